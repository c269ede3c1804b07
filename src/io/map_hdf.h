/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the parts of the HDF5 map reader share. Private to this room. */
#ifndef HAFT_IO_MAP_HDF_H
#define HAFT_IO_MAP_HDF_H

#include "hdf.h"
#include "map_file.h"

enum { HAFT_MAP_FILLS_MOST = 16 };

/* How a dataset's numbers become heights, by the conventions of NetCDF (CF): fill values and
 * numbers outside the valid range are missing pixels, the others are scale * number + offset. */
typedef struct haft_map_packing {
    double scale, offset;
    double fill[HAFT_MAP_FILLS_MOST];
    size_t fills;
    double least, most; /* valid numbers */
    bool single;        /* the numbers have 32 bits, so fill values are rounded to 32 bits too */
} haft_map_packing;

/* Reads the attributes `scale_factor`, `add_offset`, `_FillValue`, `missing_value`, `valid_min`,
 * `valid_max`, `valid_range` and the dataset's own fill value. Returns NULL, or the name of an
 * invalid attribute. */
const char *haft_map_packing_read(haft_map_packing *p, hid_t set, const haft_hdf_set *about);

/* Replaces missing pixels by not-a-number; returns how many. */
size_t haft_map_packing_mask(const haft_map_packing *p, double *number, size_t n);

/* Whether another program has the file open for writing. */
bool haft_map_hdf_is_locked(const haft_map_file *file);

/* Reports a file that cannot be read: it is damaged, or open elsewhere. */
haft_status haft_map_hdf_refuse(const haft_map_file *file, const char *what, haft_error *error);

#endif
