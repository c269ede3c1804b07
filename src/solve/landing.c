/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Landing a jump: at the load of the fold, overdamped motion M u' = -grad Pi carries the structure
 * down its energy to rest.
 *
 * Integrated by ROS3, a Rosenbrock method of order 3(2), L-stable, with one factorization and two
 * laws a step (Sandu et al. 1997). M/(gamma dt) + H is positive definite at every step, and the
 * energy falls over it. In long contact only the front moves: the part behind it is frozen for a
 * few steps, and catches up in a step of the whole. The step size follows the embedded error of the
 * gaps, scaled by the lengths over which the forces change. Once the state is stable and Newton's
 * step is small by that measure, KINSOL finishes. */
#include "landing.h"
#include "active_mesh.h"
#include "branch.h"
#include "corrector.h"

#include <math.h>
#include <string.h>

enum { FLOW_STEPS = 100000, STAGES = 3, NOT_FINITE_LIMIT = 100 };

/* Freeze sites that a step moves by at most this share of its largest move, except for a few, if at
 * most half of the unknowns remain. They stay frozen until motion comes near, and at most for so
 * many steps that one step of the whole costs an eighth of them. A share a hundred times larger
 * changes some landings over tables; this one changes none. */
#define HELD_SHARE 1e-4
#define HELD_MOST 0.5
enum { HELD_STEPS = 8, SPARE_SITES = 8, LEAST_SPARE = 2 };

/* Largest Newton step to finish with; largest flow step, and largest distance left by its slowing
 * down, before that is tried. Tried sooner, it fails four times in five. */
#define ARRIVAL 0.05
#define SETTLING 0.2
#define WAY_LEFT 0.002

/* Largest error of a step, as a share of the distance from the fold: a larger one could turn the
 * flow back to the side it came from. */
#define ERROR_SHARE 0.1

/* Shortest departure from a fold, scaled: closer to it, forces differ by rounding alone. */
#define LEAST_DEPARTURE 1e-6

/* A flow that comes back this near to its fold, scaled, does not come to rest nearer. */
#define LEAST_WAY 1e-4

/* The first step in scaled time where the forces give none: shorter than any decay. */
#define FIRST_STEP 1e-9

/* Bounds of a change of the step size, and its margin. The step after a rejected one does not grow
 * (Hairer and Wanner 1996). */
#define GROWTH 6.0
#define SHRINKAGE 0.25
#define MARGIN 0.8

/* ROS3 in the form that needs no products with H: stage i solves
 * (M/(gamma dt) + H) k_i = -grad Pi(v_i) + M sum_j c_ij k_j / dt, v_1 = u and v_2 = v_3 = u + k_1;
 * the result is u + sum_i m_i k_i, its embedded error sum_i e_i k_i. */
#define GAMMA 0.43586652150845899941601945119356
static const double COUPLING[STAGES][STAGES] = {
    {0},
    {-1.0156171083877702091975600115545},
    {4.0759956452537699824805835358067, 9.2076794298330791242156818474003}};
static const double RESULT[STAGES] = {1, 6.1697947043828245592553615689730,
                                      -0.42772256543218573326238373806514};
static const double DEFECT[STAGES] = {0.5, -2.9079558716805469821718236208017,
                                      0.22354069897811569627360909276199};

/* out = a + factor b; out may be a. */
HAFT_CLONES static void add_scaled(size_t n, const double *a, double factor, const double *b,
                                   double *out) {
    for (size_t k = 0; k < n; k++) {
        out[k] = a[k] + factor * b[k];
    }
}

/* Factors the matrix of a step dt, and solves for b. @return whether it is positive definite */
static bool solve_damped(haft_tracker *t, double dt, double *b) {
    add_scaled(haft_mesh_of(t)->nonzeros, t->hessian, 1 / (GAMMA * dt), haft_mesh_of(t)->mass,
               t->work.matrix);
    return haft_tracker_factor_solve(t, t->work.matrix, b) &&
           haft_factor_inertia(t->factor).negative == 0;
}

HAFT_CLONES static void multiply_by(size_t n, double factor, const double *a, double *out) {
    for (size_t k = 0; k < n; k++) {
        out[k] = factor * a[k];
    }
}

/* out = weighted sum of the first `stages` increments, at most two. */
HAFT_CLONES static void combine(size_t n, double *const *stage, const double *weight, int stages,
                                double *restrict out) {
    const double *a = stage[0], *b = stage[stages - 1];
    double other = stages > 1 ? weight[1] : 0;
    for (size_t k = 0; k < n; k++) {
        out[k] = weight[0] * a[k] + other * b[k];
    }
}

