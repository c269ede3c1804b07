/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The zero-force distance of a curve, searched inwards from the largest pull, with linear
 * interpolation. The search does not start at the far end, because a single tall asperity can cause
 * a zero crossing long before the surfaces meet. */
#include "haft/contact.h"

/* Whether the last nonzero force at or before point j is a push. */
static bool was_push(const double *force, size_t j) {
    while (j > 0 && force[j] == 0) {
        j--;
    }
    return force[j] > 0;
}

haft_zero_force haft_contact_zero_force(const haft_curve *curve) {
    const double *f = curve->force;
    size_t deepest = 0;
    for (size_t j = 1; j < curve->n; j++) {
        deepest = f[j] < f[deepest] ? j : deepest;
    }
    for (size_t j = deepest; j > 0; j--) {
        if (f[j] < 0 && f[j - 1] >= 0 && was_push(f, j - 1)) {
            double t = f[j - 1] / (f[j - 1] - f[j]);
#define BETWEEN(what) (curve->what[j - 1] + t * (curve->what[j] - curve->what[j - 1]))
            return (haft_zero_force){.found = true,
                                     .distance = BETWEEN(distance),
                                     .contact_area = BETWEEN(contact_area),
                                     .wet_area = BETWEEN(wet_area),
                                     .asperities = BETWEEN(asperities)};
#undef BETWEEN
        }
    }
    return (haft_zero_force){.found = false};
}
