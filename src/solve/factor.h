/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Symmetric factorization with a fixed pivot order, private to the room: by KLU, or, where the
 * matrix is as narrow as a beam's, by a solver of its own in a quarter of the time (narrow.h). */
#ifndef HAFT_SOLVE_FACTOR_H
#define HAFT_SOLVE_FACTOR_H

#include "haft/base.h"

typedef struct haft_factor haft_factor;

/* Which solver: KLU, or that for narrow matrices where the pattern is one, else KLU. */
typedef enum haft_factor_kind { HAFT_FACTOR_KLU, HAFT_FACTOR_NARROW } haft_factor_kind;

/* Analyses the pattern once; `values` must be positive definite. The pivots are the diagonal's, in
 * their own order. */
haft_status haft_factor_create(haft_factor **out, haft_factor_kind kind, size_t n,
                               const int *column, const int *row, const double *values,
                               haft_error *error);
void haft_factor_destroy(haft_factor **factor);

/* From the next update on, factors and solves for the leading n unknowns alone, others being held;
 * n of all of them ends that. @return false, and nothing changes, where the solver cannot: there
 * are fewer, or n is less than its least. */
bool haft_factor_lead(haft_factor *factor, size_t n);

/* Refactors. @return false if a pivot vanished or is not finite. */
bool haft_factor_update(haft_factor *factor, const double *values);

/* The same, and solves for one right-hand side in place; of a narrow matrix that costs less than to
 * do so after it.
 * @return false if a pivot vanished or is not finite: then b holds nothing of use. */
bool haft_factor_update_solve(haft_factor *factor, const double *values, double *b);

/* Solves in place for `columns` right-hand sides of length n, one after the other; up to four
 * together cost KLU little more than one. */
void haft_factor_solve(haft_factor *factor, double *b, int columns);

/* Signs of the pivots of the symmetric L D L': by Sylvester's law, those of the eigenvalues. */
typedef struct haft_inertia {
    int negative;
    double least_pivot; /* smallest |pivot| over the largest, negative if any pivot is */
} haft_inertia;
haft_inertia haft_factor_inertia(const haft_factor *factor);

#endif