/* Where the step from u ends, and its embedded error. */
_Static_assert(STAGES == 3, "three increments");
HAFT_CLONES static void conclude(size_t n, const double *u, double *const *stage,
                                 double *restrict end, double *restrict defect) {
    const double *a = stage[0], *b = stage[1], *c = stage[2];
    for (size_t k = 0; k < n; k++) {
        end[k] = u[k] + ((RESULT[0] * a[k] + RESULT[1] * b[k]) + RESULT[2] * c[k]);
        defect[k] = (DEFECT[0] * a[k] + DEFECT[1] * b[k]) + DEFECT[2] * c[k];
    }
}

/* One step from `from` into `to`. Gradient and Hessian at `from` are current, and stay so; the
 * embedded error goes into t->work.scratch[0]. @return false if the step must be shorter. */
static bool rosenbrock_step(haft_tracker *t, const haft_state *from, haft_state *to, double dt) {
    multiply_by(t->n, -1, t->gradient, t->work.stage[0]);
    if (!solve_damped(t, dt, t->work.stage[0])) {
        return false;
    }
    double *sum = t->work.scratch[0], *gradient = t->other.gradient;
    add_scaled(t->n, from->u, 1, t->work.stage[0], to->u);
    if (!haft_tracker_gradient(t, to->u, to->load, gradient)) {
        return false;
    }
    for (int i = 1; i < STAGES; i++) {
        combine(t->n, t->work.stage, COUPLING[i], i, sum);
        haft_tracker_multiply_mass(t, 1 / dt, sum, gradient, t->work.stage[i]);
        haft_tracker_solve(t, t->work.stage[i]);
    }
    conclude(t->n, from->u, t->work.stage, to->u, sum);
    return true;
}

/* A flow step: its length in time, and the largest scaled displacement of a gap. */
typedef struct flow_step {
    double dt, move;
} flow_step;

/* Whether the flow settles: its steps are short, and little distance is left if it goes on slowing
 * down exponentially as between the last two steps. */
static bool is_settling(flow_step before, flow_step last) {
    double slowing = log(before.move / before.dt * (last.dt / last.move));
    double half_step = slowing * last.dt / (before.dt + last.dt); /* in decay times */
    double left = last.move / (2 * half_step) * exp(-half_step);
    return slowing > 0 && last.move < SETTLING && left < WAY_LEFT;
}

/* Whether the state last evaluated is stable and its Newton step is small. */
static bool is_arriving(haft_tracker *t, const haft_state *state) {
    double *step = t->work.scratch[1];
    multiply_by(t->n, -1, t->gradient, step);
    if (!haft_tracker_factor_solve(t, t->hessian, step) ||
        haft_factor_inertia(t->factor).negative != 0) {
        return false;
    }
    return haft_tracker_scaled_displacement(t, state->gap, step, NULL) < ARRIVAL;
}

/* Finishes with KINSOL from a state that is arriving. The result must be near it, stable and not
 * higher in energy. It must not be the fold that the flow left by `departure`, unless the flow
 * itself came nearer: at the knots of a table Newton can return there over a hill too low to show
 * in the energy. */
static bool arrive(haft_tracker *t, const haft_state *flowing, haft_state *landed,
                   double departure) {
    memcpy(landed->u, flowing->u, t->n * sizeof(double));
    landed->load = flowing->load;
    haft_parameter load = {NULL, 0};
    if (!haft_corrector_solve(t, load, flowing->load, landed)) {
        return false;
    }
    double come = haft_tracker_scaled_distance(t, t->gap_before, flowing->gap);
    if (haft_tracker_scaled_distance(t, flowing->gap, landed->gap) > 2 * ARRIVAL ||
        haft_tracker_scaled_distance(t, t->gap_before, landed->gap) <
            0.5 * fmin(departure, fmax(come, LEAST_WAY))) {
        return false;
    }
    double rise = haft_tracker_potential(t, landed) - haft_tracker_potential(t, flowing);
    return rise <= haft_tracker_rounding(landed, flowing) && haft_branch_certify(t).negative == 0;
}

/* Growth rate of the amplitude of a displacement v off the fold, by the current gradient. */
static double departure_rate(haft_tracker *t, const double *v) {
    double weight = haft_tracker_weigh(t, v, t->work.scratch[3]), down = 0;
    for (size_t i = 0; i < t->n; i++) {
        down -= t->gradient[i] * v[i];
    }
    return down / weight;
}

