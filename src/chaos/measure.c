/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Errors of the expansion against its map: mean square errors by the projection's own rule and
 * by an independent one, the variance against its closed form, marginals against the kernel
 * density and the data. All points are quasi-random, so the results carry little sampling noise.
 * Each result is summed in one fixed order, whatever the number of threads. */
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "chaos/marginal.h"
#include "chaos/model.h"

enum { N = HAFT_CHAOS_DIMENSION, MAPS = 4096, SAMPLES = 65536 };

/* Number k of the additive recurrence in d directions: fractional parts of 1/2 + (k + 1) phi^-i,
 * phi the root of phi^(d+1) = phi + 1. Source: Roberts (2018). */
typedef struct recurrence {
    double step[N];
} recurrence;

static recurrence make_recurrence(size_t directions) {
    recurrence r;
    double phi = 1.5, power = 1;
    for (int i = 0; i < 100; i++) {
        phi = pow(1 + phi, 1 / ((double)directions + 1));
    }
    for (size_t i = 0; i < N; i++) {
        power /= phi;
        r.step[i] = power;
    }
    return r;
}

static double point_of(const recurrence *r, size_t k, size_t i) {
    double u = 0.5 + (double)(k + 1) * r->step[i];
    u -= floor(u);
    return fmax(1e-12, fmin(1 - 1e-12, u));
}

/* Sums of squares of the difference and of the map. */
typedef struct squares {
    double error[N], size[N];
} squares;

static void set_relmise(const haft_chaos *chaos, const squares *s, double *each, double *total) {
    double error = 0, size = 0;
    for (size_t i = 0; i < chaos->parts.components; i++) {
        each[chaos->parts.component_order[i]] = s->error[i] / s->size[i];
        error += s->error[i];
        size += s->size[i];
    }
    *total = error / size;
}

/* Coordinate i on its own tensor grid. */
static void sum_level(const haft_chaos *chaos, const double *x, const double *weight,
                      const double *value, size_t i, squares *s) {
    size_t points = chaos->parts.points, size = haft_chaos_grid_size(points, i);
    double germ[N][HAFT_SIMD_WIDTH] = {{0}}, out[N][HAFT_SIMD_WIDTH], w[HAFT_SIMD_WIDTH];
    for (size_t start = 0; start < size; start += HAFT_SIMD_WIDTH) {
        size_t count = size - start < HAFT_SIMD_WIDTH ? size - start : HAFT_SIMD_WIDTH;
        for (size_t l = 0; l < count; l++) {
            size_t rest = start + l;
            w[l] = 1;
            for (size_t j = i + 1; j-- > 0; rest /= points) {
                germ[j][l] = x[rest % points];
                w[l] *= weight[rest % points];
            }
        }
        haft_chaos_expand_together(chaos, germ, out);
        for (size_t l = 0; l < count; l++) {
            double t = value[start + l], d = t - out[i][l];
            s->error[i] += w[l] * d * d;
            s->size[i] += w[l] * t * t;
        }
    }
}

static haft_status measure_own(const haft_chaos *chaos, haft_chaos_errors *errors,
                               haft_error *error) {
    const haft_chaos_parts *p = &chaos->parts;
    double x[HAFT_CHAOS_POINTS_LIMIT], weight[HAFT_CHAOS_POINTS_LIMIT], *value[N] = {NULL};
    squares s = {{0}, {0}};
    haft_status status = haft_chaos_gauss(p->germ, p->points, x, weight, error);
    for (size_t i = 0; i < p->components && status == HAFT_OK; i++) {
        value[i] = haft_memory_alloc(haft_chaos_grid_size(p->points, i), sizeof(double), error);
        status = value[i] == NULL ? HAFT_ERROR_MEMORY : HAFT_OK;
    }
    HAFT_THEN(status, haft_chaos_map_grid(chaos, p->points, value, error));
    if (status == HAFT_OK) {
        for (size_t i = 0; i < p->components; i++) {
            sum_level(chaos, x, weight, value[i], i, &s);
        }
        set_relmise(chaos, &s, errors->relmise_own, &errors->relmise_own_total);
    }
    for (size_t i = 0; i < N; i++) {
        haft_memory_free(value[i]);
    }
    return status;
}

haft_status haft_chaos_map(const haft_chaos *chaos, size_t n, double *xi, double *eta,
                           haft_error *error) {
    size_t g = chaos->parts.components;
    const size_t *order = chaos->parts.component_order;
    recurrence r = make_recurrence(g);
    chaos_workspaces team;
    haft_status status = haft_chaos_workspaces_init(&team, chaos, error);
    if (status == HAFT_OK) {
#pragma omp parallel for schedule(dynamic, 16) num_threads(team.threads)
        for (size_t k = 0; k < n; k++) {
            double x[N];
            for (size_t i = 0; i < g; i++) {
                double u = xi[k * g + i] = point_of(&r, k, i);
                chaos_line line = haft_chaos_mixture_condition(
                    &chaos->mixture, team.work[omp_get_thread_num()], i, x);
                x[i] = eta[k * g + order[i]] = haft_chaos_line_quantile(&line, u, 1 - u);
            }
        }
    }
    haft_chaos_workspaces_clear(&team);
    return status;
}

