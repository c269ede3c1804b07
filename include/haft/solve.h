/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file solve.h
 *  Quasi-static paths with many instabilities: load until the crack has a given length, then
 *  unload. Every jump is located, followed by gradient flow to where it lands, and entered into
 *  an energy ledger. Every accepted state is a stable equilibrium. */
#ifndef HAFT_SOLVE_H
#define HAFT_SOLVE_H

#include "haft/beam.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The load programme. */
typedef struct haft_programme {
    double crack_length; /**< load until the crack is as short as this [m] */
    double
        crack_threshold; /**< share of f_max from which attraction counts as felt, 0 < share < 1 */
    double load_limit;   /**< at most up to this load [N]; INFINITY for no limit */
} haft_programme;

/** The solver of the linear systems. All give the same states to rounding. */
typedef enum haft_linear_solver {
    HAFT_LINEAR_SOLVER_AUTO, /**< KLU behind KINSOL, the band solver for certificates and landings
                              */
    HAFT_LINEAR_SOLVER_KLU,  /**< KLU everywhere: sparse LU without pivoting */
    HAFT_LINEAR_SOLVER_BAND, /**< the band solver everywhere: block L D L' along the beam */
} haft_linear_solver;

/** The accuracy of a path. Zero in a field means its default. */
typedef struct haft_path_options {
    haft_linear_solver linear_solver; /**< HAFT_LINEAR_SOLVER_AUTO */
    double gap_step; /**< largest displacement of a gap in a step, in ranges of its law; 0.5 */
    double ledger_tolerance; /**< largest error of the ledger of energy, work and dissipation at any
                                time, relative to all the work done; 1e-10 */
    double residual_tolerance; /**< of the equilibrium, relative to the largest force; 1e-11 */
    double flow_step;          /**< error of a flow step, in ranges of the laws; 0.1 */
    size_t step_limit;         /**< accepted steps and flow steps together; 200000 */
    bool keep_states;          /**< keep u at every accepted step */
    bool whole_mesh; /**< solve on the whole mesh at every step: leave out no site that is out
                          of reach, and freeze no part that rests; for comparison */
} haft_path_options;

/** Why a path ended. */
typedef enum haft_outcome {
    HAFT_OUTCOME_STUCK,         /**< unloaded, and still in contact */
    HAFT_OUTCOME_FREE,          /**< unloaded, and touching nowhere */
    HAFT_OUTCOME_STEP_STALLED,  /**< no step ends at the load or the crack length asked for */
    HAFT_OUTCOME_FLOW_STALLED,  /**< a landing did not come to rest */
    HAFT_OUTCOME_STEP_LIMIT,    /**< more steps than allowed */
    HAFT_OUTCOME_NOT_FINITE,    /**< a law gave a value that is not finite */
    HAFT_OUTCOME_ZONE_LEFT,     /**< a site that was left out came into reach: the zone of an active
                                   mesh begins too late; the exact mesh is needed */
    HAFT_OUTCOME_NOT_CONVERGED, /**< the corrector did not converge, however short the step */
    HAFT_OUTCOME_BRANCH_LOST,   /**< the corrector ended far from the predictor, however short the
                                     step */
    HAFT_OUTCOME_SINGULAR,      /**< the stiffness could not be factored */
    HAFT_OUTCOME_LEDGER_OPEN,   /**< steps miss more energy than the ledger allows */
    HAFT_OUTCOME_FOLD_LOST,     /**< a limit point was passed but could not be located */
    HAFT_OUTCOME_CRACK_UNREACHED, /**< the walls are pressed in deeper than the beam's gap, and the
                                     crack is still longer than asked for */
    HAFT_OUTCOMES                 /**< how many there are */
} haft_outcome;

/** A short name of an outcome ("stuck"), never NULL. */
const char *haft_outcome_name(haft_outcome outcome);

/** Advice for a failed path, as one clause ("ask for a longer crack ..."); an empty text for
 *  HAFT_OUTCOME_STUCK and HAFT_OUTCOME_FREE, never NULL. */
const char *haft_outcome_advice(haft_outcome outcome);

/** The direction of a jump. */
typedef enum haft_jump_kind {
    HAFT_JUMP_PULL_IN,  /**< the gaps closed */
    HAFT_JUMP_PULL_OUT, /**< they opened */
} haft_jump_kind;

/** How a branch ended. A fold is a limit point: the load has an extremum along the branch. */
typedef enum haft_departure {
    HAFT_DEPARTURE_FOLD,          /**< in a simple fold */
    HAFT_DEPARTURE_BIFURCATION,   /**< stability was lost without a limit point of the load */
    HAFT_DEPARTURE_MULTIPLE_FOLD, /**< several eigenvalues vanished at once */
    HAFT_DEPARTURE_REST, /**< there was none: the laws pull the unloaded beam away from u = 0 */
} haft_departure;

