# SPDX-License-Identifier: GPL-3.0-or-later
# The radial PSD that a case asks for and that of a piece of its first surface (Fig. 11 of Hoang et
# al.).
load "style.gp"

stats "psd.csv" using (log10($1)) nooutput name "ZETA"
stats "psd.csv" using (log10($2)) nooutput name "S"
rings = int(system("awk -F, 'NR > 1 && $2 !~ /nan/' rings.csv | wc -l"))
least = S_min
most = S_max
if (rings > 0) {
    stats "rings.csv" using (log10($2)) nooutput name "R"
    least = R_min < least ? R_min : least
    most = R_max > most ? R_max : most
}

do for [kind in "png svg"] {
    eval(open_figure(kind, "psd", 900, 700))
    set title title_text noenhanced
    set lmargin at screen 0.13
    set rmargin at screen 0.96
    set bmargin at screen 0.25
    set tmargin at screen 0.9
    set logscale xy
    set format x "10^{%L}"
    set format y "10^{%L}"
    set xlabel "wave number (rad/µm)"
    set ylabel "PSD (nm^4)" offset 1, 0
    # To the decades about them, with room for the errors.
    set xrange [10**floor(ZETA_min):10**ceil(ZETA_max + 0.01)]
    set yrange [10**floor(least - 0.1):10**ceil(most + 0.3)]
    set key at screen 0.12, 0.11 left top Left reverse
    asked = sprintf("asked for: heights %.3g nm, slopes %.3g, curvatures %.3g/µm (rms)", \
                    rms, slope, curvature)
    if (rings > 0) {
        plot "rings.csv" using 1:2:($2*(1 - ($3 < 0.9 ? $3 : 0.9))):($2*(1 + $3)) with yerrorbars \
                 pt 7 ps 0.6*dot lc rgb unloading_colour \
                 title "a piece of surface, rings, 1 standard error", \
             "psd.csv" using 1:2 with lines lw 2 lc rgb loading_colour title asked
    } else {
        plot "psd.csv" using 1:2 with lines lw 2 lc rgb loading_colour title asked
    }
    set output
}
