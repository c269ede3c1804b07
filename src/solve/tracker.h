/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What following a path needs at hand, private to the room: the workspace, states and their
 * derivatives along the branch, and the four operations on them: correct, step, locate, land.
 *
 * A branch is followed by a control: the displacement of one site (a "local parameter"), or the
 * load itself. With u and P as functions of the control's value tau, a fold is dP/dtau = 0, an
 * ordinary point of the bordered system. Everything here is scaled: P in units of energy_unit /
 * gap, tau in units of the gap (or of P). */
#ifndef HAFT_SOLVE_TRACKER_H
#define HAFT_SOLVE_TRACKER_H

#include "diagonals.h"
#include "factor.h"
#include "haft/solve.h"

/* An equilibrium, or a state on the way to one. */
typedef struct haft_state {
    double *u;
    double *gap; /* of each site [m], as evaluated; inert sites' are not kept */
    double load;
    haft_energy energy; /* [J] */
    double crack;       /* [m], NaN while nobody has asked for it */
} haft_state;

/* First and second derivatives of a branch by its control. */
typedef struct haft_branch {
    double *u1, *u2;
    double load1, load2;
} haft_branch;

/* A control: a site's displacement, or (site NULL) the load. */
typedef struct haft_control {
    const haft_site *site;
    size_t index; /* of the site */
} haft_control;

/* What the corrector may move a gap by, and how far off its end a branch is left, in the lengths
 * over which the gap's force changes. */
#define HAFT_CORRECTION_LIMIT 0.05
#define HAFT_DEPARTURE_MOVE 0.01

typedef struct haft_corrector haft_corrector;

/* A mesh of the beam, and what solves on it. */
typedef struct haft_zone {
    const haft_model *model;
    haft_factor *factor; /* of the Hessian last asked for */
    haft_corrector *corrector;
    haft_diagonals *mass;
} haft_zone;

enum { HAFT_SITE_SCRATCH = 5 };

/* What is held of a mesh: its energies, and the force and moment by which it kept the front's end
 * in place when it began to be held. */
typedef struct haft_held {
    haft_energy energy;
    double force[2];
} haft_held;

typedef struct haft_tracker {
    const haft_model *whole; /* the mesh of the path's states; all vectors have room for its */
    haft_zone *zone;         /* zones: on it and on its shorter ones, in their order */
    size_t zones, at;        /* and the one in use, which those down to n are of */
    const haft_model *model;
    haft_factor *factor;
    haft_corrector *corrector;
    haft_diagonals *mass;
    haft_model front; /* of the mesh in use, while what lies behind is held: */
    haft_held held;
    size_t n; /* unknowns that move */
    const haft_law *laws;
    haft_law_rows *rows; /* the same, laid out for evaluation */
    haft_path_options options;
    haft_programme programme;
    double load_unit;                    /* energy_unit / gap [N] */
    double *range, *edge, *wide;         /* of each site: the lengths of its law [m] */
    double *reach;                       /* it is felt within [m] */
    double *far;                         /* its force is below 1e-3 of f_max beyond [m] */
    double *nil;                         /* and below 1e-16 of it beyond [m] */
    double *wall;                        /* its law is linear below [m] */
    double *gradient, *hessian, *matrix; /* at the state last evaluated; matrix is scratch */
    struct {
        double *gradient, *hessian;
    } other;                         /* those of another state, put aside */
    double *gap;                     /* sites: of the last haft_tracker_evaluate() [m] */
    double *gap_predicted;           /* sites: where the corrector started from [m] */
    double *solution;                /* n: H^-1 b at the state last certified */
    double *motion;                  /* sites: what that is of their displacements */
    double *mode;                    /* n: eigenvector estimate of the smallest eigenvalue */
    double *scratch[4];              /* n each */
    double *stage[3];                /* n each: the flow's stages */
    double *pair;                    /* 2 n: two right-hand sides solved together */
    double *gap_before;              /* sites: before a jump [m] */
    double *site[HAFT_SITE_SCRATCH]; /* haft_law_lanes(sites) each: scratch */
    double *site_stiffness;          /* sites: at the state last evaluated, where refined by it */
    haft_state here, next, spare;    /* accepted, tried, and the flow's second */
    haft_branch start, end;          /* derivatives at `here` leaving it and at `next` arriving */
    haft_branch rebased;             /* start, kept while another control is tried */
    double *null;                    /* n: null vector at a fold */
    bool needs_refinement;           /* the factors alone lose too many digits */
    size_t not_finite;               /* evaluations that were not, since the last accepted state */
    double residual;                 /* what the corrector last left of the forces, at most */
    double ledger_left; /* what the ledger may still miss at `here`, beside new work's share [J] */
    haft_path_cost cost;
} haft_tracker;

