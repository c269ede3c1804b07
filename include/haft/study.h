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
    void (*advance)(void *user, const char *stage, size_t done, size_t total);
    void (*note)(void *user, const char *text); /**< a sentence worth telling, no line end */
    bool (*stop)(void *user);                   /**< true: end early, keeping what is done */
    void *user;
} haft_progress;

/** The capillary pressure and range and the equivalent modulus of a case. */
haft_status haft_study_contact_spec(haft_contact_spec *out, const haft_case *c,
                                    haft_error *error) HAFT_MUST_CHECK;

/** The plan of a case's surfaces.
 *  @param[in] patches how many patches of l_meso a block holds */
haft_status haft_study_surface_plan(haft_surface_plan **out, const haft_case *c, size_t patches,
                                    haft_error *error) HAFT_MUST_CHECK;

/** How many patches a block of the seamless surface holds: a matter of memory, the same for any
 *  number of threads. 1 for independent patches. */
size_t haft_study_block_patches(const haft_case *c);

/** f(d) and law vector of every patch of every realization, in parallel over blocks; the same bits
 *  for any number of threads. With a stochastic sampler instead: those of law.chaos.vectors
 *  independent patches, and the model built from them.
 *  @return HAFT_ERROR_INTERRUPTED if stopped, with *out NULL. */
haft_status haft_study_build_laws(haft_laws **out, const haft_case *c,
                                  const haft_progress *progress, haft_error *error) HAFT_MUST_CHECK;

/** Brings a case's laws into memory: reads `path` if it was built from the same inputs, else builds
 *  and writes it, saying why through `note`.
 *  @param[out] digest of the inputs */
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
 *  @param[out] vector [n]
 *  @return HAFT_ERROR_INPUT if the case's sampler is no stochastic one. Thread-safe. */
haft_status haft_study_draw(const haft_laws *laws, const haft_case *c, size_t realization, size_t n,
                            haft_law_vector *vector, haft_error *error) HAFT_MUST_CHECK;

/** Draws n vectors, those of sites 0 .. n - 1 of realization 0, by the case's sampler and writes
 *  them as CSV. @return HAFT_ERROR_INPUT if the case's sampler is no stochastic one. */
haft_status haft_study_write_sample(const haft_laws *laws, const haft_case *c, size_t n,
                                    const char *path, haft_error *error) HAFT_MUST_CHECK;

/** How many patches stand behind a case's laws: realizations times sites, or those of the model. */
size_t haft_study_law_count(const haft_case *c);

/** Sites of a case's beam. */
size_t haft_study_sites(const haft_case *c);

/** How many laws of a set carry each fault. Thread-safe. */
void haft_study_count_faults(const haft_laws *laws, size_t count[HAFT_LAW_FAULTS]);

/** The laws of one realization as the solver takes them; the tables behind them are its own. */
typedef struct haft_site_laws {
    size_t sites, unfit; /**< unfit: sites whose curve no Morse law fits */
    haft_law *law;
    haft_law_table **table; /**< NULL where the law is no table */
    haft_law_vector *vector;
} haft_site_laws;

/** Those of the patches, or drawn from the model where the case's sampler is a stochastic one.
 *  @return HAFT_ERROR_INPUT if a curve cannot be used and the case says stop, or if a drawn vector
 *  has no Morse law (as the paper's bounds allow), naming the site. Thread-safe. */
haft_status haft_study_site_laws(haft_site_laws **out, const haft_case *c, const haft_laws *laws,
                                 size_t realization, haft_error *error) HAFT_MUST_CHECK;
void haft_site_laws_destroy(haft_site_laws **laws);

/** Follows one realization and sums it up. Thread-safe. */
haft_status haft_study_realize(haft_path **out, haft_summary *summary, const haft_case *c,
                               const haft_model *model, const haft_site_laws *laws,
                               bool keep_states, haft_error *error) HAFT_MUST_CHECK;

/** Runs all realizations over OpenMP threads into the results file `path`; the same bits for any
 *  number of threads but for /summary/seconds. Stopped early, it writes what is done.
 *  @param[out] summary the case's realizations; outcome -1 where one was not run
 *  @return HAFT_ERROR_INTERRUPTED if stopped, after writing. */
haft_status haft_study_run(haft_summary *summary, const haft_case *c, const haft_laws *laws,
                           const char *laws_digest, const char *path, bool overwrite,
                           const haft_progress *progress, haft_error *error) HAFT_MUST_CHECK;

/** Statistics of the crack lengths of those realizations that stuck. */
typedef struct haft_statistics {
    size_t run, stuck, free, failed;
    double mean, deviation, standard_error; /**< [m], NaN where too few */
    double least, greatest;                 /**< [m] */
    double gamma;                           /**< Eq. 36 of the mean crack length [J/m^2] */
    double jumps, seconds;                  /**< a realization, mean */
    double ledger_error;                    /**< the greatest */
    size_t unfit;                           /**< in all */
} haft_statistics;
haft_statistics haft_study_statistics(const haft_case *c, const haft_summary *summary, size_t n);

/** Writes summary.csv, one row a realization. */
haft_status haft_study_write_summary(const haft_summary *summary, size_t n, const char *path,
                                     haft_error *error) HAFT_MUST_CHECK;

/** Writes laws.csv, one row a law: its vector, its fault (a haft_law_fault) and what its patch
 * looks like where the force vanishes. */
haft_status haft_study_write_laws(const haft_laws *laws, const char *path,
                                  haft_error *error) HAFT_MUST_CHECK;

/** Writes the data of a case's figures as CSV into `directory`, which must exist: surface.csv (a
 *  piece of realization 0's surface), laws.csv (ten of its curves and the laws they became),
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
