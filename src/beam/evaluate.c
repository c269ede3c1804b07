/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Energy, gradient and Hessian of a state. Strain goes through the elements' deformation modes,
 * deflections subtracted first: with K u the rigid part of a slender element would swamp it. */
#include "sites.h"

#include <math.h>
#include <string.h>

void haft_model_gaps(const haft_model *model, const double *u, double *d) {
    for (size_t r = 0; r < model->sites; r++) {
        d[r] = model->gap - haft_model_displacement(&model->site[r], u);
    }
}

static inline double larger(double a, double b) {
    return a > b ? a : b;
}

/* An element's unknowns by nodes. */
typedef struct element_values {
    pair near, far;
} element_values;

static inline double mode_amplitude(const double mode[HAFT_SPAN], element_values v) {
    pair part = *(const pair *)mode * v.near + *(const pair *)(mode + 2) * v.far;
    return part[0] + part[1];
}

/* Forces of an element on its four unknowns at their values v; adds its strain energy. */
static inline element_values element_forces(const haft_element *element, element_values v,
                                            double *energy) {
    const double *d = element->stiffness, *mode = element->mode[0], *other = element->mode[1];
    double q0 = mode_amplitude(mode, v), q1 = mode_amplitude(other, v);
    double m0 = d[0] * q0 + d[1] * q1, m1 = d[1] * q0 + d[2] * q1;
    *energy += 0.5 * (q0 * m0 + q1 * m1);
    return (element_values){*(const pair *)mode * m0 + *(const pair *)other * m1,
                            *(const pair *)(mode + 2) * m0 + *(const pair *)(other + 2) * m1};
}

/* Whether a node's two unknowns are there, the rotation behind the deflection. */
static inline bool is_node(const int *dof) {
    return dof[0] >= 0 && dof[1] == dof[0] + 1;
}

static inline pair node_values(const int *dof, const double *u) {
    return is_node(dof) ? *(const pair *)(u + dof[0])
                        : (pair){dof[0] < 0 ? 0 : u[dof[0]], dof[1] < 0 ? 0 : u[dof[1]]};
}

static inline void add_to_node(const int *dof, pair force, double *y) {
    if (is_node(dof)) {
        *(pair *)(y + dof[0]) += force;
        return;
    }
    for (int k = 0; k < 2; k++) {
        if (dof[k] >= 0) {
            y[dof[k]] += force[k];
        }
    }
}

static inline element_values values_at(const haft_element *element, const double *u) {
    return (element_values){node_values(element->dof, u), node_values(element->dof + 2, u)};
}

static inline pair size(pair x) {
    return (pair){fabs(x[0]), fabs(x[1])};
}

static inline double larger_of_node(double largest, const int *dof, pair force) {
    pair sizes = size(force);
    largest = dof[0] < 0 ? largest : larger(largest, sizes[0]);
    return dof[1] < 0 ? largest : larger(largest, sizes[1]);
}

/* Strain energy of all elements in units of energy; their forces go into the gradient, the greatest
 * of them into `largest` if that is asked for, and how much the energy moves when each unknown is
 * rounded into `rounding`, in units of 2^-53. */
static double add_strain(const haft_model *model, const double *u, double *gradient,
                         double *largest, double *rounding) {
    double energy = 0;
    pair moved = {0, 0};
    for (size_t e = 0; e < model->elements; e++) {
        const haft_element *element = &model->element[e];
        element_values v = values_at(element, u), f = element_forces(element, v, &energy);
        if (gradient != NULL) {
            add_to_node(element->dof, f.near, gradient);
            add_to_node(element->dof + 2, f.far, gradient);
            moved += size(f.near * v.near) + size(f.far * v.far);
        }
        if (largest != NULL) {
            *largest = larger_of_node(*largest, element->dof, f.near);
            *largest = larger_of_node(*largest, element->dof + 2, f.far);
        }
    }
    *rounding = moved[0] + moved[1];
    return energy;
}

/* The element's forces, linear in x, into y. */
static inline void multiply_element(const haft_element *element, const double *x, double *y) {
    double energy = 0;
    element_values f = element_forces(element, values_at(element, x), &energy);
    add_to_node(element->dof, f.near, y);
    add_to_node(element->dof + 2, f.far, y);
}

static void add_load(const haft_site *site, double factor, double *gradient, double *largest) {
    for (int k = 0; k < site->terms; k++) {
        double term = factor * site->shape[k];
        gradient[site->dof[k]] += term;
        *largest = larger(*largest, fabs(term));
    }
}

/* What the sites of one stretch give at their gaps d. */
typedef struct stretch_state {
    double d[HAFT_STRETCH_ROOM], force[HAFT_STRETCH_ROOM], slope[HAFT_STRETCH_ROOM];
    double curvature[HAFT_STRETCH_ROOM], potential[HAFT_STRETCH_ROOM];
} stretch_state;

