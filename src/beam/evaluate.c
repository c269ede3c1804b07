/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Energy, gradient and Hessian of a state. The strain energy is evaluated through the elements'
 * deformation modes, after subtracting deflections: in K u, rounding of the rigid motion of a
 * slender element would exceed its strain. */
#include "sites.h"

#include <math.h>
#include <string.h>

void haft_model_gaps(const haft_model *model, const double *u, double *d) {
    for (size_t r = 0; r < model->data.sites; r++) {
        d[r] = model->data.gap - haft_model_displacement(&model->data.site[r], u);
    }
}

static void add_load(const haft_site *site, double factor, double *gradient, double *largest) {
    for (int k = 0; k < site->terms; k++) {
        double term = factor * site->shape[k];
        gradient[site->dof[k]] += term;
        *largest = larger(*largest, fabs(term));
    }
}

/* The laws of one stretch of sites at their gaps d. */
typedef struct stretch_state {
    double d[HAFT_STRETCH_ROOM], force[HAFT_STRETCH_ROOM], slope[HAFT_STRETCH_ROOM];
    double potential[HAFT_STRETCH_ROOM];
} stretch_state;

/* Loops go on to a multiple of the SIMD width. */
static void clear_padding(double *values, size_t n) {
    memset(values + n, 0, HAFT_SIMD_WIDTH * sizeof *values);
}

/* @return how many laws are zero, from the first on */
static size_t evaluate_stretch(const haft_model *model, const haft_stretch *s,
                               const haft_law_rows *laws, const double *u, stretch_state *out) {
    haft_stretch_gaps(model, s, u, out->d);
    haft_law_values values = {out->force, out->slope, NULL, out->potential};
    size_t n = haft_stretch_sites(model, s);
    clear_padding(out->force, n);
    clear_padding(out->slope, n);
    clear_padding(out->potential, n);
    return haft_law_rows_evaluate(laws, s->first, n, out->d, &values);
}

/* Multiplies forces [Pa] by areas, in units of energy, and slopes likewise with their sign turned,
 * which makes them stiffnesses. @return the energy [J] of the sites zeros .. n - 1, n rounded up to
 * the SIMD width; adds the sum of |force| [N] to *pushed */
HAFT_CLONES static double weigh_stretch(const double *area, size_t zeros, size_t n, double unit,
                                        stretch_state *s, double *pushed) {
    double energy[HAFT_SIMD_WIDTH] = {0}, push[HAFT_SIMD_WIDTH] = {0}, by_unit = 1 / unit, sum = 0;
    for (size_t i = zeros; i < n; i += HAFT_SIMD_WIDTH) {
        const double *here = area + i, *potential = s->potential + i;
        double *force = s->force + i, *slope = s->slope + i;
#pragma omp simd
        for (size_t k = 0; k < HAFT_SIMD_WIDTH; k++) {
            double weight = here[k] * by_unit;
            energy[k] += here[k] * potential[k];
            push[k] += here[k] * fabs(force[k]);
            force[k] *= weight;
            slope[k] *= -weight;
        }
    }
    for (size_t k = 0; k < HAFT_SIMD_WIDTH; k++) {
        sum += energy[k];
        *pushed += push[k];
    }
    return sum;
}

/* The largest term of n sites in the gradient; n is rounded up to the SIMD width. */
HAFT_CLONES static double largest_term(const double *top, size_t zeros, size_t n,
                                       const double *force) {
    double part[HAFT_SIMD_WIDTH] = {0}, largest = 0;
    for (size_t i = zeros; i < n; i += HAFT_SIMD_WIDTH) {
        for (size_t k = 0; k < HAFT_SIMD_WIDTH; k++) {
            part[k] = larger(fabs(force[i + k]) * top[i + k], part[k]);
        }
    }
    for (size_t k = 0; k < HAFT_SIMD_WIDTH; k++) {
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
        size_t zeros = evaluate_stretch(model, s, laws, u, &state);
        size_t sites = haft_stretch_sites(model, s);
        if (gap != NULL) {
            memcpy(gap + s->first, state.d, sites * sizeof *gap);
        }
        energy += weigh_stretch(model->layout->area + s->first, zeros, sites,
                                model->data.energy_unit, &state, &pushed);
        if (site_stiffness != NULL) {
            memcpy(site_stiffness + s->first, state.slope, sites * sizeof *site_stiffness);
        }
        haft_stretch_assemble(model, s, zeros, state.force, state.slope, gradient, hessian);
        if (largest != NULL) {
            const double *top = model->layout->top + s->first;
            *largest = larger(*largest, largest_term(top, zeros, sites, state.force));
        }
    }
    *rounding += pushed * model->data.gap;
    return energy;
}

