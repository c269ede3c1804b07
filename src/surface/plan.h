/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The contents of a plan (private to the room). */
#ifndef HAFT_SURFACE_PLAN_H
#define HAFT_SURFACE_PLAN_H

#include "haft/surface.h"

#include <complex.h>
#include <fftw3.h>

/* One direction of a block. Fine transforms are longer than lattice transforms by the lattice
 * ratio. */
typedef struct surface_axis {
    size_t interior; /* lattice steps in the block */
    size_t lattice;  /* length of the noise transform: interior + 2 halo, rounded up to a fast FFT
                        length */
    size_t fine;     /* length of the fine transform, ratio * lattice */
    size_t cut;      /* highest wave number kept, at most fine / 2 */
} surface_axis;

enum { SURFACE_TILE = 8 }; /* columns transformed together; two cache lines of complex numbers */

struct haft_surface_plan {
    haft_surface_spec spec;
    size_t ratio, halo;
    surface_axis along, across;
    double *transform; /* [across.cut + 1][along.cut + 1], the kernel's transform over the number of
                          fine points */
    size_t *disc; /* [across.cut + 1], the highest wave number along the beam inside the disc */
    haft_surface_facts facts;
    double scale_in; /* with a marginal, scales the generated field to g of unit variance */
    /* Executed on the arrays of each work; FFTW allows this from several threads. */
    fftw_plan row_forward, column_forward, column_inverse, row_inverse;
};

/* Sizes of a work's arrays, in elements. */
typedef struct surface_sizes {
    size_t field_columns, field;  /* complex [max(along.lattice, rows)][field_columns] */
    size_t tile, spread;          /* complex [SURFACE_TILE][along.lattice or along.fine] */
    size_t row_real, row_complex; /* one row across the beam, as long as the longer transform */
} surface_sizes;

surface_sizes haft_surface_plan_sizes(const haft_surface_plan *plan);

#endif
