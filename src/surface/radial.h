/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A radial PSD of either kind, for the kernel and the correction (private to the room). */
#ifndef HAFT_SURFACE_RADIAL_H
#define HAFT_SURFACE_RADIAL_H

#include "haft/surface.h"

/* s is psd.s_0 up to psd.zeta_0 and nothing beyond psd.zeta_max; in between it is the table's where
 * there is one, else psd's own power. */
typedef struct surface_radial {
    haft_psd psd;
    const haft_psd_table *table;
} surface_radial;

/* Of a checked PSD, or of a checked table if that is not NULL. */
surface_radial haft_surface_radial(const haft_psd *psd, const haft_psd_table *table);
double haft_surface_radial_value(const surface_radial *radial, double zeta);
double haft_surface_radial_variance(const surface_radial *radial);

/* The PSD of the Gaussian surface g that gives sigma q(g) the PSD `wanted`, in whose unit it is:
 * its variance is that of `wanted`. `facts` takes psd_error, beyond and deviation. */
haft_status haft_surface_translate(haft_psd_table **out, const surface_radial *wanted,
                                   const haft_marginal *marginal, haft_surface_facts *facts,
                                   haft_error *error);

#endif
