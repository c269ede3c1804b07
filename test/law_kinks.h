/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A law as rough patches have it, and a check of a law at a kink: what the tests of laws share. */
#ifndef HAFT_TEST_LAW_KINKS_H
#define HAFT_TEST_LAW_KINKS_H

#include "check.h"
#include "haft/law.h"

#include <float.h>

static inline haft_law typical(void) {
    haft_law law;
    haft_law_vector v = {.e = 2.1e-3, .f_max = 4e5, .d_max = 1.1e-8, .d_limit = 7.5e-9};
    assert_int_equal(haft_law_morse(&law, &v, 5e6), HAFT_LAW_SOUND);
    return law;
}

static inline void check_continuous(const haft_law *law, double d, double length,
                                    double tolerance) {
    double step = 4 * DBL_EPSILON * fabs(d);
    haft_law_value a = haft_law_evaluate(law, d - step), b = haft_law_evaluate(law, d + step);
    double size = law->f_max + fabs(a.force);
    double slopes = size / length;
    check_near(a.force, b.force, tolerance * size + 2 * step * fabs(a.slope));
    check_near(a.slope, b.slope, tolerance * slopes + 2 * step * slopes / length);
    check_near(a.potential, b.potential, tolerance * size * length + 2 * step * size);
}

#endif
