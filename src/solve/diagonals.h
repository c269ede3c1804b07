/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Products with a matrix that has few diagonals, private to the room. */
#ifndef HAFT_SOLVE_DIAGONALS_H
#define HAFT_SOLVE_DIAGONALS_H

#include "haft/base.h"

typedef struct haft_diagonals haft_diagonals;

/* The matrix in compressed columns, n by n; symmetric, so that its columns are its rows. */
haft_status haft_diagonals_create(haft_diagonals **out, size_t n, const int *column, const int *row,
                                  const double *values, haft_error *error);
void haft_diagonals_destroy(haft_diagonals **diagonals);

/* out = factor * A x - less, A the leading n rows and columns of the matrix, `less` NULL for nil;
 * `out` is neither of them. Thread-safe. */
void haft_diagonals_multiply(const haft_diagonals *diagonals, size_t n, double factor,
                             const double *x, const double *less, double *restrict out);

#endif
