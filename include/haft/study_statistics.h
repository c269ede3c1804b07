/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file study_statistics.h
 *  Statistics of runs and of stochastic models, with confidence intervals. */
#ifndef HAFT_STUDY_STATISTICS_H
#define HAFT_STUDY_STATISTICS_H

#include "haft/io.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A confidence interval; an end that the data do not bound is -INFINITY or INFINITY. */
typedef struct haft_interval {
    double low;  /**< lower end */
    double high; /**< upper end */
} haft_interval;

/** Confidence where a case gives none. */
#define HAFT_STUDY_CONFIDENCE 0.95

/** Interval of a mean: mean -+ t s / sqrt(n), t Student's quantile with n - 1 degrees of freedom;
 *  exact for normal data, good for any of finite variance and n beyond some tens.
 *  @param[in] mean of the data
 *  @param[in] deviation s, with n - 1
 *  @param[in] n how many they are
 *  @param[in] confidence in (0, 1)
 *  @return NaN for n < 2. Thread-safe. Source: Student (1908). */
haft_interval haft_study_mean_interval(double mean, double deviation, size_t n, double confidence);

/** Interval of a standard deviation: s sqrt((n-1) / chi2), chi2 the quantiles of n - 1 degrees of
 *  freedom; for normal data alone: heavier tails make it too narrow.
 *  @return NaN for n < 2. Thread-safe. */
haft_interval haft_study_deviation_interval(double deviation, size_t n, double confidence);

/** Interval of a probability of which k of n draws came true; its coverage is never below the
 *  confidence. @return NaN for n = 0. Thread-safe. Source: Clopper and Pearson (1934). */
haft_interval haft_study_share_interval(size_t k, size_t n, double confidence);

/** Ranks (from 1) of the order statistics between which the quantile of a continuous distribution
 *  lies with at least this confidence, whatever the distribution: P(B < low), P(B >= high) <= (1 -
 *  confidence) / 2 with B binomial of n and share.
 *  @param[in] n draws
 *  @param[in] share of the quantile, in (0, 1)
 *  @param[in] confidence in (0, 1)
 *  @param[out] low 0 where n is too small for a lower bound
 *  @param[out] high n + 1 where it is too small for an upper. Thread-safe. Source: Thompson (1936).
 */
void haft_study_quantile_ranks(size_t n, double share, double confidence, size_t *low,
                               size_t *high);

/** How many quantiles statistics give. */
enum { HAFT_STUDY_QUANTILES = 3 };

/** The shares themselves, rising: 0.05, 0.5, 0.95. */
extern const double haft_study_quantiles[HAFT_STUDY_QUANTILES];

/** Statistics of the crack lengths. Mean and deviation are of the beams that stuck; for quantiles a
 *  free beam is a length censored at the beam's end, and for both the failed ones do not count. */
typedef struct haft_statistics {
    size_t run;                            /**< beams that were followed */
    size_t stuck;                          /**< of them, at rest in contact */
    size_t free;                           /**< at rest and touching nowhere */
    size_t failed;                         /**< not followed to the end */
    double confidence;                     /**< of the intervals */
    double mean;                           /**< [m], NaN where too few */
    double deviation;                      /**< with n - 1 [m], NaN where too few */
    double standard_error;                 /**< of the mean [m], NaN where too few */
    haft_interval mean_interval;           /**< [m] Student */
    haft_interval deviation_interval;      /**< [m] chi-square: assumes normal crack lengths */
    double least;                          /**< [m] */
    double greatest;                       /**< [m] */
    double quantile[HAFT_STUDY_QUANTILES]; /**< [m]; INFINITY if it lies among the free beams */
    haft_interval quantile_interval[HAFT_STUDY_QUANTILES]; /**< [m] free of a distribution; among
                                                              the free from the beam's length on */
    double stuck_share;           /**< of the beams that stuck or are free; NaN if there are none */
    haft_interval stuck_interval; /**< Clopper-Pearson */
    double gamma;                 /**< Eq. 36 of the mean crack length [J/m^2] */
    double jumps;                 /**< a realization, mean */
    double seconds;               /**< a realization, mean */
    double internal_energy;       /**< a beam that stuck or is free, mean [J] */
    double dissipated;            /**< the same */
    double end_influence;         /**< the greatest; see haft_path.end_influence */
    double ledger_error;          /**< the greatest */
    size_t unfit;                 /**< in all */
} haft_statistics;

/**
 *  @param[in] c its study.stop.confidence is the intervals', 0 the default
 *  @param[in] summary [n] beams; outcome -1 where one was not run
 *  @param[in] n how many
 *  Thread-safe. */
haft_statistics haft_study_statistics(const haft_case *c, const haft_summary *summary, size_t n);

