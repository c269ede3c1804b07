/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The data of a model's figures (Figs. 14b, 16, 17, 18 of Hoang et al.): the vectors, their
 * kernel density, and the expansion at a few orders. Densities of samples are histograms of so
 * many samples that a bin near the mode is good to a percent. */
#include "stochastic_figures.h"
#include "sheet.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { N = HAFT_CHAOS_DIMENSION, DRAWN = 1 << 19, LINE = 121, PLANE = 49, LAWS = 10 };

/* ---- a few orders of one model ---- */

void haft_stochastic_orders_close(orders *o) {
    for (size_t i = 0; i < o->n; i++) {
        haft_chaos_destroy(&o->chaos[i]);
        haft_memory_free(o->eta[i]);
    }
    *o = (orders){0};
}

/* The expansions of those orders, and many components drawn from each, sorted by component. */
haft_status haft_stochastic_orders_open(orders *o, const haft_case *c, const haft_laws *laws,
                                        haft_error *error) {
    haft_chaos_get_parts(laws->chaos, &o->p);
    o->n = 0;
    for (size_t order = 4; order < o->p.order && o->n + 1 < ORDERS; order += 4) {
        o->order[o->n++] = order;
    }
    o->order[o->n++] = o->p.order;
    haft_status status = HAFT_OK;
    for (size_t i = 0; i < o->n && status == HAFT_OK; i++) {
        status = haft_stochastic_create_of_order(&o->chaos[i], o->p.m, o->p.vector, c, o->p.germ,
                                                 o->order[i], error);
        if (status == HAFT_OK) {
            o->eta[i] = haft_memory_alloc(o->p.components * DRAWN, sizeof(double), error);
            status = o->eta[i] == NULL
                         ? HAFT_ERROR_MEMORY
                         : haft_stochastic_draw_components(o->chaos[i], laws->chaos, c->seed, DRAWN,
                                                           o->eta[i], error);
        }
        snprintf(o->label[i], sizeof o->label[i], "order %zu", o->order[i]);
    }
    if (status != HAFT_OK) {
        haft_stochastic_orders_close(o);
    }
    return status;
}

/* ---- histograms ---- */

/* Density of samples in the bins of width `step` about the points x[0], x[0] + step, ... */
static void count_line(size_t n, const double *sample, size_t stride, double low, double step,
                       size_t bins, double *density) {
    memset(density, 0, bins * sizeof *density);
    for (size_t k = 0; k < n; k++) {
        double at = (sample[k * stride] - low) / step + 0.5;
        if (at >= 0 && at < (double)bins) {
            density[(size_t)at] += 1 / ((double)n * step);
        }
    }
}

static void count_plane(size_t n, const double *x, const double *y, const double low[2],
                        const double step[2], double *density) {
    memset(density, 0, sizeof *density * PLANE * PLANE);
    for (size_t k = 0; k < n; k++) {
        double i = (x[k] - low[0]) / step[0] + 0.5, j = (y[k] - low[1]) / step[1] + 0.5;
        if (i >= 0 && i < PLANE && j >= 0 && j < PLANE) {
            density[(size_t)i * PLANE + (size_t)j] += 1 / ((double)n * step[0] * step[1]);
        }
    }
}

/* ---- the figures ---- */

/* Ten laws as drawn for the solver (Fig. 14b). */
static haft_status write_generated(const haft_case *c, const haft_laws *laws, const char *directory,
                                   haft_error *error) {
    enum { POINTS = 441 };
    static const char *const name[] = {"distance [nm]", "law 0 [MPa]", "law 1 [MPa]", "law 2 [MPa]",
                                       "law 3 [MPa]",   "law 4 [MPa]", "law 5 [MPa]", "law 6 [MPa]",
                                       "law 7 [MPa]",   "law 8 [MPa]", "law 9 [MPa]"};
    haft_law_vector vector[LAWS];
    haft_sheet t;
    haft_status status = haft_chaos_sample(laws->chaos, NULL, HAFT_CHAOS_SAMPLER_GPCE, c->seed, 0,
                                           0, LAWS, vector, error);
    HAFT_THEN(status, haft_sheet_make(&t, POINTS, 1 + LAWS, error));
    if (status != HAFT_OK) {
        return status;
    }
    double from = c->contact.distance_from, span = c->contact.distance_to - from;
    for (size_t k = 0; k < LAWS; k++) {
        haft_law law;
        bool sound = haft_law_morse(&law, &vector[k], laws->f_limit) == HAFT_LAW_SOUND;
        law.far = c->contact.far;
        for (size_t i = 0; i < POINTS; i++) {
            double d = from + span * (double)i / (POINTS - 1);
            t.value[i * (1 + LAWS)] = d * 1e9;
            t.value[i * (1 + LAWS) + 1 + k] = sound ? haft_law_evaluate(&law, d).force * 1e-6 : NAN;
        }
    }
    haft_sheet_name(&t, name);
    return haft_sheet_write(&t, directory, "generated.csv", error);
}

