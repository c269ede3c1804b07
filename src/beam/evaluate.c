/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Energy, gradient and Hessian of a state. Strain goes through the elements' deformation modes,
 * deflections subtracted first: with K u the rigid part of a slender element would swamp it. */
#include "haft/beam.h"

#include <math.h>
#include <string.h>

/* Sites whose laws are evaluated together. */
enum { BLOCK = 64 };

void haft_model_gaps(const haft_model *model, const double *u, double *d) {
    for (size_t r = 0; r < model->sites; r++) {
        d[r] = model->gap - haft_model_displacement(&model->site[r], u);
    }
}

static double mode_amplitude(const double mode[HAFT_SPAN], const double v[HAFT_SPAN]) {
    return (mode[0] * v[0] + mode[2] * v[2]) + (mode[1] * v[1] + mode[3] * v[3]);
}

static inline double larger(double a, double b) {
    return a > b ? a : b;
}

/* Forces of an element on its four unknowns at their values v; @return its strain energy. */
static inline double element_forces(const haft_element *element, const double v[HAFT_SPAN],
                                    double force[HAFT_SPAN]) {
    double q0 = mode_amplitude(element->mode[0], v), q1 = mode_amplitude(element->mode[1], v);
    const double *d = element->stiffness;
    double m0 = d[0] * q0 + d[1] * q1, m1 = d[1] * q0 + d[2] * q1;
    for (int k = 0; k < HAFT_SPAN; k++) {
        force[k] = element->mode[0][k] * m0 + element->mode[1][k] * m1;
    }
    return 0.5 * (q0 * m0 + q1 * m1);
}

static inline void element_values(const haft_element *element, const double *u,
                                  double v[HAFT_SPAN]) {
    for (int k = 0; k < HAFT_SPAN; k++) {
        v[k] = element->dof[k] < 0 ? 0 : u[element->dof[k]];
    }
}

/* Strain energy of an element; its forces go into the gradient, and how much the energy moves when
 * each unknown is rounded into `rounding`, in units of 2^-53. */
static double element_energy(const haft_element *element, const double *u, double *gradient,
                             double *largest, double *rounding) {
    double v[HAFT_SPAN], force[HAFT_SPAN];
    element_values(element, u, v);
    double energy = element_forces(element, v, force);
    for (int k = 0; gradient != NULL && k < HAFT_SPAN; k++) {
        if (element->dof[k] >= 0) {
            gradient[element->dof[k]] += force[k];
            *largest = larger(*largest, fabs(force[k]));
            *rounding += fabs(force[k] * v[k]);
        }
    }
    return energy;
}

/* The element's forces, linear in x, into y. */
static inline void multiply_element(const haft_element *element, const double *x, double *y) {
    double v[HAFT_SPAN], force[HAFT_SPAN];
    element_values(element, x, v);
    element_forces(element, v, force);
    for (int k = 0; k < HAFT_SPAN; k++) {
        if (element->dof[k] >= 0) {
            y[element->dof[k]] += force[k];
        }
    }
}

static void add_load(const haft_site *site, double factor, double *gradient, double *largest) {
    for (int k = 0; k < site->terms; k++) {
        double term = factor * site->shape[k];
        gradient[site->dof[k]] += term;
        *largest = larger(*largest, fabs(term));
    }
}

/* What neighbouring sites on the same unknowns add up to, before it is scattered once. */
typedef struct group {
    const haft_site *first;
    const int *slot;
    bool any;
    double force[HAFT_SPAN], stiffness[HAFT_SPAN * (HAFT_SPAN + 1) / 2];
} group;

static inline void add_to_group(group *g, const haft_site *site, double force, double stiffness) {
    g->any = true;
    for (int i = 0, upper = 0; i < HAFT_SPAN; i++) {
        g->force[i] += force * site->shape[i];
        double row = stiffness * site->shape[i];
        for (int j = i; j < HAFT_SPAN; j++, upper++) {
            g->stiffness[upper] += row * site->shape[j];
        }
    }
}

static void scatter_group(const group *g, double *gradient, double *hessian) {
    int terms = g->first->terms;
    for (int i = 0; i < terms && gradient != NULL; i++) {
        gradient[g->first->dof[i]] += g->force[i];
    }
    for (int i = 0, upper = 0; i < terms && hessian != NULL; upper += HAFT_SPAN - i, i++) {
        const int *slot = g->slot + i * HAFT_SPAN;
        hessian[slot[i]] += g->stiffness[upper];
        for (int j = i + 1; j < terms; j++) {
            hessian[slot[j]] += g->stiffness[upper + j - i];
            hessian[g->slot[j * HAFT_SPAN + i]] += g->stiffness[upper + j - i];
        }
    }
}

static bool share_unknowns(const haft_site *a, const haft_site *b) {
    return memcmp(a->dof, b->dof, sizeof a->dof) == 0;
}

