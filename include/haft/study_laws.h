/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file study_laws.h
 *  The laws of a case: its surfaces and forces, the laws of all patches, the stochastic model, and
 * the laws of one beam. */
#ifndef HAFT_STUDY_LAWS_H
#define HAFT_STUDY_LAWS_H

#include "haft/io.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Callbacks of a long computation. Any member may be NULL. They are called by one thread at a
 *  time, not always the same. */
typedef struct haft_progress {
    void (*advance)(void *user, const char *stage, size_t done,
                    size_t total);              /**< reports the progress of a stage */
    void (*note)(void *user, const char *text); /**< reports a sentence, without line end */
    bool (*stop)(void *user);                   /**< true: end early and keep what is done */
    void *user;                                 /**< passed to each of them */
} haft_progress;

/** The forces in a case's contacts: capillary, van der Waals forces, equivalent modulus. The
 *  caller makes the table that has_vdw needs. */
haft_status haft_study_contact_spec(haft_contact_spec *out, const haft_case *c,
                                    haft_error *error) HAFT_MUST_CHECK;

/** The plan of a case's surfaces.
 *  @param[out] out the plan; NULL after a failure
 *  @param[in] c the case
 *  @param[in] patches how many patches of l_meso a block holds
 *  @param[out] error one message where it fails; may be NULL */
haft_status haft_study_surface_plan(haft_surface_plan **out, const haft_case *c, size_t patches,
                                    haft_error *error) HAFT_MUST_CHECK;

/** The windows of maps that a case's patches are made of; NULL if its surfaces are generated. */
haft_status haft_study_tiling(haft_tiling **out, const haft_case *c,
                              haft_error *error) HAFT_MUST_CHECK;

/** Number of patches in a block of the seamless surface, limited by memory; the same for any
 *  number of threads. 1 for independent patches. */
size_t haft_study_block_patches(const haft_case *c);

/** Law vector of every patch of every realization that can come into range, with the curves the
 *  case keeps, in parallel over blocks and all in memory; the same bits for any number of
 *  threads. With a stochastic sampler, instead those of law.chaos.vectors independent patches,
 *  with the model built from them.
 *  @return HAFT_ERROR_INTERRUPTED if stopped, with *out NULL. */
haft_status haft_study_build_laws(haft_laws **out, const haft_case *c,
                                  const haft_progress *progress, haft_error *error) HAFT_MUST_CHECK;

/** The same for n cases with stochastic samplers and the same patches; each surface is made once
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

/** Digest of the laws that a case uses: of their inputs, and also of the vectors if the laws at
 *  `path` were fitted to given vectors with the same inputs. */
haft_status haft_study_laws_digest(char digest[HAFT_DIGEST_CAPACITY], const haft_case *c,
                                   const char *path, haft_error *error) HAFT_MUST_CHECK;

/** Reads a case's laws from `path` if they were built from the same inputs. Otherwise builds and
 *  writes a model, and reports why through `note`; the laws of beams with surfaces of their own
 *  are left to haft_study_run().
 *  @param[out] out NULL where there are none yet of beams' own; those that there are may lack
 *  some realizations: see haft_study_has_laws()
 *  @param[out] digest of the inputs
 *  @param[in] c the case
 *  @param[in] path of laws.h5
 *  @param[in] progress may be NULL
 *  @param[out] error one message where it fails; may be NULL */
haft_status haft_study_obtain_laws(haft_laws **out, char digest[HAFT_DIGEST_CAPACITY],
                                   const haft_case *c, const char *path,
                                   const haft_progress *progress,
                                   haft_error *error) HAFT_MUST_CHECK;

/** Builds the stochastic model of a case from the sound vectors of `laws`, with the errors of
 *  its expansion, into laws->chaos and laws->errors.
 *  @return HAFT_ERROR_INPUT if there is no model of these vectors with these choices; the
 *  message says what would help. */
haft_status haft_study_build_chaos(haft_laws *laws, const haft_case *c,
                                   haft_error *error) HAFT_MUST_CHECK;

/** Creates laws without curves from vectors measured elsewhere, with the model built from them
 *  by the case's choices. A vector without a Morse law is counted by its fault and left out of
 *  the model. */
