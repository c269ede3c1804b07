/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stochastic model of a case, for building and studying it. Private to this room. */
#ifndef HAFT_STUDY_STOCHASTIC_H
#define HAFT_STUDY_STOCHASTIC_H

#include "haft/study.h"

/* Builds the model of m vectors by the case's choices. */
haft_status haft_stochastic_create(haft_chaos **out, size_t m, const haft_law_vector *vector,
                                   const haft_case *c, haft_error *error) HAFT_MUST_CHECK;

/* The same with another germ and order, and the case's Gauss points if they are enough for that
 * order. */
haft_status haft_stochastic_create_of_order(haft_chaos **out, size_t m,
                                            const haft_law_vector *vector, const haft_case *c,
                                            haft_chaos_germ germ, size_t order,
                                            haft_error *error) HAFT_MUST_CHECK;

/* The kernels around a model's centres. */
haft_chaos_kernels haft_stochastic_kernels(const haft_chaos *chaos);

/* Principal components of n vectors drawn from the expansion of `drawn`, in the coordinates of
 * `seen`: eta [N_g of seen][n]. */
haft_status haft_stochastic_draw_components(const haft_chaos *drawn, const haft_chaos *seen,
                                            uint64_t seed, size_t n, double *eta,
                                            haft_error *error) HAFT_MUST_CHECK;

/* A grid of n points over all kernels of a column, 4 bandwidths beyond the last centres, but at
 * most `reach` either side of 0, where the centres' mean is. */
void haft_stochastic_grid(const haft_chaos_kernels *kernels, size_t column, double reach, size_t n,
                          double *x);

#endif
