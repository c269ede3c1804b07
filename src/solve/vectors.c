/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vector operations of KINSOL's iterations. SUNDIALS' own are not vectorized, which costs a tenth
 * of the time of short beams. */
#include "vectors.h"

#include <math.h>

/* sqrt(sum (x w)^2). */
HAFT_CLONES static sunrealtype weighted_norm(N_Vector x, N_Vector w) {
    const double *a = N_VGetArrayPointer(x), *b = N_VGetArrayPointer(w);
    size_t n = (size_t)N_VGetLength(x), whole = n / HAFT_SIMD_WIDTH * HAFT_SIMD_WIDTH;
    double part[HAFT_SIMD_WIDTH] = {0}, sum = 0;
    for (size_t i = 0; i < whole; i += HAFT_SIMD_WIDTH) {
        for (size_t k = 0; k < HAFT_SIMD_WIDTH; k++) {
            part[k] += (a[i + k] * b[i + k]) * (a[i + k] * b[i + k]);
        }
    }
    for (size_t i = whole; i < n; i++) {
        part[i - whole] += (a[i] * b[i]) * (a[i] * b[i]);
    }
    for (size_t k = 0; k < HAFT_SIMD_WIDTH; k++) {
        sum += part[k];
    }
    return sqrt(sum);
}

/* z = x y, by which KINSOL scales; z may be either. */
HAFT_CLONES static void product(N_Vector x, N_Vector y, N_Vector z) {
    const double *a = N_VGetArrayPointer(x), *b = N_VGetArrayPointer(y);
    double *out = N_VGetArrayPointer(z);
    size_t n = (size_t)N_VGetLength(x);
    for (size_t i = 0; i < n; i++) {
        out[i] = a[i] * b[i];
    }
}

/* min x, by which KINSOL checks its scales in every call. */
HAFT_CLONES static sunrealtype least(N_Vector x) {
    const double *a = N_VGetArrayPointer(x);
    size_t n = (size_t)N_VGetLength(x), whole = n / HAFT_SIMD_WIDTH * HAFT_SIMD_WIDTH;
    double part[HAFT_SIMD_WIDTH], low = INFINITY;
    for (size_t k = 0; k < HAFT_SIMD_WIDTH; k++) {
        part[k] = INFINITY;
    }
    for (size_t i = 0; i < whole; i += HAFT_SIMD_WIDTH) {
        for (size_t k = 0; k < HAFT_SIMD_WIDTH; k++) {
            part[k] = a[i + k] < part[k] ? a[i + k] : part[k];
        }
    }
    for (size_t i = whole; i < n; i++) {
        part[i - whole] = a[i] < part[i - whole] ? a[i] : part[i - whole];
    }
    for (size_t k = 0; k < HAFT_SIMD_WIDTH; k++) {
        low = part[k] < low ? part[k] : low;
    }
    return low;
}

/* max |x|. */
HAFT_CLONES static sunrealtype max_norm(N_Vector x) {
    const double *a = N_VGetArrayPointer(x);
    size_t n = (size_t)N_VGetLength(x), whole = n / HAFT_SIMD_WIDTH * HAFT_SIMD_WIDTH;
    double part[HAFT_SIMD_WIDTH] = {0}, most = 0;
    for (size_t i = 0; i < whole; i += HAFT_SIMD_WIDTH) {
        for (size_t k = 0; k < HAFT_SIMD_WIDTH; k++) {
            part[k] = fabs(a[i + k]) > part[k] ? fabs(a[i + k]) : part[k];
        }
    }
    for (size_t i = whole; i < n; i++) {
        part[i - whole] = fabs(a[i]) > part[i - whole] ? fabs(a[i]) : part[i - whole];
    }
    for (size_t k = 0; k < HAFT_SIMD_WIDTH; k++) {
        most = part[k] > most ? part[k] : most;
    }
    return most;
}

/* z = a x + b y; z may be either. */
HAFT_CLONES static void linear_sum(sunrealtype a, N_Vector x, sunrealtype b, N_Vector y,
                                   N_Vector z) {
    const double *in = N_VGetArrayPointer(x), *other = N_VGetArrayPointer(y);
    double *out = N_VGetArrayPointer(z);
    size_t n = (size_t)N_VGetLength(x);
    for (size_t i = 0; i < n; i++) {
        out[i] = a * in[i] + b * other[i];
    }
}

/* z = a x; z may be x. */
HAFT_CLONES static void scale(sunrealtype a, N_Vector x, N_Vector z) {
    const double *in = N_VGetArrayPointer(x);
    double *out = N_VGetArrayPointer(z);
    size_t n = (size_t)N_VGetLength(x);
    for (size_t i = 0; i < n; i++) {
        out[i] = a * in[i];
    }
}

/* z = a everywhere, as KINSOL sets each step before it is solved for. */
HAFT_CLONES static void fill(sunrealtype a, N_Vector z) {
    double *out = N_VGetArrayPointer(z);
    size_t n = (size_t)N_VGetLength(z);
    for (size_t i = 0; i < n; i++) {
        out[i] = a;
    }
}

/* z = |x|, 1 / x and x / y, of which KINSOL makes the length of a step by u's own. */
HAFT_CLONES static void absolute(N_Vector x, N_Vector z) {
    const double *in = N_VGetArrayPointer(x);
    double *out = N_VGetArrayPointer(z);
    size_t n = (size_t)N_VGetLength(x);
    for (size_t i = 0; i < n; i++) {
        out[i] = fabs(in[i]);
    }
}

HAFT_CLONES static void invert(N_Vector x, N_Vector z) {
    const double *in = N_VGetArrayPointer(x);
    double *out = N_VGetArrayPointer(z);
    size_t n = (size_t)N_VGetLength(x);
    for (size_t i = 0; i < n; i++) {
        out[i] = 1 / in[i];
    }
}

HAFT_CLONES static void divide(N_Vector x, N_Vector y, N_Vector z) {
    const double *in = N_VGetArrayPointer(x), *by = N_VGetArrayPointer(y);
    double *out = N_VGetArrayPointer(z);
    size_t n = (size_t)N_VGetLength(x);
    for (size_t i = 0; i < n; i++) {
        out[i] = in[i] / by[i];
    }
}

N_Vector haft_vector_create(size_t n, SUNContext context) {
    N_Vector v = N_VNew_Serial((sunindextype)n, context);
    if (v == NULL) {
        return NULL;
    }
    v->ops->nvwl2norm = weighted_norm;
    v->ops->nvmaxnorm = max_norm;
    v->ops->nvmin = least;
    v->ops->nvprod = product;
    v->ops->nvlinearsum = linear_sum;
    v->ops->nvscale = scale;
    v->ops->nvconst = fill;
    v->ops->nvabs = absolute;
    v->ops->nvinv = invert;
    v->ops->nvdiv = divide;
    return v;
}
