/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file study_report.h
 *  Reports on finished runs: comparison of two runs, the assumptions behind a run, and the error
 *  of its mean due to each approximation. */
#ifndef HAFT_STUDY_REPORT_H
#define HAFT_STUDY_REPORT_H

#include "haft/study.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- two results beside each other ---- */

/** Interval of the difference of two means whose deviations may differ, second less first:
 *  Student's t with the degrees of freedom of Welch and Satterthwaite.
 *  @param[in] mean of the two sets
 *  @param[in] deviation with n - 1
 *  @param[in] n how many of each
 *  @param[in] confidence in (0, 1)
 *  @return NaN where one has fewer than two. Thread-safe. Source: Welch (1947). */
haft_interval haft_study_difference_interval(const double mean[2], const double deviation[2],
                                             const size_t n[2], double confidence);

/** Crack lengths of a second set of beams compared with those of a first. Differences are second
 *  minus first, over the beams that stuck. Free beams count in the shares, and in the test of
 *  the two distributions as longer than any other. */
typedef struct haft_difference {
    double confidence;                 /**< of the intervals */
    double difference;                 /**< of the means [m] */
    double mean_error;                 /**< standard error of that difference [m] */
    haft_interval difference_interval; /**< Welch: takes the two sets as independent */
    double
        distance; /**< greatest distance of the two empirical distributions (Kolmogorov-Smirnov) */
    double p_value;         /**< of at least this distance if both have one distribution */
    double deviation_shift; /**< of the standard deviations [m] */
    double deviation_error; /**< its standard error from fourth moments, for any distribution [m] */
    double w1;              /**< Wasserstein-1 distance of those that stuck [m] */
    double w1_error;        /**< its standard error by the bootstrap [m] */
    double w1_by_chance;    /**< its mean if both had one distribution, by permutation [m] */
    double share_difference;      /**< of the shares that stuck */
    haft_interval share_interval; /**< from the two Clopper-Pearson intervals by Newcombe's (1998)
                                     square-and-add rule */
    bool paired;            /**< both have the same seed: beam k of one is beam k of the other */
    size_t pairs;           /**< k stuck in both */
    size_t switched;        /**< k stuck in one and free in the other */
    double pair_difference; /**< mean over the pairs [m] */
    double pair_deviation;  /**< standard deviation of the differences [m] */
    haft_interval pair_interval; /**< Student [m] */
    double correlation;          /**< of the pairs' crack lengths; the gain of pairing */
} haft_difference;

/** Compares a second set of beams with a first; beams that were not run or failed are left out.
 *  Numbers that need two stuck beams in each set are NaN if there are fewer. Bootstrap and
 *  permutation take 400 rounds with a fixed seed, so the result is reproducible.
 *  @param[out] out what differs
 *  @param[in] first, second their cases
 *  @param[in] first_beam, first_beams the first's beams and how many
 *  @param[in] second_beam, second_beams the second's
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_MEMORY. Thread-safe. */
haft_status haft_study_differ(haft_difference *out, const haft_case *first,
                              const haft_summary *first_beam, size_t first_beams,
                              const haft_case *second, const haft_summary *second_beam,
                              size_t second_beams, haft_error *error) HAFT_MUST_CHECK;

/** Probability that the greatest distance of two samples' empirical distributions is as great as
 *  `distance` if both are of one continuous distribution: exact where the smaller has 200 values at
 *  most and n1 n2 is 1e6 at most, else asymptotic with Stephens' correction. Ties make the truth
 *  smaller. @return NaN for an empty sample. Thread-safe. Source: Hodges (1958), Stephens (1970).
 */
double haft_study_kolmogorov(double distance, size_t n1, size_t n2);

/* ---- what a result rests on ---- */

/** What came of trying something. */
typedef enum haft_verdict {
    HAFT_VERDICT_HOLDS,    /**< as it should */
    HAFT_VERDICT_UNKNOWN,  /**< the case does not say enough to tell */
    HAFT_VERDICT_DOUBTFUL, /**< at the edge of where it may be used */
    HAFT_VERDICT_BROKEN,   /**< outside of where it may be used */
} haft_verdict;

/** One thing that a result rests on, tried. */
typedef struct haft_finding {
    const char *subject;  /**< a few words */
    bool assumption;      /**< of the model; else of its computation */
    haft_verdict verdict; /**< what came of it */
    double value;         /**< the number it was judged by, in SI */
    double limit;         /**< the bound it was held against; NaN for none */
    char text[480]; /**< whole sentences, with numbers and units, for someone new to the method */
} haft_finding;

enum { HAFT_FINDINGS_MAX = 24 };

/** All that was tried. */
typedef struct haft_findings {
    size_t count;                            /**< how many */
    haft_finding finding[HAFT_FINDINGS_MAX]; /**< count, in the order they are told */
} haft_findings;

