/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tracker's memory, its options and the lengths of the laws, and its meshes. */
#include "active_mesh.h"

#include <math.h>
#include <string.h>

static const haft_path_options DEFAULTS = {
    .gap_step = 0.5,
    .ledger_tolerance = 1e-10,
    .residual_tolerance = 1e-11,
    .flow_step = 0.1,
    .step_limit = 200000,
};

static haft_path_options resolve(const haft_path_options *given) {
    haft_path_options o = given == NULL ? DEFAULTS : *given;
    o.gap_step = o.gap_step > 0 ? o.gap_step : DEFAULTS.gap_step;
    o.ledger_tolerance = o.ledger_tolerance > 0 ? o.ledger_tolerance : DEFAULTS.ledger_tolerance;
    o.residual_tolerance =
        o.residual_tolerance > 0 ? o.residual_tolerance : DEFAULTS.residual_tolerance;
    o.flow_step = o.flow_step > 0 ? o.flow_step : DEFAULTS.flow_step;
    o.step_limit = o.step_limit > 0 ? o.step_limit : DEFAULTS.step_limit;
    return o;
}

/* Lists of all vectors of length n and of all vectors over sites, for allocation and freeing. */
enum { VECTORS = 21, SITE_VECTORS = 15 + HAFT_SITE_SCRATCH };
static void list_vectors(haft_tracker *t, double **vector[VECTORS]) {
    double **all[VECTORS] = {&t->gradient,
                             &t->other.gradient,
                             &t->solution,
                             &t->mode,
                             &t->null,
                             &t->work.scratch[0],
                             &t->work.scratch[1],
                             &t->work.scratch[2],
                             &t->work.scratch[3],
                             &t->here.u,
                             &t->next.u,
                             &t->spare.u,
                             &t->start.u1,
                             &t->start.u2,
                             &t->end.u1,
                             &t->end.u2,
                             &t->rebased.u1,
                             &t->rebased.u2,
                             &t->work.stage[0],
                             &t->work.stage[1],
                             &t->work.stage[2]};
    memcpy(vector, all, sizeof all);
}

static void list_site_vectors(haft_tracker *t, double **vector[SITE_VECTORS]) {
    double **all[SITE_VECTORS] = {&t->problem.lengths.range,
                                  &t->problem.lengths.edge,
                                  &t->problem.lengths.wide,
                                  &t->problem.reach,
                                  &t->problem.lengths.far,
                                  &t->problem.lost,
                                  &t->problem.lengths.wall,
                                  &t->gap_before,
                                  &t->gap,
                                  &t->site_stiffness,
                                  &t->motion,
                                  &t->gap_predicted,
                                  &t->here.gap,
                                  &t->next.gap,
                                  &t->spare.gap,
                                  &t->work.site[0],
                                  &t->work.site[1],
                                  &t->work.site[2],
                                  &t->work.site[3],
                                  &t->work.site[4]};
    memcpy(vector, all, sizeof all);
}

static bool allocate_list(double ***vector, int count, size_t n, haft_error *error) {
    for (int i = 0; i < count; i++) {
        *vector[i] = haft_memory_alloc(n, sizeof(double), error);
        if (*vector[i] == NULL) {
            return false;
        }
    }
    return true;
}

static void free_list(double ***vector, int count) {
    for (int i = 0; i < count; i++) {
        haft_memory_free(*vector[i]);
    }
}

static haft_status allocate(haft_tracker *t, haft_error *error) {
    double **vector[VECTORS], **site_vector[SITE_VECTORS];
    list_vectors(t, vector);
    list_site_vectors(t, site_vector);
    if (!allocate_list(vector, VECTORS, t->n, error) ||
        !allocate_list(site_vector, SITE_VECTORS, haft_mesh_of(t)->sites, error)) {
        return HAFT_ERROR_MEMORY;
    }
    t->work.pair = haft_memory_alloc(2 * t->n, sizeof(double), error);
    t->hessian = haft_memory_alloc(haft_mesh_of(t)->nonzeros, sizeof(double), error);
    t->other.hessian = haft_memory_alloc(haft_mesh_of(t)->nonzeros, sizeof(double), error);
    t->work.matrix = haft_memory_alloc(haft_mesh_of(t)->nonzeros, sizeof(double), error);
    if (!t->work.pair || !t->hessian || !t->other.hessian || !t->work.matrix) {
        return HAFT_ERROR_MEMORY;
    }
    return HAFT_OK;
}

