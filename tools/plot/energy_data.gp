# SPDX-License-Identifier: GPL-3.0-or-later
# The strain energy's path for energy.gp and overview.gp: its ranges, and the plot as a string
# `path_plot`. energy.csv: phase, jump that led here or -1, load, crack length [um], energy [pJ];
# jumps.csv: phase, pull-out, load, crack before, after [um], energy before, after [pJ], dissipated
stats "energy.csv" using 4 nooutput name "PX"
stats "energy.csv" using 5 nooutput name "PY"
stats "energy.csv" using ($1 == 0 ? $5 : NaN) nooutput name "L"
stats "energy.csv" using ($4 < 0.9*beam_length ? $4 : 0) nooutput name "C"
jumps = int(system("wc -l < jumps.csv")) - 1
if (jumps > 0) { stats "jumps.csv" using ($2 == 0) nooutput name "J" }
pull_ins = jumps > 0 ? int(J_sum) : 0
turn = L_records - 1
touched = C_max > 0
wide = 5

# Where it touches hardly anywhere the crack is as long as the beam; that part goes to an inset.
left = PX_min
right = touched ? C_max : PX_max
apart = touched && PX_max > 1.3*right
right = apart ? right : PX_max
pad = right > left ? 0.05*(right - left) : 0.05*right
left = left - pad
right = right + pad
top = PY_max > 0 ? 1.06*PY_max : 1

# Each branch is a line of its own, so that no line runs across a jump.
b = 0
branch(j) = (b = b + (j >= 0), b)
path_plot = "for [k=0:jumps] b=0 'energy.csv' using (branch($2) == k && $1 == 0 ? $4 : NaN):5 with lines lw wide lc rgb loading_colour notitle, for [k=0:jumps] b=0 'energy.csv' using (branch($2) == k && $0 >= turn ? $4 : NaN):5 with lines lw 2 lc rgb unloading_colour notitle"
path_keys = "NaN with lines lw wide lc rgb loading_colour title 'loading', NaN with lines lw 2 lc rgb unloading_colour title 'unloading'"
in_plot = "'jumps.csv' using ($2 == 0 ? $4 : NaN):6:($5-$4):($7-$6) with vectors nohead lw 1.1 dt (6,4) lc rgb ink notitle, 'jumps.csv' using ($2 == 0 ? $5 : NaN):7 with points pt 7 ps 0.95*dot lc rgb ink notitle"
out_plot = "'jumps.csv' using ($2 == 1 ? $4 : NaN):6:($5-$4):($7-$6) with vectors nohead lw 1.1 dt (6,4) lc rgb ink notitle, 'jumps.csv' using ($2 == 1 ? $5 : NaN):7 with points pt 7 ps 1.1*dot lc rgb 'white' notitle, '' using ($2 == 1 ? $5 : NaN):7 with points pt 6 ps 1.1*dot lc rgb ink notitle"
if (pull_ins > 0) {
    path_plot = path_plot.", ".in_plot
    path_keys = path_keys.", NaN with linespoints dt (4,3) lw 1.1 pt 7 ps 0.95*dot lc rgb ink title sprintf('pull-in and where it lands (%d)', pull_ins)"
}
if (jumps > pull_ins) {
    path_plot = path_plot.", ".out_plot
    path_keys = path_keys.", NaN with linespoints dt (4,3) lw 1.1 pt 6 ps 1.1*dot lc rgb ink title sprintf('pull-out and where it lands (%d)', jumps - pull_ins)"
}
