/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "hdf_edits.h"

#include "io/hdf.h"

#include <stdio.h>

enum { OBJECTS_MOST = 256, EDITS_MOST = 8, BUFFER = 1 << 16 };

static hid_t open_image(const uint8_t *bytes, size_t size) {
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_fapl_core(access, 1 << 16, 0);
    H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
    uint8_t *copy = malloc(size);
    memcpy(copy, bytes, size);
    H5Pset_file_image(access, copy, size);
    hid_t file = H5Fopen("image", H5F_ACC_RDWR, access);
    H5Pclose(access);
    free(copy);
    return file;
}

static herr_t note_object(hid_t group, const char *name, const H5O_info_t *info, void *user) {
    fuzz_hdf *file = user;
    (void)group;
    (void)info;
    if (file->objects < OBJECTS_MOST) {
        snprintf(file->object[file->objects++], sizeof *file->object, "/%s",
                 strcmp(name, ".") == 0 ? "" : name);
    }
    return 0;
}

void fuzz_hdf_open(fuzz_hdf *file, const char *path) {
    file->bytes = fuzz_get(path, &file->size);
    file->header = memcmp(file->bytes, "haft data:", 10) == 0 ? HAFT_HDF_HEADER : 0;
    file->object = calloc(OBJECTS_MOST, sizeof *file->object);
    hid_t image = open_image(file->bytes + file->header, file->size - file->header);
    if (image < 0 || H5Ovisit(image, H5_INDEX_NAME, H5_ITER_NATIVE, note_object, file) < 0) {
        fprintf(stderr, "%s cannot be edited\n", path);
        exit(2);
    }
    H5Fclose(image);
}

/* ---- what takes the place of data ---- */

static hid_t make_type(fuzz_bytes *in) {
    hid_t type;
    switch (fuzz_choice(in, 12)) {
    case 0:
        return H5Tcopy(H5T_IEEE_F32BE);
    case 1:
        return H5Tcopy(H5T_STD_I8LE);
    case 2:
        return H5Tcopy(H5T_STD_U64LE);
    case 3:
        type = H5Tcopy(H5T_C_S1);
        H5Tset_size(type, 1 + fuzz_choice(in, 300));
        return type;
    case 4:
        type = H5Tcopy(H5T_C_S1);
        H5Tset_size(type, H5T_VARIABLE);
        return type;
    case 5:
        type = H5Tcreate(H5T_COMPOUND, 16);
        H5Tinsert(type, "a", 0, H5T_NATIVE_DOUBLE);
        H5Tinsert(type, "b", 8, H5T_NATIVE_INT);
        return type;
    case 6:
        return H5Tarray_create2(H5T_NATIVE_DOUBLE, 1, (const hsize_t[]){1 + fuzz_byte(in)});
    case 7:
        return H5Tvlen_create(H5T_NATIVE_INT);
    case 8:
        return H5Tenum_create(H5T_NATIVE_INT);
    case 9:
        return H5Tcreate(H5T_OPAQUE, 8);
    case 10:
        return H5Tcopy(H5T_NATIVE_INT);
    default:
        return H5Tcopy(H5T_NATIVE_DOUBLE);
    }
}

static hid_t make_space(fuzz_bytes *in, bool small) {
    static const hsize_t extents[] = {0, 1, 2, 3, 4, 5, 6, 7, 21, 200, 1000, 1ULL << 40};
    size_t kind = fuzz_choice(in, 8), n = sizeof extents / sizeof *extents - (small ? 3 : 0);
    hsize_t dims[4];
    if (kind == 0) {
        return H5Screate(H5S_NULL);
    }
    if (kind == 1) {
        return H5Screate(H5S_SCALAR);
    }
    int rank = 1 + (int)kind % 4;
    for (int i = 0; i < rank; i++) {
        dims[i] = extents[fuzz_choice(in, n)];
    }
    return H5Screate_simple(rank, dims, NULL);
}

/* Fills a buffer with numbers, and writes it where that is little and no pointers. */
static bool fill(fuzz_bytes *in, hid_t type, hid_t space, uint8_t buffer[BUFFER]) {
    hssize_t points = H5Sget_simple_extent_npoints(space);
    size_t size = H5Tget_size(type);
    if (points < 0 || (size_t)points > BUFFER / (size + 1) || H5Tdetect_class(type, H5T_VLEN) > 0 ||
        H5Tis_variable_str(type) > 0) {
        return false;
    }
    memset(buffer, 0, BUFFER);
    for (size_t at = 0; at + 8 <= (size_t)points * size && in->left > 0; at += 8) {
        double number = fuzz_real(in);
        memcpy(buffer + at, &number, sizeof number);
    }
    return true;
}

static void replace_dataset(hid_t file, const char *path, fuzz_bytes *in, uint8_t *buffer) {
    hid_t type = make_type(in), space = make_space(in, false);
    hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
    hsize_t dims[H5S_MAX_RANK], chunk[H5S_MAX_RANK];
    int rank = H5Sget_simple_extent_ndims(space);
    size_t layout = fuzz_choice(in, 4);
    if (rank > 0 && layout == 1) {
        H5Sget_simple_extent_dims(space, dims, NULL);
        for (int i = 0; i < rank; i++) {
            chunk[i] = 1 + fuzz_choice(in, 4);
        }
        H5Pset_chunk(creation, rank, chunk);
        H5Pset_deflate(creation, 1);
    } else if (layout == 2) {
        H5Pset_external(creation, "/dev/null", 0, H5F_UNLIMITED);
    } else {
        H5Pset_alloc_time(creation, H5D_ALLOC_TIME_LATE);
    }
    H5Ldelete(file, path, H5P_DEFAULT);
    hid_t set = H5Dcreate2(file, path, type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    if (set >= 0 && layout != 2 && fill(in, type, space, buffer)) {
        H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer);
    }
    H5Dclose(set);
    H5Pclose(creation);
    H5Sclose(space);
    H5Tclose(type);
}

