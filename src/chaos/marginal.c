/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Distances between one-dimensional distributions. A mixture's CDF is tabulated at 2048 points
 * over all samples and kernels and interpolated by the cubic of its values and densities: 1e-8
 * where a step is a fifteenth of the bandwidth. */
#include "chaos/marginal.h"

#include <math.h>
#include <stdlib.h>

enum { NODES = 2048 };

#define LOW_TAIL 0.001
/* Kernels are cut off here, in bandwidths; a distance does not notice. */
#define KERNEL_REACH 8.0

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

void haft_chaos_sort(size_t n, double *x) {
    qsort(x, n, sizeof *x, compare);
}

/* Linear between the order statistics. */
static double sample_quantile(size_t n, const double *x, double p) {
    double at = p * (double)(n - 1);
    size_t k = (size_t)at;
    double share = at - (double)k;
    return k + 1 < n ? x[k] + share * (x[k + 1] - x[k]) : x[n - 1];
}

haft_chaos_distance haft_chaos_distance_of_samples(size_t n, const double *x, size_t m,
                                                   const double *y) {
    haft_chaos_distance out = {0};
    size_t i = 0, j = 0;
    double before = fmin(x[0], y[0]);
    while (i < n || j < m) {
        double at = j == m || (i < n && x[i] <= y[j]) ? x[i] : y[j];
        double gap = fabs((double)i / (double)n - (double)j / (double)m);
        out.w1 += gap * (at - before);
        out.ks = fmax(out.ks, gap);
        before = at;
        while (i < n && x[i] == at) {
            i++;
        }
        while (j < m && y[j] == at) {
            j++;
        }
    }
    out.low_quantile = sample_quantile(n, x, LOW_TAIL) - sample_quantile(m, y, LOW_TAIL);
    out.high_quantile = sample_quantile(n, x, 1 - LOW_TAIL) - sample_quantile(m, y, 1 - LOW_TAIL);
    return out;
}

typedef struct tabulated {
    double low, step;
    double *cdf, *density; /* [NODES] */
} tabulated;

static double interpolate(const tabulated *t, double x) {
    double at = (x - t->low) / t->step;
    size_t k = (size_t)fmax(0, fmin(at, NODES - 2));
    double s = at - (double)k, r = 1 - s;
    return r * r * (1 + 2 * s) * t->cdf[k] + s * s * (1 + 2 * r) * t->cdf[k + 1] +
           s * r * (r * t->density[k] - s * t->density[k + 1]) * t->step;
}

haft_status haft_chaos_distance_of_line(size_t n, const double *x, const chaos_line *line,
                                        haft_chaos_distance *out, haft_error *error) {
    tabulated t = {.low = fmin(x[0], line->low - KERNEL_REACH * line->h)};
    double high = fmax(x[n - 1], line->high + KERNEL_REACH * line->h);
    t.step = (high - t.low) / (NODES - 1);
    t.cdf = haft_memory_alloc(2 * NODES, sizeof *t.cdf, error);
    *out = (haft_chaos_distance){0};
    if (t.cdf == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    t.density = t.cdf + NODES;
#pragma omp parallel for schedule(static)
    for (size_t k = 0; k < NODES; k++) {
        double at = t.low + (double)k * t.step;
        t.cdf[k] = haft_chaos_line_value(line, at, &t.density[k]);
    }
    size_t below = 0;
    for (size_t k = 0; k < NODES; k++) {
        double at = t.low + (double)k * t.step;
        while (below < n && x[below] <= at) {
            double cdf = interpolate(&t, x[below]);
            out->ks = fmax(out->ks, fabs(cdf - (double)below / (double)n));
            out->ks = fmax(out->ks, fabs(cdf - (double)(below + 1) / (double)n));
            below++;
        }
        out->w1 += fabs((double)below / (double)n - t.cdf[k]) * t.step;
    }
    out->low_quantile =
        sample_quantile(n, x, LOW_TAIL) - haft_chaos_line_quantile(line, LOW_TAIL, 1 - LOW_TAIL);
    out->high_quantile = sample_quantile(n, x, 1 - LOW_TAIL) -
                         haft_chaos_line_quantile(line, 1 - LOW_TAIL, LOW_TAIL);
    haft_memory_free(t.cdf);
    return HAFT_OK;
}
