/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the benches: a clock (of haft/base.h), a median, and ending with an error message. */
#ifndef HAFT_BENCH_H
#define HAFT_BENCH_H

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

#include "haft/base.h"

static inline int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The median. Sorts x. */
static inline double median(double *x, int n) {
    qsort(x, (size_t)n, sizeof *x, compare);
    return 0.5 * (x[n / 2] + x[(n - 1) / 2]);
}

static inline void must(haft_status status, const haft_error *error) {
    if (status != HAFT_OK) {
        fprintf(stderr, "%s: %s\n", program_invocation_short_name, error->message);
        exit(1);
    }
}

#endif