static double left_out(const haft_chaos_parts *p, size_t kept) {
    double sum = 0, rest = 0;
    for (size_t j = 0; j < N; j++) {
        sum += p->eigenvalue[j];
        rest += j < kept ? 0 : p->eigenvalue[j];
    }
    return rest / sum;
}

/* Err^DR(N_g) by the case's bounds and by the source's (Fig. 16). */
static haft_status write_reduction(const haft_case *c, const haft_laws *laws, const char *directory,
                                   haft_error *error) {
    static const char *const name[] = {"components", "left out [1]", "left out by Eq. 24 [1]"};
    haft_case own = *c;
    haft_chaos_parts p, eq24;
    haft_chaos *chaos = NULL;
    haft_sheet t;
    own.law.chaos.spec.bounds = HAFT_CHAOS_BOUNDS_PAPER;
    haft_chaos_get_parts(laws->chaos, &p);
    haft_status status =
        haft_stochastic_create_of_order(&chaos, p.m, p.vector, &own, p.germ, 1, error);
    if (status == HAFT_OK) {
        haft_chaos_get_parts(chaos, &eq24);
        status = haft_sheet_make(&t, N + 1, 3, error);
    }
    if (status == HAFT_OK) {
        for (size_t g = 0; g <= N; g++) {
            double row[3] = {(double)g, left_out(&p, g), left_out(&eq24, g)};
            memcpy(t.value + 3 * g, row, sizeof row);
        }
        haft_sheet_name(&t, name);
        status = haft_sheet_write(&t, directory, "reduction.csv", error);
    }
    haft_chaos_destroy(&chaos);
    return status;
}

/* Marginal densities of the components (Fig. 17a, c, e). */
static haft_status write_components(const orders *o, const haft_laws *laws, const char *directory,
                                    haft_error *error) {
    const char *name[4 + ORDERS] = {"component", "eta [1]", "vectors [1]", "kernels [1]"};
    size_t columns = 4 + o->n, g = o->p.components;
    haft_chaos_kernels kernels = haft_stochastic_kernels(laws->chaos);
    double x[LINE], density[LINE];
    haft_sheet t;
    haft_status status = haft_sheet_make(&t, g * LINE, columns, error);
    for (size_t j = 0; j < g && status == HAFT_OK; j++) {
        double *first = t.value + j * LINE * columns;
        haft_stochastic_grid(&kernels, j, SHOWN, LINE, x);
        double step = x[1] - x[0];
        for (size_t k = 0; k < columns - 2; k++) {
            if (k == 0) {
                count_line(o->p.m, o->p.centre + j, g, x[0], step, LINE, density);
            } else if (k == 1) {
                haft_chaos_density(&kernels, j, LINE, x, density);
            } else {
                count_line(DRAWN, o->eta[k - 2] + j * DRAWN, 1, x[0], step, LINE, density);
            }
            for (size_t i = 0; i < LINE; i++) {
                first[i * columns] = (double)(j + 1);
                first[i * columns + 1] = x[i];
                first[i * columns + 2 + k] = density[i];
            }
        }
    }
    for (size_t i = 0; i < o->n; i++) {
        name[4 + i] = o->label[i];
    }
    if (status == HAFT_OK) {
        haft_sheet_name(&t, name);
        status = haft_sheet_write(&t, directory, "components.csv", error);
    }
    return status;
}

static haft_status fill_plane(haft_sheet *t, size_t pair, size_t a, size_t b, const orders *o,
                              const haft_chaos_kernels *kernels, double *density,
                              haft_error *error) {
    double x[2][PLANE], low[2], step[2], *counted = density + PLANE * PLANE;
    const double *eta = o->eta[o->n - 1];
    for (size_t i = 0; i < 2; i++) {
        haft_stochastic_grid(kernels, i == 0 ? a : b, SHOWN, PLANE, x[i]);
        low[i] = x[i][0];
        step[i] = x[i][1] - x[i][0];
    }
    haft_status status =
        haft_chaos_joint_density(kernels, a, b, PLANE, x[0], PLANE, x[1], density, error);
    count_plane(DRAWN, eta + a * DRAWN, eta + b * DRAWN, low, step, counted);
    for (size_t i = 0; i < PLANE * PLANE; i++) {
        double row[5] = {(double)pair, x[0][i / PLANE], x[1][i % PLANE], density[i], counted[i]};
        memcpy(t->value + 5 * (pair * PLANE * PLANE + i), row, sizeof row);
    }
    return status;
}

