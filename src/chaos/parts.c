/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Creates a model from its parts. Every number is checked, because the parts come from a file.
 * Derived data (the kernels' places, terms by coordinate) are computed again by the same
 * operations, so the model has the same bits. */
#include <math.h>
#include <string.h>

#include "chaos/model.h"

enum { N = HAFT_CHAOS_DIMENSION };

static haft_status check_sizes(const haft_chaos_parts *p, haft_error *error) {
    if (p->bounds > HAFT_CHAOS_BOUNDS_PAPER || p->kernel > HAFT_CHAOS_KERNEL_PRESERVING ||
        p->germ > HAFT_CHAOS_GERM_JACOBI) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "bounds %d, kernel %d or germ %d is unknown",
                              (int)p->bounds, (int)p->kernel, (int)p->germ);
    }
    if (p->components < 1 || p->components > N) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "components is %zu; it must be 1 to %d",
                              p->components, N);
    }
    if (p->m < 1 || p->m > UINT32_MAX) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "m is %zu; it must be 1 to %u", p->m,
                              UINT32_MAX);
    }
    if (p->order > HAFT_CHAOS_ORDER_LIMIT) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "order is %zu; it must be 0 to %d", p->order,
                              HAFT_CHAOS_ORDER_LIMIT);
    }
    if (p->points <= p->order || p->points > HAFT_CHAOS_POINTS_LIMIT ||
        haft_chaos_grid_size(p->points, p->components - 1) > HAFT_CHAOS_GRID_LIMIT) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "points is %zu; it must be above the order, %zu, and %d at most, and "
                              "its power %zu at most %d",
                              p->points, p->order, HAFT_CHAOS_POINTS_LIMIT, p->components,
                              HAFT_CHAOS_GRID_LIMIT);
    }
    size_t terms = haft_chaos_terms(p->components, p->order);
    if (p->terms != terms) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "terms is %zu; %zu components to order %zu have %zu", p->terms,
                              p->components, p->order, terms);
    }
    if (p->vector == NULL || p->centre == NULL || p->index == NULL || p->coefficient == NULL) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "vector, centre, index or coefficient is missing");
    }
    return HAFT_OK;
}

static haft_status check_positive(const char *name, size_t i, double value, haft_error *error) {
    if (!(value > 0) || !isfinite(value)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s[%zu] is %g; it must be positive and finite", name, i, value);
    }
    return HAFT_OK;
}

static haft_status check_scalars(const haft_chaos_parts *p, haft_error *error) {
    haft_status status = check_positive("f_limit", 0, fabs(p->f_limit), error);
    if (status == HAFT_OK && !(p->bandwidth >= HAFT_CHAOS_LEAST_BANDWIDTH &&
                               p->bandwidth <= HAFT_CHAOS_GREATEST_BANDWIDTH)) {
        status =
            haft_error_set(error, HAFT_ERROR_INPUT, "bandwidth is %g; it must be %g to %g",
                           p->bandwidth, HAFT_CHAOS_LEAST_BANDWIDTH, HAFT_CHAOS_GREATEST_BANDWIDTH);
    }
    for (size_t i = 0; i < N && status == HAFT_OK; i++) {
        status = check_positive("sigma", i, p->sigma[i], error);
        if (status == HAFT_OK && !isfinite(p->mean[i])) {
            status = haft_error_set(error, HAFT_ERROR_INPUT, "mean[%zu] is %g; it must be finite",
                                    i, p->mean[i]);
        }
    }
    for (size_t j = 0; j < N && status == HAFT_OK; j++) {
        double value = p->eigenvalue[j];
        bool used = j < p->components;
        if (!isfinite(value) || value < 0 || (used && value == 0) ||
            (j > 0 && value > p->eigenvalue[j - 1])) {
            status =
                haft_error_set(error, HAFT_ERROR_INPUT,
                               "eigenvalue[%zu] is %g; they must fall and be positive", j, value);
        }
    }
    bool seen[N] = {false};
    for (size_t i = 0; i < p->components && status == HAFT_OK; i++) {
        size_t j = p->component_order[i];
        if (j >= p->components || seen[j]) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "component_order[%zu] is %zu; each of 0 to %zu must stand once",
                                  i, j, p->components - 1);
        }
        seen[j] = true;
    }
    return status;
}

