# SPDX-License-Identifier: GPL-3.0-or-later
# Height map of a piece of the first beam's surface. PNG alone: an SVG would carry the same pixels.
load "style.gp"

stats "surface.csv" using 1 nooutput name "X"
stats "surface.csv" using 2 nooutput name "Y"
stats "surface.csv" using 3 nooutput name "Z"

eval(open_png("surface", 1280, 1130))
set border 15
set title title_text noenhanced
set size ratio -1
set xlabel "along the beam (µm)"
set ylabel "across the beam (µm)"
set cblabel sprintf("height (nm), rms %.2f nm in this piece", Z_stddev)
set xrange [X_min:X_max]
set yrange [Y_min:Y_max]
# A flat surface still needs a range.
set cbrange [Z_min - 1e-6 : Z_max + 1e-6]
unset grid
plot "surface.csv" using 1:2:3 with image notitle
set output
