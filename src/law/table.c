/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A curve as a C1 law: cubics between its points, the first tangent to the left of them, nothing to
 * the right. The potential is the exact integral of the cubics, summed from the right end once.
 * Even grids are looked up by arithmetic, others by bisection. */
#include "law/table.h"

#include <math.h>

#include "law/hermite.h"

enum { CACHE_LINE = 64 };

/* One line of the cache: a beam's laws together are larger than it. */
typedef struct piece {
    _Alignas(CACHE_LINE) haft_hermite cubic;
    double start;     /* gap at its left end */
    double potential; /* there */
} piece;

struct haft_law_table {
    size_t pieces;
    bool even;
    double first, last, per_step;
    double f_max, d_max; /* 0 and NaN if it never pulls */
    double range;
    piece piece[];
};

static double greatest(size_t n, const double *f, double sign, size_t *where) {
    double most = 0;
    for (size_t i = 0; i < n; i++) {
        if (sign * f[i] > most) {
            most = sign * f[i];
            *where = i;
        }
    }
    return most;
}

static haft_status check(size_t n, const double *distance, const double *force, double scale,
                         haft_error *error) {
    if (force[0] < 0) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "the curve pulls (%g Pa) at its first distance, %g m, where a law "
                              "needs a wall; begin it at a smaller distance",
                              force[0], distance[0]);
    }
    if (fabs(force[n - 1]) > HAFT_LAW_PROMINENCE * scale) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "the curve has not died away (%g Pa) at its last distance, %g m; "
                              "carry it on to a larger distance",
                              force[n - 1], distance[n - 1]);
    }
    return HAFT_OK;
}

/* A Morse law is steepest, where it pulls, at its zero: 4 a f_max. So four times f_max over the
 * steepest slope of a table's pull is the range that the same law has as Morse. The wall is steep
 * without telling how wide the well is: it is left out, unless there is nothing else. */
static void find_range(haft_law_table *table, double scale) {
    double steepest = 0, pushes_up_to = table->f_max > 0 ? 0 : scale;
    for (size_t i = 0; i < table->pieces; i++) {
        const haft_hermite *cubic = &table->piece[i].cubic;
        if (cubic->c[0] <= pushes_up_to) {
            steepest = fmax(steepest, haft_hermite_steepest(cubic));
        }
    }
    table->range = steepest > 0 ? 4 * scale / steepest : table->last - table->first;
}

haft_status haft_law_table_create(haft_law_table **out, size_t n, const double *distance,
                                  const double *force, haft_error *error) {
    *out = NULL;
    if (n < 4) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                              "a law's table needs at least 4 points, not %zu", n);
    }
    if (!haft_hermite_is_curve(n, distance, force)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "a law's table needs finite forces at finite, strictly increasing "
                              "distances");
    }
    size_t at = n;
    double pull = greatest(n, force, -1, &at);
    size_t pushes_at = 0;
    double scale = pull > 0 ? pull : greatest(n, force, 1, &pushes_at);
    haft_status status = check(n, distance, force, scale, error);
    if (status != HAFT_OK) {
        return status;
    }
    haft_law_table *table =
        haft_memory_alloc(1, sizeof *table + (n - 1) * sizeof table->piece[0], error);
    if (table == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    table->pieces = n - 1;
    table->first = distance[0];
    table->last = distance[n - 1];
    table->even = haft_hermite_is_even(n, distance);
    table->per_step = (double)(n - 1) / (table->last - table->first);
    table->f_max = pull;
    table->d_max = pull > 0 ? distance[at] : NAN;
    double potential = 0;
    for (size_t i = n - 1; i-- > 0;) {
        haft_hermite cubic = haft_hermite_interval(n, distance, force, i);
        potential += haft_hermite_integral(&cubic, cubic.width);
        table->piece[i] = (piece){cubic, distance[i], potential};
    }
    find_range(table, scale);
    *out = table;
    return HAFT_OK;
}

void haft_law_table_destroy(haft_law_table **table) {
    if (table != NULL && *table != NULL) {
        haft_memory_free(*table);
        *table = NULL;
    }
}

/* The piece that holds d, first <= d < last. */
static inline const piece *find_piece(const haft_law_table *table, double d) {
    const piece *all = table->piece;
    size_t low = 0, high = table->pieces;
    if (table->even) {
        low = (size_t)((d - table->first) * table->per_step);
        low = low < table->pieces ? low : table->pieces - 1;
        double t = d - all[low].start;
        if (t < 0) {
            return all + low - (low > 0);
        }
        return all + low + (t >= all[low].cubic.width && low + 1 < table->pieces);
    }
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        if (all[middle].start <= d) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return all + low;
}

static inline haft_law_value evaluate(const haft_law_table *table, double d) {
    if (d >= table->last) {
        return (haft_law_value){0};
    }
    const piece *p = table->piece;
    const double *c = p->cubic.c;
    double t = d - table->first;
    if (t < 0) {
        return (haft_law_value){.force = c[0] + c[1] * t,
                                .slope = c[1],
                                .potential = p->potential - t * (c[0] + 0.5 * c[1] * t)};
    }
    p = find_piece(table, d);
    c = p->cubic.c;
    t = d - p->start;
    return (haft_law_value){
        .force = haft_hermite_value(&p->cubic, t),
        .slope = c[1] + t * (2 * c[2] + t * 3 * c[3]),
        .curvature = 2 * c[2] + 6 * c[3] * t,
        .potential = p->potential - haft_hermite_integral(&p->cubic, t),
    };
}

haft_law_value haft_law_table_evaluate(const haft_law_table *table, double d) {
    return evaluate(table, d);
}

void haft_law_tables_evaluate(const haft_law_table *const *table, size_t n, const double *d,
                              const haft_law_values *out) {
    for (size_t i = 0; i < n; i++) {
        if (table[i] != NULL) {
            haft_law_value x = evaluate(table[i], d[i]);
            out->force[i] = x.force;
            out->slope[i] = x.slope;
            out->curvature[i] = x.curvature;
            out->potential[i] = x.potential;
        }
    }
}

haft_law haft_law_from_table(const haft_law_table *table) {
    const piece *p = table->piece;
    return (haft_law){.kind = HAFT_LAW_TABLE,
                      .f_max = table->f_max,
                      .d_max = table->d_max,
                      .wall_distance = table->first,
                      .wall_force = p->cubic.c[0],
                      .wall_slope = p->cubic.c[1],
                      .wall_potential = p->potential,
                      .table = table};
}

double haft_law_table_reach(const haft_law_table *table, double share) {
    bool pulls = table->f_max > 0;
    double level = pulls ? -share * table->f_max : 0;
    for (size_t i = table->pieces; i-- > 0;) {
        const piece *p = &table->piece[i];
        double start = p->cubic.c[0];
        double end = i + 1 < table->pieces ? table->piece[i + 1].cubic.c[0] : 0.0;
        if (pulls && start <= level && end > level) {
            return p->start + haft_hermite_solve(&p->cubic, level);
        }
        if (!pulls && start > 0) {
            return i + 1 < table->pieces ? table->piece[i + 1].start : table->last;
        }
    }
    return table->first;
}

double haft_law_table_range(const haft_law_table *table) {
    return table->range;
}
