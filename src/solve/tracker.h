/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tracker of a path: the problem, the states on its branch with their derivatives, and scratch
 * arrays. Private to the room. corrector.h, branch.h, limit_point.h and landing.h operate on it.
 *
 * A branch is followed by a continuation parameter: the displacement of one site, or the load. With
 * u and P as functions of its value tau, a fold (limit point) is dP/dtau = 0, an ordinary point of
 * the bordered system. Everything here is scaled: P in units of energy_unit / gap, tau in units of
 * the gap (or of P). */
#ifndef HAFT_SOLVE_TRACKER_H
#define HAFT_SOLVE_TRACKER_H

#include "diagonals.h"
#include "displacements.h"
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

/* First and second derivatives of a branch by its parameter. */
typedef struct haft_branch {
    double *u1, *u2;
    double load1, load2;
} haft_branch;

/* A parameter: a site's displacement, or (site NULL) the load. */
typedef struct haft_parameter {
    const haft_site *site;
    size_t index; /* of the site */
} haft_parameter;

/* The largest correction of a gap, and how far beyond its end a branch is left. Both in units of
 * the length over which the gap's force changes. */
#define HAFT_CORRECTION_LIMIT 0.05
#define HAFT_DEPARTURE_MOVE 0.01

typedef struct haft_corrector haft_corrector;

/* A mesh of the beam, and what solves on it; see active_mesh.h. */
typedef struct haft_active_mesh {
    const haft_model *model;
    haft_factor *factor; /* of the Hessian last asked for */
    haft_corrector *corrector;
    haft_diagonals *mass;
} haft_active_mesh;

enum { HAFT_SITE_SCRATCH = 5 };

/* The frozen part of a mesh: its energies, and the force and moment with which it held the end of
 * the moving part when it was frozen. */
typedef struct haft_frozen {
    haft_energy energy;
    double force[2];
} haft_frozen;

/* What is solved; constant while a path is followed. The lengths are arrays over the sites. */
typedef struct haft_problem {
    const haft_model *whole; /* the mesh of the path's states; all vectors have room for its */
    const haft_law *laws;
    haft_law_rows *rows; /* the same, laid out for evaluation */
    haft_path_options options;
    haft_programme programme;
    double load_unit; /* energy_unit / gap [N] */
    haft_site_lengths lengths;
    double *reach;    /* attraction counts as felt within [m] */
    double *lost;     /* force below 1e-16 of the maximum beyond, and no far field left [m] */
    double far_slope; /* steepest of the far field, 0 without [Pa/m] */
} haft_problem;

/* Scratch arrays. None keeps its contents from one function of tracker.h, branch.h or landing.h to
 * the next. */
typedef struct haft_work {
    double *matrix;                  /* a matrix of the mesh in use */
    double *scratch[4];              /* n each */
    double *stage[3];                /* n each: the flow's stages */
    double *pair;                    /* 2 n: two right-hand sides solved together */
    double *site[HAFT_SITE_SCRATCH]; /* sites each */
} haft_work;

typedef struct haft_tracker {
    haft_problem problem;
    haft_work work;
    haft_active_mesh *mesh; /* the whole mesh and its shorter ones, in their order */
    size_t meshes, at;      /* their number, and the one in use: of it are the members down to n */
    const haft_model *model;
    haft_factor *factor;
    haft_corrector *corrector;
    haft_diagonals *mass;
    haft_model *front; /* the moving part of the mesh in use, while the rest is frozen */
    haft_frozen frozen;
    size_t n;                   /* unknowns that move */
    double *gradient, *hessian; /* at the state last evaluated */
    struct {
        double *gradient, *hessian;
    } other;                      /* those of another state, swapped in and out */
    double *gap;                  /* sites: of the last haft_tracker_evaluate() [m] */
    double *gap_predicted;        /* sites: where the corrector started from [m] */
    double *gap_before;           /* sites: before a jump [m] */
    double *site_stiffness;       /* sites: at the state last evaluated, where refined by it */
    double *solution;             /* n: H^-1 b at the state last certified */
    double *motion;               /* sites: the displacements of `solution` */
    double *mode;                 /* n: eigenvector estimate of the smallest eigenvalue */
    double *null;                 /* n: null vector at a fold */
    haft_state here, next, spare; /* accepted, tried, and the flow's second */
    haft_branch start, end;       /* derivatives at `here` leaving it and at `next` arriving */
    haft_branch rebased;          /* start, kept while another parameter is tried */
    bool needs_refinement;        /* the factors alone lose too many digits */
    size_t not_finite;            /* evaluations since the last accepted state, not finite */
    double residual;              /* bound of the forces' residual after the last correction */
    double ledger_left; /* allowance of the ledger at `here`, besides that of new work [J] */
    haft_path_cost cost;
} haft_tracker;

