/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The radial convolution kernel of a PSD, tapered to compact support (private to the room). */
#ifndef HAFT_SURFACE_KERNEL_H
#define HAFT_SURFACE_KERNEL_H

#include "surface/radial.h"

typedef struct surface_kernel {
    double lattice_step; /* [m] */
    double spacing;      /* of the radial table [m] */
    size_t n;            /* entries of the table */
    double *table;       /* kernel times taper at r = i * spacing [m] */
    size_t halo;         /* reach in lattice steps */
    double reach;        /* halo * lattice_step [m] */
    double loss;         /* share of the energy that the taper removes */
    double smear;        /* half-width of the taper's spectrum [rad/m] */
} surface_kernel;

/* Builds the kernel with the smallest reach, in whole lattice steps, whose loss is at most
 * `tolerance`. */
haft_status haft_surface_kernel_create(surface_kernel *kernel, const surface_radial *radial,
                                       double lattice_step, double tolerance, haft_error *error);
void haft_surface_kernel_destroy(surface_kernel *kernel);

/* The tapered kernel at distance r >= 0 [m]; zero from the reach on. */
double haft_surface_kernel_value(const surface_kernel *kernel, double r);

#endif
