/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads untrusted files: checks every link, type, shape and size before it reads a value. */
#include "hdf.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void haft_hdf_refuse(haft_hdf *hdf, const char *format, ...) {
    if (hdf->status != HAFT_OK) {
        return;
    }
    char message[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    hdf->status =
        haft_error_set(hdf->error, HAFT_ERROR_INPUT, "%s: %s; %s", hdf->path, message, hdf->remedy);
}

/* ---- objects ---- */

/* Opens the object at a path. Rejects the file if the path has a soft or external link; the caller
 * handles missing objects. */
static hid_t enter(haft_hdf *hdf, const char *path) {
    const char *reason = NULL;
    hid_t object = hdf->status == HAFT_OK ? haft_hdf_enter(hdf->file, path, &reason) : -1;
    if (object < 0 && reason != NULL && reason != haft_hdf_missing) {
        haft_hdf_refuse(hdf, "has %s, which %s", path, reason);
    }
    return object;
}

/* Opens an object that must exist. */
static hid_t open_object(haft_hdf *hdf, const char *path) {
    hid_t object = enter(hdf, path);
    if (object < 0) {
        haft_hdf_refuse(hdf, "lacks %s", path);
    }
    return object;
}

bool haft_hdf_has(haft_hdf *hdf, const char *path) {
    hid_t object = enter(hdf, path);
    if (object >= 0) {
        H5Oclose(object);
    }
    return object >= 0;
}

/* ---- attributes ---- */

bool haft_hdf_has_attribute(haft_hdf *hdf, const char *object, const char *name) {
    hid_t id = open_object(hdf, object);
    bool there = id >= 0 && H5Aexists(id, name) > 0;
    if (id >= 0) {
        H5Oclose(id);
    }
    return there;
}

static void read_attribute(haft_hdf *hdf, const char *object, const char *name, haft_hdf_kind kind,
                           void *value) {
    hid_t id = open_object(hdf, object);
    if (id < 0) {
        return;
    }
    switch (haft_hdf_get_attribute(id, name, kind, 1, value)) {
    case HAFT_HDF_FOUND:
        break;
    case HAFT_HDF_ABSENT:
        haft_hdf_refuse(hdf, "lacks the attribute `%s` of %s", name, object);
        break;
    case HAFT_HDF_FOREIGN:
        haft_hdf_refuse(hdf, "has an attribute `%s` of %s that is not one %s", name, object,
                        kind == HAFT_HDF_TEXT ? "text of at most 1 MiB" : "number");
        break;
    case HAFT_HDF_UNREADABLE:
        haft_hdf_refuse(hdf, "has an attribute `%s` of %s that cannot be read", name, object);
        break;
    case HAFT_HDF_NO_MEMORY:
        hdf->status = haft_error_set(hdf->error, HAFT_ERROR_MEMORY,
                                     "%s: no memory for the attribute `%s`", hdf->path, name);
        break;
    }
    H5Oclose(id);
}

void haft_hdf_read_text(haft_hdf *hdf, const char *object, const char *name, char **text) {
    *text = NULL;
    read_attribute(hdf, object, name, HAFT_HDF_TEXT, text);
}

void haft_hdf_read_real(haft_hdf *hdf, const char *object, const char *name, double *value) {
    read_attribute(hdf, object, name, HAFT_HDF_REALS, value);
}

void haft_hdf_read_count(haft_hdf *hdf, const char *object, const char *name, uint64_t *value) {
    read_attribute(hdf, object, name, HAFT_HDF_COUNTS, value);
}

/* ---- datasets ---- */

/* Opens a dataset and gets its shape, or rejects the file. */
static hid_t open_dataset(haft_hdf *hdf, const char *path, int rank, haft_hdf_set *set) {
    const char *reason = NULL;
    hid_t dataset = enter(hdf, path);
    if (dataset < 0 || H5Iget_type(dataset) != H5I_DATASET) {
        haft_hdf_refuse(hdf, "lacks the dataset %s", path);
    } else if ((reason = haft_hdf_inspect(set, dataset, hdf->file_bytes)) != NULL) {
        haft_hdf_refuse(hdf, "has the dataset %s, which %s", path, reason);
    } else if (set->class == H5T_NO_CLASS) {
        haft_hdf_refuse(hdf, "has %s of another type than real or integer", path);
    } else if (set->rank != rank) {
        haft_hdf_refuse(hdf, "has %s in %d dimensions where %d are wanted", path, set->rank, rank);
    }
    if (dataset >= 0 && hdf->status != HAFT_OK) {
        H5Oclose(dataset);
        return -1;
    }
    return dataset;
}

void haft_hdf_shape(haft_hdf *hdf, const char *path, int rank, size_t *dims) {
    haft_hdf_set set;
    memset(dims, 0, (size_t)rank * sizeof *dims);
    hid_t dataset = open_dataset(hdf, path, rank, &set);
    if (dataset >= 0) {
        for (int i = 0; i < rank; i++) {
            dims[i] = (size_t)set.dims[i];
        }
        H5Oclose(dataset);
    }
}

void haft_hdf_read(haft_hdf *hdf, const char *path, haft_hdf_type type, int rank,
                   const size_t *dims, void *value) {
    haft_hdf_set set;
    hid_t dataset = open_dataset(hdf, path, rank, &set);
    if (dataset < 0) {
        return;
    }
    bool real = type == HAFT_HDF_REAL;
    for (int i = 0; i < rank; i++) {
        if (set.dims[i] != dims[i]) {
            haft_hdf_refuse(hdf, "has %s of extent %zu where %zu is wanted", path,
                            (size_t)set.dims[i], dims[i]);
        }
    }
    if (set.class != (real ? H5T_FLOAT : H5T_INTEGER)) {
        haft_hdf_refuse(hdf, "has %s of another type than %s", path, real ? "real" : "integer");
    } else if (hdf->status == HAFT_OK && H5Dread(dataset, haft_hdf_native_type(type), H5S_ALL,
                                                 H5S_ALL, H5P_DEFAULT, value) < 0) {
        haft_hdf_refuse(hdf, "has %s that cannot be read", path);
    }
    H5Oclose(dataset);
}

void haft_hdf_read_columns(haft_hdf *hdf, const char *group, size_t columns,
                           const haft_hdf_column *column, void *rows, size_t stride, size_t n) {
    if (hdf->status != HAFT_OK) {
        return;
    }
    double *scratch = haft_memory_alloc(n, sizeof *scratch, hdf->error);
    if (scratch == NULL) {
        hdf->status = HAFT_ERROR_MEMORY;
        return;
    }
    for (size_t j = 0; j < columns && hdf->status == HAFT_OK; j++) {
        size_t size = column[j].type == HAFT_HDF_REAL ? sizeof(double) : sizeof(int);
        char path[128];
        snprintf(path, sizeof path, "%s/%s", group, column[j].name);
        haft_hdf_read(hdf, path, column[j].type, 1, &n, scratch);
        for (size_t i = 0; i < n && hdf->status == HAFT_OK; i++) {
            memcpy((char *)rows + i * stride + column[j].offset, (const char *)scratch + i * size,
                   size);
        }
    }
    haft_memory_free(scratch);
}
