# SPDX-License-Identifier: GPL-3.0-or-later
# What menisci and van der Waals forces each do by themselves against the humidity (Fig. 20 of Hoang
# et al.): apparent energies of the beams' cracks.
load "style.gp"

table = "../sweep.csv"
at = 2 + keys # column of "run"; mean crack and quantiles:
mean_at = at + 4
low_at = at + 21
high_at = at + 22
known(c) = column(c) > 0 && column(c) < 1e9 ? column(c) : NaN
apparent(c) = gamma_factor/known(c)**4
# contact.forces, the second swept key: 0 given, 1 auto, 2 capillary, 3 vdw
of(which) = column(3) == which || (which == 0 && column(3) == 1) ? column(2)*100 : NaN
both = int(system("awk -F, 'NR > 1 && $3 < 2 { n++ } END { print n + 0 }' ".table))

do for [kind in "png svg"] {
    eval(open_figure(kind, "contributions", 1000, 720))
    set title title_text noenhanced
    set lmargin at screen 0.11
    set rmargin at screen 0.97
    set bmargin at screen 0.23
    set tmargin at screen 0.91
    set xlabel "relative humidity (%)"
    set xrange [24:86]
    set ylabel "apparent energy Γ (mJ/m²)" offset 0.5, 0
    set logscale y
    set format y "10^{%L}"
    set key at screen 0.54, 0.07 center Left reverse maxrows 2 width 2
    plot table using (of(2)):(apparent(mean_at)):(apparent(high_at)):(apparent(low_at)) with yerrorbars \
             pt 7 ps 1.3*dot lw 1.6 lc rgb loading_colour title "menisci alone", \
         table using (of(3)):(apparent(mean_at)):(apparent(high_at)):(apparent(low_at)) with yerrorbars \
             pt 5 ps 1.3*dot lw 1.6 lc rgb unloading_colour title "van der Waals alone", \
         table using (of(0)):(apparent(mean_at)):(apparent(high_at)):(apparent(low_at)) with yerrorbars \
             pt 4 ps 1.3*dot lw 1.6 lc rgb ink title (both > 0 ? "both" : "bars: 5 to 95 % of the beams")
    unset logscale y
    set output
}
