/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Following a branch. The continuation parameter of a step is the gap with the largest scaled
 * displacement, so that a fold of the load is an ordinary point of the step. Where a gap would pass
 * a kink of its law, the step ends on the kink, so that derivatives are smooth within each step. */
#include "active_mesh.h"
#include "walker.h"

#include <math.h>
#include <string.h>

/* Smallest step, scaled. */
#define LEAST_STEP 1e-9

/* A branch that loses stability within a step of this scaled size, although the load does not turn,
 * is at a bifurcation. */
#define EDGE_STEP 1e-6

/* Largest defect of the ledger that counts as rounding of a state, in units of that rounding. */
#define OFF_BRANCH 1e4

/* Largest growth of a step: where knots of a table have cut it, more of them lie ahead. */
#define GROWTH 1.3

/* A gap is on a kink of its law within this share of the law's range, or within the rounding of
 * gaps, as a share of the height they are measured from. */
#define KINK_NEAR 1e-9
#define GAP_ROUNDING 0x1p-49

/* Kinks of gaps that move less than this share of the largest move do not end a step. */
#define KINK_SHARE 0.05

/* The gap that moves most in the direction of the certified branch becomes the parameter. */
static haft_parameter choose_control(haft_tracker *t) {
    size_t site = 0;
    double move = haft_tracker_largest_step(t, t->here.gap, t->motion, &site);
    if (!(move > 0)) {
        return (haft_parameter){NULL, 0};
    }
    return (haft_parameter){&haft_mesh_of(t)->site[site], site};
}

/* Derivatives at `here` by the step's parameter: those at the end of the last step, unless the two
 * sides differ there. */
static void derive(haft_walker *w, const haft_step *step) {
    haft_tracker *t = w->t;
    if (!w->arrived) {
        haft_branch_derive(t, &t->here, step->parameter, step->sign, &t->start);
        return;
    }
    haft_branch arrived = t->end;
    t->end = t->start;
    t->start = arrived;
    haft_branch_rebase(t, step->parameter, &t->start);
    w->arrived = false;
}

/* Starts a step at `here`: parameter, derivatives on the side of the motion, and size step_size. */
static void depart(haft_walker *w, haft_step *step) {
    haft_tracker *t = w->t;
    step->parameter = choose_control(t);
    const haft_site *site = step->parameter.site;
    double rate = site == NULL ? 1 : haft_tracker_row(t, site, t->solution);
    step->sign = rate * w->direction > 0 ? 1 : -1;
    derive(w, step);
    double size = 1;
    if (site != NULL) {
        double length = haft_step_length(&t->problem.lengths, step->parameter.index,
                                         t->here.gap[step->parameter.index]);
        size = w->step_size * length / haft_mesh_of(t)->gap;
    }
    step->dtau = step->sign * size;
}

/* Share of the step at which a gap passes a kink, moving from d by first- and second-order amounts
 * a and b. It is above 1 if the gap does not pass, or if it first moves away and then turns, since
 * the gap cannot be the parameter then. A gap within `near` of the kink is on it. */
static double passing_share(double d, double a, double b, double kink, double near) {
    double end = d + a + b, to = kink - d;
    if (fabs(to) < near || to * (kink - end) >= 0 || to * a <= 0) {
        return 2;
    }
    double share = to / (end - d);
    for (int i = 0; i < 8; i++) {
        share -= (share * (a + share * b) - to) / (a + 2 * share * b);
    }
    return share > 0 && share < 1 ? share : to / (end - d);
}

/* Shortens the step to the first kink that it would pass, with that gap's site as the parameter, so
 * that it ends on the kink to rounding. */
