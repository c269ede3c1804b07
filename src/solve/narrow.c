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

/* Two rows of it, so laid out that what comes behind both waits for three operations, not four as
 * for one row after the other: the first's share of the second, the second's shares of the three
 * behind it, and the first's of the next two with what goes there through the second. */
typedef struct narrow_pair {
    lanes inverse[2], within, l[HALF], through[2];
} narrow_pair;

/* Where a column's entries lie in the pattern: its diagonal, and how many follow and precede it. */
typedef struct narrow_column {
    int diagonal, below, above;
} narrow_column;

struct haft_narrow {
    size_t n, steps, core; /* rows eliminated in each lane; 3 or 4 are left between them */
    narrow_column *column;
    narrow_pair *pair;         /* of an odd number of rows the first has none behind it */
    lanes *y;                  /* steps: a right-hand side */
    lanes least, largest;      /* of the rows' pivots: the least, and the greatest in size */
    lane_counts negative;      /* and how many are not positive */
    double middle[CORE][CORE]; /* what is left, factored: L below D; three are four with a one */
    double inverse[CORE];      /* of that D */
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
    narrow->pair = haft_memory_alloc(narrow->steps / 2 + 1, sizeof *narrow->pair, error);
    narrow->y = haft_memory_alloc(narrow->steps, sizeof *narrow->y, error);
    bool made = narrow->column && narrow->pair && narrow->y, fits = made;
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
    haft_memory_free((*narrow)->pair);
    haft_memory_free((*narrow)->y);
    haft_memory_free(*narrow);
    *narrow = NULL;
}

/* Entry k off the diagonal of the i-th rows of both lanes. */
HAFT_INLINE lanes entry(const haft_narrow *narrow, const double *values, size_t i, int k) {
    const narrow_column *first = &narrow->column[i], *last = &narrow->column[narrow->n - 1 - i];
    return (lanes){k <= first->below ? values[first->diagonal + k] : 0,
                   k <= last->above ? values[last->diagonal - k] : 0};
}

/* The next three rows of each lane, less what those eliminated take from them: the upper triangle
 * of their corner. Where they are the middle's, that alone. */
typedef struct corner {
    lanes a00, a01, a02, a11, a12, a22;
} corner;

/* What is left between the lanes, with what they take from it. */
HAFT_INLINE void gather_middle(haft_narrow *narrow, const double *values, const corner *taken) {
    size_t size = narrow->core;
    const lanes share[HALF][HALF] = {{taken->a00, taken->a01, taken->a02},
                                     {taken->a01, taken->a11, taken->a12},
                                     {taken->a02, taken->a12, taken->a22}};
    double(*m)[CORE] = narrow->middle;
    for (size_t b = 0; b < CORE; b++) {
        m[CORE - 1][b] = b == CORE - 1;
    }
    for (size_t a = 0; a < size; a++) {
        for (size_t b = 0; b <= a; b++) {
            const narrow_column *c = &narrow->column[narrow->steps + b];
            int k = (int)(a - b);
            m[a][b] = k <= c->below ? values[c->diagonal + k] : 0;
            m[a][b] += a < HALF ? share[a][b][0] : 0;
            m[a][b] += size - 1 - b < HALF ? share[size - 1 - a][size - 1 - b][1] : 0;
        }
    }
}

/* @return something finite if all pivots and their inverses are */
HAFT_INLINE double factor_middle(haft_narrow *narrow) {
    double(*m)[CORE] = narrow->middle, check = 0;
    for (size_t j = 0; j < CORE; j++) {
        double inverse = 1 / m[j][j], l[CORE];
        narrow->inverse[j] = inverse;
        check += m[j][j] + inverse;
        for (size_t a = j + 1; a < CORE; a++) {
            l[a] = m[a][j] * inverse;
        }
        for (size_t a = j + 1; a < CORE; a++) {
            for (size_t b = j + 1; b <= a; b++) {
                m[a][b] -= l[b] * m[a][j];
            }
        }
        for (size_t a = j + 1; a < CORE; a++) {
            m[a][j] = l[a];
        }
    }
    return check;
}

/* a where the mask is set, b elsewhere. */
HAFT_INLINE lanes choose(lane_counts mask, lanes a, lanes b) {
    return (lanes)(((lane_counts)a & mask) | ((lane_counts)b & ~mask));
}