/** Tries all that a finished run rests on: certificates and ledger of every beam, resolved scales,
 *  the number of beams; and of the model the separation of scales, elastic asperities, separate
 *  menisci, laws used where they were computed.
 *  @param[out] out what was found
 *  @param[in] c the case
 *  @param[in] laws its laws
 *  @param[in] results_path of results.h5
 *  @param[in] summary its beams
 *  @param[in] realization whose shapes stand for all
 *  Not thread-safe (HDF5, FFTW planner).
 *  @param[out] error one message where it fails; may be NULL */
haft_status haft_study_find(haft_findings *out, const haft_case *c, const haft_laws *laws,
                            const char *results_path, const haft_summary *summary,
                            size_t realization, haft_error *error) HAFT_MUST_CHECK;

/** The least distance from which the autocorrelation of a case's surface stays below `share` of
 *  its variance [m], to the grid's step; the patch's width if that is shorter. Not thread-safe
 *  (FFTW planner). Source: Hoang et al. (2017), Sec. 4.1, with 1 %. */
haft_status haft_study_correlation_length(double *length, const haft_case *c, double share,
                                          haft_error *error) HAFT_MUST_CHECK;

/* ---- the error budget ---- */

/** What a crack length owes to one choice of its case: the same beams with that choice changed. */
typedef struct haft_budget_term {
    char name[32];     /**< for tables: "grid step" */
    char change[128];  /**< "5 nm to 2.5 nm" */
    bool measured;     /**< false: `change` says why there is nothing to measure */
    bool refinement;   /**< towards the model's own limit; else another model of the same thing */
    bool paired;       /**< the same beams in both; else independent ones */
    size_t beams;      /**< that stuck, in both or in the smaller set */
    size_t switched;   /**< stuck in one, free in the other; of paired ones */
    double from;       /**< mean crack length without the change [m] */
    double to;         /**< and with it [m] */
    double shift;      /**< mean change of the crack length [m] */
    double half_width; /**< of its interval [m] */
    double cost;       /**< time of a beam, laws included, with the change over that without */
} haft_budget_term;

enum { HAFT_BUDGET_TERMS_MAX = 12 };

/** What a mean crack length owes to all choices of its case. */
typedef struct haft_budget {
    size_t beams;                                 /**< followed for each term */
    double confidence;                            /**< of half widths */
    double mean;                                  /**< of the case as it is, over these beams [m] */
    size_t count;                                 /**< terms */
    haft_budget_term term[HAFT_BUDGET_TERMS_MAX]; /**< count, each change alone */
    double sampling;           /**< half width of the mean over all beams of the case [m] */
    size_t sampled;            /**< how many those are */
    double total;              /**< sum of |shift| over the refinements [m] */
    double total_half_width;   /**< of it, root of the sum of their squares [m] */
    double models;             /**< sum of |shift| over the other models [m] */
    haft_budget_term together; /**< all refinements at once */
    haft_budget_term
        interaction; /**< what those change beyond the sum of the refinements one by one, beam by
                          beam; not measured where a term has other beams on its two sides */
} haft_budget;

/** Measures the budget of a case's mean crack length: for each approximation the beams 0 to
 *  beams - 1 are followed with and without it. Laws and beams of a term have random numbers in
 *  common wherever the two share what they are drawn for.
 *  @param[out] out the budget
 *  @param[in] c the case
 *  @param[in] beams a term, at least 2
 *  @param[in] headline statistics of the whole run, for the sampling error; NULL: of these beams
 *  @param[in] directory an existing folder: the resolved cases of the variants are kept there
 *  @param[in] progress may be NULL
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_ARGUMENT for fewer than 2 beams; HAFT_ERROR_INTERRUPTED if stopped. Not
 *  thread-safe. */
haft_status haft_study_budget(haft_budget *out, const haft_case *c, size_t beams,
                              const haft_statistics *headline, const char *directory,
                              const haft_progress *progress, haft_error *error) HAFT_MUST_CHECK;

/** Writes budget.csv: a row a term, then the sample, all refinements at once, and the totals. Its
 *  last column is the digest of the case, so that a stale one is known. */
haft_status haft_study_write_budget(const haft_budget *budget, const haft_case *c, const char *path,
                                    haft_error *error) HAFT_MUST_CHECK;

/** Reads budget.csv back.
 *  @return HAFT_ERROR_IO if it cannot be opened; HAFT_ERROR_INPUT if it is no such file or is of
 *  another case than c, saying how to make it anew. */
haft_status haft_study_read_budget(haft_budget *out, const haft_case *c, const char *path,
                                   haft_error *error) HAFT_MUST_CHECK;

#ifdef __cplusplus
}
#endif
#endif
