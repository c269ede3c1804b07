/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Jumps: from the end of a branch to where the gradient flow leads, at constant load.
 *
 * Most branches end in a simple fold. There are two other ends. A fixed rule decides how to leave
 * them, so that the answer is the same on every machine.
 *
 * Bifurcation: an eigenvalue vanishes although the load does not turn, as in a pitchfork of two
 * like sites. The flow starts just beyond it along the null vector, to the side of lower energy. If
 * both are equal, to the side where the first of the gaps that move most closes in loading or opens
 * in unloading.
 *
 * Multiple fold: several eigenvalues vanish at once, as for like sites far apart. The flow starts
 * in the direction of the last motion, which contains all null vectors in the shares that the load
 * gives them.
 *
 * A path also begins with a jump where the laws pull the unloaded beam from its place. */
#include "active_mesh.h"
#include "landing.h"
#include "limit_point.h"
#include "walker.h"

#include <math.h>
#include <string.h>

static void describe_jump(haft_walker *w, haft_jump *jump) {
    haft_tracker *t = w->t;
    double closing = 0, *gap = t->work.site[0];
    haft_model_gaps(t->model, t->here.u, gap);
    for (size_t r = haft_model_get(t->problem.whole)->inert;
         r < haft_model_get(t->problem.whole)->sites; r++) {
        bool before = t->gap_before[r] <= t->problem.reach[r],
             after = gap[r] <= t->problem.reach[r];
        jump->sites_switched += before != after;
        closing += t->gap_before[r] - gap[r];
    }
    jump->kind = closing > 0 ? HAFT_JUMP_PULL_IN : HAFT_JUMP_PULL_OUT;
}

/* Follows the flow from `here` along `away` (NULL: by the forces). The load stays constant, and its
 * work is accounted for. t->null decides which site moves most. */
static haft_outcome jump_from_here(haft_walker *w, haft_departure departure, const double *away,
                                   double fold_defect) {
    haft_tracker *t = w->t;
    haft_active_mesh_enter(t, t->at); /* a jump may move what was frozen on the branch */
    haft_jump jump = {.phase = w->phase,
                      .load = t->here.load * t->problem.load_unit,
                      .crack_before = haft_tracker_crack(t, &t->here),
                      .internal_before = t->here.energy.strain,
                      .departure = departure,
                      .fold_defect = fold_defect};
    size_t site = 0;
    haft_tracker_scaled_displacement(t, t->here.gap, t->null, &site);
    jump.site = (int)site;
    double energy = t->here.energy.strain + t->here.energy.contact;
    double deflection = haft_tracker_row(t, &haft_mesh_of(t)->load, t->here.u);
    haft_model_gaps(t->model, t->here.u, t->gap_before);
    size_t at = t->at;
    haft_outcome outcome = haft_landing_follow(t, away, &jump.flow_steps);
    if (outcome != HAFT_OUTCOME_STUCK) {
        haft_active_mesh_enter(t, at);
        return outcome;
    }
    if (departure != HAFT_DEPARTURE_FOLD) { /* shorter and shorter steps led there */
        w->step_size = t->problem.options.gap_step;
    }
    if (departure == HAFT_DEPARTURE_REST && jump.flow_steps == 0) {
        return HAFT_OUTCOME_STUCK; /* no jump */
    }
    double work = t->here.load * haft_mesh_of(t)->energy_unit *
                  (haft_tracker_row(t, &haft_mesh_of(t)->load, t->here.u) - deflection);
    jump.dissipated = work + energy - t->here.energy.strain - t->here.energy.contact;
    jump.crack_after = haft_tracker_crack(t, &t->here);
    jump.internal_after = t->here.energy.strain;
    describe_jump(w, &jump);
    haft_walker_book(w, work, jump.dissipated);
    if (haft_record_jump(w->path, &jump, w->error) != HAFT_OK) {
        w->failed = true;
        return HAFT_OUTCOME_STUCK;
    }
    haft_walker_record(w, (int)w->path->jumps - 1);
    haft_walker_narrow(w, NULL);
    return HAFT_OUTCOME_STUCK;
}

/* Whether the part of the step up to the fold will miss more energy than allowed, estimated from
 * the defect of the whole step and the secant of the load's rate. */
static bool is_too_long(const haft_tracker *t, const haft_step *step) {
    double share = t->start.load1 / (t->start.load1 - t->end.load1);
    double order = haft_branch_defect_order(t, step->parameter);
    return fabs(step->defect) * pow(share, order) > step->allowed;
}

