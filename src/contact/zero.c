/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a curve's force vanishes, looked for from the greatest pull inwards, linear between
 * distances. Not from the far end: one tall asperity that pushes alone makes a zero of its own,
 * long before the surfaces meet. */
#include "haft/contact.h"

/* Whether the force, going back from point j over zeros, is a push. */
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
