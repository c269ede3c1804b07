/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One step along a branch: certificate, derivatives, predictor, ledger. Private to the room. */
#ifndef HAFT_SOLVE_BRANCH_H
#define HAFT_SOLVE_BRANCH_H

#include "tracker.h"

/* Factors the Hessian at the state last evaluated and sets t->solution. @return its inertia,
 * with negative = -1 if it could not be factored. */
haft_inertia haft_branch_certify(haft_tracker *t);

/* Whether solutions by the current factor, of the state last evaluated, lose too many digits. */
bool haft_branch_loses_digits(haft_tracker *t);

/* Derivatives at a certified state. `side` is the sign of dtau of the motion on whose side the
 * laws' kinks are read: where it leads when leaving, where it comes from (pass -sign) when
 * arriving. */
void haft_branch_derive(haft_tracker *t, const haft_state *state, haft_parameter parameter,
                        int side, haft_branch *out);

/* The same branch by another parameter: derivatives by the chain rule. @return the dtau of the new
 * parameter that one unit of the old one's is, to first order. */
double haft_branch_rebase(const haft_tracker *t, haft_parameter parameter, haft_branch *branch);

/* The predictor: extrapolates `here` by dtau into `next`, by the derivatives at `here`. */
void haft_branch_predict(haft_tracker *t, double dtau);

/* Work of the load [J] between `here` and `next` over dtau, by quintic interpolation of load and
 * deflection from both ends' derivatives. */
double haft_branch_work(const haft_tracker *t, double dtau);

/* Smallest eigenvalue of H phi = lambda M phi at the certified state, by inverse iteration. */
double haft_branch_least_eigenvalue(haft_tracker *t);

typedef enum haft_step_result {
    HAFT_STEP_TAKEN,
    HAFT_STEP_REJECTED,
    HAFT_STEP_LEAVES, /* a site that the mesh leaves out would come into reach, or what is held
                         would move */
    HAFT_STEP_ENERGY_CHECK_FAILED, /* sound, but the energy ledger is off by more than allowed */
    HAFT_STEP_DIPS,                /* sound, but two folds may lie inside: to be cut at step->dip */
    HAFT_STEP_FOLD,     /* the branch turned: dP/dtau changed sign, one eigenvalue went negative */
    HAFT_STEP_UNSTABLE, /* an eigenvalue went negative though the load did not turn */
} haft_step_result;

/* A step tried: `next`, its certificate and its ledger. */
typedef struct haft_step {
    haft_parameter parameter;
    int sign;     /* of dtau */
    bool at_kink; /* it was to end on a law's kink */
    double dtau;
    double work;          /* of the load [J] */
    double defect;        /* energy gained - work [J] */
    double allowed;       /* what the defect may be [J] */
    double dip;           /* share of dtau at which the load's rate is least */
    double moved;         /* largest scaled displacement from prediction to solution */
    haft_outcome failure; /* outcome of the path if no shorter step succeeds */
    haft_inertia inertia;
} haft_step;

/* Computes the step's work, defect and allowance from `here` to `next`. */
void haft_branch_book(haft_tracker *t, haft_step *step);

/* The order of the defect in the step size: that of the quintic where the laws are smooth, less at
 * the knots of tables. */
double haft_branch_defect_order(const haft_tracker *t, haft_parameter parameter);

/* Predicts, corrects, certifies and accounts for a step from `here`, whose derivatives are in
 * t->start. */
haft_step_result haft_branch_try(haft_tracker *t, haft_step *step, int direction);

#endif
