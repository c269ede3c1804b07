/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The law vector of a sampled curve, and the faults that prevent one. The greatest pull is the
 * vertex of a parabola, because the monotone interpolant flattens the minimum. Energy and limit
 * are exact for the interpolant. Allocates no memory. */
#include <math.h>

#include "haft/law.h"
#include "law/hermite.h"

static double pull(double force) {
    return fmax(-force, 0);
}

/* Whether the pull rises again by more than `barrier` on the way from its maximum outwards. */
static bool rises_again(const double *force, size_t from, size_t to, double barrier) {
    double least = INFINITY;
    size_t i = from;
    for (;;) {
        least = fmin(least, pull(force[i]));
        if (pull(force[i]) - least > barrier) {
            return true;
        }
        if (i == to) {
            return false;
        }
        i = to > from ? i + 1 : i - 1;
    }
}

/* The integral of the negative part; between two points the cubic changes sign once at most. */
double haft_law_energy(size_t n, const double *distance, const double *force) {
    double sum = 0;
    for (size_t i = 0; i + 1 < n; i++) {
        haft_hermite cubic = haft_hermite_interval(n, distance, force, i);
        double end = i + 2 < n ? force[i + 1] : 0.0;
        double low = 0, high = cubic.width;
        if (cubic.c[0] > 0 && end < 0) {
            low = haft_hermite_solve(&cubic, 0);
        } else if (cubic.c[0] < 0 && end > 0) {
            high = haft_hermite_solve(&cubic, 0);
        } else if (cubic.c[0] >= 0 && end >= 0) {
            continue;
        }
        sum -= haft_hermite_integral(&cubic, low, high);
    }
    return sum;
}

/* The vertex of the parabola through the greatest pull and its neighbours. */
static void bottom(const double *distance, const double *force, size_t at,
                   haft_law_vector *vector) {
    double left = force[at - 1], middle = force[at], right = force[at + 1];
    double bend = (left - middle) + (right - middle);
    double shift = bend > 0 ? 0.5 * (left - right) / bend : 0;
    vector->d_max = distance[at] + shift * 0.5 * (distance[at + 1] - distance[at - 1]);
    vector->f_max = -middle + 0.25 * (left - right) * shift;
}

haft_law_fault haft_law_characterise(size_t n, const double *distance, const double *force,
                                     double f_limit, haft_law_vector *vector) {
    if (n < 4 || !isfinite(f_limit) || f_limit == 0 || !haft_hermite_is_curve(n, distance, force) ||
        !haft_hermite_is_even(n, distance)) {
        return HAFT_LAW_INVALID;
    }
    size_t at = 0;
    for (size_t i = 1; i < n; i++) {
        at = force[i] < force[at] ? i : at;
    }
    double barrier = HAFT_LAW_PROMINENCE * pull(force[at]);
    if (!(force[at] < 0)) {
        return HAFT_LAW_NO_ATTRACTION;
    }
    if (at == n - 1 || fabs(force[n - 1]) > barrier) {
        return HAFT_LAW_RANGE_RIGHT;
    }
    if (rises_again(force, at, n - 1, barrier) || rises_again(force, at, 0, barrier)) {
        return HAFT_LAW_TWO_WELLS;
    }
    if (at == 0) {
        return HAFT_LAW_RANGE_LEFT;
    }
    bottom(distance, force, at, vector);
    double limit = haft_law_limit(f_limit, vector->f_max);
    size_t wall = at;
    while (wall > 0 && force[wall] < limit) {
        wall--;
    }
    if (force[wall] < limit) {
        return HAFT_LAW_RANGE_LEFT;
    }
    vector->e = haft_law_energy(n, distance, force);
    haft_hermite cubic = haft_hermite_interval(n, distance, force, wall);
    vector->d_limit = distance[wall] + haft_hermite_solve(&cubic, limit);
    return HAFT_LAW_SOUND;
}