/* Takes note of the rows' pivots d as they come; a comparison gives -1 where it holds. */
HAFT_INLINE void note_pivots(haft_narrow *narrow, lanes d) {
    lanes size = choose(d < 0, -d, d);
    narrow->negative -= ~(d > 0);
    narrow->least = choose(d < narrow->least, d, narrow->least);
    narrow->largest = choose(size > narrow->largest, size, narrow->largest);
}

/* The next three of what is left of a right-hand side before each lane's row. */
typedef struct onward {
    lanes now, next, third;
} onward;

HAFT_INLINE onward set_out(size_t n, const double *b) {
    return (onward){{b[0], b[n - 1]}, {b[1], b[n - 2]}, {b[2], b[n - 3]}};
}

/* b's entries that come in with row i, nil once the lanes have met. */
HAFT_INLINE lanes come_in(const haft_narrow *narrow, const double *b, size_t i) {
    return i < narrow->steps ? (lanes){b[i], b[narrow->n - 1 - i]} : (lanes){0, 0};
}

/* Past a pair that begins with row i: its y, over its pivots, and what it takes from the three rows
 * behind it. */
HAFT_INLINE onward pass_pair(const haft_narrow *narrow, const narrow_pair *pair, size_t i,
                             const double *b, onward f) {
    const lanes second = f.next - pair->within * f.now;
    narrow->y[i] = f.now * pair->inverse[0];
    narrow->y[i + 1] = second * pair->inverse[1];
    return (onward){f.third - (pair->through[0] * f.now + pair->l[0] * f.next),
                    come_in(narrow, b, i + 3) - (pair->through[1] * f.now + pair->l[1] * f.next),
                    come_in(narrow, b, i + 4) - pair->l[2] * second};
}

/* Past the first row, where it has no second. */
HAFT_INLINE onward pass_first(const haft_narrow *narrow, const double *b, onward f) {
    const narrow_pair *pair = &narrow->pair[0];
    narrow->y[0] = f.now * pair->inverse[0];
    return (onward){f.next - pair->within * f.now, f.third - pair->through[0] * f.now,
                    come_in(narrow, b, 3) - pair->through[1] * f.now};
}

/* Back from the middle, where `f` is what the lanes leave of its first and last three rows. */
HAFT_INLINE void solve_middle(const haft_narrow *narrow, double *b, onward f) {
    const lanes rest[HALF] = {f.now, f.next, f.third};
    const double(*m)[CORE] = narrow->middle;
    double x[CORE] = {0};
    for (size_t k = 0; k < narrow->core; k++) {
        x[k] = b[k];
    }
    for (size_t k = 0; k < HALF; k++) {
        x[k] += rest[k][0];
        x[narrow->core - 1 - k] += rest[k][1];
    }
    for (size_t j = 0; j < CORE; j++) {
        for (size_t a = j + 1; a < CORE; a++) {
            x[a] -= m[a][j] * x[j];
        }
    }
    for (size_t j = CORE; j-- > 0;) {
        x[j] *= narrow->inverse[j];
        for (size_t a = CORE - 1; a > j; a--) {
            x[j] -= m[a][j] * x[a];
        }
    }
    for (size_t k = 0; k < narrow->core; k++) {
        b[k] = x[k];
    }
}

HAFT_INLINE void put(double *b, size_t n, size_t i, lanes x) {
    b[i] = x[0];
    b[n - 1 - i] = x[1];
}

HAFT_INLINE void solve_backwards(const haft_narrow *narrow, double *b) {
    size_t n = narrow->n, i = narrow->steps;
    lanes x1 = {b[i], b[n - 1 - i]}, x2 = {b[i + 1], b[n - 2 - i]}, x3 = {b[i + 2], b[n - 3 - i]};
    while (i > 1) {
        i -= 2;
        const narrow_pair *pair = &narrow->pair[(i + 1) / 2];
        lanes early = narrow->y[i + 1] - pair->l[2] * x3;
        lanes second = early - (pair->l[1] * x2 + pair->l[0] * x1);
        lanes first =
            (narrow->y[i] - pair->within * early) - (pair->through[1] * x2 + pair->through[0] * x1);
        put(b, n, i + 1, second);
        put(b, n, i, first);
        x3 = x1;
        x2 = second;
        x1 = first;
    }
    if (i > 0) {
        const narrow_pair *pair = &narrow->pair[0];
        lanes behind = pair->through[1] * x3 + pair->through[0] * x2;
        put(b, n, 0, (narrow->y[0] - behind) - pair->within * x1);
    }
}

