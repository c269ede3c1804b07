/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Distances between one-dimensional distributions (private to the room). */
#ifndef HAFT_CHAOS_MARGINAL_H
#define HAFT_CHAOS_MARGINAL_H

#include "chaos/mixture.h"
#include "haft/chaos.h"

/* The distance of sorted samples x from the distribution of a line, which is tabulated. */
haft_status haft_chaos_distance_of_line(size_t n, const double *x, const chaos_line *line,
                                        haft_chaos_distance *out,
                                        haft_error *error) HAFT_MUST_CHECK;

#endif
