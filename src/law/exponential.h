/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The exponential of the Morse law. It is written out so that a loop over sites becomes vector
 * code, and so that its bits do not depend on the C library's choice for a processor. */
#ifndef HAFT_LAW_EXPONENTIAL_H
#define HAFT_LAW_EXPONENTIAL_H

#include "haft/base.h"

#include <stdint.h>
#include <string.h>

/* e^x for |x| <= 700, to an ulp: x = n ln 2 + r with |r| <= ln(2)/2, the Taylor polynomial of
 * degree 13 in r (remainder below 5e-18), and n added to the exponent. Terms are summed in pairs
 * and fours, which a processor adds in parallel. */
HAFT_INLINE double haft_law_exponential(double x) {
    const double shift = 0x1.8p52; /* adding it rounds to an integer, held in the low bits */
    double t = x * 0x1.71547652b82fep0 + shift;
    double n = t - shift;
    double r = (x - n * 0x1.62e42fee00000p-1) - n * 0x1.a39ef35793c76p-33;
    double r2 = r * r, r4 = r2 * r2;
    double low = (0.5 + r * (1.0 / 6.0)) + r2 * (1.0 / 24.0 + r * (1.0 / 120.0));
    double middle =
        (1.0 / 720.0 + r * (1.0 / 5040.0)) + r2 * (1.0 / 40320.0 + r * (1.0 / 362880.0));
    double high = (1.0 / 3628800.0 + r * (1.0 / 39916800.0)) +
                  r2 * (1.0 / 479001600.0 + r * (1.0 / 6227020800.0));
    double q = low + r4 * (middle + r4 * high);
    double power = r + r2 * q;
    uint64_t bits;
    memcpy(&bits, &t, sizeof bits);
    bits = (bits << 52) + ((uint64_t)1023 << 52);
    double scale;
    memcpy(&scale, &bits, sizeof scale);
    return scale + scale * power;
}

#endif
