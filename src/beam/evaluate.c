/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Energy, gradient and Hessian of a state. Strain goes through the elements' deformation modes,
 * deflections subtracted first: with K u the rigid part of a slender element would swamp it. */
#include "haft/beam.h"

#include <math.h>
#include <string.h>

double haft_model_displacement(const haft_site *site, const double *u) {
    double w = 0;
    for (int k = 0; k < HAFT_SPAN; k++) {
        if (site->dof[k] >= 0) {
            w += site->shape[k] * u[site->dof[k]];
        }
    }
    return w;
}

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

/* Strain energy of an element; its forces go into the gradient, and how much the energy moves when
 * each unknown is rounded into `rounding`, in units of 2^-53. */
static double element_energy(const haft_element *element, const double *u, double *gradient,
                             double *largest, double *rounding) {
    double v[HAFT_SPAN];
    for (int k = 0; k < HAFT_SPAN; k++) {
        v[k] = element->dof[k] < 0 ? 0 : u[element->dof[k]];
    }
    double q0 = mode_amplitude(element->mode[0], v), q1 = mode_amplitude(element->mode[1], v);
    const double *d = element->stiffness;
    double m0 = d[0] * q0 + d[1] * q1, m1 = d[1] * q0 + d[2] * q1;
    for (int k = 0; gradient != NULL && k < HAFT_SPAN; k++) {
        if (element->dof[k] >= 0) {
            double term = element->mode[0][k] * m0 + element->mode[1][k] * m1;
            gradient[element->dof[k]] += term;
            *largest = larger(*largest, fabs(term));
            *rounding += fabs(term * v[k]);
        }
    }
    return 0.5 * (q0 * m0 + q1 * m1);
}

static void add_load(const haft_site *site, double factor, double *gradient, double *largest) {
    for (int k = 0; k < HAFT_SPAN; k++) {
        if (site->dof[k] >= 0) {
            double term = factor * site->shape[k];
            gradient[site->dof[k]] += term;
            *largest = larger(*largest, fabs(term));
        }
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

static void scatter_group(group *g, double *gradient, double *hessian) {
    for (int i = 0; i < HAFT_SPAN && gradient != NULL; i++) {
        if (g->first->dof[i] >= 0) {
            gradient[g->first->dof[i]] += g->force[i];
        }
    }
    for (int i = 0, upper = 0; i < HAFT_SPAN && hessian != NULL; i++) {
        for (int j = i; j < HAFT_SPAN; j++, upper++) {
            int ij = g->slot[i * HAFT_SPAN + j];
            if (ij >= 0) {
                hessian[ij] += g->stiffness[upper];
                hessian[i == j ? ij : g->slot[j * HAFT_SPAN + i]] +=
                    i == j ? 0 : g->stiffness[upper];
            }
        }
    }
}

static bool share_unknowns(const haft_site *a, const haft_site *b) {
    return memcmp(a->dof, b->dof, sizeof a->dof) == 0;
}

/* Contact of all sites: their energy [J], and their forces and stiffnesses into the sums. */
static double add_contact(const haft_model *model, const haft_law *laws, const double *u,
                          double *gradient, double *hessian, double *largest, double *rounding) {
    double energy = 0;
    group g = {.first = NULL};
    for (size_t r = 0; r < model->sites; r++) {
        const haft_site *site = &model->site[r];
        if (g.first == NULL || !share_unknowns(g.first, site)) {
            if (g.any) {
                scatter_group(&g, gradient, hessian);
            }
            g = (group){.first = site, .slot = model->site_slot + r * HAFT_SPAN * HAFT_SPAN};
        }
        haft_law_value f =
            haft_law_evaluate(&laws[r], model->gap - haft_model_displacement(site, u));
        energy += site->area * f.potential;
        *rounding += site->area * fabs(f.force) * model->gap;
        double weight = site->area / model->energy_unit;
        if (f.force != 0 || f.slope != 0) {
            add_to_group(&g, site, weight * f.force, -weight * f.slope);
            for (int k = 0; k < HAFT_SPAN; k++) {
                *largest = larger(*largest, fabs(weight * f.force * site->shape[k]));
            }
        }
    }
    if (g.any) {
        scatter_group(&g, gradient, hessian);
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
    for (size_t r = 0; r < model->sites; r++) {
        const haft_site *site = &model->site[r];
        double d = model->gap - haft_model_displacement(site, u);
        site_stiffness[r] = -site->area / model->energy_unit * haft_law_evaluate(&laws[r], d).slope;
    }
}

void haft_model_multiply(const haft_model *model, const double *site_stiffness, const double *x,
                         double *y) {
    double largest = 0, rounding = 0;
    memset(y, 0, model->dofs * sizeof *y);
    for (size_t e = 0; e < model->elements; e++) {
        element_energy(&model->element[e], x, y, &largest, &rounding); /* quadratic: its gradient */
    }
    for (size_t r = 0; r < model->sites; r++) {
        if (site_stiffness[r] != 0) {
            const haft_site *site = &model->site[r];
            add_load(site, site_stiffness[r] * haft_model_displacement(site, x), y, &largest);
        }
    }
}
