/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files are made in memory (HDF5's core driver) and then written by plain writes, after a header
 * with a checksum. So a full disk is an ordinary error, which HDF5 would not survive if it wrote
 * the file itself, and damage is detected before HDF5 reads the file. The cost is memory of the
 * file's size. No object has a time stamp, so that the same contents give the same bytes. */
#include "hdf.h"

#include <stdio.h>
#include <string.h>

static herr_t keep_first(unsigned n, const H5E_error2_t *entry, void *data) {
    const char **message = data;
    if (n == 0 && entry->desc != NULL) {
        *message = entry->desc;
    }
    return 0;
}

void haft_hdf_fail(haft_hdf *hdf, const char *what) {
    if (hdf->status != HAFT_OK) {
        return;
    }
    const char *message = "no reason given";
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first, &message);
    hdf->status = haft_error_set(hdf->error, HAFT_ERROR_LIBRARY, "%s: HDF5 cannot make %s: %s",
                                 hdf->path, what, message);
}

void haft_hdf_begin(haft_hdf *hdf) {
    hdf->file = -1;
    if (hdf->status != HAFT_OK) {
        return;
    }
    hid_t access = H5Pcreate(H5P_FILE_ACCESS), creation = H5Pcreate(H5P_FILE_CREATE);
    if (access >= 0 && creation >= 0 && H5Pset_fapl_core(access, 1 << 20, 0) >= 0 &&
        H5Pset_fclose_degree(access, H5F_CLOSE_STRONG) >= 0 &&
        H5Pset_obj_track_times(creation, 0) >= 0) {
        hdf->file = H5Fcreate(hdf->path, H5F_ACC_TRUNC, creation, access);
    }
    if (hdf->file < 0) {
        haft_hdf_fail(hdf, "a file in memory");
    }
    H5Pclose(creation);
    H5Pclose(access);
}

void haft_hdf_drop(haft_hdf *hdf) {
    haft_hdf_list_release(hdf);
    if (hdf->file >= 0) {
        H5Fclose(hdf->file);
        hdf->file = -1;
    }
}

/* ---- attributes ---- */

static void attach(haft_hdf *hdf, hid_t object, const char *name, hid_t stored, hid_t given,
                   const void *value) {
    hid_t space = H5Screate(H5S_SCALAR);
    hid_t attribute = H5Acreate2(object, name, stored, space, H5P_DEFAULT, H5P_DEFAULT);
    if (attribute < 0 || H5Awrite(attribute, given, value) < 0) {
        haft_hdf_fail(hdf, name);
    }
    if (attribute >= 0) {
        H5Aclose(attribute);
    }
    H5Sclose(space);
}

static void attach_text(haft_hdf *hdf, hid_t object, const char *name, const char *text) {
    hid_t type = H5Tcopy(H5T_C_S1);
    if (type < 0 || H5Tset_size(type, strlen(text) + 1) < 0 ||
        H5Tset_cset(type, H5T_CSET_UTF8) < 0) {
        haft_hdf_fail(hdf, name);
    } else {
        attach(hdf, object, name, type, type, text);
    }
    if (type >= 0) {
        H5Tclose(type);
    }
}

static hid_t open_object(haft_hdf *hdf, const char *path) {
    hid_t object = hdf->status == HAFT_OK ? H5Oopen(hdf->file, path, H5P_DEFAULT) : -1;
    if (object < 0) {
        haft_hdf_fail(hdf, path);
    }
    return object;
}

void haft_hdf_write_text(haft_hdf *hdf, const char *object, const char *name, const char *text) {
    hid_t id = open_object(hdf, object);
    if (id >= 0) {
        attach_text(hdf, id, name, text);
        haft_hdf_list_attribute(hdf, object, name, HAFT_HDF_TEXT, text, strlen(text));
        H5Oclose(id);
    }
}

/* Writes a double or a uint64_t, depending on the kind. */
static void write_number(haft_hdf *hdf, const char *object, const char *name, haft_hdf_kind kind,
                         const void *value) {
    bool real = kind == HAFT_HDF_REALS;
    hid_t id = open_object(hdf, object);
    if (id >= 0) {
        attach(hdf, id, name, real ? H5T_IEEE_F64LE : H5T_STD_U64LE,
               real ? H5T_NATIVE_DOUBLE : H5T_NATIVE_UINT64, value);
        haft_hdf_list_attribute(hdf, object, name, kind, value, sizeof(uint64_t));
        H5Oclose(id);
    }
}

void haft_hdf_write_real(haft_hdf *hdf, const char *object, const char *name, double value) {
    write_number(hdf, object, name, HAFT_HDF_REALS, &value);
}

