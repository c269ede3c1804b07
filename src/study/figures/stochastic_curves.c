/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The data of the figures of a model's convergence (Figs. B.22 and C.23 of Hoang et al.). */
#include "sheet.h"
#include "stochastic_figures.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { N = HAFT_CHAOS_DIMENSION, LINE = 301, DENSITIES = 5 };

/* ---- the map ---- */

/* A line through the germ's cube: coordinate 0, or coordinate 1 at a given probability of it. */
typedef struct section {
    size_t coordinate;
    double first;
} section;

static haft_status fill_section(haft_sheet *t, size_t curve, section s, const orders *o,
                                const haft_laws *laws, haft_chaos_work *work, haft_error *error) {
    size_t at = o->p.component_order[s.coordinate];
    for (size_t i = 0; i < LINE; i++) {
        double *row = t->value + (curve * LINE + i) * t->columns, eta[N], germ[N];
        double u = ((double)i + 0.5) / LINE, xi[N] = {0.5, 0.5, 0.5, 0.5};
        xi[0] = s.coordinate == 0 ? u : s.first;
        xi[s.coordinate] = u;
        HAFT_TRY(haft_chaos_inverse(laws->chaos, work, xi, NULL, eta, error));
        row[0] = (double)curve;
        row[1] = u;
        row[2] = eta[at];
        for (size_t k = 0; k < o->n; k++) {
            for (size_t j = 0; j < o->p.components; j++) {
                germ[j] = haft_chaos_germ_quantile(o->p.germ, xi[j]);
            }
            haft_chaos_expand(o->chaos[k], germ, eta);
            row[3 + k] = eta[at];
        }
    }
    return HAFT_OK;
}

haft_status haft_stochastic_write_map(const orders *o, const haft_laws *laws, const char *directory,
                                      haft_error *error) {
    static const section sections[] = {{0, 0}, {1, 0.1}, {1, 0.5}, {1, 0.9}};
    const char *name[3 + ORDERS] = {"curve", "xi [1]", "map [1]"};
    size_t curves = o->p.components > 1 ? 4 : 1;
    haft_chaos_work *work = NULL;
    haft_sheet t = {0};
    haft_status status = haft_chaos_work_create(&work, laws->chaos, error);
    HAFT_THEN(status, haft_sheet_make(&t, curves * LINE, 3 + o->n, error));
    for (size_t i = 0; i < curves && status == HAFT_OK; i++) {
        status = fill_section(&t, i, sections[i], o, laws, work, error);
    }
    haft_chaos_work_destroy(&work);
    if (status != HAFT_OK) {
        haft_sheet_drop(&t);
        return status;
    }
    for (size_t k = 0; k < o->n; k++) {
        name[3 + k] = o->label[k];
    }
    haft_sheet_name(&t, name);
    return haft_sheet_write(&t, directory, "map.csv", error);
}

/* ---- the order ---- */

haft_status haft_stochastic_write_orders(const haft_case *c, const haft_laws *laws,
                                         const char *directory, haft_error *error) {
    enum { COLUMNS = 8 + 2 * N };
    static const char *const name[COLUMNS] = {"germ",         "order",       "terms",
                                              "own rule [1]", "relMISE [1]", "variance lacking [1]",
                                              "KS [1]",       "outside [1]", "own rule 1",
                                              "own rule 2",   "own rule 3",  "own rule 4",
                                              "relMISE 1",    "relMISE 2",   "relMISE 3",
                                              "relMISE 4"};
    enum { ROWS = HAFT_STUDY_ORDER_ROWS };
    haft_order_error o[ROWS];
    haft_sheet t = {0};
    haft_chaos_parts p;
    haft_chaos_get_parts(laws->chaos, &p);
    haft_study_list_orders(o);
    haft_status status = haft_study_model_orders(laws, c, ROWS, o, error);
    HAFT_THEN(status, haft_sheet_make(&t, ROWS, COLUMNS, error));
    for (size_t i = 0; i < ROWS && status == HAFT_OK; i++) {
        const haft_chaos_errors *e = &o[i].errors;
        double *row = t.value + i * COLUMNS;
        row[0] = o[i].germ;
        row[1] = (double)o[i].order;
        row[2] = (double)o[i].terms;
        row[3] = e->relmise_own_total;
        row[4] = e->relmise_total;
        for (size_t j = 0; j < N; j++) {
            bool kept = j < p.components;
            row[5] = kept ? fmax(row[5], fabs(e->variance_error[j])) : row[5];
            row[6] = kept ? fmax(row[6], e->kernel[j].ks) : row[6];
            row[8 + j] = kept ? e->relmise_own[j] : NAN;
            row[8 + N + j] = kept ? e->relmise[j] : NAN;
        }
        row[7] = e->outside;
    }
    if (status != HAFT_OK) {
        haft_sheet_drop(&t);
        return status;
    }
    haft_sheet_name(&t, name);
    return haft_sheet_write(&t, directory, "orders.csv", error);
}

