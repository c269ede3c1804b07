/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The contents of a model (private to the room). */
#ifndef HAFT_CHAOS_MODEL_H
#define HAFT_CHAOS_MODEL_H

#include "chaos/basis.h"
#include "chaos/mixture.h"
#include "haft/chaos.h"

struct haft_chaos {
    haft_chaos_parts parts; /* its arrays are the model's own, below */
    haft_law_vector *vector;
    double *centre, *coefficient;
    unsigned *index;
    chaos_mixture mixture;
    chaos_recurrence recurrence;
    /* Coefficients of coordinate i of the map, which depends on only the first i + 1 germ
     * variables: its terms in those, in rising lexicographic order. */
    double *compact[HAFT_CHAOS_DIMENSION];
};

/* The numbers of q before division by sigma; NaN where the vector breaks the bounds. */
void haft_chaos_raw_from_vector(haft_chaos_bounds bounds, double f_limit,
                                const haft_law_vector *vector, double *raw);

/* f_max / (2 a_left): the energy of a Morse law's left wing. */
double haft_chaos_left_energy(const haft_law_vector *vector, double f_limit);

/* Creates a model with room for its arrays; copies the scalars of `parts`, all else is zero. */
haft_status haft_chaos_alloc(haft_chaos **out, const haft_chaos_parts *parts,
                             haft_error *error) HAFT_MUST_CHECK;

/* Makes the mixture of the centres. */
haft_status haft_chaos_place_kernels(haft_chaos *chaos, haft_error *error) HAFT_MUST_CHECK;

/* Mean, covariance and principal components of q [m][4] into parts. */
void haft_chaos_principal(size_t m, const double *q, haft_chaos_parts *parts);

/* The number of components whose share of the covariance is above rounding. */
size_t haft_chaos_rank(const haft_chaos_parts *parts);

/* A work for each thread. */
typedef struct chaos_workspaces {
    int threads;
    haft_chaos_work **work;
} chaos_workspaces;

haft_status haft_chaos_workspaces_init(chaos_workspaces *work, const haft_chaos *chaos,
                                       haft_error *error) HAFT_MUST_CHECK;
void haft_chaos_workspaces_clear(chaos_workspaces *work);

/* The inverse map at the tensor Gauss points: value[i] is coordinate i at points^(i + 1) points,
 * the last direction running fastest. */
haft_status haft_chaos_map_grid(const haft_chaos *chaos, size_t points,
                                double *const value[HAFT_CHAOS_DIMENSION],
                                haft_error *error) HAFT_MUST_CHECK;

/* The expansion at HAFT_SIMD_WIDTH germs x[i][lane], as coordinates of the map. */
void haft_chaos_expand_together(const haft_chaos *chaos,
                                double x[HAFT_CHAOS_DIMENSION][HAFT_SIMD_WIDTH],
                                double out[HAFT_CHAOS_DIMENSION][HAFT_SIMD_WIDTH]);

#endif
