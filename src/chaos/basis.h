/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Three-term recurrence of the germs' orthonormal polynomials (private to the room):
 * x psi_k = b_(k+1) psi_(k+1) + a psi_k + b_k psi_(k-1). */
#ifndef HAFT_CHAOS_BASIS_H
#define HAFT_CHAOS_BASIS_H

#include "haft/chaos.h"

typedef struct chaos_recurrence {
    double a;
    double b[HAFT_CHAOS_POINTS_LIMIT + 1]; /* b[0] is 0 */
} chaos_recurrence;

void haft_chaos_recurrence(haft_chaos_germ germ, chaos_recurrence *out);

/* psi[0 .. order], order at most HAFT_CHAOS_POINTS_LIMIT. */
void haft_chaos_recur(const chaos_recurrence *recurrence, size_t order, double x, double *psi);

/* points^(i + 1). */
size_t haft_chaos_grid_size(size_t points, size_t i);

#endif
