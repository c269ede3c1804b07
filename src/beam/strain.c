/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Strain energy and its forces, element by element through the deformation modes, deflections
 * subtracted first. Neighbours that are alike, as all of a mesh are but a few, are gone through
 * from node to node, a node's two unknowns in the lanes of a vector. */
#include "sites.h"

#include <math.h>
#include <string.h>

/* Sums over elements: energy [units of energy], by its two modes; how much it moves as each unknown
 * is rounded, in units of 2^-53, and the greatest force, by a node's two unknowns. */
typedef struct sums {
    pair energy, moved, largest;
} sums;

/* An element's unknowns, or the forces on them, by nodes. */
typedef struct element_values {
    pair near, far;
} element_values;

HAFT_INLINE double mode_amplitude(const double mode[HAFT_SPAN], element_values v) {
    pair part = *(const pair *)mode * v.near + *(const pair *)(mode + 2) * v.far;
    return part[0] + part[1];
}

/* Whether a node's two unknowns are there, the rotation behind the deflection. */
HAFT_INLINE bool is_node(const int *dof) {
    return dof[0] >= 0 && dof[1] == dof[0] + 1;
}

HAFT_INLINE pair node_values(const int *dof, const double *u) {
    return is_node(dof) ? *(const pair *)(u + dof[0])
                        : (pair){dof[0] < 0 ? 0 : u[dof[0]], dof[1] < 0 ? 0 : u[dof[1]]};
}

HAFT_INLINE void add_to_node(const int *dof, pair force, double *y) {
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

HAFT_INLINE pair size_of(pair v) {
    return (pair)((pair_bits)v & INT64_MAX);
}

HAFT_INLINE pair larger_of(pair a, pair b) {
    const pair_bits a_is = a > b;
    return (pair)(((pair_bits)a & a_is) | ((pair_bits)b & ~a_is));
}

HAFT_INLINE void weigh_node(const int *dof, pair force, pair value, sums *s) {
    s->moved += size_of(force * value);
    for (int k = 0; k < 2; k++) {
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

/* A run's numbers as its nodes' lanes take them, from a beam's modes (1, turn, -1, 0) and (1, 0,
 * -1, far_turn): q = fall + turns * rotations, m = own * q + mixed * (q turned over), and forces
 * near * (m0 + m1, m0) and far * (m0 + m1, m1) on the nodes. */
typedef struct run_numbers {
    pair turns, own, mixed, near, far;
} run_numbers;

HAFT_INLINE run_numbers number_run(const haft_element *element) {
    const double *d = element->stiffness;
    double turn = element->mode[0][1], far_turn = element->mode[1][3];
    return (run_numbers){{turn, far_turn}, {d[0], d[2]}, {d[1], d[1]}, {1, turn}, {-1, far_turn}};
}

/* What is asked for beside energy and forces. */
typedef enum asked { NO_MORE, MOVED, LARGEST_TOO } asked;

/* Elements alike side by side, the first of which may begin at a clamp. */
HAFT_INLINE void add_run(const haft_element *element, size_t elements, const double *u,
                         double *gradient, asked more, sums *s) {
    const run_numbers number = number_run(element);
    bool clamped = element->dof[0] < 0;
    pair here = clamped ? (pair){0, 0} : *(const pair *)(u + element->dof[0]), before = {0, 0};
    const double *next = u + element->dof[2];
    double *g = gradient != NULL ? gradient + element->dof[2] : NULL;
    for (size_t e = 0; e < elements; e++) {
        const pair there = *(const pair *)(next + 2 * e), way = here - there;
        const pair rotations = __builtin_shufflevector(here, there, 1, 3);
        const pair q = __builtin_shufflevector(way, way, 0, 0) + number.turns * rotations;
        const pair m = number.own * q + number.mixed * __builtin_shufflevector(q, q, 1, 0);
        s->energy += q * m;
        if (gradient != NULL) {
            const pair sum = m + __builtin_shufflevector(m, m, 1, 0);
            const pair near = number.near * __builtin_shufflevector(sum, m, 0, 2);
            const pair far = number.far * __builtin_shufflevector(sum, m, 0, 3);
            bool held = clamped && e == 0;
            if (!held) {
                *(pair *)(g + 2 * e - 2) += before + near;
            }
            if (more >= MOVED) {
                s->moved += size_of(near * here) + size_of(far * there);
            }
            if (more >= LARGEST_TOO) {
                s->largest = larger_of(s->largest, size_of(far));
                s->largest = held ? s->largest : larger_of(s->largest, size_of(near));
            }
            before = far;
        }
        here = there;
    }
    if (gradient != NULL) {
        *(pair *)(g + 2 * elements - 2) += before;
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
    for (size_t e = 0; e < model->elements; e++) {
        const haft_element *now = &model->element[e];
        if (e == 0 || !continues(&model->element[run[runs - 1]], now, (int)(e - run[runs - 1]))) {
            run[runs++] = e;
        }
    }
    return runs;
}

HAFT_CLONES static void add_runs(const haft_model *model, const double *u, double *gradient,
                                 asked more, sums *out) {
    sums s = {{0, 0}, {0, 0}, {0, 0}};
    const haft_layout *layout = model->layout;
    for (size_t r = 0; r < layout->element_runs && layout->element_run[r] < model->elements; r++) {
        size_t e = layout->element_run[r];
        size_t end = r + 1 < layout->element_runs ? layout->element_run[r + 1] : model->elements;
        end = end < model->elements ? end : model->elements;
        if (end - e < 2) {
            add_element(&model->element[e], u, gradient, &s);
        } else if (more == LARGEST_TOO) { /* a constant in each */
            add_run(&model->element[e], end - e, u, gradient, LARGEST_TOO, &s);
        } else if (more == MOVED) {
            add_run(&model->element[e], end - e, u, gradient, MOVED, &s);
        } else {
            add_run(&model->element[e], end - e, u, gradient, NO_MORE, &s);
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
