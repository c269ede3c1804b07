/* SPDX-License-Identifier: GPL-3.0-or-later */
/* L D L' of a symmetric matrix of half-bandwidth 3, which a beam's is: two unknowns a node, each
 * coupled to its neighbours' alone.
 *
 * Elimination goes from both ends at once and meets in the middle (the twisted order; Meurant
 * 1992): each row waits for the one before it, and two of them side by side, in the two lanes of a
 * vector, take the time of one. The order is a symmetric permutation like any other: D's signs are
 * the inertia, and for a positive definite matrix it is stable without pivoting. */
#include "narrow.h"

#include <math.h>
#include <stdint.h>

enum { HALF = 3, CORE = 4, LEAST_SIZE = 12 };

/* Lane 0 counts rows from the first on, lane 1 from the last back. */
typedef double lanes __attribute__((vector_size(16)));
typedef int64_t lane_counts __attribute__((vector_size(16)));

/* A row of the factor: its pivot's inverse, and its shares of the three rows behind it. */
typedef struct narrow_row {
    lanes inverse, l[HALF];
} narrow_row;

/* Where a column's entries lie in the pattern: its diagonal, and how many follow and precede it. */
typedef struct narrow_column {
    int diagonal, below, above;
} narrow_column;

struct haft_narrow {
    size_t n, steps, core; /* rows eliminated in each lane; 3 or 4 are left between them */
    narrow_column *column;
    narrow_row *row;
    lanes *y;                  /* steps: a right-hand side */
    lanes least, largest;      /* of the rows' pivots: the least, and the greatest in size */
    lane_counts negative;      /* and how many are not positive */
    double middle[CORE][CORE]; /* what is left, factored: L below D */
};

/* Notes where column j's entries lie; false if not all of them within the band, without a gap. */
static bool find_column(narrow_column *out, int j, const int *row, int from, int to) {
    int diagonal = from;
    while (diagonal < to && row[diagonal] < j) {
        diagonal++;
    }
    *out = (narrow_column){diagonal, to - diagonal - 1, diagonal - from};
    return diagonal < to && row[diagonal] == j && out->below <= HALF && out->above <= HALF &&
           row[to - 1] == j + out->below && row[from] == j - out->above;
}

