/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The one interface to every kind of law. Morse is written out here, where the dispatch is, for it
 * is the solver's innermost function: one branch, one exponential. */
#include <math.h>

#include "law/exponential.h"
#include "law/table.h"

/* Decay lengths beyond which a law is nothing: e^-100 is lost beside any other force. */
#define NIL 100.0

/* The power of e in a Morse law at d; beyond its wall, and where it is nil, nothing is read off it.
 */
static inline double power(const haft_law *law, double d) {
    double y = d - law->d_max;
    double x = -(y >= 0 ? law->a_right : law->a_left) * y;
    x = x < -NIL ? -NIL : x;
    return x > 700 ? 700 : x;
}

/* Whether a Morse law is nothing at d. */
static inline bool is_nil(const haft_law *law, double d) {
    return law->kind == HAFT_LAW_MORSE && d > law->wall_distance &&
           law->a_right * (d - law->d_max) > NIL;
}

/* A Morse law given E = exp of its power. With x = E - 1 the left wing's force is f_max (x^2 - 1)
 * and its potential above that of the bottom f_max x (x - 2) / (2 a). */
static inline haft_law_value morse(const haft_law *law, double d, double E) {
    double t = d - law->wall_distance;
    if (t < 0) {
        return (haft_law_value){.force = law->wall_force + law->wall_slope * t,
                                .slope = law->wall_slope,
                                .potential = law->wall_potential -
                                             t * (law->wall_force + 0.5 * law->wall_slope * t)};
    }
    double y = d - law->d_max;
    bool right = y >= 0;
    double a = right ? law->a_right : law->a_left;
    if (is_nil(law, d)) {
        return (haft_law_value){0};
    }
    double F = law->f_max;
    double left_potential = (E - 1) * (E - 3) / (2 * law->a_left) - 1.5 / law->a_right;
    double right_potential = E * (0.5 * E - 2) / law->a_right;
    return (haft_law_value){
        .force = F * E * (E - 2),
        .slope = -2 * a * F * E * (E - 1),
        .curvature = 2 * a * a * F * E * (2 * E - 1),
        .potential = F * (right ? right_potential : left_potential),
    };
}

haft_law_value haft_law_evaluate(const haft_law *law, double d) {
    return law->kind == HAFT_LAW_MORSE ? morse(law, d, haft_law_exponential(power(law, d)))
                                       : haft_law_table_evaluate(law->table, d);
}

void haft_law_evaluate_many(const haft_law *law, size_t n, const double *d, double *force,
                            double *slope, double *potential) {
    enum { BLOCK = 16 };
    double E[BLOCK];
    for (size_t first = 0; first < n; first += BLOCK) {
        size_t end = n - first < BLOCK ? n : first + BLOCK;
        bool nil = true;
        for (size_t i = first; i < end; i++) {
            E[i - first] = power(&law[i], d[i]);
            nil = nil && is_nil(&law[i], d[i]);
        }
        if (nil) { /* a free span */
            size_t bytes = (end - first) * sizeof *force;
            memset(force + first, 0, bytes);
            memset(slope + first, 0, bytes);
            memset(potential + first, 0, bytes);
            continue;
        }
        for (size_t i = end - first; i < BLOCK; i++) {
            E[i] = 0; /* so that the next loop's length is known to the compiler */
        }
        for (size_t i = 0; i < BLOCK; i++) {
            E[i] = haft_law_exponential(E[i]);
        }
        for (size_t i = first; i < end; i++) {
            haft_law_value v = law[i].kind == HAFT_LAW_MORSE
                                   ? morse(&law[i], d[i], E[i - first])
                                   : haft_law_table_evaluate(law[i].table, d[i]);
            force[i] = v.force;
            slope[i] = v.slope;
            potential[i] = v.potential;
        }
    }
}

double haft_law_reach(const haft_law *law, double share) {
    if (!(share > 0 && share < 1)) {
        return NAN;
    }
    if (law->kind == HAFT_LAW_TABLE) {
        return haft_law_table_reach(law->table, share);
    }
    /* 1 - sqrt(1 - share) without the cancellation. */
    return law->d_max - log(share / (1 + sqrt(1 - share))) / law->a_right;
}

double haft_law_range(const haft_law *law) {
    if (law->kind == HAFT_LAW_TABLE) {
        return haft_law_table_range(law->table);
    }
    return 1 / fmax(law->a_left, law->a_right);
}

const char *haft_law_fault_name(haft_law_fault fault) {
    switch (fault) {
    case HAFT_LAW_SOUND:
        return "sound";
    case HAFT_LAW_NO_ATTRACTION:
        return "no attraction";
    case HAFT_LAW_TWO_WELLS:
        return "two wells";
    case HAFT_LAW_RANGE_LEFT:
        return "range too short on the left";
    case HAFT_LAW_RANGE_RIGHT:
        return "range too short on the right";
    case HAFT_LAW_BOUND:
        return "energy below the bound";
    case HAFT_LAW_INVALID:
        return "invalid numbers";
    case HAFT_LAW_FAULTS:
        break;
    }
    return "unknown";
}
