/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints the parameters of ISO 25178, and a map as the `surface` section of a case. haft init uses
 * the latter too. */
#ifndef HAFT_TOOLS_INSPECT_PRINT_H
#define HAFT_TOOLS_INSPECT_PRINT_H

#include "inspect.h"

/* The contents of a `surface` section with maps. */
typedef struct surface_block {
    size_t files, opposite_files;
    const char *const *file, *const *opposite; /* paths as they are to be written */
    const inspect_wishes *wishes;
    const char *channel;     /* "": the first with heights */
    double grid_step;        /* [m] */
    double kernel_tolerance; /* 0: the default */
    const haft_psd_fit *fit; /* NULL: none */
} surface_block;

void inspect_print_texture(FILE *stream, const haft_map_texture *t);

/* Prints the section: each option as a key, and the fitted PSD in both forms as comments. */
haft_status inspect_print_block(FILE *stream, const surface_block *b, haft_error *error);

/* The coarsest grid step that resolves waves up to zeta_max and is a plain number of nanometres (1,
 * 1.5, 2, ... 7.5 times a power of ten). */
double inspect_grid_step(double zeta_max);

#endif