static void evaluate_stretch(const haft_model *model, const haft_stretch *s,
                             const haft_law_rows *laws, const double *u, stretch_state *out) {
    haft_stretch_displacements(model, s, u, out->d);
    for (size_t i = 0; i < s->sites + HAFT_LAW_LANES; i++) {
        out->d[i] = model->gap - out->d[i];
    }
    haft_law_values values = {out->force, out->slope, out->curvature, out->potential};
    haft_law_rows_evaluate(laws, s->first, s->sites, out->d, &values);
}

/* Energy [J] of a stretch, and what rounding makes of it, each the sum of eight sums side by side;
 * forces and stiffnesses in units of energy take their places. */
HAFT_CLONES static double weigh_stretch(const double *area, size_t n, double unit, stretch_state *s,
                                        double *pushed) {
    double energy[HAFT_LAW_LANES] = {0}, push[HAFT_LAW_LANES] = {0}, by_unit = 1 / unit;
    for (size_t i = 0; i < n; i += HAFT_LAW_LANES) {
        for (size_t k = 0; k < HAFT_LAW_LANES; k++) {
            double here = area[i + k];
            energy[k] += here * s->potential[i + k];
            push[k] += here * fabs(s->force[i + k]);
            double weight = here * by_unit;
            s->force[i + k] *= weight;
            s->slope[i + k] *= -weight;
        }
    }
    double sum = 0;
    for (size_t k = 0; k < HAFT_LAW_LANES; k++) {
        sum += energy[k];
        *pushed += push[k];
    }
    return sum;
}

/* The largest term that n sites, in whole lanes, give the gradient. */
HAFT_CLONES static double largest_term(const double *top, size_t n, const double *force) {
    double part[HAFT_LAW_LANES] = {0}, largest = 0;
    for (size_t i = 0; i < n; i += HAFT_LAW_LANES) {
        for (size_t k = 0; k < HAFT_LAW_LANES; k++) {
            part[k] = larger(fabs(force[i + k]) * top[i + k], part[k]);
        }
    }
    for (size_t k = 0; k < HAFT_LAW_LANES; k++) {
        largest = larger(largest, part[k]);
    }
    return largest;
}

/* Contact of all sites: their energy [J], their forces and stiffnesses into the sums, and, where
 * asked for, their gaps and their stiffnesses one by one. */
static double add_contact(const haft_model *model, const haft_law_rows *laws, const double *u,
                          double *gradient, double *hessian, double *largest, double *rounding,
                          double *gap, double *site_stiffness) {
    double energy = 0, pushed = 0;
    stretch_state state;
    for (size_t n = 0; n < model->stretches; n++) {
        const haft_stretch *s = &model->layout->stretch[n];
        evaluate_stretch(model, s, laws, u, &state);
        if (gap != NULL) {
            memcpy(gap + s->first, state.d, s->sites * sizeof *gap);
        }
        energy += weigh_stretch(model->layout->area + s->first, s->sites, model->energy_unit,
                                &state, &pushed);
        if (site_stiffness != NULL) {
            memcpy(site_stiffness + s->first, state.slope, s->sites * sizeof *site_stiffness);
        }
        haft_stretch_assemble(model, s, state.force, state.slope, gradient, hessian);
        if (largest != NULL) {
            const double *top = model->layout->top + s->first;
            *largest = larger(*largest, largest_term(top, s->sites, state.force));
        }
    }
    *rounding += pushed * model->gap;
    return energy;
}

haft_energy haft_model_evaluate(const haft_model *model, const haft_law_rows *laws, const double *u,
                                double load, double *gradient, double *hessian, double *force_scale,
                                double *gap, double *site_stiffness) {
    haft_energy energy = {0};
    double largest = 0, strain_rounding = 0;
    double *term = force_scale != NULL ? &largest : NULL;
    if (gradient != NULL) {
        memset(gradient, 0, model->dofs * sizeof *gradient);
    }
    if (hessian != NULL) {
        memcpy(hessian, model->stiffness, model->nonzeros * sizeof *hessian);
    }
    energy.strain = model->energy_unit * add_strain(model, u, gradient, term, &strain_rounding);
    double rounding = 0;
    energy.contact =
        add_contact(model, laws, u, gradient, hessian, term, &rounding, gap, site_stiffness);
    energy.rounding = 0x1p-53 * (strain_rounding * model->energy_unit + rounding);
    if (gradient != NULL) {
        add_load(&model->load, -load / model->energy_unit, gradient, &largest);
    }
    if (force_scale != NULL) {
        *force_scale = largest;
    }
    return energy;
}

void haft_model_multiply(const haft_model *model, const double *site_stiffness, const double *x,
                         double *y) {
    memset(y, 0, model->dofs * sizeof *y);
    for (size_t e = 0; e < model->elements; e++) {
        multiply_element(&model->element[e], x, y);
    }
    double force[HAFT_STRETCH_ROOM];
    for (size_t n = 0; n < model->stretches; n++) {
        const haft_stretch *s = &model->layout->stretch[n];
        haft_stretch_displacements(model, s, x, force);
        for (size_t i = 0; i < s->sites; i++) {
            force[i] *= site_stiffness[s->first + i];
        }
        haft_stretch_assemble(model, s, force, force, y, NULL);
    }
}
