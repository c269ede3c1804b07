/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Normal distribution functions in loops that compilers vectorise: no branch, and one
 * exponential and one division each, which also give the density.
 *
 * Phi(-a) = exp(-a^2/2) R(a); (a + 5.5) R(a) is a polynomial of degree 20 in 1/(a + 5.5) on 0 <=
 * a <= 39, interpolated in Chebyshev points to 6e-16 of itself in the far tail and 1e-16 near
 * the middle (the substitution is Schonfelder's, 1978). exp(x) = 2^n exp(r), a polynomial of
 * degree 11 in r to 3e-18. Coefficients were computed with 50 digits. Without fused
 * multiply-adds, vectors of any width give the same bits. */
#include "chaos/normal.h"

#include "haft/base.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

enum { BLOCK = 128 };

/* Beyond it densities would underflow. */
#define FARTHEST 37.5
#define INVERSE_ROOT_2PI 0.39894228040143267794

HAFT_INLINE double exponential(double x) {
    const double shift = 0x1.8p52; /* adding it leaves the nearest integer in the low bits */
    double scaled = x * 1.44269504088896340736 + shift;
    double n = scaled - shift;
    double r = (x - n * 0x1.62e42fefa38p-1) - n * 0x1.ef35793c7673p-45;
    double r2 = r * r, r4 = r2 * r2;
    double low = (1 + r) + r2 * (0.50000000000000183876 + r * 0.16666666666666702415);
    double mid = (0.041666666666488081465 + r * 0.0083333333333095256391) +
                 r2 * (0.001388888895231804535 + r * 0.00019841269909219842196);
    double high = (2.4801485479216429363e-5 + r * 2.7557224956110722939e-6) +
                  r2 * (2.7632640675430235707e-7 + r * 2.5114870219497475323e-8);
    double y = low + r4 * (mid + r4 * high);
    uint64_t bits, power;
    memcpy(&bits, &y, sizeof bits);
    memcpy(&power, &scaled, sizeof power);
    bits += power << 52;
    memcpy(&y, &bits, sizeof y);
    return y;
}

/* (a + 5.5) R(a) at i = 1/(a + 5.5). Even and odd powers are summed apart, because two
 * independent chains run in parallel. */
HAFT_INLINE double scaled_tail(double i) {
    double s = 1.2820512820512820513 - 12.551282051282051282 * i, t = s * s;
    double even =
        0.86738408682608705544 +
        t * (0.53297422299478442312 +
             t * (0.17519211792229182487 +
                  t * (0.026340344444196491706 +
                       t * (0.00066131989147681631412 +
                            t * (-0.0001065699296920382601 +
                                 t * (7.1985842160977578706e-6 +
                                      t * (-4.0056705264498730927e-7 +
                                           t * (2.1306160606684579159e-8 +
                                                t * (-1.2552201936956906427e-9 +
                                                     t * 7.3519911192904091006e-11)))))))));
    double odd = -0.73283240875989250726 +
                 t * (-0.33209318901626735643 +
                      t * (-0.076449692027052503686 +
                           t * (-0.0063986316429145996343 +
                                t * (0.00022020119398332529938 +
                                     t * (7.7215333696807673378e-6 +
                                          t * (-1.858271984488726818e-6 +
                                               t * (2.1733833163644782489e-7 +
                                                    t * (-2.1543642809948574244e-8 +
                                                         t * 1.4868381115563403913e-9))))))));
    return even + s * odd;
}

HAFT_INLINE double clamp(double t) {
    double a = fabs(t);
    return a < FARTHEST ? a : FARTHEST;
}

/* Phi(t), a being |t| clamped, and exp(-a^2/2). */
HAFT_INLINE double distribution(double t, double a, double *density) {
    double e = exponential(-0.5 * a * a), i = 1 / (a + 5.5);
    double q = e * (i * scaled_tail(i));
    *density = e;
    return (0.5 + copysign(0.5, t)) - copysign(q, t); /* q or 1 - q, without a branch */
}

HAFT_INLINE double fold(const double lane[HAFT_SIMD_WIDTH]) {
    return ((lane[0] + lane[4]) + (lane[2] + lane[6])) +
           ((lane[1] + lane[5]) + (lane[3] + lane[7]));
}

HAFT_CLONES static chaos_sums sum_normals(size_t n, const double *restrict c,
                                          const double *restrict w, double x, double scale) {
    double t[BLOCK], a[BLOCK], p[BLOCK], e[BLOCK];
    double cdf[HAFT_SIMD_WIDTH] = {0}, pdf[HAFT_SIMD_WIDTH] = {0}, moment[HAFT_SIMD_WIDTH] = {0};
    for (size_t start = 0; start < n; start += BLOCK) {
        size_t count = n - start < BLOCK ? n - start : BLOCK;
        const double *restrict centre = c + start, *restrict weight = w + start;
        for (size_t k = 0; k < count; k++) {
            t[k] = (x - centre[k]) * scale;
            a[k] = clamp(t[k]);
        }
        for (size_t k = 0; k < count;
             k++) { /* a loop of its own, otherwise GCC makes the clamp a branch */
            p[k] = distribution(t[k], a[k], &e[k]);
        }
        for (size_t k = 0; k < count; k += HAFT_SIMD_WIDTH) {
            for (size_t j = 0; j < HAFT_SIMD_WIDTH; j++) {
                double density = weight[k + j] * e[k + j];
                cdf[j] += weight[k + j] * p[k + j];
                pdf[j] += density;
                moment[j] += density * t[k + j];
            }
        }
    }
    return (chaos_sums){fold(cdf), fold(pdf) * INVERSE_ROOT_2PI, fold(moment) * INVERSE_ROOT_2PI};
}

HAFT_CLONES static void fill_exponentials(size_t n, const double *x, double *y) {
    for (size_t k = 0; k < n; k++) {
        y[k] = exponential(x[k]);
    }
}

chaos_sums haft_chaos_normal_sums(size_t n, const double *c, const double *w, double x,
                                  double scale) {
    return sum_normals(n, c, w, x, scale);
}

void haft_chaos_exponentials(size_t n, const double *x, double *y) {
    fill_exponentials(n, x, y);
}

double haft_chaos_normal_cdf(double t) {
    double density;
    return distribution(t, clamp(t), &density);
}
