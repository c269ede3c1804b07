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
 * S_k+1. C adj(S) C' is formed beside det S, and only its product with 1 / det S comes after the
 * division. And the elimination goes from both ends at once and meets in the middle block (the
 * twisted order; Meurant 1992), so that the processor has two chains to work on: `bench-cycle -s`
 * takes 1.0 to 1.2 times as long without. */
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

bool haft_band_use_leading(haft_band *band, size_t n) {
    bool fits = n > 0 && n % 2 == 0 && n <= band->capacity;
    band->n = fits ? n : band->n;
    return fits;
}

/* What is noted of all pivots; `check` is finite if all are. */
typedef struct tally {
    int negative;
    double least, largest, check;
} tally;

HAFT_INLINE void count_pivot(tally *t, double pivot) {
    double size = fabs(pivot);
    t->negative += !(pivot > 0);
    t->least = pivot < t->least ? pivot : t->least;
    t->largest = size > t->largest ? size : t->largest;
}

/* A symmetric block; a block off the diagonal, whose rows are those of the next node. */
typedef struct symmetric {
    double s00, s01, s11;
} symmetric;
typedef struct coupling {
    double c00, c01, c10, c11;
} coupling;

HAFT_INLINE symmetric diagonal_block(const haft_band *band, const double *values, size_t k) {
    const double *entry = values + band->diagonal[2 * k];
    return (symmetric){entry[0], entry[1], values[band->diagonal[2 * k + 1]]};
}

/* C_k, which leads from node k to the next, and C_k-1', which leads to the one before. */
HAFT_INLINE coupling to_next(const haft_band *band, const double *values, size_t k) {
    const double *left = values + band->diagonal[2 * k],
                 *right = values + band->diagonal[2 * k + 1];
    return (coupling){left[2], right[1], left[3], right[2]};
}

HAFT_INLINE coupling to_previous(const haft_band *band, const double *values, size_t k) {
    coupling c = to_next(band, values, k - 1);
    return (coupling){c.c00, c.c10, c.c01, c.c11};
}

HAFT_INLINE symmetric subtract(symmetric a, symmetric b) {
    return (symmetric){a.s00 - b.s00, a.s01 - b.s01, a.s11 - b.s11};
}

/* Eliminates a block. @return what it takes from the next, L C' */
HAFT_INLINE symmetric eliminate(band_block *block, symmetric s, coupling c, tally *t) {
    double inverse = 1 / (s.s00 * s.s11 - s.s01 * s.s01);
    /* C adj(S), whose product with 1 / det S is L */
    double m00 = c.c00 * s.s11 - c.c01 * s.s01, m01 = c.c01 * s.s00 - c.c00 * s.s01;
    double m10 = c.c10 * s.s11 - c.c11 * s.s01, m11 = c.c11 * s.s00 - c.c10 * s.s01;
    *block = (band_block){{s.s11 * inverse, -s.s01 * inverse, s.s00 * inverse},
                          {{m00 * inverse, m01 * inverse}, {m10 * inverse, m11 * inverse}}};
    count_pivot(t, s.s00);
    count_pivot(t, 1 / block->inverse[2]);
    t->check += inverse;
    return (symmetric){(m00 * c.c00 + m01 * c.c01) * inverse, (m10 * c.c00 + m11 * c.c01) * inverse,
                       (m10 * c.c10 + m11 * c.c11) * inverse};
}

/* The next block's part of a right-hand side, less L y. */
HAFT_INLINE void forward(const band_block *block, const double *y, double *next) {
    next[0] -= block->l[0][0] * y[0] + block->l[0][1] * y[1];
    next[1] -= block->l[1][0] * y[0] + block->l[1][1] * y[1];
}

/* x = S^-1 y - L' x_next, in place of y. */
HAFT_INLINE void backward(const band_block *block, double *y, const double *next) {
    double x0 = block->inverse[0] * y[0] + block->inverse[1] * y[1];
    double x1 = block->inverse[1] * y[0] + block->inverse[2] * y[1];
    y[0] = x0 - (block->l[0][0] * next[0] + block->l[1][0] * next[1]);
    y[1] = x1 - (block->l[0][1] * next[0] + block->l[1][1] * next[1]);
}

/* From the middle block, whose number is that of the blocks before it, outwards. */
HAFT_INLINE void solve_outwards(const haft_band *band, double *b) {
    size_t blocks = band->n / 2, middle = blocks / 2;
    double *y = b + 2 * middle;
    static const double nothing[2] = {0, 0};
    backward(&band->block[middle], y, nothing);
    for (size_t i = 1; i <= middle; i++) {
        size_t before = middle - i, behind = middle + i;
        backward(&band->block[before], b + 2 * before, b + 2 * before + 2);
        if (behind < blocks) {
            backward(&band->block[behind], b + 2 * behind, b + 2 * behind - 2);
        }
    }
}

HAFT_INLINE bool update(haft_band *band, const double *values, double *b) {
    size_t blocks = band->n / 2, middle = blocks / 2, last = blocks - 1;
    symmetric front = diagonal_block(band, values, 0), back = diagonal_block(band, values, last);
    symmetric taken = {0, 0, 0};
    tally t = {.least = INFINITY};
    for (size_t i = 0; i < middle; i++) {
        band_block *block = &band->block[i];
        front = subtract(diagonal_block(band, values, i + 1),
                         eliminate(block, front, to_next(band, values, i), &t));
        if (b != NULL) {
            forward(block, b + 2 * i, b + 2 * i + 2);
        }
        size_t k = last - i;
        if (k > middle) {
            block = &band->block[k];
            taken = eliminate(block, back, to_previous(band, values, k), &t);
            back = subtract(diagonal_block(band, values, k - 1), taken);
            if (b != NULL) {
                forward(block, b + 2 * k, b + 2 * k - 2);
            }
        }
    }
    eliminate(&band->block[middle], subtract(front, taken), (coupling){0, 0, 0, 0}, &t);
    band->inertia = (haft_inertia){t.negative, t.least / t.largest};
    if (b != NULL) {
        solve_outwards(band, b);
    }
    return isfinite(t.check + t.largest); /* after a vanished pivot nothing is */
}

HAFT_CLONES static bool factor_alone(haft_band *band, const double *values) {
    return update(band, values, NULL);
}

HAFT_CLONES static bool factor_and_solve(haft_band *band, const double *values, double *b) {
    return update(band, values, b);
}

bool haft_band_update(haft_band *band, const double *values, double *b) {
    return b == NULL ? factor_alone(band, values) : factor_and_solve(band, values, b);
}

HAFT_CLONES static void solve_one(const haft_band *band, double *b) {
    size_t blocks = band->n / 2, middle = blocks / 2;
    for (size_t i = 0; i < middle; i++) {
        forward(&band->block[i], b + 2 * i, b + 2 * i + 2);
        size_t k = blocks - 1 - i;
        if (k > middle) {
            forward(&band->block[k], b + 2 * k, b + 2 * k - 2);
        }
    }
    solve_outwards(band, b);
}

void haft_band_solve(haft_band *band, double *b, int columns) {
    for (int c = 0; c < columns; c++) {
        solve_one(band, b + (size_t)c * band->n);
    }
}

haft_inertia haft_band_inertia(const haft_band *band) {
    return band->inertia;
}
