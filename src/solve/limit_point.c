/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Locates a fold, where dP/dtau = 0 along the branch. There the null vector of H is du/dtau, and
 * the bordered matrix is regular. Newton's method on dP/dtau takes P'' from the branch's second
 * derivatives, within a bracket that is halved whenever Newton leaves it or the rate does not fall
 * to half. P is stationary at the root, so its load is twice as exact as its place. */
#include "limit_point.h"
#include "corrector.h"

#include <math.h>
#include <string.h>

enum { FOLD_ITERATIONS = 60 };

/* The root is found when |dP/dtau| has fallen to this share of its value at the start, or when
 * Newton would move it by less than this share of the step; the change of the load is the square of
 * that. Rounding of the rate would not allow a smaller share: Newton would count as failed, and the
 * whole bracket would be bisected. */
#define FOLD_TOLERANCE 1e-10
#define PLACE_TOLERANCE 1e-6

typedef struct bracket {
    double stable, beyond; /* dtau from `here` before and beyond the fold */
} bracket;

/* Solves for the branch at dtau; t->next and t->end hold it. */
static bool evaluate_at(haft_tracker *t, haft_step *step, double dtau, haft_inertia *inertia) {
    haft_branch_predict(t, dtau);
    double value = haft_parameter_value(t, step->parameter, &t->here) + dtau;
    if (!haft_corrector_solve(t, step->parameter, value, &t->next)) {
        return false;
    }
    *inertia = haft_branch_certify(t);
    if (inertia->negative < 0) {
        return false;
    }
    haft_branch_derive(t, &t->next, step->parameter, -step->sign, &t->end);
    return isfinite(t->end.load1) && isfinite(t->end.load2);
}

static double next_guess(const haft_tracker *t, const bracket *b, double dtau, bool gaining) {
    double newton = dtau - t->end.load1 / t->end.load2;
    double low = fmin(b->stable, b->beyond), high = fmax(b->stable, b->beyond);
    return gaining && newton > low && newton < high ? newton : 0.5 * (b->stable + b->beyond);
}

static bool is_found(const haft_tracker *t, const bracket *b, double defect, double length) {
    return defect < FOLD_TOLERANCE ||
           fabs(t->end.load1) <= PLACE_TOLERANCE * length * fabs(t->end.load2) ||
           fabs(b->beyond - b->stable) < 1e-14 * length;
}

bool haft_limit_point_locate(haft_tracker *t, haft_step *step, int direction, double *defect) {
    bracket b = {0, step->dtau};
    double length = fabs(step->dtau), last = INFINITY;
    double dtau = next_guess(t, &b, step->dtau, true);
    t->cost.folds++;
    for (int i = 0; i < FOLD_ITERATIONS; i++) {
        haft_inertia inertia;
        if (!evaluate_at(t, step, dtau, &inertia)) {
            return false;
        }
        *(t->end.load1 * step->sign * direction > 0 ? &b.stable : &b.beyond) = dtau;
        *defect = fabs(t->end.load1 / t->start.load1);
        if (is_found(t, &b, *defect, length)) {
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