/* Makes a tracker and puts it at rest: u = 0, P = 0, certified. */
haft_status haft_tracker_create(haft_tracker **out, const haft_model *model, const haft_law *laws,
                                const haft_programme *programme, const haft_path_options *options,
                                haft_error *error);
void haft_tracker_destroy(haft_tracker **tracker);

/* Evaluates energy, gradient, Hessian and gaps at u under a scaled load into the tracker.
 * @return false if anything is not finite. */
bool haft_tracker_evaluate(haft_tracker *t, const double *u, double load, haft_energy *energy,
                           double *force_scale);

/* The same of a state, where its energy and gaps go; the tracker's own gaps stay. */
bool haft_tracker_visit(haft_tracker *t, haft_state *state);

/* The gradient alone, into `gradient`; what is at hand stays. @return whether it is finite. */
bool haft_tracker_gradient(haft_tracker *t, const double *u, double load, double *gradient);

/* The energy alone; what is at hand stays. */
haft_energy haft_tracker_energy(const haft_tracker *t, const double *u);

/* Puts the gradient and Hessian at hand aside, for those that were so before. */
void haft_tracker_turn(haft_tracker *t);

static inline void haft_tracker_count_factorization(haft_tracker *t) {
    t->cost.factorizations++;
    t->cost.unknowns += t->n;
}

/* Solves in place with the factor at hand. */
void haft_tracker_solve(haft_tracker *t, double *b);

/* Factors a matrix of the mesh in use, and solves with it in place. @return false if it could not
 * be factored. */
bool haft_tracker_factor_solve(haft_tracker *t, const double *matrix, double *b);

/* out = factor * M x - less, `less` NULL for nil; `out` is neither of them. */
void haft_tracker_multiply_mass(const haft_tracker *t, double factor, const double *x,
                                const double *less, double *restrict out);

/* mx = M x. @return x'Mx */
double haft_tracker_weigh(const haft_tracker *t, const double *x, double *restrict mx);

/* Pi of an evaluated state at its own load [J]. */
double haft_tracker_potential(const haft_tracker *t, const haft_state *state);

/* Rounding in the difference of two states' energies [J]: a few units in the last place of their
 * parts, and what rounding of the states makes of them. */
double haft_tracker_rounding(const haft_state *a, const haft_state *b);

/* The control's value in a state. */
double haft_control_value(const haft_tracker *t, haft_control control, const haft_state *state);

/* Whether a step by this control passes knots of a table. */
static inline bool haft_tracker_meets_knots(const haft_tracker *t, haft_control control) {
    return control.site != NULL && t->laws[control.index].kind == HAFT_LAW_TABLE;
}

/* sum_k shape_k v_k / gap for a site, or for the load point. */
double haft_tracker_row(const haft_tracker *t, const haft_site *site, const double *v);

/* Adds factor * row' of a site to v. */
void haft_tracker_add_row(const haft_tracker *t, const haft_site *site, double factor, double *v);

/* The length over which a site's force changes at gap d: the law's own, but no longer than leads
 * just behind its edge; longer the farther the gap is out of reach. */
static inline double haft_tracker_length(const haft_tracker *t, size_t site, double d) {
    double beyond = d - t->far[site], past = d - t->edge[site];
    double length = t->range[site] + (past > 0 ? past : 0);
    return (length < t->wide[site] ? length : t->wide[site]) + (beyond > 0 ? beyond : 0);
}

