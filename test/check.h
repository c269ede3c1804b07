/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What every test includes: cmocka with the headers it wants, and checks of real numbers that
 * print both sides when they fail. */
#ifndef HAFT_TEST_CHECK_H
#define HAFT_TEST_CHECK_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "haft/base.h"

/* |actual - expected| <= tolerance; false for NaN. */
#define check_near(actual, expected, tolerance)                                                    \
    do {                                                                                           \
        double check_a = (actual), check_e = (expected), check_t = (tolerance);                    \
        if (!(fabs(check_a - check_e) <= check_t)) {                                               \
            fail_msg("%s = %.17g, expected %.17g within %.3g (off by %.3g)", #actual, check_a,     \
                     check_e, check_t, check_a - check_e);                                         \
        }                                                                                          \
    } while (0)

/* |actual - expected| <= tolerance * |expected|. */
#define check_relative(actual, expected, tolerance)                                                \
    check_near(actual, expected, (tolerance)*fabs(expected))

#define check_less(actual, bound)                                                                  \
    do {                                                                                           \
        double check_a = (actual), check_b = (bound);                                              \
        if (!(check_a < check_b)) {                                                                \
            fail_msg("%s = %.6g is not below %s = %.6g", #actual, check_a, #bound, check_b);       \
        }                                                                                          \
    } while (0)

/* A call that must succeed; prints the error's message when it does not. */
#define check_ok(call, error)                                                                      \
    do {                                                                                           \
        if ((call) != HAFT_OK) {                                                                   \
            fail_msg("%s: %s", #call, (error).message);                                            \
        }                                                                                          \
    } while (0)

#endif