/* A site in a node: one unknown, one entry. */
static inline void add_node_site(const haft_site *site, const int *slot, double force,
                                 double stiffness, double *gradient, double *hessian) {
    double shape = site->shape[0];
    if (gradient != NULL) {
        gradient[site->dof[0]] += force * shape;
    }
    if (hessian != NULL) {
        hessian[slot[0]] += stiffness * shape * shape;
    }
}

/* What the sites of one stretch give at their gaps d. */
typedef struct stretch {
    double d[BLOCK], force[BLOCK], slope[BLOCK], potential[BLOCK];
} stretch;

/* Forces and stiffnesses of n sites from `first` on into the sums. */
static void add_stretch(const haft_model *model, size_t first, size_t n, const stretch *s,
                        double *gradient, double *hessian, double *largest) {
    group g = {.first = NULL};
    for (size_t i = 0; i < n; i++) {
        const haft_site *site = &model->site[first + i];
        if (s->force[i] == 0 && s->slope[i] == 0) {
            continue;
        }
        const int *slot = model->site_slot + (first + i) * HAFT_SPAN * HAFT_SPAN;
        double weight = site->area / model->energy_unit;
        double force = weight * s->force[i], stiffness = -weight * s->slope[i];
        for (int k = 0; k < site->terms; k++) {
            *largest = larger(*largest, fabs(force * site->shape[k]));
        }
        if (site->terms == 1) {
            add_node_site(site, slot, force, stiffness, gradient, hessian);
            continue;
        }
        if (g.first == NULL || !share_unknowns(g.first, site)) {
            if (g.any) {
                scatter_group(&g, gradient, hessian);
            }
            g = (group){.first = site, .slot = slot};
        }
        add_to_group(&g, site, force, stiffness);
    }
    if (g.any) {
        scatter_group(&g, gradient, hessian);
    }
}

/* Contact of all sites: their energy [J], and their forces and stiffnesses into the sums. */
static double add_contact(const haft_model *model, const haft_law *laws, const double *u,
                          double *gradient, double *hessian, double *largest, double *rounding) {
    double energy = 0;
    stretch s;
    for (size_t first = model->inert; first < model->sites; first += BLOCK) {
        size_t n = model->sites - first < BLOCK ? model->sites - first : BLOCK;
        for (size_t i = 0; i < n; i++) {
            s.d[i] = model->gap - haft_model_displacement(&model->site[first + i], u);
        }
        haft_law_evaluate_many(laws + first, n, s.d, s.force, s.slope, s.potential);
        for (size_t i = 0; i < n; i++) {
            double area = model->site[first + i].area;
            energy += area * s.potential[i];
            *rounding += area * fabs(s.force[i]) * model->gap;
        }
        if (gradient != NULL || hessian != NULL) {
            add_stretch(model, first, n, &s, gradient, hessian, largest);
        }
    }
    return energy;
}

haft_energy haft_model_evaluate(const haft_model *model, const haft_law *laws, const double *u,
                                double load, double *gradient, double *hessian,
                                double *force_scale) {
    haft_energy energy = {0};
    double largest = 0, strain_rounding = 0;
    if (gradient != NULL) {
        memset(gradient, 0, model->dofs * sizeof *gradient);
    }
    if (hessian != NULL) {
        memcpy(hessian, model->stiffness, model->nonzeros * sizeof *hessian);
    }
    for (size_t e = 0; e < model->elements; e++) {
        energy.strain +=
            element_energy(&model->element[e], u, gradient, &largest, &strain_rounding);
    }
    energy.strain *= model->energy_unit;
    double rounding = 0;
    energy.contact = add_contact(model, laws, u, gradient, hessian, &largest, &rounding);
    energy.rounding = 0x1p-53 * (strain_rounding * model->energy_unit + rounding);
    if (gradient != NULL) {
        add_load(&model->load, -load / model->energy_unit, gradient, &largest);
    }
    if (force_scale != NULL) {
        *force_scale = largest;
    }
    return energy;
}

void haft_model_site_stiffness(const haft_model *model, const haft_law *laws, const double *u,
                               double *site_stiffness) {
    for (size_t r = model->inert; r < model->sites; r++) {
        const haft_site *site = &model->site[r];
        double d = model->gap - haft_model_displacement(site, u);
        site_stiffness[r] = -site->area / model->energy_unit * haft_law_evaluate(&laws[r], d).slope;
    }
}

void haft_model_multiply(const haft_model *model, const double *site_stiffness, const double *x,
                         double *y) {
    double largest = 0;
    memset(y, 0, model->dofs * sizeof *y);
    for (size_t e = 0; e < model->elements; e++) {
        multiply_element(&model->element[e], x, y);
    }
    for (size_t r = model->inert; r < model->sites; r++) {
        if (site_stiffness[r] != 0) {
            const haft_site *site = &model->site[r];
            add_load(site, site_stiffness[r] * haft_model_displacement(site, x), y, &largest);
        }
    }
}