/* Joint densities of two components each (Fig. 17b, d, f): pairs 1-2, 1-3, 2-3, ... */
static haft_status write_joint(const orders *o, const haft_laws *laws, const char *directory,
                               haft_error *error) {
    static const char *const name[] = {"pair", "eta a [1]", "eta b [1]", "kernels [1]",
                                       "expansion [1]"};
    size_t g = o->p.components, pairs = g * (g - 1) / 2, pair = 0;
    haft_chaos_kernels kernels = haft_stochastic_kernels(laws->chaos);
    haft_sheet t = {0};
    double *density = haft_memory_alloc(2 * PLANE * PLANE, sizeof *density, error);
    haft_status status =
        density == NULL ? HAFT_ERROR_MEMORY : haft_sheet_make(&t, pairs * PLANE * PLANE, 5, error);
    for (size_t a = 0; a < g; a++) {
        for (size_t b = a + 1; b < g && status == HAFT_OK; b++) {
            status = fill_plane(&t, pair++, a, b, o, &kernels, density, error);
        }
    }
    haft_memory_free(density);
    if (status != HAFT_OK) {
        haft_sheet_drop(&t);
        return status;
    }
    haft_sheet_name(&t, name);
    return haft_sheet_write(&t, directory, "joint.csv", error);
}

static double number_of(const haft_law_vector *v, int i) {
    const double number[N] = {v->e * 1e3, v->f_max * 1e-6, v->d_max * 1e9, v->d_limit * 1e9};
    return number[i];
}

/* Densities of e, f_max, d_max, d_limit: of the vectors, and of those drawn (Fig. 18). */
static haft_status write_marginals(const haft_case *c, const haft_laws *laws, const char *directory,
                                   haft_error *error) {
    enum { BINS = 40 };
    static const char *const name[] = {"number", "value", "vectors", "drawn"};
    haft_chaos_parts p;
    haft_chaos_get_parts(laws->chaos, &p);
    double density[2][BINS];
    haft_sheet t = {0};
    haft_law_vector *drawn = haft_memory_alloc(DRAWN, sizeof *drawn, error);
    double *x = haft_memory_alloc(p.m + DRAWN, sizeof *x, error);
    haft_status status =
        drawn == NULL || x == NULL ? HAFT_ERROR_MEMORY : haft_sheet_make(&t, N * BINS, 4, error);
    HAFT_THEN(status, haft_chaos_sample(laws->chaos, NULL, HAFT_CHAOS_SAMPLER_GPCE, c->seed, 0, 0,
                                        DRAWN, drawn, error));
    for (int i = 0; i < N && status == HAFT_OK; i++) {
        for (size_t k = 0; k < p.m + DRAWN; k++) {
            x[k] = number_of(k < p.m ? &p.vector[k] : &drawn[k - p.m], i);
        }
        haft_chaos_sort(p.m, x);
        double low = x[p.m / 1000], high = x[p.m - 1 - p.m / 1000];
        double margin = 0.15 * (high - low), step = (1.3 * (high - low)) / BINS;
        low = i < 2 ? fmax(0, low - margin) : low - margin;
        count_line(p.m, x, 1, low + 0.5 * step, step, BINS, density[0]);
        count_line(DRAWN, x + p.m, 1, low + 0.5 * step, step, BINS, density[1]);
        for (size_t b = 0; b < BINS; b++) {
            double row[4] = {i, low + ((double)b + 0.5) * step, density[0][b], density[1][b]};
            memcpy(t.value + 4 * ((size_t)i * BINS + b), row, sizeof row);
        }
    }
    haft_memory_free(x);
    haft_memory_free(drawn);
    if (status != HAFT_OK) {
        haft_sheet_drop(&t);
        return status;
    }
    haft_sheet_name(&t, name);
    return haft_sheet_write(&t, directory, "marginals.csv", error);
}

haft_status haft_study_write_model_figures(const haft_case *c, const haft_laws *laws,
                                           const char *directory, haft_error *error) {
    orders o = {0};
    haft_status status = write_generated(c, laws, directory, error);
    HAFT_THEN(status, write_reduction(c, laws, directory, error));
    HAFT_THEN(status, write_marginals(c, laws, directory, error));
    HAFT_THEN(status, haft_stochastic_orders_open(&o, c, laws, error));
    HAFT_THEN(status, write_components(&o, laws, directory, error));
    HAFT_THEN(status, write_joint(&o, laws, directory, error));
    HAFT_THEN(status, haft_stochastic_write_map(&o, laws, directory, error));
    haft_stochastic_orders_close(&o);
    HAFT_THEN(status, haft_stochastic_write_orders(c, laws, directory, error));
    return status == HAFT_OK ? haft_stochastic_write_parts(c, laws, directory, error) : status;
}
