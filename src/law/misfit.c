/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The misfit of a law to its curve: the area between them, by the trapezoidal rule on the
 * curve's points. */
#include <math.h>

#include "law/far.h"

double haft_law_misfit(const haft_law *law, size_t n, const double *distance, const double *force) {
    haft_law near = haft_law_near(law);
    double between = 0, energy = 0, last_gap = 0, last_pull = 0;
    for (size_t i = 0; i < n; i++) {
        double gap = 0, pull = fmax(-force[i], 0);
        if (distance[i] >= law->wall_distance) {
            gap = fabs(haft_law_evaluate(&near, distance[i]).force - force[i]);
        }
        if (i > 0) {
            double half = 0.5 * (distance[i] - distance[i - 1]);
            between += half * (gap + last_gap);
            energy += half * (pull + last_pull);
        }
        last_gap = gap;
        last_pull = pull;
    }
    return between / energy;
}
