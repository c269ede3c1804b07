/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The model's memory and its identification: bounds, principal components, kernels, projection. */
#include "chaos/model.h"

#include <math.h>
#include <string.h>

enum { N = HAFT_CHAOS_DIMENSION };

haft_status haft_chaos_alloc(haft_chaos **out, const haft_chaos_parts *parts, haft_error *error) {
    size_t g = parts->components, m = parts->m;
    *out = NULL;
    haft_chaos *c = haft_memory_alloc(1, sizeof *c, error);
    if (c == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    c->parts = *parts;
    c->parts.terms = haft_chaos_terms(g, parts->order);
    c->vector = haft_memory_alloc(m, sizeof *c->vector, error);
    c->centre = haft_memory_alloc(m * g, sizeof *c->centre, error);
    c->coefficient = haft_memory_alloc(c->parts.terms * g, sizeof *c->coefficient, error);
    c->index = haft_memory_alloc(c->parts.terms * g, sizeof *c->index, error);
    bool complete = c->vector && c->centre && c->coefficient && c->index;
    for (size_t i = 0; i < g; i++) {
        c->compact[i] =
            haft_memory_alloc(haft_chaos_terms(i + 1, parts->order), sizeof(double), error);
        complete = complete && c->compact[i] != NULL;
    }
    if (!complete) {
        haft_chaos_destroy(&c);
        return HAFT_ERROR_MEMORY;
    }
    c->parts.vector = c->vector;
    c->parts.centre = c->centre;
    c->parts.coefficient = c->coefficient;
    c->parts.index = c->index;
    haft_chaos_indices(g, parts->order, c->index);
    haft_chaos_recurrence(parts->germ, &c->recurrence);
    *out = c;
    return HAFT_OK;
}

void haft_chaos_destroy(haft_chaos **chaos) {
    if (chaos == NULL || *chaos == NULL) {
        return;
    }
    haft_chaos *c = *chaos;
    haft_chaos_mixture_clear(&c->mixture);
    for (size_t i = 0; i < N; i++) {
        haft_memory_free(c->compact[i]);
    }
    haft_memory_free(c->vector);
    haft_memory_free(c->centre);
    haft_memory_free(c->coefficient);
    haft_memory_free(c->index);
    haft_memory_free(c);
    *chaos = NULL;
}

haft_status haft_chaos_place_kernels(haft_chaos *c, haft_error *error) {
    const haft_chaos_parts *p = &c->parts;
    double shrink =
        p->kernel == HAFT_CHAOS_KERNEL_PRESERVING ? 1 / sqrt(1 + p->bandwidth * p->bandwidth) : 1;
    return haft_chaos_mixture_init(&c->mixture, p->m, p->components, c->centre, p->component_order,
                                   shrink, shrink * p->bandwidth, error);
}

static haft_status check_vectors(size_t m, const haft_law_vector *vector,
                                 const haft_chaos_spec *spec, haft_error *error) {
    for (size_t k = 0; k < m; k++) {
        haft_law_vector v = vector[k];
        if (!isfinite(v.e) || !isfinite(v.f_max) || !isfinite(v.d_max) || !isfinite(v.d_limit)) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "law vector %zu of %zu is (%g, %g, %g, %g); all four numbers "
                                  "must be finite: leave it out",
                                  k, m, v.e, v.f_max, v.d_max, v.d_limit);
        }
        if (!(v.e > 0) || !(v.f_max > 0) || !(v.d_max > v.d_limit)) {
            return haft_error_set(
                error, HAFT_ERROR_INPUT,
                "law vector %zu of %zu has e = %g J/m2, f_max = %g Pa and d_max - "
                "d_limit = %g m; all three must be positive: leave it out",
                k, m, v.e, v.f_max, v.d_max - v.d_limit);
        }
        double left = haft_chaos_left_energy(&v, spec->f_limit);
        if (spec->bounds == HAFT_CHAOS_BOUNDS_STRICT && !(v.e > left)) {
            return haft_error_set(
                error, HAFT_ERROR_INPUT,
                "law vector %zu of %zu has e = %g J/m2, not above the %g J/m2 of "
                "its left wing, which ends at a push of %g Pa: leave it out, lower f_limit "
                "or take the paper's bounds",
                k, m, v.e, left, haft_law_limit(spec->f_limit, v.f_max));
        }
    }
    return HAFT_OK;
}

