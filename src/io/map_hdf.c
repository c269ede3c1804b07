/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A height map as a two-dimensional HDF5 dataset, with the attributes `unit` (text) and `size`
 * (width and height, in metres). The library's own messages are turned off; what it cannot open is
 * refused.
 */
#include "hdf.h"
#include "map_file.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Names of the two-dimensional datasets that a file holds. */
typedef struct finder {
    char names[512];
    char first[256];
    size_t found;
} finder;

static herr_t visit(hid_t group, const char *name, const H5O_info_t *info, void *user) {
    finder *f = user;
    if (info->type != H5O_TYPE_DATASET) {
        return 0;
    }
    hid_t set = H5Dopen2(group, name, H5P_DEFAULT);
    hid_t space = set >= 0 ? H5Dget_space(set) : -1;
    if (space >= 0 && H5Sget_simple_extent_ndims(space) == 2) {
        size_t used = strlen(f->names);
        snprintf(f->names + used, sizeof f->names - used, "%s%.60s", used > 0 ? ", " : "", name);
        if (f->found++ == 0) {
            snprintf(f->first, sizeof f->first, "%.255s", name);
        }
    }
    if (space >= 0) {
        H5Sclose(space);
    }
    if (set >= 0) {
        H5Dclose(set);
    }
    return 0;
}

/* Metres of the text attribute `unit`, 0 if there is none; false if it is no length. */
static bool read_unit(hid_t set, double *unit) {
    char text[64] = "", *variable = NULL;
    *unit = 0;
    if (H5Aexists(set, "unit") <= 0) {
        return true;
    }
    hid_t attribute = H5Aopen(set, "unit", H5P_DEFAULT);
    hid_t type = attribute >= 0 ? H5Aget_type(attribute) : -1;
    bool good = type >= 0 && H5Tget_class(type) == H5T_STRING;
    if (good && H5Tis_variable_str(type) > 0) {
        hid_t memory = H5Tcopy(H5T_C_S1);
        good = H5Tset_size(memory, H5T_VARIABLE) >= 0 &&
               H5Tset_cset(memory, H5Tget_cset(type)) >= 0 &&
               H5Aread(attribute, memory, &variable) >= 0 && variable != NULL;
        if (good) {
            snprintf(text, sizeof text, "%.63s", variable);
        }
        H5free_memory(variable);
        H5Tclose(memory);
    } else if (good) {
        good = H5Tget_size(type) < sizeof text && H5Aread(attribute, type, text) >= 0;
    }
    if (type >= 0) {
        H5Tclose(type);
    }
    if (attribute >= 0) {
        H5Aclose(attribute);
    }
    return good && haft_map_length(1, text, unit) && *unit > 0;
}

/* The attribute `size`; zeros if there is none. */
static bool read_size(hid_t set, double size[2]) {
    size[0] = size[1] = 0;
    if (H5Aexists(set, "size") <= 0) {
        return true;
    }
    hid_t attribute = H5Aopen(set, "size", H5P_DEFAULT);
    hid_t space = attribute >= 0 ? H5Aget_space(attribute) : -1;
    bool good = space >= 0 && H5Sget_simple_extent_npoints(space) == 2 &&
                H5Aread(attribute, H5T_NATIVE_DOUBLE, size) >= 0 && size[0] > 0 && size[1] > 0 &&
                isfinite(size[0] + size[1]);
    if (space >= 0) {
        H5Sclose(space);
    }
    if (attribute >= 0) {
        H5Aclose(attribute);
    }
    return good;
}

/* The dataset's shape, if it is two-dimensional and no larger than the file allows. */
static bool read_shape(const haft_map_file *file, hid_t set, hsize_t shape[2]) {
    hid_t space = H5Dget_space(set), type = H5Dget_type(set);
    H5T_class_t kind = type >= 0 ? H5Tget_class(type) : H5T_NO_CLASS;
    bool good = space >= 0 && H5Sget_simple_extent_ndims(space) == 2 &&
                H5Sget_simple_extent_dims(space, shape, NULL) == 2 &&
                (kind == H5T_FLOAT || kind == H5T_INTEGER) && shape[0] >= 2 && shape[1] >= 2 &&
                shape[0] <= 32768 && shape[1] <= 32768 &&
                shape[0] * shape[1] / 1024 <= file->size; /* deflate packs no denser */
    if (space >= 0) {
        H5Sclose(space);
    }
    if (type >= 0) {
        H5Tclose(type);
    }
    return good;
}

static haft_status read_set(haft_map **out, const haft_map_file *file, hid_t set, const char *name,
                            haft_error *error) {
    hsize_t shape[2] = {0, 0};
    double unit = 0, size[2];
    if (!read_shape(file, set, shape)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: %s is no matrix of numbers, 2 to 32768 a side", file->path,
                              name);
    }
    if (!read_unit(set, &unit) || !read_size(set, size)) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "%s: %s has an attribute `unit` that is no length, or a `size` that is "
            "not two of them in metres",
            file->path, name);
    }
    double *z = haft_memory_alloc(shape[0] * shape[1], sizeof *z, error);
    if (z == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    haft_status status = HAFT_OK;
    if (H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, z) < 0) {
        status = haft_error_set(error, HAFT_ERROR_INPUT,
                                "%s: the pixels of %s cannot be read; the file is damaged",
                                file->path, name);
    }
    if (status == HAFT_OK) {
        status =
            haft_map_from_matrix(out, file, shape[0], shape[1], size[0], size[1], unit, z, error);
    }
    haft_memory_free(z);
    return status;
}

static haft_status read_file(haft_map **out, const haft_map_file *file, hid_t hdf,
                             haft_error *error) {
    finder f = {.found = 0};
    H5Ovisit(hdf, H5_INDEX_NAME, H5_ITER_NATIVE, visit, &f);
    const char *name = file->options.channel[0] != '\0' ? file->options.channel : f.first;
    if (file->options.channel[0] == '\0' && f.found != 1) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              f.found == 0 ? "%s: holds no two-dimensional dataset%s"
                                           : "%s: holds several maps; name one as the channel: %s",
                              file->path, f.names);
    }
    hid_t set = H5Dopen2(hdf, name, H5P_DEFAULT);
    if (set < 0) {
        char quoted[48];
        return haft_error_set(error, HAFT_ERROR_INPUT, "%s: has no dataset \"%s\"; it has: %s",
                              file->path, haft_map_quote(quoted, name, 40), f.names);
    }
    haft_status status = read_set(out, file, set, name, error);
    H5Dclose(set);
    if (status == HAFT_OK) {
        haft_map_name((*out)->channel, name, strlen(name));
        snprintf((*out)->format, sizeof(*out)->format, "HDF5");
    }
    return status;
}

haft_status haft_map_read_hdf(haft_map **out, const haft_map_file *file, haft_error *error) {
    haft_hdf_voice voice = haft_hdf_hush();
    hid_t hdf = H5Fopen(file->path, H5F_ACC_RDONLY, H5P_DEFAULT);
    haft_status status;
    if (hdf < 0) {
        status = haft_error_set(error, HAFT_ERROR_INPUT,
                                "%s: is an HDF5 file that cannot be opened; it is cut short or "
                                "damaged",
                                file->path);
    } else {
        status = read_file(out, file, hdf, error);
        H5Fclose(hdf);
    }
    haft_hdf_unhush(voice);
    return status;
}
