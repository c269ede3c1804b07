/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One step along a stable branch.
 *
 * Predictor: the branch's first two derivatives. Corrector: KINSOL at the new value of the
 * parameter. Certificate: the pivots of H. Ledger: the energy gained must equal the work of the
 * load, integrated from the derivatives at both ends (quintic, error O(dtau^7)). The ledger bounds
 * the step size; a step that hops to another branch misses energy in it. */
#include "branch.h"
#include "active_mesh.h"
#include "corrector.h"

#include <math.h>
#include <string.h>

/* A step within which the load's rate falls below DIP_SHARE of the rate at its ends is cut where
 * the rate is least, unless that is close to an end. */
#define DIP_SHARE 0.5
#define DIP_EDGE 0.04

/* Steps shorter than this, scaled, are not examined: only rounding of the rates would show. */
#define DIP_STEP 1e-4

/* Relative error of solutions by the factor alone above which they are refined: with elements
 * shorter than about a two-hundredth of the beam. */
#define LOST_DIGITS 1e-9

/* Accuracy of second derivatives: they are a small part of a step's work, which the ledger asks for
 * to 1e-10. */
#define ENOUGH_OF_SECOND 1e-12

/* Share of the ledger's remaining allowance that one step may use. */
#define SPENT 0.2

/* Largest numbers of steps of iterative refinement and of inverse iteration. */
enum { REFINEMENTS = 6, EIGEN_SWEEPS = 3 };

/* Largest residual at the frozen node, as a share of the corrector's tolerance: then a state with a
 * frozen part is an equilibrium of the whole. */
#define UNBALANCE_SHARE 0.1

/* Offset from a kink, in ranges, at which a law's curvature is read. */
#define KINK_OFFSET 1e-7

static double greatest(const double *v, size_t n) {
    double most = 0;
    for (size_t i = 0; i < n; i++) {
        most = fabs(v[i]) > most ? fabs(v[i]) : most;
    }
    return most;
}

/* One step of iterative refinement of H x = b for the factored H, with a product by deformation
 * modes. @return the change relative to x */
static double refine(haft_tracker *t, const double *b, double *x) {
    double *step = t->work.scratch[1];
    haft_model_multiply(t->model, t->site_stiffness, x, step);
    for (size_t k = 0; k < t->n; k++) {
        step[k] = b[k] - step[k];
    }
    haft_tracker_solve(t, step);
    double change = greatest(step, t->n) / greatest(x, t->n);
    for (size_t k = 0; k < t->n && change < 1; k++) {
        x[k] += step[k];
    }
    return change;
}

/* Refines the solution x of H x = b, b in scratch[0], to a relative error of about `enough`, on
 * meshes that need it. */
static void refine_all(haft_tracker *t, double *x, double enough) {
    const double *b = t->work.scratch[0];
    double last = INFINITY, rate = 0;
    for (int i = 0; i < REFINEMENTS && t->needs_refinement; i++) {
        double change = refine(t, b, x);
        rate = i == 0 ? change : rate; /* the first change is the convergence rate */
        if (!(change < 0.5 * last) || rate * change < enough) {
            return;
        }
        last = change;
    }
}

/* Puts the load's row into scratch[0] and into the right-hand side; frozen unknowns have no load.
 */
static void put_load(haft_tracker *t) {
    double *b = t->work.scratch[0];
    memset(b, 0, t->n * sizeof *b);
    haft_tracker_add_row(t, &haft_mesh_of(t)->load, 1, b);
    memset(b + t->n, 0, (haft_mesh_of(t)->dofs - t->n) * sizeof *b);
    memcpy(t->solution, b, haft_mesh_of(t)->dofs * sizeof *b);
}

bool haft_branch_loses_digits(haft_tracker *t) {
    put_load(t);
    haft_tracker_solve(t, t->solution);
    return refine(t, t->work.scratch[0], t->solution) > LOST_DIGITS;
}

