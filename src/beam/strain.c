/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Strain energy and its forces, element by element through the deformation modes, deflections
 * subtracted first. Neighbours that are alike, as all of a mesh are but a few, are done in blocks
 * of as many as a vector has lanes; forces are the same to the bit either way. */
#include "sites.h"

#include <math.h>
#include <string.h>

enum { BLOCK = HAFT_LAW_LANES, BLOCK_DOFS = 2 * BLOCK };

/* Sums over elements: energy [units of energy], and how much it moves as each unknown is rounded,
 * in units of 2^-53; the greatest force. Side by side, for blocks. */
typedef struct sums {
    double energy[BLOCK], moved[BLOCK_DOFS], largest[BLOCK_DOFS];
} sums;

/* An element's unknowns, or the forces on them, by nodes. */
typedef struct element_values {
    pair near, far;
} element_values;

static inline double mode_amplitude(const double mode[HAFT_SPAN], element_values v) {
    pair part = *(const pair *)mode * v.near + *(const pair *)(mode + 2) * v.far;
    return part[0] + part[1];
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

static inline void weigh_node(const int *dof, pair force, pair value, sums *s) {
    for (int k = 0; k < 2; k++) {
        s->moved[k] += fabs(force[k] * value[k]);
        s->largest[k] = dof[k] < 0 ? s->largest[k] : larger(s->largest[k], fabs(force[k]));
    }
}

static void add_element(const haft_element *element, const double *u, double *gradient, sums *s) {
    const double *d = element->stiffness, *mode = element->mode[0], *other = element->mode[1];
    element_values v = {node_values(element->dof, u), node_values(element->dof + 2, u)};
    double q0 = mode_amplitude(mode, v), q1 = mode_amplitude(other, v);
    double m0 = d[0] * q0 + d[1] * q1, m1 = d[1] * q0 + d[2] * q1;
    s->energy[0] += q0 * m0 + q1 * m1;
    if (gradient != NULL) {
        pair near = *(const pair *)mode * m0 + *(const pair *)other * m1;
        pair far = *(const pair *)(mode + 2) * m0 + *(const pair *)(other + 2) * m1;
        add_to_node(element->dof, near, gradient);
        add_to_node(element->dof + 2, far, gradient);
        weigh_node(element->dof, near, v.near, s);
        weigh_node(element->dof + 2, far, v.far, s);
    }
}

/* BLOCK beam elements alike whose unknowns begin at u: forces on their near and far nodes. */
static inline void block_forces(const haft_element *element, const double *restrict u,
                                double *restrict near, double *restrict far,
                                double *restrict energy) {
    const double *d = element->stiffness;
    double turn = element->mode[0][1], far_turn = element->mode[1][3];
    for (size_t k = 0; k < BLOCK; k++) {
        double fall = u[2 * k] - u[2 * k + 2];
        double q0 = fall + turn * u[2 * k + 1], q1 = fall + far_turn * u[2 * k + 3];
        double m0 = d[0] * q0 + d[1] * q1, m1 = d[1] * q0 + d[2] * q1;
        energy[k] += q0 * m0 + q1 * m1;
        near[2 * k] = m0 + m1;
        near[2 * k + 1] = turn * m0;
        far[2 * k] = -(m0 + m1);
        far[2 * k + 1] = far_turn * m1;
    }
}

/* The first n elements of a run, in whole blocks. */
HAFT_CLONES static void add_blocks(const haft_element *element, size_t n, const double *restrict u,
                                   double *restrict gradient, bool weigh, sums *restrict s) {
    double near[BLOCK_DOFS], far[BLOCK_DOFS];
    const double *v = u + element->dof[0];
    for (size_t e = 0; e < n; e += BLOCK, v += BLOCK_DOFS) {
        block_forces(element, v, near, far, s->energy);
        if (gradient != NULL) {
            double *g = gradient + (v - u);
            for (size_t i = 0; i < BLOCK_DOFS; i++) {
                g[i] += near[i];
            }
            for (size_t i = 0; i < BLOCK_DOFS; i++) {
                g[i + 2] += far[i];
            }
        }
        for (size_t i = 0; i < BLOCK_DOFS && weigh; i++) {
            s->moved[i] += fabs(near[i] * v[i]) + fabs(far[i] * v[i + 2]);
            s->largest[i] = larger(s->largest[i], larger(fabs(near[i]), fabs(far[i])));
        }
    }
}

/* Whether the modes are a beam's, end rotations off the chord. */
static bool is_beam(const haft_element *e) {
    const double mode[2][HAFT_SPAN] = {{1, e->mode[0][1], -1, 0}, {1, 0, -1, e->mode[1][3]}};
    return memcmp(mode, e->mode, sizeof mode) == 0;
}

/* Whether element e goes on a run that element `first` begins. */
static bool continues(const haft_element *first, const haft_element *e, int behind) {
    bool alike = is_beam(first) && memcmp(first->mode, e->mode, sizeof e->mode) == 0 &&
                 memcmp(first->stiffness, e->stiffness, sizeof e->stiffness) == 0;
    for (int k = 0; alike && k < HAFT_SPAN; k++) {
        alike = first->dof[0] >= 0 && e->dof[k] == first->dof[0] + 2 * behind + k;
    }
    return alike;
}

size_t haft_strain_find_runs(const haft_model *model, size_t *run) {
    size_t runs = 0;
    for (size_t e = 0; e < model->elements; e++) {
        const haft_element *now = &model->element[e];
        if (e == 0 || !continues(&model->element[run[runs - 1]], now, (int)(e - run[runs - 1]))) {
            run[runs++] = e;
        }
    }
    return runs;
}

double haft_strain(const haft_model *model, const double *u, double *gradient, double *largest,
                   double *rounding) {
    sums s = {{0}, {0}, {0}};
    bool weigh = gradient != NULL && (largest != NULL || rounding != NULL);
    const haft_layout *layout = model->layout;
    for (size_t r = 0; r < layout->element_runs && layout->element_run[r] < model->elements; r++) {
        size_t e = layout->element_run[r];
        size_t end = r + 1 < layout->element_runs ? layout->element_run[r + 1] : model->elements;
        end = end < model->elements ? end : model->elements;
        size_t blocks = (end - e) / BLOCK * BLOCK;
        if (blocks > 0) {
            add_blocks(&model->element[e], blocks, u, gradient, weigh, &s);
        }
        for (e += blocks; e < end; e++) {
            add_element(&model->element[e], u, gradient, &s);
        }
    }
    double energy = 0;
    for (size_t k = 0; k < BLOCK; k++) {
        energy += s.energy[k];
    }
    for (size_t i = 0; i < BLOCK_DOFS && weigh; i++) {
        if (rounding != NULL) {
            *rounding += s.moved[i];
        }
        if (largest != NULL) {
            *largest = larger(*largest, s.largest[i]);
        }
    }
    return 0.5 * energy;
}
