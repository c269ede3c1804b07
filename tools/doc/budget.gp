# SPDX-License-Identifier: GPL-3.0-or-later
# What each refinement of FOLDER/out/budget.csv moves the mean crack length by, into FOLDER/out/budget.png.
# Usage: gnuplot -e "folder='cases/delrio-rh85'" budget.gp
set datafile separator ","
set terminal pngcairo noenhanced size 720,480
set output folder . "/out/budget.png"
set key off
set xlabel "shift of the mean crack length (um)"
set yrange [*:*] reverse
set offsets 0, 0, 0.5, 0.5
set arrow 1 from 0, graph 0 to 0, graph 1 nohead linetype 0
set lmargin 26
plot "< grep '^\"[a-zA-Z_ ]*\",refi' " . folder . "/out/budget.csv" \
    using 8:0:($8 - $9):($8 + $9):ytic(1) with xerrorbars pointtype 7 linewidth 2
