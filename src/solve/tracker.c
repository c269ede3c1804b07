/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tracker's small operations: evaluation, rows of sites, lengths over which forces change. */
#include "tracker.h"

#include <math.h>
#include <string.h>

bool haft_tracker_evaluate(haft_tracker *t, const double *u, double load, haft_energy *energy,
                           double *force_scale) {
    haft_energy e = haft_model_evaluate(t->model, t->rows, u, load * t->load_unit, t->gradient,
                                        t->hessian, force_scale);
    if (energy != NULL) {
        *energy = e;
    }
    double sum = e.strain + e.contact;
    for (size_t i = 0; i < t->n; i++) {
        sum += t->gradient[i];
    }
    t->not_finite += !isfinite(sum);
    return isfinite(sum);
}

bool haft_tracker_gradient(haft_tracker *t, const double *u, double load) {
    haft_energy e =
        haft_model_evaluate(t->model, t->rows, u, load * t->load_unit, t->gradient, NULL, NULL);
    double sum = e.strain + e.contact;
    t->not_finite += !isfinite(sum);
    return isfinite(sum);
}

void haft_tracker_solve(haft_tracker *t, double *b) {
    t->cost.solves++;
    haft_factor_solve(t->factor, b, 1);
}

double haft_tracker_row(const haft_tracker *t, const haft_site *site, const double *v) {
    return haft_model_displacement(site, v) / t->model->gap;
}

void haft_tracker_add_row(const haft_tracker *t, const haft_site *site, double factor, double *v) {
    for (int k = 0; k < site->terms; k++) {
        v[site->dof[k]] += factor * site->shape[k] / t->model->gap;
    }
}

void haft_tracker_add_mass(const haft_tracker *t, double factor, const double *x, double *y) {
    const haft_model *m = t->model;
    for (size_t j = 0; j < t->n; j++) { /* M is symmetric: a column is a row */
        double sum = 0;
        for (int k = m->column[j]; k < m->column[j + 1]; k++) {
            sum += m->mass[k] * x[m->row[k]];
        }
        y[j] += factor * sum;
    }
}

double haft_tracker_potential(const haft_tracker *t, const haft_state *state) {
    return state->energy.strain + state->energy.contact -
           state->load * t->model->energy_unit * haft_tracker_row(t, &t->model->load, state->u);
}

double haft_tracker_rounding(const haft_state *a, const haft_state *b) {
    double size = fabs(a->energy.strain) + fabs(a->energy.contact) + fabs(b->energy.strain) +
                  fabs(b->energy.contact);
    return 0x1p-47 * size + 4 * (a->energy.rounding + b->energy.rounding);
}

double haft_control_value(const haft_tracker *t, haft_control control, const haft_state *state) {
    return control.site == NULL ? state->load : haft_tracker_row(t, control.site, state->u);
}

bool haft_tracker_is_clear(const haft_tracker *t, const double *u) {
    for (size_t r = 0; r < t->model->inert; r++) {
        if (t->model->gap - haft_model_displacement(&t->model->site[r], u) <= t->far[r]) {
            return false;
        }
    }
    return true;
}

/* How far each site's gap moves in lengths of its law, into `share`. */
HAFT_CLONES static void measure_moves(const haft_tracker *t, const double *w, const double *motion,
                                      double *restrict share) {
    for (size_t r = t->model->inert; r < t->model->sites; r++) {
        share[r] = fabs(motion[r]) / haft_tracker_length(t, r, t->model->gap - w[r]);
    }
}

double haft_tracker_move(const haft_tracker *t, const double *u, const double *v, size_t *site) {
    double *w = t->site[0], *motion = t->site[1], *share = t->site[2], largest = 0;
    haft_model_displacements(t->model, u, w);
    haft_model_displacements(t->model, v, motion);
    measure_moves(t, w, motion, share);
    for (size_t r = t->model->inert; r < t->model->sites; r++) {
        if (share[r] > largest) {
            largest = share[r];
            if (site != NULL) {
                *site = r;
            }
        }
    }
    return largest;
}

