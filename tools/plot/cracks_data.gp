# SPDX-License-Identifier: GPL-3.0-or-later
# The crack lengths for cracks.gp and overview.gp: ranges, and the plot as a string `cracks_plot`.
band_colour = "#dfe6f2"
# summary.csv: realization, outcome (0 stuck, 1 free, others not followed to the end), crack [um]
stats "../summary.csv" using ($2 >= 0) nooutput name "A"
stats "../summary.csv" using ($2 == 0) nooutput name "B"
stats "../summary.csv" using ($2 == 1) nooutput name "F"
beams = int(A_sum)
stuck_beams = int(B_sum)
free_beams = int(F_sum)
if (stuck_beams > 0) { stats "../summary.csv" using ($2 == 0 ? $3 : NaN) nooutput name "S" }
mean = stuck_beams > 0 ? S_mean : -1
deviation = stuck_beams > 1 ? S_ssd : -1

crack_low = 1e9
crack_high = -1e9
if (stuck_beams > 0) { crack_low = S_min; crack_high = S_max }
if (paper > 0) { crack_low = paper < crack_low ? paper : crack_low; crack_high = paper > crack_high ? paper : crack_high }
if (measured > 0) { crack_low = measured < crack_low ? measured : crack_low; crack_high = measured > crack_high ? measured : crack_high }
if (crack_high < crack_low) { crack_low = 0; crack_high = beam_length }
crack_pad = crack_high > crack_low ? 0.08*(crack_high - crack_low) : 0.05*crack_high
crack_low = crack_low > crack_pad ? crack_low - crack_pad : 0
crack_high = crack_high + crack_pad

count_text = sprintf("%d of %d beams stuck", stuck_beams, beams)
if (free_beams > 0) { count_text = count_text.sprintf(", %d free", free_beams) }
if (beams - stuck_beams - free_beams > 0) { count_text = count_text.sprintf(", %d not followed to the end", beams - stuck_beams - free_beams) }

cracks_plot = "NaN notitle"
if (stuck_beams > 0) { cracks_plot = cracks_plot.", '../summary.csv' using ($2 == 0 ? $3 : NaN):(1.0) smooth cnorm with steps lw 1.2 lc rgb loading_colour notitle, '../summary.csv' using ($2 == 0 ? $3 : NaN):(1.0) smooth cnorm with points pt 7 ps 0.9*dot lc rgb loading_colour title 'each beam', '+' using (mean):(2*$0) every ::0::1 with lines lw 2.4 lc rgb loading_colour title sprintf('Haft, mean %.4g µm', mean)" }
if (deviation > 0) { cracks_plot = cracks_plot.", NaN with boxes fs solid fc rgb band_colour title sprintf('± standard deviation, %.2g µm', deviation)" }
if (paper > 0) { cracks_plot = cracks_plot.", '+' using (paper):(2*$0) every ::0::1 with lines lw 2.2 dt (7,4) lc rgb unloading_colour title sprintf('paper, mean %.4g µm', paper)" }
if (measured > 0) { cracks_plot = cracks_plot.", '+' using (measured):(2*$0) every ::0::1 with lines lw 2.4 dt (2,2) lc rgb ink title sprintf('measured, %.4g µm', measured)" }
cracks_setup = "set xlabel 'crack length at rest (µm)'; set ylabel 'cumulative share of the stuck beams'; set xrange [crack_low:crack_high]; set yrange [0:1.03]"
if (deviation > 0) { cracks_setup = cracks_setup."; set object 1 rectangle from mean - deviation, graph 0 to mean + deviation, graph 1 behind fc rgb band_colour fs solid noborder" }
if (stuck_beams == 0) { cracks_setup = cracks_setup."; set label 9 'no beam stuck: there is no crack length' at graph 0.5, 0.5 center" }
