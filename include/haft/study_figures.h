/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file study_figures.h
 *  Tables and the data of figures, as CSV. */
#ifndef HAFT_STUDY_FIGURES_H
#define HAFT_STUDY_FIGURES_H

#include "haft/study_statistics.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Draws the vectors of sites 0 .. n - 1 of realization 0 by the case's sampler, and writes them
 *  as CSV. @return HAFT_ERROR_INPUT if the case's sampler is not stochastic. */
haft_status haft_study_write_sample(const haft_laws *laws, const haft_case *c, size_t n,
                                    const char *path, haft_error *error) HAFT_MUST_CHECK;

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

/** Writes the correlation over up to 20 patches as correlation.csv, with intervals by Student's
 *  t over the realizations (Fig. 15 of Hoang et al.). */
haft_status haft_study_write_correlation(const haft_case *c, const haft_laws *laws,
                                         const char *directory, haft_error *error) HAFT_MUST_CHECK;

/** One variant of a sweep with its results. */
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

/** Writes data of a case's surfaces (Figs. 3 and 11 of Hoang et al., 2017): surface.csv, heights
 *  of a square piece of the first one; psd.csv, the radial PSD asked for; and rings.csv, that of
 *  a piece of 6 um (of maps: of a patch) by the beam's width, at most 4096 points a side,
 *  windowed by sin^2, with its standard error over its own value and the PSD asked for there. A
 *  piece with fewer than 16 half waves per side has no rings: one row of NaN.
 *  @param[in] c the case, its files read
 *  @param[in] directory they are written into; must exist
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_OK, HAFT_ERROR_MEMORY, HAFT_ERROR_IO, or the failure of making the surface. Not
 *  thread-safe (FFTW planner). */
haft_status haft_study_write_surface(const haft_case *c, const char *directory,
                                     haft_error *error) HAFT_MUST_CHECK;

/** Writes summary.csv, one row a realization. */
haft_status haft_study_write_summary(const haft_summary *summary, size_t n, const char *path,
                                     haft_error *error) HAFT_MUST_CHECK;

/** Writes convergence.csv: mean and standard deviation of the crack length with their intervals
 * over the first n beams, for up to 2000 n up to all (Fig. 19a, b). */
haft_status haft_study_write_convergence(const haft_case *c, const haft_summary *summary, size_t n,
                                         const char *path, haft_error *error) HAFT_MUST_CHECK;

/** Writes laws.csv, one row per law: its vector, its fault (a haft_law_fault), and contact area
 *  and asperities of its patch at zero force. */
haft_status haft_study_write_laws(const haft_laws *laws, const char *path,
                                  haft_error *error) HAFT_MUST_CHECK;

/** The beam's shapes at the accepted states of a realization's path: from its evidence, or from
 *  following it again if there is none. Thread-safe except for HDF5, see haft/io.h. */
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