static void stop_at_kink(haft_walker *w, haft_step *step) {
    haft_tracker *t = w->t;
    const haft_model_data *m = haft_mesh_of(t);
    double first = 1, target = 0, rate = t->start.load1;
    const double *d = t->here.gap;
    size_t chosen = m->sites;
    for (size_t r = m->inert; r < m->sites; r++) {
        const haft_law *law = &t->problem.laws[r];
        double a = -t->motion[r] * rate * step->dtau;
        if (fabs(a) < KINK_SHARE * w->step_size * haft_length(&t->problem.lengths, r, d[r]) ||
            law->kind != HAFT_LAW_MORSE) {
            continue;
        }
        double curving = haft_model_displacement(&m->site[r], t->start.u2);
        double b = -0.5 * curving * step->dtau * step->dtau;
        const double kink[2] = {law->d_max, law->wall_distance};
        double near = fmax(KINK_NEAR * t->problem.lengths.range[r], GAP_ROUNDING * m->gap);
        for (int k = 0; k < 2; k++) {
            double share = passing_share(d[r], a, b, kink[k], near);
            if (share < first) {
                first = share;
                target = d[r] - kink[k];
                chosen = r;
            }
        }
    }
    if (chosen < haft_mesh_of(t)->sites) {
        step->parameter = (haft_parameter){&haft_mesh_of(t)->site[chosen], chosen};
        double turned = haft_branch_rebase(t, step->parameter, &t->start);
        step->sign = turned > 0 ? step->sign : -step->sign;
        step->dtau = target / haft_mesh_of(t)->gap;
        step->at_kink = true;
    }
}

/* Accepts `next`, and adapts the step size to the margins that ledger and corrector left. */
static void accept(haft_walker *w, const haft_step *step) {
    haft_walker_swap(w->t);
    w->arrived = !step->at_kink;
    w->t->cost.steps++;
    haft_walker_book(w, step->work, 0);
    haft_walker_record(w, -1);
    double used =
        fmax(fabs(step->defect) / step->allowed, pow(step->moved / HAFT_CORRECTION_LIMIT, 2));
    double factor = 0.85 * pow(fmax(used, 1e-6), -1.0 / 6);
    w->step_size =
        fmin(w->t->problem.options.gap_step, w->step_size * fmin(GROWTH, fmax(0.3, factor)));
    haft_walker_narrow(w, w->t->next.u); /* `here` before the step */
}

/* Shortens a step in proportion to its defect. */
static void shrink(haft_walker *w, haft_step *step) {
    w->t->cost.rejected++;
    double factor = 0.5;
    if (isfinite(step->defect) && step->allowed > 0) {
        double order = haft_branch_defect_order(w->t, step->parameter);
        factor = fmin(0.7, fmax(0.1, 0.85 * pow(step->allowed / fabs(step->defect), 1 / order)));
    }
    w->step_size *= factor;
    step->dtau *= factor;
}

/* Whether shorter steps do not reduce the ledger's defect of a sound step. Then `here` is off its
 * branch in a soft direction by what the corrector's tolerance allows, the step returns to the
 * branch, and the defect is the energy of that error. */
static bool is_back_on_branch(const haft_walker *w, const haft_step *step, double defect_before) {
    const haft_tracker *t = w->t;
    return w->step_size < EDGE_STEP && fabs(step->defect) > 0.9 * fabs(defect_before) &&
           fabs(step->defect) < OFF_BRANCH * haft_tracker_rounding(&t->here, &t->next);
}

/* Crack length above the one asked for at the end of a step of this size; NaN if the step fails. */
static double residual_at(haft_walker *w, haft_step *step, double dtau) {
    step->dtau = dtau;
    haft_step_result result = haft_branch_try(w->t, step, w->direction);
    bool sound = result == HAFT_STEP_TAKEN || result == HAFT_STEP_DIPS;
    return sound ? haft_walker_crack_residual(w, &w->t->next) : NAN;
}

/* Shortens a step that passes the crack length asked for, so that it ends where that is just
 * reached. Every third secant is a bisection, since the tip leaps from patch to patch. @return
 * false if no such step could be taken. */
static bool stop_at_target(haft_walker *w, haft_step *step) {
    double wanted = w->t->problem.programme.crack_length, full = fabs(step->dtau);
    double low = 0, above = haft_walker_crack_residual(w, &w->t->here);
    double high = step->dtau, below = haft_walker_crack_residual(w, &w->t->next);
    for (int i = 0; fabs(high - low) > 1e-13 * full && below < -1e-13 * wanted; i++) {
        double share = i % 3 < 2 ? above / (above - below) : 0.5;
        double dtau = low + (share > 0.01 && share < 0.99 ? share : 0.5) * (high - low);
        if (dtau == low || dtau == high) {
            break;
        }
        double residual = residual_at(w, step, dtau);
        if (residual <= 0) {
            high = dtau;
            below = residual;
        } else {
            low = dtau;
            above = residual;
        }
    }
    return residual_at(w, step, high) <= 0;
}

