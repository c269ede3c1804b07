/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the asperity models share: the patch, its distances, and the scratch. */
#ifndef HAFT_CONTACT_PATCH_H
#define HAFT_CONTACT_PATCH_H

#include "contact/vdw.h"

typedef struct haft_patch {
    const double *z;
    size_t rows, columns;
    double step;
} haft_patch;

/* An even, increasing grid of levels; at[n] is +infinity. */
typedef struct haft_levels {
    size_t n;
    double first, per_step;
    const double *at;
} haft_levels;

/* How many levels lie strictly below z, exactly as comparing with each would tell: rounding to the
 * nearest level leaves only that one in doubt. A z that is no number counts as below all. */
static inline size_t haft_levels_below(const haft_levels *levels, double z) {
    double x = (z - levels->first) * levels->per_step + 0.5;
    double n = (double)levels->n;
    x = x > 0 ? x : 0;
    x = x < n ? x : n;
    size_t nearest = (size_t)(int)x;
    return nearest + (levels->at[nearest] < z);
}

/* What the asperities sum to at each distance. */
typedef struct haft_tally {
    double *push;   /* sum of forces over 4/3 of the modulus, sqrt(R) (z_s - d)^(3/2) each [m^2] */
    double *area;   /* sum of contact areas, pi R (z_s - d) each [m^2] */
    double *number; /* asperities in contact */
} haft_tally;

enum { HAFT_CONTACT_LANES = 4 }; /* at least 2 */

/* Points gone through at a time: they stay in the nearest cache for all that is asked of them. */
enum { HAFT_CONTACT_CHUNK = 256 };

/* Bins of the grid by which a point finds its place: some twenty a distance. */
enum { HAFT_WET_BINS = 8192 };

/* Where the points fall between the wet thresholds of all curves that are made together. */
typedef struct haft_wet {
    size_t thresholds, most; /* in all, and in one bin at most */
    double first, per_bin;
    double *at;       /* thresholds + 1: in rising order, then +infinity */
    size_t *of;       /* thresholds: whose each is, curve n + distance */
    uint32_t *start;  /* HAFT_WET_BINS: how many thresholds the bins before have */
    uint32_t *counts; /* HAFT_CONTACT_LANES (thresholds + 1) */
} haft_wet;

/* With N points and T = ceil(rows/2) ceil(columns/2), the most summits or islands there can be (no
 * two are neighbours), `found` and `spare` hold 4 (N + rows + 2 columns + 4) bytes each and the
 * other arrays T items: 15 bytes a point in all. */
struct haft_contact_work {
    size_t rows, columns;
    size_t levels, curves; /* capacity of what follows, grown when longer or more curves come */
    double *level_data;    /* distances, the tally, and the curves' wet shares: (4 + curves)
                              (levels + 1) numbers */
    uint32_t *counts; /* curves HAFT_CONTACT_LANES (levels + 1): the wet count's, then scratch */
    haft_wet wet;     /* its counts are these */
    double *shift;    /* curves: what their thresholds are below the distances */
    size_t *next;     /* curves: scratch */
    uint32_t *found;  /* points above the lowest distance, in the order of the scan */
    void *spare;
    double *top_a, *top_b;
    uint32_t *top_count, *top_parent, *top_live;
};

/* Sets up the thresholds distance[j] - shift[k] of n distances and so many curves (next: scratch,
 * one a curve), counts points between them, and tells the shares of all points above each: share k
 * n + j. */
void haft_wet_set_up(haft_wet *wet, size_t curves, const double *shift, const double *distance,
                     size_t n, size_t *next);
void haft_wet_count(const haft_wet *wet, const double *z, size_t n);
void haft_wet_shares(const haft_wet *wet, double points, double *share);

/* The tally of summits or of islands from the points work->found[0 .. n - 1], those above
 * levels->at[0]; they may overwrite found. Without adhesion the levels are the distances; with it,
 * as far below them as an asperity still is felt: reach for summits, range for islands. fitted:
 * HAFT_ASPERITY_FITTED. */
void haft_contact_summits(haft_contact_work *work, const haft_patch *patch,
                          const haft_levels *levels, size_t n, const haft_adhesion *adhesion,
                          const haft_tally *tally);
void haft_contact_islands(haft_contact_work *work, const haft_patch *patch,
                          const haft_levels *levels, size_t n, const haft_adhesion *adhesion,
                          bool fitted, const haft_tally *tally);

#endif