/* entry(), nil from the middle on. */
HAFT_INLINE lanes entry_before(const haft_narrow *narrow, const double *values, size_t i, int k) {
    return i < narrow->steps ? entry(narrow, values, i, k) : (lanes){0, 0};
}

/* Eliminates the i-th rows of both lanes, the first of `c`. */
HAFT_INLINE narrow_row eliminate(haft_narrow *narrow, const double *values, size_t i, corner *c,
                                 lanes *sum) {
    const lanes d = c->a00, r1 = c->a01, r2 = c->a02, r3 = entry(narrow, values, i, 3);
    const lanes inverse = 1 / d, l1 = r1 * inverse, l2 = r2 * inverse, l3 = r3 * inverse;
    note_pivots(narrow, d);
    *sum += d;
    *c = (corner){.a00 = c->a11 - l1 * r1,
                  .a01 = c->a12 - l1 * r2,
                  .a02 = entry_before(narrow, values, i + 1, 2) - l1 * r3,
                  .a11 = c->a22 - l2 * r2,
                  .a12 = entry_before(narrow, values, i + 2, 1) - l2 * r3,
                  .a22 = entry_before(narrow, values, i + 3, 0) - l3 * r3};
    return (narrow_row){inverse, {l1, l2, l3}};
}

HAFT_INLINE narrow_pair combine(narrow_row first, narrow_row second) {
    const lanes within = first.l[0];
    return (narrow_pair){
        {first.inverse, second.inverse},
        within,
        {second.l[0], second.l[1], second.l[2]},
        {first.l[1] - second.l[0] * within, first.l[2] - second.l[1] * within},
    };
}

/* Factors, and solves for b on the way unless that is NULL. */
HAFT_INLINE bool update(haft_narrow *narrow, const double *values, double *b) {
    corner c = {.a00 = entry(narrow, values, 0, 0),
                .a01 = entry(narrow, values, 0, 1),
                .a02 = entry(narrow, values, 0, 2),
                .a11 = entry(narrow, values, 1, 0),
                .a12 = entry(narrow, values, 1, 1),
                .a22 = entry(narrow, values, 2, 0)};
    lanes sum = {0, 0};
    onward f = {{0}, {0}, {0}};
    narrow->least = (lanes){INFINITY, INFINITY};
    narrow->largest = (lanes){0, 0};
    narrow->negative = (lane_counts){0, 0};
    if (b != NULL) {
        f = set_out(narrow->n, b);
    }
    size_t i = narrow->steps % 2;
    if (i > 0) {
        narrow->pair[0] = combine(eliminate(narrow, values, 0, &c, &sum), (narrow_row){0});
        f = b != NULL ? pass_first(narrow, b, f) : f;
    }
    for (; i < narrow->steps; i += 2) {
        narrow_pair *pair = &narrow->pair[(i + 1) / 2];
        narrow_row first = eliminate(narrow, values, i, &c, &sum);
        *pair = combine(first, eliminate(narrow, values, i + 1, &c, &sum));
        f = b != NULL ? pass_pair(narrow, pair, i, b, f) : f;
    }
    gather_middle(narrow, values, &c);
    double check = factor_middle(narrow) + sum[0] + sum[1];
    if (b != NULL) {
        solve_middle(narrow, b + narrow->steps, f);
        solve_backwards(narrow, b);
    }
    return isfinite(check); /* after a vanished pivot nothing is */
}

HAFT_CLONES bool haft_narrow_update(haft_narrow *narrow, const double *values) {
    return update(narrow, values, NULL);
}

HAFT_CLONES bool haft_narrow_update_solve(haft_narrow *narrow, const double *values, double *b) {
    return update(narrow, values, b);
}

HAFT_CLONES void haft_narrow_solve(haft_narrow *narrow, double *b) {
    onward f = set_out(narrow->n, b);
    size_t i = narrow->steps % 2;
    f = i > 0 ? pass_first(narrow, b, f) : f;
    for (; i < narrow->steps; i += 2) {
        f = pass_pair(narrow, &narrow->pair[(i + 1) / 2], i, b, f);
    }
    solve_middle(narrow, b + narrow->steps, f);
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