haft_inertia haft_branch_certify(haft_tracker *t) {
    put_load(t);
    if (!haft_tracker_factor_solve(t, t->hessian, t->solution)) {
        return (haft_inertia){-1, 0};
    }
    refine_all(t, t->solution, 1e-16);
    haft_model_displacements(t->model, t->solution, t->motion);
    return haft_factor_inertia(t->factor);
}

/* H u2 = b P2 - sum_r A_r f''_r (s_r u1)^2 s_r, with zero second derivative of the parameter. */
static void second_derivatives(haft_tracker *t, const haft_state *state, haft_parameter parameter,
                               int side, double rate, haft_branch *out) {
    const haft_model_data *m = haft_mesh_of(t);
    double *d = t->work.site[0], *force = t->work.site[1], by_control = 1 / rate,
           unit = 1 / m->energy_unit;
    haft_law_values values = {t->work.site[2], t->work.site[3], t->work.site[4], force};
    for (size_t r = m->inert; r < m->sites; r++) {
        double motion = t->motion[r] * by_control;
        d[r] = state->gap[r] - copysign(KINK_OFFSET * t->problem.lengths.range[r], motion * side);
    }
    haft_law_rows_evaluate(t->problem.rows, m->inert, m->sites - m->inert, d + m->inert, &values);
    for (size_t r = m->inert; r < m->sites; r++) {
        double weight = m->site[r].area * unit, motion = t->motion[r] * by_control;
        force[r] = -weight * values.curvature[r - m->inert] * motion * motion;
    }
    memset(out->u2, 0, m->dofs * sizeof *out->u2);
    haft_model_add_forces(t->model, force, out->u2);
    memset(out->u2 + t->n, 0, (m->dofs - t->n) * sizeof *out->u2); /* the frozen part stays */
    memcpy(t->work.scratch[0], out->u2, t->n * sizeof *out->u2);
    haft_tracker_solve(t, out->u2);
    refine_all(t, out->u2, ENOUGH_OF_SECOND);
    out->load2 = 0;
    if (parameter.site != NULL) {
        out->load2 = -haft_tracker_row(t, parameter.site, out->u2) / rate;
        for (size_t i = 0; i < t->n; i++) {
            out->u2[i] += out->load2 * t->solution[i];
        }
    }
}

void haft_branch_derive(haft_tracker *t, const haft_state *state, haft_parameter parameter,
                        int side, haft_branch *out) {
    double rate = parameter.site == NULL ? 1 : haft_tracker_row(t, parameter.site, t->solution);
    for (size_t i = 0; i < t->n; i++) {
        out->u1[i] = t->solution[i] / rate;
    }
    out->load1 = 1 / rate;
    second_derivatives(t, state, parameter, side, rate, out);
}

double haft_branch_rebase(const haft_tracker *t, haft_parameter parameter, haft_branch *branch) {
    bool by_load = parameter.site == NULL;
    double a = by_load ? branch->load1 : haft_tracker_row(t, parameter.site, branch->u1);
    double b = by_load ? branch->load2 : haft_tracker_row(t, parameter.site, branch->u2);
    for (size_t i = 0; i < t->n; i++) {
        branch->u2[i] = (branch->u2[i] - branch->u1[i] * (b / a)) / (a * a);
        branch->u1[i] /= a;
    }
    branch->load2 = (branch->load2 - branch->load1 * (b / a)) / (a * a);
    branch->load1 /= a;
    return a;
}

/* Value, first and second derivative at both ends of an interval of length h. */
typedef struct quintic {
    double c[6]; /* powers of s = (tau - tau0) / h */
} quintic;

static quintic interpolate(double h, double p0, double v0, double a0, double p1, double v1,
                           double a1) {
    double d = p1 - p0;
    v0 *= h, v1 *= h, a0 *= 0.5 * h * h, a1 *= 0.5 * h * h;
    return (quintic){{p0, v0, a0, 10 * d - 6 * v0 - 4 * v1 - 3 * a0 + a1,
                      -15 * d + 8 * v0 + 7 * v1 + 3 * a0 - 2 * a1,
                      6 * d - 3 * v0 - 3 * v1 - a0 + a1}};
}

