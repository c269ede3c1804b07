/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A curve as a C1 law: cubics between its points, the first tangent to the left of them, nothing to
 * the right. The potential is the exact integral of the cubics, summed from the right end once.
 * Within a piece it is integrated from the piece's right end: from the left, a small potential
 * would be the difference of two large numbers. Even grids are looked up by arithmetic, others by
 * bisection. */
#include "law/table.h"

#include <math.h>

#include "law/hermite.h"

enum { CACHE_LINE = 64, AHEAD = 16, LEAST_POINTS = 4 };

/* One line of the cache: a beam's laws together are larger than it. */
typedef struct piece {
    _Alignas(CACHE_LINE) haft_hermite cubic;
    double start;     /* gap at its left end */
    double potential; /* at its right end */
    double least;     /* force at the left ends from this one on */
} piece;

struct haft_law_table {
    size_t pieces;
    double first, last, per_step; /* as in its head */
    double f_max, d_max;          /* 0 and NaN if it never pulls */
    double range;
    double wall_potential; /* at its first point */
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

/* A law needs a wall: it must push at its first point, and less at the next one. Otherwise nothing
 * stops a site from sinking through the substrate. So the points before the first that is followed
 * by a fall are left out. @return how many; a curve without any force keeps all its points. */
static size_t rising_points(size_t n, const double *force, double scale) {
    size_t first = 0;
    while (scale > 0 && first + 1 < n && force[first + 1] >= force[first]) {
        first++;
    }
    return first;
}

/* `first` is the point that the wall begins at. */
static haft_status check(size_t n, const double *distance, const double *force, size_t first,
                         double scale, haft_error *error) {
    if (force[0] < 0) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "the curve pulls (%g Pa) at its first distance, %g m, where a law "
                              "needs a wall; begin it at a smaller distance",
                              force[0], distance[0]);
    }
    if (scale > 0 && (!(force[first] > 0) || n - first < LEAST_POINTS)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "the curve does not push and then fall from its first distance, %g m "
                              "(%g Pa), where a law needs a wall; begin it at a smaller distance",
                              distance[0], force[0]);
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
 * steepest slope of a table beyond its wall is the range that the same law has as Morse. The wall
 * is steep without telling how wide the well is: it is left out, unless there is nothing else. A
 * table may push again beyond its well. */
static void find_range(haft_law_table *table, double scale) {
    double steepest = 0;
    bool beyond_wall = !(table->f_max > 0);
    for (size_t i = 0; i < table->pieces; i++) {
        const haft_hermite *cubic = &table->piece[i].cubic;
        beyond_wall |= cubic->c[0] <= 0;
        if (beyond_wall) {
            steepest = fmax(steepest, haft_hermite_steepest(cubic));
        }
    }
    table->range = steepest > 0 ? 4 * scale / steepest : table->last - table->first;
}

/* Makes the table of a curve that has a wall. */
static haft_status create(haft_law_table **out, size_t n, const double *distance,
                          const double *force, haft_error *error) {
    haft_law_table *table =
        haft_memory_alloc(1, sizeof *table + (n - 1) * sizeof table->piece[0], error);
    if (table == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    size_t pulls_at = n, pushes_at = n;
    double pull = greatest(n, force, -1, &pulls_at);
    table->pieces = n - 1;
    table->first = distance[0];
    table->last = distance[n - 1];
    bool even = haft_hermite_is_even(n, distance);
    table->per_step = even ? (double)(n - 1) / (table->last - table->first) : 0;
    table->f_max = pull;
    table->d_max = pull > 0 ? distance[pulls_at] : NAN;
    double potential = 0, least = INFINITY;
    for (size_t i = n - 1; i-- > 0;) {
        haft_hermite cubic = haft_hermite_interval(n, distance, force, i);
        least = fmin(least, cubic.c[0]);
        table->piece[i] = (piece){cubic, distance[i], potential, least};
        potential += haft_hermite_integral(&cubic, 0, cubic.width);
    }
    table->wall_potential = potential;
    find_range(table, pull > 0 ? pull : greatest(n, force, 1, &pushes_at));
    *out = table;
    return HAFT_OK;
}

haft_status haft_law_table_create(haft_law_table **out, size_t n, const double *distance,
                                  const double *force, haft_error *error) {
    *out = NULL;
    if (n < LEAST_POINTS) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                              "a law's table needs at least %d points, not %zu", LEAST_POINTS, n);
    }
    if (!haft_hermite_is_curve(n, distance, force)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "a law's table needs finite forces at finite, strictly increasing "
                              "distances");
    }
    size_t at = n;
    double pull = greatest(n, force, -1, &at);
    double scale = pull > 0 ? pull : greatest(n, force, 1, &at);
    size_t first = rising_points(n, force, scale);
    haft_status status = check(n, distance, force, first, scale, error);
    return status == HAFT_OK ? create(out, n - first, distance + first, force + first, error)
                             : status;
}

