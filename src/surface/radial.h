/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A radial PSD, self-affine or a table, for the kernel and the correction (private to the room). */
#ifndef HAFT_SURFACE_RADIAL_H
#define HAFT_SURFACE_RADIAL_H

#include "haft/surface.h"

/* s is psd.s_0 up to psd.zeta_0 and zero beyond psd.zeta_max. In between it is the table's, or
 * psd's power law if there is no table. */
typedef struct surface_radial {
    haft_psd psd;
    const haft_psd_table *table;
} surface_radial;

/* From a checked PSD, or from a checked table if that is not NULL. */
surface_radial haft_surface_radial(const haft_psd *psd, const haft_psd_table *table);
double haft_surface_radial_value(const surface_radial *radial, double zeta);
double haft_surface_radial_variance(const surface_radial *radial);

/* The PSD of the Gaussian surface g for which sigma q(g) has the PSD `wanted`, scaled to the
 * variance of `wanted`. Sets psd_error, beyond and deviation of `facts`. */
haft_status haft_surface_translate(haft_psd_table **out, const surface_radial *wanted,
                                   const haft_marginal *marginal, haft_surface_facts *facts,
                                   haft_error *error);

#endif
