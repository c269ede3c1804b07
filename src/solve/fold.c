/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A fold is where dP/dtau = 0 on the branch followed by the control: there the null vector of H is
 * du/dtau, and the bordered matrix is regular. The root is found by Newton on dP/dtau, whose slope
 * P'' comes with the branch's second derivatives, kept inside a bracket that is halved
 * whenever Newton leaves it or the rate has not fallen to half. P is stationary at the root, so the
 * fold's load is twice as exact as its place. */
#include "tracker.h"

#include <math.h>
#include <string.h>

enum { FOLD_ITERATIONS = 60 };

/* The root counts as found when |dP/dtau| has fallen to this share of the branch's own. */
#define FOLD_TOLERANCE 1e-10

typedef struct bracket {
    double stable, beyond; /* dtau from `here` on both sides of the fold */
    double slope;          /* |dP/dtau| on the stable side at the start */
} bracket;

/* Solves for the branch at dtau; t->next and t->end hold it. */
static bool evaluate_at(haft_tracker *t, haft_step *step, double dtau, haft_inertia *inertia) {
    for (size_t i = 0; i < t->n; i++) {
        t->next.u[i] = t->here.u[i] + dtau * (t->start.u1[i] + 0.5 * dtau * t->start.u2[i]);
    }
    t->next.load = t->here.load + dtau * (t->start.load1 + 0.5 * dtau * t->start.load2);
    double value = haft_control_value(t, step->control, &t->here) + dtau;
    if (!haft_corrector_solve(t, step->control, value, &t->next)) {
        return false;
    }
    *inertia = haft_branch_certify(t, t->next.u);
    if (inertia->negative < 0) {
        return false;
    }
    haft_branch_derive(t, &t->next, step->control, -step->sign, &t->end);
    return isfinite(t->end.load1) && isfinite(t->end.load2);
}

static double next_guess(const haft_tracker *t, const bracket *b, double dtau, bool gaining) {
    double newton = dtau - t->end.load1 / t->end.load2;
    double low = fmin(b->stable, b->beyond), high = fmax(b->stable, b->beyond);
    return gaining && newton > low && newton < high ? newton : 0.5 * (b->stable + b->beyond);
}

bool haft_fold_locate(haft_tracker *t, haft_step *step, int direction, double *defect) {
    bracket b = {0, step->dtau, fabs(t->start.load1)};
    double length = fabs(step->dtau);
    double dtau = step->dtau - t->end.load1 / t->end.load2;
    if (!(dtau * step->sign > 0 && fabs(dtau) < length)) {
        dtau = 0.5 * step->dtau;
    }
    double last = INFINITY;
    t->cost.folds++;
    for (int i = 0; i < FOLD_ITERATIONS; i++) {
        haft_inertia inertia;
        if (!evaluate_at(t, step, dtau, &inertia)) {
            return false;
        }
        double slope = t->end.load1 * step->sign * direction;
        if (slope > 0) {
            b.stable = dtau;
        } else {
            b.beyond = dtau;
        }
        *defect = fabs(slope) / b.slope;
        if (*defect < FOLD_TOLERANCE || fabs(b.beyond - b.stable) < 1e-14 * length) {
            memcpy(t->null, t->end.u1, t->n * sizeof(double));
            step->dtau = dtau;
            haft_branch_book(t, step);
            return true;
        }
        dtau = next_guess(t, &b, dtau, *defect < 0.5 * last);
        last = *defect;
    }
    return false;
}
