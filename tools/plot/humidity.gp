# SPDX-License-Identifier: GPL-3.0-or-later
# Apparent energy and crack length of a sweep against the humidity, with the paper's and the measured
# (Fig. 21, Tabs. 3 and 4 of Hoang et al.).
load "style.gp"

table = "../sweep.csv"
at = 2 + keys # column of "run"; mean crack, the paper's, the measured, quantiles:
mean_at = at + 4
paper_at = at + 15
measured_at = at + 16
low_at = at + 21
high_at = at + 22
known(c) = column(c) > 0 && column(c) < 1e9 ? column(c) : NaN
apparent(c) = gamma_factor/known(c)**4

do for [kind in "png svg"] {
    eval(open_figure(kind, "humidity", 1300, 700))
    set multiplot layout 1,2 title title_text noenhanced margins 0.08, 0.98, 0.26, 0.86 spacing 0.12, 0
    set xlabel "relative humidity (%)"
    set xrange [-3:103]
    set logscale y
    set format y "10^{%L}"
    set key at screen 0.53, 0.075 center Left reverse maxrows 2 width 2
    set title "apparent energy"
    set ylabel "Γ (mJ/m²)" offset 0.5, 0
    plot table using (column(2)*100):(apparent(mean_at)):(apparent(high_at)):(apparent(low_at)) \
             with yerrorbars pt 7 ps 1.1*dot lc rgb pale title "5 to 95 % of the beams", \
         table using (column(2)*100):(apparent(mean_at)) with linespoints pt 7 ps 1.1*dot lw 1.6 \
             lc rgb loading_colour title "mean crack", \
         table using (column(2)*100):(apparent(paper_at)) with linespoints dt 2 pt 6 ps 1.1*dot \
             lc rgb unloading_colour title "paper", \
         table using (column(2)*100):(apparent(measured_at)) with linespoints dt 3 pt 4 ps 1.1*dot \
             lc rgb ink title "measured"
    unset key
    set title "crack length at rest"
    set format y "%g"
    set ylabel "crack length (µm)" offset 0.5, 0
    set yrange [60:*]
    plot table using (column(2)*100):(known(mean_at)):(known(low_at)):(known(high_at)) with yerrorbars \
             pt 7 ps 1.1*dot lc rgb pale notitle, \
         table using (column(2)*100):(known(mean_at)) with linespoints pt 7 ps 1.1*dot lw 1.6 \
             lc rgb loading_colour notitle, \
         table using (column(2)*100):(known(paper_at)) with linespoints dt 2 pt 6 ps 1.1*dot \
             lc rgb unloading_colour notitle, \
         table using (column(2)*100):(known(measured_at)) with linespoints dt 3 pt 4 ps 1.1*dot \
             lc rgb ink notitle
    unset logscale y
    set yrange [*:*]
    unset multiplot
    set output
}
