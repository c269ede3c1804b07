# SPDX-License-Identifier: GPL-3.0-or-later
# The states for shapes.gp and overview.gp. shapes.csv: phase, state, crack length [um], x [um],
# height [um], load [uN], 1 just before and 2 just after the phase's greatest jump, else 0; a state
# is as many rows as there are up to x = beam length.
stats "shapes.csv" using ($1 == 0 ? $2 : NaN) nooutput name "SL"
stats "shapes.csv" using ($1 == 1 ? $2 : NaN) nooutput name "SU"
stats "shapes.csv" using 4 nooutput name "X"
stats "shapes.csv" using 6 nooutput name "Q"
load_max = Q_max
states_0 = SL_max + 1
states_1 = SU_max + 1
rows = X_records/(states_0 + states_1)
rest_first = X_records - rows
rest_last = X_records - 1
stats "shapes.csv" every ::rest_last::rest_last using 3 nooutput name "RC"
rest_crack = RC_min
stuck = rest_crack < 0.999*beam_length

# Colours tell the crack length of the states that stick; the others are grey.
sticks(crack) = crack < 0.9*beam_length
stats "shapes.csv" using (sticks($3) ? $3 : 0) nooutput name "ST"
coloured = ST_max > 0
if (coloured) { stats "shapes.csv" using (sticks($3) ? $3 : NaN) nooutput name "SC" }
set cbrange [0:1]
shapes_colours = "eval(set_line_palette); set cbrange [SC_min : SC_max > SC_min ? SC_max : SC_min + 1]"
shapes_wide = coloured ? 1.3*SC_max : beam_length
shapes_wide = shapes_wide < beam_length ? shapes_wide : beam_length
nm_top = 100
if (stuck) {
    stats "shapes.csv" every ::rest_first::rest_last using ($4 >= rest_crack ? $5*1e3 : NaN) nooutput name "H"
    nm_top = 6*abs(H_median) + 1e-3
}

# One line a state: the row at the clamp, where nothing happens, is left out to break the line.
of(phase, want) = sprintf("using ($1 == %d && $4 > 0 && (%s) ? $4 : NaN):5", phase, want)
shapes_plot(phase) = "'shapes.csv' ".of(phase, "!sticks($3)")." with lines lw 0.9 lc rgb pale notitle, 'shapes.csv' ".of(phase, "sticks($3)").":3 with lines lw 1.3 lc palette notitle, 'shapes.csv' ".of(phase, "$7 == 1")." with lines lw 2.2 dt (7,5) lc rgb ink notitle, 'shapes.csv' ".of(phase, "$7 == 2")." with lines lw 2.2 lc rgb ink notitle"
stats "shapes.csv" using ($1 == 0 && $7 > 0) nooutput name "GL"
stats "shapes.csv" using ($1 == 1 && $7 > 0) nooutput name "GU"
stats "shapes.csv" using ($1 == 0 && !sticks($3)) nooutput name "NL"
stats "shapes.csv" using ($1 == 1 && !sticks($3)) nooutput name "NU"
marked(phase) = (phase == 0 ? GL_max : GU_max) > 0
loose(phase) = (phase == 0 ? NL_max : NU_max) > 0
shapes_keys(phase) = "NaN notitle".(loose(phase) ? ", NaN with lines lw 0.9 lc rgb pale title '".(phase == 0 ? "not yet stuck" : "no longer stuck")."'" : "").(marked(phase) ? ", NaN with lines lw 2.2 dt (7,5) lc rgb ink title 'before the greatest jump', NaN with lines lw 2.2 lc rgb ink title 'after it'" : "")

mark_load = "set arrow 1 from load_position, 1.30*gap to load_position, 1.04*gap head filled size screen 0.008,20 lc rgb ink lw 1.6; set label 1 'load' at load_position, 1.22*gap left offset 0.8, 0"
show_bar = "set colorbox user origin screen 0.905, screen 0.59 size screen 0.014, screen 0.31; set cblabel 'crack length (µm)'"
