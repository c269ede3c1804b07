/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The two-wing Morse law of a law vector and back, in closed form; no iteration. */
#include <math.h>

#include "haft/law.h"

double haft_law_limit(double f_limit, double f_max) {
    return f_limit > 0 ? f_limit : -f_limit * f_max;
}

double haft_law_share(double share) {
    return -share;
}

haft_law_fault haft_law_morse(haft_law *out, const haft_law_vector *vector, double f_limit) {
    const haft_law_vector v = *vector;
    if (!isfinite(v.e) || !isfinite(v.f_max) || !isfinite(v.d_max) || !isfinite(v.d_limit) ||
        !isfinite(f_limit) || f_limit == 0 || !(v.e > 0) || !(v.f_max > 0) ||
        !(v.d_max > v.d_limit)) {
        return HAFT_LAW_INVALID;
    }
    /* E at the wall, less 1: there E^2 - 2 E = f_limit / f_max. */
    double limit = haft_law_limit(f_limit, v.f_max);
    double rise = sqrt(1 + limit / v.f_max);
    double left = log1p(rise) / (v.d_max - v.d_limit);
    double right_energy = v.e - v.f_max / (2 * left);
    if (!(right_energy > 0)) {
        return HAFT_LAW_BOUND;
    }
    double right = 1.5 * v.f_max / right_energy;
    double slope = -2 * v.f_max * left * (1 + rise) * rise;
    if (!isfinite(slope) || !isfinite(right) || !(right > 0)) {
        return HAFT_LAW_INVALID;
    }
    *out = (haft_law){
        .kind = HAFT_LAW_MORSE,
        .f_max = v.f_max,
        .d_max = v.d_max,
        .a_left = left,
        .a_right = right,
        .wall_distance = v.d_limit,
        .wall_force = limit,
        .wall_slope = slope,
        .wall_potential = v.f_max * (rise * (rise - 2) / (2 * left) - 1.5 / right),
    };
    return HAFT_LAW_SOUND;
}

haft_law_fault haft_law_vector_fault(const haft_law_vector *vector, double f_limit) {
    haft_law law;
    return haft_law_morse(&law, vector, f_limit);
}

haft_law_vector haft_law_morse_vector(const haft_law *law) {
    return (haft_law_vector){
        .e = law->f_max * (0.5 / law->a_left + 1.5 / law->a_right),
        .f_max = law->f_max,
        .d_max = law->d_max,
        .d_limit = law->wall_distance,
    };
}
