/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The programme: load to the crack length asked for, unload to nothing, jump by jump.
 *
 * Each step is controlled by the gap that would move most, in the length over which its force
 * changes, so that a fold of the load is an ordinary point of the step; where a gap would pass a
 * kink of its law, the step ends on the kink, so that every step's derivatives are smooth. */
#include "record.h"

#include <math.h>
#include <string.h>

/* A step smaller than this, in lengths, is no step. */
#define LEAST_STEP 1e-9

/* A gap that moves less than this share of the largest move does not choose where a step ends. */
#define KINK_SHARE 0.05

typedef struct walker {
    haft_tracker *t;
    haft_path *path;
    haft_ledger ledger;
    int phase, direction;
    double eta; /* size of the next step, in lengths */
    bool failed;
    haft_error *error;
} walker;

static void swap_states(haft_tracker *t) {
    haft_state state = t->here;
    t->here = t->next;
    t->next = state;
}

/* The gap that moves most in the direction of the certified branch becomes the control. */
static haft_control choose_control(haft_tracker *t) {
    size_t site = 0;
    double move = haft_tracker_move(t, t->here.u, t->solution, &site);
    if (!(move > 0)) {
        return (haft_control){NULL, 0};
    }
    return (haft_control){&t->model->site[site], site};
}

/* Sets out from `here`: control, derivatives on the side of the motion, a step of eta lengths. */
static void depart(walker *w, haft_step *step) {
    haft_tracker *t = w->t;
    step->control = choose_control(t);
    const haft_site *site = step->control.site;
    double rate = site == NULL ? 1 : haft_tracker_row(t, site, t->solution);
    step->sign = rate * w->direction > 0 ? 1 : -1;
    haft_branch_derive(t, &t->here, step->control, step->sign, &t->start);
    double size = 1;
    if (site != NULL) {
        double d = t->model->gap - haft_model_displacement(site, t->here.u);
        size = w->eta * haft_tracker_length(t, step->control.index, d) / t->model->gap;
    }
    step->dtau = step->sign * size;
}

/* Share of the step at which a gap, moving from d by first- and second-order amounts a and b,
 * passes a kink; above 1 if it does not. */
static double passing_share(double d, double a, double b, double kink, double range) {
    double end = d + a + b, to = kink - d;
    if (fabs(to) < 1e-9 * range || (kink - d) * (kink - end) >= 0) {
        return 2;
    }
    double share = to / (end - d);
    for (int i = 0; i < 8; i++) {
        share -= (share * (a + share * b) - to) / (a + 2 * share * b);
    }
    return share > 0 && share < 1 ? share : to / (end - d);
}

/* Shortens the step to the first kink of a law that it would pass, by taking that gap's site as the
 * control: then the kink is met to round-off. */
static void stop_at_kink(walker *w, haft_step *step) {
    haft_tracker *t = w->t;
    double first = 1, target = 0;
    size_t chosen = t->model->sites;
    for (size_t r = 0; r < t->model->sites; r++) {
        const haft_law *law = &t->laws[r];
        const haft_site *site = &t->model->site[r];
        if (law->kind != HAFT_LAW_MORSE) {
            continue;
        }
        double d = t->model->gap - haft_model_displacement(site, t->here.u);
        double a = -haft_model_displacement(site, t->start.u1) * step->dtau;
        if (fabs(a) < KINK_SHARE * w->eta * haft_tracker_length(t, r, d)) {
            continue;
        }
        double b = -0.5 * haft_model_displacement(site, t->start.u2) * step->dtau * step->dtau;
        const double kink[2] = {law->d_max, law->wall_distance};
        for (int k = 0; k < 2; k++) {
            double share = passing_share(d, a, b, kink[k], t->range[r]);
            if (share < first) {
                first = share;
                target = d - kink[k];
                chosen = r;
            }
        }
    }
    if (chosen < t->model->sites) {
        step->control = (haft_control){&t->model->site[chosen], chosen};
        double rate = haft_branch_rebase(t, step->control, &t->start);
        step->sign = rate > 0 ? step->sign : -step->sign;
        step->dtau = target / t->model->gap;
    }
}

static void enter_work(walker *w, double work, double dissipated) {
    w->ledger.work += work;
    w->ledger.turnover += fabs(work);
    w->ledger.dissipated += dissipated;
}

static void record(walker *w, int jump) {
    if (haft_record_point(w->path, w->t, &w->ledger, w->phase, jump, w->error) != HAFT_OK) {
        w->failed = true;
    }
}

/* Accepts `next` and adapts the step by what the ledger and the corrector left of their margins. */
static void accept(walker *w, const haft_step *step) {
    swap_states(w->t);
    w->t->cost.steps++;
    enter_work(w, step->work, 0);
    record(w, -1);
    double used = fmax(fabs(step->defect) / step->allowed, pow(step->moved / 0.05, 2));
    double factor = 0.85 * pow(fmax(used, 1e-6), -1.0 / 6);
    w->eta = fmin(w->t->options.gap_step, w->eta * fmin(2, fmax(0.3, factor)));
}

