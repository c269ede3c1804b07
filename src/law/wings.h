/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The Morse law written out without a branch, so that a loop over sites becomes vector code: one
 * exponential, both wings and the wall, and what holds is chosen at the end. */
#ifndef HAFT_LAW_WINGS_H
#define HAFT_LAW_WINGS_H

#include "haft/law.h"
#include "law/exponential.h"

/* Decay lengths beyond which a law is nothing: e^-100 is lost beside any other force. */
#define HAFT_LAW_DECAYS 100.0

/* A Morse law's numbers as its evaluation takes them. */
typedef struct haft_wings {
    double f_max, d_max, a_left, a_right;
    double half_left, length_right; /* 1/(2 a_left) and 1/a_right [m] */
    double wall_distance, wall_force, wall_slope, wall_potential;
} haft_wings;

/* Between which the exponent is kept: what lies beyond is zero, or behind a wall. Given from
 * outside, it costs two operations; of numbers that it knows a compiler makes ten. */
typedef struct haft_wings_bounds {
    double least, most;
} haft_wings_bounds;

static inline haft_wings_bounds haft_law_wings_bounds(void) {
    return (haft_wings_bounds){-HAFT_LAW_DECAYS, 700};
}

static inline haft_wings haft_law_wings(const haft_law *law) {
    return (haft_wings){law->f_max,
                        law->d_max,
                        law->a_left,
                        law->a_right,
                        1 / (2 * law->a_left),
                        1 / law->a_right,
                        law->wall_distance,
                        law->wall_force,
                        law->wall_slope,
                        law->wall_potential};
}

/* Without `walls`, d must not be behind the law's. With E = exp(-a (d - d_max)) the right wing's
 * potential is f_max E (E/2 - 2) / a; the left one's above that of the bottom f_max (E - 1) (E - 3)
 * / (2 a), the bottom's -1.5 f_max / a_right. */
HAFT_INLINE haft_law_value haft_law_wings_evaluate(haft_wings w, double d, haft_wings_bounds bounds,
                                                   bool walls) {
    double y = d - w.d_max, t = d - w.wall_distance;
    double a = y >= 0 ? w.a_right : w.a_left;
    double x = -a * y;
    x = x < bounds.least ? bounds.least : x;
    x = x > bounds.most ? bounds.most : x;
    double E = haft_law_exponential(x), F = w.f_max;
    double left = (E - 1) * (E - 3) * w.half_left - 1.5 * w.length_right;
    double right = E * (0.5 * E - 2) * w.length_right;
    double force = F * E * (E - 2), slope = -2 * a * F * E * (E - 1);
    double curvature = 2 * a * a * F * E * (2 * E - 1);
    double potential = F * (y >= 0 ? right : left);
    bool behind = walls && t < 0;
    double wall_force = w.wall_force + w.wall_slope * t;
    double wall_potential = w.wall_potential - t * (w.wall_force + 0.5 * w.wall_slope * t);
    bool zero = w.a_right * y > HAFT_LAW_DECAYS;
    return (haft_law_value){
        .force = behind ? wall_force
                 : zero ? 0
                        : force,
        .slope = behind ? w.wall_slope
                 : zero ? 0
                        : slope,
        .curvature = behind || zero ? 0 : curvature,
        .potential = behind ? wall_potential
                     : zero ? 0
                            : potential,
    };
}

#endif
