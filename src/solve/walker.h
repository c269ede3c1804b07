/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The continuation driver's state: tracker, record and energy ledger. Private to the room. */
#ifndef HAFT_SOLVE_WALKER_H
#define HAFT_SOLVE_WALKER_H

#include "record.h"

typedef struct haft_walker {
    haft_tracker *t;
    haft_path *path;
    haft_ledger ledger;
    int phase, direction; /* of the load: 1 up, -1 down */
    double step_size;     /* of the next step, scaled */
    bool arrived;         /* t->end holds the derivatives at `here`, the same on both sides */
    bool failed;          /* out of memory: `error` says so */
    haft_error *error;
} haft_walker;

/* Swaps `next` and `here`. */
void haft_walker_swap(haft_tracker *t);

/* Enters work and dissipation [J] into the ledger, and `here` into the path. */
void haft_walker_book(haft_walker *w, double work, double dissipated);
void haft_walker_record(haft_walker *w, int jump);

/* Moves `here` to a mesh long enough for `next`, or unfreezes (false: neither is possible); moves
 * it to a shorter mesh if that is enough, coming from u = `before` (NULL: at rest), and freezes
 * what does not move; or only unfreezes. `here` is then certified on the mesh in use. */
bool haft_walker_widen(haft_walker *w);
void haft_walker_narrow(haft_walker *w, const double *before);
void haft_walker_unfreeze(haft_walker *w);

/* The crack length of a state above the one asked for, and whether that ends the loading. */
double haft_walker_crack_residual(const haft_walker *w, haft_state *state);
bool haft_walker_reached(const haft_walker *w, haft_state *state);

/* ---- step.c ---- */

/* Takes one step, or one jump. @return STUCK to go on, FREE when the phase is over, else the
 * failure. */
haft_outcome haft_walker_advance(haft_walker *w);

/* ---- jump.c ---- */

/* Locates the fold that a step has passed: `next` is then the fold, and the step ends there.
 * @return REJECTED if it could not be located or the ledger is off by more than allowed, UNSTABLE
 * if the load limit comes before it, else TAKEN. */
haft_step_result haft_jump_locate_fold(haft_walker *w, haft_step *step, double limit,
                                       double *defect);

/* Accounts for the step up to the fold in `next`, and jumps. */
haft_outcome haft_jump_at_fold(haft_walker *w, const haft_step *step, double defect);

/* Jumps from a bifurcation, where stability is lost although the load does not turn: `next` is a
 * state just beyond it. */
haft_outcome haft_jump_at_bifurcation(haft_walker *w, const haft_step *step);

/* Jumps from a multiple fold, where several eigenvalues vanish at once: `here` is the last state
 * that was reached. */
haft_outcome haft_jump_at_multiple_fold(haft_walker *w, const haft_step *step);

/* Begins the path: follows the gradient flow from u = 0 without load. That is a jump if the flow
 * takes a step. `here` is then certified, and recorded if it was a jump. */
haft_outcome haft_jump_from_rest(haft_walker *w);

#endif
