/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Convergence of a case's stochastic model in its order and in the number of its vectors. For
 * the latter the vectors are divided into disjoint parts, and each part's kernel density and
 * model are compared with those of all vectors, in the principal components of all. Densities
 * are integrated on a grid by the trapezoidal rule, which is exact to rounding for such smooth
 * kernels. As a part belongs to the whole, it is closer to it than a new sample would be, by
 * about its share of the vectors. */
#include "study/laws/stochastic.h"

#include <math.h>

enum { N = HAFT_CHAOS_DIMENSION, MAPS = 4096, SAMPLES = 16384, GRID = 401, PARTS = 8 };

/* One expansion: all errors except those against the map, which is evaluated once for all. */
static haft_status study_order(haft_order_error *out, const haft_chaos_parts *p, const haft_case *c,
                               const double *xi, const double *eta, haft_error *error) {
    haft_chaos *chaos = NULL;
    haft_chaos_effort effort = {.maps = 1, .samples = SAMPLES};
    haft_status status =
        haft_stochastic_create_of_order(&chaos, p->m, p->vector, c, out->germ, out->order, error);
    HAFT_THEN(status, haft_chaos_measure(chaos, &effort, &out->errors, error));
    if (status == HAFT_OK) {
        haft_chaos_relmise(chaos, HAFT_STUDY_MAPS, xi, eta, out->errors.relmise,
                           &out->errors.relmise_total);
        out->terms = haft_chaos_terms(p->components, out->order);
    }
    haft_chaos_destroy(&chaos);
    return status;
}

void haft_study_list_orders(haft_order_error row[HAFT_STUDY_ORDER_ROWS]) {
    static const size_t orders[HAFT_STUDY_ORDERS] = {1, 2, 3, 4, 6, 8, 10, 12, 14};
    for (size_t i = 0; i < HAFT_STUDY_ORDER_ROWS; i++) {
        row[i] = (haft_order_error){.germ = (haft_chaos_germ)(i / HAFT_STUDY_ORDERS),
                                    .order = orders[i % HAFT_STUDY_ORDERS]};
    }
}

