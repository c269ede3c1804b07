# SPDX-License-Identifier: GPL-3.0-or-later
# Correlation of the force laws' four numbers along seamless surfaces, with intervals over the
# realizations (Fig. 15 of Hoang et al.).
# correlation.csv: patches apart, distance [um], then value, low, high of e, f_max, d_max, d_limit
load "style.gp"
stats "correlation.csv" using ($1 > 0 ? $2 : NaN) nooutput name "D"
stats "correlation.csv" using ($1 > 0 ? (($4 < $7 ? $4 : $7) < ($10 < $13 ? $10 : $13) ? ($4 < $7 ? $4 : $7) : ($10 < $13 ? $10 : $13)) : NaN) nooutput name "L"
stats "correlation.csv" using ($1 > 0 ? (($5 > $8 ? $5 : $8) > ($11 > $14 ? $11 : $14) ? ($5 > $8 ? $5 : $8) : ($11 > $14 ? $11 : $14)) : NaN) nooutput name "H"
# Where fewer than two numbers differ there is no correlation, and intervals may be wider than the figure.
known = L_records > 0
low = known && L_min > -1 ? L_min : -1
high = known && H_max < 1 ? H_max : 1
names = "'e' 'f_{max}' 'd_{max}' 'd_{limit}'"
colours = "#1f3b73 #e8862e #21918c #8a2f6b"
shapes = "7 5 9 13"
pad = 0.15*(high - low)
step = D_min

do for [kind in "png svg"] {
    eval(open_figure(kind, "correlation", 1400, 720))
    set multiplot layout 1,2 title title_text noenhanced margins 0.075, 0.985, 0.23, 0.85 spacing 0.09, 0
    set xlabel "distance along the beam (µm)"
    set ylabel "correlation (1)" offset 1, 0
    set key at screen 0.53, 0.065 center Left reverse enhanced maxrows 1 width 4
    set title "of two patches' law numbers"
    set xrange [-0.02*D_max:1.03*D_max]
    set yrange [low - pad < -0.2 ? low - pad : -0.2:1.05]
    plot 0 with lines lc rgb ink lw 0.8 notitle, \
         for [i=1:4] "correlation.csv" using 2:(column(3*i)) with linespoints lw 1.4 pt int(word(shapes, i)) ps 0.9*dot lc rgb word(colours, i) title word(names, i)
    unset key
    set title sprintf("the same but for distance 0, with %.4g %% intervals", 100*confidence)
    set yrange [low - pad:high + pad]
    plot 0 with lines lc rgb ink lw 0.8 notitle, \
         for [i=1:4] "correlation.csv" using ($1 > 0 ? $2 + (i - 2.5)*0.16*step : NaN):(column(3*i)):(column(3*i+1)):(column(3*i+2)) with yerrorbars lw 1.2 pt int(word(shapes, i)) ps 0.8*dot lc rgb word(colours, i) notitle
    unset multiplot
    set output
}