/* Share of the greatest pull below which a force hardly matters for the step size. */
#define FAINT_SHARE 1e-3

/* Share below which it is lost in rounding. */
#define LOST_SHARE 1e-16

/* The steepest fall of the far field's pull [Pa/m]. */
static double steepest_far(const haft_far_field *far) {
    enum { POINTS = 256 };
    double most = 0;
    for (int i = 0; i < POINTS && far != NULL; i++) {
        double d = far->first + (far->out - far->first) * pow((double)i / POINTS, 3);
        double energy, pressure, slope;
        haft_far_field_evaluate(far, 1, &d,
                                &(haft_far_field_values){&energy, &pressure, &slope, NULL});
        most = fmax(most, fabs(slope));
    }
    return most;
}

/* A far field changes over a third of the gap or more, which is longer than the step out of what
 * the near part has there: so `far` is the near part's, and beyond it steps grow with the gap. */
static double extent_of_near(const haft_law *law) {
    haft_law near = *law;
    near.far = NULL;
    return haft_law_extent(&near, FAINT_SHARE);
}

static haft_status put_at_rest(haft_tracker *t, haft_error *error) {
    size_t sites = haft_mesh_of(t)->sites;
    t->problem.far_slope = steepest_far(sites > 0 ? t->problem.laws[0].far : NULL);
    for (size_t r = 0; r < haft_mesh_of(t)->sites; r++) {
        haft_law_lengths lengths = haft_law_find_lengths(&t->problem.laws[r]);
        t->problem.lengths.range[r] = lengths.range;
        t->problem.lengths.edge[r] = lengths.edge;
        t->problem.lengths.wide[r] = lengths.wide;
        t->problem.reach[r] =
            haft_law_reach(&t->problem.laws[r], t->problem.programme.crack_threshold);
        t->problem.lengths.far[r] = extent_of_near(&t->problem.laws[r]);
        t->problem.lost[r] = haft_law_extent(&t->problem.laws[r], LOST_SHARE);
        t->problem.lengths.wall[r] = t->problem.laws[r].wall_distance;
        if (!(t->problem.lengths.range[r] > 0) ||
            !isfinite(t->problem.lengths.range[r] + t->problem.lengths.far[r] +
                      t->problem.reach[r])) {
            return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                                  "the law of site %zu has no finite range", r);
        }
    }
    for (size_t i = 0; i < t->n; i++) {
        t->mode[i] = 1 / (double)(i + 1);
    }
    return haft_active_meshes_create(t, error);
}

haft_status haft_tracker_create(haft_tracker **out, const haft_model *model, const haft_law *laws,
                                const haft_programme *programme, const haft_path_options *options,
                                haft_error *error) {
    const haft_model_data *m = haft_model_get(model);
    *out = NULL;
    haft_tracker *t = haft_memory_alloc(1, sizeof *t, error);
    if (t == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    t->problem.whole = model;
    t->model = model;
    t->problem.laws = laws;
    t->problem.programme = *programme;
    t->problem.options = resolve(options);
    t->n = m->dofs;
    t->problem.load_unit = m->energy_unit / m->gap;
    t->needs_refinement = true; /* until it is known */
    haft_status status = allocate(t, error);
    HAFT_THEN(status, haft_model_create_front(&t->front, error));
    HAFT_THEN(status, haft_law_rows_create(&t->problem.rows, m->sites, laws, error));
    HAFT_THEN(status, put_at_rest(t, error));
    if (status != HAFT_OK) {
        haft_tracker_destroy(&t);
    }
    *out = t;
    return status;
}

void haft_tracker_destroy(haft_tracker **tracker) {
    if (tracker == NULL || *tracker == NULL) {
        return;
    }
    haft_tracker *t = *tracker;
    haft_active_meshes_destroy(t);
    double **vector[VECTORS], **site_vector[SITE_VECTORS];
    list_vectors(t, vector);
    list_site_vectors(t, site_vector);
    free_list(vector, VECTORS);
    free_list(site_vector, SITE_VECTORS);
    haft_memory_free(t->work.pair);
    haft_memory_free(t->hessian);
    haft_memory_free(t->other.hessian);
    haft_memory_free(t->work.matrix);
    haft_law_rows_destroy(&t->problem.rows);
    haft_model_destroy_front(&t->front);
    haft_memory_free(t);
    *tracker = NULL;
}
