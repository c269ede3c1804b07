/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A path being walked: tracker, record and ledger together. Private to the room. */
#ifndef HAFT_SOLVE_WALKER_H
#define HAFT_SOLVE_WALKER_H

#include "record.h"

typedef struct haft_walker {
    haft_tracker *t;
    haft_path *path;
    haft_ledger ledger;
    int phase, direction; /* of the load: 1 up, -1 down */
    double eta;           /* size of the next step, in lengths */
    bool arrived;         /* t->end holds the derivatives at `here`, on either side alike */
    bool failed;          /* out of memory: `error` says so */
    haft_error *error;
} haft_walker;

/* `next` becomes `here`. */
void haft_walker_swap(haft_tracker *t);

/* Enters work and dissipation [J] into the ledger, and `here` into the path. */
void haft_walker_book(haft_walker *w, double work, double dissipated);
void haft_walker_record(haft_walker *w, int jump);

/* Goes over to a mesh wide enough for `next`, or lets go what is held of this one (false: neither
 * is possible); goes over to a narrower one if that is enough for `here`, coming from u = `before`
 * (NULL: at rest), and holds what does not move; or just lets go what is held. `here` is certified
 * on what is then in use. */
bool haft_walker_widen(haft_walker *w);
void haft_walker_narrow(haft_walker *w, const double *before);
void haft_walker_let_go(haft_walker *w);

/* By how much a state's crack exceeds the one asked for, and whether it ends the loading. */
double haft_walker_excess(const haft_walker *w, haft_state *state);
bool haft_walker_reached(const haft_walker *w, haft_state *state);

/* ---- step.c ---- */

/* One step, or one jump. @return STUCK to go on, FREE when the phase is over, else why it failed.
 */
haft_outcome haft_walker_advance(haft_walker *w);

/* ---- jump.c ---- */

/* Locates the fold behind a step that ended beyond it: it is then in `next`, and the step that up
 * to it. @return REJECTED if it could not be located or the stretch is too long for its ledger,
 * UNSTABLE if the load's limit comes before it, TAKEN otherwise. */
haft_step_result haft_jump_locate_fold(haft_walker *w, haft_step *step, double limit,
                                       double *defect);

/* Books the stretch up to the fold located in `next`, and jumps. */
haft_outcome haft_jump_at_fold(haft_walker *w, const haft_step *step, double defect);

/* Leaves a branch where it loses its stability though its load does not turn: `next` holds a state
 * just beyond. */
haft_outcome haft_jump_at_bifurcation(haft_walker *w, const haft_step *step);

/* Leaves a branch that ends in more than one null vector at once: `here` is its last state that
 * could be reached. */
haft_outcome haft_jump_at_crowded_fold(haft_walker *w, const haft_step *step);

/* Begins the path: from u = 0 without load to where the flow leads, as a jump if it makes any
 * steps. `here` is then certified, and recorded if it was a jump. */
haft_outcome haft_jump_from_rest(haft_walker *w);

#endif
