/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The self-affine form with a constant floor, and its likelihood over the rings of a PSD. */
#ifndef HAFT_SURFACE_PSD_LIKELIHOOD_H
#define HAFT_SURFACE_PSD_LIKELIHOOD_H

#include "haft/surface_map.h"

/* The rings of a table used in a fit: the first n. */
typedef struct haft_psd_rings {
    size_t n;
    double *log_zeta, *s, *count;
    double scale; /* the smallest s, unit of the floor */
} haft_psd_rings;

/* exp(a - b x) + floor with x = log(zeta/zeta_0) above the roll-off and 0 below. */
typedef struct haft_psd_form {
    double log_zeta_0, a, b, floor;
    double deviance; /* over the rings it was fitted to */
} haft_psd_form;

/* s of the form, without and with its floor. */
double haft_psd_form_power(const haft_psd_form *form, double log_zeta);
double haft_psd_form_value(const haft_psd_form *form, double log_zeta);

/* 2 N (r - 1 - log r) with r = s/model: twice the difference of the log likelihood (Gamma with
 * shape N) from that of a model that meets s exactly. */
double haft_psd_ring_deviance(double s, double count, double model);

enum { HAFT_PSD_GRID = 120 };

/* The best form for each roll-off of a grid from the first ring to the third last, and the best of
 * all. */
typedef struct haft_psd_profile {
    size_t n; /* intervals of the grid */
    haft_psd_form at[HAFT_PSD_GRID + 1];
    haft_psd_form best;
} haft_psd_profile;

void haft_psd_profile_make(haft_psd_profile *profile, const haft_psd_rings *rings, size_t n);

/* The best a, b and floor for a roll-off, starting from a form nearby. */
haft_psd_form haft_psd_form_at(const haft_psd_rings *rings, double log_zeta_0,
                               const haft_psd_form *near);

/* Covariance of a, b and floor at a fixed roll-off. */
void haft_psd_form_covariance(const haft_psd_form *form, const haft_psd_rings *rings,
                              double covariance[3][3]);

#endif
