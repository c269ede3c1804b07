/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A symmetric matrix by its diagonals: in a product as many rows as a vector has lanes go along all
 * of them, without an index. Worth it where they are few and full, as a beam's seven are. */
#include "diagonals.h"

#include <stdlib.h>

struct haft_diagonals {
    size_t n, count, widest;
    size_t *offset; /* of the diagonals on and below the main one */
    double *value;  /* n each: entry (j + offset, j) at j */
};

/* Where the diagonal stands in the list, which it is put at the end of if it is new. */
static size_t place(haft_diagonals *d, size_t offset) {
    size_t k = 0;
    while (k < d->count && d->offset[k] != offset) {
        k++;
    }
    if (k == d->count) {
        d->offset[d->count++] = offset;
        d->widest = offset > d->widest ? offset : d->widest;
    }
    return k;
}

static void find_diagonals(haft_diagonals *d, const int *column, const int *row) {
    for (size_t j = 0; j < d->n; j++) {
        for (int k = column[j]; k < column[j + 1]; k++) {
            if (row[k] >= (int)j) {
                place(d, (size_t)row[k] - j);
            }
        }
    }
}

haft_status haft_diagonals_create(haft_diagonals **out, size_t n, const int *column, const int *row,
                                  const double *values, haft_error *error) {
    *out = NULL;
    haft_diagonals *d = haft_memory_alloc(1, sizeof *d, error);
    if (d == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    d->n = n;
    d->offset = haft_memory_alloc(n, sizeof *d->offset, error);
    if (d->offset != NULL) {
        find_diagonals(d, column, row);
        d->value = haft_memory_alloc(d->count * n, sizeof *d->value, error);
    }
    if (d->offset == NULL || d->value == NULL) {
        haft_diagonals_destroy(&d);
        return HAFT_ERROR_MEMORY;
    }
    for (size_t j = 0; j < n; j++) {
        for (int k = column[j]; k < column[j + 1]; k++) {
            if (row[k] >= (int)j) {
                d->value[place(d, (size_t)row[k] - j) * n + j] = values[k];
            }
        }
    }
    *out = d;
    return HAFT_OK;
}

void haft_diagonals_destroy(haft_diagonals **diagonals) {
    if (diagonals == NULL || *diagonals == NULL) {
        return;
    }
    haft_memory_free((*diagonals)->offset);
    haft_memory_free((*diagonals)->value);
    haft_memory_free(*diagonals);
    *diagonals = NULL;
}

static double row_product(const haft_diagonals *d, size_t n, const double *x, size_t i) {
    double sum = 0;
    for (size_t k = 0; k < d->count; k++) {
        size_t offset = d->offset[k];
        const double *a = d->value + k * d->n;
        sum += i + offset < n ? a[i] * x[i + offset] : 0;
        sum += offset > 0 && i >= offset ? a[i - offset] * x[i - offset] : 0;
    }
    return sum;
}

/* HAFT_SIMD_WIDTH rows from row i on, none of them as near to an end as the widest diagonal is
 * wide. */
HAFT_INLINE void multiply_rows(const haft_diagonals *d, size_t i, double factor, const double *x,
                               const double *less, double *restrict out) {
    double sum[HAFT_SIMD_WIDTH] = {0};
    for (size_t k = 0; k < d->count; k++) {
        size_t offset = d->offset[k];
        const double *a = d->value + k * d->n + i, *right = x + i + offset, *left = x + i - offset;
#pragma omp simd
        for (size_t l = 0; l < HAFT_SIMD_WIDTH; l++) {
            sum[l] += a[l] * right[l];
        }
        if (offset == 0) {
            continue;
        }
        const double *mirrored = a - offset;
#pragma omp simd
        for (size_t l = 0; l < HAFT_SIMD_WIDTH; l++) {
            sum[l] += mirrored[l] * left[l];
        }
    }
#pragma omp simd
    for (size_t l = 0; l < HAFT_SIMD_WIDTH; l++) {
        out[i + l] = factor * sum[l] - (less != NULL ? less[i + l] : 0);
    }
}

/* The rows between those near the ends, the last of them together with some before them again.
 * @return how many near each end are left */
HAFT_CLONES static size_t multiply_middle(const haft_diagonals *d, size_t n, double factor,
                                          const double *x, const double *less,
                                          double *restrict out) {
    size_t edge = d->widest;
    if (n < 2 * edge + HAFT_SIMD_WIDTH) {
        return n;
    }
    size_t end = n - edge, i = edge;
    for (; i + HAFT_SIMD_WIDTH <= end; i += HAFT_SIMD_WIDTH) {
        multiply_rows(d, i, factor, x, less, out);
    }
    if (i < end) {
        multiply_rows(d, end - HAFT_SIMD_WIDTH, factor, x, less, out);
    }
    return edge;
}

void haft_diagonals_multiply(const haft_diagonals *d, size_t n, double factor, const double *x,
                             const double *less, double *restrict out) {
    size_t edge = multiply_middle(d, n, factor, x, less, out);
    for (size_t k = 0; k < 2 * edge && k < n; k++) {
        size_t i = k < edge ? k : n - 1 - (k - edge);
        out[i] = factor * row_product(d, n, x, i) - (less != NULL ? less[i] : 0);
    }
}
