/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The Maugis spheres of one material: conversion of the units of haft_maugis to those of a
 * patch. */
#ifndef HAFT_CONTACT_VDW_H
#define HAFT_CONTACT_VDW_H

#include "contact/maugis.h"

/* Forces are in units of 4/3 of the modulus, as in haft_tally. */
typedef struct haft_adhesion {
    const haft_maugis_table *table;
    haft_vdw_path path;
    double least_radius, most_radius;
    double lambda, approach, force; /* for a radius of 1 m: lambda, and the units */
    double range;                   /* h_0 [m] */
    double strength;                /* sigma_0 over 4/3 of the modulus */
    double reach; /* attraction is felt up to this distance above a summit [m]: the length of a
                     sphere's neck at the lambda above which necks break while in contact. The
                     longer necks of blunter summits are cut off here */
} haft_adhesion;

/* Checks the spec, and with haft_contact_check_spheres() the limits of asperity radii. */
haft_status haft_adhesion_make(haft_adhesion *out, const haft_contact_spec *spec, double rows,
                               double columns, double step, haft_error *error);

typedef struct haft_sphere {
    haft_maugis_curve curve;
    double per_approach, force, area;
} haft_sphere;

haft_sphere haft_adhesion_sphere(const haft_adhesion *adhesion, double radius);

/* Force of a sphere at a depth [m] (negative above the plane), and its contact area. */
static inline double haft_sphere_force(const haft_sphere *sphere, double depth, double *area) {
    double radius;
    double force = haft_maugis_force(&sphere->curve, depth * sphere->per_approach, &radius);
    *area = sphere->area * radius * radius;
    return sphere->force * force;
}

#endif
