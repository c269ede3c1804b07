# SPDX-License-Identifier: GPL-3.0-or-later
# Share of the variance that is left out with the last principal components (Fig. 16 of Hoang et al.).
# reduction.csv: components kept, left out by the case's bounds, left out by those of Eq. 24 [1]
load "style.gp"
do for [kind in "png svg"] {
    eval(open_figure(kind, "reduction", 1000, 720))
    set title title_text noenhanced
    set lmargin at screen 0.12
    set rmargin at screen 0.97
    set bmargin at screen 0.21
    set tmargin at screen 0.92
    set xlabel "principal components kept, N_g"
    set ylabel "variance left out (%)"
    set xrange [0.6:3.4]
    set xtics 1
    set logscale y
    set format y "%g"
    set yrange [0.01:100]
    set key at screen 0.54, 0.05 center horizontal Left reverse width 2
    plot "reduction.csv" using ($1 > 0 && $1 < 4 ? $1 : NaN):(100*$2) with linespoints lw 1.8 pt 7 ps 1.3*dot lc rgb loading_colour title "the case's bounds", \
         "reduction.csv" using ($1 > 0 && $1 < 4 ? $1 : NaN):(100*$3) with linespoints lw 1.8 dt (6,4) pt 6 ps 1.3*dot lc rgb unloading_colour title "the paper's bounds, Eq. 24", \
         "reduction.csv" using ($1 > 0 && $1 < 4 ? $1 : NaN):(100*$2):(sprintf("%.3g %%", 100*$2)) with labels offset 4.2, 0.5 tc rgb loading_colour notitle
    set output
    unset logscale
}
