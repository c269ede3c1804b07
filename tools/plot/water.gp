# SPDX-License-Identifier: GPL-3.0-or-later
# Laplace pressure and height of the water between the faces against the humidity (Fig. 4b of Hoang
# et al.).
load "style.gp"

do for [kind in "png svg"] {
    eval(open_figure(kind, "water", 900, 640))
    set title title_text noenhanced
    set lmargin at screen 0.12
    set rmargin at screen 0.88
    set bmargin at screen 0.23
    set tmargin at screen 0.9
    set border 11
    set xlabel "relative humidity (%)"
    set xrange [28:100]
    set ylabel "Laplace pressure (MPa)" offset 1, 0
    set yrange [*:0]
    set y2label "height of the water (nm)" offset -1, 0
    set y2range [0:20]
    set y2tics
    set key at screen 0.5, 0.06 center Left reverse maxrows 2 width 2
    plot "water.csv" using ($1*100):2 with lines lw 2 lc rgb loading_colour title "pressure (left)", \
         "water.csv" using ($1*100):3 axes x1y2 with lines lw 2 dt 2 lc rgb unloading_colour \
             title "height (right)"
    set output
}
