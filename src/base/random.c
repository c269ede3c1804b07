/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Counter-based random numbers: Random123's Philox4x64-10 and the normal quantile of AS 241. Why
 * the quantile and not Box-Muller: one word gives one number, so a stream can be entered anywhere,
 * and the middle 85 % of the numbers need no transcendental function. */
#include "haft/base.h"

#include <Random123/philox.h>
#include <math.h>
#include <string.h>

void haft_random_words(haft_random_key key, uint64_t realization, uint64_t site, uint64_t draw,
                       uint64_t words[4]) {
    philox4x64_ctr_t counter = {{realization, site, draw, 0}};
    philox4x64_key_t philox_key = {{key.seed, key.purpose}};
    philox4x64_ctr_t result = philox4x64(counter, philox_key);
    for (int i = 0; i < 4; i++) {
        words[i] = result.v[i];
    }
}

/* Signed, because that conversion is a single instruction. */
static inline double uniform(uint64_t word) {
    return ((double)(int64_t)(word >> 11) + 0.5) * 0x1p-53;
}

double haft_random_uniform(uint64_t word) {
    return uniform(word);
}

static inline double central_quantile(double q) {
    double r = 0.180625 - q * q;
    double top = (((((((2.5090809287301226727e3 * r + 3.3430575583588128105e4) * r +
                       6.7265770927008700853e4) *
                          r +
                      4.5921953931549871457e4) *
                         r +
                     1.3731693765509461125e4) *
                        r +
                    1.9715909503065514427e3) *
                       r +
                   1.3314166789178437745e2) *
                      r +
                  3.3871328727963666080e0);
    double bottom = (((((((5.2264952788528545610e3 * r + 2.8729085735721942674e4) * r +
                          3.9307895800092710610e4) *
                             r +
                         2.1213794301586595867e4) *
                            r +
                        5.3941960214247511077e3) *
                           r +
                       6.8718700749205790830e2) *
                          r +
                      4.2313330701600911252e1) *
                         r +
                     1.0);
    return q * top / bottom;
}

static inline double near_tail(double r) {
    double top = (((((((7.74545014278341407640e-4 * r + 2.27238449892691845833e-2) * r +
                       2.41780725177450611770e-1) *
                          r +
                      1.27045825245236838258e0) *
                         r +
                     3.64784832476320460504e0) *
                        r +
                    5.76949722146069140550e0) *
                       r +
                   4.63033784615654529590e0) *
                      r +
                  1.42343711074968357734e0);
    double bottom = (((((((1.05075007164441684324e-9 * r + 5.47593808499534494600e-4) * r +
                          1.51986665636164571966e-2) *
                             r +
                         1.48103976427480074590e-1) *
                            r +
                        6.89767334985100004550e-1) *
                           r +
                       1.67638483018380384940e0) *
                          r +
                      2.05319162663775882187e0) *
                         r +
                     1.0);
    return top / bottom;
}

static double far_tail(double r) {
    double top = (((((((2.01033439929228813265e-7 * r + 2.71155556874348757815e-5) * r +
                       1.24266094738807843860e-3) *
                          r +
                      2.65321895265761230930e-2) *
                         r +
                     2.96560571828504891230e-1) *
                        r +
                    1.78482653991729133580e0) *
                       r +
                   5.46378491116411436990e0) *
                      r +
                  6.65790464350110377720e0);
    double bottom = (((((((2.04426310338993978564e-15 * r + 1.42151175831644588870e-7) * r +
                          1.84631831751005468180e-5) *
                             r +
                         7.86869131145613259100e-4) *
                            r +
                        1.48753612908506148525e-2) *
                           r +
                       1.36929880922735805310e-1) *
                          r +
                      5.99832206555887937690e-1) *
                         r +
                     1.0);
    return top / bottom;
}

double haft_random_normal_quantile(double p) {
    double q = p - 0.5;
    if (fabs(q) <= 0.425) {
        return central_quantile(q);
    }
    double r = sqrt(-log(q < 0 ? p : 1.0 - p));
    double z = r <= 5.0 ? near_tail(r - 1.6) : far_tail(r - 5.0);
    return q < 0 ? -z : z;
}

enum { BATCH = 256 };

