/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks of a random beam's path against the independent oracle: equilibrium and stability of each
 * accepted state, the ledger, the signs of work and dissipation, where jumps land and where the
 * path starts. */
#ifndef HAFT_TEST_STRESS_CHECKS_H
#define HAFT_TEST_STRESS_CHECKS_H

#include "stress_flow.h"

/* What can be wrong with a path. */
typedef enum stress_fault {
    STRESS_UNSTABLE,    /* the Hessian of a state is not positive definite */
    STRESS_UNBALANCED,  /* a state's forces are out of balance */
    STRESS_OFF,         /* a state is off its equilibrium, by Newton's step */
    STRESS_ENERGY,      /* an energy told is not the state's */
    STRESS_OPEN,        /* work, energy and dissipation do not add up */
    STRESS_UPHILL,      /* a jump gained energy, or lost more than there was */
    STRESS_BACKWARDS,   /* load or deflection went back on a branch */
    STRESS_WORK,        /* a step's work is not between its loads times its way */
    STRESS_PASSED,      /* small steps of the load do not lead from a state to the next */
    STRESS_LANDING,     /* a jump landed elsewhere than the flow does */
    STRESS_START,       /* the start is not where the flow from rest ends */
    STRESS_MESH_JUMPS,  /* two meshes jump at other loads */
    STRESS_MESH_LANDED, /* or at the same load to another state */
    STRESS_MESH_END,    /* or end in another state after the same jumps */
    STRESS_FAULTS
} stress_fault;

static inline const char *stress_fault_name(stress_fault fault) {
    static const char *const name[STRESS_FAULTS] = {"unstable state",
                                                    "forces out of balance",
                                                    "state off its branch",
                                                    "energy told wrong",
                                                    "ledger open",
                                                    "jump uphill",
                                                    "load back",
                                                    "work told wrong",
                                                    "fold passed",
                                                    "landing elsewhere",
                                                    "start elsewhere",
                                                    "meshes: loads of jumps",
                                                    "meshes: landing",
                                                    "meshes: end"};
    return name[fault];
}

/* Bounds, each with its reason. The solver leaves 1e-11 of the largest force it met in a step, or
 * what rounding of u makes of the forces there; a hundred times either is a wrong state, since the
 * oracle's elements round otherwise. The ledger is asked for 1e-10 of all work, so energies are for
 * as much. */
#define STRESS_RESIDUAL 1e-9L
#define STRESS_FLOORS 64
#define STRESS_LEDGER 2e-10L
#define STRESS_SHIFT 1e-11L /* of a Hessian's diagonal: what its own rounding may hide */
#define STRESS_LANDED 1e-3L /* of a law's range */
#define STRESS_NEWTON 1e-2L /* of the length over which a site's force changes */

/* Forces and energies are not asked for below these shares of those that bend the beam to its
 * substrate: a beam at rest has none, and a law a hundred ranges off may be told as nothing. */
#define STRESS_LEAST_FORCE 1e-2L
#define STRESS_LEAST_ENERGY 1e-16L
#define STRESS_FELT_FORCE 1e-12L

/* What was found on one mesh: the worst of each fault in units of its bound, and where. */
typedef struct stress_finding {
    long double worst[STRESS_FAULTS]; /* above 1: a fault */
    size_t point[STRESS_FAULTS];      /* point or jump of the worst */
    size_t branches;                  /* steps followed again */
    size_t landings, lost_landings;   /* compared; where the oracle gave up */
    bool start_felt, start_lost;      /* the start was compared; the oracle gave up */
    size_t dragged;                   /* landings that differ by the mesh's drag alone */
    size_t undecided;                 /* or that the oracle could not judge */
} stress_finding;

static inline void stress_note(stress_finding *f, stress_fault fault, long double size,
                               size_t point) {
    if (!(size <= f->worst[fault])) {
        f->worst[fault] = isnan(size) ? INFINITY : size;
        f->point[fault] = point;
    }
}