haft_status haft_narrow_create(haft_narrow **out, size_t n, const int *column, const int *row,
                               haft_error *error) {
    *out = NULL;
    haft_narrow *narrow = haft_memory_alloc(1, sizeof *narrow, error);
    if (narrow == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    if (!haft_narrow_lead(narrow, n)) {
        haft_narrow_destroy(&narrow);
        return HAFT_OK;
    }
    narrow->column = haft_memory_alloc(n, sizeof *narrow->column, error);
    narrow->row = haft_memory_alloc(narrow->steps, sizeof *narrow->row, error);
    narrow->y = haft_memory_alloc(narrow->steps, sizeof *narrow->y, error);
    bool made = narrow->column && narrow->row && narrow->y, fits = made;
    for (size_t j = 0; j < n && fits; j++) {
        fits = find_column(&narrow->column[j], (int)j, row, column[j], column[j + 1]);
    }
    if (!fits) {
        haft_narrow_destroy(&narrow);
    }
    *out = narrow;
    return made ? HAFT_OK : HAFT_ERROR_MEMORY;
}

bool haft_narrow_lead(haft_narrow *narrow, size_t n) {
    if (n < LEAST_SIZE) {
        return false;
    }
    narrow->n = n;
    narrow->core = HALF + (n - HALF) % 2;
    narrow->steps = (n - narrow->core) / 2;
    return true;
}

void haft_narrow_destroy(haft_narrow **narrow) {
    if (narrow == NULL || *narrow == NULL) {
        return;
    }
    haft_memory_free((*narrow)->column);
    haft_memory_free((*narrow)->row);
    haft_memory_free((*narrow)->y);
    haft_memory_free(*narrow);
    *narrow = NULL;
}

/* Entry k off the diagonal of the i-th rows of both lanes. */
static inline lanes entry(const haft_narrow *narrow, const double *values, size_t i, int k) {
    const narrow_column *first = &narrow->column[i], *last = &narrow->column[narrow->n - 1 - i];
    return (lanes){k <= first->below ? values[first->diagonal + k] : 0,
                   k <= last->above ? values[last->diagonal - k] : 0};
}

/* What the rows eliminated take from the next three: the upper triangle of their corner. */
typedef struct corner {
    lanes a00, a01, a02, a11, a12, a22;
} corner;

static void factor_middle(haft_narrow *narrow, const double *values, const corner *taken) {
    size_t size = narrow->core;
    const lanes share[HALF][HALF] = {{taken->a00, taken->a01, taken->a02},
                                     {taken->a01, taken->a11, taken->a12},
                                     {taken->a02, taken->a12, taken->a22}};
    double(*m)[CORE] = narrow->middle;
    for (size_t a = 0; a < size; a++) {
        for (size_t b = 0; b <= a; b++) {
            const narrow_column *c = &narrow->column[narrow->steps + b];
            int k = (int)(a - b);
            m[a][b] = k <= c->below ? values[c->diagonal + k] : 0;
            m[a][b] += a < HALF ? share[a][b][0] : 0;
            m[a][b] += size - 1 - b < HALF ? share[size - 1 - a][size - 1 - b][1] : 0;
        }
    }
    for (size_t j = 0; j < size; j++) {
        for (size_t a = j + 1; a < size; a++) {
            double l = m[a][j] / m[j][j];
            for (size_t b = j + 1; b <= a; b++) {
                m[a][b] -= (b < a ? m[b][j] : l) * m[a][j];
            }
            m[a][j] = l;
        }
    }
}

/* a where the mask is set, b elsewhere. */
static inline lanes choose(lane_counts mask, lanes a, lanes b) {
    return (lanes)(((lane_counts)a & mask) | ((lane_counts)b & ~mask));
}

/* Takes note of the rows' pivots d as they come; a comparison gives -1 where it holds. */
static inline void note_pivots(haft_narrow *narrow, lanes d) {
    lanes size = choose(d < 0, -d, d);
    narrow->negative -= ~(d > 0);
    narrow->least = choose(d < narrow->least, d, narrow->least);
    narrow->largest = choose(size > narrow->largest, size, narrow->largest);
}

bool haft_narrow_update(haft_narrow *narrow, const double *values) {
    corner c = {0};
    lanes sum = {0, 0};
    narrow->least = (lanes){INFINITY, INFINITY};
    narrow->largest = (lanes){0, 0};
    narrow->negative = (lane_counts){0, 0};
    for (size_t i = 0; i < narrow->steps; i++) {
        narrow_row *row = &narrow->row[i];
        lanes d = entry(narrow, values, i, 0) + c.a00, r1 = entry(narrow, values, i, 1) + c.a01;
        lanes r2 = entry(narrow, values, i, 2) + c.a02, r3 = entry(narrow, values, i, 3);
        lanes inverse = 1 / d, l1 = r1 * inverse, l2 = r2 * inverse, l3 = r3 * inverse;
        *row = (narrow_row){inverse, {l1, l2, l3}};
        note_pivots(narrow, d);
        sum += d;
        c = (corner){.a00 = c.a11 - l1 * r1,
                     .a01 = c.a12 - l1 * r2,
                     .a02 = -l1 * r3,
                     .a11 = c.a22 - l2 * r2,
                     .a12 = -l2 * r3,
                     .a22 = -l3 * r3};
    }
    factor_middle(narrow, values, &c);
    double check = sum[0] + sum[1];
    for (size_t j = 0; j < narrow->core; j++) {
        check += narrow->middle[j][j] + 1 / narrow->middle[j][j];
    }
    return isfinite(check); /* after a vanished pivot nothing is */
}

static void solve_middle(const haft_narrow *narrow, double *b) {
    size_t size = narrow->core;
    for (size_t j = 0; j < size; j++) {
        for (size_t a = j + 1; a < size; a++) {
            b[a] -= narrow->middle[a][j] * b[j];
        }
    }
    for (size_t j = size; j-- > 0;) {
        b[j] /= narrow->middle[j][j];
        for (size_t a = j + 1; a < size; a++) {
            b[j] -= narrow->middle[a][j] * b[a];
        }
    }
}

/* L y = b down to the middle; what the lanes leave of its first and last three rows goes there. */
static void solve_forwards(haft_narrow *narrow, double *b) {
    size_t n = narrow->n, steps = narrow->steps;
    const lanes nil = {0, 0};
    lanes now = {b[0], b[n - 1]}, next = {b[1], b[n - 2]}, third = {b[2], b[n - 3]};
    for (size_t i = 0; i < steps; i++) {
        const narrow_row *row = &narrow->row[i];
        lanes y = now, entering = i + HALF < steps ? (lanes){b[i + 3], b[n - 4 - i]} : nil;
        narrow->y[i] = y * row->inverse;
        now = next - row->l[0] * y;
        next = third - row->l[1] * y;
        third = entering - row->l[2] * y;
    }
    const lanes rest[HALF] = {now, next, third};
    for (size_t k = 0; k < HALF; k++) {
        b[steps + k] += rest[k][0];
        b[n - 1 - steps - k] += rest[k][1];
    }
}

static void solve_backwards(const haft_narrow *narrow, double *b) {
    size_t n = narrow->n, steps = narrow->steps;
    lanes x1 = {b[steps], b[n - 1 - steps]}, x2 = {b[steps + 1], b[n - 2 - steps]};
    lanes x3 = {b[steps + 2], b[n - 3 - steps]};
    for (size_t i = steps; i-- > 0;) {
        const narrow_row *row = &narrow->row[i];
        lanes x = ((narrow->y[i] - row->l[2] * x3) - row->l[1] * x2) - row->l[0] * x1;
        b[i] = x[0];
        b[n - 1 - i] = x[1];
        x3 = x2;
        x2 = x1;
        x1 = x;
    }
}

void haft_narrow_solve(haft_narrow *narrow, double *b) {
    solve_forwards(narrow, b);
    solve_middle(narrow, b + narrow->steps);
    solve_backwards(narrow, b);
}

static void count_pivot(double pivot, haft_inertia *inertia, double *largest) {
    inertia->negative += !(pivot > 0);
    inertia->least_pivot = pivot < inertia->least_pivot ? pivot : inertia->least_pivot;
    *largest = fabs(pivot) > *largest ? fabs(pivot) : *largest;
}

haft_inertia haft_narrow_inertia(const haft_narrow *narrow) {
    haft_inertia inertia = {(int)(narrow->negative[0] + narrow->negative[1]),
                            fmin(narrow->least[0], narrow->least[1])};
    double largest = fmax(narrow->largest[0], narrow->largest[1]);
    for (size_t j = 0; j < narrow->core; j++) {
        count_pivot(narrow->middle[j][j], &inertia, &largest);
    }
    inertia.least_pivot /= largest;
    return inertia;
}