haft_status haft_study_fit_laws(haft_laws **out, const haft_case *c, size_t m,
                                const haft_law_vector *vector, haft_error *error) HAFT_MUST_CHECK;

/** Vectors of sites 0 .. n - 1 of a realization, drawn from the model by the case's sampler.
 *  @param[in] laws with a model
 *  @param[in] c whose sampler and seed
 *  @param[in] realization the beam
 *  @param[in] n sites
 *  @param[out] vector [n]
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_INPUT if the case's sampler is not stochastic. Thread-safe. */
haft_status haft_study_draw(const haft_laws *laws, const haft_case *c, size_t realization, size_t n,
                            haft_law_vector *vector, haft_error *error) HAFT_MUST_CHECK;

/** Number of patches that a case's laws are computed from: realizations times the sites that can
 *  come into range, or those of the model. */
size_t haft_study_law_count(const haft_case *c);

/** Number of sites of a case's beam. */
size_t haft_study_sites(const haft_case *c);

/** The first site that can come into range and has a law; 0 if laws are drawn. */
size_t haft_study_first_site(const haft_case *c);

/** Whether laws (NULL: none), built from the case's inputs for the beams' own surfaces, contain
 *  all sites of a realization that can come into range. Thread-safe. */
bool haft_study_has_sites(const haft_case *c, const haft_laws *laws, size_t realization);

/** Whether they also contain all curves that the solver needs. Thread-safe. */
bool haft_study_has_laws(const haft_case *c, const haft_laws *laws, size_t realization);

/** Whether a case's beams draw patches and use their curves as tables: a bootstrap of tables
 *  needs patches but no model. Thread-safe. */
bool haft_study_draws_patches(const haft_case *c);

/** Copies one set of laws (a realization's, or those of a model's patches) with the sites and
 *  curves that the case keeps.
 *  @param[out] out the copy; NULL after a failure
 *  @param[in] c which sites and curves it keeps
 *  @param[in] laws copied from
 *  @param[in] set number of the realization within `laws`
 *  @param[in] realization its number in the case
 *  @param[out] error one message where it fails; may be NULL */
haft_status haft_study_take_laws(haft_laws **out, const haft_case *c, const haft_laws *laws,
                                 size_t set, size_t realization, haft_error *error) HAFT_MUST_CHECK;

/** Counts the laws of a set by fault. Thread-safe. */
void haft_study_count_faults(const haft_laws *laws, size_t count[HAFT_LAW_FAULTS]);

/** The laws of one realization for the solver, with their tables. */
typedef struct haft_site_laws {
    size_t sites;           /**< of the beam */
    size_t unfit;           /**< sites whose curve has no Morse law */
    haft_law *law;          /**< sites */
    size_t tables;          /**< of sites, or of all patches if patches are drawn */
    haft_law_table **table; /**< tables; NULL if there is none, if no site drew it, or if it belongs
                               to the laws it came from, which must outlive these */
    haft_law_vector *vector; /**< sites; NaN where a curve has none */
} haft_site_laws;

/** The laws of the patches, or drawn from the model if the case's sampler is stochastic. Sites
 *  before the active zone get the law of the zone with the largest reach.
 *  @return HAFT_ERROR_INPUT if a curve cannot be used and the case says stop, or if a drawn
 *  vector has no Morse law (as the paper's bounds allow), naming the site. Thread-safe. */
haft_status haft_study_site_laws(haft_site_laws **out, const haft_case *c, const haft_laws *laws,
                                 size_t realization, haft_error *error) HAFT_MUST_CHECK;

/** Tries to make the law of a site from the first of the laws, as haft_study_site_laws() does.
 *  @param[in] c the case
 *  @param[in] laws one at least
 *  @param[in] site for messages, and how many sites before it there are
 *  @param[out] error why there is no law; may be NULL
 *  @return HAFT_ERROR_INPUT as haft_study_site_laws(). Thread-safe. */
haft_status haft_study_try_law(const haft_case *c, const haft_laws *laws, size_t site,
                               haft_error *error) HAFT_MUST_CHECK;

/** Frees them and sets the pointer to NULL; NULL is allowed. */
void haft_site_laws_destroy(haft_site_laws **laws);

#ifdef __cplusplus
}
#endif
#endif
