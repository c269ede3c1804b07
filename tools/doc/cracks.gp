# SPDX-License-Identifier: GPL-3.0-or-later
# Cumulative distribution of the crack lengths in FOLDER/out/summary.csv, into FOLDER/out/cracks.png.
# Usage: gnuplot -e "folder='cases/delrio-rh85'" cracks.gp
set datafile separator ","
set terminal pngcairo size 640,480
set output folder . "/out/cracks.png"
stats folder . "/out/summary.csv" using ($2 == 0 ? $3 : 1/0) skip 1 nooutput name "crack_"
set xlabel "crack length at rest (um)"
set ylabel "cumulative share of the stuck beams"
set yrange [0:1]
set key off
plot folder . "/out/summary.csv" using ($2 == 0 ? $3 : 1/0):(1.0 / crack_records) skip 1 \
    smooth cumulative with steps linewidth 2