static haft_status check_spec(const haft_chaos_spec *s, haft_error *error) {
    if (s->bounds > HAFT_CHAOS_BOUNDS_PAPER || s->kernel > HAFT_CHAOS_KERNEL_PRESERVING ||
        s->germ > HAFT_CHAOS_GERM_JACOBI) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "bounds %d, kernel %d or germ %d is none there is; 0 is always one",
                              (int)s->bounds, (int)s->kernel, (int)s->germ);
    }
    if (s->f_limit == 0 || !isfinite(s->f_limit)) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "f_limit = %g; it must be a positive push in Pa, or less than 0 for a share of "
            "f_max",
            s->f_limit);
    }
    if (s->components > N) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%zu components; a law vector has %d at most", s->components, N);
    }
    if (s->components == 0 && !(s->epsilon > 0 && s->epsilon < 1)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "epsilon = %g; give one between 0 and 1, such as 0.001, or the "
                              "number of components",
                              s->epsilon);
    }
    if (s->bandwidth != 0 && !(s->bandwidth >= HAFT_CHAOS_LEAST_BANDWIDTH &&
                               s->bandwidth <= HAFT_CHAOS_GREATEST_BANDWIDTH)) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "bandwidth = %g standard deviations; it must be %g to %g, or 0 for Scott's",
            s->bandwidth, HAFT_CHAOS_LEAST_BANDWIDTH, HAFT_CHAOS_GREATEST_BANDWIDTH);
    }
    if (s->order > HAFT_CHAOS_ORDER_LIMIT) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "order %zu; %d is the highest", s->order,
                              HAFT_CHAOS_ORDER_LIMIT);
    }
    if (s->points != 0 && (s->points <= s->order || s->points > HAFT_CHAOS_POINTS_LIMIT)) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "%zu Gauss points a direction for order %zu; give %zu to %d, or 0 for "
            "%zu",
            s->points, s->order, s->order + 1, HAFT_CHAOS_POINTS_LIMIT, s->order + 1);
    }
    return HAFT_OK;
}

/* q of all vectors [m][4], standardised (Eqs. 24-26). */
static haft_status standardise(size_t m, const haft_law_vector *vector, haft_chaos_parts *parts,
                               double *q, haft_error *error) {
    static const char *const name[2][N] = {
        {"ln(e - f_max/(2 a_left))", "ln f_max", "d_max", "ln(d_max - d_limit)"},
        {"ln e", "ln f_max", "d_max", "ln(d_max - d_limit)"}};
    for (size_t k = 0; k < m; k++) {
        haft_chaos_raw_from_vector(parts->bounds, parts->f_limit, &vector[k], q + N * k);
    }
    for (size_t i = 0; i < N; i++) {
        double mean = 0, square = 0, greatest = 0;
        for (size_t k = 0; k < m; k++) {
            mean += q[N * k + i] / (double)m;
            greatest = fmax(greatest, fabs(q[N * k + i]));
        }
        for (size_t k = 0; k < m; k++) {
            double d = q[N * k + i] - mean;
            square += d * d / (double)(m - 1);
        }
        double sigma = sqrt(square);
        if (!(sigma > 1e-13 * greatest)) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "number %zu, %s, is the same in all %zu law vectors (%g); each "
                                  "must vary: the bootstrap needs no model",
                                  i, name[parts->bounds][i], m, q[i]);
        }
        parts->sigma[i] = sigma;
        for (size_t k = 0; k < m; k++) {
            q[N * k + i] /= sigma;
        }
    }
    return HAFT_OK;
}

static haft_status choose_components(const haft_chaos_spec *spec, haft_chaos_parts *parts,
                                     haft_error *error) {
    size_t rank = haft_chaos_rank(parts), g = spec->components;
    double sum = 0, rest = 0;
    for (size_t j = 0; j < N; j++) {
        sum += parts->eigenvalue[j];
    }
    if (g == 0) { /* Eq. 32 */
        for (g = N; g > 1; g--) {
            rest += parts->eigenvalue[g - 1];
            if (!(rest < spec->epsilon * sum)) {
                break;
            }
        }
        g = g < rank ? g : rank;
    }
    if (g > rank) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "%zu components asked for, but the law vectors vary in %zu only; take "
            "%zu",
            g, rank, rank);
    }
    parts->components = g;
    bool given = false, seen[N] = {false};
    for (size_t i = 0; i < N; i++) {
        given = given || spec->component_order[i] != 0;
    }
    for (size_t i = 0; i < g; i++) {
        size_t j = given ? spec->component_order[i] : i;
        if (j >= g || seen[j]) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "component order: entry %zu is %zu; the first %zu entries must "
                                  "hold each of 0 to %zu once",
                                  i, j, g, g - 1);
        }
        seen[j] = true;
        parts->component_order[i] = j;
    }
    return HAFT_OK;
}