void haft_law_table_destroy(haft_law_table **table) {
    if (table != NULL && *table != NULL) {
        haft_memory_free(*table);
        *table = NULL;
    }
}

haft_table_head haft_law_table_head(const haft_law_table *table) {
    return table == NULL ? (haft_table_head){0}
                         : (haft_table_head){table->first, table->last, table->per_step,
                                             (double)(table->pieces - 1), table};
}

/* The last piece whose number at `offset`, which rises from piece to piece, is at most `value`; the
 * first if there is none. */
static inline const piece *last_at_most(const haft_law_table *table, size_t offset, double value) {
    size_t low = 0, high = table->pieces;
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        const char *at = (const char *)&table->piece[middle];
        if (*(const double *)(at + offset) <= value) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return table->piece + low;
}

/* The piece that holds d, or of an even grid perhaps one beside it: found without a look at any.
 * NULL beyond the table's end. */
static inline const piece *guess_piece(haft_table_head head, double d) {
    const haft_law_table *table = head.table;
    if (d >= head.last) {
        return NULL;
    }
    if (head.per_step > 0) {
        double at = (d - head.first) * head.per_step;
        return table->piece + (int)(at > 0 ? at < head.most ? at : head.most : 0);
    }
    return last_at_most(table, offsetof(piece, start), d);
}

/* The piece that holds d, first <= d < last, next to the one guessed or that itself. */
static inline const piece *correct(const haft_law_table *table, const piece *guess, double d) {
    double t = d - guess->start;
    if (t < 0 && guess > table->piece) {
        return guess - 1;
    }
    return t >= guess->cubic.width && guess + 1 < table->piece + table->pieces ? guess + 1 : guess;
}

/* Cubics to be evaluated side by side, each at t from its left end. */
typedef struct cubics {
    double t[AHEAD], end[AHEAD], c[4][AHEAD], potential[AHEAD]; /* the potential at `end` */
} cubics;

/* Puts a table's cubic at d into lane i: nil beyond its end, on its wall the tangent, which ends at
 * the first point. */
static inline void put_cubic(cubics *cubic, size_t i, haft_table_head head, const piece *guess,
                             double d) {
    static const piece NIL;
    bool beyond = guess == NULL, wall = d < head.first;
    const piece *p = beyond ? &NIL : wall ? head.table->piece : correct(head.table, guess, d);
    cubic->t[i] = beyond ? 0 : d - p->start;
    cubic->end[i] = beyond || wall ? 0 : p->cubic.width;
    cubic->c[0][i] = p->cubic.c[0];
    cubic->c[1][i] = p->cubic.c[1];
    cubic->c[2][i] = wall ? 0 : p->cubic.c[2];
    cubic->c[3][i] = wall ? 0 : p->cubic.c[3];
    cubic->potential[i] = wall ? head.table->wall_potential : p->potential;
}

static inline haft_law_value value_in_lane(const cubics *cubic, size_t i) {
    haft_hermite h = {{cubic->c[0][i], cubic->c[1][i], cubic->c[2][i], cubic->c[3][i]}, 0};
    double t = cubic->t[i];
    return (haft_law_value){
        .force = haft_hermite_value(&h, t),
        .slope = h.c[1] + t * (2 * h.c[2] + t * 3 * h.c[3]),
        .curvature = 2 * h.c[2] + 6 * h.c[3] * t,
        .potential = cubic->potential[i] + haft_hermite_integral(&h, t, cubic->end[i]),
    };
}