haft_status haft_study_model_orders(const haft_laws *laws, const haft_case *c, size_t n,
                                    haft_order_error *out, haft_error *error) {
    haft_chaos_parts p;
    haft_case own = *c;
    haft_chaos_get_parts(laws->chaos, &p);
    own.law.chaos.spec.components = p.components;
    size_t size = (size_t)HAFT_STUDY_MAPS * p.components;
    double *xi = haft_memory_alloc(2 * size, sizeof *xi, error);
    if (xi == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    haft_status status = haft_chaos_map(laws->chaos, HAFT_STUDY_MAPS, xi, xi + size, error);
    for (size_t i = 0; i < n && status == HAFT_OK; i++) {
        status = study_order(&out[i], &p, &own, xi, xi + size, error);
    }
    haft_memory_free(xi);
    return status;
}

/* ---- the number of vectors ---- */

/* All vectors: their components with a grid and the density there for each, and their centres
 * sorted. */
typedef struct whole {
    const haft_chaos *chaos;
    haft_chaos_parts p;
    double x[N][GRID], density[N][GRID];
    double *sorted; /* [N_g][m] */
    double *drawn;  /* [N_g][SAMPLES] */
} whole;

static haft_status open_whole(whole *w, const haft_chaos *chaos, haft_error *error) {
    w->chaos = chaos;
    haft_chaos_get_parts(chaos, &w->p);
    size_t m = w->p.m, g = w->p.components;
    haft_chaos_kernels all = haft_stochastic_kernels(chaos);
    w->sorted = haft_memory_alloc(g * (m + SAMPLES), sizeof *w->sorted, error);
    if (w->sorted == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    w->drawn = w->sorted + g * m;
    for (size_t j = 0; j < g; j++) {
        haft_stochastic_grid(&all, j, INFINITY, GRID, w->x[j]);
        haft_chaos_density(&all, j, GRID, w->x[j], w->density[j]);
        for (size_t k = 0; k < m; k++) {
            w->sorted[j * m + k] = w->p.centre[k * g + j];
        }
        haft_chaos_sort(m, w->sorted + j * m);
    }
    return HAFT_OK;
}

/* int (p_part - p_all)^2 / int p_all^2. */
static double density_error(const whole *w, const haft_chaos_kernels *part, size_t j) {
    double density[GRID], error = 0, size = 0;
    haft_chaos_density(part, j, GRID, w->x[j], density);
    for (size_t i = 0; i < GRID; i++) {
        double d = density[i] - w->density[j][i];
        error += d * d;
        size += w->density[j][i] * w->density[j][i];
    }
    return error / size;
}

/* The errors of one part of the vectors. */
typedef struct part {
    double density[N], w1[N], relmise;
} part;

static haft_status study_part(part *out, const whole *w, const haft_case *c, size_t first, size_t m,
                              haft_error *error) {
    haft_chaos *chaos = NULL;
    haft_chaos_errors errors;
    haft_chaos_effort effort = {.maps = MAPS, .samples = 1};
    size_t g = w->p.components;
    haft_status status = haft_stochastic_create(&chaos, m, w->p.vector + first, c, error);
    HAFT_THEN(status, haft_chaos_measure(chaos, &effort, &errors, error));
    HAFT_THEN(status,
              haft_stochastic_draw_components(chaos, w->chaos, c->seed, SAMPLES, w->drawn, error));
    if (status == HAFT_OK) {
        haft_chaos_kernels kernels = haft_stochastic_kernels(chaos);
        kernels.centre = w->p.centre + first * g;
        kernels.stride = g;
        out->relmise = errors.relmise_total;
        for (size_t j = 0; j < g; j++) {
            double *x = w->drawn + j * SAMPLES;
            haft_chaos_sort(SAMPLES, x);
            out->w1[j] =
                haft_chaos_distance_of_samples(SAMPLES, x, w->p.m, w->sorted + j * w->p.m).w1;
            out->density[j] = density_error(w, &kernels, j);
        }
    }
    haft_chaos_destroy(&chaos);
    return status;
}

/* Means over the parts, and the standard error of the first. */
static void sum_up(haft_vectors_error *out, const part *each, size_t parts, size_t components) {
    for (size_t k = 0; k < parts; k++) {
        out->relmise += each[k].relmise / (double)parts;
        for (size_t j = 0; j < components; j++) {
            out->density[j] += each[k].density[j] / (double)parts;
            out->w1[j] += each[k].w1[j] / (double)parts;
        }
    }
    for (size_t j = 0; j < components; j++) {
        double squares = 0;
        for (size_t k = 0; k < parts; k++) {
            squares += pow(each[k].density[j] - out->density[j], 2);
        }
        out->density_error[j] =
            parts > 1 ? sqrt(squares / (double)(parts - 1) / (double)parts) : NAN;
    }
}

haft_status haft_study_model_vectors(const haft_laws *laws, const haft_case *c, size_t n,
                                     const size_t *m, haft_vectors_error *out, haft_error *error) {
    whole *w = haft_memory_alloc(1, sizeof *w, error);
    haft_case own = *c;
    haft_status status = w == NULL ? HAFT_ERROR_MEMORY : open_whole(w, laws->chaos, error);
    for (size_t i = 0; i < n && status == HAFT_OK; i++) {
        part each[PARTS];
        size_t parts = w->p.m / m[i] < PARTS ? w->p.m / m[i] : PARTS;
        if (parts == 0) {
            status = haft_error_set(error, HAFT_ERROR_ARGUMENT, "there are %zu vectors, not %zu",
                                    w->p.m, m[i]);
        }
        own.law.chaos.spec.components = w->p.components;
        for (size_t k = 0; k < parts && status == HAFT_OK; k++) {
            status = study_part(&each[k], w, &own, k * (w->p.m / parts), m[i], error);
        }
        out[i] = (haft_vectors_error){.m = m[i], .parts = parts};
        if (status == HAFT_OK) {
            sum_up(&out[i], each, parts, w->p.components);
        }
    }
    if (w != NULL) {
        haft_memory_free(w->sorted);
    }
    haft_memory_free(w);
    return status;
}

size_t haft_study_model_parts(const haft_laws *laws, size_t m[HAFT_STUDY_PARTS]) {
    haft_chaos_parts p;
    haft_chaos_get_parts(laws->chaos, &p);
    size_t n = 0, least = 40;
    for (size_t at = p.m; at >= least && n < HAFT_STUDY_PARTS; at /= 2) {
        m[n++] = at;
    }
    for (size_t i = 0; i < n / 2; i++) {
        size_t swap = m[i];
        m[i] = m[n - 1 - i];
        m[n - 1 - i] = swap;
    }
    return n;
}