/* The farthest that two states' sites are apart, in units of what may be. */
static inline long double stress_apart(const stress_oracle *o, const double *u, const double *v) {
    long double most = 0;
    for (size_t r = 0; r < o->beam->sites; r++) {
        long double miss =
            fabsl(stress_displacement(&o->site[r], u) - stress_displacement(&o->site[r], v));
        long double least = STRESS_LANDED * stress_beam_law(o->beam, r)->range;
        most = fmaxl(most, miss / fmaxl(least, 1e-9L * o->beam->spec.gap));
    }
    return most;
}

/* The force at the end that bends the beam to its substrate, but for a factor of 3 [N]. */
static inline long double stress_bending_force(const stress_oracle *o) {
    long double l = o->beam->spec.length;
    return o->stiffness * o->beam->spec.gap / (l * l * l);
}

/* What forces may be out of balance in the state last evaluated [N]. */
static inline long double stress_slack(const stress_oracle *o) {
    long double force = fmaxl(o->largest, STRESS_LEAST_FORCE * stress_bending_force(o));
    return STRESS_RESIDUAL * force + STRESS_FLOORS * o->floor;
}

/* Equilibrium, stability and energies of point i; `before` is what the forces of the point before,
 * from where the solver came, may be out of balance. @return the same of this point */
static inline long double stress_check_state(stress_oracle *o, const haft_path *path, size_t i,
                                             long double before, stress_finding *f) {
    const haft_path_point *p = &path->point[i];
    const double *u = path->state + i * o->dofs;
    stress_evaluate(o, u, p->load);
    long double slack = stress_slack(o);
    stress_note(f, STRESS_UNBALANCED, stress_unbalance(o) / fmaxl(slack, before), i);
    stress_note(f, STRESS_UNSTABLE, stress_factorize(o, STRESS_SHIFT) > 0 ? INFINITY : 0, i);
    if (stress_factorize(o, 0) == 0) {
        stress_newton(o);
        stress_note(f, STRESS_OFF, stress_step_size(o, u) / STRESS_NEWTON, i);
    }
    long double size = fabsl(o->strain) + fabsl(o->contact);
    long double allowed = STRESS_LEDGER * size + STRESS_FLOORS * o->rounding +
                          STRESS_LEAST_ENERGY * stress_bending_force(o) * o->beam->spec.gap;
    long double miss =
        fmaxl(fabsl(o->strain - p->internal_energy), fabsl(o->contact - p->contact_energy));
    stress_note(f, STRESS_ENERGY, miss / allowed, i);
    return slack;
}

/* What the ledger's sums are held against. */
typedef struct stress_books {
    long double energy_start, turnover, most, rounding;
} stress_books;

/* Opens the books: at the first point, or at u = 0 if the path begins with a jump from there. */
static inline stress_books stress_open_books(stress_oracle *o, const haft_path *path) {
    double *rest = calloc(o->dofs, sizeof *rest);
    bool jumped = path->points > 0 && path->point[0].jump >= 0;
    stress_evaluate(o, jumped || path->points == 0 ? rest : path->state, 0);
    free(rest);
    return (stress_books){.energy_start = o->strain + o->contact,
                          .most = fabsl(o->strain) + fabsl(o->contact),
                          .rounding = o->rounding};
}

/* The ledger at point i, whose state was evaluated last, by the oracle's energies. */
static inline void stress_check_ledger(const stress_oracle *o, const haft_path *path, size_t i,
                                       stress_books *books, stress_finding *f) {
    const haft_path_point *p = &path->point[i];
    books->turnover += i == 0 ? 0 : fabs(p->work - path->point[i - 1].work);
    books->most = fmaxl(books->most, fabsl(o->strain) + fabsl(o->contact));
    books->rounding = fmaxl(books->rounding, o->rounding);
    long double gained = o->strain + o->contact - books->energy_start;
    long double allowed = STRESS_LEDGER * books->turnover + 1e-13L * books->most +
                          STRESS_FLOORS * books->rounding +
                          STRESS_LEAST_ENERGY * stress_bending_force(o) * o->beam->spec.gap;
    stress_note(f, STRESS_OPEN, fabsl(gained - p->work + p->dissipated) / allowed, i);
}

