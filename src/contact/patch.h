/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Common types of the asperity models: the patch, its distances, and the scratch. */
#ifndef HAFT_CONTACT_PATCH_H
#define HAFT_CONTACT_PATCH_H

#include "contact/vdw.h"

typedef struct haft_patch {
    const double *z;
    size_t rows, columns;
    double step;
} haft_patch;

/* A uniform, increasing grid of levels; at[n] is +infinity. */
typedef struct haft_levels {
    size_t n;
    double first, per_step;
    const double *at;
} haft_levels;

/* The number of levels strictly below z. It is exact: z is rounded to the nearest level, and then
 * compared with it. A NAN counts as below all levels. */
static inline size_t haft_levels_below(const haft_levels *levels, double z) {
    double x = (z - levels->first) * levels->per_step + 0.5;
    double n = (double)levels->n;
    x = x > 0 ? x : 0;
    x = x < n ? x : n;
    size_t nearest = (size_t)(int)x;
    return nearest + (levels->at[nearest] < z);
}

/* Sums over the asperities at each distance. */
typedef struct haft_tally {
    double *push;   /* sum of forces over 4/3 of the modulus, sqrt(R) (z_s - d)^(3/2) each [m^2] */
    double *area;   /* sum of contact areas, pi R (z_s - d) each [m^2] */
    double *number; /* asperities in contact */
} haft_tally;

enum { HAFT_CONTACT_PARTIALS = 4 }; /* independent partial sums and counts; at least 2 */

/* Points processed together, so that they stay in the first-level cache during all operations. */
enum { HAFT_CONTACT_CHUNK = 256 };

/* Bins for locating a point among the thresholds: about twenty per distance. */
enum { HAFT_WET_BINS = 8192 };

/* Counts the points between the wet thresholds of all curves that are made together. */
typedef struct haft_wet {
    size_t thresholds, most; /* their total number, and the largest number in a bin */
    double first, per_bin;
    double *at;       /* thresholds + 1: in increasing order, then +infinity */
    size_t *of;       /* thresholds: the curve and distance of each, curve * n + distance */
    uint32_t *start;  /* HAFT_WET_BINS: number of thresholds in the bins before */
    uint32_t *counts; /* HAFT_CONTACT_PARTIALS (thresholds + 1) */
} haft_wet;

/* With N points there are at most T = ceil(rows/2) ceil(columns/2) summits or islands, since no two
 * are neighbours. `found` and `spare` have 4 (N + rows + 2 columns + 4) bytes each, and the other
 * arrays T items: 15 bytes per point in all. */
struct haft_contact_work {
    size_t rows, columns;
    size_t levels, curves; /* capacity of the following arrays, which grow as needed */
    double *level_data; /* (4 + curves) (levels + 1): distances, tally, wet shares of the curves */
    uint32_t *counts; /* curves * HAFT_CONTACT_PARTIALS * (levels + 1): wet counts, then scratch */
    haft_wet wet;     /* its counts are the array above */
    double *shift;    /* curves: distances minus wet thresholds */
    size_t *next;     /* curves: scratch */
    uint32_t *found;  /* points above the lowest distance, in scan order */
    void *spare;
    double *top_a, *top_b;
    uint32_t *top_count, *top_parent, *top_live;
};

/* Wet area: set up the thresholds distance[j] - shift[k] of n distances and of all curves (next:
 * scratch, one per curve), count the points between them, and compute the share of points above
 * each, share[k * n + j]. */
void haft_wet_set_up(haft_wet *wet, size_t curves, const double *shift, const double *distance,
                     size_t n, size_t *next);
void haft_wet_count(const haft_wet *wet, const double *z, size_t n);
void haft_wet_shares(const haft_wet *wet, double points, double *share);

/* The tally of summits or of islands from the points work->found[0 .. n - 1], which are those above
 * levels->at[0]; both may overwrite found. Without adhesion the levels are the distances. With
 * adhesion they are lower by the distance over which an asperity is felt: reach for summits, range
 * for islands. fitted: HAFT_ASPERITY_FITTED. */
void haft_contact_summits(haft_contact_work *work, const haft_patch *patch,
                          const haft_levels *levels, size_t n, const haft_adhesion *adhesion,
                          const haft_tally *tally);
void haft_contact_islands(haft_contact_work *work, const haft_patch *patch,
                          const haft_levels *levels, size_t n, const haft_adhesion *adhesion,
                          bool fitted, const haft_tally *tally);

#endif
