/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A beam's equilibrium and stability in long double, by code of the test's own: elements and sites
 * assembled from the mesh's nodes and the beam's numbers, forces from the test's own laws. Of the
 * library only the nodes' places and the units of the unknowns are taken. */
#ifndef HAFT_TEST_STRESS_STATES_H
#define HAFT_TEST_STRESS_STATES_H

#include "stress_beams.h"

enum { STRESS_BAND = 4 }; /* of the Hessian's lower half, its diagonal included */

typedef struct stress_point {
    size_t element;
    long double shape[4]; /* [m] a unit of each unknown of the element, counted from its nodes */
} stress_point;

typedef struct stress_oracle {
    const stress_beam *beam;
    size_t nodes, dofs;       /* the clamped node's two unknowns are not counted */
    long double *length;      /* of each element [m] */
    const double *unit;       /* dofs: the model's scale */
    stress_point *site, load; /* where laws and load act */
    long double stiffness;    /* E I */
    long double *gradient, *step;
    long double (*hessian)[STRESS_BAND]; /* [i][k] couples i and i + k */
    long double (*factor)[STRESS_BAND];
    /* of the state last evaluated */
    long double largest;         /* force: load, site, shear, moment over element [N] */
    long double floor;           /* what rounding of u makes of a force [N] */
    long double strain, contact; /* energies [J] */
    long double rounding;        /* what rounding of u makes of them [J] */
} stress_oracle;

/* Unknown k of element e, -1 where clamped. */
static inline long stress_dof(size_t e, int k) {
    return 2 * (long)e + k - 2;
}

static inline long double stress_unit(const stress_oracle *o, size_t e, int k) {
    long i = stress_dof(e, k);
    return i < 0 ? 0 : o->unit[i];
}

static inline stress_point stress_locate(const stress_oracle *o, const double *node_x,
                                         long double x) {
    size_t e = 0;
    while (e + 2 < o->nodes && node_x[e + 1] <= x) {
        e++;
    }
    long double l = o->length[e], t = (x - node_x[e]) / l;
    if (fabsl(t) < 1e-9L || fabsl(t - 1) < 1e-9L) {
        t = roundl(t); /* it is the node */
    }
    stress_point p = {.element = e};
    p.shape[0] = (1 - t) * (1 - t) * (1 + 2 * t) * stress_unit(o, e, 0);
    p.shape[1] = l * t * (1 - t) * (1 - t) * stress_unit(o, e, 1);
    p.shape[2] = t * t * (3 - 2 * t) * stress_unit(o, e, 2);
    p.shape[3] = l * t * t * (t - 1) * stress_unit(o, e, 3);
    return p;
}

static inline stress_oracle stress_oracle_make(const stress_beam *b, const haft_model *m) {
    const haft_model_data *data = haft_model_get(m);
    stress_oracle o = {.beam = b, .nodes = data->nodes, .dofs = data->dofs, .unit = data->scale};
    long double t = b->spec.thickness, pitch = b->spec.length / (long double)b->sites;
    o.stiffness = b->spec.young_modulus * (long double)b->spec.width * t * t * t / 12;
    o.length = calloc(o.nodes, sizeof *o.length);
    o.site = calloc(b->sites, sizeof *o.site);
    o.gradient = calloc(o.dofs, sizeof *o.gradient);
    o.step = calloc(o.dofs, sizeof *o.step);
    o.hessian = calloc(o.dofs + STRESS_BAND, sizeof *o.hessian);
    o.factor = calloc(o.dofs + STRESS_BAND, sizeof *o.factor);
    for (size_t e = 0; e + 1 < o.nodes; e++) {
        long double l = (long double)data->node_x[e + 1] - data->node_x[e];
        long double parts = l / pitch; /* the rounding of the nodes is no part of the beam */
        parts = fabsl(2 * parts - roundl(2 * parts)) < 1e-9L ? roundl(2 * parts) / 2 : parts;
        o.length[e] = parts * pitch;
    }
    for (size_t r = 0; r < b->sites; r++) {
        o.site[r] = stress_locate(&o, data->node_x, (r + 0.5L) * pitch);
    }
    o.load = stress_locate(&o, data->node_x, b->load_position);
    return o;
}

