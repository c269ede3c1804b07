/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A symmetric matrix by its diagonals: a product is one pass along each, without an index, which is
 * vector code. Worth it where the diagonals are few and full, as a beam's seven are. */
#include "diagonals.h"

#include <stdlib.h>

struct haft_diagonals {
    size_t n, count;
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

HAFT_CLONES void haft_diagonals_multiply(const haft_diagonals *d, size_t n, double factor,
                                         const double *x, double *restrict y) {
    for (size_t k = 0; k < d->count; k++) {
        size_t offset = d->offset[k], length = n > offset ? n - offset : 0;
        const double *a = d->value + k * d->n;
        for (size_t j = 0; j < length; j++) {
            y[j + offset] += factor * (a[j] * x[j]);
        }
        for (size_t j = 0; j < length && offset > 0; j++) {
            y[j] += factor * (a[j] * x[j + offset]);
        }
    }
}
