# SPDX-License-Identifier: GPL-3.0-or-later
# Ten force laws, the curves computed from the surface and the Morse laws they became; and one of
# them with the four numbers that make it.
load "style.gp"
load "laws_data.gp"
eval(laws_setup)
# Where the Morse law's left wing reaches a push.
wall(f) = d_max - (d_max - d_limit)*log(1 + sqrt(1 + f/f_max))/log(1 + sqrt(1 + f_limit/f_max))
right_of(x) = d_max + x*(law_right - law_left)

do for [kind in "png svg"] {
    eval(open_figure(kind, "laws", 1500, 720))
    set multiplot layout 1, (shown > 0 ? 2 : 1) title title_text noenhanced margins 0.075, 0.985, 0.125, 0.86 spacing 0.09, 0
    set title sprintf("%d patch%s of the first beam", n, n == 1 ? "" : "es") offset 0, -0.4
    set key top right
    eval("plot ".laws_plot)
    if (shown > 0) {
        set title "one of them and its four numbers" offset 0, -0.4
        set key bottom right
        set label 1 sprintf("e = %.3g mJ/m²", e) at right_of(0.22), -0.58*f_max left
        set arrow 1 from right_of(0.21), -0.58*f_max to right_of(0.04), -0.35*f_max lc rgb ink lw 0.8 head filled size screen 0.008,20
        set label 2 sprintf("f_{max} = %.3g MPa", f_max) at right_of(0.22), -0.88*f_max left
        set arrow 2 from d_max, -f_max to right_of(0.21), -0.88*f_max nohead lc rgb ink lw 0.8 dt (4,4) front
        set label 3 sprintf("d_{max} = %.3g nm", d_max) at right_of(0.02), 0.35*f_max left
        set arrow 3 from d_max, -f_max to d_max, 0.4*f_max nohead lc rgb ink lw 0.8 dt (4,4) front
        # The limit push may lie far above the panel.
        above = f_limit > law_top
        y_limit = above ? 0.86*law_top : f_limit
        set label 4 sprintf("d_{limit} = %.3g nm%s\nthe push is f_{limit} = %.3g MPa", d_limit, above ? ", further up, where" : ", where", f_limit) at right_of(0.02), y_limit left
        if (above) { set arrow 4 from right_of(0.01), y_limit to wall(law_top), 0.99*law_top head filled size screen 0.008,20 lc rgb ink lw 0.8 } else { set arrow 4 from d_limit, f_limit to right_of(0.01), f_limit nohead lc rgb ink lw 0.8 dt (4,4) front }
        plot "laws.csv" using 1:(column(2*shown+1) < 0 ? column(2*shown+1) : 0):(0) with filledcurves fc rgb shade_colour notitle, \
             0 with lines lc rgb ink lw 0.8 notitle, \
             "laws.csv" using 1:(column(2*shown)) with lines lw 1.4 lc rgb "#777777" title "curve", \
             "laws.csv" using 1:(column(2*shown+1)) with lines lw 2.2 lc rgb loading_colour title "its Morse law", \
             "+" using (d_max):(-f_max) every ::0::0 with points pt 7 ps 0.9*dot lc rgb loading_colour notitle, \
             "+" using (d_limit):(f_limit) every ::0::0 with points pt 7 ps 0.9*dot lc rgb loading_colour notitle
        unset label
        unset arrow
    }
    unset multiplot
    set output
}
