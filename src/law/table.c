/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A curve as a C1 law: cubics between its points, the tangent to the left of them, zero to the
 * right. The potential is the exact integral of the cubics, summed from the right end once.
 *
 * A cubic is evaluated in the Hermite basis, and its potential from its right end, so that close
 * to an end only the numbers of that end count. In powers from the left end, a small force or
 * potential at the right end of a steep piece would be the difference of large numbers.
 *
 * Even grids are looked up by arithmetic, others by bisection. */
#include "law/table.h"

#include <math.h>

#include "law/hermite.h"

enum { CACHE_LINE = 64, AHEAD = 16, LEAST_POINTS = 4 };

/* One cache line, because the laws of a beam do not fit into the cache. */
typedef struct piece {
    _Alignas(CACHE_LINE) double force[2]; /* at its ends */
    double rise[2];                       /* the slopes there times the width */
    double width;
    double start;     /* gap at its left end */
    double potential; /* at its right end */
} piece;

struct haft_law_table {
    size_t pieces;
    double first, last, per_step; /* as in its head */
    double f_max, d_max;          /* 0 and NaN if it never pulls */
    double range;
    double wall_potential; /* at its first point */
    piece piece[];
};

static haft_hermite cubic_of(const piece *p) {
    haft_hermite_ends ends = {{p->force[0], p->force[1]},
                              {p->rise[0] / p->width, p->rise[1] / p->width}};
    return haft_hermite_from_ends(ends, p->width);
}

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

/* A law needs a wall: it must push at its first point, and less at the next one. Otherwise
 * nothing stops a site from sinking through the substrate. So points before the first one that
 * is followed by a lower one are left out. @return how many; a curve without any force keeps all
 * its points. */
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

static double steepest_of(const piece *p) {
    haft_hermite cubic = cubic_of(p);
    return haft_hermite_steepest(&cubic);
}

/* A Morse law is steepest, where it pulls, at its zero: 4 a f_max. So four times f_max over the
 * steepest slope of a table beyond its wall is the range that the same law has as Morse. The wall
 * is steep without telling how wide the well is: it is left out, unless there is nothing else. A
 * table may push again beyond its well. */
