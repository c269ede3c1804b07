/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Window functions, and means of windowed spectra over rings of wave vectors. */
#ifndef HAFT_SURFACE_SPECTRUM_H
#define HAFT_SURFACE_SPECTRUM_H

#include "haft/surface_map.h"

typedef struct haft_rings {
    size_t n;
    double *edge;              /* n + 1 */
    double *weight, *zeta, *s; /* weighted sums over modes of 1, zeta and s */
} haft_rings;

/* The window at pixel i of n. */
double haft_window_value(haft_window window, size_t i, size_t n);

/* Makes rings from half of `width`, the largest mode spacing, to the highest wave number `most`. */
haft_status haft_rings_create(haft_rings *rings, double width, double most, haft_error *error);

void haft_rings_destroy(haft_rings *rings);

/* Adds the modes up to `most` of a map without missing pixels, each with weight `known`. */
haft_status haft_rings_enter(haft_rings *rings, const haft_map *map, haft_window window,
                             double most, double known, haft_error *error);

/* The ring means as a table; rings without power are left out. */
haft_status haft_rings_to_table(haft_psd_table **out, const haft_rings *rings, haft_error *error);

#endif
