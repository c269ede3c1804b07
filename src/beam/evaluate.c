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

static double element_energy(const haft_element *element, const double *u, double *gradient,
                             double *largest) {
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
        }
    }
    return 0.5 * (q0 * m0 + q1 * m1);
}

static void add_force(const haft_site *site, double factor, double *gradient, double *largest) {
    for (int k = 0; k < HAFT_SPAN; k++) {
        if (site->dof[k] >= 0) {
            double term = factor * site->shape[k];
            gradient[site->dof[k]] += term;
            *largest = larger(*largest, fabs(term));
        }
    }
}

static void add_stiffness(const haft_site *site, const int *slot, double factor, double *hessian) {
    for (int i = 0; i < HAFT_SPAN; i++) {
        for (int j = 0; j < HAFT_SPAN; j++) {
            int at = slot[i * HAFT_SPAN + j];
            if (at >= 0) {
                hessian[at] += factor * site->shape[i] * site->shape[j];
            }
        }
    }
}

haft_energy haft_model_evaluate(const haft_model *model, const haft_law *laws, const double *u,
                                double load, double *gradient, double *hessian,
                                double *force_scale) {
    haft_energy energy = {0};
    double largest = 0;
    if (gradient != NULL) {
        memset(gradient, 0, model->dofs * sizeof *gradient);
    }
    if (hessian != NULL) {
        memcpy(hessian, model->stiffness, model->nonzeros * sizeof *hessian);
    }
    for (size_t e = 0; e < model->elements; e++) {
        energy.strain += element_energy(&model->element[e], u, gradient, &largest);
    }
    energy.strain *= model->energy_unit;
    for (size_t r = 0; r < model->sites; r++) {
        const haft_site *site = &model->site[r];
        haft_law_value f =
            haft_law_evaluate(&laws[r], model->gap - haft_model_displacement(site, u));
        energy.contact += site->area * f.potential;
        double weight = site->area / model->energy_unit;
        if (gradient != NULL && f.force != 0) {
            add_force(site, weight * f.force, gradient, &largest);
        }
        if (hessian != NULL && f.slope != 0) {
            add_stiffness(site, model->site_slot + r * HAFT_SPAN * HAFT_SPAN, -weight * f.slope,
                          hessian);
        }
    }
    if (gradient != NULL) {
        add_force(&model->load, -load / model->energy_unit, gradient, &largest);
    }
    if (force_scale != NULL) {
        *force_scale = largest;
    }
    return energy;
}
