# SPDX-License-Identifier: GPL-3.0-or-later
# Densities of the principal components: of the vectors, of the kernels about them, and of the
# expansions of a few orders; alone, and two together (Fig. 17 of Hoang et al.).
# components.csv: component, eta, vectors, kernels, then one column an order [1]
# joint.csv: pair, eta a, eta b, kernels, expansion of the case's order [1]
load "style.gp"
stats "components.csv" using 1 nooutput name "C"
n = int(C_max)
stats "components.csv" using 4 nooutput name "P"
orders = int(system("head -1 components.csv | tr ',' '\\n' | wc -l")) - 4
label(k) = system(sprintf("head -1 components.csv | cut -d, -f%d", 4 + k))
colours = "#c9a227 #21918c #1f3b73"
colour(k) = word(colours, 3 - orders + k)
pairs = n*(n - 1)/2
pair_a(p) = n == 2 ? 1 : n == 3 ? (p < 2 ? 1 : 2) : (p < 3 ? 1 : p < 5 ? 2 : 3)
pair_b(p) = n == 2 ? 2 : n == 3 ? (p == 0 ? 2 : 3) : (p < 3 ? p + 2 : p < 5 ? p : 4)
shown = pairs > 3 ? 3 : pairs
rows = n > 3 ? 3 : n

# The grid of a pair, column c of joint.csv in the third place, as gnuplot wants grids.
grid(p, c) = sprintf("<awk -F, 'NR == 1 { print \"a,b,p\" } $1 == %d { if (seen++ && $2 != x) print \"\"; x = $2; print $2 \",\" $3 \",\" $%d }' joint.csv", p, c)
unset key
do for [kind in "png svg"] {
    eval(open_figure(kind, "components", 1300, 430*rows + 160))
    set multiplot title title_text noenhanced
    foot = 140.0/(430*rows + 160)
    tall = (1 - foot - 0.06)/rows
    set ylabel "density (1)" offset 1, 0
    set yrange [0:*]
    do for [j=1:rows] {
        set lmargin at screen 0.085
        set rmargin at screen 0.48
        set tmargin at screen 1 - 0.06 - (j - 1)*tall - 0.01
        set bmargin at screen 1 - 0.06 - j*tall + 82.0/(430*rows + 160)
        set xlabel sprintf("component η_%d (standard deviations)", j) enhanced
        set xrange [*:*]
        if (j == rows) { set key at screen 0.28, 0.42*foot center Left reverse noenhanced maxrows 3 width 1 samplen 2 }
        plot "components.csv" using ($1 == j ? $2 : NaN):3 with points pt 7 ps 0.55*dot lc rgb pale title "vectors, counted", \
             "components.csv" using ($1 == j ? $2 : NaN):4 with lines lw 4 lc rgb shade_colour title "kernels", \
             for [k=1:orders] "components.csv" using ($1 == j ? $2 : NaN):(column(4+k)) with lines lw 1.4 dt 1 + (k == orders ? 0 : k + 1) lc rgb colour(k) title "expansion, ".label(k)
        unset key
    }
    do for [p=0:shown-1] {
        set xrange [*:*]
        set yrange [*:*]
        stats "joint.csv" using ($1 == p ? $4 : NaN) nooutput name "J"
        stats "joint.csv" using ($1 == p && $4 > 0.01*J_max ? $2 : NaN) nooutput name "A"
        stats "joint.csv" using ($1 == p && $4 > 0.01*J_max ? $3 : NaN) nooutput name "B"
        # Contours at the same densities for both.
        set contour base
        unset surface
        set cntrparam levels discrete 0.02*J_max, 0.1*J_max, 0.3*J_max, 0.6*J_max, 0.9*J_max
        set table $kernels
        from = grid(p, 4)
        splot from using 1:2:3 with lines
        unset table
        set table $expansion
        from = grid(p, 5)
        splot from using 1:2:3 with lines
        unset table
        unset contour
        set surface
        set lmargin at screen 0.565
        set rmargin at screen 0.985
        set tmargin at screen 1 - 0.06 - p*tall - 0.01
        set bmargin at screen 1 - 0.06 - (p + 1)*tall + 82.0/(430*rows + 160)
        set xlabel sprintf("component η_%d (standard deviations)", pair_a(p)) enhanced
        set ylabel sprintf("η_%d (standard deviations)", pair_b(p)) enhanced
        set xrange [A_min - 0.5:A_max + 0.5]
        set yrange [B_min - 0.5:B_max + 0.5]
        set datafile separator whitespace
        set datafile nocolumnheaders
        if (p == shown - 1) { set key at screen 0.77, 0.42*foot center Left reverse noenhanced maxrows 2 width 1 }
        plot $kernels using 1:2 with lines lw 3.5 lc rgb shade_colour title "kernels, at 2, 10, 30, 60, 90 % of their mode", \
             $expansion using 1:2 with lines lw 1.2 lc rgb loading_colour title "expansion, ".label(orders).", at the same densities"
        unset key
        set datafile separator ","
        set datafile columnheaders
    }
    unset multiplot
    set output
}