void haft_chaos_relmise(const haft_chaos *chaos, size_t n, const double *xi, const double *eta,
                        double *each, double *total) {
    size_t g = chaos->parts.components;
    const size_t *order = chaos->parts.component_order;
    squares s = {{0}, {0}};
    for (size_t k = 0; k < n; k++) {
        double germ[N], expanded[N];
        for (size_t i = 0; i < g; i++) {
            germ[i] = haft_chaos_germ_quantile(chaos->parts.germ, xi[k * g + i]);
        }
        haft_chaos_expand(chaos, germ, expanded);
        for (size_t i = 0; i < g; i++) {
            double exact = eta[k * g + order[i]], d = exact - expanded[order[i]];
            s.error[i] += d * d;
            s.size[i] += exact * exact;
        }
    }
    set_relmise(chaos, &s, each, total);
}

static haft_status measure_independent(const haft_chaos *chaos, size_t maps,
                                       haft_chaos_errors *errors, haft_error *error) {
    size_t g = chaos->parts.components;
    double *xi = haft_memory_alloc(2 * maps * g, sizeof *xi, error);
    if (xi == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    double *eta = xi + maps * g;
    haft_status status = haft_chaos_map(chaos, maps, xi, eta, error);
    if (status == HAFT_OK) {
        haft_chaos_relmise(chaos, maps, xi, eta, errors->relmise, &errors->relmise_total);
    }
    haft_memory_free(xi);
    return status;
}

static void measure_variance(const haft_chaos *chaos, haft_chaos_errors *errors) {
    const haft_chaos_parts *p = &chaos->parts;
    const chaos_mixture *mixture = &chaos->mixture;
    size_t g = p->components;
    for (size_t i = 0; i < g; i++) {
        size_t j = p->component_order[i];
        const double *c = mixture->axis[i].centre;
        double mean = 0, square = 0, kept = 0;
        for (size_t k = 0; k < p->m; k++) {
            mean += c[k] / (double)p->m;
        }
        for (size_t k = 0; k < p->m; k++) {
            square += (c[k] - mean) * (c[k] - mean) / (double)p->m;
        }
        for (size_t t = 1; t < p->terms; t++) {
            kept += p->coefficient[t * g + j] * p->coefficient[t * g + j];
        }
        errors->variance[j] = square + mixture->h * mixture->h;
        errors->variance_error[j] = 1 - kept / errors->variance[j];
    }
    double sum = 0, rest = 0;
    for (size_t j = 0; j < N; j++) {
        sum += p->eigenvalue[j];
        rest += j < g ? 0 : p->eigenvalue[j];
    }
    errors->reduction = rest / sum;
}

/* Samples of the expansion, [component][samples], and how many have no Morse law. */
static size_t sample_expansion(const haft_chaos *chaos, size_t samples, double *eta) {
    const haft_chaos_parts *p = &chaos->parts;
    recurrence r = make_recurrence(p->components);
    size_t outside = 0;
#pragma omp parallel for schedule(static) reduction(+ : outside)
    for (size_t k = 0; k < samples; k++) {
        double germ[N], one[N], q[N];
        for (size_t i = 0; i < p->components; i++) {
            germ[i] = haft_chaos_germ_quantile(p->germ, point_of(&r, k, i));
        }
        haft_chaos_expand(chaos, germ, one);
        for (size_t j = 0; j < p->components; j++) {
            eta[j * samples + k] = one[j];
        }
        haft_chaos_q_from_eta(chaos, one, q);
        haft_law_vector v = haft_chaos_vector_from_q(chaos, q);
        outside += haft_law_vector_fault(&v, p->f_limit) != HAFT_LAW_SOUND;
    }
    return outside;
}

static haft_status measure_marginals(const haft_chaos *chaos, size_t samples,
                                     haft_chaos_errors *errors, haft_error *error) {
    const haft_chaos_parts *p = &chaos->parts;
    size_t g = p->components;
    double *eta = haft_memory_alloc(samples * g + p->m, sizeof *eta, error);
    if (eta == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    double *data = eta + samples * g;
    errors->outside = (double)sample_expansion(chaos, samples, eta) / (double)samples;
    haft_status status = HAFT_OK;
    for (size_t i = 0; i < g && status == HAFT_OK; i++) {
        size_t j = p->component_order[i];
        double *x = eta + j * samples;
        for (size_t k = 0; k < p->m; k++) {
            data[k] = p->centre[k * g + j];
        }
        haft_chaos_sort(samples, x);
        haft_chaos_sort(p->m, data);
        errors->data[j] = haft_chaos_distance_of_samples(samples, x, p->m, data);
        status = haft_chaos_distance_of_line(samples, x, &chaos->mixture.first[i],
                                             &errors->kernel[j], error);
    }
    haft_memory_free(eta);
    return status;
}

haft_status haft_chaos_measure(const haft_chaos *chaos, const haft_chaos_effort *effort,
                               haft_chaos_errors *errors, haft_error *error) {
    size_t maps = effort->maps == 0 ? MAPS : effort->maps;
    size_t samples = effort->samples == 0 ? SAMPLES : effort->samples;
    *errors = (haft_chaos_errors){0};
    if (maps > HAFT_CHAOS_GRID_LIMIT || samples > HAFT_CHAOS_GRID_LIMIT) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                              "an effort of %zu maps and %zu samples; %d of each are the most",
                              maps, samples, HAFT_CHAOS_GRID_LIMIT);
    }
    haft_status status = measure_own(chaos, errors, error);
    HAFT_THEN(status, measure_independent(chaos, maps, errors, error));
    HAFT_THEN(status, measure_marginals(chaos, samples, errors, error));
    measure_variance(chaos, errors);
    return status;
}
