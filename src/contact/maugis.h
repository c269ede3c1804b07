/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A Maugis sphere in the units of haft_maugis: what its direct solution and its table share, and
 * how the table is read for many approaches of one sphere. */
#ifndef HAFT_CONTACT_MAUGIS_H
#define HAFT_CONTACT_MAUGIS_H

#include "haft/contact.h"

/* A point of the touching branch. */
typedef struct haft_maugis_point {
    double approach, force, radius, reach;
    double approach_slope, force_slope; /* by theta */
} haft_maugis_point;

/* At theta = arcsec(c/a): pi/2 where the sphere touches in a point, 0 in the deep. */
haft_maugis_point haft_maugis_at(double lambda, double theta);

/* The lambda at which the fold is the point contact: below it the untouched branch ends in the
 * fold, above it the touching one. */
double haft_maugis_meeting(void);

/* The angle at which the touching branch's stable part begins: its fold or the point contact. */
double haft_maugis_first_angle(double lambda);

/* The angle below `first` with this approach, which is above that of `first`. */
double haft_maugis_angle(double lambda, double first, double approach);

/* The reach c of the untouched sphere and its fold's, c_f = 8 lambda/(3 pi). */
double haft_maugis_untouched(double lambda, double approach);
double haft_maugis_fold_reach(double lambda);

/* One sphere. */
typedef struct haft_maugis_curve {
    const haft_maugis_table *table;
    double lambda, place; /* in its strip, -1 to 1 */
    int strip;
    double begin; /* approach where the touching branch begins */
    double end;   /* approach below which nothing pulls */
} haft_maugis_curve;

/* lambda within the table. */
haft_maugis_curve haft_maugis_curve_of(const haft_maugis_table *table, double lambda,
                                       haft_vdw_path path);

/* Force, and the contact radius into *radius. */
double haft_maugis_force(const haft_maugis_curve *curve, double approach, double *radius);

#endif