void haft_hdf_write_count(haft_hdf *hdf, const char *object, const char *name, uint64_t value) {
    write_number(hdf, object, name, HAFT_HDF_COUNTS, &value);
}

void haft_hdf_write_origin(haft_hdf *hdf, const char *format, const haft_case *c,
                           const char *laws_digest) {
    char *text = NULL;
    char digest[HAFT_DIGEST_CAPACITY], hdf5[64];
    unsigned major = 0, minor = 0, release = 0;
    if (hdf->status == HAFT_OK) {
        hdf->status = haft_case_emit(&text, c, hdf->error);
    }
    if (hdf->status != HAFT_OK) {
        return;
    }
    haft_hdf_list_begin(hdf);
    haft_digest_memory(text, strlen(text), digest);
    H5get_libversion(&major, &minor, &release);
    snprintf(hdf5, sizeof hdf5, "%u.%u.%u", major, minor, release);
    haft_hdf_write_text(hdf, "/", "format", format);
    haft_hdf_write_count(hdf, "/", "layout_version", HAFT_HDF_LAYOUT);
    haft_hdf_write_text(hdf, "/", "haft_version", haft_version());
    haft_hdf_write_text(hdf, "/", "haft_revision", haft_revision());
#if defined(__clang__)
    haft_hdf_write_text(hdf, "/", "compiler", __VERSION__);
#else
    haft_hdf_write_text(hdf, "/", "compiler", "gcc " __VERSION__);
#endif
    haft_hdf_write_text(hdf, "/", "hdf5_version", hdf5);
    haft_hdf_write_count(hdf, "/", "seed", c->seed);
    haft_hdf_write_text(hdf, "/", "laws_digest", laws_digest == NULL ? "" : laws_digest);
    haft_hdf_write_text(hdf, "/", "case_digest", digest);
    haft_hdf_write_text(hdf, "/", "case", text);
    haft_memory_free(text);
}

/* ---- datasets ---- */

static hid_t stored_type(haft_hdf_type type) {
    return type == HAFT_HDF_REAL  ? H5T_IEEE_F64LE
           : type == HAFT_HDF_INT ? H5T_STD_I32LE
                                  : H5T_STD_U8LE;
}

/* Writes a dataset at a path relative to `at`, a group or the file. */
static void write_dataset(haft_hdf *hdf, hid_t at, const char *path, haft_hdf_type type, int rank,
                          const hsize_t *dims, const void *value, const char *unit,
                          const char *description) {
    static const char nothing[8] = {0};
    hid_t space = H5Screate_simple(rank, dims, NULL);
    hid_t links = H5Pcreate(H5P_LINK_CREATE), creation = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_create_intermediate_group(links, 1);
    H5Pset_obj_track_times(creation, 0);
    hid_t dataset = H5Dcreate2(at, path, stored_type(type), space, links, creation, H5P_DEFAULT);
    if (dataset < 0 || H5Dwrite(dataset, haft_hdf_native_type(type), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                                value != NULL ? value : nothing) < 0) {
        haft_hdf_fail(hdf, path);
    } else if (unit != NULL) {
        attach_text(hdf, dataset, "unit", unit);
        attach_text(hdf, dataset, "description", description);
    }
    if (dataset >= 0) {
        H5Dclose(dataset);
    }
    H5Pclose(creation);
    H5Pclose(links);
    H5Sclose(space);
}

void haft_hdf_write(haft_hdf *hdf, const char *path, haft_hdf_type type, int rank,
                    const hsize_t *dims, const void *value, const char *unit,
                    const char *description) {
    if (hdf->status == HAFT_OK) {
        write_dataset(hdf, hdf->file, path, type, rank, dims, value, unit, description);
        haft_hdf_list_dataset(hdf, path, type, rank, dims, value, unit);
    }
}

/* Opens a group, or makes it and the missing groups of its path. */
static hid_t open_group(haft_hdf *hdf, const char *path) {
    hid_t group = H5Gopen2(hdf->file, path, H5P_DEFAULT);
    if (group < 0) {
        hid_t links = H5Pcreate(H5P_LINK_CREATE);
        H5Pset_create_intermediate_group(links, 1);
        group = H5Gcreate2(hdf->file, path, links, H5P_DEFAULT, H5P_DEFAULT);
        H5Pclose(links);
    }
    if (group < 0) {
        haft_hdf_fail(hdf, path);
    }
    return group;
}

void haft_hdf_write_group(haft_hdf *hdf, const char *path) {
    hid_t group = hdf->status == HAFT_OK ? open_group(hdf, path) : -1;
    if (group >= 0) {
        H5Gclose(group);
    }
}

