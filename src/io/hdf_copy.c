/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A file without a valid checksum may come from anywhere, and a few changed bytes can make HDF5
 * write out of bounds. So a child process reads it and returns a new file with what Haft reads:
 * groups, datasets of numbers, and attributes of one text or number. The parent opens only that
 * file. Soft and external links and other kinds of data are left out. */
#include "child.h"
#include "hdf.h"

#include <stdio.h>
#include <string.h>

/* The deepest path that Haft writes is /realizations/K/evidence/NAME. No object is smaller than
 * OBJECT_BYTES. */
enum { DEPTH_MOST = 8, OBJECT_BYTES = 64, ATTRIBUTES_MOST = 256 };

typedef struct copier {
    haft_hdf from, to;
    char *list; /* what Haft wrote, if the file has the list */
} copier;

/* ---- in the child ---- */

/* Copies an attribute that can be read as a text or a number; others are left out. */
static void copy_attribute(haft_hdf *to, hid_t object, const char *path, const char *name) {
    char *text = NULL;
    uint64_t count = 0;
    double real = 0;
    if (haft_hdf_get_attribute(object, name, HAFT_HDF_TEXT, 1, &text) == HAFT_HDF_FOUND) {
        haft_hdf_write_text(to, path, name, text);
    } else if (haft_hdf_get_attribute(object, name, HAFT_HDF_COUNTS, 1, &count) == HAFT_HDF_FOUND) {
        haft_hdf_write_count(to, path, name, count);
    } else if (haft_hdf_get_attribute(object, name, HAFT_HDF_REALS, 1, &real) == HAFT_HDF_FOUND) {
        haft_hdf_write_real(to, path, name, real);
    }
    haft_memory_free(text);
}

static void copy_attributes(copier *c, hid_t object, const char *path) {
    for (unsigned i = 0; i < ATTRIBUTES_MOST; i++) {
        char name[64];
        ssize_t n = H5Aget_name_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_NATIVE, i, name,
                                       sizeof name, H5P_DEFAULT);
        if (n < 0) {
            return;
        }
        if (n > 0 && (size_t)n < sizeof name) {
            copy_attribute(&c->to, object, path, name);
        }
    }
}

/* Copies a dataset as doubles or ints, which is what the readers take. A dataset that Haft did not
 * write may be of any kind. */
static void copy_dataset(copier *c, hid_t dataset, const char *path) {
    haft_hdf_set set;
    const char *reason = haft_hdf_inspect(&set, dataset, c->from.file_bytes);
    if (reason != NULL && (c->list == NULL || haft_hdf_list_has(c->list, path))) {
        haft_hdf_refuse(&c->from, "has the dataset %s, which %s", path, reason);
    }
    if (reason != NULL || set.class == H5T_NO_CLASS || set.rank == 0) {
        return;
    }
    bool real = set.class == H5T_FLOAT;
    size_t n = 1;
    for (int i = 0; i < set.rank; i++) {
        n *= (size_t)set.dims[i]; /* no overflow: haft_hdf_inspect() has bounded the size */
    }
    haft_child_allow(2 * n * sizeof(double));
    double *value = haft_memory_alloc(n, sizeof *value, c->from.error);
    if (value == NULL) {
        c->from.status = HAFT_ERROR_MEMORY;
    } else if (H5Dread(dataset, real ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT, H5S_ALL, H5S_ALL,
                       H5P_DEFAULT, value) < 0) {
        haft_hdf_refuse(&c->from, "has %s that cannot be read", path);
    } else {
        haft_hdf_write(&c->to, path, real ? HAFT_HDF_REAL : HAFT_HDF_INT, set.rank, set.dims, value,
                       NULL, NULL);
        copy_attributes(c, dataset, path);
    }
    haft_memory_free(value);
}

static herr_t copy_object(void *user, const char *path, hid_t object, H5I_type_t kind,
                          haddr_t address) {
    (void)address;
    copier *c = user;
    if (kind == H5I_GROUP) {
        haft_hdf_write_group(&c->to, path);
        copy_attributes(c, object, path);
    } else if (kind == H5I_DATASET) {
        copy_dataset(c, object, path);
    }
    return c->from.status == HAFT_OK && c->to.status == HAFT_OK ? 0 : -1;
}

static void copy_all(copier *c) {
    hid_t root = haft_hdf_open_image(c->from.bytes, c->from.file_bytes);
    if (root < 0) {
        haft_hdf_refuse(&c->from, "cannot be read as HDF5");
        return;
    }
    c->from.file = root;
    c->list = haft_hdf_list_read(&c->from);
    haft_hdf_begin(&c->to);
    copy_attributes(c, root, "/");
    const char *reason =
        haft_hdf_walk(root, DEPTH_MOST, c->from.file_bytes / OBJECT_BYTES, copy_object, c);
    if (reason != NULL) {
        haft_hdf_refuse(&c->from, "has %s", reason);
    }
    haft_memory_free(c->list);
    H5Fclose(root);
}

static haft_status copy(const void *context, void **bytes, size_t *size, haft_error *error) {
    const haft_hdf *given = context;
    haft_error first = {0}, second = {0};
    copier c = {.from = *given, .to = {.file = -1, .path = given->path}};
    c.from.error = &first;
    c.to.error = &second;
    copy_all(&c);
    if (c.from.status == HAFT_OK) {
        haft_hdf_take_image(&c.to, bytes, size);
    }
    haft_status status = c.from.status != HAFT_OK ? c.from.status : c.to.status;
    if (status != HAFT_OK) {
        haft_error_set(error, status, "%s",
                       c.from.status != HAFT_OK ? first.message : second.message);
    }
    return status;
}

/* ---- in the parent ---- */

void haft_hdf_copy_apart(haft_hdf *hdf) {
    void *bytes = NULL;
    size_t size = 0;
    haft_child_input input = {
        .path = hdf->path, .remedy = hdf->remedy, .bytes = hdf->file_bytes, .context = hdf};
    hdf->status = haft_child_run(&bytes, &size, copy, &input, hdf->error);
    if (hdf->status == HAFT_OK) {
        haft_memory_free(hdf->bytes);
        hdf->bytes = bytes;
        hdf->file_bytes = size;
    }
}