double haft_branch_work(const haft_tracker *t, double dtau) {
    const haft_site *load = &haft_mesh_of(t)->load;
    quintic p = interpolate(dtau, t->here.load, t->start.load1, t->start.load2, t->next.load,
                            t->end.load1, t->end.load2);
    quintic w = interpolate(
        dtau, haft_tracker_row(t, load, t->here.u), haft_tracker_row(t, load, t->start.u1),
        haft_tracker_row(t, load, t->start.u2), haft_tracker_row(t, load, t->next.u),
        haft_tracker_row(t, load, t->end.u1), haft_tracker_row(t, load, t->end.u2));
    double work = 0;
    for (int i = 0; i < 6; i++) {
        for (int j = 1; j < 6; j++) {
            work += p.c[i] * w.c[j] * j / (i + j);
        }
    }
    return work * haft_mesh_of(t)->energy_unit;
}

double haft_branch_least_eigenvalue(haft_tracker *t) {
    double *x = t->mode, *mx = t->work.scratch[0], *y = t->work.scratch[1], lambda = 0, last = NAN;
    for (int sweep = 0; sweep < EIGEN_SWEEPS && !(fabs(lambda - last) < 1e-3 * lambda); sweep++) {
        last = lambda;
        double before = haft_tracker_weigh(t, x, mx), after = 0;
        memcpy(y, mx, t->n * sizeof *y);
        haft_tracker_solve(t, y);
        for (size_t i = 0; i < t->n; i++) {
            after += y[i] * mx[i];
        }
        lambda = before / after; /* x'Mx / x'M H^-1 M x, x the last iterate */
        double scale = 1 / sqrt(fabs(after));
        if (!(scale > 0) || !isfinite(scale)) {
            return 0;
        }
        for (size_t i = 0; i < t->n; i++) {
            x[i] = scale * y[i];
        }
    }
    return lambda;
}

void haft_branch_predict(haft_tracker *t, double dtau) {
    for (size_t i = 0; i < t->n; i++) {
        t->next.u[i] = t->here.u[i] + dtau * (t->start.u1[i] + 0.5 * dtau * t->start.u2[i]);
    }
    t->next.load = t->here.load + dtau * (t->start.load1 + 0.5 * dtau * t->start.load2);
}

static double total(haft_energy e) {
    return e.strain + e.contact;
}

/* The defect of a step may be what its own work adds to the path's allowance. Over a table, where
 * second derivatives jump at the knots, it may instead be a share of the remaining allowance.
 * Either way the whole ledger stays within the tolerance of the whole work, and a step with little
 * work need not be as exact as if it were alone. Over smooth laws that would gain almost nothing.
 */
void haft_branch_book(haft_tracker *t, haft_step *step) {
    step->work = haft_branch_work(t, step->dtau);
    step->defect = total(t->next.energy) - total(t->here.energy) - step->work;
    step->allowed = t->problem.options.ledger_tolerance * fabs(step->work);
    if (haft_tracker_meets_knots(t, step->parameter)) {
        step->allowed = fmax(step->allowed, SPENT * t->ledger_left);
    }
    step->allowed += haft_tracker_rounding(&t->here, &t->next);
}

double haft_branch_defect_order(const haft_tracker *t, haft_parameter parameter) {
    return haft_tracker_meets_knots(t, parameter) ? 3 : 6;
}

static double load_rate(const quintic *p, double s) {
    return (((5 * p->c[5] * s + 4 * p->c[4]) * s + 3 * p->c[3]) * s + 2 * p->c[2]) * s + p->c[1];
}

/* Where the load's rate is least within a step, as a share of the step, and its share of the
 * smaller rate at the ends: two close folds show there before they show at the ends. */
