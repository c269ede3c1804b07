/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The Maugis spheres of one material: what turns the units of haft_maugis into a patch's. */
#ifndef HAFT_CONTACT_VDW_H
#define HAFT_CONTACT_VDW_H

#include "contact/maugis.h"

/* Forces are those of haft_tally: in units of 4/3 of the modulus. */
typedef struct haft_adhesion {
    const haft_maugis_table *table;
    haft_vdw_path path;
    double least_radius, most_radius;
    double lambda, approach, force; /* of a sphere of radius 1 m: lambda and the units */
    double range;                   /* h_0 [m] */
    double strength;                /* sigma_0, as a force an area */
    double reach; /* how far above a summit the plane still is felt [m]: as far as a sphere's neck
                     stretches at the lambda from which necks break in contact; the longer necks of
                     rounder summits are cut there */
} haft_adhesion;

/* Checks the spec, and by haft_contact_check_spheres() the radii that the patch's asperities are
 * taken to. */
haft_status haft_adhesion_make(haft_adhesion *out, const haft_contact_spec *spec, double rows,
                               double columns, double step, haft_error *error);

typedef struct haft_sphere {
    haft_maugis_curve curve;
    double per_approach, force, area;
} haft_sphere;

haft_sphere haft_adhesion_sphere(const haft_adhesion *adhesion, double radius);

/* Force of a sphere at a depth [m], negative before it touches, and its contact area. */
static inline double haft_sphere_force(const haft_sphere *sphere, double depth, double *area) {
    double radius;
    double force = haft_maugis_force(&sphere->curve, depth * sphere->per_approach, &radius);
    *area = sphere->area * radius * radius;
    return sphere->force * force;
}

#endif
