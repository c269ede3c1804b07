# SPDX-License-Identifier: GPL-3.0-or-later
# The beam's heights above the substrate: in loading, in unloading, at rest, and where it lies on.
load "style.gp"
load "shapes_data.gp"
if (coloured) { eval(shapes_colours) }

do for [kind in "png svg"] {
    eval(open_figure(kind, "shapes", 1500, 1080))
    set key on
    set multiplot title title_text noenhanced
    set ylabel "height above the substrate (µm)" offset 1, 0
    set xlabel "position along the beam (µm)"
    set yrange [-0.04*gap:1.58*gap]

    set lmargin at screen 0.07
    set rmargin at screen 0.445
    set bmargin at screen 0.59
    set tmargin at screen 0.90
    set xrange [0:beam_length]
    set title sprintf("(a) loading, up to %.3g µN", load_max)
    unset colorbox
    eval(mark_load)
    eval("plot ".shapes_plot(0).", ".shapes_keys(0))

    set lmargin at screen 0.525
    set rmargin at screen 0.885
    if (stuck) { set xrange [0:shapes_wide] }
    set title "(b) unloading to zero"
    if (coloured) { eval(show_bar) }
    eval("plot ".shapes_plot(1).", ".shapes_keys(1))
    unset colorbox
    unset arrow
    unset label

    set lmargin at screen 0.07
    set rmargin at screen 0.445
    set bmargin at screen 0.085
    set tmargin at screen 0.43
    set xrange [0:beam_length]
    unset key
    set yrange [-0.04*gap:1.22*gap]
    set title stuck ? sprintf("(c) at rest: stuck, crack length %.1f µm", rest_crack) : "(c) at rest: free"
    if (stuck) {
        set arrow 1 from 0, 1.1*gap to rest_crack, 1.1*gap heads filled size screen 0.008,20 lc rgb ink lw 1
        set arrow 2 from rest_crack, 1.15*gap to rest_crack, 0 nohead lc rgb ink lw 0.8 dt (2,3)
    }
    plot "shapes.csv" every ::rest_first::rest_last using 4:5:(0) with filledcurves fc rgb "#eeeeee" notitle, \
         "" every ::rest_first::rest_last using 4:5 with lines lw 2.6 lc rgb loading_colour notitle
    unset arrow

    if (stuck) {
        set lmargin at screen 0.525
        set rmargin at screen 0.885
        near = rest_crack - 40 > 0 ? rest_crack - 40 : 0
        far = rest_crack + 110 < beam_length ? rest_crack + 110 : beam_length
        set xrange [near:far]
        set yrange [0:nm_top]
        set ylabel "height above the substrate (nm)"
        set title "(d) at rest: where it lies on the asperities"
        set arrow 2 from rest_crack, graph 0 to rest_crack, graph 1 nohead lc rgb ink lw 0.8 dt (2,3)
        set label 2 " end of the crack" at rest_crack, graph 0.95 left
        plot "shapes.csv" every ::rest_first::rest_last using 4:($5*1e3) with lines lw 2.6 lc rgb loading_colour notitle
        unset arrow
        unset label
    }
    unset multiplot
    set output
}