/* ---- the number of vectors ---- */

/* Density of eta_1 by the first m of the vectors, for a few m up to all. */
static haft_status write_density(const haft_laws *laws, size_t n, const size_t *m,
                                 const char *directory, haft_error *error) {
    const char *name[1 + DENSITIES] = {"eta_1 [1]"};
    char label[DENSITIES][32];
    haft_chaos_kernels kernels = haft_stochastic_kernels(laws->chaos);
    double x[LINE], density[LINE], all = kernels.bandwidth, whole = (double)kernels.m;
    haft_sheet t;
    HAFT_TRY(haft_sheet_make(&t, LINE, 1 + n, error));
    haft_stochastic_grid(&kernels, 0, SHOWN, LINE, x);
    for (size_t k = 0; k < n; k++) {
        /* Scott's factor; a bandwidth that the case fixes is scaled alike */
        kernels.m = m[k];
        kernels.bandwidth = all * pow((double)m[k] / whole, -1 / ((double)kernels.stride + 4));
        haft_chaos_density(&kernels, 0, LINE, x, density);
        for (size_t i = 0; i < LINE; i++) {
            t.value[i * (1 + n)] = x[i];
            t.value[i * (1 + n) + 1 + k] = density[i];
        }
        snprintf(label[k], sizeof label[k], "m = %zu", m[k]);
        name[1 + k] = label[k];
    }
    haft_sheet_name(&t, name);
    return haft_sheet_write(&t, directory, "density.csv", error);
}

static haft_status write_errors(const haft_case *c, const haft_laws *laws, size_t n,
                                const size_t *m, const char *directory, haft_error *error) {
    enum { COLUMNS = 3 + 3 * N };
    static const char *const name[COLUMNS] = {
        "vectors",       "parts",         "relMISE of the expansion [1]",
        "density 1 [1]", "density 2 [1]", "density 3 [1]",
        "density 4 [1]", "error 1",       "error 2",
        "error 3",       "error 4",       "W1 1 [sd]",
        "W1 2 [sd]",     "W1 3 [sd]",     "W1 4 [sd]"};
    haft_vectors_error e[HAFT_STUDY_PARTS];
    haft_sheet t;
    haft_chaos_parts p;
    haft_chaos_get_parts(laws->chaos, &p);
    haft_status status = haft_study_model_vectors(laws, c, n, m, e, error);
    HAFT_THEN(status, haft_sheet_make(&t, n, COLUMNS, error));
    if (status != HAFT_OK) {
        return status;
    }
    for (size_t i = 0; i < n; i++) {
        double *row = t.value + i * COLUMNS;
        row[0] = (double)e[i].m;
        row[1] = (double)e[i].parts;
        row[2] = e[i].relmise;
        for (size_t j = 0; j < N; j++) {
            row[3 + j] = j < p.components ? e[i].density[j] : NAN;
            row[3 + N + j] = j < p.components ? e[i].density_error[j] : NAN;
            row[3 + 2 * N + j] = j < p.components ? e[i].w1[j] : NAN;
        }
    }
    haft_sheet_name(&t, name);
    return haft_sheet_write(&t, directory, "parts.csv", error);
}

haft_status haft_stochastic_write_parts(const haft_case *c, const haft_laws *laws,
                                        const char *directory, haft_error *error) {
    size_t m[HAFT_STUDY_PARTS], n = haft_study_model_parts(laws, m);
    if (n == 0) {
        haft_chaos_parts p;
        haft_chaos_get_parts(laws->chaos, &p);
        m[n++] = p.m;
    }
    size_t few = n < DENSITIES ? n : DENSITIES;
    haft_status status = write_errors(c, laws, n, m, directory, error);
    return status == HAFT_OK ? write_density(laws, few, m + n - few, directory, error) : status;
}
