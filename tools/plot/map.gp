# SPDX-License-Identifier: GPL-3.0-or-later
# A measured map, the distribution of its heights, its radial PSD. PNG alone: the map's pixels would
# be the same in an SVG.
load "style.gp"

stats "map.csv" using 1 nooutput name "X"
stats "map.csv" using 2 nooutput name "Y"
stats "map.csv" using 3 nooutput name "Z"

eval(open_png("map", 1900, 640))
set multiplot title title_text noenhanced
set bmargin at screen 0.13
set tmargin at screen 0.88

set border 15
set lmargin at screen 0.05
set rmargin at screen 0.26
set size ratio -1
set xlabel "x (µm)"
set ylabel "y (µm)"
set cblabel "height (nm)"
set xrange [X_min:X_max]
set yrange [Y_min:Y_max]
set cbrange [Z_min - 1e-6 : Z_max + 1e-6]
unset grid
plot "map.csv" using 1:2:3 with image notitle

set border 3
set lmargin at screen 0.41
set rmargin at screen 0.66
set size noratio
set grid
set autoscale
set xlabel "height (nm)"
set ylabel "density (1/nm)"
set yrange [0:*]
set key top right
plot "histogram.csv" using 1:2 with boxes fill solid 0.35 border lc rgb loading_colour \
         lc rgb loading_colour title "pixels", \
     "" using 1:3 with lines lc rgb unloading_colour lw 2 title "normal"

set lmargin at screen 0.74
set rmargin at screen 0.98
if (panels == 2) { unset multiplot; exit }
set autoscale
set logscale xy
set format x "10^{%L}"
set format y "10^{%L}"
set xlabel "wave number (rad/µm)"
set ylabel "PSD (nm^4)"
set key bottom left
plot "psd.csv" using 1:2:($2*(1 - ($3 < 0.9 ? $3 : 0.9))):($2*(1 + $3)) with yerrorbars \
         pt 7 ps 0.6 lc rgb loading_colour title "rings, 1 standard error", \
     "" using 1:(fitted && $1 >= first && $1 <= last ? $4 : NaN) with lines \
         lc rgb unloading_colour lw 2 title fitted ? "self-affine fit, where it holds" : ""
unset multiplot
set output
