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

/* Factors without pivoting. @return false if a pivot vanished or is not finite. */
bool haft_narrow_update(haft_narrow *narrow, const double *values);

/* Solves in place for one right-hand side. */
void haft_narrow_solve(haft_narrow *narrow, double *b);

haft_inertia haft_narrow_inertia(const haft_narrow *narrow);

#endif
