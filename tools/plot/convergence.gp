# SPDX-License-Identifier: GPL-3.0-or-later
# Mean and standard deviation of the crack length over the first n beams, with their confidence
# intervals (Fig. 19a, b of Hoang et al.). The first few beams' intervals are wider than the figure.
load "style.gp"

band_colour = "#dfe6f2"
table = "../convergence.csv"
# convergence.csv: beams, stuck, mean, its low and high, deviation, its low and high [um]
stats table using 1:2 nooutput name "N"
beams = int(N_max_x)
known = N_max_y > 1
if (known) {
    stats table using ($2 > 4 ? $4 : $2 > 1 ? $3 : NaN) nooutput name "ML"
    stats table using ($2 > 4 ? $5 : $2 > 1 ? $3 : NaN) nooutput name "MH"
    stats table using ($2 > 4 ? $8 : $2 > 1 ? $6 : NaN) nooutput name "DH"
    pad = MH_max > ML_min ? 0.05*(MH_max - ML_min) : 0.05*MH_max
    deviation_top = DH_max > 0 ? 1.05*DH_max : 1
}

do for [kind in "png svg"] {
    eval(open_figure(kind, "convergence", 1400, 700))
    set multiplot layout 1,2 title title_text noenhanced margins 0.085, 0.97, 0.24, 0.85 spacing 0.09, 0
    set xlabel "number of beams"
    set xrange [1:beams]
    if (beams < 12) { set xtics 1 }
    set key bottom center outside horizontal width 1 Left reverse
    if (known) {
        set title "mean"
        set ylabel "crack length at rest (µm)" offset 1, 0
        set yrange [ML_min - pad:MH_max + pad]
        plot table using 1:4:5 with filledcurves fc rgb band_colour title sprintf("%.4g %% interval of the mean (Student)", 100*confidence), \
             table using 1:($2 > 0 ? $3 : NaN) with lines lw 2.2 lc rgb loading_colour title "mean"
        set title "standard deviation"
        set ylabel "standard deviation (µm)" offset 1, 0
        set yrange [0:deviation_top]
        plot table using 1:7:8 with filledcurves fc rgb band_colour title sprintf("%.4g %% interval (chi-square)", 100*confidence), \
             table using 1:6 with lines lw 2.2 lc rgb loading_colour title "standard deviation"
    } else {
        set title " "
        set yrange [0:1]
        set label 9 "fewer than two beams stuck" at graph 0.5, 0.5 center
        plot NaN notitle
        unset label 9
        plot NaN notitle
    }
    unset multiplot
    set output
}
