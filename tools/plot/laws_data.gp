# SPDX-License-Identifier: GPL-3.0-or-later
# The force laws for laws.gp and overview.gp: their ranges, the plot as a string `laws_plot`, and
# the four numbers of the law that is explained.
# vectors.csv: site, Morse, e [mJ/m2], f_max [MPa], d_max [nm], d_limit [nm], f_limit [MPa]
# laws.csv: distance [nm], then curve and law [MPa] of each
stats "vectors.csv" using 1 nooutput name "V"
n = V_records
law_lowest = 0
law_left = 1e9
law_right = 0
law_reach = 0
do for [k=1:n] {
    # From where a curve has come down to 1.5 times its well, to where its pull has died away.
    stats "laws.csv" using (column(2*k)) nooutput name "C"
    law_lowest = C_min < law_lowest ? C_min : law_lowest
    well = C_min < 0 ? -C_min : C_max
    stats "laws.csv" using (column(2*k) < 1.5*well ? $1 : NaN) nooutput name "W"
    law_left = W_min < law_left ? W_min : law_left
    stats "laws.csv" using (abs(column(2*k)) > 0.01*well ? $1 : NaN) nooutput name "R"
    law_reach = R_max > law_reach ? R_max : law_reach
}
if (law_lowest == 0) {
    stats "laws.csv" using 2 nooutput name "C"
    law_lowest = -0.5*C_max
}
law_left = law_left - 0.06*(law_reach - law_left)
law_right = law_reach + 0.04*(law_reach - law_left)
law_bottom = 1.25*law_lowest
law_top = -1.35*law_lowest

# The law that is explained: the first that is a Morse law.
shown = 0
do for [k=n:1:-1] {
    stats "vectors.csv" using 2 every ::(k-1)::(k-1) nooutput name "M"
    if (M_min == 1) { shown = k }
}
if (shown > 0) {
    stats "vectors.csv" using 3 every ::(shown-1)::(shown-1) nooutput name "E"
    stats "vectors.csv" using 4 every ::(shown-1)::(shown-1) nooutput name "F"
    stats "vectors.csv" using 5 every ::(shown-1)::(shown-1) nooutput name "DM"
    stats "vectors.csv" using 6 every ::(shown-1)::(shown-1) nooutput name "DL"
    stats "vectors.csv" using 7 every ::(shown-1)::(shown-1) nooutput name "FL"
    e = E_min; f_max = F_min; d_max = DM_min; d_limit = DL_min; f_limit = FL_min
}
# Colours only keep neighbours apart.
share(k) = n > 1 ? (k - 1.0)/(n - 1) : 0.3
laws_setup = "eval(set_line_palette); set cbrange [0:1]; unset colorbox; set xlabel 'distance (nm)'; set ylabel 'pressure (MPa), positive pushing apart'; set xrange [law_left:law_right]; set yrange [law_bottom:law_top]"
laws_plot = "0 with lines lc rgb ink lw 0.8 notitle, for [k=1:n] 'laws.csv' using 1:(column(2*k)) with lines lw 1.3 lc palette frac share(k) notitle, for [k=1:n] 'laws.csv' using 1:(column(2*k+1)) with lines lw 1.5 dt (5,4) lc palette frac share(k) notitle, NaN with lines lw 1.3 lc rgb ink title 'curve computed from the surface', NaN with lines lw 1.5 dt (5,4) lc rgb ink title 'law the solver uses'"