static void shrink(walker *w, haft_step *step) {
    w->t->cost.rejected++;
    double factor = 0.5;
    if (isfinite(step->defect) && step->allowed > 0) {
        factor = fmin(0.7, fmax(0.1, 0.85 * pow(fabs(step->defect) / step->allowed, -1.0 / 6)));
    }
    w->eta *= factor;
    step->dtau *= factor;
}

static double crack_of(const haft_tracker *t, const haft_state *state) {
    return haft_model_crack_length(t->model, t->laws, state->u, t->programme.crack_threshold);
}

static bool target_reached(const walker *w, const haft_state *state) {
    return w->direction > 0 && crack_of(w->t, state) <= w->t->programme.crack_length;
}

/* Shortens a taken step so that it ends where the crack length asked for is just reached. */
static void stop_at_target(walker *w, haft_step *step) {
    double low = 0, high = step->dtau, full = fabs(step->dtau);
    while (fabs(high - low) > 1e-13 * full) {
        step->dtau = 0.5 * (low + high);
        if (step->dtau == low || step->dtau == high) {
            break;
        }
        if (haft_branch_try(w->t, step, w->direction) != HAFT_STEP_TAKEN ||
            !target_reached(w, &w->t->next)) {
            low = step->dtau;
        } else {
            high = step->dtau;
        }
    }
    step->dtau = high;
    haft_branch_try(w->t, step, w->direction);
}