/* Writes the terms of coordinate i, those without a later variable, to their places among all. */
static void spread(haft_chaos *c, size_t i) {
    size_t g = c->parts.components, next = 0;
    for (size_t t = 0; t < c->parts.terms; t++) {
        unsigned later = 0;
        for (size_t j = i + 1; j < g; j++) {
            later += c->index[t * g + j];
        }
        if (later == 0) {
            c->coefficient[t * g + c->parts.component_order[i]] = c->compact[i][next++];
        }
    }
}

static haft_status identify(haft_chaos *c, haft_error *error) {
    const haft_chaos_parts *p = &c->parts;
    double *value[N] = {NULL};
    haft_status status = HAFT_OK;
    for (size_t i = 0; i < p->components && status == HAFT_OK; i++) {
        value[i] = haft_memory_alloc(haft_chaos_grid_size(p->points, i), sizeof(double), error);
        status = value[i] == NULL ? HAFT_ERROR_MEMORY : HAFT_OK;
    }
    HAFT_THEN(status, haft_chaos_map_grid(c, p->points, value, error));
    for (size_t i = 0; i < p->components && status == HAFT_OK; i++) {
        status = haft_chaos_project(p->germ, i + 1, p->order, p->points, value[i], c->compact[i], 1,
                                    error);
        spread(c, i);
    }
    for (size_t i = 0; i < N; i++) {
        haft_memory_free(value[i]);
    }
    return status;
}

static haft_status settle_parts(size_t m, const haft_law_vector *vector,
                                const haft_chaos_spec *spec, haft_chaos_parts *parts, double *q,
                                haft_error *error) {
    *parts = (haft_chaos_parts){.bounds = spec->bounds,
                                .f_limit = spec->f_limit,
                                .kernel = spec->kernel,
                                .m = m,
                                .germ = spec->germ,
                                .order = spec->order,
                                .points = spec->points == 0 ? spec->order + 1 : spec->points};
    HAFT_TRY(standardise(m, vector, parts, q, error));
    haft_chaos_principal(m, q, parts);
    HAFT_TRY(choose_components(spec, parts, error));
    size_t g = parts->components;
    if (haft_chaos_grid_size(parts->points, g - 1) > HAFT_CHAOS_GRID_LIMIT) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%zu Gauss points in each of %zu directions are more than %d; take "
                              "%d a direction at most",
                              parts->points, g, HAFT_CHAOS_GRID_LIMIT,
                              (int)floor(pow(HAFT_CHAOS_GRID_LIMIT, 1.0 / (double)g) + 1e-9));
    }
    parts->bandwidth =
        spec->bandwidth > 0 ? spec->bandwidth : pow((double)m, -1.0 / ((double)g + 4));
    return HAFT_OK;
}

haft_status haft_chaos_create(haft_chaos **out, size_t m, const haft_law_vector *vector,
                              const haft_chaos_spec *spec, haft_error *error) {
    *out = NULL;
    haft_status status = check_spec(spec, error);
    size_t least = (spec->components == 0 ? N : spec->components) + 1;
    if (status == HAFT_OK && m < least) {
        status = haft_error_set(error, HAFT_ERROR_INPUT,
                                "%zu law vectors are too few for %zu components; %zu are the "
                                "fewest, thousands are usual",
                                m, least - 1, least);
    }
    if (status == HAFT_OK && m > UINT32_MAX) {
        status = haft_error_set(error, HAFT_ERROR_INPUT, "%zu law vectors; %u are the most", m,
                                UINT32_MAX);
    }
    HAFT_THEN(status, check_vectors(m, vector, spec, error));
    if (status != HAFT_OK) {
        return status;
    }
    haft_chaos_parts parts;
    haft_chaos *c = NULL;
    double *q = haft_memory_alloc(m * N, sizeof *q, error);
    status = q == NULL ? HAFT_ERROR_MEMORY : settle_parts(m, vector, spec, &parts, q, error);
    HAFT_THEN(status, haft_chaos_alloc(&c, &parts, error));
    if (status == HAFT_OK) {
        memcpy(c->vector, vector, m * sizeof *vector);
        for (size_t k = 0; k < m; k++) {
            haft_chaos_eta_from_q(c, q + N * k, c->centre + k * parts.components);
        }
        status = haft_chaos_place_kernels(c, error);
    }
    haft_memory_free(q);
    HAFT_THEN(status, identify(c, error));
    if (status != HAFT_OK) {
        haft_chaos_destroy(&c);
    }
    *out = c;
    return status;
}

void haft_chaos_get_parts(const haft_chaos *chaos, haft_chaos_parts *parts) {
    *parts = chaos->parts;
}