void haft_hdf_write_columns(haft_hdf *hdf, const char *group, size_t columns,
                            const haft_hdf_column *column, const void *rows, size_t stride,
                            size_t n) {
    if (hdf->status != HAFT_OK) {
        return;
    }
    double *scratch = haft_memory_alloc(n, sizeof *scratch, hdf->error);
    if (scratch == NULL) {
        hdf->status = HAFT_ERROR_MEMORY;
        return;
    }
    hid_t at = open_group(hdf, group);
    hsize_t dims[1] = {n};
    for (size_t j = 0; j < columns && hdf->status == HAFT_OK; j++) {
        size_t size = column[j].type == HAFT_HDF_REAL ? sizeof(double) : sizeof(int);
        for (size_t i = 0; i < n; i++) {
            memcpy((char *)scratch + i * size, (const char *)rows + i * stride + column[j].offset,
                   size);
        }
        write_dataset(hdf, at, column[j].name, column[j].type, 1, dims, scratch, column[j].unit,
                      column[j].description);
        char path[128];
        snprintf(path, sizeof path, "%s/%s", group, column[j].name);
        haft_hdf_list_dataset(hdf, path, column[j].type, 1, dims, scratch, column[j].unit);
    }
    if (at >= 0) {
        H5Gclose(at);
    }
    haft_memory_free(scratch);
}

/* ---- to the disk ---- */

void haft_hdf_make_header(char header[HAFT_HDF_HEADER], uint64_t size, const char *digest) {
    memset(header, 0, HAFT_HDF_HEADER);
    snprintf(header, HAFT_HDF_HEADER, "haft data: HDF5 from byte %d on\nsize %llu\nxxh3-128 %s\n",
             HAFT_HDF_HEADER, (unsigned long long)size, digest);
}

void haft_hdf_take_image(haft_hdf *hdf, void **bytes, size_t *size) {
    *bytes = NULL;
    *size = 0;
    if (hdf->status != HAFT_OK) {
        return;
    }
    ssize_t n =
        H5Fflush(hdf->file, H5F_SCOPE_GLOBAL) < 0 ? -1 : H5Fget_file_image(hdf->file, NULL, 0);
    if (n <= 0) {
        haft_hdf_fail(hdf, "its image");
        return;
    }
    *bytes = haft_memory_alloc((size_t)n, 1, hdf->error);
    if (*bytes == NULL) {
        hdf->status = HAFT_ERROR_MEMORY;
    } else if (H5Fget_file_image(hdf->file, *bytes, (size_t)n) != n) {
        haft_hdf_fail(hdf, "its image");
        haft_memory_free(*bytes);
        *bytes = NULL;
    } else {
        *size = (size_t)n;
    }
}

static void store_image(haft_hdf *hdf, haft_store *store) {
    void *image = NULL;
    size_t size = 0;
    haft_hdf_take_image(hdf, &image, &size);
    if (image == NULL) {
        return;
    }
    char digest[HAFT_DIGEST_CAPACITY], header[HAFT_HDF_HEADER];
    haft_digest_memory(image, size, digest);
    haft_hdf_make_header(header, (uint64_t)size, digest);
    hdf->status = haft_store_write(store, header, sizeof header, hdf->error);
    if (hdf->status == HAFT_OK) {
        hdf->status = haft_store_write(store, image, size, hdf->error);
    }
    haft_memory_free(image);
}

haft_status haft_hdf_store(haft_hdf *hdf, haft_store *store) {
    haft_hdf_list_write(hdf);
    if (hdf->status == HAFT_OK) {
        store_image(hdf, store);
    }
    haft_hdf_drop(hdf);
    if (hdf->status == HAFT_OK) {
        hdf->status = haft_store_commit(store, hdf->error);
    } else {
        haft_store_abandon(store);
    }
    return hdf->status;
}

void haft_hdf_list_write(haft_hdf *hdf) {
    haft_hdf_list *list = &hdf->contents;
    if (!list->kept) {
        return;
    }
    char digest[HAFT_DIGEST_CAPACITY];
    hsize_t dims[1] = {list->used};
    list->kept = false; /* the list has no line for itself */
    haft_digest_memory(list->text, list->used, digest);
    haft_hdf_write(hdf, HAFT_HDF_CONTENTS, HAFT_HDF_BYTE, 1, dims, list->text, "1",
                   "characters of a text; a line a dataset or attribute: XXH3-128 digest, path");
    haft_hdf_write_text(hdf, "/", HAFT_HDF_CONTENTS_DIGEST, digest);
}
