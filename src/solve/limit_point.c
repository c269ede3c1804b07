/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A fold is where dP/dtau = 0 on the branch followed by the parameter: there the null vector of H
 * is du/dtau, and the bordered matrix is regular. The root is found by Newton on dP/dtau, whose
 * slope P'' comes with the branch's second derivatives, kept inside a bracket that is halved
 * whenever Newton leaves it or the rate has not fallen to half. P is stationary at the root, so the
 * fold's load is twice as exact as its place. */
#include "limit_point.h"
#include "corrector.h"

#include <math.h>
#include <string.h>

enum { FOLD_ITERATIONS = 60 };

/* The root counts as found when |dP/dtau| has fallen to this share of the branch's own, or when
 * Newton would move its place by less than this share of the step: of the load that is the square,
 * nothing. Rounding in the rate keeps a smaller share from coming true, and then Newton, taken to
 * have failed, gives way to bisection of the whole bracket. */
#define FOLD_TOLERANCE 1e-10
#define PLACE_TOLERANCE 1e-6

typedef struct bracket {
    double stable, beyond; /* dtau from `here` on both sides of the fold */
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
