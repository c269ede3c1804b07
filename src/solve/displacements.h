/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Displacements of gaps, scaled by the lengths over which the forces of their laws change. Private
 * to the room. All functions are thread-safe. */
#ifndef HAFT_SOLVE_DISPLACEMENTS_H
#define HAFT_SOLVE_DISPLACEMENTS_H

#include <stddef.h>

/* Arrays over the sites, of lengths of their laws [m]; see haft_law_lengths. */
typedef struct haft_site_lengths {
    double *range, *edge, *wide;
    double *far;  /* near part's force below 1e-3 of its maximum beyond */
    double *wall; /* the law is linear below */
} haft_site_lengths;

/* The length over which a site's force changes at gap d: the law's own, but not so long that a step
 * passes its edge; longer where the gap is out of reach. */
static inline double haft_length(const haft_site_lengths *s, size_t site, double d) {
    double beyond = d - s->far[site], past = d - s->edge[site];
    double length = s->range[site] + (past > 0 ? past : 0);
    return (length < s->wide[site] ? length : s->wide[site]) + (beyond > 0 ? beyond : 0);
}

/* The length over which a site's slope changes at gap d: the length above, or the depth in the
 * law's wall, where the force is linear. A step may be as long as this. */
static inline double haft_step_length(const haft_site_lengths *s, size_t site, double d) {
    double behind = s->wall[site] - d, length = haft_length(s, site, d);
    return behind > 0 ? s->range[site] + behind : length;
}

/* Displacements of the gaps of the sites first .. sites - 1. */
typedef struct haft_displacements {
    const haft_site_lengths *lengths;
    size_t first, sites;
    const double *gap; /* from these gaps [m] */
    const double *by;  /* [m]; NULL if `to` is given */
    const double *to;  /* the gaps afterwards [m]; NULL if `by` is given */
} haft_displacements;

/* The largest displacement over its length, or over its step length; NaN are passed over. */
double haft_displacements_largest(const haft_displacements *d);
double haft_displacements_largest_step(const haft_displacements *d);

/* The first site whose displacement over its length (or its step length) equals `largest`. */
size_t haft_displacements_find(const haft_displacements *d, double largest);
size_t haft_displacements_find_step(const haft_displacements *d, double largest);

/* The number of sites up to the last one whose displacement over its length exceeds `least`;
 * `first` if there is none. */
size_t haft_displacements_count(const haft_displacements *d, double least);

#endif
