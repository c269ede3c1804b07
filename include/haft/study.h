/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file study.h
 *  What the programs do: build the laws of a case, follow its realizations, gather their
 * statistics, and lay out the data of its figures. */
#ifndef HAFT_STUDY_H
#define HAFT_STUDY_H

#include "haft/io.h"

#ifdef __cplusplus
extern "C" {
#endif

/** How a long computation speaks to whoever started it. Any member may be NULL; calls come from one
 *  thread at a time, not always the same. */
typedef struct haft_progress {
    void (*advance)(void *user, const char *stage, size_t done,
                    size_t total);              /**< how far a stage has come */
    void (*note)(void *user, const char *text); /**< a sentence worth telling, no line end */
    bool (*stop)(void *user);                   /**< true: end early, keeping what is done */
    void *user;                                 /**< handed to each of them */
} haft_progress;

/** What acts in a case's contacts: capillary, van der Waals forces, the equivalent modulus. The
 * table that has_vdw needs is the caller's to make. */
haft_status haft_study_contact_spec(haft_contact_spec *out, const haft_case *c,
                                    haft_error *error) HAFT_MUST_CHECK;

/** Thickness of the water film adsorbed on each face at the case's humidity [m], 0 if it wants
 * none. Menisci then reach from film to film: the capillary range is that of Kelvin's law and both
 * films. A choice of Haft's: the film's own pressure on Kelvin's law is left out. */
double haft_study_film(const haft_case *c);

/** The plan of a case's surfaces.
 *  @param[out] out the plan; NULL after a failure
 *  @param[in] c the case
 *  @param[in] patches how many patches of l_meso a block holds
 *  @param[out] error one message where it fails; may be NULL */
haft_status haft_study_surface_plan(haft_surface_plan **out, const haft_case *c, size_t patches,
                                    haft_error *error) HAFT_MUST_CHECK;

/** The windows of maps that a case's patches are laid out of; NULL where its surfaces are
 * generated. */
haft_status haft_study_tiling(haft_tiling **out, const haft_case *c,
                              haft_error *error) HAFT_MUST_CHECK;

/** How many patches a block of the seamless surface holds: a matter of memory, the same for any
 *  number of threads. 1 for independent patches. */
size_t haft_study_block_patches(const haft_case *c);

/** Law vector of every patch of every realization that can come into range, with the curves the
 *  case keeps, in parallel over blocks and all in memory; the same bits for any number of threads.
 *  With a stochastic sampler instead: those of law.chaos.vectors independent patches, and the model
 *  built from them.
 *  @return HAFT_ERROR_INTERRUPTED if stopped, with *out NULL. */
haft_status haft_study_build_laws(haft_laws **out, const haft_case *c,
                                  const haft_progress *progress, haft_error *error) HAFT_MUST_CHECK;

/** The same of n cases of stochastic samplers that have the same patches, each surface made once
 *  for all of them.
 *  @param[out] out [n]; NULL where a case's patches do not make its model, which does not fail:
 *  built alone it tells why
 *  @param[in] c [n] cases of one haft_case_patches_digest()
 *  @param[in] n how many, > 0
 *  @param[in] progress may be NULL
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_INTERRUPTED if stopped; after a failure all are NULL. */
haft_status haft_study_build_laws_together(haft_laws **out, const haft_case *const *c, size_t n,
                                           const haft_progress *progress,
                                           haft_error *error) HAFT_MUST_CHECK;

/** Digest of the laws a case uses: of its inputs, and of the vectors too where the laws at `path`
 *  were fitted to some by those inputs. */
haft_status haft_study_laws_digest(char digest[HAFT_DIGEST_CAPACITY], const haft_case *c,
                                   const char *path, haft_error *error) HAFT_MUST_CHECK;

/** Brings a case's laws into memory: reads `path` if it was built from the same inputs. Else a
 * model is built and written, saying why through `note`; the laws of beams with surfaces of their
 * own are left to haft_study_run().
 *  @param[out] out NULL where there are none yet of beams' own; those that there are may lack some
 *  realizations: see haft_study_has_laws()
 *  @param[out] digest of the inputs
 *  @param[in] c the case
 *  @param[in] path of laws.h5
 *  @param[in] progress may be NULL
 *  @param[out] error one message where it fails; may be NULL */
haft_status haft_study_obtain_laws(haft_laws **out, char digest[HAFT_DIGEST_CAPACITY],
                                   const haft_case *c, const char *path,
                                   const haft_progress *progress,
                                   haft_error *error) HAFT_MUST_CHECK;

/** Builds the stochastic model of a case from the sound vectors of `laws`, with the errors of its
 *  expansion, into laws->chaos and laws->errors.
 *  @return HAFT_ERROR_INPUT if the vectors or the choices do not make a model: the message says
 *  what would. */
haft_status haft_study_build_chaos(haft_laws *laws, const haft_case *c,
                                   haft_error *error) HAFT_MUST_CHECK;

/** Laws without curves: vectors measured elsewhere, and the model built from them by the case's
 *  choices. A vector that has no Morse law is counted by its fault and left out of the model. */
haft_status haft_study_fit_laws(haft_laws **out, const haft_case *c, size_t m,
                                const haft_law_vector *vector, haft_error *error) HAFT_MUST_CHECK;

/** Vectors of sites 0 .. n - 1 of a realization, drawn from the model by the case's sampler.
 *  @param[in] laws with a model
 *  @param[in] c whose sampler and seed
 *  @param[in] realization the beam
 *  @param[in] n sites
 *  @param[out] vector [n]
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_INPUT if the case's sampler is no stochastic one. Thread-safe. */
haft_status haft_study_draw(const haft_laws *laws, const haft_case *c, size_t realization, size_t n,
                            haft_law_vector *vector, haft_error *error) HAFT_MUST_CHECK;

/** Draws n vectors, those of sites 0 .. n - 1 of realization 0, by the case's sampler and writes
 *  them as CSV. @return HAFT_ERROR_INPUT if the case's sampler is no stochastic one. */
haft_status haft_study_write_sample(const haft_laws *laws, const haft_case *c, size_t n,
                                    const char *path, haft_error *error) HAFT_MUST_CHECK;

/** How many patches stand behind a case's laws: realizations times the sites that can come into
 *  range, or those of the model. */
size_t haft_study_law_count(const haft_case *c);

/** Sites of a case's beam. */
size_t haft_study_sites(const haft_case *c);

/** The first of them that can come into range and has laws of its own; 0 where laws are drawn. */
size_t haft_study_first_site(const haft_case *c);

/** Whether laws (NULL: none), built from the case's inputs for its beams' own surfaces, hold all
 *  the sites of a realization that can come into range. Thread-safe. */
bool haft_study_has_sites(const haft_case *c, const haft_laws *laws, size_t realization);

/** Whether they hold them with all the curves that the solver takes. Thread-safe. */
bool haft_study_has_laws(const haft_case *c, const haft_laws *laws, size_t realization);

/** Whether a case's beams draw patches and take their curves, whatever form these have: a bootstrap
 *  of tables, which needs patches but no model of them. Thread-safe. */
bool haft_study_draws_patches(const haft_case *c);

/** A copy of one set of laws, which is a realization's or a model's patches, with such sites and
 *  curves as the case keeps.
 *  @param[out] out the copy; NULL after a failure
 *  @param[in] c which sites and curves it keeps
 *  @param[in] laws copied from
 *  @param[in] set number of the realization within `laws`
 *  @param[in] realization its number in the case
 *  @param[out] error one message where it fails; may be NULL */
haft_status haft_study_take_laws(haft_laws **out, const haft_case *c, const haft_laws *laws,
                                 size_t set, size_t realization, haft_error *error) HAFT_MUST_CHECK;

/** How many laws of a set carry each fault. Thread-safe. */
void haft_study_count_faults(const haft_laws *laws, size_t count[HAFT_LAW_FAULTS]);

/** The laws of one realization as the solver takes them; the tables behind them are its own. */
typedef struct haft_site_laws {
    size_t sites;            /**< of the beam */
    size_t unfit;            /**< sites whose curve no Morse law fits */
    haft_law *law;           /**< sites */
    size_t tables;           /**< of the sites or, where patches are drawn, of all these */
    haft_law_table **table;  /**< tables; NULL where there is none, nobody drew it, or the laws that
                                  it came from have it: they must outlive these */
    haft_law_vector *vector; /**< sites; NaN where a curve has none */
} haft_site_laws;

/** Those of the patches, or drawn from the model where the case's sampler is a stochastic one. The
 *  law of the active zone that reaches farthest stands for those of the sites before the zone.
 *  @return HAFT_ERROR_INPUT if a curve cannot be used and the case says stop, or if a drawn vector
 *  has no Morse law (as the paper's bounds allow), naming the site. Thread-safe. */
haft_status haft_study_site_laws(haft_site_laws **out, const haft_case *c, const haft_laws *laws,
                                 size_t realization, haft_error *error) HAFT_MUST_CHECK;

/** Makes the law of a site from the first of the laws, as haft_study_site_laws() does, and drops
 * it.
 *  @param[in] c the case
 *  @param[in] laws one at least
 *  @param[in] site for messages, and how many sites before it there are
 *  @param[out] error why there is no law; may be NULL
 *  @return HAFT_ERROR_INPUT as haft_study_site_laws(). Thread-safe. */
haft_status haft_study_try_law(const haft_case *c, const haft_laws *laws, size_t site,
                               haft_error *error) HAFT_MUST_CHECK;

/** Takes the steps that a run of the case takes first, without following a beam: mesh, surfaces or
 *  windows of maps, forces, and the law of the first site of realization 0 where laws are built
 * from curves. So what a run would refuse there is known before it, by the same message.
 *  @param[in] c the case
 *  @param[in] laws whether surfaces, forces and law are tried too, which may take seconds
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_INPUT with what a run would refuse. Not thread-safe (FFTW's planner). */
haft_status haft_study_check(const haft_case *c, bool laws, haft_error *error) HAFT_MUST_CHECK;

/** Frees them and sets the pointer to NULL; NULL is allowed. */
void haft_site_laws_destroy(haft_site_laws **laws);

/** Follows one realization and sums it up. Thread-safe. */
haft_status haft_study_realize(haft_path **out, haft_summary *summary, const haft_case *c,
                               const haft_model *model, const haft_site_laws *laws,
                               bool keep_states, haft_error *error) HAFT_MUST_CHECK;

/** Joins the processes that `mpirun` started for this program (MPI_Init_thread); to be called first
 *  thing in main, by the thread that will call haft_study_run(). Does nothing where Haft was built
 *  without HAFT_MPI. */
void haft_study_ranks_begin(void);

/** Leaves them again (MPI_Finalize), if they were joined; fit for atexit(). */
void haft_study_ranks_end(void);

/** This process's number among them, from 0. */
int haft_study_rank(void);

/** How many they are; 1 where there are no others. */
int haft_study_ranks(void);

/** Are all of them ready? Each must call it once, ready or not, before each haft_study_run(), which
 *  none then calls unless all are. */
bool haft_study_ranks_agree(bool ready);

/** Where a run finds its laws and keeps what it makes. */
typedef struct haft_run_files {
    const char *laws;    /**< laws.h5: read, or built where its inputs changed */
    const char *results; /**< results.h5 */
    const char *parts;   /**< folder of the realizations of an unfinished run */
    const char *folder;  /**< the case's, as messages name it */
    /** Writes what lies beside the results, once they are in place and before the parts go: so a
     * run killed in between is resumed. May be NULL. */
    haft_status (*beside)(void *user, const haft_summary *summary, const haft_laws *laws,
                          haft_error *error);
    void *user; /**< handed to it */
} haft_run_files;

/** What a run does about what is there already. */
typedef enum haft_run_mode {
    HAFT_RUN_NEW,    /**< nothing of an earlier run may be there */
    HAFT_RUN_ANEW,   /**< replaces what is there */
    HAFT_RUN_RESUME, /**< does what an unfinished run has left to do */
    HAFT_RUN_MERGE,  /**< makes the results of parts that leave nothing to do, and does nothing else
                      */
} haft_run_mode;

/** Runs the realizations of a case over OpenMP threads, and over ranks where there are several: all
 *  call it with the same arguments and see the same files; rank 0 builds the model that
 *  laws are drawn from, hands out the realizations one by one, tells progress, and makes the
 * results; the others return HAFT_OK with nothing to tell, or HAFT_ERROR_INTERRUPTED where rank 0
 * returns a failure. Where beams have laws of their own, those that laws.h5 does not hold are built
 * by whoever follows the beam, just before. Each realization is appended to a part file, its laws
 * with it, as soon as it is done, so that a run ended by whatever means loses only what was in
 * work; at the end the parts become the laws and results files, in order of realization, and go.
 * (Fewer beams than threads, of one process and without a stop rule, have their laws built by all
 * threads together first.) The same bits for any number of threads, ranks and interruptions, but
 * for /summary/seconds; but laws.h5 may keep more beams' laws than a run needs if they were there
 * before.
 *
 *  Stop rule (case key study.stop.crack_length_mean): the run needs only the realizations 0 to n-1,
 *  n the least multiple of HAFT_STOP_STRIDE from HAFT_STOP_LEAST on for which half the width of the
 *  mean's interval over them is at most that; what was done beyond is dropped.
 *
 *  A shard follows its own realizations and leaves them in parts of its own, which HAFT_RUN_MERGE
 *  (or RESUME) turns into the same files as a single run's. NEW goes on from the shard's own parts,
 *  ANEW clears them first. Shards share nothing but the folder of parts, or not even that: parts
 *  may be copied into one. A shard looks at no stop rule, and a model that its laws are drawn from
 *  must have been built before.
 *
 *  Stopped through `progress`, it keeps the parts and, if no shard, writes the results done so far
 *  as well.
 *  @param[in] c the case
 *  @param[in] files where all is
 *  @param[in] mode what to do about what is there
 *  @param[in] progress may be NULL
 *  @param[in] shard {0} for all realizations; only with NEW and ANEW
 *  @param[out] summary the case's realizations; outcome -1 where one was not run or was dropped;
 *  rank 0's alone
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_EXISTS if results or parts are there (NEW) or another process is at work on
 *  them; HAFT_ERROR_INPUT if there is nothing to resume or merge, or not all of it to merge (the
 *  message tells the shards that lack and the command that does them), or it belongs to another
 *  case, other laws or another build; HAFT_ERROR_INTERRUPTED if stopped, after writing. After any
 * failure the parts stay where they hold anything. */
haft_status haft_study_run(haft_summary *summary, const haft_case *c, const haft_run_files *files,
                           haft_run_mode mode, haft_shard shard, const haft_progress *progress,
                           haft_error *error) HAFT_MUST_CHECK;

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
    double quantile[HAFT_STUDY_QUANTILES]; /**< [m]; INFINITY where it lies among the free */
    haft_interval quantile_interval[HAFT_STUDY_QUANTILES]; /**< [m] free of a distribution; among
                                                              the free from the beam's length on */
    double stuck_share;           /**< of those that stuck or are free; NaN if there is none */
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

/** Maps that expansions are held against, the same for all of them. */
enum { HAFT_STUDY_MAPS = 32768 };

/** Studies the model of a set of laws in its expansion.
 *  @param[in] laws with a model
 *  @param[in] c whose law.chaos it was built by
 *  @param[in] n expansions
 *  @param[in,out] out [n] germs and orders in, terms and errors out
 *  @param[out] error one message where it fails; may be NULL */
haft_status haft_study_model_orders(const haft_laws *laws, const haft_case *c, size_t n,
                                    haft_order_error *out, haft_error *error) HAFT_MUST_CHECK;

/** The orders that figures and tables of convergence go through, and rows of all germs in them. */
enum { HAFT_STUDY_ORDERS = 9, HAFT_STUDY_ORDER_ROWS = 3 * HAFT_STUDY_ORDERS };

/** Sets germ and order of each row, germ by germ. Thread-safe. */
void haft_study_list_orders(haft_order_error row[HAFT_STUDY_ORDER_ROWS]);

/** What a model of m vectors lacks of one of all, [j] for principal component j of all; means over
 *  up to 8 disjoint parts of the vectors. */
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

/** Studies the model of a set of laws in the number of its vectors.
 *  @param[in] laws with a model
 *  @param[in] c whose law.chaos it was built by
 *  @param[in] n numbers to try
 *  @param[in] m [n], at most the model's
 *  @param[out] out [n]
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_ARGUMENT for more than there are; HAFT_ERROR_INPUT if so few make no model.
 */
haft_status haft_study_model_vectors(const haft_laws *laws, const haft_case *c, size_t n,
                                     const size_t *m, haft_vectors_error *out,
                                     haft_error *error) HAFT_MUST_CHECK;

enum { HAFT_STUDY_PARTS = 8 };

/** Numbers of vectors worth studying, rising: all, half, a quarter, ... down to 40.
 *  @return how many. Thread-safe. */
size_t haft_study_model_parts(const haft_laws *laws, size_t m[HAFT_STUDY_PARTS]);

/** Writes the data of a model's figures into `directory`, which must exist: generated.csv (ten laws
 *  drawn, Fig. 14b of Hoang et al.), reduction.csv (the error of leaving components out, Fig. 16),
 *  components.csv and joint.csv (densities of the components, Fig. 17), marginals.csv (of the law
 *  vectors' numbers, Fig. 18), parts.csv and density.csv (convergence in the number of vectors,
 *  Fig. B.22), orders.csv and map.csv (in the order, Fig. C.23).
 *  @param[in] c the case
 *  @param[in] laws with a model
 *  @param[in] directory they are written into
 *  @param[out] error one message where it fails; may be NULL */
haft_status haft_study_write_model_figures(const haft_case *c, const haft_laws *laws,
                                           const char *directory,
                                           haft_error *error) HAFT_MUST_CHECK;

/** A correlation, its standard error, and how many pairs it is of. */
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

/** That of e, f_max, d_max, d_limit of a set of explicit laws.
 *  @param[in] laws of explicit beams
 *  @param[in] lags below the sites
 *  @param[out] out [4][lags + 1]
 *  @param[out] error one message where it fails; may be NULL */
haft_status haft_study_correlate_laws(const haft_laws *laws, size_t lags,
                                      haft_correlation *const out[4],
                                      haft_error *error) HAFT_MUST_CHECK;

/** Writes it for up to 20 patches as correlation.csv, with intervals by Student's t over the
 *  realizations (Fig. 15 of Hoang et al.). */
haft_status haft_study_write_correlation(const haft_case *c, const haft_laws *laws,
                                         const char *directory, haft_error *error) HAFT_MUST_CHECK;

/** One variant of a sweep, run. */
typedef struct haft_variant {
    const haft_case *c;         /**< the variant */
    haft_statistics statistics; /**< of its beams */
} haft_variant;

/** Writes sweep.csv, one row a variant: its number, the swept values in SI, and its statistics. */
haft_status haft_study_write_sweep(const haft_variant *variant, size_t variants, const char *path,
                                   haft_error *error) HAFT_MUST_CHECK;

/** Writes DIRECTORY/water.csv: Laplace pressure and height of the water between the faces, films
 *  included, from RH 30 to 99 %, for the liquid of a case that has a capillary. */
haft_status haft_study_write_water(const haft_case *c, const char *directory,
                                   haft_error *error) HAFT_MUST_CHECK;

/** Writes what a case's surfaces look like (Figs. 3 and 11 of Hoang et al., 2017): surface.csv,
 *  heights of a square piece of the first one; psd.csv, the radial PSD asked for; and rings.csv,
 * that of a piece of 6 um (of maps: of a patch) by the beam's width, at most 4096 points a side,
 * windowed by sin^2, with its standard error over its own value and the PSD asked for there. A
 * piece of fewer than 16 waves' halves a side has no rings: one row of NaN.
 *  @param[in] c the case, its files read
 *  @param[in] directory they are written into; must exist
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_OK, HAFT_ERROR_MEMORY, HAFT_ERROR_IO, or what making the surface failed with.
 *  Not thread-safe (FFTW planner). */
haft_status haft_study_write_surface(const haft_case *c, const char *directory,
                                     haft_error *error) HAFT_MUST_CHECK;

/** Writes summary.csv, one row a realization. */
haft_status haft_study_write_summary(const haft_summary *summary, size_t n, const char *path,
                                     haft_error *error) HAFT_MUST_CHECK;

/** Writes convergence.csv: mean and standard deviation of the crack length with their intervals
 * over the first n beams, for up to 2000 n up to all (Fig. 19a, b). */
haft_status haft_study_write_convergence(const haft_case *c, const haft_summary *summary, size_t n,
                                         const char *path, haft_error *error) HAFT_MUST_CHECK;

/** Writes laws.csv, one row a law: its vector, its fault (a haft_law_fault) and what its patch
 * looks like where the force vanishes. */
haft_status haft_study_write_laws(const haft_laws *laws, const char *path,
                                  haft_error *error) HAFT_MUST_CHECK;

/** The beam's shapes at the accepted states of a realization's path: its evidence, or of following
 * it again where it left none. Thread-safe but for HDF5, see haft/io.h. */
haft_status haft_study_shapes(haft_results_shapes **out, const haft_case *c, const haft_laws *laws,
                              const char *results_path, size_t realization,
                              haft_error *error) HAFT_MUST_CHECK;

/** Writes the data of a case's figures as CSV into `directory`, which must exist: those of
 *  haft_study_write_surface(), laws.csv (ten curves of realization 0 and the laws they became),
 *  vectors.csv (those laws' e, f_max, d_max, d_limit), and of `realization`: shapes.csv (heights in
 *  loading and unloading, those about each phase's greatest jump marked), energy.csv and jumps.csv
 *  (internal energy against crack length, and its jumps). */
haft_status haft_study_write_figures(const haft_case *c, const haft_laws *laws,
                                     const char *results_path, size_t realization,
                                     const char *directory, haft_error *error) HAFT_MUST_CHECK;

#ifdef __cplusplus
}
#endif
#endif
