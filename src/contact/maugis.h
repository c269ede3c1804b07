/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A Maugis sphere in the units of haft_maugis: functions common to the direct solution and the
 * table, and the table for many approaches of one sphere. */
#ifndef HAFT_CONTACT_MAUGIS_H
#define HAFT_CONTACT_MAUGIS_H

#include "haft/contact.h"

/* A point of the touching branch. */
typedef struct haft_maugis_point {
    double approach, force, radius, reach;
    double approach_slope, force_slope; /* derivatives by theta */
} haft_maugis_point;

/* The point at theta = arcsec(c/a): pi/2 at point contact, 0 in the limit of deep contact. */
haft_maugis_point haft_maugis_at(double lambda, double theta);

/* The lambda at which the fold is at the point contact, about 0.938. Below it the branch without
 * contact ends in the fold, above it the touching branch does. */
double haft_maugis_meeting(void);

/* The angle at which the stable part of the touching branch begins: its fold or the point
 * contact. */
double haft_maugis_first_angle(double lambda);

/* The angle below `first` with this approach, which must exceed the approach at `first`. */
double haft_maugis_angle(double lambda, double first, double approach);

/* The reach c of a sphere without contact, and its value at the fold, c_f = 8 lambda/(3 pi). */
double haft_maugis_untouched(double lambda, double approach);
double haft_maugis_fold_reach(double lambda);

/* The force curve of one sphere. */
typedef struct haft_maugis_curve {
    const haft_maugis_table *table;
    double lambda, place; /* its place in the strip, -1 to 1 */
    int strip;
    double begin; /* approach at which the touching branch begins */
    double end;   /* zero force below this approach */
} haft_maugis_curve;

/* The curve of a lambda, clamped to the range of the table. */
haft_maugis_curve haft_maugis_curve_of(const haft_maugis_table *table, double lambda,
                                       haft_vdw_path path);

/* The force, and in *radius the contact radius. */
double haft_maugis_force(const haft_maugis_curve *curve, double approach, double *radius);

#endif