enum { TOGETHER = 4, WORDS = 4 * TOGETHER };

/* Uniforms of TOGETHER successive draws. Their rounds are interleaved because they are independent,
 * and a single draw leaves the multiplier idle. */
HAFT_INLINE void draw_together(haft_random_key key, uint64_t realization, uint64_t site,
                               uint64_t draw, double u[WORDS]) {
    philox4x64_key_t philox_key = {{key.seed, key.purpose}};
    philox4x64_ctr_t at[TOGETHER];
    for (uint64_t i = 0; i < TOGETHER; i++) {
        at[i] = (philox4x64_ctr_t){{realization, site, draw + i, 0}};
    }
    for (int round = 0; round < philox4x64_rounds; round++) {
        for (int i = 0; i < TOGETHER; i++) {
            at[i] = _philox4x64round(at[i], philox_key);
        }
        philox_key = _philox4x64bumpkey(philox_key);
    }
    for (int i = 0; i < TOGETHER; i++) {
        for (int k = 0; k < 4; k++) {
            u[4 * i + k] = uniform(at[i].v[k]);
        }
    }
}

HAFT_INLINE void fill_uniforms(haft_random_key key, uint64_t realization, uint64_t site,
                               uint64_t first, size_t n, double *u) {
    double batch[WORDS];
    size_t skip = first % 4;
    for (size_t j = 0; j < n; skip = 0) {
        draw_together(key, realization, site, (first + j) / 4, batch);
        size_t count = n - j < WORDS - skip ? n - j : WORDS - skip;
        memcpy(u + j, batch + skip, count * sizeof *u);
        j += count;
    }
}

/* haft_random_normal_quantile() in passes that compilers vectorise: the rational function of the
 * middle for all numbers, then that of the near tail for those outside the middle, then the rare
 * far tail. */
HAFT_INLINE void fill_quantiles(const double *restrict u, size_t n, double *restrict z) {
    unsigned short tail[BATCH];
    double r[BATCH], near[BATCH];
    size_t tails = 0;
    for (size_t j = 0; j < n; j++) {
        z[j] = central_quantile(u[j] - 0.5);
    }
    for (size_t j = 0; j < n; j++) {
        tail[tails] = (unsigned short)j;
        tails += fabs(u[j] - 0.5) > 0.425;
    }
    for (size_t i = 0; i < tails; i++) {
        double p = u[tail[i]];
        r[i] = sqrt(-log(p - 0.5 < 0 ? p : 1.0 - p));
    }
    for (size_t i = 0; i < tails; i++) {
        near[i] = near_tail(r[i] - 1.6);
    }
    for (size_t i = 0; i < tails; i++) {
        z[tail[i]] = u[tail[i]] - 0.5 < 0 ? -near[i] : near[i];
    }
    for (size_t i = 0; i < tails; i++) {
        if (r[i] > 5.0) {
            z[tail[i]] = haft_random_normal_quantile(u[tail[i]]);
        }
    }
}

HAFT_INLINE void fill_normals(haft_random_key key, uint64_t realization, uint64_t site,
                              uint64_t first, size_t n, double *z) {
    double u[BATCH];
    for (size_t start = 0; start < n; start += BATCH) {
        size_t count = n - start < BATCH ? n - start : BATCH;
        fill_uniforms(key, realization, site, first + start, count, u);
        fill_quantiles(u, count, z + start);
    }
}

/* The same operations with AVX2, four per instruction. Multiplies and adds are not fused, so the
 * bits are the same. */
#if defined(__x86_64__) && defined(__GNUC__)
#define HAFT_RANDOM_WIDE
__attribute__((target("avx2,bmi2"))) static void fill_normals_wide(haft_random_key key,
                                                                   uint64_t realization,
                                                                   uint64_t site, uint64_t first,
                                                                   size_t n, double *z) {
    fill_normals(key, realization, site, first, n, z);
}
#endif

void haft_random_normals(haft_random_key key, uint64_t realization, uint64_t site, uint64_t first,
                         size_t n, double *z) {
#ifdef HAFT_RANDOM_WIDE
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2")) {
        fill_normals_wide(key, realization, site, first, n, z);
        return;
    }
#endif
    fill_normals(key, realization, site, first, n, z);
}
