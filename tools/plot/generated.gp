# SPDX-License-Identifier: GPL-3.0-or-later
# Ten force laws computed from patches beside ten that the model draws (Fig. 14 of Hoang et al.).
# laws.csv: distance [nm], then curve and law [MPa] of each; generated.csv: distance, ten laws
load "style.gp"
load "laws_data.gp"
eval(laws_setup)
stats "generated.csv" using 2 nooutput name "G"
do for [k=1:10] {
    stats "generated.csv" using (column(1+k) < 1e30 ? column(1+k) : NaN) nooutput name "G"
    law_bottom = 1.25*G_min < law_bottom ? 1.25*G_min : law_bottom
}

do for [kind in "png svg"] {
    eval(open_figure(kind, "generated", 1500, 720))
    set multiplot layout 1,2 title title_text noenhanced margins 0.075, 0.985, 0.125, 0.86 spacing 0.09, 0
    unset key
    set yrange [law_bottom:law_top]
    set title sprintf("(a) curves of %d patches", n) offset 0, -0.4
    plot 0 with lines lc rgb ink lw 0.8 notitle, \
         for [k=1:n] "laws.csv" using 1:(column(2*k)) with lines lw 1.5 lc palette frac share(k) notitle
    set title "(b) ten laws drawn from the expansion" offset 0, -0.4
    plot 0 with lines lc rgb ink lw 0.8 notitle, \
         for [k=1:10] "generated.csv" using 1:(column(1+k)) with lines lw 1.5 lc palette frac (k - 1)/9.0 notitle
    unset multiplot
    set output
}