static inline void stress_oracle_free(stress_oracle *o) {
    free(o->length);
    free(o->site);
    free(o->gradient);
    free(o->step);
    free(o->hessian);
    free(o->factor);
}

static inline long double stress_displacement(const stress_point *p, const double *u) {
    long double w = 0;
    for (int k = 0; k < 4; k++) {
        long i = stress_dof(p->element, k);
        w += i < 0 ? 0 : p->shape[k] * u[i];
    }
    return w;
}

static inline long double stress_gap(const stress_oracle *o, size_t site, const double *u) {
    return o->beam->spec.gap - stress_displacement(&o->site[site], u);
}

/* Adds force times a row to the gradient, and stiffness times its square to the Hessian. */
static inline void stress_add(stress_oracle *o, const stress_point *p, long double force,
                              long double stiffness) {
    for (int k = 0; k < 4; k++) {
        long i = stress_dof(p->element, k);
        for (int j = k; j < 4 && i >= 0; j++) {
            o->hessian[i][j - k] += stiffness * p->shape[k] * p->shape[j];
        }
        if (i >= 0) {
            o->gradient[i] += force * p->shape[k];
        }
    }
}

/* Strain of element e: energy EI/l (2/l^0) in the end rotations against the chord. */
static inline void stress_add_element(stress_oracle *o, size_t e, const double *u) {
    long double l = o->length[e], d = 2 * o->stiffness / l, v[4], row[2][4];
    for (int k = 0; k < 4; k++) {
        long i = stress_dof(e, k);
        v[k] = i < 0 ? 0 : u[i] * (long double)o->unit[i];
    }
    long double chord = (v[2] - v[0]) / l, q1 = v[1] - chord, q2 = v[3] - chord;
    long double m1 = d * (2 * q1 + q2), m2 = d * (q1 + 2 * q2);
    o->strain += (q1 * m1 + q2 * m2) / 2;
    o->rounding += (fabsl(m1) + fabsl(m2)) *
                   (fabsl(v[1]) + fabsl(v[3]) + (fabsl(v[0]) + fabsl(v[2])) / l) * 0x1p-53L;
    o->largest = fmaxl(o->largest, fmaxl(fabsl(m1), fabsl(m2)) / l);
    for (int k = 0; k < 4; k++) {
        long double unit = stress_unit(o, e, k);
        row[0][k] = unit * (k == 0 ? 1 / l : k == 1 ? 1 : k == 2 ? -1 / l : 0);
        row[1][k] = unit * (k == 0 ? 1 / l : k == 1 ? 0 : k == 2 ? -1 / l : 1);
    }
    for (int k = 0; k < 4; k++) {
        long i = stress_dof(e, k);
        if (i < 0) {
            continue;
        }
        o->gradient[i] += m1 * row[0][k] + m2 * row[1][k];
        long double a = d * (2 * row[0][k] + row[1][k]), c = d * (row[0][k] + 2 * row[1][k]);
        for (int j = k; j < 4; j++) {
            o->hessian[i][j - k] += a * row[0][j] + c * row[1][j];
        }
    }
}

static inline void stress_add_site(stress_oracle *o, size_t r, const double *u) {
    const haft_beam_spec *spec = &o->beam->spec;
    long double area = (long double)spec->width * spec->length / o->beam->sites;
    stress_value f = stress_law_value(stress_beam_law(o->beam, r), stress_gap(o, r, u));
    o->contact += area * f.potential;
    o->rounding += area * fabsl(f.force) * spec->gap * 0x1p-53L;
    o->largest = fmaxl(o->largest, fabsl(area * f.force));
    stress_add(o, &o->site[r], area * f.force, -area * f.slope);
}

