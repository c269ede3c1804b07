/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The linear solver: a symmetric factorization with a fixed pivot order, by KLU or by a band solver
 * of our own (band.h). Private to the room. */
#ifndef HAFT_SOLVE_FACTOR_H
#define HAFT_SOLVE_FACTOR_H

#include "haft/base.h"

typedef struct haft_factor haft_factor;

/* The band solver takes matrices of beams alone; for another pattern it is KLU. */
typedef enum haft_factor_kind { HAFT_FACTOR_KLU, HAFT_FACTOR_BAND } haft_factor_kind;

/* Analyses the pattern once; `values` must be positive definite. The pivots are the diagonal's, in
 * their own order. */
haft_status haft_factor_create(haft_factor **out, haft_factor_kind kind, size_t n,
                               const int *column, const int *row, const double *values,
                               haft_error *error);
void haft_factor_destroy(haft_factor **factor);

/* From the next update on, factors and solves the leading n x n block, the other unknowns being
 * frozen; n of all unknowns ends that. @return false, and nothing changes, where the solver cannot.
 */
bool haft_factor_use_leading(haft_factor *factor, size_t n);

/* Refactors. @return false if a pivot vanished or is not finite. */
bool haft_factor_update(haft_factor *factor, const double *values);

/* Refactors and solves for one right-hand side in place; the band solver does both in one pass.
 * @return false if a pivot vanished or is not finite: then b holds nothing of use. */
bool haft_factor_update_solve(haft_factor *factor, const double *values, double *b);

/* Solves in place for `columns` right-hand sides of length n, one after the other; several together
 * cost little more than one. */
void haft_factor_solve(haft_factor *factor, double *b, int columns);

/* Signs of the pivots of the symmetric L D L': by Sylvester's law, those of the eigenvalues. */
typedef struct haft_inertia {
    int negative;
    double least_pivot; /* smallest |pivot| over the largest, negative if any pivot is */
} haft_inertia;
haft_inertia haft_factor_inertia(const haft_factor *factor);

#endif
