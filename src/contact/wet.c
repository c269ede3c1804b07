/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The wet area of all curves in one pass. A point is wet at distance d if its height is above d -
 * range. So the thresholds d - range of all curves are sorted together, and each point is counted
 * once, between two of them. The bin of a uniform grid locates it: thresholds in lower bins are
 * below the point, and those in its own bin are compared with it. The counts are exact, because the
 * bin is a non-decreasing function of the height even with rounding. */
#include <math.h>
#include <string.h>

#include "contact/patch.h"

enum { PARTIALS = HAFT_CONTACT_PARTIALS, BINS = HAFT_WET_BINS };

/* The bins of heights, vectorised. */
HAFT_CLONES static void find_bins(double first, double per_bin, const double *restrict z, size_t n,
                                  int32_t *restrict bin) {
    for (size_t j = 0; j < n; j++) {
        double x = (z[j] - first) * per_bin;
        x = x > 0 ? x : 0;
        x = x < BINS - 1 ? x : BINS - 1;
        bin[j] = (int32_t)x;
    }
}

/* Merges the thresholds of all curves, each a shifted uniform grid, into one sorted array. */
static void merge(haft_wet *wet, size_t curves, const double *shift, const double *distance,
                  size_t n, size_t *next) {
    memset(next, 0, curves * sizeof *next);
    for (size_t m = 0; m < curves * n; m++) {
        size_t least = curves;
        for (size_t k = 0; k < curves; k++) {
            if (next[k] < n && (least == curves || distance[next[k]] - shift[k] <
                                                       distance[next[least]] - shift[least])) {
                least = k;
            }
        }
        wet->at[m] = distance[next[least]] - shift[least];
        wet->of[m] = least * n + next[least]++;
    }
    wet->thresholds = curves * n;
    wet->at[wet->thresholds] = INFINITY;
}

void haft_wet_set_up(haft_wet *wet, size_t curves, const double *shift, const double *distance,
                     size_t n, size_t *next) {
    merge(wet, curves, shift, distance, n, next);
    size_t count = wet->thresholds;
    wet->first = wet->at[0];
    wet->per_bin = BINS / (wet->at[count - 1] - wet->first);
    memset(wet->start, 0, BINS * sizeof *wet->start);
    for (size_t m = 0; m < count; m++) {
        int32_t bin = 0;
        find_bins(wet->first, wet->per_bin, &wet->at[m], 1, &bin);
        wet->start[bin]++;
    }
    uint32_t before = 0;
    wet->most = 0;
    for (size_t b = 0; b < BINS; b++) {
        uint32_t here = wet->start[b];
        wet->start[b] = before;
        before += here;
        wet->most = here > wet->most ? here : wet->most;
    }
    memset(wet->counts, 0, PARTIALS * (count + 1) * sizeof *wet->counts);
}

/* Alternates between PARTIALS counts: neighbouring points fall between the same thresholds, and
 * increments of one counter would wait for each other. */
void haft_wet_count(const haft_wet *wet, const double *z, size_t n) {
    int32_t bin[HAFT_CONTACT_CHUNK];
    find_bins(wet->first, wet->per_bin, z, n, bin);
    for (size_t j = 0; j < n; j++) {
        size_t below = wet->start[bin[j]];
        for (size_t m = 0; m < wet->most; m++) {
            below += wet->at[below] < z[j];
        }
        wet->counts[PARTIALS * below + j % PARTIALS]++;
    }
}

void haft_wet_shares(const haft_wet *wet, double points, double *share) {
    uint64_t above = 0;
    for (size_t m = wet->thresholds; m-- > 0;) {
        for (size_t p = 0; p < PARTIALS; p++) {
            above += wet->counts[PARTIALS * (m + 1) + p];
        }
        share[wet->of[m]] = (double)above / points;
    }
}