/** An expansion of a germ and order, and its errors (haft_chaos_measure(), with 16384 samples; the
 *  relMISE by an independent rule with HAFT_STUDY_MAPS maps). */
typedef struct haft_order_error {
    haft_chaos_germ germ;     /**< its variables */
    size_t order;             /**< N_d */
    size_t terms;             /**< how many it has */
    haft_chaos_errors errors; /**< measured */
} haft_order_error;

/** Number of maps that expansions are compared with, the same for all of them. */
enum { HAFT_STUDY_MAPS = 32768 };

/** Measures the errors of expansions of the model of a set of laws.
 *  @param[in] laws with a model
 *  @param[in] c whose law.chaos it was built by
 *  @param[in] n expansions
 *  @param[in,out] out [n] germs and orders in, terms and errors out
 *  @param[out] error one message where it fails; may be NULL */
haft_status haft_study_model_orders(const haft_laws *laws, const haft_case *c, size_t n,
                                    haft_order_error *out, haft_error *error) HAFT_MUST_CHECK;

/** Number of orders in figures and tables of convergence, and of rows for all germs. */
enum { HAFT_STUDY_ORDERS = 9, HAFT_STUDY_ORDER_ROWS = 3 * HAFT_STUDY_ORDERS };

/** Sets germ and order of each row, germ by germ. Thread-safe. */
void haft_study_list_orders(haft_order_error row[HAFT_STUDY_ORDER_ROWS]);

/** The error of a model of m vectors against that of all vectors, [j] for principal component j
 *  of all: means over up to 8 disjoint parts of the vectors. */
typedef struct haft_vectors_error {
    size_t m;                                   /**< vectors of each part */
    size_t parts;                               /**< disjoint, of all vectors */
    double density[HAFT_CHAOS_DIMENSION];       /**< relMISE of the kernel density of eta_j,
                                                 *   int (p_m - p)^2 / int p^2 */
    double density_error[HAFT_CHAOS_DIMENSION]; /**< standard error over the parts; NaN for one */
    double w1[HAFT_CHAOS_DIMENSION]; /**< Wasserstein-1 distance of the expansion's eta_j from all
                                      *   vectors' [standard deviations] */
    double relmise;                  /**< of the expansion from the part's own map (Eq. C.10) */
} haft_vectors_error;

/** Measures the convergence of a model in the number of its vectors.
 *  @param[in] laws with a model
 *  @param[in] c whose law.chaos it was built by
 *  @param[in] n numbers to try
 *  @param[in] m [n], at most the model's
 *  @param[out] out [n]
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_ARGUMENT for more vectors than there are; HAFT_ERROR_INPUT for too few for
 *  a model. */
haft_status haft_study_model_vectors(const haft_laws *laws, const haft_case *c, size_t n,
                                     const size_t *m, haft_vectors_error *out,
                                     haft_error *error) HAFT_MUST_CHECK;

enum { HAFT_STUDY_PARTS = 8 };

/** Numbers of vectors worth studying, rising: all, half, a quarter, ... down to 40.
 *  @return how many. Thread-safe. */
size_t haft_study_model_parts(const haft_laws *laws, size_t m[HAFT_STUDY_PARTS]);

/** A correlation, its standard error, and its number of pairs. */
typedef struct haft_correlation {
    double value; /**< rho_l */
    double error; /**< by leaving out one realization at a time; NaN if there is one */
    size_t pairs; /**< it is the mean of */
} haft_correlation;

/** Normalised spatial correlation of a number along surfaces,
 *      rho_l = mean over pairs of (x_r - mean) (x_{r+l} - mean) / variance,
 *  mean and variance over all. Numbers that are not finite are left out with their pairs.
 *  @param[in] realizations surfaces
 *  @param[in] sites of each
 *  @param[in] x [realizations][sites], stride apart
 *  @param[in] stride from a number to the next
 *  @param[in] lags below sites
 *  @param[out] out [lags + 1], from rho_0 = 1; NaN where all numbers are one
 *  Source: Hoang et al. (2017), Eq. 35; Quenouille (1949). Thread-safe.
 *  @param[out] error one message where it fails; may be NULL */
haft_status haft_study_correlation(size_t realizations, size_t sites, const double *x,
                                   size_t stride, size_t lags, haft_correlation *out,
                                   haft_error *error) HAFT_MUST_CHECK;

/** The correlations of e, f_max, d_max and d_limit of a set of explicit laws.
 *  @param[in] laws of explicit beams
 *  @param[in] lags below the sites
 *  @param[out] out [4][lags + 1]
 *  @param[out] error one message where it fails; may be NULL */
haft_status haft_study_correlate_laws(const haft_laws *laws, size_t lags,
                                      haft_correlation *const out[4],
                                      haft_error *error) HAFT_MUST_CHECK;

#ifdef __cplusplus
}
#endif
#endif
