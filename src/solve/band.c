/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Block L D L' of a block-tridiagonal symmetric matrix with 2 x 2 blocks A_k on the diagonal and
 * C_k below them (Golub and Van Loan 2013, Sec. 4.5.1):
 *
 *     S_0 = A_0,   L_k = C_k S_k^-1,   S_k+1 = A_k+1 - L_k C_k'.
 *
 * There is no pivoting: for a positive definite matrix none is needed, and elsewhere the factor is
 * used for its signs alone. By Sylvester's law the signs of the pivots S_k(0,0) and
 * det S_k / S_k(0,0) are those of the eigenvalues.
 *
 * Each block waits for the one before it, so what counts is the chain of operations from S_k to
 * S_k+1: C adj(S) C' is formed beside det S, and only its product with 1 / det S comes after the
 * division. */
#include "band.h"

#include <math.h>

/* S^-1, L to the next block, and a right-hand side on the way to the solution. */
typedef struct band_block {
    double inverse[3]; /* (0,0), (0,1), (1,1) */
    double l[2][2];
} band_block;

struct haft_band {
    size_t capacity, n; /* unknowns, all and in use */
    int *diagonal;      /* of each column, the place of its diagonal entry */
    band_block *block;
    haft_inertia inertia;
};

/* Whether column j holds all rows of its node and of the nodes beside it, and no others. */
static bool is_full(const int *column, const int *row, size_t j, size_t n) {
    size_t first = j / 2 > 0 ? j / 2 * 2 - 2 : 0, end = j / 2 * 2 + 4 < n ? j / 2 * 2 + 4 : n;
    int from = column[j], to = column[j + 1];
    return (size_t)(to - from) == end - first && row[from] == (int)first &&
           row[to - 1] == (int)end - 1;
}

haft_status haft_band_create(haft_band **out, size_t n, const int *column, const int *row,
                             haft_error *error) {
    *out = NULL;
    bool fits = n > 0 && n % 2 == 0;
    for (size_t j = 0; fits && j < n; j++) {
        fits = is_full(column, row, j, n);
    }
    if (!fits) {
        return HAFT_OK;
    }
    haft_band *band = haft_memory_alloc(1, sizeof *band, error);
    if (band == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    band->capacity = band->n = n;
    band->diagonal = haft_memory_alloc(n, sizeof *band->diagonal, error);
    band->block = haft_memory_alloc(n / 2, sizeof *band->block, error);
    if (band->diagonal == NULL || band->block == NULL) {
        haft_band_destroy(&band);
        return HAFT_ERROR_MEMORY;
    }
    for (size_t j = 0; j < n; j++) {
        band->diagonal[j] = column[j] + (int)(j < 2 ? j : 2 + j % 2);
    }
    *out = band;
    return HAFT_OK;
}

void haft_band_destroy(haft_band **band) {
    if (band == NULL || *band == NULL) {
        return;
    }
    haft_memory_free((*band)->diagonal);
    haft_memory_free((*band)->block);
    haft_memory_free(*band);
    *band = NULL;
}

bool haft_band_lead(haft_band *band, size_t n) {
    bool fits = n > 0 && n % 2 == 0 && n <= band->capacity;
    band->n = fits ? n : band->n;
    return fits;
}

static void count_pivot(haft_inertia *inertia, double pivot, double *largest) {
    inertia->negative += !(pivot > 0);
    inertia->least_pivot = fmin(inertia->least_pivot, pivot);
    *largest = fmax(*largest, fabs(pivot));
}

/* y_k+1 = b_k+1 - L_k y_k; b_k becomes y_k. */
HAFT_INLINE void forward(const band_block *block, double *b, int columns, size_t n) {
    for (int c = 0; c < columns; c++, b += n) {
        b[2] -= block->l[0][0] * b[0] + block->l[0][1] * b[1];
        b[3] -= block->l[1][0] * b[0] + block->l[1][1] * b[1];
    }
}

/* x_k = S_k^-1 y_k - L_k' x_k+1. */
HAFT_INLINE void backward(const haft_band *band, double *b, int columns) {
    size_t n = band->n, last = n / 2 - 1;
    for (size_t k = last + 1; k-- > 0;) {
        const band_block *block = &band->block[k];
        for (int c = 0; c < columns; c++) {
            double *y = b + (size_t)c * n + 2 * k;
            double x0 = block->inverse[0] * y[0] + block->inverse[1] * y[1];
            double x1 = block->inverse[1] * y[0] + block->inverse[2] * y[1];
            if (k < last) {
                x0 -= block->l[0][0] * y[2] + block->l[1][0] * y[3];
                x1 -= block->l[0][1] * y[2] + block->l[1][1] * y[3];
            }
            y[0] = x0;
            y[1] = x1;
        }
    }
}

bool haft_band_update(haft_band *band, const double *values, double *b) {
    size_t blocks = band->n / 2;
    const int *diagonal = band->diagonal;
    double s00 = values[diagonal[0]], s01 = values[diagonal[0] + 1], s11 = values[diagonal[1]];
    double largest = 0, check = 0;
    band->inertia = (haft_inertia){0, INFINITY};
    for (size_t k = 0; k < blocks; k++) {
        band_block *block = &band->block[k];
        double inverse = 1 / (s00 * s11 - s01 * s01);
        block->inverse[0] = s11 * inverse;
        block->inverse[1] = -s01 * inverse;
        block->inverse[2] = s00 * inverse;
        check += inverse;
        count_pivot(&band->inertia, s00, &largest);
        count_pivot(&band->inertia, 1 / block->inverse[2], &largest);
        if (k + 1 == blocks) {
            break;
        }
        const double *left = values + diagonal[2 * k], *right = values + diagonal[2 * k + 1];
        const double c00 = left[2], c10 = left[3], c01 = right[1], c11 = right[2];
        /* C adj(S), whose product with the inverse of det S is L */
        const double m00 = c00 * s11 - c01 * s01, m01 = c01 * s00 - c00 * s01;
        const double m10 = c10 * s11 - c11 * s01, m11 = c11 * s00 - c10 * s01;
        block->l[0][0] = m00 * inverse;
        block->l[0][1] = m01 * inverse;
        block->l[1][0] = m10 * inverse;
        block->l[1][1] = m11 * inverse;
        const double *next = values + diagonal[2 * k + 2];
        s00 = next[0] - (m00 * c00 + m01 * c01) * inverse;
        s01 = next[1] - (m10 * c00 + m11 * c01) * inverse;
        s11 = values[diagonal[2 * k + 3]] - (m10 * c10 + m11 * c11) * inverse;
        if (b != NULL) {
            forward(block, b + 2 * k, 1, band->n);
        }
    }
    band->inertia.least_pivot /= largest;
    if (b != NULL) {
        backward(band, b, 1);
    }
    return isfinite(check + largest); /* after a vanished pivot nothing is */
}

HAFT_INLINE void solve(const haft_band *band, double *b, int columns) {
    for (size_t k = 0; k + 1 < band->n / 2; k++) {
        forward(&band->block[k], b + 2 * k, columns, band->n);
    }
    backward(band, b, columns);
}

void haft_band_solve(haft_band *band, double *b, int columns) {
    for (; columns > 1; columns -= 2, b += 2 * band->n) {
        solve(band, b, 2); /* two side by side wait no longer than one */
    }
    if (columns == 1) {
        solve(band, b, 1);
    }
}

haft_inertia haft_band_inertia(const haft_band *band) {
    return band->inertia;
}
