/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sparse symmetric factorization by KLU with a fixed symmetric pivot order, private to the room. */
#ifndef HAFT_SOLVE_FACTOR_H
#define HAFT_SOLVE_FACTOR_H

#include "haft/base.h"

typedef struct haft_factor haft_factor;

/* Analyses the pattern once (AMD, no block form) and fixes the pivot order, the diagonal, on
 * `values`, which must be positive definite. */
haft_status haft_factor_create(haft_factor **out, size_t n, const int *column, const int *row,
                               const double *values, haft_error *error);
void haft_factor_destroy(haft_factor **factor);

/* Refactors with the order kept. @return false if a pivot vanished or is not finite. */
bool haft_factor_update(haft_factor *factor, const double *values);

/* Solves in place for `columns` right-hand sides of length n, one after the other. */
void haft_factor_solve(haft_factor *factor, double *b, int columns);

/* How often that was done; up to four columns together cost little more than one. */
size_t haft_factor_solves(const haft_factor *factor);

/* Signs of the pivots of the symmetric L D L': by Sylvester's law, those of the eigenvalues. */
typedef struct haft_inertia {
    int negative;
    double least_pivot; /* smallest |pivot| over the largest, negative if any pivot is */
} haft_inertia;
haft_inertia haft_factor_inertia(const haft_factor *factor);

#endif
