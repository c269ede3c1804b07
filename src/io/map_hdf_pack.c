/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Packed numbers and missing pixels of an HDF5 dataset, by the conventions of NetCDF (CF 1.11,
 * sections 2.5.1 and 8.1): fill values and limits apply to the packed numbers. A dataset's own fill
 * value is in pixels that were never written; a fill value of 0 is ignored, since programs often
 * set it by default. */
#include "map_hdf.h"

#include <float.h>
#include <math.h>

/* Reads one number; also true if the attribute is absent. */
static bool read_one(hid_t set, const char *name, double *value) {
    haft_hdf_found found = haft_hdf_get_attribute(set, name, HAFT_HDF_REALS, 1, value);
    return found == HAFT_HDF_FOUND || found == HAFT_HDF_ABSENT;
}

/* Reads an attribute with any number of fill values. */
static bool read_fills(haft_map_packing *p, hid_t set, const char *name) {
    size_t room = HAFT_MAP_FILLS_MOST - p->fills;
    for (size_t n = 1; n <= room; n++) {
        haft_hdf_found found =
            haft_hdf_get_attribute(set, name, HAFT_HDF_REALS, n, p->fill + p->fills);
        if (found != HAFT_HDF_FOREIGN) {
            p->fills += found == HAFT_HDF_FOUND ? n : 0;
            return found == HAFT_HDF_FOUND || found == HAFT_HDF_ABSENT;
        }
    }
    return false;
}

static bool read_range(haft_map_packing *p, hid_t set) {
    double range[2] = {p->least, p->most};
    haft_hdf_found found = haft_hdf_get_attribute(set, "valid_range", HAFT_HDF_REALS, 2, range);
    p->least = range[0];
    p->most = range[1];
    return (found == HAFT_HDF_FOUND || found == HAFT_HDF_ABSENT) && p->least <= p->most;
}

/* Reads the fill value of the library, for pixels that were never written. */
static void read_own_fill(haft_map_packing *p, hid_t set) {
    H5D_fill_value_t state = H5D_FILL_VALUE_UNDEFINED;
    double value = 0;
    hid_t creation = H5Dget_create_plist(set);
    if (creation >= 0 && H5Pfill_value_defined(creation, &state) >= 0 &&
        state == H5D_FILL_VALUE_USER_DEFINED &&
        H5Pget_fill_value(creation, H5T_NATIVE_DOUBLE, &value) >= 0 && value != 0 &&
        p->fills < HAFT_MAP_FILLS_MOST) {
        p->fill[p->fills++] = value;
    }
    if (creation >= 0) {
        H5Pclose(creation);
    }
}

const char *haft_map_packing_read(haft_map_packing *p, hid_t set, const haft_hdf_set *about) {
    *p = (haft_map_packing){.scale = 1, .least = -INFINITY, .most = INFINITY};
    p->single = about->class == H5T_FLOAT && about->type_bytes == sizeof(float);
    if (!read_one(set, "scale_factor", &p->scale) || !isfinite(p->scale) || p->scale == 0) {
        return "scale_factor";
    }
    if (!read_one(set, "add_offset", &p->offset) || !isfinite(p->offset)) {
        return "add_offset";
    }
    read_own_fill(p, set);
    if (!read_fills(p, set, "_FillValue")) {
        return "_FillValue";
    }
    if (!read_fills(p, set, "missing_value")) {
        return "missing_value";
    }
    if (!read_one(set, "valid_min", &p->least) || isnan(p->least)) {
        return "valid_min";
    }
    if (!read_one(set, "valid_max", &p->most) || isnan(p->most)) {
        return "valid_max";
    }
    return read_range(p, set) ? NULL : "valid_range";
}

static bool is_fill(const haft_map_packing *p, double number) {
    for (size_t k = 0; k < p->fills; k++) {
        double fill = p->fill[k];
        if (number == fill) {
            return true;
        }
        if (p->single && fabs(fill) <= (double)FLT_MAX && (float)number == (float)fill) {
            return true;
        }
    }
    return false;
}

size_t haft_map_packing_mask(const haft_map_packing *p, double *number, size_t n) {
    size_t masked = 0;
    for (size_t i = 0; i < n; i++) {
        if (!isnan(number[i]) &&
            (number[i] < p->least || number[i] > p->most || is_fill(p, number[i]))) {
            number[i] = NAN;
            masked++;
        }
    }
    return masked;
}