/* What rounding of u makes of the forces [N]: a row of |H| |u|, by a unit in the last place. */
static inline long double stress_floor(const stress_oracle *o, const double *u) {
    long double most = 0, gap = o->beam->spec.gap;
    for (size_t i = 0; i < o->dofs; i++) {
        long double sum = fabsl(o->hessian[i][0] * u[i]);
        for (size_t k = 1; k < STRESS_BAND; k++) {
            sum += i + k < o->dofs ? fabsl(o->hessian[i][k] * u[i + k]) : 0;
            sum += i >= k ? fabsl(o->hessian[i - k][k] * u[i - k]) : 0;
        }
        most = fmaxl(most, sum / gap);
    }
    return most * 0x1p-52L;
}

/* Evaluates a state of the model's unknowns at a load [N]. */
static inline void stress_evaluate(stress_oracle *o, const double *u, long double load) {
    memset(o->gradient, 0, o->dofs * sizeof *o->gradient);
    memset(o->hessian, 0, o->dofs * sizeof *o->hessian);
    o->strain = o->contact = o->rounding = 0;
    o->largest = fabsl(load);
    for (size_t e = 0; e + 1 < o->nodes; e++) {
        stress_add_element(o, e, u);
    }
    for (size_t r = 0; r < o->beam->sites; r++) {
        stress_add_site(o, r, u);
    }
    stress_add(o, &o->load, -load, 0);
    o->floor = stress_floor(o, u);
}

/* The largest force out of balance in the state last evaluated [N]: a unit of an unknown moves the
 * beam by about a gap. */
static inline long double stress_unbalance(const stress_oracle *o) {
    long double most = 0;
    for (size_t i = 0; i < o->dofs; i++) {
        most = fmaxl(most, fabsl(o->gradient[i]) / o->beam->spec.gap);
    }
    return most;
}

/* L D L' of H + shift |diagonal|. @return how many pivots are not positive */
static inline size_t stress_factorize(stress_oracle *o, long double shift) {
    size_t n = o->dofs, bad = 0;
    memcpy(o->factor, o->hessian, n * sizeof *o->factor);
    for (size_t i = 0; i < n; i++) {
        o->factor[i][0] += shift * fabsl(o->hessian[i][0]);
    }
    for (size_t j = 0; j < n; j++) {
        long double *c = o->factor[j], pivot = c[0];
        bad += !(pivot > 0);
        for (size_t a = 1; a < STRESS_BAND && j + a < n; a++) {
            for (size_t k = a; k < STRESS_BAND && j + k < n; k++) {
                o->factor[j + a][k - a] -= c[a] * c[k] / pivot;
            }
        }
        for (size_t a = 1; a < STRESS_BAND; a++) {
            c[a] /= pivot;
        }
    }
    return bad;
}

/* Puts Newton's step from the state last evaluated and factorized into o->step. */
static inline void stress_newton(stress_oracle *o) {
    size_t n = o->dofs;
    for (size_t i = 0; i < n; i++) {
        o->step[i] = -o->gradient[i];
        for (size_t k = 1; k < STRESS_BAND && k <= i; k++) {
            o->step[i] -= o->factor[i - k][k] * o->step[i - k];
        }
    }
    for (size_t i = n; i-- > 0;) {
        o->step[i] /= o->factor[i][0];
        for (size_t k = 1; k < STRESS_BAND && i + k < n; k++) {
            o->step[i] -= o->factor[i][k] * o->step[i + k];
        }
    }
}

/* What o->step is of the displacement of a point [m]. */
static inline long double stress_step_of(const stress_oracle *o, const stress_point *p) {
    long double w = 0;
    for (int k = 0; k < 4; k++) {
        long i = stress_dof(p->element, k);
        w += i < 0 ? 0 : p->shape[k] * o->step[i];
    }
    return w;
}

/* The farthest that o->step moves a site from u, in the length over which its force changes: its
 * range, and as much more as it is out of reach. */
static inline long double stress_step_size(const stress_oracle *o, const double *u) {
    long double most = 0;
    for (size_t r = 0; r < o->beam->sites; r++) {
        const stress_law *law = stress_beam_law(o->beam, r);
        long double beyond = fmaxl(stress_gap(o, r, u) - law->reach, 0);
        most = fmaxl(most, fabsl(stress_step_of(o, &o->site[r])) / (law->range + beyond));
    }
    return most;
}

#endif
