/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The autocorrelation of a map with holes (private to the room). */
#ifndef HAFT_SURFACE_AUTOCORRELATION_H
#define HAFT_SURFACE_AUTOCORRELATION_H

#include "haft/surface_map.h"

/* The sum over pairs of pixels of (z - mean)(z' - mean), and how many pairs there are, for each
 * lag: twice the map's rows x twice its columns, a negative lag counted from the end. */
haft_status haft_surface_autocorrelate(double *sum, double *pairs, const haft_map *map, double mean,
                                       haft_error *error);

#endif