/* On a stable branch the deflection under the load rises with the load, so that the work of a step
 * lies between its way times either load. `slack` is what the load may be off [N]. */
static inline void stress_check_step(const stress_oracle *o, const haft_path *path, size_t i,
                                     long double slack, stress_finding *f) {
    const haft_path_point *a = &path->point[i - 1], *b = &path->point[i];
    if (b->jump >= 0) {
        return;
    }
    long double w0 = stress_displacement(&o->load, path->state + (i - 1) * o->dofs);
    long double w1 = stress_displacement(&o->load, path->state + i * o->dofs);
    long double sign = b->phase == 0 ? 1 : -1, way = w1 - w0;
    stress_note(f, STRESS_BACKWARDS, sign * ((long double)a->load - b->load) / slack, i);
    long double work = (long double)b->work - a->work, low = a->load * way, high = b->load * way;
    long double out = fmaxl(fminl(low, high) - work, work - fmaxl(low, high));
    long double gap = o->beam->spec.gap, most = fmaxl(fabsl(a->load), fabsl(b->load));
    long double allowed = STRESS_LEDGER * fmaxl(fabs(a->work), fabs(b->work)) + slack * fabsl(way) +
                          STRESS_FLOORS * (o->rounding + most * gap * 0x1p-53L) +
                          STRESS_LEAST_ENERGY * stress_bending_force(o) * gap;
    stress_note(f, STRESS_WORK, out / allowed, i);
}

/* Jump at point i: it lost energy, and no more than the state before it had above the state after
 * it at the jump's load, since that state is above the fold's there. Before the first point is the
 * beam at rest. */
static inline void stress_check_jump(stress_oracle *o, const haft_path *path, size_t i,
                                     stress_finding *f) {
    const haft_jump *j = &path->jump[path->point[i].jump];
    double *zero = calloc(o->dofs, sizeof *zero);
    const double *u[2] = {i == 0 ? zero : path->state + (i - 1) * o->dofs,
                          path->state + i * o->dofs};
    long double energy[2], allowed = 1e-9L * j->dissipated;
    for (int k = 0; k < 2; k++) {
        stress_evaluate(o, u[k], j->load);
        energy[k] = o->strain + o->contact - j->load * stress_displacement(&o->load, u[k]);
        allowed += 1e-12L * (fabsl(o->strain) + fabsl(o->contact)) + STRESS_FLOORS * o->rounding;
    }
    free(zero);
    stress_note(f, STRESS_UPHILL, j->dissipated > 0 ? 0 : INFINITY, i);
    stress_note(f, STRESS_UPHILL, (j->dissipated - (energy[0] - energy[1])) / allowed, i);
}

/* Follows the branch from point i - 1 to point i by small steps of the load, each finished by
 * Newton within a fiftieth of a length: over a fold between them none would lead. */
static inline void stress_check_branch(stress_oracle *o, const haft_model *m, const haft_path *path,
                                       size_t i, stress_finding *f) {
    size_t bytes = o->dofs * sizeof(double);
    double *u = malloc(bytes), *rest = malloc(bytes), share = 0, step = 0.25;
    double from = path->point[i - 1].load, way = path->point[i].load - from;
    memcpy(u, path->state + (i - 1) * o->dofs, bytes);
    while (share < 1 && step > 1e-7) {
        double next = fmin(1, share + step);
        stress_flow at = {o, m, from + next * way};
        if (stress_flow_rests(&at, u, rest, 0.02L)) {
            memcpy(u, rest, bytes);
            share = next;
            step *= 2;
        } else {
            step /= 4;
        }
    }
    f->branches++;
    stress_note(f, STRESS_PASSED,
                share < 1 ? INFINITY : stress_apart(o, u, path->state + i * o->dofs), i);
    free(u);
    free(rest);
}

