# SPDX-License-Identifier: GPL-3.0-or-later
# What menisci and van der Waals forces each do by themselves against the humidity (Fig. 20 of Hoang
# et al.): apparent energies of the beams' cracks.
load "style.gp"

table = "../sweep.csv"
at = 2 + keys # column of "run"
gamma(l) = l > 0 && l < 1e9 ? gamma_factor/l**4 : NaN
# contact.forces, the second swept key: 0 given, 1 auto, 2 capillary, 3 vdw
of(kind) = column(3) == kind ? 1 : NaN
aside(kind) = column(2)*100 + 0.7*(kind - 2)
series_name = "given both capillary vdW"
series_title(kind) = kind == 0 ? "both" : kind == 1 ? "by the paper's rule" : kind == 2 ? "menisci alone" : "van der Waals alone"
series_colour(kind) = kind == 2 ? loading_colour : kind == 3 ? unloading_colour : kind == 0 ? ink : pale
any(kind) = int(system(sprintf("awk -F, 'NR > 1 && $3 == %d { n++ } END { print n + 0 }' %s", kind, table)))

do for [kind in "png svg"] {
    eval(open_figure(kind, "contributions", 1000, 720))
    set title title_text noenhanced
    set lmargin at screen 0.11
    set rmargin at screen 0.97
    set bmargin at screen 0.23
    set tmargin at screen 0.9
    set xlabel "relative humidity (%)"
    set ylabel "apparent energy Γ (mJ/m²), mean and 5 to 95 % of the beams" offset 1, 0
    set logscale y
    set format y "10^{%L}"
    set key at screen 0.54, 0.06 center Left reverse maxrows 1 width 2
    plot for [k=0:3] (any(k) > 0 ? table : NaN) using (of(k)*aside(k)):(gamma(column(at + 4))):(gamma(column(at + 22))):(gamma(column(at + 21))) \
             with yerrorbars pt 7 ps 1.3*dot lw 1.6 lc rgb series_colour(k) title (any(k) > 0 ? series_title(k) : "")
    set output
}