/* Displaces `from` by `move`, scaled, from the fold. @return the growth rate there, NaN if it
 * cannot be evaluated. */
static double depart_by(haft_tracker *t, haft_state *from, const double *away, double move) {
    double *v = t->work.scratch[2];
    double amplitude = move / haft_tracker_scaled_displacement(t, t->gap_before, away, NULL);
    for (size_t i = 0; i < t->n; i++) {
        v[i] = amplitude * away[i];
        from->u[i] = t->here.u[i] + v[i];
    }
    from->load = t->here.load;
    return haft_tracker_visit(t, from) ? departure_rate(t, v) : NAN;
}

/* Displaces `from` from the fold by so little that the energy still falls there: the valley beyond
 * may be narrower than the usual departure. @return a first step size, NaN if it cannot be
 * evaluated. */
static double depart(haft_tracker *t, haft_state *from, const double *away, double *move) {
    for (*move = HAFT_DEPARTURE_MOVE; *move > LEAST_DEPARTURE; *move /= 4) {
        double rate = depart_by(t, from, away, *move);
        if (!(rate <= 0)) {
            return 0.1 / rate;
        }
    }
    *move = HAFT_DEPARTURE_MOVE;
    return isnan(depart_by(t, from, away, *move)) ? NAN : FIRST_STEP;
}

static void swap(haft_state *a, haft_state *b) {
    haft_state state = *a;
    *a = *b;
    *b = state;
}

/* Whether the stages of a step cancel, so that it goes nowhere: at a knot of a table, where the
 * stiffness jumps, that can happen again and again, far from equilibrium. Otherwise the error is
 * smaller than the step. */
static bool is_caught(double error, double move) {
    return error > LEAST_DEPARTURE && error > 2 * move;
}

/* Tries one step. On success `to` is evaluated, and *move is the largest scaled displacement of a
 * gap. Otherwise gradient and Hessian at `from` stay; `to` is evaluated only if the error allows
 * it, which nearly always fails before the energy would rise.
 * @return the scaled embedded error, more than allowed if the step must be shorter. */
static double try_step(haft_tracker *t, const haft_state *from, haft_state *to, double dt,
                       double allowed, double *move) {
    if (!rosenbrock_step(t, from, to, dt)) {
        return INFINITY;
    }
    double error = haft_tracker_scaled_displacement(t, from->gap, t->work.scratch[0], NULL);
    if (!(error <= allowed)) {
        return isnan(error) ? INFINITY : error;
    }
    haft_tracker_turn(t);
    if (haft_tracker_visit(t, to)) {
        double before = haft_tracker_potential(t, from);
        *move = haft_tracker_scaled_distance(t, from->gap, to->gap);
        if (haft_tracker_potential(t, to) <= before + 1e-13 * fabs(before) &&
            !is_caught(error, *move)) {
            return error;
        }
    }
    haft_tracker_turn(t);
    return INFINITY;
}

/* A landing in progress. */
typedef struct landing {
    haft_state *from, *to;  /* the state reached, and the one before it or tried next */
    double departure;       /* from the fold, scaled */
    double dt, growth;      /* of the next step, and the bound of its growth */
    double allowed;         /* error of a step, scaled */
    flow_step before, last; /* the last two */
    int held;               /* steps until the frozen part is released */
} landing;

/* Sets the next step size by the error of a step; the step after a rejected one does not grow. */
static void adapt(landing *l, double error) {
    double factor = MARGIN * cbrt(l->allowed / fmax(error, 1e-30));
    l->dt *= fmin(l->growth, fmax(SHRINKAGE, factor));
    l->growth = error <= l->allowed ? GROWTH : 1;
}

/* The number of sites up to the last one that the step moved by more than HELD_SHARE. */
static size_t moved_sites(const haft_tracker *t, const landing *l) {
    return haft_tracker_moved(t, l->from->gap, l->to->gap, HELD_SHARE * l->last.move);
}

/* Freezes the part that the step hardly moved. */
static void hold(haft_tracker *t, landing *l) {
    size_t n = t->n;
    if (haft_active_mesh_freeze(t, l->from, l->to, moved_sites(t, l) + SPARE_SITES, HELD_MOST)) {
        l->held = (int)(HELD_STEPS * n / t->n);
    }
}

/* After a step: freezes the part that need not move in the next, or releases the frozen part.
 * @return false if the state cannot be evaluated. */
