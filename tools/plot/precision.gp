# SPDX-License-Identifier: GPL-3.0-or-later
# Error against the time of a cycle, from the CSV of bench-precision. From the top folder:
#   gnuplot -e "csv='FILE.csv'; png='FILE.png'" tools/plot/precision.gp
set loadpath "tools/plot"
load "style.gp"

set terminal pngcairo enhanced butt size 1500,640 background 'white' font 'DejaVu Sans,14' linewidth 1.6
set output png

# Columns: varied, value, seconds, the three errors, jumps, beams_that_differ, default.
stats csv using 3 nooutput
left = 0.8*STATS_min
right = 1.3*STATS_max
floor_at(e, low) = e < low ? low : e # exact to the last bit: drawn at the foot
picked(name) = strcol(1) eq name && column(2) > 0
exact(unused) = strcol(1) eq "element_length" && column(2) == 0

set logscale xy
set xrange [left:right]
set xtics (0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10)
set format x "%g"
set format y "10^{%T}"
set xlabel "time of a load-unload cycle (s)"
set bmargin at screen 0.29
set tmargin at screen 0.91

steps = "gap_step ledger_tolerance flow_step"
labels = "'gap step' 'ledger tolerance' 'flow step'"
colours = "#e8862e #8a8a8a #21918c"
shapes = "4 8 12"
panels = "'crack length at rest' 'loads of the jumps' 'energy lost in jumps'"
units = "'error (µm)' 'error over the greatest load' 'relative error'"

set multiplot
unset key
do for [p = 1:3] {
    e = p + 3
    low = p == 1 ? 1e-12 : 1e-15
    set yrange [low : (p == 1 ? 1e3 : 10)]
    set lmargin at screen 0.065 + (p - 1)*0.325
    set rmargin at screen 0.065 + (p - 1)*0.325 + 0.255
    set title word(panels, p)
    set ylabel word(units, p) offset 1, 0
    plot csv using (picked("element_length") ? column(3) : NaN):(floor_at(column(e), low)) \
             with points pt 7 ps 1.2 lc rgb loading_colour notitle, \
         csv using (picked("element_length") ? column(3) : NaN):(floor_at(column(e), low)):(sprintf("%g", 1e6*column(2))) \
             with labels left offset 0.9, 0.3 font ",12" tc rgb loading_colour notitle, \
         csv using (exact(0) ? column(3) : NaN):(floor_at(column(e), low)) \
             with points pt 3 ps 1.5 lw 1.5 lc rgb loading_colour notitle, \
         for [i = 1:3] csv using (picked(word(steps, i)) ? column(3) : NaN):(floor_at(column(e), low)) \
             with points pt int(word(shapes, i)) ps 1.2 lw 1.2 lc rgb word(colours, i) notitle, \
         csv using (column(9) == 1 ? column(3) : NaN):(floor_at(column(e), low)) \
             with points pt 6 ps 2.8 lw 1.4 lc rgb ink notitle
}
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
set tmargin at screen 0.17
set key center center horizontal Left reverse maxrows 2
plot NaN with points pt 7 ps 1.2 lc rgb loading_colour title "element length in µm, against the exact mesh", \
     NaN with points pt 3 ps 1.5 lw 1.5 lc rgb loading_colour title "exact mesh, against the finest steps on it", \
     for [i = 1:3] NaN with points pt int(word(shapes, i)) ps 1.2 lw 1.2 lc rgb word(colours, i) \
         title word(labels, i).", against the finest", \
     NaN with points pt 6 ps 2.8 lw 1.4 lc rgb ink title "default of each"
unset multiplot
set output