static void find_range(haft_law_table *table, double scale) {
    double steepest = 0;
    bool beyond_wall = !(table->f_max > 0);
    for (size_t i = 0; i < table->pieces; i++) {
        beyond_wall |= table->piece[i].force[0] <= 0;
        if (beyond_wall) {
            steepest = fmax(steepest, steepest_of(&table->piece[i]));
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
    double potential = 0;
    for (size_t i = n - 1; i-- > 0;) {
        haft_hermite_ends at = haft_hermite_at_ends(n, distance, force, i);
        double h = distance[i + 1] - distance[i];
        double rise[2] = {h * at.slope[0], h * at.slope[1]};
        table->piece[i] =
            (piece){{at.value[0], at.value[1]}, {rise[0], rise[1]}, h, distance[i], potential};
        potential += h * (0.5 * (at.value[0] + at.value[1]) + (rise[0] - rise[1]) / 12);
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

/* The last piece that starts at d or before; the first if there is none. */
static inline const piece *last_before(const haft_law_table *table, double d) {
    size_t low = 0, high = table->pieces;
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        if (table->piece[middle].start <= d) {
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
    return last_before(table, d);
}

/* The piece that holds d, first <= d < last, next to the one guessed or that itself. */
static inline const piece *correct(const haft_law_table *table, const piece *guess, double d) {
    double t = d - guess->start;
    if (t < 0 && guess > table->piece) {
        return guess - 1;
    }
    return t >= guess->width && guess + 1 < table->piece + table->pieces ? guess + 1 : guess;
}

/* Cubics to be evaluated side by side, each at t from its left end; behind a wall t < 0, and the
 * potential is that at the left end. */
typedef struct cubics {
    double t[AHEAD], width[AHEAD], force[2][AHEAD], rise[2][AHEAD], potential[AHEAD];
} cubics;

/* Puts a table's cubic at d into lane i; beyond its end that is nothing. */
static inline void put_cubic(cubics *cubic, size_t i, haft_table_head head, const piece *guess,
                             double d) {
    static const piece NOTHING = {.width = 1};
    bool beyond = guess == NULL, wall = d < head.first;
    const piece *p = beyond ? &NOTHING : wall ? head.table->piece : correct(head.table, guess, d);
    cubic->t[i] = beyond ? 0 : d - p->start;
    cubic->width[i] = p->width;
    for (int end = 0; end < 2; end++) {
        cubic->force[end][i] = p->force[end];
        cubic->rise[end][i] = p->rise[end];
    }
    cubic->potential[i] = wall ? head.table->wall_potential : p->potential;
}

/* With x = t / width and y = 1 - x,
 *     f   = y^2 (f0 (1 + 2 x) + r0 x) + x^2 (f1 (1 + 2 y) - r1 y),
 *     Phi = Phi1 + width (f0 (y^3 - y^4/2) + r0 (y^3/3 - y^4/4)
 *                       + f1 (y - y^3 + y^4/2) - r1 (y^2/2 - 2 y^3/3 + y^4/4)),
 * and behind the wall the tangent at t = 0. */
static inline haft_law_value value_in_lane(const cubics *cubic, size_t i) {
    double t = cubic->t[i], h = cubic->width[i], per_h = 1 / h, x = t * per_h, y = 1 - x;
    double f0 = cubic->force[0][i], f1 = cubic->force[1][i];
    double r0 = cubic->rise[0][i], r1 = cubic->rise[1][i], slope0 = r0 * per_h;
    bool wall = t < 0;
    double force = y * y * (f0 * (1 + 2 * x) + r0 * x) + x * x * (f1 * (1 + 2 * y) - r1 * y);
    double slope = 6 * x * y * (f1 - f0) + r0 * y * (1 - 3 * x) + r1 * x * (1 - 3 * y);
    double curvature = 6 * (1 - 2 * x) * (f1 - f0) + r0 * (6 * x - 4) + r1 * (6 * x - 2);
    double right =
        y * (y * y * (f0 * (1 - 0.5 * y) + r0 * (1.0 / 3 - 0.25 * y)) +
             f1 * (1 - y * y * (1 - 0.5 * y)) - r1 * y * (0.5 - y * (2.0 / 3 - 0.25 * y)));
    return (haft_law_value){
        .force = wall ? f0 + slope0 * t : force,
        .slope = wall ? slope0 : slope * per_h,
        .curvature = wall ? 0 : curvature * per_h * per_h,
        .potential = cubic->potential[i] + (wall ? -t * (f0 + 0.5 * slope0 * t) : h * right),
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
                      .wall_force = p->force[0],
                      .wall_slope = p->rise[0] / p->width,
                      .wall_potential = table->wall_potential,
                      .table = table};
}

size_t haft_law_table_points(const haft_law_table *table) {
    return table->pieces + 1;
}

double haft_law_table_point(const haft_law_table *table, size_t i) {
    return i < table->pieces ? table->piece[i].start : table->last;
}

double haft_law_table_force(const haft_law_table *table, size_t i) {
    return table->piece[i].force[0];
}

/* Where the last of the pushes ends, of a table that never pulls. */
static double end_of_push(const haft_law_table *table) {
    for (size_t i = table->pieces; i-- > 0;) {
        if (table->piece[i].force[0] > 0) {
            return i + 1 < table->pieces ? table->piece[i + 1].start : table->last;
        }
    }
    return table->first;
}

/* Where the last piece that begins beyond `level`, and so ends within it, passes it: the last that
 * pulls so much, or with `pushes` also the last that pushes so much. */
static double last_passage(const haft_law_table *table, double level, bool pushes) {
    for (size_t i = table->pieces; i-- > 0;) {
        const piece *p = &table->piece[i];
        if (p->force[0] <= -level || (pushes && p->force[0] >= level)) {
            haft_hermite cubic = cubic_of(p);
            return p->start + haft_hermite_solve(&cubic, copysign(level, p->force[0]));
        }
    }
    return table->first;
}

double haft_law_table_reach(const haft_law_table *table, double share) {
    return table->f_max > 0 ? last_passage(table, share * table->f_max, false) : end_of_push(table);
}

double haft_law_table_extent(const haft_law_table *table, double share) {
    return table->f_max > 0 ? last_passage(table, share * table->f_max, true) : end_of_push(table);
}

haft_law_lengths haft_law_table_lengths(const haft_law_table *table) {
    double f = table->f_max, range = table->range, edge = table->last, steepest = 0;
    for (size_t i = table->pieces; i-- > 0;) { /* 4 f_max over the slope, as for the range */
        double slope = steepest_of(&table->piece[i]);
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
