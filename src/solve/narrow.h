/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Symmetric factorization of matrices as narrow as a beam's, private to the room. */
#ifndef HAFT_SOLVE_NARROW_H
#define HAFT_SOLVE_NARROW_H

#include "factor.h"

typedef struct haft_narrow haft_narrow;

/* For a symmetric pattern in compressed columns, rows sorted. *out stays NULL, with HAFT_OK, where
 * an entry lies further than 3 off the diagonal or the matrix is too small to gain by it. */
haft_status haft_narrow_create(haft_narrow **out, size_t n, const int *column, const int *row,
                               haft_error *error);
void haft_narrow_destroy(haft_narrow **narrow);

/* From the next update on the matrix is that of the leading n unknowns alone, of those it was made
 * for. @return false, and nothing changes, where they are too few to gain by it. */
bool haft_narrow_lead(haft_narrow *narrow, size_t n);

/* Factors without pivoting. @return false if a pivot vanished or is not finite. */
bool haft_narrow_update(haft_narrow *narrow, const double *values);

/* The same, and solves for one right-hand side in place: going forward through it costs nothing,
 * since the factorization waits for its divisions. */
bool haft_narrow_update_solve(haft_narrow *narrow, const double *values, double *b);

/* Solves in place for one right-hand side. */
void haft_narrow_solve(haft_narrow *narrow, double *b);

haft_inertia haft_narrow_inertia(const haft_narrow *narrow);

#endif