/* Takes the load as the parameter, to end a step exactly at a load. */
static bool stop_at_load(haft_walker *w, haft_step *step, double load) {
    haft_tracker *t = w->t;
    haft_step direct = *step;
    direct.parameter = (haft_parameter){NULL, 0};
    direct.dtau = load - t->here.load;
    direct.sign = direct.dtau > 0 ? 1 : -1;
    size_t bytes = t->n * sizeof(double);
    memcpy(t->rebased.u1, t->start.u1, bytes);
    memcpy(t->rebased.u2, t->start.u2, bytes);
    t->rebased.load1 = t->start.load1;
    t->rebased.load2 = t->start.load2;
    haft_branch_rebase(t, direct.parameter, &t->start);
    if (haft_branch_try(t, &direct, w->direction) == HAFT_STEP_TAKEN) {
        *step = direct;
        t->next.load = load;
        return true;
    }
    haft_branch spent = t->start;
    t->start = t->rebased;
    t->rebased = spent;
    return false;
}

haft_outcome haft_walker_advance(haft_walker *w) {
    haft_tracker *t = w->t;
    haft_step step = {.at_kink = false};
    depart(w, &step);
    stop_at_kink(w, &step);
    double limit = w->direction > 0 ? t->problem.programme.load_limit / t->problem.load_unit : 0;
    double defect_before = INFINITY;
    while (w->step_size > LEAST_STEP) {
        haft_step_result result = haft_branch_try(t, &step, w->direction);
        if (result == HAFT_STEP_LEAVES) {
            return haft_walker_widen(w) ? HAFT_OUTCOME_STUCK : HAFT_OUTCOME_ZONE_LEFT;
        }
        if (result == HAFT_STEP_DIPS) {
            step.dtau *= step.dip;
            continue;
        }
        bool past_load = result == HAFT_STEP_TAKEN && (t->next.load - limit) * w->direction >= 0;
        double fold_defect = 0;
        if (result == HAFT_STEP_FOLD) {
            result = haft_jump_locate_fold(w, &step, limit, &fold_defect);
            past_load = result == HAFT_STEP_UNSTABLE;
            if (result == HAFT_STEP_TAKEN && !haft_walker_reached(w, &t->next)) {
                haft_outcome outcome = haft_jump_at_fold(w, &step, fold_defect);
                bool over = outcome == HAFT_OUTCOME_STUCK && haft_walker_reached(w, &t->here);
                return over ? HAFT_OUTCOME_FREE : outcome;
            }
        }
        if (past_load) {
            if (stop_at_load(w, &step, limit)) {
                accept(w, &step);
                w->path->turned_by_load |= w->direction > 0;
                return HAFT_OUTCOME_FREE;
            }
        } else if (result == HAFT_STEP_TAKEN) {
            bool over = haft_walker_reached(w, &t->next);
            if (!over || stop_at_target(w, &step)) {
                accept(w, &step);
                return over ? HAFT_OUTCOME_FREE : HAFT_OUTCOME_STUCK;
            }
        }
        if (result == HAFT_STEP_UNSTABLE && !past_load && w->step_size < EDGE_STEP) {
            return haft_jump_at_bifurcation(w, &step);
        }
        if (result == HAFT_STEP_ENERGY_CHECK_FAILED && is_back_on_branch(w, &step, defect_before)) {
            accept(w, &step);
            return HAFT_OUTCOME_STUCK;
        }
        defect_before = step.defect;
        shrink(w, &step);
    }
    if (haft_active_mesh_is_frozen(t)) { /* the whole mesh may succeed */
        haft_walker_unfreeze(w);
        w->step_size = t->problem.options.gap_step;
        return HAFT_OUTCOME_STUCK;
    }
    return haft_jump_at_multiple_fold(w, &step);
}
