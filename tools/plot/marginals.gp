# SPDX-License-Identifier: GPL-3.0-or-later
# Densities of the law vectors' four numbers: of the patches, and of what the model's expansion draws
# (Fig. 18 of Hoang et al.). marginals.csv: number 0 to 3, value, vectors, drawn [1/unit of the value]
load "style.gp"
names = "'energy e (mJ/m²)' 'greatest pull f_{max} (MPa)' 'its distance d_{max} (nm)' 'limit distance d_{limit} (nm)'"
units = "'m²/mJ' '1/MPa' '1/nm' '1/nm'"
do for [kind in "png svg"] {
    eval(open_figure(kind, "marginals", 1400, 980))
    set multiplot layout 2,2 title title_text noenhanced margins 0.075, 0.985, 0.15, 0.92 spacing 0.1, 0.12
    set style fill solid noborder
    set key at screen 0.53, 0.03 center horizontal Left reverse width 2
    do for [i=0:3] {
        stats "marginals.csv" using ($1 == i ? $2 : NaN) nooutput name "X"
        set xrange [X_min:X_max]
        set yrange [0:*]
        set xlabel word(names, i + 1) enhanced
        set ylabel "density (".word(units, i + 1).")" offset 1, 0
        plot "marginals.csv" using ($1 == i ? $2 : NaN):3:((X_max - X_min)/39) with boxes lc rgb shade_colour title "patches", \
             "marginals.csv" using ($1 == i ? $2 : NaN):4 with lines lw 2.2 lc rgb loading_colour title "drawn from the expansion"
        unset key
    }
    unset multiplot
    set output
}
