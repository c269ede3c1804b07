# SPDX-License-Identifier: GPL-3.0-or-later
# Crack-length error against cost, from the CSV of tools/bench/samplers. From the top folder:
#   gnuplot -e "csv='FILE.csv'; png='FILE.png'" tools/plot/samplers.gp
# Columns: sampler, group, germ, order, vectors, beams, mean, shift, its error, deviation's shift, its
# error, KS, its chance, W1, its error, W1 by chance [um], fit, a beam, a thousand beams [s].
set loadpath "tools/plot"
load "style.gp"
set terminal pngcairo enhanced butt size 1500,820 background 'white' font 'DejaVu Sans,14' linewidth 1.6
set output png

of(g) = strcol(2) eq g
germ(g) = strcol(2) eq "gpce" && strcol(3) eq g
# Germs and orders, which cost the same, stand beside each other. The mean law is out of range: its one crack length is told in the table.
keep = "explicit tables patches bootstrap kernel exact fewer"
names = "'explicit' 'explicit, tables' 'patches' 'bootstrap' 'kernel' 'exact' 'gpce, order 12, from fewer vectors'"
colours = "#222222 #777777 #c9a227 #8a2f6b #5ec962 #b03a2e #1f3b73"
shapes = "7 6 5 4 9 13 8"
germs = "legendre hermite jacobi"
germ_colours = "#1f3b73 #e8862e #21918c"

set logscale x
set format x "10^{%T}"
set xlabel "processor time of 1000 beams with all they need (s)"
set bmargin at screen 0.33
set tmargin at screen 0.92
set multiplot
unset key
set lmargin at screen 0.07
set rmargin at screen 0.485
set title "mean crack length, less the explicit beams'"
set ylabel "shift (µm), ± standard error" offset 1, 0
plot 0 with lines lc rgb ink lw 0.8 notitle, \
     for [i=1:7] csv using 19:(of(word(keep, i)) ? $8 : NaN):9 with yerrorbars lw 1.1 pt int(word(shapes, i)) ps 1.1 lc rgb word(colours, i) notitle, \
     for [g=1:3] csv using ($19*(1 + 0.25*(g - 2) + 0.02*($4 - 9))):(germ(word(germs, g)) ? $8 : NaN):9 with yerrorbars lw 1.1 pt 1 ps 0.9 lc rgb word(germ_colours, g) notitle
set lmargin at screen 0.57
set rmargin at screen 0.985
set title "Wasserstein-1 distance from the explicit beams"
set ylabel "distance (µm), ± standard error" offset 1, 0
set yrange [0:*]
plot for [i=2:7] csv using 19:(of(word(keep, i)) ? $14 : NaN):15 with yerrorbars lw 1.1 pt int(word(shapes, i)) ps 1.1 lc rgb word(colours, i) notitle, \
     for [g=1:3] csv using ($19*(1 + 0.25*(g - 2) + 0.02*($4 - 9))):(germ(word(germs, g)) ? $14 : NaN):15 with yerrorbars lw 1.1 pt 1 ps 0.9 lc rgb word(germ_colours, g) notitle, \
     csv using 19:(strcol(2) ne "mean" && strcol(2) ne "explicit" ? $16 : NaN) with points pt 2 ps 1.2 lw 1.2 lc rgb unloading_colour notitle
# The key, in a row of its own.
unset border
unset tics
unset xlabel
unset ylabel
unset title
unset logscale
set xrange [0:1]
set yrange [0:1]
set lmargin at screen 0.03
set rmargin at screen 0.97
set bmargin at screen 0.01
set tmargin at screen 0.21
set key center center Left reverse maxrows 4 width 1
plot for [i=1:7] NaN with points pt int(word(shapes, i)) ps 1.1 lc rgb word(colours, i) title word(names, i), \
     for [g=1:3] NaN with points pt 1 ps 0.9 lc rgb word(germ_colours, g) title "gpce, ".word(germs, g).", orders 4 to 14", \
     NaN with points pt 2 ps 1.2 lw 1.2 lc rgb unloading_colour title "distance that chance alone makes"
unset multiplot
set output