haft_energy haft_model_evaluate(const haft_model *model, const haft_law_rows *laws, const double *u,
                                double load, double *gradient, double *hessian, double *force_scale,
                                double *gap, double *site_stiffness) {
    haft_energy energy = {0};
    double largest = 0, strain_rounding = 0;
    double *term = force_scale != NULL ? &largest : NULL;
    if (gradient != NULL) {
        memset(gradient, 0, model->data.dofs * sizeof *gradient);
    }
    if (hessian != NULL) {
        memcpy(hessian, model->data.stiffness, model->data.nonzeros * sizeof *hessian);
    }
    energy.strain =
        model->data.energy_unit * haft_strain(model, u, gradient, term, &strain_rounding);
    double rounding = 0;
    energy.contact =
        add_contact(model, laws, u, gradient, hessian, term, &rounding, gap, site_stiffness);
    energy.rounding = 0x1p-53 * (strain_rounding * model->data.energy_unit + rounding);
    if (gradient != NULL) {
        add_load(&model->data.load, -load / model->data.energy_unit, gradient, &largest);
    }
    if (force_scale != NULL) {
        *force_scale = largest;
    }
    return energy;
}

/* Turns pressures into forces, in units of energy. */
HAFT_CLONES static void weigh_forces(const double *area, size_t zeros, size_t n, double unit,
                                     double *force) {
    double by_unit = 1 / unit;
    for (size_t i = zeros; i < n; i += HAFT_SIMD_WIDTH) {
        for (size_t k = 0; k < HAFT_SIMD_WIDTH; k++) {
            force[i + k] *= area[i + k] * by_unit;
        }
    }
}

void haft_model_gradient(const haft_model *model, const haft_law_rows *laws, const double *u,
                         double load, double *gradient) {
    double largest = 0, d[HAFT_STRETCH_ROOM], force[HAFT_STRETCH_ROOM];
    const haft_law_values values = {.force = force};
    memset(gradient, 0, model->data.dofs * sizeof *gradient);
    haft_strain(model, u, gradient, NULL, NULL);
    for (size_t n = 0; n < model->stretches; n++) {
        const haft_stretch *s = &model->layout->stretch[n];
        haft_stretch_gaps(model, s, u, d);
        size_t sites = haft_stretch_sites(model, s);
        size_t zeros = haft_law_rows_evaluate(laws, s->first, sites, d, &values);
        clear_padding(force, sites);
        weigh_forces(model->layout->area + s->first, zeros, sites, model->data.energy_unit, force);
        haft_stretch_assemble(model, s, zeros, force, force, gradient, NULL);
    }
    add_load(&model->data.load, -load / model->data.energy_unit, gradient, &largest);
}

void haft_model_multiply(const haft_model *model, const double *site_stiffness, const double *x,
                         double *y) {
    memset(y, 0, model->data.dofs * sizeof *y);
    haft_strain(model, x, y, NULL, NULL);
    double force[HAFT_STRETCH_ROOM];
    for (size_t n = 0; n < model->stretches; n++) {
        const haft_stretch *s = &model->layout->stretch[n];
        haft_stretch_displacements(model, s, x, force);
        for (size_t i = 0, sites = haft_stretch_sites(model, s); i < sites; i++) {
            force[i] *= site_stiffness[s->first + i];
        }
        haft_stretch_assemble(model, s, 0, force, force, y, NULL);
    }
}
