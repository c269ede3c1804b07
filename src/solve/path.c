/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The continuation driver: loads to the crack length asked for, then unloads to zero. */
#include "active_mesh.h"
#include "branch.h"
#include "walker.h"

#include <math.h>

/* A wall pressed in deeper than the gap by so many ranges counts as pressed through. */
#define DEEP_RANGES 100

/* Whether an unlimited load presses a wall in deeper than the gap is high: then it will never reach
 * the crack length asked for. */
static bool is_pressed_through(const haft_walker *w) {
    const haft_tracker *t = w->t;
    if (w->direction < 0 || isfinite(t->problem.programme.load_limit)) {
        return false;
    }
    for (size_t r = haft_mesh_of(t)->inert; r < haft_mesh_of(t)->sites; r++) {
        if (t->problem.lengths.wall[r] - t->here.gap[r] >
            haft_model_get(t->problem.whole)->gap + DEEP_RANGES * t->problem.lengths.range[r]) {
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
        if (w->t->cost.steps + w->t->cost.flow_steps > w->t->problem.options.step_limit) {
            return HAFT_OUTCOME_STEP_LIMIT;
        }
        if (is_pressed_through(w)) {
            return HAFT_OUTCOME_CRACK_UNREACHED;
        }
        haft_outcome outcome = haft_walker_advance(w);
        if (outcome != HAFT_OUTCOME_STUCK && outcome != HAFT_OUTCOME_FREE && w->t->not_finite > 0) {
            return HAFT_OUTCOME_NOT_FINITE; /* which stopped the step */
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
    for (size_t r = 0; r < haft_mesh_of(t)->sites; r++) {
        double d =
            haft_mesh_of(t)->gap - haft_model_displacement(&haft_mesh_of(t)->site[r], t->here.u);
        if (d <= t->problem.reach[r]) {
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
    w->step_size = t->problem.options.gap_step;
    if (!haft_walker_reached(w, &t->here)) { /* at rest the crack may be short enough */
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
    haft_active_mesh_enter(t, t->at);
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
    HAFT_TRY(haft_tracker_create(&w.t, model, laws, programme, options, error));
    w.path = haft_memory_alloc(1, sizeof *w.path, error);
    if (w.path == NULL) {
        haft_tracker_destroy(&w.t);
        return HAFT_ERROR_MEMORY;
    }
    w.path->outcome = walk(&w);
    haft_status status =
        w.failed ? HAFT_ERROR_MEMORY : haft_record_finish(w.path, w.t, &w.ledger, error);
    haft_tracker_destroy(&w.t);
    if (status != HAFT_OK) {
        haft_path_destroy(&w.path);
    }
    *out = w.path;
    return status;
}