static const haft_path_options DEFAULTS = {
    .gap_step = 0.25,
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

/* All vectors of length n, in one list: allocated and freed by the same walk. */
enum { VECTORS = 20 };
static void list_vectors(haft_tracker *t, double **vector[VECTORS]) {
    double **all[VECTORS] = {&t->gradient,   &t->solution,   &t->mode,       &t->null,
                             &t->scratch[0], &t->scratch[1], &t->scratch[2], &t->scratch[3],
                             &t->here.u,     &t->next.u,     &t->spare.u,    &t->start.u1,
                             &t->start.u2,   &t->end.u1,     &t->end.u2,     &t->rebased.u1,
                             &t->rebased.u2, &t->stage[0],   &t->stage[1],   &t->stage[2]};
    memcpy(vector, all, sizeof all);
}

static haft_status allocate(haft_tracker *t, haft_error *error) {
    double **vector[VECTORS];
    list_vectors(t, vector);
    for (int i = 0; i < VECTORS; i++) {
        *vector[i] = haft_memory_alloc(t->n, sizeof(double), error);
        if (*vector[i] == NULL) {
            return HAFT_ERROR_MEMORY;
        }
    }
    size_t sites = t->model->sites;
    t->pair = haft_memory_alloc(2 * t->n, sizeof(double), error);
    t->hessian = haft_memory_alloc(t->model->nonzeros, sizeof(double), error);
    t->matrix = haft_memory_alloc(t->model->nonzeros, sizeof(double), error);
    t->range = haft_memory_alloc(sites, sizeof(double), error);
    t->reach = haft_memory_alloc(sites, sizeof(double), error);
    t->far = haft_memory_alloc(sites, sizeof(double), error);
    t->gap_before = haft_memory_alloc(sites, sizeof(double), error);
    t->gap_after = haft_memory_alloc(sites, sizeof(double), error);
    t->site_stiffness = haft_memory_alloc(sites, sizeof(double), error);
    bool scratch = true;
    for (int i = 0; i < HAFT_SITE_SCRATCH; i++) {
        t->site[i] = haft_memory_alloc(haft_law_lanes(sites), sizeof(double), error);
        scratch = scratch && t->site[i] != NULL;
    }
    bool all = scratch && t->pair && t->hessian && t->matrix && t->range && t->reach && t->far &&
               t->gap_before && t->gap_after && t->site_stiffness;
    return all ? HAFT_OK : HAFT_ERROR_MEMORY;
}

/* Share of the greatest pull below which a law counts as nil for the step's size. */
#define NIL_SHARE 1e-3

/* And below which it is lost in the rounding of the others. */
#define LOST_SHARE 1e-16

static haft_status put_at_rest(haft_tracker *t, haft_error *error) {
    for (size_t r = 0; r < t->model->sites; r++) {
        t->range[r] = haft_law_range(&t->laws[r]);
        t->reach[r] = haft_law_reach(&t->laws[r], t->programme.crack_threshold);
        t->far[r] = haft_law_reach(&t->laws[r], r < t->model->inert ? LOST_SHARE : NIL_SHARE);
        if (!(t->range[r] > 0) || !isfinite(t->range[r] + t->far[r] + t->reach[r])) {
            return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                                  "the law of site %zu has no finite range", r);
        }
    }
    for (size_t i = 0; i < t->n; i++) {
        t->mode[i] = 1 / (double)(i + 1);
    }
    haft_status status = haft_factor_create(&t->factor, HAFT_FACTOR_NARROW, t->n, t->model->column,
                                            t->model->row, t->model->stiffness, error);
    if (status != HAFT_OK) {
        return status;
    }
    return haft_corrector_create(&t->corrector, t, error);
}

haft_status haft_tracker_create(haft_tracker **out, const haft_model *model, const haft_law *laws,
                                const haft_programme *programme, const haft_path_options *options,
                                haft_error *error) {
    *out = NULL;
    haft_tracker *t = haft_memory_alloc(1, sizeof *t, error);
    if (t == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    t->model = model;
    t->laws = laws;
    t->programme = *programme;
    t->options = resolve(options);
    t->n = model->dofs;
    t->load_unit = model->energy_unit / model->gap;
    haft_status status = allocate(t, error);
    if (status == HAFT_OK) {
        status = haft_law_rows_create(&t->rows, model->sites, laws, error);
    }
    if (status == HAFT_OK) {
        status = put_at_rest(t, error);
    }
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
    haft_corrector_destroy(&t->corrector);
    haft_factor_destroy(&t->factor);
    double **vector[VECTORS];
    list_vectors(t, vector);
    for (int i = 0; i < VECTORS; i++) {
        haft_memory_free(*vector[i]);
    }
    haft_memory_free(t->pair);
    haft_memory_free(t->hessian);
    haft_memory_free(t->matrix);
    haft_memory_free(t->range);
    haft_memory_free(t->reach);
    haft_memory_free(t->far);
    haft_memory_free(t->gap_before);
    haft_memory_free(t->gap_after);
    haft_memory_free(t->site_stiffness);
    for (int i = 0; i < HAFT_SITE_SCRATCH; i++) {
        haft_memory_free(t->site[i]);
    }
    haft_law_rows_destroy(&t->rows);
    haft_memory_free(t);
    *tracker = NULL;
}
