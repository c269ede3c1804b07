/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Laws laid out for evaluation: each of their numbers in a row of its own, padded so that the
 * innermost loop of the solver works on whole vectors. Table laws are evaluated one by one after
 * it, and what all have in common, their far field, last. */
#include "law/far.h"
#include "law/table.h"
#include "law/wings.h"

#include <math.h>
#include <string.h>

enum { COLUMNS = 11, WALL = 6, ZERO = 10 };

struct haft_law_rows {
    size_t laws, stride;
    haft_wings_bounds bounds; /* kept here, so that no compiler optimizes for their values */
    double *value;          /* COLUMNS rows of the wings' numbers, stride each; the last is the gap
                               beyond which a law is zero */
    size_t tables;          /* how many there are */
    haft_table_head *table; /* laws: zero where a law is no table */
    const haft_far_field *far; /* of all, or NULL */
};

/* The gap beyond which a law evaluates to zero, with room for rounding; -INFINITY for empty lanes.
 */
static double zero_beyond(haft_wings w) {
    if (w.a_right == 0) {
        return -INFINITY; /* no Morse law: an empty lane, or a table's */
    }
    double beyond = w.d_max + (1 + 1e-9) * HAFT_LAW_DECAYS / w.a_right + 0x1p-50 * fabs(w.d_max);
    return beyond < w.wall_distance ? w.wall_distance : beyond;
}

static void put(haft_law_rows *rows, size_t i, haft_wings w) {
    const double number[COLUMNS] = {w.f_max,      w.d_max,          w.a_left,        w.a_right,
                                    w.half_left,  w.length_right,   w.wall_distance, w.wall_force,
                                    w.wall_slope, w.wall_potential, zero_beyond(w)};
    for (size_t k = 0; k < COLUMNS; k++) {
        rows->value[k * rows->stride + i] = number[k];
    }
}

