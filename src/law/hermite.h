/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The monotone cubic between two points of a curve, shared by the table and by characterise. */
#ifndef HAFT_LAW_HERMITE_H
#define HAFT_LAW_HERMITE_H

#include "haft/base.h"

/* f(t) = c[0] + c[1] t + c[2] t^2 + c[3] t^3, 0 <= t <= width. */
typedef struct haft_hermite {
    double c[4];
    double width;
} haft_hermite;

/* Whether x is finite and strictly increasing and f finite. */
bool haft_hermite_is_curve(size_t n, const double *x, const double *f);

/* Whether the grid is even: no x differs by more than a millionth of a step. */
bool haft_hermite_is_even(size_t n, const double *x);

/* A piece's values and slopes at its left and right end. */
typedef struct haft_hermite_ends {
    double value[2], slope[2];
} haft_hermite_ends;

/* The values and slopes at the ends of [x[i], x[i + 1]], as below. */
haft_hermite_ends haft_hermite_at_ends(size_t n, const double *x, const double *f, size_t i);

/* The cubic with given values and slopes at its ends. */
haft_hermite haft_hermite_from_ends(haft_hermite_ends ends, double width);

/* The cubic of [x[i], x[i + 1]] with slopes that keep it monotone; n >= 3. The last point counts as
 * f = 0 with slope 0, whatever f holds there. */
haft_hermite haft_hermite_interval(size_t n, const double *x, const double *f, size_t i);

static inline double haft_hermite_value(const haft_hermite *cubic, double t) {
    const double *c = cubic->c;
    return c[0] + t * (c[1] + t * (c[2] + t * c[3]));
}

/* Integral from s to t, to the rounding of (t - s) times the terms of f: without a difference of
 * two antiderivatives. */
static inline double haft_hermite_integral(const haft_hermite *cubic, double s, double t) {
    const double *c = cubic->c;
    double sum = s + t, squares = s * s + t * t;
    return (t - s) * (c[0] + 0.5 * c[1] * sum + 1.0 / 3 * c[2] * (squares + s * t) +
                      0.25 * c[3] * sum * squares);
}

/* The place where a cubic that is monotone on its width takes `value`, between its end values. */
double haft_hermite_solve(const haft_hermite *cubic, double value);

/* The largest |slope| on the width. */
double haft_hermite_steepest(const haft_hermite *cubic);

#endif