static double deepest_dip(const haft_tracker *t, double dtau, double *depth) {
    enum { LOOKS = 32 };
    quintic p = interpolate(dtau, t->here.load, t->start.load1, t->start.load2, t->next.load,
                            t->end.load1, t->end.load2);
    double sign = p.c[1] > 0 ? 1 : -1, rate[LOOKS + 1];
    int least = 0;
    for (int i = 0; i <= LOOKS; i++) {
        rate[i] = sign * load_rate(&p, (double)i / LOOKS);
        least = rate[i] < rate[least] ? i : least;
    }
    double ends = fmin(rate[0], rate[LOOKS]), where = (double)least / LOOKS;
    if (least > 0 && least < LOOKS) { /* the parabola's foot, twice */
        for (double h = 1.0 / LOOKS; h > 1e-3; h /= 16) {
            double before = sign * load_rate(&p, where - h),
                   after = sign * load_rate(&p, where + h);
            double bend = before + after - 2 * sign * load_rate(&p, where);
            where += bend > 0 ? fmax(-h, fmin(h, 0.5 * h * (before - after) / bend)) : 0;
        }
    }
    *depth = sign * load_rate(&p, where) / ends;
    return where;
}

haft_step_result haft_branch_try(haft_tracker *t, haft_step *step, int direction) {
    haft_branch_predict(t, step->dtau);
    double value = haft_parameter_value(t, step->parameter, &t->here) + step->dtau;
    step->moved = INFINITY;
    step->defect = INFINITY;
    step->allowed = 0;
    step->failure = HAFT_OUTCOME_NOT_CONVERGED;
    if (t->at > 0 && !haft_active_mesh_is_clear(t, t->next.u)) {
        return HAFT_STEP_LEAVES; /* change to a longer mesh before any work is done */
    }
    if (!haft_corrector_solve(t, step->parameter, value, &t->next)) {
        return HAFT_STEP_REJECTED;
    }
    step->failure = HAFT_OUTCOME_BRANCH_LOST;
    step->moved = haft_tracker_scaled_distance(t, t->next.gap, t->gap_predicted);
    if (!(step->moved <= HAFT_CORRECTION_LIMIT)) {
        return HAFT_STEP_REJECTED;
    }
    if (!haft_active_mesh_is_clear(t, t->next.u) ||
        haft_active_mesh_unbalance(t) > UNBALANCE_SHARE * t->residual) {
        return HAFT_STEP_LEAVES;
    }
    step->inertia = haft_branch_certify(t);
    if (step->inertia.negative < 0) {
        step->failure = HAFT_OUTCOME_SINGULAR;
        return HAFT_STEP_REJECTED;
    }
    step->failure = HAFT_OUTCOME_FOLD_LOST;
    haft_branch_derive(t, &t->next, step->parameter, -step->sign, &t->end);
    haft_branch_book(t, step);
    bool turned = t->end.load1 * step->sign * direction <= 0;
    if (step->inertia.negative > 0) {
        return turned && step->inertia.negative == 1 ? HAFT_STEP_FOLD : HAFT_STEP_UNSTABLE;
    }
    if (turned) {
        return HAFT_STEP_REJECTED;
    }
    if (fabs(step->defect) > step->allowed) {
        step->failure = HAFT_OUTCOME_LEDGER_OPEN;
        return HAFT_STEP_ENERGY_CHECK_FAILED;
    }
    step->failure = HAFT_OUTCOME_STEP_STALLED;
    double depth = 1, where = 0;
    if (step->parameter.site != NULL &&
        fabs(step->dtau) * haft_mesh_of(t)->gap >
            DIP_STEP * t->problem.lengths.range[step->parameter.index]) {
        where = deepest_dip(t, step->dtau, &depth);
    }
    bool inside = where > DIP_EDGE && where < 1 - DIP_EDGE;
    if (depth < DIP_SHARE && where > 0 && where < 1 && (inside || depth < 0)) {
        step->dip = where;
        return HAFT_STEP_DIPS;
    }
    return HAFT_STEP_TAKEN;
}
