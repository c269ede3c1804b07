/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The beam's shapes along a path: from a realization's evidence, or by following the path again,
 * which gives the same bits. */
#include "haft/study.h"

static haft_results_shapes *make_shapes(const haft_model *model, size_t points, haft_error *error) {
    haft_results_shapes *s = haft_memory_alloc(1, sizeof *s, error);
    if (s == NULL) {
        return NULL;
    }
    s->points = points;
    s->nodes = haft_model_get(model)->nodes;
    s->node_x = haft_memory_alloc(s->nodes, sizeof(double), error);
    s->deflection = haft_memory_alloc(points * s->nodes, sizeof(double), error);
    s->rotation = haft_memory_alloc(points * s->nodes, sizeof(double), error);
    if (!s->node_x || !s->deflection || !s->rotation) {
        haft_results_shapes_destroy(&s);
    }
    return s;
}

/* Nodes after the clamp have a deflection and a rotation each. */
static void fill_shapes(haft_results_shapes *s, const haft_model *model, const haft_path *path) {
    const haft_model_data *m = haft_model_get(model);
    for (size_t k = 0; k < s->nodes; k++) {
        s->node_x[k] = m->node_x[k];
    }
    for (size_t i = 0; i < s->points; i++) {
        const double *u = path->state + i * m->dofs;
        for (size_t k = 1; k < s->nodes; k++) {
            size_t w = 2 * (k - 1);
            s->deflection[i * s->nodes + k] = m->scale[w] * u[w];
            s->rotation[i * s->nodes + k] = m->scale[w + 1] * u[w + 1];
        }
    }
}

static haft_status follow_again(haft_results_shapes **out, const haft_case *c,
                                const haft_laws *laws, size_t realization, haft_error *error) {
    haft_model *model = NULL;
    haft_site_laws *sites = NULL;
    haft_path *path = NULL;
    haft_summary summary;
    haft_status status = haft_model_create_beam(&model, &c->beam, &c->mesh, error);
    HAFT_THEN(status, haft_study_site_laws(&sites, c, laws, realization, error));
    HAFT_THEN(status, haft_study_realize(&path, &summary, c, model, sites, true, error));
    if (status == HAFT_OK) {
        *out = make_shapes(model, path->points, error);
        status = *out == NULL ? HAFT_ERROR_MEMORY : HAFT_OK;
    }
    if (status == HAFT_OK) {
        fill_shapes(*out, model, path);
    }
    haft_path_destroy(&path);
    haft_site_laws_destroy(&sites);
    haft_model_destroy(&model);
    return status;
}

haft_status haft_study_shapes(haft_results_shapes **out, const haft_case *c, const haft_laws *laws,
                              const char *results_path, size_t realization, haft_error *error) {
    *out = NULL;
    return haft_case_wants_evidence(c, realization)
               ? haft_results_read_shapes(out, results_path, realization, error)
               : follow_again(out, c, laws, realization, error);
}
