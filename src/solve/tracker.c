/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tracker's small operations: evaluation, rows of sites, lengths over which forces change. */
#include "tracker.h"

#include <math.h>

/* Sum of v, in eight lanes; not finite if any element is not. */
HAFT_CLONES static double total(const double *v, size_t n) {
    double part[HAFT_SIMD_WIDTH] = {0}, sum = 0;
    size_t whole = n / HAFT_SIMD_WIDTH * HAFT_SIMD_WIDTH;
    for (size_t i = 0; i < whole; i += HAFT_SIMD_WIDTH) {
        for (size_t k = 0; k < HAFT_SIMD_WIDTH; k++) {
            part[k] += v[i + k];
        }
    }
    for (size_t i = whole; i < n; i++) {
        part[i - whole] += v[i];
    }
    for (size_t k = 0; k < HAFT_SIMD_WIDTH; k++) {
        sum += part[k];
    }
    return sum;
}

static haft_energy add(haft_energy a, haft_energy b) {
    return (haft_energy){a.strain + b.strain, a.contact + b.contact, a.rounding + b.rounding};
}

/* Evaluates energy, gradient and Hessian, and puts the gaps into `gap`. */
static bool evaluate(haft_tracker *t, const double *u, double load, haft_energy *energy,
                     double *force_scale, double *gap) {
    double *stiffness = t->needs_refinement ? t->site_stiffness : NULL;
    haft_energy e = haft_model_evaluate(t->model, t->problem.rows, u, load * t->problem.load_unit,
                                        t->gradient, t->hessian, force_scale, gap, stiffness);
    if (energy != NULL) {
        *energy = add(e, t->frozen.energy);
    }
    /* the rounding bound covers all forces but the load */
    bool finite = isfinite(e.strain + e.contact + e.rounding + load);
    t->not_finite += !finite;
    return finite;
}

bool haft_tracker_evaluate(haft_tracker *t, const double *u, double load, haft_energy *energy,
                           double *force_scale) {
    return evaluate(t, u, load, energy, force_scale, t->gap);
}

bool haft_tracker_visit(haft_tracker *t, haft_state *state) {
    return evaluate(t, state->u, state->load, &state->energy, NULL, state->gap);
}

bool haft_tracker_gradient(haft_tracker *t, const double *u, double load, double *gradient) {
    haft_model_gradient(t->model, t->problem.rows, u, load * t->problem.load_unit, gradient);
    double sum = total(gradient, t->n);
    t->not_finite += !isfinite(sum);
    return isfinite(sum);
}

haft_energy haft_tracker_energy(const haft_tracker *t, const double *u) {
    haft_energy e =
        haft_model_evaluate(t->model, t->problem.rows, u, 0, NULL, NULL, NULL, NULL, NULL);
    return add(e, t->frozen.energy);
}

void haft_tracker_turn(haft_tracker *t) {
    double *gradient = t->gradient, *hessian = t->hessian;
    t->gradient = t->other.gradient;
    t->hessian = t->other.hessian;
    t->other.gradient = gradient;
    t->other.hessian = hessian;
}

void haft_tracker_solve(haft_tracker *t, double *b) {
    t->cost.solves++;
    haft_factor_solve(t->factor, b, 1);
}

bool haft_tracker_factor_solve(haft_tracker *t, const double *matrix, double *b) {
    haft_tracker_count_factorization(t);
    bool made = haft_factor_update_solve(t->factor, matrix, b);
    t->cost.solves += made;
    return made;
}

double haft_tracker_row(const haft_tracker *t, const haft_site *site, const double *v) {
    return haft_model_displacement(site, v) / haft_mesh_of(t)->gap;
}

void haft_tracker_add_row(const haft_tracker *t, const haft_site *site, double factor, double *v) {
    for (int k = 0; k < site->terms; k++) {
        v[site->dof[k]] += factor * site->shape[k] / haft_mesh_of(t)->gap;
    }
}

void haft_tracker_multiply_mass(const haft_tracker *t, double factor, const double *x,
                                const double *less, double *restrict out) {
    haft_diagonals_multiply(t->mass, t->n, factor, x, less, out);
}

double haft_tracker_weigh(const haft_tracker *t, const double *x, double *restrict mx) {
    double sum = 0;
    haft_tracker_multiply_mass(t, 1, x, NULL, mx);
    for (size_t i = 0; i < t->n; i++) {
        sum += x[i] * mx[i];
    }
    return sum;
}

double haft_tracker_potential(const haft_tracker *t, const haft_state *state) {
    return state->energy.strain + state->energy.contact -
           state->load * haft_mesh_of(t)->energy_unit *
               haft_tracker_row(t, &haft_mesh_of(t)->load, state->u);
}

double haft_tracker_rounding(const haft_state *a, const haft_state *b) {
    double size = fabs(a->energy.strain) + fabs(a->energy.contact) + fabs(b->energy.strain) +
                  fabs(b->energy.contact);
    return 0x1p-47 * size + 4 * (a->energy.rounding + b->energy.rounding);
}

double haft_parameter_value(const haft_tracker *t, haft_parameter parameter,
                            const haft_state *state) {
    return parameter.site == NULL ? state->load : haft_tracker_row(t, parameter.site, state->u);
}

double haft_tracker_crack(const haft_tracker *t, haft_state *state) {
    if (isnan(state->crack)) {
        state->crack = haft_model_crack_length(t->mesh[t->at].model, t->problem.reach, state->u);
    }
    return state->crack;
}

/* Displacements by `by`, or to the gaps `to`, on the mesh in use. */
static haft_displacements of(const haft_tracker *t, const double *gap, const double *by,
                             const double *to) {
    return (haft_displacements){
        &t->problem.lengths, haft_mesh_of(t)->inert, haft_mesh_of(t)->sites, gap, by, to};
}

double haft_tracker_largest_step(const haft_tracker *t, const double *gap, const double *motion,
                                 size_t *site) {
    haft_displacements d = of(t, gap, motion, NULL);
    double largest = haft_displacements_largest_step(&d);
    if (largest > 0) {
        *site = haft_displacements_find_step(&d, largest);
    }
    return largest;
}

double haft_tracker_scaled_displacement(const haft_tracker *t, const double *gap, const double *v,
                                        size_t *site) {
    haft_model_displacements(t->model, v, t->work.site[0]);
    haft_displacements d = of(t, gap, t->work.site[0], NULL);
    double largest = haft_displacements_largest(&d);
    if (site != NULL && largest > 0) {
        *site = haft_displacements_find(&d, largest);
    }
    return largest;
}

double haft_tracker_scaled_distance(const haft_tracker *t, const double *gap, const double *to) {
    haft_displacements d = of(t, gap, NULL, to);
    return haft_displacements_largest(&d);
}

size_t haft_tracker_moved(const haft_tracker *t, const double *gap, const double *to,
                          double least) {
    haft_displacements d = of(t, gap, NULL, to);
    return haft_displacements_count(&d, least);
}

size_t haft_tracker_stirred(const haft_tracker *t, double share) {
    haft_displacements d = of(t, t->here.gap, t->motion, NULL);
    return haft_displacements_count(&d, share * haft_displacements_largest(&d));
}
