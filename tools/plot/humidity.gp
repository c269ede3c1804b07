# SPDX-License-Identifier: GPL-3.0-or-later
# Against the humidity: what water does (Fig. 4b of Hoang et al.), and the apparent energy and the
# crack length of a sweep, with the paper's and the measured (Fig. 21, Tabs. 3 and 4).
load "style.gp"

table = "../sweep.csv"
at = 2 + keys # column of "run"
gamma(l) = l > 0 ? gamma_factor/l**4 : NaN
known(c) = column(c) > 0 ? column(c) : NaN
stuck_at = at + 1
lows = at + 21 # quantiles
highs = at + 22
full(c) = column(c) > 0 && column(c) < 1e9 ? column(c) : NaN

do for [kind in "png svg"] {
    eval(open_figure(kind, "humidity", 1500, 640))
    set multiplot layout 1,3 title title_text noenhanced margins 0.06, 0.985, 0.27, 0.85 spacing 0.09, 0
    set xlabel "relative humidity (%)"
    set title "water between the faces"
    set xrange [25:100]
    set ylabel "Laplace pressure (MPa)" offset 1, 0
    set y2label "height of the water (nm)" offset -1.5, 0
    set ytics nomirror
    set y2tics
    set yrange [*:0]
    set y2range [0:20]
    set border 11
    set key at screen 0.17, 0.1 center Left reverse maxrows 2 width 2
    plot "water.csv" using ($1*100):2 with lines lw 2 lc rgb loading_colour title "pressure", \
         "water.csv" using ($1*100):3 axes x1y2 with lines lw 2 dt 2 lc rgb unloading_colour title "height"
    unset y2tics
    unset y2label
    set border 3
    set xrange [-3:100]
    set logscale y
    set yrange [*:*]
    set format y "10^{%L}"
    set key at screen 0.5, 0.1 center Left reverse maxrows 2 width 2
    set title "apparent energy Γ"
    set ylabel "Γ (mJ/m²)" offset 1, 0
    plot table using (column(2)*100):(gamma(column(at + 4))):(gamma(full(highs))):(gamma(full(lows))) \
             with yerrorbars pt 7 ps 1.1*dot lc rgb pale title "5 to 95 % of the beams", \
         table using (column(2)*100):(gamma(column(at + 4))) with linespoints pt 7 ps 1.1*dot lw 1.6 \
             lc rgb loading_colour title "of the mean crack", \
         table using (column(2)*100):(gamma(known(at + 15))) with linespoints dt 2 pt 6 ps 1.1*dot \
             lc rgb unloading_colour title "paper", \
         table using (column(2)*100):(gamma(known(at + 16))) with linespoints dt 3 pt 4 ps 1.1*dot \
             lc rgb ink title "measured"
    set key at screen 0.83, 0.1 center Left reverse maxrows 2 width 2
    set title "crack length at rest"
    set format y "%g"
    set ylabel "crack length (µm)" offset 1, 0
    plot table using (column(2)*100):(column(at + 4)):(full(lows)):(full(highs)) with yerrorbars \
             pt 7 ps 1.1*dot lc rgb pale title "5 to 95 % of the beams", \
         table using (column(2)*100):(column(at + 4)) with linespoints pt 7 ps 1.1*dot lw 1.6 \
             lc rgb loading_colour title "mean", \
         table using (column(2)*100):(known(at + 15)) with linespoints dt 2 pt 6 ps 1.1*dot \
             lc rgb unloading_colour title "paper", \
         table using (column(2)*100):(known(at + 16)) with linespoints dt 3 pt 4 ps 1.1*dot \
             lc rgb ink title "measured"
    unset logscale y
    set format y "%g"
    set yrange [*:*]
    unset multiplot
    set output
}
