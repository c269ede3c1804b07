# SPDX-License-Identifier: GPL-3.0-or-later
# What changes of the surface do to the adhesion energy at low humidity, beside the measured one: a
# panel a humidity, a line a change. Drawn by tools/bench/low-humidity, which gives `measured`
# [mJ/m2] and the folder of gap.csv as `folder`.
load "style.gp"
table = folder."/gap.csv"
set output
eval(open_png(folder."/gap", 1500, 760))
humidities = "0 30 45 55"
stats table using 4 nooutput name "E"
rows = int(E_records/words(humidities))
set multiplot layout 1,4 margins 0.27, 0.985, 0.13, 0.86 spacing 0.015, 0 \
    title "Adhesion energy of the DelRio surfaces' patches, one thing changed at a time"
set logscale x
set xrange [0.6*E_min:2*E_max]
set yrange [rows - 0.4:-0.6] noreverse
set format x "10^{%L}"
set xtics 100
set xlabel "energy (mJ/m²)"
set grid x
unset key
do for [k=1:4] {
    rh = word(humidities, k)
    set title sprintf("RH %s %%", rh)
    set arrow 1 from measured, graph 0 to measured, graph 1 nohead lc rgb unloading_colour dt 2 lw 1.4
    set label 1 "measured" at measured, graph 0.03 offset 0.6, 0 tc rgb unloading_colour font ",13"
    points = "table using 4:(int($0)):($5/sqrt($6)) every 4::(k - 1) with xerrorbars pt 7 ps 1.3*dot lc rgb loading_colour"
    # the first panel names the rows; the others take its tics without names
    if (k == 1) { eval("plot ".points.", table using 4:(int($0)):ytic(2) every 4::(k - 1) with points ps 0") }
    if (k > 1) { set ytics 1 format ""; eval("plot ".points) }
}
unset multiplot
