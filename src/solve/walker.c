/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What steps and jumps share: the two states, the energy ledger, the record, and the mesh in use.
 */
#include "walker.h"
#include "active_mesh.h"
#include "branch.h"

#include <math.h>

/* Relative tolerance of the crack length asked for. The tip rests at borders of patches, and
 * rounding must not miss a length asked for there. */
#define CRACK_TOLERANCE 1e-9

/* Freeze sites that move by less than STILL_SHARE of the largest move, except for SPARE_SITES, if
 * at most STILL_MOST of the unknowns remain; freeze more later if that gains WORTH_SITES. */
#define STILL_SHARE 1e-10
#define STILL_MOST 0.85
enum { SPARE_SITES = 8, WORTH_SITES = 32 };

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

double haft_walker_crack_residual(const haft_walker *w, haft_state *state) {
    return haft_tracker_crack(w->t, state) -
           w->t->problem.programme.crack_length * (1 + CRACK_TOLERANCE);
}

bool haft_walker_reached(const haft_walker *w, haft_state *state) {
    return w->direction > 0 && haft_walker_crack_residual(w, state) <= 0;
}

/* Certifies `here` on the mesh just entered. */
static void settle(haft_walker *w) {
    haft_branch_certify(w->t);
    w->arrived = false;
}

void haft_walker_unfreeze(haft_walker *w) {
    haft_active_mesh_unfreeze(w->t, &w->t->here);
    settle(w);
}

bool haft_walker_widen(haft_walker *w) {
    haft_tracker *t = w->t;
    if (haft_active_mesh_is_frozen(t) && haft_active_mesh_is_clear(t, t->next.u)) {
        haft_walker_unfreeze(w);
        return true;
    }
    if (!haft_active_mesh_widen(t, &t->here, t->next.u)) {
        return false;
    }
    settle(w);
    return true;
}

/* Freezes the part that the load hardly moves at `here`, just certified, if that is much of the
 * mesh and more than is frozen already. */
static void hold(haft_walker *w) {
    haft_tracker *t = w->t;
    bool held = haft_active_mesh_is_frozen(t);
    size_t sites = haft_tracker_stirred(t, STILL_SHARE) + SPARE_SITES;
    if (held && sites + WORTH_SITES > haft_mesh_of(t)->sites) {
        return;
    }
    if (!haft_active_mesh_freeze(t, &t->here, &t->next, sites, STILL_MOST)) {
        if (held) {
            haft_walker_unfreeze(w);
        }
    } else if (!w->arrived) {
        haft_branch_certify(t);
    }
}

void haft_walker_narrow(haft_walker *w, const double *before) {
    if (haft_active_mesh_narrow(w->t, &w->t->here, before)) {
        settle(w);
    }
    hold(w);
}