/* Whether the columns are orthonormal. */
static haft_status check_eigenvectors(const haft_chaos_parts *p, haft_error *error) {
    for (int a = 0; a < N; a++) {
        for (int b = 0; b <= a; b++) {
            double dot = 0;
            for (int i = 0; i < N; i++) {
                dot += p->eigenvector[i][a] * p->eigenvector[i][b];
            }
            if (!(fabs(dot - (a == b)) <= 1e-9)) {
                return haft_error_set(error, HAFT_ERROR_INPUT,
                                      "eigenvectors %d and %d have the product %g; it must be %d",
                                      b, a, dot, a == b);
            }
        }
    }
    return HAFT_OK;
}

static haft_status check_data(const haft_chaos_parts *p, haft_error *error) {
    size_t g = p->components;
    for (size_t k = 0; k < p->m; k++) {
        haft_law_vector v = p->vector[k];
        double raw[N];
        haft_chaos_raw_from_vector(p->bounds, p->f_limit, &v, raw);
        if (!isfinite(raw[0]) || !isfinite(raw[1]) || !isfinite(raw[2]) || !isfinite(raw[3])) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "vector[%zu] is (%g, %g, %g, %g); it must keep the %s bounds", k,
                                  v.e, v.f_max, v.d_max, v.d_limit,
                                  haft_chaos_bounds_name(p->bounds));
        }
    }
    for (size_t k = 0; k < p->m * g; k++) {
        if (!(fabs(p->centre[k]) <= HAFT_CHAOS_GREATEST_CENTRE)) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "centre[%zu][%zu] is %g; it must be within +-%g", k / g, k % g,
                                  p->centre[k], HAFT_CHAOS_GREATEST_CENTRE);
        }
    }
    return HAFT_OK;
}

/* The expansion must have the model's shape; `chaos` has the indices it must have. */
static haft_status check_expansion(const haft_chaos *chaos, const haft_chaos_parts *p,
                                   haft_error *error) {
    size_t g = p->components;
    for (size_t k = 0; k < p->terms * g; k++) {
        if (p->index[k] != chaos->index[k]) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "index[%zu][%zu] is %u; in lexicographic order it is %u", k / g,
                                  k % g, p->index[k], chaos->index[k]);
        }
    }
    for (size_t t = 0; t < p->terms; t++) {
        unsigned later = 0;
        for (size_t i = g; i-- > 0;) {
            double c = p->coefficient[t * g + p->component_order[i]];
            if (!isfinite(c) || (later > 0 && c != 0)) {
                return haft_error_set(error, HAFT_ERROR_INPUT,
                                      "coefficient[%zu][%zu] is %g; it must be %s", t,
                                      p->component_order[i], c,
                                      later > 0 ? "0, the term having a later variable" : "finite");
            }
            later += p->index[t * g + i];
        }
    }
    return HAFT_OK;
}

static void gather(haft_chaos *c) {
    size_t g = c->parts.components;
    for (size_t i = 0; i < g; i++) {
        size_t next = 0;
        for (size_t t = 0; t < c->parts.terms; t++) {
            unsigned later = 0;
            for (size_t j = i + 1; j < g; j++) {
                later += c->index[t * g + j];
            }
            if (later == 0) {
                c->compact[i][next++] = c->coefficient[t * g + c->parts.component_order[i]];
            }
        }
    }
}

haft_status haft_chaos_create_from_parts(haft_chaos **out, const haft_chaos_parts *parts,
                                         haft_error *error) {
    haft_chaos *c = NULL;
    *out = NULL;
    haft_status status = check_sizes(parts, error);
    HAFT_THEN(status, check_scalars(parts, error));
    HAFT_THEN(status, check_eigenvectors(parts, error));
    HAFT_THEN(status, check_data(parts, error));
    HAFT_THEN(status, haft_chaos_alloc(&c, parts, error));
    HAFT_THEN(status, check_expansion(c, parts, error));
    if (status == HAFT_OK) {
        size_t g = parts->components;
        memcpy(c->vector, parts->vector, parts->m * sizeof *c->vector);
        memcpy(c->centre, parts->centre, parts->m * g * sizeof *c->centre);
        memcpy(c->coefficient, parts->coefficient, parts->terms * g * sizeof *c->coefficient);
        gather(c);
        status = haft_chaos_place_kernels(c, error);
    }
    if (status != HAFT_OK) {
        haft_chaos_destroy(&c);
    }
    *out = c;
    return status;
}
