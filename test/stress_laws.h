/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Laws of the random-beam stress: what they are made of, and their values in long double by code of
 * the test's own. The formulas are those of law.h: the Morse law of a vector in closed form, and
 * the monotone cubic table of Hyman (1983) and Fritsch and Butland (1984). */
#ifndef HAFT_TEST_STRESS_LAWS_H
#define HAFT_TEST_STRESS_LAWS_H

#include "check.h"
#include "haft/law.h"

enum { STRESS_POINTS = 400 }; /* of a table, at most */

/* One law. A table's points and cubics are owned. */
typedef struct stress_law {
    haft_law_vector vector; /* of a Morse law */
    double f_limit;
    size_t points; /* of a table; 0: Morse */
    double *x, *f;
    long double (*piece)[5]; /* cubic and the potential at the piece's left end */
    haft_law_table *table;
    haft_law law;        /* the library's */
    double range, reach; /* the library's, for tolerances alone: a thousandth of the pull is felt */
} stress_law;

typedef struct stress_value {
    long double force, slope, potential;
} stress_value;

static inline stress_value stress_morse_wings(const stress_law *l, long double d) {
    const haft_law_vector *v = &l->vector;
    long double width = (long double)v->d_max - v->d_limit, F = v->f_max;
    long double left = logl(1 + sqrtl(1 + l->f_limit / F)) / width;
    long double right = 1.5L / (v->e / F - 1 / (2 * left));
    long double y = d - v->d_max, a = y >= 0 ? right : left, E = expl(-a * y);
    stress_value out = {F * E * (E - 2), -2 * a * F * E * (E - 1), 0};
    out.potential = y >= 0 ? F * E * (E / 2 - 2) / right
                           : F * (E - 1) * (E - 3) / (2 * left) - 1.5L * F / right;
    return out;
}

static inline stress_value stress_tangent(stress_value wall, long double t) {
    return (stress_value){wall.force + wall.slope * t, wall.slope,
                          wall.potential - t * (wall.force + wall.slope * t / 2)};
}

static inline stress_value stress_cubic(const long double c[5], long double t) {
    return (stress_value){c[0] + t * (c[1] + t * (c[2] + t * c[3])),
                          c[1] + t * (2 * c[2] + t * 3 * c[3]),
                          c[4] - t * (c[0] + t * (c[1] / 2 + t * (c[2] / 3 + t * c[3] / 4)))};
}

static inline stress_value stress_table_value(const stress_law *l, long double d) {
    if (d < l->x[0]) {
        const long double *c = l->piece[0];
        return stress_tangent((stress_value){c[0], c[1], c[4]}, d - l->x[0]);
    }
    if (d >= l->x[l->points - 1]) {
        return (stress_value){0};
    }
    size_t low = 0, high = l->points - 1;
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        *(l->x[middle] <= d ? &low : &high) = middle;
    }
    return stress_cubic(l->piece[low], d - l->x[low]);
}

static inline stress_value stress_law_value(const stress_law *l, long double d) {
    if (l->points > 0) {
        return stress_table_value(l, d);
    }
    double wall = l->vector.d_limit;
    return d < wall ? stress_tangent(stress_morse_wings(l, wall), d - wall)
                    : stress_morse_wings(l, d);
}

/* ---- the table's cubics -----------------------------------------------------------------------
 */

static inline double stress_secant(const stress_law *l, size_t i) {
    double next = i + 2 == l->points ? 0 : l->f[i + 1]; /* the last point counts as 0 */
    return (next - l->f[i]) / (l->x[i + 1] - l->x[i]);
}

static inline bool stress_is_even(const double *x) {
    double step = (x[4] - x[0]) / 4;
    for (int i = 1; i < 5; i++) {
        if (!(fabs(x[i] - (x[0] + i * step)) <= 1e-6 * step)) {
            return false;
        }
    }
    return true;
}

