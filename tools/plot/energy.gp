# SPDX-License-Identifier: GPL-3.0-or-later
# Strain energy against crack length in loading and unloading, each jump from its fold to where it
# lands; the way before the beam sticks in an inset.
load "style.gp"
load "energy_data.gp"

do for [kind in "png svg"] {
    eval(open_figure(kind, "energy", 1400, 900))
    small = kind eq "svg" ? ",15" : ",13"
    set multiplot
    set title title_text noenhanced
    set xlabel "crack length (µm)"
    set ylabel "strain energy (pJ)"
    set xrange [left:right]
    set yrange [-0.02*top:top]
    set lmargin at screen 0.085
    set rmargin at screen 0.975
    set bmargin at screen 0.20
    set tmargin at screen 0.93
    set key at screen 0.53, 0.06 center Left reverse maxrows 2 width 2
    eval("plot ".path_plot.", ".path_keys)
    if (apart) {
        set lmargin at screen 0.55
        set rmargin at screen 0.955
        set bmargin at screen 0.52
        set tmargin at screen 0.87
        unset key
        wide = 3
        set title "the whole way, from the free beam" font small offset 0, -0.6
        set xlabel font small offset 0, drop + 0.4
        set ylabel font small offset 0.8, 0
        set tics font small
        set xrange [0:1.03*PX_max]
        eval("plot ".path_plot)
        set xlabel font "" offset 0, drop
        set ylabel font "" offset 0, 0
        set title font "" offset 0, 0
        set tics font ""
    }
    wide = 5
    unset multiplot
    set output
}
