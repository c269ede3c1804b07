/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "displacements.h"

#include <math.h>

#include "haft/law.h"

HAFT_INLINE double scaled(const haft_displacements *d, bool step, size_t r) {
    double gap = d->gap[r];
    double by = d->to != NULL ? d->to[r] - gap : d->by[r];
    return fabs(by) /
           (step ? haft_step_length(d->lengths, r, gap) : haft_length(d->lengths, r, gap));
}

/* Called many times a step. So `step` is a constant, and so is which of `by` and `to` is given:
 * then the loop becomes vector code, with a maximum in each element of the vector. */
HAFT_INLINE double largest(const haft_displacements *d, bool step) {
    double part[HAFT_SIMD_WIDTH] = {0}, most = 0;
    size_t r = d->first;
    for (; r + HAFT_SIMD_WIDTH <= d->sites; r += HAFT_SIMD_WIDTH) {
#pragma omp simd
        for (size_t k = 0; k < HAFT_SIMD_WIDTH; k++) {
            double x = scaled(d, step, r + k);
            part[k] = x > part[k] ? x : part[k];
        }
    }
    for (size_t k = 0; k < HAFT_SIMD_WIDTH; k++) {
        most = part[k] > most ? part[k] : most;
    }
    for (; r < d->sites; r++) {
        double x = scaled(d, step, r);
        most = x > most ? x : most;
    }
    return most;
}

HAFT_CLONES static double largest_by(const haft_displacements *d) {
    return largest(&(haft_displacements){d->lengths, d->first, d->sites, d->gap, d->by, NULL},
                   false);
}

HAFT_CLONES static double largest_to(const haft_displacements *d) {
    return largest(&(haft_displacements){d->lengths, d->first, d->sites, d->gap, NULL, d->to},
                   false);
}

HAFT_CLONES static double largest_step_by(const haft_displacements *d) {
    return largest(&(haft_displacements){d->lengths, d->first, d->sites, d->gap, d->by, NULL},
                   true);
}

HAFT_CLONES static double largest_step_to(const haft_displacements *d) {
    return largest(&(haft_displacements){d->lengths, d->first, d->sites, d->gap, NULL, d->to},
                   true);
}

double haft_displacements_largest(const haft_displacements *d) {
    return d->to != NULL ? largest_to(d) : largest_by(d);
}

double haft_displacements_largest_step(const haft_displacements *d) {
    return d->to != NULL ? largest_step_to(d) : largest_step_by(d);
}

static size_t find(const haft_displacements *d, bool step, double value) {
    for (size_t r = d->first; r + 1 < d->sites; r++) {
        if (scaled(d, step, r) == value) {
            return r;
        }
    }
    return d->sites - 1;
}

size_t haft_displacements_find(const haft_displacements *d, double value) {
    return find(d, false, value);
}

size_t haft_displacements_find_step(const haft_displacements *d, double value) {
    return find(d, true, value);
}

size_t haft_displacements_count(const haft_displacements *d, double least) {
    for (size_t r = d->sites; r > d->first; r--) {
        if (scaled(d, false, r - 1) > least) {
            return r;
        }
    }
    return d->first;
}
