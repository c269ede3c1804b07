/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From law vectors to unbounded numbers and back, by way of the principal components; names.
 *
 * The strict bounds replace ln e by ln(e - f_max/(2 a_left)), the logarithm of the right wing's
 * energy: any real number then gives a positive energy. Adding the left wing's energy must not
 * round it away. */
#include <math.h>

#include "chaos/model.h"

/* Bound of the logarithms: 1e-100 to 1e100 in SI units. */
#define LOG_LIMIT 230.0

double haft_chaos_left_energy(const haft_law_vector *v, double f_limit) {
    double left =
        log1p(sqrt(1 + haft_law_limit(f_limit, v->f_max) / v->f_max)) / (v->d_max - v->d_limit);
    return v->f_max / (2 * left);
}

void haft_chaos_raw_from_vector(haft_chaos_bounds bounds, double f_limit, const haft_law_vector *v,
                                double *raw) {
    double e = v->e;
    if (bounds == HAFT_CHAOS_BOUNDS_STRICT) {
        e -= haft_chaos_left_energy(v, f_limit);
    }
    double width = v->d_max - v->d_limit;
    raw[0] = e > 0 ? log(e) : NAN;
    raw[1] = v->f_max > 0 ? log(v->f_max) : NAN;
    raw[2] = v->d_max;
    raw[3] = width > 0 ? log(width) : NAN;
}

void haft_chaos_q_from_vector(const haft_chaos *chaos, const haft_law_vector *vector, double *q) {
    const haft_chaos_parts *p = &chaos->parts;
    haft_chaos_raw_from_vector(p->bounds, p->f_limit, vector, q);
    for (int i = 0; i < HAFT_CHAOS_DIMENSION; i++) {
        q[i] /= p->sigma[i];
    }
}

static double bounded_exp(double x) {
    return exp(fmax(-LOG_LIMIT, fmin(LOG_LIMIT, x)));
}

haft_law_vector haft_chaos_vector_from_q(const haft_chaos *chaos, const double *q) {
    const haft_chaos_parts *p = &chaos->parts;
    haft_law_vector v = {.e = bounded_exp(q[0] * p->sigma[0]),
                         .f_max = bounded_exp(q[1] * p->sigma[1]),
                         .d_max = q[2] * p->sigma[2]};
    v.d_limit = v.d_max - bounded_exp(q[3] * p->sigma[3]);
    if (!(v.d_limit < v.d_max)) {
        v.d_limit = nextafter(v.d_max, -INFINITY);
    }
    if (p->bounds == HAFT_CHAOS_BOUNDS_STRICT) {
        double left = haft_chaos_left_energy(&v, p->f_limit);
        v.e += left;
        if (!(v.e > left)) {
            v.e = nextafter(left, INFINITY);
        }
    }
    return v;
}

void haft_chaos_eta_from_q(const haft_chaos *chaos, const double *q, double *eta) {
    const haft_chaos_parts *p = &chaos->parts;
    for (size_t j = 0; j < p->components; j++) {
        double sum = 0;
        for (size_t i = 0; i < HAFT_CHAOS_DIMENSION; i++) {
            sum += (q[i] - p->mean[i]) * p->eigenvector[i][j];
        }
        eta[j] = sum / sqrt(p->eigenvalue[j]);
    }
}

void haft_chaos_q_from_eta(const haft_chaos *chaos, const double *eta, double *q) {
    const haft_chaos_parts *p = &chaos->parts;
    for (size_t i = 0; i < HAFT_CHAOS_DIMENSION; i++) {
        double sum = 0;
        for (size_t j = 0; j < p->components; j++) {
            sum += p->eigenvector[i][j] * (sqrt(p->eigenvalue[j]) * eta[j]);
        }
        q[i] = p->mean[i] + sum;
    }
}

const char *haft_chaos_bounds_name(haft_chaos_bounds bounds) {
    switch (bounds) {
    case HAFT_CHAOS_BOUNDS_STRICT:
        return "strict";
    case HAFT_CHAOS_BOUNDS_PAPER:
        return "paper";
    }
    return "unknown";
}

const char *haft_chaos_kernel_name(haft_chaos_kernel kernel) {
    switch (kernel) {
    case HAFT_CHAOS_KERNEL_SCOTT:
        return "scott";
    case HAFT_CHAOS_KERNEL_PRESERVING:
        return "preserving";
    }
    return "unknown";
}

const char *haft_chaos_germ_name(haft_chaos_germ germ) {
    switch (germ) {
    case HAFT_CHAOS_GERM_LEGENDRE:
        return "legendre";
    case HAFT_CHAOS_GERM_HERMITE:
        return "hermite";
    case HAFT_CHAOS_GERM_JACOBI:
        return "jacobi";
    }
    return "unknown";
}

const char *haft_chaos_sampler_name(haft_chaos_sampler sampler) {
    switch (sampler) {
    case HAFT_CHAOS_SAMPLER_GPCE:
        return "gpce";
    case HAFT_CHAOS_SAMPLER_EXACT:
        return "exact";
    case HAFT_CHAOS_SAMPLER_KERNEL:
        return "kernel";
    case HAFT_CHAOS_SAMPLER_BOOTSTRAP:
        return "bootstrap";
    case HAFT_CHAOS_SAMPLER_MEAN:
        return "mean";
    }
    return "unknown";
}
