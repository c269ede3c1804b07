/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sums of normal distribution functions, and exponentials, over arrays (private to the room). */
#ifndef HAFT_CHAOS_NORMAL_H
#define HAFT_CHAOS_NORMAL_H

#include "haft/base.h"

/* n rounded up to a multiple of the SIMD width. */
static inline size_t chaos_padded(size_t n) {
    return (n + HAFT_SIMD_WIDTH - 1) / HAFT_SIMD_WIDTH * HAFT_SIMD_WIDTH;
}

typedef struct chaos_sums {
    double cdf;    /* sum of w Phi(t) */
    double pdf;    /* sum of w phi(t) */
    double moment; /* sum of w t phi(t) */
} chaos_sums;

/* The sums at t = (x - c) * scale. n is a multiple of HAFT_SIMD_WIDTH: pad with w = 0 and any
 * finite c. The relative error of Phi(t) is about 1e-15 (1 + t^2); below -37.5 it keeps its
 * value there, 5e-308. */
chaos_sums haft_chaos_normal_sums(size_t n, const double *c, const double *w, double x,
                                  double scale);

/* y = exp(x) to 3e-16 for -700 <= x <= 700; n a multiple of HAFT_SIMD_WIDTH. In place is allowed.
 */
void haft_chaos_exponentials(size_t n, const double *x, double *y);

/* Phi(t), as above. */
double haft_chaos_normal_cdf(double t);

#endif
