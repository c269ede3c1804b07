/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Piecewise cubic Hermite interpolation that is monotone wherever the points are. Slopes are
 * zero where the neighbouring secants differ in sign. Elsewhere, on an even grid, they are the
 * central differences of fourth order, limited to between 0 and three times the flatter secant
 * (Fritsch and Carlson 1980; Hyman 1983); on others, and beside the ends, a weighted harmonic
 * mean of the secants (Fritsch and Butland 1984). Fourth and third order in the step where the
 * curve is monotone; second order at an extremum, which is flattened. */
#include "law/hermite.h"

#include <math.h>

bool haft_hermite_is_curve(size_t n, const double *x, const double *f) {
    for (size_t i = 0; i < n; i++) {
        if (!isfinite(x[i]) || !isfinite(f[i]) || (i > 0 && !(x[i] > x[i - 1]))) {
            return false;
        }
    }
    return true;
}

bool haft_hermite_is_even(size_t n, const double *x) {
    double step = (x[n - 1] - x[0]) / (double)(n - 1);
    for (size_t i = 1; i < n; i++) {
        if (!(fabs(x[i] - (x[0] + (double)i * step)) <= 1e-6 * step)) {
            return false;
        }
    }
    return true;
}

static double point_value(size_t n, const double *f, size_t i) {
    return i == n - 1 ? 0.0 : f[i];
}

static double secant(size_t n, const double *x, const double *f, size_t i) {
    return (point_value(n, f, i + 1) - point_value(n, f, i)) / (x[i + 1] - x[i]);
}

/* The left end: the parabola's slope, limited so that the cubic stays monotone. Where the curve
 * falls, the tangent, which continues to the left as the law's wall, falls by at least half the
 * secant. */
static double first_slope(size_t n, const double *x, const double *f) {
    double h0 = x[1] - x[0], h1 = x[2] - x[1];
    double s0 = secant(n, x, f, 0), s1 = secant(n, x, f, 1);
    double slope = s0 + (s0 - s1) * h0 / (h0 + h1);
    if (s0 >= 0) {
        return 0;
    }
    return fmax(fmin(slope, 0.5 * s0), 3 * s0);
}

/* Whether the four steps around point i exist and are equal. */
static bool is_even_about(size_t n, const double *x, size_t i) {
    return i >= 2 && i + 2 < n && haft_hermite_is_even(5, x + i - 2);
}

static double slope_at(size_t n, const double *x, const double *f, size_t i) {
    if (i == 0) {
        return first_slope(n, x, f);
    }
    if (i == n - 1) {
        return 0;
    }
    double h0 = x[i] - x[i - 1], h1 = x[i + 1] - x[i];
    double s0 = secant(n, x, f, i - 1), s1 = secant(n, x, f, i);
    if (!((s0 > 0 && s1 > 0) || (s0 < 0 && s1 < 0))) {
        return 0;
    }
    if (!is_even_about(n, x, i)) {
        return 3 * (h0 + h1) / ((2 * h1 + h0) / s0 + (h1 + 2 * h0) / s1);
    }
    double slope = (7 * (s0 + s1) - secant(n, x, f, i - 2) - secant(n, x, f, i + 1)) / 12;
    double steepest = 3 * fmin(fabs(s0), fabs(s1));
    return copysign(fmin(fmax(copysign(1, s0) * slope, 0), steepest), s0);
}

haft_hermite_ends haft_hermite_at_ends(size_t n, const double *x, const double *f, size_t i) {
    return (haft_hermite_ends){{point_value(n, f, i), point_value(n, f, i + 1)},
                               {slope_at(n, x, f, i), slope_at(n, x, f, i + 1)}};
}

haft_hermite haft_hermite_from_ends(haft_hermite_ends ends, double width) {
    double h = width, m0 = ends.slope[0], m1 = ends.slope[1];
    double s = (ends.value[1] - ends.value[0]) / h;
    return (haft_hermite){
        .c = {ends.value[0], m0, (3 * s - 2 * m0 - m1) / h, (m0 + m1 - 2 * s) / (h * h)},
        .width = h,
    };
}

haft_hermite haft_hermite_interval(size_t n, const double *x, const double *f, size_t i) {
    return haft_hermite_from_ends(haft_hermite_at_ends(n, x, f, i), x[i + 1] - x[i]);
}

typedef struct reached {
    const haft_hermite *cubic;
    double value;
} reached;

static double above_value(const void *data, double t, double *slope) {
    const reached *r = data;
    const double *c = r->cubic->c;
    *slope = c[1] + t * (2 * c[2] + t * 3 * c[3]);
    return haft_hermite_value(r->cubic, t) - r->value;
}

double haft_hermite_solve(const haft_hermite *cubic, double value) {
    bool rises = haft_hermite_value(cubic, cubic->width) >= cubic->c[0];
    return haft_root_find(above_value, &(reached){cubic, value}, 0, cubic->width, rises);
}

double haft_hermite_steepest(const haft_hermite *cubic) {
    const double *c = cubic->c;
    double h = cubic->width;
    double steepest = fmax(fabs(c[1]), fabs(c[1] + h * (2 * c[2] + h * 3 * c[3])));
    double t = -c[2] / (3 * c[3]);
    if (t > 0 && t < h) {
        steepest = fmax(steepest, fabs(c[1] + t * (2 * c[2] + t * 3 * c[3])));
    }
    return steepest;
}