/* Where the flow leads from the state before the jump at point i, at a load a little beyond. Too
 * little, and the flow's own error decides which side of the fold it leaves by; too much, and it
 * passes another fold. So more is tried until one agrees. @return whether one did */
static inline bool stress_check_landing(stress_oracle *o, const haft_model *m,
                                        const haft_path *path, size_t i, stress_finding *f) {
    static const double overshoot[] = {1e-7, 1e-6, 1e-5, 1e-4};
    size_t bytes = o->dofs * sizeof(double);
    double *u = malloc(bytes), *rest = malloc(bytes);
    long double nearest = INFINITY;
    bool flowed = false;
    for (size_t k = 0; k < 4 && !(nearest <= 1); k++) {
        const haft_path_point *p = &path->point[i];
        memcpy(u, path->state + (i - 1) * o->dofs, bytes);
        double load = p->load * (p->phase == 0 ? 1 + overshoot[k] : 1 - overshoot[k]);
        if (stress_flow_run(o, m, load, p->load, u, rest)) {
            flowed = true;
            nearest = fminl(nearest, stress_apart(o, rest, path->state + i * o->dofs));
        }
    }
    f->landings += flowed;
    f->lost_landings += !flowed;
    if (flowed) {
        stress_note(f, STRESS_LANDING, nearest, i);
    }
    free(u);
    free(rest);
    return nearest <= 1;
}

/* The first point against the flow from u = 0 without load, where laws are felt at rest.
 * @return whether they agree */
static inline bool stress_check_start(stress_oracle *o, const haft_model *m, const haft_path *path,
                                      stress_finding *f) {
    double *u = calloc(o->dofs, sizeof *u), *rest = malloc(o->dofs * sizeof *rest);
    stress_evaluate(o, u, 0);
    f->start_felt = o->largest > STRESS_FELT_FORCE * stress_bending_force(o) && path->points > 0;
    if (f->start_felt) {
        f->start_lost = !stress_flow_run(o, m, 0, 0, u, rest);
        if (!f->start_lost) {
            stress_note(f, STRESS_START, stress_apart(o, rest, path->state), 0);
        }
    }
    free(u);
    free(rest);
    return f->start_felt && !f->start_lost && f->worst[STRESS_START] <= 1;
}

/* Checks a whole path with its states; of its landings in simple folds `sample`, evenly, and ten
 * times as many of its steps. */
static inline void stress_check_path(stress_oracle *o, const haft_model *m, const haft_path *path,
                                     size_t sample, stress_finding *f) {
    stress_books books = stress_open_books(o, path);
    size_t every = sample > 0 ? (path->jumps + sample - 1) / sample : 0;
    size_t stride = sample > 0 ? path->points / (10 * sample) + 1 : 0;
    long double slack = 0, before = 0;
    for (size_t i = 0; i < path->points; i++) {
        before = slack;
        slack = stress_check_state(o, path, i, before, f);
        stress_check_ledger(o, path, i, &books, f);
        int jump = path->point[i].jump;
        if (i > 0) {
            stress_check_step(o, path, i, fmaxl(slack, before), f);
        }
        if (i > 0 && jump < 0 && stride > 0 && i % stride == 0) {
            stress_check_branch(o, m, path, i, f);
        }
        if (jump >= 0) {
            stress_check_jump(o, path, i, f);
            if (i > 0 && every > 0 && (size_t)jump % every == 0 &&
                path->jump[jump].departure == HAFT_DEPARTURE_FOLD) {
                stress_check_landing(o, m, path, i, f);
            }
        }
    }
    if (sample > 0) {
        stress_check_start(o, m, path, f);
    }
}

#endif
