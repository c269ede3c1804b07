# SPDX-License-Identifier: GPL-3.0-or-later
# What the figures share: fonts, colours that keep their order in grey, the two terminals. Found
# through GNUPLOT_LIB; the current directory is the folder of the CSV files.
set encoding utf8
set datafile separator ","
set datafile columnheaders

# The case's title is someone's free text: never evaluated, never enhanced.
title_text = system("printenv HAFT_TITLE")
if (strlen(title_text) > 100) { title_text = title_text[1:97]."..." }

# Where figures are drawn before they are checked and put in their place; here, if nobody checks.
if (!exists("draft")) { draft = "" }

open_png(name, w, h) = sprintf("set terminal pngcairo enhanced butt size %d,%d background 'white' font 'DejaVu Sans,15' linewidth 1.6 dashlength 1.6; set output '%s%s.png'", w, h, draft, name)
open_svg(name, w, h) = sprintf("set terminal svg enhanced butt size %d,%d dynamic background 'white' font 'DejaVu Sans,18' linewidth 1.6 dashlength 1.6; set output '%s%s.svg'", w, h, draft, name)
# The SVG terminal draws points larger and sets labels further out.
open_figure(kind, name, w, h) = kind eq "svg" ? open_svg(name, w, h)."; dot = 0.6; drop = 0.7; set xlabel offset 0, drop; set xtics offset 0, 0.2" : open_png(name, w, h)."; dot = 1; drop = 0; set xlabel offset 0, drop; set xtics offset 0, 0"
dot = 1
drop = 0

ink = "#222222"
pale = "#9a9a9a"
loading_colour = "#1f3b73"
unloading_colour = "#e8862e"
shade_colour = "#f3c99a"

set border 3 lc rgb ink lw 0.8
set tics nomirror out scale 0.6
set grid lc rgb "#dddddd" lt 1 lw 0.5
set key noenhanced samplen 2.5 spacing 1.25

# Viridis (Smith and van der Walt, 2015), evenly lightening. Lines on white use its darker part.
set palette defined (0 "#440154", 1 "#472d7b", 2 "#3b528b", 3 "#2c728e", 4 "#21918c", \
                     5 "#28ae80", 6 "#5ec962", 7 "#addc30", 8 "#fde725")
set_line_palette = "set palette defined (0 '#440154', 1 '#472d7b', 2 '#3b528b', 3 '#2c728e', 4 '#21918c', 5 '#28ae80', 6 '#5ec962')"
