/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file chaos_laws.h
 *  Sets of laws in memory, with the stochastic model made of them; haft/io.h reads and writes them.
 *  Functions are thread-safe for distinct sets. */
#ifndef HAFT_CHAOS_LAWS_H
#define HAFT_CHAOS_LAWS_H

#include "haft/chaos.h"
#include "haft/law.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A set of m laws of curves on n distances, with the curves that are kept, and the stochastic
 *  model built from the laws, if any. */
typedef struct haft_laws {
    size_t m;          /**< laws */
    size_t n;          /**< distances of a curve */
    size_t sites;      /**< laws a realization; m where a model was built from them */
    size_t first_site; /**< law i of realization j has the index j * sites + i and belongs to site
                          first_site + i; the sites before never come into range */
    double f_limit;    /**< as haft_law_limit() takes it */
    double *distance;  /**< n [m] */
    size_t curves;     /**< kept, <= m */
    int *curve_law;    /**< curves: which law each is of, rising; NULL: all are kept */
    double *force;     /**< curves x n [Pa] */
    haft_law_vector *vector;           /**< m; NaN where the fault forbids it */
    haft_law_fault *fault;             /**< m */
    double *zero_distance;             /**< m: zero-force distance [m], NaN if none */
    double *contact_area;              /**< m: there, share of the area */
    double *wet_area;                  /**< m */
    double *asperities;                /**< m: in contact, a patch */
    haft_chaos *chaos;                 /**< of the sound vectors; NULL without a model. Owned */
    haft_chaos_errors errors;          /**< of its expansion */
    char origin[HAFT_DIGEST_CAPACITY]; /**< digest of the vectors it was fitted to; "" if built */
    haft_law_table **table; /**< m: of the curves, by haft_laws_tabulate(); else NULL. Owned */
} haft_laws;

/** Creates a set of m laws with room for all curves. Without distances (n = 0), the numbers
 *  taken from curves are NaN. @return HAFT_ERROR_MEMORY */
haft_status haft_laws_create(haft_laws **out, size_t m, size_t n,
                             haft_error *error) HAFT_MUST_CHECK;

/** The same with room for only some of the curves, and at most INT_MAX laws. The caller fills in
 *  curve_law unless curves == m. */
haft_status haft_laws_create_sparse(haft_laws **out, size_t m, size_t curves, size_t n,
                                    haft_error *error) HAFT_MUST_CHECK;

/** The curve of law k, n forces; NULL if it is not kept. Thread-safe. */
const double *haft_laws_curve(const haft_laws *laws, size_t k);

/** Makes the tables of all curves that are kept, so that beams that draw the same curves share
 *  them. A curve that cannot be a table gets none. Does nothing if they exist.
 *  @return HAFT_ERROR_MEMORY */
haft_status haft_laws_tabulate(haft_laws *laws, haft_error *error) HAFT_MUST_CHECK;

/** Copies the laws first .. first + count - 1 as those of one realization; the first keeps its
 *  site.
 *  @param[out] out the copy; NULL after a failure
 *  @param[in] laws they are copied from
 *  @param[in] first, count which
 *  @param[in] keep [count] whose curves are to be kept, of those there are
 *  @param[out] error one message where it fails; may be NULL */
haft_status haft_laws_select(haft_laws **out, const haft_laws *laws, size_t first, size_t count,
                             const bool *keep, haft_error *error) HAFT_MUST_CHECK;

/** Joins sets of one realization each, with the same sites and distances. Destroys each set as
 *  soon as it is copied. */
haft_status haft_laws_join(haft_laws **out, haft_laws **set, size_t count,
                           haft_error *error) HAFT_MUST_CHECK;

/** Frees laws and sets the pointer to NULL; NULL is allowed. */
void haft_laws_destroy(haft_laws **laws);

#ifdef __cplusplus
}
#endif
#endif