/* The mesh in use, or the moving part of it. */
static inline const haft_model_data *haft_mesh_of(const haft_tracker *t) {
    return haft_model_get(t->model);
}

/* Makes a tracker and puts it at rest: u = 0, P = 0, certified. */
haft_status haft_tracker_create(haft_tracker **out, const haft_model *model, const haft_law *laws,
                                const haft_programme *programme, const haft_path_options *options,
                                haft_error *error);
void haft_tracker_destroy(haft_tracker **tracker);

/* Evaluates energy, gradient, Hessian and gaps at u under a scaled load into the tracker.
 * @return false if anything is not finite. */
bool haft_tracker_evaluate(haft_tracker *t, const double *u, double load, haft_energy *energy,
                           double *force_scale);

/* The same for a state, which takes energy and gaps; the tracker's own gaps stay. */
bool haft_tracker_visit(haft_tracker *t, haft_state *state);

/* Evaluates the gradient alone; the tracker's gradient and Hessian stay. @return whether it is
 * finite. */
bool haft_tracker_gradient(haft_tracker *t, const double *u, double load, double *gradient);

/* Evaluates the energy alone; the tracker's gradient and Hessian stay. */
haft_energy haft_tracker_energy(const haft_tracker *t, const double *u);

/* Swaps gradient and Hessian with those of `other`. */
void haft_tracker_turn(haft_tracker *t);

static inline void haft_tracker_count_factorization(haft_tracker *t) {
    t->cost.factorizations++;
    t->cost.unknowns += t->n;
}

/* Solves in place with the current factor. */
void haft_tracker_solve(haft_tracker *t, double *b);

/* Factors a matrix of the mesh in use, and solves with it in place. @return false if it could not
 * be factored. */
bool haft_tracker_factor_solve(haft_tracker *t, const double *matrix, double *b);

/* out = factor * M x - less; `less` may be NULL; `out` is neither x nor less. */
void haft_tracker_multiply_mass(const haft_tracker *t, double factor, const double *x,
                                const double *less, double *restrict out);

/* mx = M x. @return x'Mx */
double haft_tracker_weigh(const haft_tracker *t, const double *x, double *restrict mx);

/* Pi of an evaluated state at its own load [J]. */
double haft_tracker_potential(const haft_tracker *t, const haft_state *state);

/* Bound of the rounding error in the difference of two states' energies [J]: a few units in the
 * last place of their parts, and the effect of rounding of the states. */
double haft_tracker_rounding(const haft_state *a, const haft_state *b);

/* The parameter's value in a state. */
double haft_parameter_value(const haft_tracker *t, haft_parameter parameter,
                            const haft_state *state);

/* Whether a step by this parameter passes knots of a table. */
static inline bool haft_tracker_meets_knots(const haft_tracker *t, haft_parameter parameter) {
    return parameter.site != NULL && t->problem.laws[parameter.index].kind == HAFT_LAW_TABLE;
}

/* sum_k shape_k v_k / gap for a site, or for the load point. */
double haft_tracker_row(const haft_tracker *t, const haft_site *site, const double *v);

/* Adds factor * row' of a site to v. */
void haft_tracker_add_row(const haft_tracker *t, const haft_site *site, double factor, double *v);

/* The largest of the sites' motions [m], scaled by their step lengths at the gaps given, and its
 * site. */
double haft_tracker_largest_step(const haft_tracker *t, const double *gap, const double *motion,
                                 size_t *site);

/* The largest scaled displacement of a gap for a displacement v of the unknowns, and its site (may
 * be NULL); and the largest from one state's gaps to another's. */
double haft_tracker_scaled_displacement(const haft_tracker *t, const double *gap, const double *v,
                                        size_t *site);
double haft_tracker_scaled_distance(const haft_tracker *t, const double *gap, const double *to);

/* The number of sites up to the last one whose scaled displacement between two states' gaps exceeds
 * `least`. */
size_t haft_tracker_moved(const haft_tracker *t, const double *gap, const double *to, double least);

/* The number of sites up to the last one that the load moves, at `here` just certified, by more
 * than a share of the largest scaled displacement. */
size_t haft_tracker_stirred(const haft_tracker *t, double share);

/* Crack length of a state [m], computed once. */
double haft_tracker_crack(const haft_tracker *t, haft_state *state);

#endif
