/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The programme: load to the crack length asked for, unload to nothing, jump by jump. */
#include "walker.h"

#include <math.h>

/* A crack is as short as asked within this share: its tip rests at the borders of patches for a
 * while, and a length asked for there must not be missed by rounding. */
#define CRACK_TOLERANCE 1e-9

/* Sites that move by less than this share of the most are held, but for a few, if no more than such
 * a share of the unknowns is left to move; and later more of them, if that is worth it. */
#define STILL_SHARE 1e-10
#define STILL_MOST 0.85
enum { SPARE_SITES = 8, WORTH_SITES = 32 };

/* A wall pressed in by so many ranges more than the gap is pressed through. */
#define DEEP_RANGES 100

void haft_walker_swap(haft_tracker *t) {
    haft_state state = t->here;
    t->here = t->next;
    t->next = state;
}

void haft_walker_book(haft_walker *w, double work, double dissipated) {
    w->ledger.work += work;
    w->ledger.turnover += fabs(work);
    w->ledger.dissipated += dissipated;
}

void haft_walker_record(haft_walker *w, int jump) {
    if (haft_record_point(w->path, w->t, &w->ledger, w->phase, jump, w->error) != HAFT_OK) {
        w->failed = true;
    }
    w->t->not_finite = 0;
}

double haft_walker_excess(const haft_walker *w, haft_state *state) {
    return haft_tracker_crack(w->t, state) - w->t->programme.crack_length * (1 + CRACK_TOLERANCE);
}

bool haft_walker_reached(const haft_walker *w, haft_state *state) {
    return w->direction > 0 && haft_walker_excess(w, state) <= 0;
}

/* `here` on the mesh just entered. */
static void settle(haft_walker *w) {
    haft_branch_certify(w->t);
    w->arrived = false;
}

void haft_walker_unfreeze(haft_walker *w) {
    haft_zone_unfreeze(w->t, &w->t->here);
    settle(w);
}

bool haft_walker_widen(haft_walker *w) {
    haft_tracker *t = w->t;
    if (haft_zone_is_frozen(t) && haft_zone_is_clear(t, t->next.u)) {
        haft_walker_unfreeze(w);
        return true;
    }
    if (!haft_zone_widen(t, &t->here, t->next.u)) {
        return false;
    }
    settle(w);
    return true;
}

/* Holds what hardly moves with the load at `here`, just certified, where that is much of the mesh,
 * or more than is held already. */
static void hold(haft_walker *w) {
    haft_tracker *t = w->t;
    bool held = haft_zone_is_frozen(t);
    size_t sites = haft_tracker_stirred(t, STILL_SHARE) + SPARE_SITES;
    if (held && sites + WORTH_SITES > t->model->sites) {
        return;
    }
    if (!haft_zone_freeze(t, &t->here, &t->next, sites, STILL_MOST)) {
        if (held) {
            haft_walker_unfreeze(w);
        }
    } else if (!w->arrived) {
        haft_branch_certify(t);
    }
}

void haft_walker_narrow(haft_walker *w, const double *before) {
    if (haft_zone_narrow(w->t, &w->t->here, before)) {
        settle(w);
    }
    hold(w);
}

/* Whether the load, which nothing limits, presses a wall in deeper than the gap is high: it will
 * not reach the crack length asked for. */
static bool is_pressed_through(const haft_walker *w) {
    const haft_tracker *t = w->t;
    if (w->direction < 0 || isfinite(t->programme.load_limit)) {
        return false;
    }
    for (size_t r = t->model->inert; r < t->model->sites; r++) {
        if (t->wall[r] - t->here.gap[r] > t->whole->gap + DEEP_RANGES * t->range[r]) {
            return true;
        }
    }
    return false;
}

/* Follows one phase to its end. @return STUCK when it ended as asked. */
static haft_outcome follow(haft_walker *w) {
    for (;;) {
        if (w->failed) {
            return HAFT_OUTCOME_STUCK;
        }
        if (w->t->cost.steps + w->t->cost.flow_steps > w->t->options.step_limit) {
            return HAFT_OUTCOME_STEP_LIMIT;
        }
        if (is_pressed_through(w)) {
            return HAFT_OUTCOME_CRACK_UNREACHED;
        }
        haft_outcome outcome = haft_walker_advance(w);
        if (outcome != HAFT_OUTCOME_STUCK && outcome != HAFT_OUTCOME_FREE && w->t->not_finite > 0) {
            return HAFT_OUTCOME_NOT_FINITE; /* that is what the step could not get past */
        }
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

static haft_outcome walk(haft_walker *w) {
    haft_tracker *t = w->t;
    haft_outcome outcome = haft_jump_from_rest(w);
    if (outcome != HAFT_OUTCOME_STUCK || w->failed) {
        return t->not_finite > 0 ? HAFT_OUTCOME_NOT_FINITE : outcome;
    }
    t->needs_refinement = haft_branch_loses_digits(t);
    haft_branch_certify(t);
    if (w->path->points == 0) { /* no jump */
        w->ledger.energy_start = t->here.energy.strain + t->here.energy.contact;
        haft_walker_record(w, -1);
    }
    w->step_size = t->options.gap_step;
    if (!haft_walker_reached(w, &t->here)) { /* it may be, at rest */
        outcome = follow(w);
    }
    w->path->turn = w->path->points > 0 ? w->path->points - 1 : 0;
    if (outcome != HAFT_OUTCOME_STUCK || w->failed) {
        return outcome;
    }
    w->phase = 1;
    w->direction = -1;
    if (t->here.load > 0) {
        outcome = follow(w);
    }
    haft_zone_enter(t, t->at);
    if (outcome != HAFT_OUTCOME_STUCK) {
        return outcome;
    }
    return touches(t) ? HAFT_OUTCOME_STUCK : HAFT_OUTCOME_FREE;
}

static haft_status check_programme(const haft_programme *programme, haft_error *error) {
    if (!(programme->crack_threshold > 0 && programme->crack_threshold < 1)) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT, "the crack threshold %g is not in (0, 1)",
                              programme->crack_threshold);
    }
    if (!(programme->load_limit > 0)) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                              "the load limit %g N is not positive; INFINITY stands for none",
                              programme->load_limit);
    }
    double length = programme->crack_length;
    if (!isfinite(length) || (!(length > 0) && isinf(programme->load_limit))) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                              "the crack length %g m to load to is not positive, and no load limit "
                              "ends the loading",
                              length);
    }
    return HAFT_OK;
}

haft_status haft_solve_path(haft_path **out, const haft_model *model, const haft_law *laws,
                            const haft_programme *programme, const haft_path_options *options,
                            haft_error *error) {
    *out = NULL;
    haft_status checked = check_programme(programme, error);
    if (checked != HAFT_OK) {
        return checked;
    }
    haft_walker w = {.phase = 0, .direction = 1, .error = error};
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