static bool hold_or_let_go(haft_tracker *t, landing *l, bool settling) {
    if (!haft_active_mesh_is_frozen(t)) {
        if (!settling) {
            hold(t, l);
        }
        return true;
    }
    l->held--;
    if (settling || l->held == 0 || moved_sites(t, l) + LEAST_SPARE > haft_mesh_of(t)->sites) {
        return haft_active_mesh_unfreeze(t, l->from);
    }
    return true;
}

/* Records the step as the last one. @return whether the flow settles. */
static bool go_on(haft_tracker *t, landing *l, flow_step taken) {
    t->cost.flow_steps++;
    swap(l->from, l->to);
    haft_active_mesh_narrow(t, l->from, l->to->u);
    if (l->allowed < t->problem.options.flow_step) {
        l->allowed =
            fmin(t->problem.options.flow_step,
                 ERROR_SHARE * haft_tracker_scaled_distance(t, t->gap_before, l->from->gap));
    }
    l->before = l->last;
    l->last = taken;
    return is_settling(l->before, l->last);
}

/* Tries to bring a settling flow to rest. @return HAFT_OUTCOMES if it must go on. */
static haft_outcome finish(haft_tracker *t, landing *l) {
    if (!is_arriving(t, l->from)) {
        return HAFT_OUTCOMES;
    }
    if (arrive(t, l->from, l->to, l->departure)) {
        if (haft_active_mesh_is_clear(t, l->to->u)) {
            swap(&t->here, l->to);
            return HAFT_OUTCOME_STUCK;
        }
        if (!haft_active_mesh_widen(t, l->from, l->to->u)) {
            return HAFT_OUTCOME_ZONE_LEFT;
        }
    }
    bool finite = haft_tracker_evaluate(t, l->from->u, l->from->load, NULL, NULL);
    return finite ? HAFT_OUTCOMES : HAFT_OUTCOME_NOT_FINITE;
}

/* The outcome if a rejected step cannot be shortened; HAFT_OUTCOMES if it can. */
static haft_outcome give_up(const haft_tracker *t, const landing *l) {
    if (t->not_finite > NOT_FINITE_LIMIT) {
        return HAFT_OUTCOME_NOT_FINITE;
    }
    return l->dt > 1e-40 ? HAFT_OUTCOMES : HAFT_OUTCOME_FLOW_STALLED;
}

/* Starts the flow off the fold, or with `away` NULL by the forces at `here`, which may be so near
 * to rest that there is nowhere to go. @return HAFT_OUTCOMES if the flow is to be followed. */
static haft_outcome set_out(haft_tracker *t, landing *l, const double *away) {
    l->to->load = t->here.load;
    if (away != NULL) {
        l->dt = depart(t, l->from, away, &l->departure);
        l->allowed = fmin(t->problem.options.flow_step, ERROR_SHARE * l->departure);
        return isnan(l->dt) ? HAFT_OUTCOME_NOT_FINITE : HAFT_OUTCOMES;
    }
    memcpy(l->from->u, t->here.u, t->n * sizeof(double));
    l->from->load = t->here.load;
    l->dt = FIRST_STEP;
    l->allowed = t->problem.options.flow_step;
    return haft_tracker_visit(t, l->from) ? finish(t, l) : HAFT_OUTCOME_NOT_FINITE;
}

haft_outcome haft_landing_follow(haft_tracker *t, const double *away, int *steps) {
    landing l = {.from = &t->spare, .to = &t->next, .growth = GROWTH};
    haft_outcome outcome = set_out(t, &l, away);
    for (*steps = 0; *steps < FLOW_STEPS && outcome == HAFT_OUTCOMES;) {
        flow_step step = {l.dt, 0};
        double error = try_step(t, l.from, l.to, l.dt, l.allowed, &step.move);
        adapt(&l, error);
        if (!(error <= l.allowed)) {
            outcome = give_up(t, &l);
        } else if (!haft_active_mesh_is_clear(t, l.to->u)) {
            outcome = haft_active_mesh_widen(t, l.from, l.to->u) ? outcome : HAFT_OUTCOME_ZONE_LEFT;
        } else {
            (*steps)++;
            bool settling = go_on(t, &l, step);
            if (!hold_or_let_go(t, &l, settling)) {
                outcome = HAFT_OUTCOME_NOT_FINITE;
            } else if (settling) {
                outcome = finish(t, &l);
            }
        }
    }
    return outcome == HAFT_OUTCOMES ? HAFT_OUTCOME_FLOW_STALLED : outcome;
}