/* The length over which a site's slope changes at gap d: that above, or how deep the gap is in the
 * law's wall, where the force is linear. A step may be as long as this. */
static inline double haft_tracker_step_length(const haft_tracker *t, size_t site, double d) {
    double behind = t->wall[site] - d, length = haft_tracker_length(t, site, d);
    return behind > 0 ? t->range[site] + behind : length;
}

/* Largest of the sites' motions [m] at the gaps given, in step lengths, and whose it is. */
double haft_tracker_greatest(const haft_tracker *t, const double *gap, const double *motion,
                             size_t *site);

/* Largest of the motions that a displacement v of the unknowns makes, in lengths, and whose it is
 * (site may be NULL); and of those from one state's gaps to another's. */
double haft_tracker_move(const haft_tracker *t, const double *gap, const double *v, size_t *site);
double haft_tracker_way(const haft_tracker *t, const double *gap, const double *to);

/* The sites up to the last that goes further than `least` lengths from one state's gaps to
 * another's: how many they are. */
size_t haft_tracker_moved(const haft_tracker *t, const double *gap, const double *to, double least);

/* The sites up to the last that the load moves, at `here` just certified, by more than a share of
 * what it moves most: how many they are. */
size_t haft_tracker_stirred(const haft_tracker *t, double share);

/* Crack length of a state [m], computed once. */
double haft_tracker_crack(const haft_tracker *t, haft_state *state);

/* ---- zone.c: on which of the beam's meshes
 * --------------------------------------------------------- */

/* Makes the zones of a tracker whose vectors are there, and enters the whole mesh. */
haft_status haft_zones_create(haft_tracker *t, haft_error *error);
void haft_zones_destroy(haft_tracker *t);

/* Whether all sites that the mesh in use leaves out are where their laws are nil. */
bool haft_zone_is_clear(const haft_tracker *t, const double *u);

/* Puts zone `at` in use, all of it. */
void haft_zone_enter(haft_tracker *t, size_t at);

/* Holds what lies behind the first so many sites, or a few more, as it is in `state`, until a zone
 * is entered: the tracker's model is the front, and t->n its unknowns. Energies still are those of
 * all. `other` is a state to be made of it. @return false, and nothing is held, where more than
 * `most` of the unknowns, as a share of all, would still move. */
bool haft_zone_hold(haft_tracker *t, const haft_state *state, haft_state *other, size_t sites,
                    double most);

/* Lets go what is held, and evaluates a state. @return false if it is not finite. */
bool haft_zone_let_go(haft_tracker *t, haft_state *state);

/* By how much the forces on the held node, in the state last evaluated, are no more what they were
 * when it began to be held: so much is out of balance there. */
double haft_zone_unbalance(const haft_tracker *t);

static inline bool haft_zone_is_held(const haft_tracker *t) {
    return t->model == &t->front;
}

/* Goes over with a state to a wider mesh, that has what it would touch at u = `ahead`, or to the
 * narrowest that has all that it may touch soon, coming from u = `before` (NULL: at rest). It is
 * evaluated there, with the gaps of all sites.
 * @return false if there is none to go to. */
bool haft_zone_widen(haft_tracker *t, haft_state *state, const double *ahead);
bool haft_zone_narrow(haft_tracker *t, haft_state *state, const double *before);

/* ---- corrector.c: KINSOL on the bordered system
 * --------------------------------------------------- */

haft_status haft_corrector_create(haft_corrector **out, haft_tracker *t, const haft_model *model,
                                  haft_error *error);
void haft_corrector_destroy(haft_corrector **corrector);

/* From now on, n of the unknowns move, the first ones. @return false, and nothing changes, where it
 * cannot be so few. */
bool haft_corrector_lead(haft_corrector *corrector, size_t n);

/* Solves grad Pi = 0 with the control at `value`, from the state given; leaves the Hessian at the
 * solution in t->hessian. @return false if it did not converge. */
bool haft_corrector_solve(haft_tracker *t, haft_control control, double value, haft_state *state);

/* ---- branch.c
 * ------------------------------------------------------------------------------------- */