haft_status haft_law_rows_create(haft_law_rows **out, size_t n, const haft_law *laws,
                                 haft_error *error) {
    *out = NULL;
    for (size_t i = 1; i < n; i++) {
        if (laws[i].far != laws[0].far) {
            return haft_error_set(
                error, HAFT_ERROR_ARGUMENT,
                "law %zu has another far field than law 0; all must share one, or "
                "have none",
                i);
        }
    }
    haft_law_rows *rows = haft_memory_alloc(1, sizeof *rows, error);
    if (rows == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    rows->laws = n;
    rows->far = n > 0 ? laws[0].far : NULL;
    rows->bounds = haft_law_wings_bounds();
    rows->stride = haft_simd_padded(n);
    rows->value = haft_memory_alloc(COLUMNS * rows->stride, sizeof *rows->value, error);
    rows->table = haft_memory_alloc(n, sizeof *rows->table, error);
    if (!rows->value || !rows->table) {
        haft_law_rows_destroy(&rows);
        return HAFT_ERROR_MEMORY;
    }
    for (size_t i = 0; i < rows->stride; i++) {
        bool is_table = i < n && laws[i].kind == HAFT_LAW_TABLE;
        put(rows, i, i < n && !is_table ? haft_law_wings(&laws[i]) : (haft_wings){0});
        if (is_table) {
            rows->table[i] = haft_law_table_head(laws[i].table);
            rows->tables++;
        }
    }
    *out = rows;
    return HAFT_OK;
}

void haft_law_rows_destroy(haft_law_rows **rows) {
    if (rows == NULL || *rows == NULL) {
        return;
    }
    haft_memory_free((*rows)->value);
    haft_memory_free((*rows)->table);
    haft_memory_free(*rows);
    *rows = NULL;
}

/* Whether all of HAFT_SIMD_WIDTH laws are zero: a free span. Beams lie down from their ends, so the
 * last lane decides soonest. */
HAFT_INLINE bool all_zero(const double *v, size_t stride, const double *d) {
    size_t i = HAFT_SIMD_WIDTH;
    while (i > 0 && d[i - 1] > v[ZERO * stride + i - 1]) {
        i--;
    }
    return i == 0;
}

/* Which values are asked for. */
typedef enum asked { FORCE, NO_CURVATURE, ALL } asked;

/* Evaluates HAFT_SIMD_WIDTH laws, whose numbers begin at v. */
HAFT_INLINE void evaluate_lanes(const double *v, size_t stride, haft_wings_bounds bounds,
                                bool walls, asked what, const double *d, double *restrict force,
                                double *restrict slope, double *restrict curvature,
                                double *restrict potential) {
    double gap[HAFT_SIMD_WIDTH];
    memcpy(gap, d, sizeof gap);
#pragma omp simd
    for (size_t i = 0; i < HAFT_SIMD_WIDTH; i++) {
        haft_wings w = {v[i],
                        v[stride + i],
                        v[2 * stride + i],
                        v[3 * stride + i],
                        v[4 * stride + i],
                        v[5 * stride + i],
                        v[6 * stride + i],
                        v[7 * stride + i],
                        v[8 * stride + i],
                        v[9 * stride + i]};
        haft_law_value x = haft_law_wings_evaluate(w, gap[i], bounds, walls);
        force[i] = x.force;
        if (what != FORCE) {
            slope[i] = x.slope;
            potential[i] = x.potential;
        }
        if (what == ALL) {
            curvature[i] = x.curvature;
        }
    }
}

/* Whether any of HAFT_SIMD_WIDTH gaps lies behind its law's wall, which nearly none does: most are
 * spared the walls. */
HAFT_INLINE bool any_behind_wall(const double *v, size_t stride, const double *d) {
    const double *wall = v + WALL * stride;
    int any = 0;
#pragma omp simd reduction(| : any)
    for (size_t i = 0; i < HAFT_SIMD_WIDTH; i++) {
        any |= d[i] < wall[i];
    }
    return any != 0;
}

/* The values of HAFT_SIMD_WIDTH laws from law i on, to where those go. */
HAFT_INLINE void evaluate_from(const haft_law_rows *rows, const double *v, bool walls, asked what,
                               const double *d, const haft_law_values *out, size_t i) {
    evaluate_lanes(v, rows->stride, rows->bounds, walls, what, d + i, out->force + i,
                   what != FORCE ? out->slope + i : NULL, what == ALL ? out->curvature + i : NULL,
                   what != FORCE ? out->potential + i : NULL);
}

HAFT_INLINE void set_zero(asked what, const haft_law_values *out, size_t i) {
    memset(out->force + i, 0, HAFT_SIMD_WIDTH * sizeof(double));
    if (what != FORCE) {
        memset(out->slope + i, 0, HAFT_SIMD_WIDTH * sizeof(double));
        memset(out->potential + i, 0, HAFT_SIMD_WIDTH * sizeof(double));
    }
    if (what == ALL) {
        memset(out->curvature + i, 0, HAFT_SIMD_WIDTH * sizeof(double));
    }
}

HAFT_INLINE size_t evaluate_asked(const haft_law_rows *rows, size_t first, size_t n,
                                  const double *d, asked what, const haft_law_values *out) {
    size_t zeros = 0;
    for (size_t i = 0; i < n; i += HAFT_SIMD_WIDTH) {
        const double *v = rows->value + first + i;
        if (all_zero(v, rows->stride, d + i)) {
            set_zero(what, out, i);
            zeros += zeros == i ? HAFT_SIMD_WIDTH : 0;
            continue;
        }
        if (any_behind_wall(v, rows->stride, d + i)) {
            evaluate_from(rows, v, true, what, d, out, i);
        } else {
            evaluate_from(rows, v, false, what, d, out, i);
        }
    }
    return zeros < n ? zeros : n;
}

HAFT_CLONES static size_t evaluate_wings(const haft_law_rows *rows, size_t first, size_t n,
                                         const double *d, asked what, const haft_law_values *out) {
    switch (what) { /* what is asked for is a constant in each */
    case FORCE:
        return evaluate_asked(rows, first, n, d, FORCE, out);
    case NO_CURVATURE:
        return evaluate_asked(rows, first, n, d, NO_CURVATURE, out);
    default:
        return evaluate_asked(rows, first, n, d, ALL, out);
    }
}

/* The number of leading laws that evaluated to zero: all n, or a multiple of the SIMD width. */
static size_t count_zeros(size_t n, const haft_law_values *out) {
    size_t i = 0;
    while (i < n && out->force[i] == 0 &&
           (out->slope == NULL || (out->slope[i] == 0 && out->potential[i] == 0)) &&
           (out->curvature == NULL || out->curvature[i] == 0)) {
        i++;
    }
    return i < n ? i / HAFT_SIMD_WIDTH * HAFT_SIMD_WIDTH : n;
}

/* Morse laws of the last, incomplete group, through arrays that are complete. @return as
 * evaluate_wings() */
static size_t evaluate_rest(const haft_law_rows *rows, size_t first, size_t n, const double *d,
                            asked what, const haft_law_values *out, size_t i) {
    double gap[HAFT_SIMD_WIDTH], value[4][HAFT_SIMD_WIDTH];
    haft_law_values own = {value[0], what != FORCE ? value[1] : NULL, what == ALL ? value[2] : NULL,
                           what != FORCE ? value[3] : NULL};
    size_t count = n - i, size = count * sizeof *d;
    for (size_t k = 0; k < HAFT_SIMD_WIDTH; k++) {
        gap[k] = d[i + (k < count ? k : 0)];
    }
    size_t zeros = evaluate_wings(rows, first + i, count, gap, what, &own);
    memcpy(out->force + i, own.force, size);
    if (what != FORCE) {
        memcpy(out->slope + i, own.slope, size);
        memcpy(out->potential + i, own.potential, size);
    }
    if (what == ALL) {
        memcpy(out->curvature + i, own.curvature, size);
    }
    return zeros;
}

size_t haft_law_rows_evaluate(const haft_law_rows *rows, size_t first, size_t n, const double *d,
                              const haft_law_values *out) {
    asked what = out->slope == NULL ? FORCE : out->curvature == NULL ? NO_CURVATURE : ALL;
    size_t zeros = 0, whole = n / HAFT_SIMD_WIDTH * HAFT_SIMD_WIDTH;
    if (rows->tables < rows->laws) {
        zeros = evaluate_wings(rows, first, whole, d, what, out);
        if (whole < n) {
            size_t more = evaluate_rest(rows, first, n, d, what, out, whole);
            zeros += zeros == whole ? more : 0;
        }
    }
    if (rows->tables > 0) {
        haft_law_tables_evaluate(rows->table + first, n, d, out);
        zeros = count_zeros(n, out);
    }
    return rows->far != NULL ? haft_law_add_far(rows->far, n, d, out, zeros) : zeros;
}
