# SPDX-License-Identifier: GPL-3.0-or-later
# Cases beside each other: the distributions of their crack lengths, and their means.
load "style.gp"

# Labels are folders' names: one a line, without spaces, shown as they are.
labels = system("printenv HAFT_LABELS")
label_of(i) = strlen(word(labels, i + 1)) > 36 ? "...".word(labels, i + 1)[strlen(word(labels, i + 1)) - 32:*] : word(labels, i + 1)
# compare.csv: case, beams, stuck, free, mean, low, high, deviation [um], ...
# distributions.csv: case, crack length [um], share
stats "compare.csv" using 5:6 nooutput name "M"
stats "distributions.csv" using 2 nooutput name "L"
known = L_records > 0
pad = known && L_max > L_min ? 0.05*(L_max - L_min) : 1
shade(i) = cases > 1 ? i/(cases - 1.0) : 0
dash_of(i) = i % 2 + 1
key_rows = (cases + 1)/2
height = 640 + 30*key_rows
foot = (105.0 + 30*key_rows)/height

do for [kind in "png svg"] {
    eval(open_figure(kind, "compare", 1400, height))
    set multiplot layout 1,2 title title_text noenhanced margins 0.075, 0.97, foot, 0.87 spacing 0.11, 0
    eval(set_line_palette)
    set cbrange [0:1]
    unset colorbox
    set xlabel "crack length at rest (µm)"
    set ylabel "share of the beams" offset 1, 0
    set yrange [0:1]
    set key at screen 0.5, 0.015 center bottom Left reverse maxrows key_rows width 2
    set title "distributions"
    if (known) {
        set xrange [L_min - pad:L_max + pad]
        plot for [i=0:cases-1] "distributions.csv" using ($1 == i ? $2 : NaN):3 with steps lw 2.4 \
            dt dash_of(i) lc palette frac shade(i) title sprintf("%d  %s", i, label_of(i))
    } else {
        set xrange [0:1]
        set label 9 "no beam stuck" at graph 0.5, 0.5 center
        plot for [i=0:cases-1] NaN with lines lw 2.4 title sprintf("%d  %s", i, label_of(i))
        unset label 9
    }
    unset key
    set title sprintf("means and their %.4g %% intervals", 100*confidence)
    set xlabel "case (number in the key)"
    set ylabel "mean crack length at rest (µm)" offset 1, 0
    set xrange [-0.5:cases - 0.5]
    set xtics 1
    set autoscale y
    if (!known) { set yrange [0:1] }
    plot "compare.csv" using 1:5:6:7 with yerrorbars pt 7 ps 1.2*dot lw 1.6 lc rgb pale notitle, \
         "" using 1:5 with points pt 7 ps 1.2*dot lc rgb loading_colour notitle
    unset multiplot
    set output
    set xtics autofreq
}
