# SPDX-License-Identifier: GPL-3.0-or-later
# What Haft does, in one picture: from a rough surface by its force laws to beams that stick.
load "style.gp"
load "laws_data.gp"
load "shapes_data.gp"
load "cracks_data.gp"
stats "surface.csv" using 1 nooutput name "X"
stats "surface.csv" using 2 nooutput name "Y"
stats "surface.csv" using 3 nooutput name "Z"

eval(open_png("overview", 1240, 1120))
set multiplot title title_text noenhanced
set title offset 0, -0.5

set lmargin at screen 0.068
set rmargin at screen 0.405
set bmargin at screen 0.61
set tmargin at screen 0.92
set title "(a) a piece of the rough surface"
set size ratio -1
set border 15
unset grid
set xlabel "along the beam (µm)"
set ylabel "across the beam (µm)"
set cblabel "height (nm)"
set xrange [X_min:X_max]
set yrange [Y_min:Y_max]
set cbrange [Z_min - 1e-6 : Z_max + 1e-6]
# Every second point each way is enough at this size; surface.csv is a square, row after row.
side = int(sqrt(X_records) + 0.5)
plot "<awk -v n=".side." 'NR == 1 || (NR-2)%2 == 0 && int((NR-2)/n)%2 == 0' surface.csv" using 1:2:3 with image notitle
set size noratio
set border 3
set grid

set lmargin at screen 0.60
set rmargin at screen 0.985
set title "(b) force laws of some of its patches"
eval(laws_setup)
set ylabel "pressure (MPa)"
set key top right
eval("plot ".laws_plot)

set lmargin at screen 0.068
set rmargin at screen 0.405
set bmargin at screen 0.165
set tmargin at screen 0.48
set title "(c) a beam pressed down, and let go"
set xlabel "position along the beam (µm)"
set ylabel "height above the substrate (µm)"
set xrange [0:beam_length]
set yrange [-0.04*gap:1.75*gap]
eval(mark_load)
if (coloured) {
    eval(shapes_colours)
    set colorbox user origin screen 0.415, screen 0.165 size screen 0.012, screen 0.315
    set cblabel "crack length (µm)"
}
eval("plot ".shapes_plot(0).", 'shapes.csv' every ::rest_first::rest_last using 4:5 with lines lw 3 lc rgb unloading_colour notitle, ".shapes_keys(0).", NaN with lines lw 3 lc rgb unloading_colour title 'at rest, the load gone'")
unset colorbox
unset arrow
unset label

set lmargin at screen 0.60
set rmargin at screen 0.985
set title sprintf("(d) crack lengths: %d of %d beams stuck", stuck_beams, beams)
set key at screen 0.74, 0.055 center Left reverse maxrows 3 width 0
eval(cracks_setup)
eval("plot ".cracks_plot)
unset multiplot
set output
