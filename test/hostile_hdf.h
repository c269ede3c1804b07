/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HDF5 files that a reader must refuse, written with the library; every failure here ends the test.
 */
#ifndef HAFT_TEST_HOSTILE_HDF_H
#define HAFT_TEST_HOSTILE_HDF_H

#include "scratch.h"

#include <hdf5.h>

enum { HDF_SIDE = 16 };

/* What a dataset is made by; all zero is a plain one. */
typedef struct hdf_layout {
    const char *external;   /* its data lie in this file */
    const char *virtual_of; /* it is the dataset "z" of this file */
    hsize_t chunk;          /* a side */
    bool deflate;
    int filter;     /* number of one that is registered */
    bool unwritten; /* no data at all */
} hdf_layout;

static inline hid_t hdf_create(const char *path) {
    hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(file >= 0);
    return file;
}

static inline hid_t hdf_layout_list(const hdf_layout *l, hid_t space, hsize_t bytes) {
    hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
    if (l->external != NULL) {
        assert_true(H5Pset_external(creation, l->external, 0, bytes) >= 0);
    }
    if (l->virtual_of != NULL) {
        assert_true(H5Pset_virtual(creation, space, l->virtual_of, "z", space) >= 0);
    }
    if (l->chunk > 0) {
        assert_true(H5Pset_chunk(creation, 2, (hsize_t[]){l->chunk, l->chunk}) >= 0);
    }
    if (l->deflate) {
        assert_true(H5Pset_deflate(creation, 6) >= 0);
    }
    if (l->filter > 0) {
        assert_true(H5Pset_filter(creation, l->filter, 0, 0, NULL) >= 0);
    }
    return creation;
}

/* A matrix of rows x columns; heights k % 7 of pixel k unless they are not written. */
static inline void hdf_matrix(hid_t at, const char *name, hsize_t rows, hsize_t columns,
                              const hdf_layout *l) {
    hid_t space = H5Screate_simple(2, (hsize_t[]){rows, columns},
                                   l->chunk > 0 ? (hsize_t[]){H5S_UNLIMITED, H5S_UNLIMITED} : NULL);
    hid_t creation = hdf_layout_list(l, space, rows * columns * sizeof(double));
    hid_t set = H5Dcreate2(at, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    assert_true(set >= 0);
    if (!l->unwritten && l->virtual_of == NULL && l->external == NULL) {
        double *z = calloc(rows * columns, sizeof *z);
        assert_non_null(z);
        for (size_t k = 0; k < rows * columns; k++) {
            z[k] = (double)(k % 7);
        }
        assert_true(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, z) >= 0);
        free(z);
    }
    H5Dclose(set);
    H5Pclose(creation);
    H5Sclose(space);
}

/* An attribute of `points` values, or of one in a space of rank 0 (points 0). */
static inline void hdf_attach(hid_t file, const char *object, const char *name, hid_t type,
                              hsize_t points, const void *value) {
    hid_t space = points == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &points, NULL);
    hid_t attribute =
        H5Acreate_by_name(file, object, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(attribute >= 0 && H5Awrite(attribute, type, value) >= 0);
    H5Aclose(attribute);
    H5Sclose(space);
}

/* The type of a text of that length; 0: of any. */
static inline hid_t hdf_text_type(size_t length) {
    hid_t type = H5Tcopy(H5T_C_S1);
    assert_true(H5Tset_size(type, length == 0 ? H5T_VARIABLE : length) >= 0);
    return type;
}

/* Puts the header with length and checksum in front of an HDF5 file, as Haft's own files have it.
 */
static inline void hdf_vouch(const char *path) {
    enum { HEADER = 512 };
    size_t size = 0;
    char digest[HAFT_DIGEST_CAPACITY], *bytes = read_whole_file(path, &size);
    char *both = calloc(HEADER + size, 1);
    assert_non_null(both);
    haft_digest_memory(bytes, size, digest);
    snprintf(both, HEADER, "haft data: HDF5 from byte 512 on\nsize %zu\nxxh3-128 %s\n", size,
             digest);
    memcpy(both + HEADER, bytes, size);
    write_file(path, both, HEADER + size);
    free(both);
    free(bytes);
}

#endif
