# SPDX-License-Identifier: GPL-3.0-or-later
# A run's crack lengths against a reference's: mean, standard deviation and distribution (Fig. 19 of
# Hoang et al.). convergence.csv: beams, stuck, mean, low, high, deviation, low, high [um]
load "style.gp"
reference_text = system("printenv HAFT_REFERENCE")
if (strlen(reference_text) > 100) { reference_text = reference_text[1:97]."..." }
ours = "../convergence.csv"
theirs = "reference_convergence.csv"
stats ours using 1 nooutput name "N"
stats theirs using 1 nooutput name "R"
beams = N_max > R_max ? N_max : R_max
stats ours using ($2 > 9 ? $4 : NaN) nooutput name "L"
stats ours using ($2 > 9 ? $5 : NaN) nooutput name "H"
stats theirs using ($2 > 9 ? $4 : NaN) nooutput name "P"
stats theirs using ($2 > 9 ? $5 : NaN) nooutput name "Q"
stats ours using ($2 > 9 ? $8 : NaN) nooutput name "D"
stats theirs using ($2 > 9 ? $8 : NaN) nooutput name "E"
low = L_min < P_min ? L_min : P_min
high = H_max > Q_max ? H_max : Q_max
top = D_max > E_max ? D_max : E_max
ours_band = "#dfe6f2"
theirs_band = "#fae6cf"

do for [kind in "png svg"] {
    eval(open_figure(kind, "against", 1700, 720))
    set multiplot title title_text noenhanced
    set bmargin at screen 0.25
    set tmargin at screen 0.86
    set key at screen 0.5, 0.07 center Left reverse maxrows 2 width 2
    set style fill transparent solid 0.7 noborder
    set logscale x
    set xrange [2:beams]
    set lmargin at screen 0.06
    set rmargin at screen 0.325
    set title "(a) mean over the first n beams"
    set xlabel "beams n"
    set ylabel "mean crack length at rest (µm)" offset 1, 0
    set yrange [low - 0.05*(high - low):high + 0.05*(high - low)]
    plot theirs using 1:4:5 with filledcurves fc rgb theirs_band notitle, \
         ours using 1:4:5 with filledcurves fc rgb ours_band notitle, \
         theirs using 1:3 with lines lw 2.2 dt (6,3) lc rgb unloading_colour title sprintf("%s: %d beams", reference_text, R_max), \
         ours using 1:3 with lines lw 2.2 lc rgb loading_colour title sprintf("%s: %d beams", title_text, N_max)
    unset key
    set lmargin at screen 0.385
    set rmargin at screen 0.65
    set title "(b) standard deviation"
    set ylabel "standard deviation (µm)" offset 1, 0
    set yrange [0:1.05*top]
    plot theirs using 1:7:8 with filledcurves fc rgb theirs_band notitle, \
         ours using 1:7:8 with filledcurves fc rgb ours_band notitle, \
         theirs using 1:6 with lines lw 2.2 dt (6,3) lc rgb unloading_colour notitle, \
         ours using 1:6 with lines lw 2.2 lc rgb loading_colour notitle
    unset logscale
    set lmargin at screen 0.715
    set rmargin at screen 0.985
    set title "(c) cumulative distribution"
    set xlabel "crack length at rest (µm)"
    set ylabel "share of the beams that stuck (1)" offset 1, 0
    set xrange [*:*]
    set yrange [0:1.03]
    plot "reference_summary.csv" using ($2 == 0 ? $3 : NaN):(1.0) smooth cnorm with steps lw 2.2 dt (6,3) lc rgb unloading_colour notitle, \
         "../summary.csv" using ($2 == 0 ? $3 : NaN):(1.0) smooth cnorm with steps lw 2.2 lc rgb loading_colour notitle
    unset multiplot
    set output
}
