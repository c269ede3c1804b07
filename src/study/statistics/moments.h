/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Running mean and squares of the crack lengths of beams that stuck. Private to this room. */
#ifndef HAFT_STUDY_MOMENTS_H
#define HAFT_STUDY_MOMENTS_H

#include "haft/study.h"

typedef struct haft_moments {
    size_t n;
    double mean, squares; /* [m], [m^2]: sum of (x - mean)^2 */
} haft_moments;

/* Takes a realization in if it stuck (Welford 1962). */
void haft_moments_add(haft_moments *moments, const haft_summary *one);

/* Standard deviation with n - 1; NaN for fewer than two. */
double haft_moments_deviation(const haft_moments *moments);

/* Half the width of the mean's interval; INFINITY for fewer than two. */
double haft_moments_half_width(const haft_moments *moments, double confidence);

#endif
