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

/** Frees them and sets the pointer to NULL; NULL is allowed. */
void haft_site_laws_destroy(haft_site_laws **laws);

#ifdef __cplusplus
}
#endif
#endif
