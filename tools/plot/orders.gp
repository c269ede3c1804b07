# SPDX-License-Identifier: GPL-3.0-or-later
# How the expansion settles with its order (Fig. C.23 of Hoang et al.).
# orders.csv: germ 0 to 2, order, terms, relMISE by its own rule, by an independent one, ..., relMISE of
# each component from column 13; map.csv: curve, xi, inverse Rosenblatt map, then an order a column
load "style.gp"
germs = "Legendre Hermite Jacobi"
colours = "#1f3b73 #e8862e #21918c"
shapes = "7 5 9"
orders = int(system("head -1 map.csv | tr ',' '\\n' | wc -l")) - 3
label(k) = system(sprintf("head -1 map.csv | cut -d, -f%d", 3 + k))
own_colours = "#c9a227 #21918c #1f3b73"
colour(k) = word(own_colours, 3 - orders + k)
stats "map.csv" using 1 nooutput name "C"
stats "orders.csv" using ($4 > 1e-6 ? $4 : 1e-6) nooutput name "O"

do for [kind in "png svg"] {
    eval(open_figure(kind, "orders", 1700, 800))
    set multiplot title title_text noenhanced
    set bmargin at screen 0.33
    set tmargin at screen 0.87
    set lmargin at screen 0.06
    set rmargin at screen 0.315
    set title "(a) error against the order"
    set xlabel "order N_d of the expansion"
    set ylabel "relMISE (1)" offset 1, 0
    set logscale y
    set format y "10^{%T}"
    set yrange [10**floor(log10(O_min)):1]
    set xrange [0:15]
    set key at screen 0.20, 0.115 center Left reverse maxrows 3 width 0 samplen 2
    plot for [g=0:2] "orders.csv" using ($1 == g ? $2 : NaN):5 with linespoints lw 1.6 pt int(word(shapes, g + 1)) ps 1.0*dot lc rgb word(colours, g + 1) title word(germs, g + 1).", independent", \
         for [g=0:2] "orders.csv" using ($1 == g ? $2 : NaN):4 with linespoints lw 1.1 dt (4,4) pt int(word(shapes, g + 1)) ps 0.6*dot lc rgb word(colours, g + 1) title word(germs, g + 1).", own rule"
    unset logscale
    set format y "%g"
    set lmargin at screen 0.385
    set rmargin at screen 0.645
    set title "(b) map to the first component"
    set xlabel "ξ_1 (1)" enhanced
    set ylabel "component (standard deviations)" offset 1, 0
    set xrange [0:1]
    set yrange [*:*]
    set key at screen 0.68, 0.115 center Left reverse maxrows 2 width 2
    plot "map.csv" using ($1 == 0 ? $2 : NaN):3 with lines lw 4 lc rgb shade_colour title "inverse Rosenblatt map", \
         for [k=1:orders] "map.csv" using ($1 == 0 ? $2 : NaN):(column(3+k)) with lines lw 1.4 lc rgb colour(k) title "expansion, ".label(k)
    unset key
    if (C_max > 0) {
        set lmargin at screen 0.72
        set rmargin at screen 0.98
        set title "(c) map to the second, at ξ_1 = 0.1, 0.5, 0.9" enhanced
        set xlabel "ξ_2 (1)" enhanced
        set yrange [*:*]
        plot for [c=1:3] "map.csv" using ($1 == c ? $2 : NaN):3 with lines lw 4 lc rgb shade_colour notitle, \
             for [c=1:3] for [k=1:orders] "map.csv" using ($1 == c ? $2 : NaN):(column(3+k)) with lines lw 1.4 lc rgb colour(k) notitle
    }
    unset multiplot
    set output
}