static inline long double stress_slope(const stress_law *l, size_t i) {
    if (i + 1 == l->points) {
        return 0;
    }
    if (i == 0) {
        double h0 = l->x[1] - l->x[0], h1 = l->x[2] - l->x[1];
        double s0 = stress_secant(l, 0), slope = s0 + (s0 - stress_secant(l, 1)) * h0 / (h0 + h1);
        return fmax(fmin(slope, 0.5 * s0), 3 * s0);
    }
    double h0 = l->x[i] - l->x[i - 1], h1 = l->x[i + 1] - l->x[i];
    double s0 = stress_secant(l, i - 1), s1 = stress_secant(l, i);
    if (!(s0 * s1 > 0)) {
        return 0;
    }
    if (i < 2 || i + 2 >= l->points || !stress_is_even(l->x + i - 2)) {
        return 3 * (h0 + h1) / ((2 * h1 + h0) / s0 + (h1 + 2 * h0) / s1);
    }
    double slope = (7 * (s0 + s1) - stress_secant(l, i - 2) - stress_secant(l, i + 1)) / 12;
    double sign = s0 > 0 ? 1 : -1, most = 3 * fmin(fabs(s0), fabs(s1));
    return sign * fmin(fmax(sign * slope, 0), most);
}

static inline void stress_law_cut(stress_law *l) {
    size_t n = l->points;
    long double potential = 0;
    l->piece = calloc(n - 1, sizeof *l->piece);
    for (size_t i = n - 1; i-- > 0;) {
        long double h = (long double)l->x[i + 1] - l->x[i], m0 = stress_slope(l, i),
                    m1 = stress_slope(l, i + 1), end = i + 2 == n ? 0 : l->f[i + 1],
                    s = (end - l->f[i]) / h, *c = l->piece[i];
        c[0] = l->f[i];
        c[1] = m0;
        c[2] = (3 * s - 2 * m0 - m1) / h;
        c[3] = (m0 + m1 - 2 * s) / (h * h);
        potential += h * (c[0] + h * (c[1] / 2 + h * (c[2] / 3 + h * c[3] / 4)));
        c[4] = potential;
    }
}

/* ---- making them ------------------------------------------------------------------------------
 */

/* A Morse law of two exponents [1/m], its wall where the push is `limit` times the pull.
 * @return false if the library refuses it. */
static inline bool stress_law_morse(stress_law *l, double f_max, double d_max, double left,
                                    double right, double limit) {
    *l = (stress_law){.f_limit = limit * f_max};
    l->vector = (haft_law_vector){f_max * (0.5 / left + 1.5 / right), f_max, d_max,
                                  d_max - log(1 + sqrt(1 + limit)) / left};
    if (haft_law_morse(&l->law, &l->vector, l->f_limit) != HAFT_LAW_SOUND) {
        return false;
    }
    l->range = haft_law_range(&l->law);
    l->reach = haft_law_reach(&l->law, 1e-3);
    return true;
}

/* The table of n points, which are copied, but for those at the start from which the curve rises.
 * @return false if the library refuses it. */
static inline bool stress_law_table(stress_law *l, size_t n, const double *x, const double *f,
                                    haft_error *error) {
    *l = (stress_law){.points = n};
    if (haft_law_table_create(&l->table, n, x, f, error) != HAFT_OK) {
        return false;
    }
    while (f[1] >= f[0]) {
        x++, f++, n--;
    }
    l->points = n;
    l->x = malloc(2 * n * sizeof *l->x);
    l->f = l->x + n;
    memcpy(l->x, x, n * sizeof *x);
    memcpy(l->f, f, n * sizeof *f);
    stress_law_cut(l);
    l->law = haft_law_from_table(l->table);
    l->range = haft_law_range(&l->law);
    l->reach = haft_law_reach(&l->law, 1e-3);
    return true;
}

static inline void stress_law_free(stress_law *l) {
    free(l->x);
    free(l->piece);
    haft_law_table_destroy(&l->table);
}

#endif
