/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The point law of haft_dispersion as a sum of terms, for those that evaluate it many times. */
#ifndef HAFT_CONTACT_DISPERSION_H
#define HAFT_CONTACT_DISPERSION_H

#include "haft/contact.h"

enum { HAFT_DISPERSION_TERMS = 9 }; /* three interfaces a face at most */

/* W(g) = -sum amount / (x^2 + rate x^3), x = g + depth. */
typedef struct haft_dispersion_terms {
    size_t n;
    double rate; /* 5.32/lambda, or 0 [1/m] */
    double amount[HAFT_DISPERSION_TERMS], depth[HAFT_DISPERSION_TERMS];
} haft_dispersion_terms;

haft_dispersion_terms haft_dispersion_terms_of(const haft_dispersion *law);

haft_dispersion_value haft_dispersion_sum(const haft_dispersion_terms *terms, double gap);

/* The mean over gaps spread evenly from low to high, both positive, low <= high: exact, and without
 * loss of digits where they lie close together. */
haft_dispersion_value haft_dispersion_mean(const haft_dispersion_terms *terms, double low,
                                           double high);

#endif
