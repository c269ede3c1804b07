/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What inspect prints beyond its own findings: the parameters of ISO 25178, and the map as the
 * `surface` section of a case, which haft init writes too. */
#ifndef HAFT_TOOLS_INSPECT_PRINT_H
#define HAFT_TOOLS_INSPECT_PRINT_H

#include "inspect.h"

/* A `surface` section of a map. */
typedef struct surface_block {
    size_t files, opposite_files;
    const char *const *file, *const *opposite; /* as they are to be written */
    const inspect_wishes *wishes;
    const char *channel;     /* "" : the first with heights */
    double grid_step;        /* [m] */
    double kernel_tolerance; /* 0: the default */
    const haft_psd_fit *fit; /* NULL: none */
} surface_block;

void inspect_print_texture(FILE *stream, const haft_map_texture *t);

/* The section, each option as a key, and in comments the fitted PSD in both forms. */
haft_status inspect_print_block(FILE *stream, const surface_block *b, haft_error *error);

/* The coarsest step of a plain number of nanometres (1, 1.5, 2, ... 7.5 times a power of ten) that
 * carries waves up to zeta_max. */
double inspect_grid_step(double zeta_max);

#endif
