/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Block L D L' of a block-tridiagonal matrix, which a beam's is. Private to the room. */
#ifndef HAFT_SOLVE_BAND_H
#define HAFT_SOLVE_BAND_H

#include "factor.h"

typedef struct haft_band haft_band;

/* For a symmetric pattern in compressed columns, rows sorted. *out stays NULL, with HAFT_OK, where
 * the pattern is not a beam's: two unknowns a node, each node coupled to its neighbours alone. */
haft_status haft_band_create(haft_band **out, size_t n, const int *column, const int *row,
                             haft_error *error);
void haft_band_destroy(haft_band **band);

/* From the next update on the matrix is its leading n x n block, n not above what it was made for.
 * @return false, and nothing changes, if n is odd or 0. */
bool haft_band_use_leading(haft_band *band, size_t n);

/* Factors, and with b solves for one right-hand side in place; b may be NULL.
 * @return false if a pivot vanished or is not finite: then b holds nothing of use. */
bool haft_band_update(haft_band *band, const double *values, double *b);

/* Solves in place for `columns` right-hand sides of length n, one after the other. */
void haft_band_solve(haft_band *band, double *b, int columns);

haft_inertia haft_band_inertia(const haft_band *band);

#endif
