/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the parts of the HDF5 map reader share. Private to this room. */
#ifndef HAFT_IO_MAP_HDF_H
#define HAFT_IO_MAP_HDF_H

#include "hdf.h"
#include "map_file.h"

enum { HAFT_MAP_FILLS_MOST = 16 };

/* How a dataset's numbers become heights, by the conventions of NetCDF (CF): those that mark
 * missing pixels or lie out of the valid range are none, and the others are scale * number +
 * offset. */
typedef struct haft_map_packing {
    double scale, offset;
    double fill[HAFT_MAP_FILLS_MOST];
    size_t fills;
    double least, most; /* valid numbers */
    bool single;        /* the numbers are of 32 bits: so are the marks, whatever holds them */
} haft_map_packing;

/* Reads the attributes `scale_factor`, `add_offset`, `_FillValue`, `missing_value`, `valid_min`,
 * `valid_max`, `valid_range` and the dataset's own fill value. NULL, or the attribute that is not
 * as it should be. */
const char *haft_map_packing_read(haft_map_packing *p, hid_t set, const haft_hdf_set *about);

/* Makes not-a-number of the numbers that are none; returns how many. */
size_t haft_map_packing_mask(const haft_map_packing *p, double *number, size_t n);

/* Whether another program holds the file open for writing. */
bool haft_map_hdf_is_locked(const haft_map_file *file);

/* Tells of a file that cannot be read: it is damaged, or open elsewhere. */
haft_status haft_map_hdf_refuse(const haft_map_file *file, const char *what, haft_error *error);

#endif