/** One accepted state; energies, work and dissipation are sums from the start [J]. */
typedef struct haft_path_point {
    double load;            /**< P [N] */
    double deflection;      /**< w(x_P) [m] */
    double crack_length;    /**< [m] */
    double internal_energy; /**< strain energy */
    double contact_energy;  /**< sum A_r Phi_r(d_r) */
    double work;            /**< of the load */
    double dissipated;      /**< in jumps */
    double lambda_min; /**< smallest eigenvalue of H phi = lambda M phi, scaled, of the part that is
                          not frozen: > 0 */
    double least_pivot; /**< smallest pivot of the factored Hessian over its largest: > 0 */
    int phase;          /**< 0 loading, 1 unloading */
    int jump;           /**< index of the jump that led here, -1 if none */
} haft_path_point;

/** One jump at constant load. */
typedef struct haft_jump {
    haft_jump_kind kind;      /**< pull-in if the gaps closed */
    int phase;                /**< 0 loading, 1 unloading */
    haft_departure departure; /**< how the branch before ended */
    double load;              /**< of the fold [N] */
    int site; /**< the site that moves most in the fold's null vector; at rest, by the forces */
    int sites_switched;     /**< sites that came into or went out of reach */
    double crack_before;    /**< crack length at the fold [m] */
    double crack_after;     /**< and at the landing [m] */
    double dissipated;      /**< decrease of Pi at the fold's load [J], > 0 */
    double internal_before; /**< strain energy at the fold [J] */
    double internal_after;  /**< and at the landing [J] */
    int flow_steps;         /**< of the landing */
    double fold_defect; /**< |dP/dtau| left at the located fold, relative to the branch's own; 0 at
 other departures */
} haft_jump;

/** Counts of the solver's work. */
typedef struct haft_path_cost {
    size_t steps;             /**< accepted */
    size_t rejected;          /**< steps tried and halved */
    size_t newton_iterations; /**< of correctors, folds and landings */
    size_t factorizations;    /**< of a Hessian */
    size_t solves;            /**< with a factored Hessian */
    size_t folds;             /**< located */
    size_t flow_steps;        /**< of all landings */
    size_t unknowns; /**< summed over the factorizations, which have fewer than the model on shorter
                        meshes and while a part is frozen. Not kept in files */
} haft_path_cost;

/** A path, made by haft_solve_path() and owned by the caller. */
typedef struct haft_path {
    size_t points;          /**< accepted states */
    size_t jumps;           /**< between them */
    haft_path_point *point; /**< points */
    haft_jump *jump;        /**< jumps */
    double *state;          /**< points x dofs (keep_states), else NULL: scaled unknowns */
    double *final_state;    /**< dofs */
    size_t turn;            /**< index of the last point of the loading */
    bool turned_by_load;    /**< the loading ended at the load limit, not at the crack length */
    haft_outcome outcome;   /**< why it ended */
    double ledger_error;    /**< greatest |work - energy - dissipated| over the path, divided by the
                                 total |work| or, where that is more, by 1e-6 of the greatest
                                 |strain energy| + |contact energy| */
    double end_influence; /**< of the free end of a stuck beam on its crack's tip: the deflection at
                             the tip over that at the end, |w_tip / w_end|, due to a force at the
                             end. If it is small, a longer beam would give the same result. 0 for a
                             free beam and for a structure that is no beam, NaN if not solved */
    haft_path_cost cost;  /**< its cost */
    size_t point_capacity; /**< room in `point` */
    size_t jump_capacity;  /**< room in `jump` */
} haft_path;

/** Follows the load programme. A failure to converge is an outcome, not an error: the path holds
 *  what was followed so far. If the laws act on the beam at rest, the path begins where the
 *  gradient flow from u = 0 leads. If that is far, it is the path's first jump, and the first
 *  point is its landing.
 *  @param[out] out the path; NULL after a failure
 *  @param[in] model the structure
 *  @param[in] laws one a site of the model
 *  @param[in] programme of the load; its crack_length may be 0 or less, which no crack reaches,
 *  if its load_limit is finite
 *  @param[in] options how finely; NULL: all defaults
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_OK, HAFT_ERROR_MEMORY, HAFT_ERROR_ARGUMENT or HAFT_ERROR_LIBRARY. Thread-safe. */
haft_status haft_solve_path(haft_path **out, const haft_model *model, const haft_law *laws,
                            const haft_programme *programme, const haft_path_options *options,
                            haft_error *error) HAFT_MUST_CHECK;

/** Frees a path and sets the pointer to NULL; NULL is allowed. */
void haft_path_destroy(haft_path **path);

/** The summary of a path; a row of /summary in results.h5. */
typedef struct haft_summary {
    double crack_length;        /**< after unloading [m]; the beam's length if free */
    double loaded_crack_length; /**< where the loading ends [m] */
    double gamma;               /**< Eq. 36 [J/m^2]; 0 if free */
    double work;                /**< of the load [J] */
    double dissipated;          /**< in jumps [J] */
    double internal_energy;     /**< strain energy at rest [J] */
    double end_influence;       /**< see haft_path.end_influence */
    double ledger_error;        /**< see haft_path.ledger_error */
    double seconds;             /**< time taken; the one number that is not reproducible */
    int outcome;                /**< a haft_outcome */
    int jumps;                  /**< in loading and unloading */
    int steps;                  /**< accepted */
    int unfit;                  /**< sites whose curve no Morse law fits */
} haft_summary;

#ifdef __cplusplus
}
#endif
#endif
