# SPDX-License-Identifier: GPL-3.0-or-later
# Crack lengths at rest of all beams that stuck: each a dot on their empirical distribution, with
# the mean, the standard deviation and what is known from elsewhere.
load "style.gp"
load "cracks_data.gp"

do for [kind in "png svg"] {
    eval(open_figure(kind, "cracks", 1300, 900))
    set title title_text."\n".count_text noenhanced
    set lmargin at screen 0.085
    set rmargin at screen 0.97
    set bmargin at screen 0.21
    set tmargin at screen 0.9
    set key at screen 0.53, 0.068 center Left reverse maxrows 3 width 2
    eval(cracks_setup)
    eval("plot ".cracks_plot)
    set output
}