/* Other numbers in a dataset as it is. */
static void rewrite_dataset(hid_t file, const char *path, fuzz_bytes *in, uint8_t *buffer) {
    hid_t set = H5Dopen2(file, path, H5P_DEFAULT);
    hid_t space = set >= 0 ? H5Dget_space(set) : -1, type = set >= 0 ? H5Dget_type(set) : -1;
    hssize_t points = space >= 0 ? H5Sget_simple_extent_npoints(space) : 0;
    size_t size = type >= 0 ? H5Tget_size(type) : 0;
    if (points > 0 && size > 0 && size <= 8 && (size_t)points * size <= BUFFER &&
        H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer) >= 0) {
        for (size_t i = 0, n = 1 + fuzz_choice(in, 4); i < n; i++) {
            double number = fuzz_real(in);
            uint64_t whole = fuzz_word(in);
            uint8_t *at = buffer + fuzz_choice(in, (size_t)points) * size;
            memcpy(at, H5Tget_class(type) == H5T_FLOAT ? (void *)&number : (void *)&whole, size);
        }
        H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer);
    }
    H5Tclose(type);
    H5Sclose(space);
    H5Dclose(set);
}

static void edit_attribute(hid_t file, const char *path, fuzz_bytes *in, uint8_t *buffer) {
    hid_t object = H5Oopen(file, path, H5P_DEFAULT);
    H5O_info_t info;
    char name[64] = "unit";
    if (object < 0 || H5Oget_info2(object, &info, H5O_INFO_NUM_ATTRS) < 0) {
        return;
    }
    if (info.num_attrs > 0) {
        H5Aget_name_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC,
                           fuzz_choice(in, (size_t)info.num_attrs), name, sizeof name, H5P_DEFAULT);
    }
    size_t what = fuzz_choice(in, 4);
    hid_t type = -1, space = -1;
    if (what == 0) { /* its value alone */
        hid_t old = H5Aopen(object, name, H5P_DEFAULT);
        type = H5Aget_type(old);
        space = H5Aget_space(old);
        H5Aclose(old);
    } else if (what > 1) {
        type = make_type(in);
        space = make_space(in, true);
    }
    H5Adelete(object, name);
    hid_t made = type >= 0 ? H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT) : -1;
    if (made >= 0 && fill(in, type, space, buffer)) {
        H5Awrite(made, type, buffer);
    }
    H5Aclose(made);
    H5Sclose(space);
    H5Tclose(type);
    H5Oclose(object);
}

static void relink(hid_t file, const char *path, const char *other, fuzz_bytes *in) {
    size_t what = fuzz_choice(in, 5);
    H5Ldelete(file, path, H5P_DEFAULT);
    if (what == 1) {
        H5Lcreate_soft(other, file, path, H5P_DEFAULT, H5P_DEFAULT);
    } else if (what == 2) {
        H5Lcreate_external("/dev/null", other, file, path, H5P_DEFAULT, H5P_DEFAULT);
    } else if (what == 3) {
        H5Lcreate_hard(file, other, file, path, H5P_DEFAULT, H5P_DEFAULT);
    } else if (what == 4) {
        H5Gclose(H5Gcreate2(file, path, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    }
}

static void edit(hid_t image, const fuzz_hdf *file, fuzz_bytes *in) {
    static uint8_t buffer[BUFFER];
    for (int i = 0; i < EDITS_MOST && in->left > 0; i++) {
        const char *path = file->object[fuzz_choice(in, file->objects)];
        const char *other = file->object[fuzz_choice(in, file->objects)];
        switch (fuzz_choice(in, 4)) {
        case 0:
            replace_dataset(image, path, in, buffer);
            break;
        case 1:
            relink(image, path, other, in);
            break;
        case 2:
            edit_attribute(image, path, in, buffer);
            break;
        default:
            rewrite_dataset(image, path, in, buffer);
        }
    }
}

const char *fuzz_hdf_put(const fuzz_hdf *file, const char *name, fuzz_bytes *in) {
    haft_hdf_voice voice = haft_hdf_hush();
    hid_t image = open_image(file->bytes + file->header, file->size - file->header);
    edit(image, file, in);
    H5Fflush(image, H5F_SCOPE_GLOBAL);
    ssize_t size = H5Fget_file_image(image, NULL, 0);
    if (size <= 0) {
        abort();
    }
    char *bytes = calloc(1, HAFT_HDF_HEADER + (size_t)size);
    H5Fget_file_image(image, bytes + HAFT_HDF_HEADER, (size_t)size);
    H5Fclose(image);
    haft_hdf_unhush(voice);
    char digest[HAFT_DIGEST_CAPACITY];
    haft_digest_memory(bytes + HAFT_HDF_HEADER, (size_t)size, digest);
    haft_hdf_make_header(bytes, (uint64_t)size, digest);
    size_t skipped = file->header == 0 ? HAFT_HDF_HEADER : 0;
    const char *path = fuzz_put(name, bytes + skipped, HAFT_HDF_HEADER + (size_t)size - skipped);
    free(bytes);
    return path;
}
