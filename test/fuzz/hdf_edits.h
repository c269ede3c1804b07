/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edits to a sound HDF5 file: an input is a list of them, done through the HDF5 library in memory,
 * so that what a reader gets is valid HDF5 under a right checksum, and wrong in what it holds.
 * Damage to the format itself would crash the library, not Haft, and never gets past the checksum.
 */
#ifndef HAFT_FUZZ_HDF_EDITS_H
#define HAFT_FUZZ_HDF_EDITS_H

#include "entry.h"

#include <hdf5.h>

/* A sound file: its bytes with Haft's header or without, and the objects in it. */
typedef struct fuzz_hdf {
    uint8_t *bytes;
    size_t size, header; /* header: bytes of it in front; 0 where there is none */
    size_t objects;
    char (*object)[128]; /* paths, "/" among them */
} fuzz_hdf;

/* Reads a file that Haft or a test wrote. */
void fuzz_hdf_open(fuzz_hdf *file, const char *path);

/* Makes the edits that the input tells and puts the file as `name`; @return its path. */
const char *fuzz_hdf_put(const fuzz_hdf *file, const char *name, fuzz_bytes *in);

#endif