haft_step_result haft_jump_locate_fold(haft_walker *w, haft_step *step, double limit,
                                       double *defect) {
    haft_tracker *t = w->t;
    if (is_too_long(t, step) || !haft_limit_point_locate(t, step, w->direction, defect)) {
        return HAFT_STEP_REJECTED;
    }
    if ((t->next.load - limit) * w->direction >= 0) {
        return HAFT_STEP_UNSTABLE;
    }
    return fabs(step->defect) > step->allowed ? HAFT_STEP_REJECTED : HAFT_STEP_TAKEN;
}

haft_outcome haft_jump_at_fold(haft_walker *w, const haft_step *step, double defect) {
    haft_tracker *t = w->t;
    haft_walker_swap(t);
    haft_walker_book(w, step->work, 0);
    for (size_t i = 0; i < t->n; i++) {
        t->null[i] *= step->sign;
    }
    return jump_from_here(w, HAFT_DEPARTURE_FOLD, t->null, defect);
}

/* Pi at the load of `here`, at here + amplitude * null. */
static double energy_beside(haft_tracker *t, double amplitude) {
    memcpy(t->spare.u, t->here.u, haft_model_get(t->mesh[t->at].model)->dofs * sizeof(double));
    for (size_t i = 0; i < t->n; i++) {
        t->spare.u[i] = t->here.u[i] + amplitude * t->null[i];
    }
    t->spare.load = t->here.load;
    t->spare.energy = haft_tracker_energy(t, t->spare.u);
    return haft_tracker_potential(t, &t->spare);
}

/* The sign by which the first of the gaps that move most closes in loading, opens in unloading. */
static int conventional_sign(const haft_walker *w) {
    const haft_tracker *t = w->t;
    double most = haft_tracker_scaled_displacement(t, t->here.gap, t->null, NULL);
    for (size_t r = haft_mesh_of(t)->inert; r < haft_mesh_of(t)->sites; r++) {
        double closing = haft_model_displacement(&haft_mesh_of(t)->site[r], t->null);
        if (fabs(closing) / haft_length(&t->problem.lengths, r, t->here.gap[r]) > 0.999 * most) {
            return closing * w->direction > 0 ? 1 : -1;
        }
    }
    return 1;
}

haft_outcome haft_jump_at_bifurcation(haft_walker *w, const haft_step *step) {
    haft_tracker *t = w->t;
    haft_walker_swap(t);
    haft_walker_book(w, step->work, 0);
    for (int i = 0; i < 10; i++) {
        haft_branch_least_eigenvalue(t);
    }
    memcpy(t->null, t->mode, t->n * sizeof(double));
    double amplitude =
        HAFT_DEPARTURE_MOVE / haft_tracker_scaled_displacement(t, t->here.gap, t->null, NULL);
    double forth = energy_beside(t, amplitude), back = energy_beside(t, -amplitude);
    double alike = haft_tracker_rounding(&t->here, &t->here) +
                   1e-3 * fabs(forth + back - 2 * energy_beside(t, 0));
    int sign = fabs(forth - back) <= alike ? conventional_sign(w) : forth < back ? 1 : -1;
    for (size_t i = 0; i < t->n; i++) {
        t->null[i] *= sign;
    }
    return jump_from_here(w, HAFT_DEPARTURE_BIFURCATION, t->null, 0);
}

haft_outcome haft_jump_at_multiple_fold(haft_walker *w, const haft_step *step) {
    haft_tracker *t = w->t;
    if (!haft_tracker_evaluate(t, t->here.u, t->here.load, &t->here.energy, NULL)) {
        return HAFT_OUTCOME_NOT_FINITE;
    }
    for (size_t i = 0; i < t->n; i++) {
        t->null[i] = step->sign * t->start.u1[i];
    }
    double amplitude =
        HAFT_DEPARTURE_MOVE / haft_tracker_scaled_displacement(t, t->here.gap, t->null, NULL);
    if (!(energy_beside(t, amplitude) < energy_beside(t, 0))) {
        return step->failure; /* the branch does not end here */
    }
    return jump_from_here(w, HAFT_DEPARTURE_MULTIPLE_FOLD, t->null, 0);
}

haft_outcome haft_jump_from_rest(haft_walker *w) {
    haft_tracker *t = w->t;
    if (!haft_tracker_visit(t, &t->here)) {
        return HAFT_OUTCOME_NOT_FINITE;
    }
    w->ledger.energy_start = t->here.energy.strain + t->here.energy.contact;
    for (size_t i = 0; i < t->n; i++) {
        t->null[i] = -t->gradient[i];
    }
    return jump_from_here(w, HAFT_DEPARTURE_REST, NULL, 0);
}
