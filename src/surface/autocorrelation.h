/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The autocorrelation of a map with missing pixels (private to the room). */
#ifndef HAFT_SURFACE_AUTOCORRELATION_H
#define HAFT_SURFACE_AUTOCORRELATION_H

#include "haft/surface_map.h"

/* For each lag, the sum of (z - mean)(z' - mean) over pairs of pixels, and the number of pairs.
 * Both arrays are twice the map's rows x twice its columns; negative lags count from the end. */
haft_status haft_surface_autocorrelate(double *sum, double *pairs, const haft_map *map, double mean,
                                       haft_error *error);

#endif
