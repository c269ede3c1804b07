/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Strain energy and its forces, element by element through the deformation modes; deflections are
 * subtracted first, which loses no digits. Runs of equal elements, as nearly all of a mesh are, are
 * summed from node to node. */
#include "sites.h"

#include <math.h>
#include <string.h>

/* Sums over elements: energy [units of energy] by its two modes; the change of the energy as each
 * unknown is rounded, in units of 2^-53; and the largest force. The last two are kept apart for
 * deflections and rotations, so that no sum waits for the other. */
typedef struct sums {
    double energy[2], moved[2], largest[2];
} sums;

/* An element's two nodes' unknowns, or the forces on them: deflection, rotation. */
typedef struct element_values {
    double near[2], far[2];
} element_values;

HAFT_INLINE double mode_amplitude(const double mode[HAFT_SPAN], const element_values *v) {
    return (mode[0] * v->near[0] + mode[2] * v->far[0]) +
           (mode[1] * v->near[1] + mode[3] * v->far[1]);
}

/* Whether both of a node's unknowns exist, the rotation following the deflection. */
HAFT_INLINE bool is_node(const int *dof) {
    return dof[0] >= 0 && dof[1] == dof[0] + 1;
}

HAFT_INLINE void add_to_node(const int *dof, const double force[2], const double value[2],
                             double *y, sums *s) {
    for (int k = 0; k < 2; k++) {
        s->moved[k] += fabs(force[k] * value[k]);
        if (dof[k] >= 0) {
            y[dof[k]] += force[k];
            s->largest[k] = larger(s->largest[k], fabs(force[k]));
        }
    }
}

static void add_element(const haft_element *element, const double *u, double *gradient, sums *s) {
    const double *d = element->stiffness, *mode = element->mode[0], *other = element->mode[1];
    element_values v, f;
    for (int k = 0; k < 2; k++) {
        v.near[k] = element->dof[k] < 0 ? 0 : u[element->dof[k]];
        v.far[k] = element->dof[2 + k] < 0 ? 0 : u[element->dof[2 + k]];
    }
    double q0 = mode_amplitude(mode, &v), q1 = mode_amplitude(other, &v);
    double m0 = d[0] * q0 + d[1] * q1, m1 = d[1] * q0 + d[2] * q1;
    s->energy[0] += q0 * m0 + q1 * m1;
    if (gradient != NULL) {
        for (int k = 0; k < 2; k++) {
            f.near[k] = mode[k] * m0 + other[k] * m1;
            f.far[k] = mode[2 + k] * m0 + other[2 + k] * m1;
        }
        add_to_node(element->dof, f.near, v.near, gradient, s);
        add_to_node(element->dof + 2, f.far, v.far, gradient, s);
    }
}

/* What is asked for besides energy and forces. */
typedef enum asked { NO_MORE, MOVED, LARGEST_TOO } asked;

/* Equal elements in a row, of a beam's modes (1, turn, -1, 0) and (1, 0, -1, far_turn); the first
 * may begin at a clamp. A node's forces from both its elements are added in one piece. */
HAFT_INLINE void add_run(const haft_element *element, size_t elements, const double *u,
                         double *gradient, asked more, sums *s) {
    const double d0 = element->stiffness[0], d1 = element->stiffness[1], d2 = element->stiffness[2];
    const double turn = element->mode[0][1], far_turn = element->mode[1][3];
    const bool clamped = element->dof[0] < 0;
    const double *next = u + element->dof[2];
    double *g = gradient != NULL ? gradient + element->dof[2] : NULL;
    double w = clamped ? 0 : u[element->dof[0]], phi = clamped ? 0 : u[element->dof[0] + 1];
    double force = 0, moment = 0; /* of the element before, on this one's first node */
    for (size_t e = 0; e < elements; e++) {
        const double w_far = next[2 * e], phi_far = next[2 * e + 1], fall = w - w_far;
        const double q0 = fall + turn * phi, q1 = fall + far_turn * phi_far;
        const double m0 = d0 * q0 + d1 * q1, m1 = d2 * q1 + d1 * q0;
        s->energy[0] += q0 * m0;
        s->energy[1] += q1 * m1;
        if (gradient != NULL) {
            const double shear = m0 + m1, near = turn * m0, far = far_turn * m1;
            const bool fixed = clamped && e == 0;
            if (!fixed) {
                g[2 * e - 2] += force + shear;
                g[2 * e - 1] += moment + near;
            }
            if (more >= MOVED) {
                s->moved[0] += fabs(shear * w) + fabs(shear * w_far);
                s->moved[1] += fabs(near * phi) + fabs(far * phi_far);
            }
            if (more >= LARGEST_TOO) {
                s->largest[0] = larger(s->largest[0], fabs(shear));
                s->largest[1] = larger(s->largest[1], fabs(far));
                s->largest[1] = fixed ? s->largest[1] : larger(s->largest[1], fabs(near));
            }
            force = -shear;
            moment = far;
        }
        w = w_far;
        phi = phi_far;
    }
    if (gradient != NULL) {
        g[2 * elements - 2] += force;
        g[2 * elements - 1] += moment;
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
    bool clamped = first->dof[0] < 0 && first->dof[1] < 0;
    alike = alike && (clamped || is_node(first->dof)) && is_node(first->dof + 2);
    for (int k = 0; alike && k < HAFT_SPAN; k++) {
        alike = e->dof[k] == first->dof[2] + 2 * (behind - 1) + k;
    }
    return alike;
}

size_t haft_strain_find_runs(const haft_model *model, size_t *run) {
    size_t runs = 0;
    for (size_t e = 0; e < model->data.elements; e++) {
        const haft_element *now = &model->data.element[e];
        if (e == 0 ||
            !continues(&model->data.element[run[runs - 1]], now, (int)(e - run[runs - 1]))) {
            run[runs++] = e;
        }
    }
    return runs;
}

HAFT_CLONES static void add_runs(const haft_model *model, const double *u, double *gradient,
                                 asked more, sums *out) {
    sums s = {{0, 0}, {0, 0}, {0, 0}};
    const haft_layout *layout = model->layout;
    for (size_t r = 0; r < layout->element_runs && layout->element_run[r] < model->data.elements;
         r++) {
        size_t e = layout->element_run[r];
        size_t end =
            r + 1 < layout->element_runs ? layout->element_run[r + 1] : model->data.elements;
        end = end < model->data.elements ? end : model->data.elements;
        if (end - e < 2) {
            add_element(&model->data.element[e], u, gradient, &s);
        } else if (more == LARGEST_TOO) { /* a constant in each */
            add_run(&model->data.element[e], end - e, u, gradient, LARGEST_TOO, &s);
        } else if (more == MOVED) {
            add_run(&model->data.element[e], end - e, u, gradient, MOVED, &s);
        } else {
            add_run(&model->data.element[e], end - e, u, gradient, NO_MORE, &s);
        }
    }
    *out = s;
}

double haft_strain(const haft_model *model, const double *u, double *gradient, double *largest,
                   double *rounding) {
    asked more = largest != NULL ? LARGEST_TOO : rounding != NULL ? MOVED : NO_MORE;
    sums s;
    add_runs(model, u, gradient, more, &s);
    if (rounding != NULL) {
        *rounding += s.moved[0] + s.moved[1];
    }
    if (largest != NULL) {
        *largest = larger(*largest, larger(s.largest[0], s.largest[1]));
    }
    return 0.5 * (s.energy[0] + s.energy[1]);
}