/* Factors the Hessian at the state last evaluated and sets t->solution. @return its inertia,
 * with negative = -1 if it could not be factored. */
haft_inertia haft_branch_certify(haft_tracker *t);

/* Whether solutions by the factors at hand, of the state last evaluated, lose too many
 * digits. */
bool haft_branch_loses_digits(haft_tracker *t);

/* Derivatives at a certified state. `side` is the sign of dtau of the motion on whose side the
 * laws' kinks are read: where it leads when leaving, where it comes from (pass -sign) when
 * arriving. */
void haft_branch_derive(haft_tracker *t, const haft_state *state, haft_control control, int side,
                        haft_branch *out);

/* The same branch by another control: derivatives by the chain rule. @return the dtau of the new
 * control that one unit of the old one's is, to first order. */
double haft_branch_rebase(const haft_tracker *t, haft_control control, haft_branch *branch);

/* Puts into `next` what lies dtau from `here`, by the derivatives there. */
void haft_branch_predict(haft_tracker *t, double dtau);

/* Work of the load [J] between `here` and `next` over dtau, by quintic interpolation of load and
 * deflection from both ends' derivatives. */
double haft_branch_work(const haft_tracker *t, double dtau);

/* Smallest eigenvalue of H phi = lambda M phi at the certified state, by inverse iteration. */
double haft_branch_least_eigenvalue(haft_tracker *t);

typedef enum haft_step_result {
    HAFT_STEP_TAKEN,
    HAFT_STEP_REJECTED,
    HAFT_STEP_LEAVES,   /* a site that the mesh leaves out would come into reach, or what is held
                           would move */
    HAFT_STEP_AMISS,    /* sound, but the ledger misses more energy than is allowed */
    HAFT_STEP_DIPS,     /* sound, but two folds may hide inside: to be cut at step->dip */
    HAFT_STEP_FOLD,     /* the branch turned: dP/dtau changed sign, one eigenvalue went negative */
    HAFT_STEP_UNSTABLE, /* an eigenvalue went negative though the load did not turn */
} haft_step_result;

/* A step tried: `next`, its certificate and its ledger. */
typedef struct haft_step {
    haft_control control;
    int sign;     /* of dtau */
    bool at_kink; /* it was to end on a law's kink */
    double dtau;
    double work;          /* of the load [J] */
    double defect;        /* energy gained - work [J] */
    double allowed;       /* what the defect may be [J] */
    double dip;           /* share of dtau at which the load's rate is least */
    double moved;         /* largest way of a gap between prediction and solution, in lengths */
    haft_outcome failure; /* what the path ends with if no shorter step is better */
    haft_inertia inertia;
} haft_step;

/* Sets the step's work, defect and allowance from `here` to `next`. */
void haft_branch_book(haft_tracker *t, haft_step *step);

/* The power of a step's size with which its defect falls: that of the quintic where the laws are
 * smooth, less where they are tables, for their knots. */
double haft_branch_defect_order(const haft_tracker *t, haft_control control);

/* Predicts, corrects, certifies and books a step from `here`, whose derivatives are in t->start. */
haft_step_result haft_branch_try(haft_tracker *t, haft_step *step, int direction);

/* ---- fold.c
 * --------------------------------------------------------------------------------------- */

/* Given a step that ended in HAFT_STEP_FOLD, puts the fold into t->next and its null vector, scaled
 * by the control, into t->null; step->dtau, work and defect become those of the stretch up to the
 * fold. @return false if it could not be located. */
bool haft_fold_locate(haft_tracker *t, haft_step *step, int direction, double *defect);

/* ---- flow.c
 * --------------------------------------------------------------------------------------- */

/* Follows M u' = -grad Pi at the load of `here` from here + a little of `away` until it rests in a
 * stable, certified equilibrium, which goes into `here`. With `away` NULL it starts from `here`
 * itself, which is no equilibrium; no steps are made if Newton's step from there is small. The gaps
 * of `here` are in t->gap_before.
 * @return HAFT_OUTCOME_STUCK when landed, else why not. */
haft_outcome haft_flow_land(haft_tracker *t, const double *away, int *steps);

#endif
