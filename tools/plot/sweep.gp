# SPDX-License-Identifier: GPL-3.0-or-later
# A sweep: crack length at rest and internal energy there against the first swept key (Fig. 13 of
# Hoang et al. where that is l_meso or the element length).
load "style.gp"

table = "../sweep.csv"
# sweep.csv: variant, the swept keys in SI, run, stuck, free, failed, mean, low, high, deviation [um],
# Gamma [mJ/m2], internal energy, dissipated [pJ], ...
at = 2 + keys # column of "run"
at_x(v) = choices eq "" ? column(2)*swept_factor : column(1) # a choice has places, not values
stats table using (at_x(0)) nooutput name "X"
stats table using (column(at + 4)) nooutput name "M"
known(name) = name eq "paper" ? paper > 0 : measured > 0
ratio = choices eq "" && X_min > 0 ? X_max/X_min : 1
if (choices ne "") { set xtics () }
do for [i=1:words(choices)] { set xtics add (word(choices, i) i - 1) }
margin = choices eq "" ? 0.05 : 0.2
joined = choices eq "" ? "linespoints" : "points" # nothing lies between two choices
set macros

do for [kind in "png svg"] {
    eval(open_figure(kind, "sweep", 1400, 700))
    set multiplot layout 1,2 title title_text noenhanced margins 0.075, 0.98, 0.26, 0.85 spacing 0.1, 0
    set xlabel swept.(swept_unit eq "" ? "" : " (".swept_unit.")") noenhanced
    if (ratio > 4) { set logscale x 2; set xrange [X_min/1.2:X_max*1.2] }
    if (ratio <= 4) { set xrange [X_min - margin*(X_max - X_min):X_max + margin*(X_max - X_min)] }
    set key at screen 0.29, 0.075 center Left reverse maxrows 2 width 2
    set ylabel "crack length at rest (µm)" offset 1, 0
    set title "crack length"
    plot table using (at_x(0)):(column(at + 4)):(column(at + 5)):(column(at + 6)) with yerrorbars \
             pt 7 ps 1.1*dot lc rgb pale title sprintf("%.4g %% interval", 100*confidence), \
         table using (at_x(0)):(column(at + 4)) with @joined pt 7 ps 1.1*dot lw 1.6 \
             lc rgb loading_colour title "mean over the beams", \
         table using (at_x(0)):(column(at + 15)) with @joined dt 2 pt 6 ps 1.1*dot \
             lc rgb unloading_colour title (known("paper") ? "paper" : ""), \
         table using (at_x(0)):(column(at + 16)) with @joined dt 3 pt 4 ps 1.1*dot \
             lc rgb ink title (known("measured") ? "measured" : "")
    set title "internal energy at rest"
    set key at screen 0.78, 0.075 center Left reverse maxrows 1 width 2
    set ylabel "internal energy (pJ)" offset 1, 0
    plot table using (at_x(0)):(column(at + 9)) with @joined pt 7 ps 1.1*dot lw 1.6 \
             lc rgb loading_colour title "mean over the beams"
    unset multiplot
    set output
}