/* Takes the load itself as control to end a step exactly at a load. */
static bool stop_at_load(walker *w, haft_step *step, double load) {
    haft_tracker *t = w->t;
    haft_step direct = *step;
    direct.control = (haft_control){NULL, 0};
    direct.dtau = load - t->here.load;
    direct.sign = direct.dtau > 0 ? 1 : -1;
    size_t bytes = t->n * sizeof(double);
    memcpy(t->rebased.u1, t->start.u1, bytes);
    memcpy(t->rebased.u2, t->start.u2, bytes);
    t->rebased.load1 = t->start.load1;
    t->rebased.load2 = t->start.load2;
    haft_branch_rebase(t, direct.control, &t->start);
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

static void describe_jump(walker *w, haft_jump *jump) {
    haft_tracker *t = w->t;
    double closing = 0;
    for (size_t r = 0; r < t->model->sites; r++) {
        bool before = t->gap_before[r] <= t->reach[r], after = t->gap_after[r] <= t->reach[r];
        jump->sites_switched += before != after;
        closing += t->gap_before[r] - t->gap_after[r];
    }
    jump->kind = closing > 0 ? HAFT_JUMP_PULL_IN : HAFT_JUMP_PULL_OUT;
}

/* From the fold in `here` to where the flow leads; the load stays, its work goes on. */
static haft_outcome jump_from_fold(walker *w, int sign, double fold_defect) {
    haft_tracker *t = w->t;
    haft_jump jump = {.phase = w->phase,
                      .load = t->here.load * t->load_unit,
                      .crack_before = crack_of(t, &t->here),
                      .internal_before = t->here.energy.strain,
                      .fold_defect = fold_defect};
    for (size_t i = 0; i < t->n; i++) {
        t->null[i] *= sign;
    }
    size_t site = 0;
    haft_tracker_move(t, t->here.u, t->null, &site);
    jump.site = (int)site;
    double energy = t->here.energy.strain + t->here.energy.contact;
    double deflection = haft_tracker_row(t, &t->model->load, t->here.u);
    haft_model_gaps(t->model, t->here.u, t->gap_before);
    haft_outcome outcome = haft_flow_land(t, t->null, &jump.flow_steps);
    if (outcome != HAFT_OUTCOME_STUCK) {
        return outcome;
    }
    haft_model_gaps(t->model, t->here.u, t->gap_after);
    double work = t->here.load * t->model->energy_unit *
                  (haft_tracker_row(t, &t->model->load, t->here.u) - deflection);
    jump.dissipated = work + energy - t->here.energy.strain - t->here.energy.contact;
    jump.crack_after = crack_of(t, &t->here);
    jump.internal_after = t->here.energy.strain;
    describe_jump(w, &jump);
    enter_work(w, work, jump.dissipated);
    if (haft_record_jump(w->path, &jump, w->error) != HAFT_OK) {
        w->failed = true;
        return HAFT_OUTCOME_STUCK;
    }
    record(w, (int)w->path->jumps - 1);
    return HAFT_OUTCOME_STUCK;
}

/* Locates the fold behind a step that ended beyond it, books the stretch up to it, and jumps.
 * @return REJECTED if the stretch is too long for its ledger, UNSTABLE if the load's limit comes
 * before the fold, TAKEN otherwise, with the jump's outcome. */
static haft_step_result pass_fold(walker *w, haft_step *step, double limit, haft_outcome *outcome) {
    haft_tracker *t = w->t;
    double fold_defect = 0;
    if (!haft_fold_locate(t, step, w->direction, &fold_defect)) {
        return HAFT_STEP_REJECTED;
    }
    if ((t->next.load - limit) * w->direction >= 0) {
        return HAFT_STEP_UNSTABLE;
    }
    if (fabs(step->defect) > step->allowed) {
        return HAFT_STEP_REJECTED;
    }
    swap_states(t);
    enter_work(w, step->work, 0);
    *outcome = jump_from_fold(w, step->sign, fold_defect);
    return HAFT_STEP_TAKEN;
}

/* One step, or one jump. @return STUCK to go on, FREE when the phase is over, else why it failed.
 */
static haft_outcome advance(walker *w) {
    haft_tracker *t = w->t;
    haft_step step;
    depart(w, &step);
    stop_at_kink(w, &step);
    double limit = w->direction > 0 ? t->programme.load_limit / t->load_unit : 0;
    haft_outcome outcome = HAFT_OUTCOME_STEP_STALLED;
    while (w->eta > LEAST_STEP) {
        haft_step_result result = haft_branch_try(t, &step, w->direction);
        bool past_load = result == HAFT_STEP_TAKEN && (t->next.load - limit) * w->direction >= 0;
        if (result == HAFT_STEP_FOLD) {
            result = pass_fold(w, &step, limit, &outcome);
            if (result == HAFT_STEP_TAKEN) {
                bool over = outcome == HAFT_OUTCOME_STUCK && target_reached(w, &t->here);
                return over ? HAFT_OUTCOME_FREE : outcome;
            }
            past_load = result == HAFT_STEP_UNSTABLE;
        }
        if (past_load) {
            if (stop_at_load(w, &step, limit)) {
                accept(w, &step);
                w->path->turned_by_load |= w->direction > 0;
                return HAFT_OUTCOME_FREE;
            }
        } else if (result == HAFT_STEP_TAKEN) {
            bool over = target_reached(w, &t->next);
            if (over) {
                stop_at_target(w, &step);
            }
            accept(w, &step);
            return over ? HAFT_OUTCOME_FREE : HAFT_OUTCOME_STUCK;
        }
        shrink(w, &step);
    }
    return outcome;
}

/* Follows one phase to its end. @return STUCK when it ended as asked. */
static haft_outcome follow(walker *w) {
    for (;;) {
        if (w->failed) {
            return HAFT_OUTCOME_STUCK;
        }
        if (w->t->cost.steps + w->t->cost.flow_steps > w->t->options.step_limit) {
            return HAFT_OUTCOME_STEP_LIMIT;
        }
        haft_outcome outcome = advance(w);
        if (outcome == HAFT_OUTCOME_FREE) {
            return HAFT_OUTCOME_STUCK;
        }
        if (outcome != HAFT_OUTCOME_STUCK) {
            return outcome;
        }
    }
}

static bool touches(const haft_tracker *t) {
    for (size_t r = 0; r < t->model->sites; r++) {
        double d = t->model->gap - haft_model_displacement(&t->model->site[r], t->here.u);
        if (d <= t->reach[r]) {
            return true;
        }
    }
    return false;
}

static haft_outcome walk(walker *w) {
    haft_tracker *t = w->t;
    haft_control load = {NULL, 0};
    if (!haft_corrector_solve(t, load, 0, &t->here)) {
        return HAFT_OUTCOME_NOT_FINITE;
    }
    if (haft_branch_certify(t).negative != 0) {
        return HAFT_OUTCOME_STEP_STALLED;
    }
    w->ledger.energy_start = t->here.energy.strain + t->here.energy.contact;
    record(w, -1);
    w->eta = t->options.gap_step;
    haft_outcome outcome = follow(w);
    w->path->turn = w->path->points > 0 ? w->path->points - 1 : 0;
    if (outcome != HAFT_OUTCOME_STUCK || w->failed) {
        return outcome;
    }
    w->phase = 1;
    w->direction = -1;
    outcome = follow(w);
    if (outcome != HAFT_OUTCOME_STUCK) {
        return outcome;
    }
    return touches(t) ? HAFT_OUTCOME_STUCK : HAFT_OUTCOME_FREE;
}

haft_status haft_solve_path(haft_path **out, const haft_model *model, const haft_law *laws,
                            const haft_programme *programme, const haft_path_options *options,
                            haft_error *error) {
    *out = NULL;
    if (!(programme->crack_threshold > 0 && programme->crack_threshold < 1)) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT, "the crack threshold %g is not in (0, 1)",
                              programme->crack_threshold);
    }
    walker w = {.phase = 0, .direction = 1, .error = error};
    haft_status status = haft_tracker_create(&w.t, model, laws, programme, options, error);
    if (status != HAFT_OK) {
        return status;
    }
    w.path = haft_memory_alloc(1, sizeof *w.path, error);
    if (w.path == NULL) {
        haft_tracker_destroy(&w.t);
        return HAFT_ERROR_MEMORY;
    }
    w.path->outcome = walk(&w);
    status = w.failed ? HAFT_ERROR_MEMORY : haft_record_finish(w.path, w.t, &w.ledger, error);
    haft_tracker_destroy(&w.t);
    if (status != HAFT_OK) {
        haft_path_destroy(&w.path);
    }
    *out = w.path;
    return status;
}