HAFT_CLONES static void evaluate_cubics(const cubics *restrict cubic, size_t n,
                                        double *restrict force, double *restrict slope,
                                        double *restrict curvature, double *restrict potential) {
    for (size_t i = 0; i < n; i++) {
        haft_law_value x = value_in_lane(cubic, i);
        force[i] = x.force;
        slope[i] = x.slope;
        curvature[i] = x.curvature;
        potential[i] = x.potential;
    }
}

haft_law_value haft_law_table_evaluate(const haft_law_table *table, double d) {
    haft_table_head head = haft_law_table_head(table);
    cubics one;
    put_cubic(&one, 0, head, guess_piece(head, d), d);
    return value_in_lane(&one, 0);
}

/* Up to AHEAD tables: the pieces of all are asked for before the first is used. */
static void evaluate_some(const haft_table_head *head, size_t n, const double *d, size_t first,
                          const haft_law_values *out) {
    const piece *guess[AHEAD];
    cubics cubic;
    for (size_t i = 0; i < n; i++) {
        guess[i] = guess_piece(head[i], d[i]);
        __builtin_prefetch(guess[i]);
    }
    for (size_t i = 0; i < n; i++) {
        put_cubic(&cubic, i, head[i], guess[i], d[i]);
    }
    double spare[3][AHEAD]; /* for what is not asked for */
    evaluate_cubics(&cubic, n, out->force + first,
                    out->slope != NULL ? out->slope + first : spare[0],
                    out->curvature != NULL ? out->curvature + first : spare[1],
                    out->potential != NULL ? out->potential + first : spare[2]);
}

void haft_law_tables_evaluate(const haft_table_head *head, size_t n, const double *d,
                              const haft_law_values *out) {
    for (size_t i = 0; i < n;) {
        size_t end = i;
        while (end < n && end - i < AHEAD && head[end].table != NULL) {
            end++;
        }
        if (end > i) {
            evaluate_some(head + i, end - i, d + i, i, out);
        }
        i = end > i ? end : i + 1;
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
                      .wall_potential = table->wall_potential,
                      .table = table};
}

/* Where the last of the pushes ends, of a table that never pulls. */
static double end_of_push(const haft_law_table *table) {
    for (size_t i = table->pieces; i-- > 0;) {
        if (table->piece[i].cubic.c[0] > 0) {
            return i + 1 < table->pieces ? table->piece[i + 1].start : table->last;
        }
    }
    return table->first;
}

double haft_law_table_reach(const haft_law_table *table, double share) {
    if (!(table->f_max > 0)) {
        return end_of_push(table);
    }
    double level = -share * table->f_max;
    const piece *p = last_at_most(table, offsetof(piece, least), level);
    return p->start + haft_hermite_solve(&p->cubic, level);
}

double haft_law_table_extent(const haft_law_table *table, double share) {
    if (!(table->f_max > 0)) {
        return end_of_push(table);
    }
    double level = share * table->f_max;
    for (size_t i = table->pieces; i-- > 0;) {
        const piece *p = &table->piece[i];
        if (fabs(p->cubic.c[0]) > level) { /* and its right end is not */
            return p->start + haft_hermite_solve(&p->cubic, copysign(level, p->cubic.c[0]));
        }
    }
    return table->first;
}

haft_law_lengths haft_law_table_lengths(const haft_law_table *table) {
    double f = table->f_max, range = table->range, edge = table->last, steepest = 0;
    for (size_t i = table->pieces; i-- > 0;) { /* 4 f_max over the slope, as for the range */
        double slope = haft_hermite_steepest(&table->piece[i].cubic);
        if (slope * HAFT_LAW_WIDER * range > 4 * f) {
            break;
        }
        steepest = fmax(steepest, slope);
        edge = table->piece[i].start;
    }
    bool narrow = edge - table->first < 0.25 * (table->last - table->first);
    return (haft_law_lengths){range, edge,
                              f > 0 && narrow && steepest > 0 ? 4 * f / steepest : range};
}

double haft_law_table_range(const haft_law_table *table) {
    return table->range;
}
