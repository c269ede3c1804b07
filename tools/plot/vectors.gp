# SPDX-License-Identifier: GPL-3.0-or-later
# How the model settles with the number of vectors it is built from (Fig. B.22 of Hoang et al.).
# density.csv: eta_1, then its kernel density from the first m vectors, a column each m
# parts.csv: vectors, parts, relMISE of the expansion, of the densities of eta_1 .. 4, their errors,
# Wasserstein-1 distances of the expansion's eta_1 .. 4 [standard deviations]
load "style.gp"
curves = int(system("head -1 density.csv | tr ',' '\\n' | wc -l")) - 1
label(k) = system(sprintf("head -1 density.csv | cut -d, -f%d", 1 + k))
rows = int(system("wc -l < parts.csv")) - 1
stats "parts.csv" using 1 nooutput name "M"
share(k) = curves > 1 ? (k - 1.0)/(curves - 1) : 0
greek = "η₁ η₂ η₃ η₄"
colours = "#1f3b73 #e8862e #21918c #8a2f6b"
shapes = "7 5 9 13"
known(j) = system(sprintf("tail -1 parts.csv | cut -d, -f%d", 3 + j)) ne "nan"
components = known(4) ? 4 : known(3) ? 3 : known(2) ? 2 : 1

do for [kind in "png svg"] {
    eval(open_figure(kind, "vectors", 1500, 780))
    set multiplot layout 1,2 title title_text noenhanced margins 0.075, 0.985, 0.3, 0.86 spacing 0.09, 0
    eval(set_line_palette)
    unset colorbox
    set cbrange [0:1]
    set title "kernel density of component η_1 by the first m vectors" enhanced
    set xlabel "component η_1 (standard deviations)" enhanced
    set ylabel "density (1)" offset 1, 0
    set xrange [*:*]
    set yrange [0:*]
    set key at screen 0.28, 0.09 center Left reverse maxrows 2 width 1
    plot for [k=1:curves] "density.csv" using 1:(column(1+k)) with lines lw (k == curves ? 2.6 : 1.4) lc palette frac share(k) title label(k)
    set title "against all vectors, mean over disjoint parts of m"
    set xlabel "vectors m"
    set ylabel "relMISE (1); distance (std. dev.)" offset 1, 0
    set logscale xy
    set format y "%g"
    set xrange [M_min/1.3:M_max*1.3]
    set yrange [*:*]
    set key at screen 0.79, 0.09 center Left reverse noenhanced maxrows 3 width 0 samplen 2
    # With one part there is nothing to hold it against.
    densities = rows > 1 ? "for [j=1:components] 'parts.csv' using ($2 > 1 ? $1 : NaN):(column(3+j)):(column(7+j)) with yerrorlines lw 1.3 pt int(word(shapes, j)) ps 0.9*dot lc rgb word(colours, j) title 'density of '.word(greek, j), " : ""
    eval("plot ".densities."'parts.csv' using 1:(column(12)) with linespoints lw 1.3 dt (6,4) pt 6 ps 1.1*dot lc rgb loading_colour title 'distance of η₁ as drawn', 'parts.csv' using 1:3 with linespoints lw 1.3 dt (2,3) pt 4 ps 1.1*dot lc rgb ink title 'expansion from its map'")
    unset logscale
    set format y
    unset multiplot
    set output
}
