/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The root of a function that changes sign in an interval. */
#include "haft/base.h"

/* Bisection alone would need about 53 steps, Newton takes about 5. */
enum { STEPS = 200 };

double haft_root_find(haft_root_function function, const void *data, double low, double high,
                      bool rises) {
    double x = 0.5 * (low + high);
    for (int step = 0; step < STEPS; step++) {
        double slope, value = function(data, x, &slope);
        if (value == 0) {
            break;
        }
        if ((value > 0) == rises) {
            high = x;
        } else {
            low = x;
        }
        double next = x - value / slope;
        if (!(next > low && next < high)) {
            next = 0.5 * (low + high);
        }
        if (next == x || !(next > low && next < high)) {
            break;
        }
        x = next;
    }
    return x;
}
