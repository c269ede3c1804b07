/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reading back with distrust: the header's checksum before HDF5 sees a byte, then format, layout
 * version, shapes and sizes. A file without the header (repacked by another tool) is read too, then
 * without that first guard. */
#include "hdf.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

static const size_t TEXT_MOST = 1 << 20;

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

/* ---- the header ---- */

static void check_digest(haft_hdf *hdf, int descriptor, const char *digest) {
    void *bytes = mmap(NULL, hdf->file_bytes, PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (bytes == MAP_FAILED) {
        hdf->status = haft_error_set(hdf->error, HAFT_ERROR_IO, "%s: cannot be read: %s", hdf->path,
                                     strerror(errno));
        return;
    }
    char actual[HAFT_DIGEST_CAPACITY];
    haft_digest_memory((const char *)bytes + HAFT_HDF_HEADER, hdf->file_bytes - HAFT_HDF_HEADER,
                       actual);
    munmap(bytes, hdf->file_bytes);
    if (strcmp(actual, digest) != 0) {
        haft_hdf_refuse(hdf, "is damaged: its contents do not match their checksum");
    }
}

static void check_header(haft_hdf *hdf, int descriptor, bool verify) {
    char header[HAFT_HDF_HEADER + 1] = {0}, digest[HAFT_DIGEST_CAPACITY] = "";
    unsigned long long size = 0;
    ssize_t n = pread(descriptor, header, HAFT_HDF_HEADER, 0);
    if (n < 0) {
        hdf->status = haft_error_set(hdf->error, HAFT_ERROR_IO, "%s: cannot be read: %s", hdf->path,
                                     strerror(errno));
        return;
    }
    if (n >= 8 && memcmp(header, "\211HDF\r\n\032\n", 8) == 0) {
        return; /* bare HDF5 */
    }
    if (strncmp(header, "haft data:", 10) != 0) {
        haft_hdf_refuse(hdf, n == 0 ? "is empty" : "is no HDF5 file");
        return;
    }
    const char *line = strchr(header, '\n');
    if (n < HAFT_HDF_HEADER || line == NULL ||
        sscanf(line, " size %20llu xxh3-128 %32[0-9a-f]", &size, digest) != 2) {
        haft_hdf_refuse(hdf, "is damaged: its header is incomplete");
    } else if (hdf->file_bytes - HAFT_HDF_HEADER != size) {
        haft_hdf_refuse(hdf, "is damaged: it should be %llu bytes long and is %zu",
                        size + HAFT_HDF_HEADER, hdf->file_bytes);
    } else if (verify) {
        check_digest(hdf, descriptor, digest);
    }
}

static void open_checked(haft_hdf *hdf, bool verify) {
    struct stat facts;
    int descriptor = open(hdf->path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0 || fstat(descriptor, &facts) != 0) {
        bool missing = errno == ENOENT;
        hdf->status =
            haft_error_set(hdf->error, HAFT_ERROR_IO, "%s: cannot be opened: %s%s%s", hdf->path,
                           strerror(errno), missing ? "; " : "", missing ? hdf->remedy : "");
    } else if (!S_ISREG(facts.st_mode)) {
        hdf->status = haft_error_set(hdf->error, HAFT_ERROR_IO,
                                     "%s: is a directory or a device; give a file", hdf->path);
    } else {
        hdf->file_bytes = (size_t)facts.st_size;
        check_header(hdf, descriptor, verify);
    }
    if (descriptor >= 0) {
        close(descriptor);
    }
}

static void check_format(haft_hdf *hdf, const char *format) {
    char *found = NULL;
    uint64_t layout = 0;
    if (hdf->status == HAFT_OK && H5Aexists(hdf->file, "format") <= 0) {
        haft_hdf_refuse(hdf, "is HDF5 but not of Haft: it has no attribute `format`");
    }
    haft_hdf_read_text(hdf, "/", "format", &found);
    if (hdf->status == HAFT_OK && strcmp(found, format) != 0) {
        haft_hdf_refuse(hdf, "holds \"%.40s\" where \"%s\" is wanted", found, format);
    }
    haft_memory_free(found);
    haft_hdf_read_count(hdf, "/", "layout_version", &layout);
    if (hdf->status == HAFT_OK && layout != HAFT_HDF_LAYOUT) {
        haft_hdf_refuse(hdf,
                        "has layout version %llu, and this program (Haft %s) reads %d; take "
                        "a newer Haft",
                        (unsigned long long)layout, haft_version(), HAFT_HDF_LAYOUT);
    }
}

haft_status haft_hdf_open(haft_hdf *hdf, const char *path, const char *format, bool verify,
                          haft_error *error) {
    *hdf = (haft_hdf){.file = -1, .path = path, .error = error};
    hdf->remedy = strcmp(format, HAFT_HDF_LAWS) == 0
                      ? "build it anew with haft-laws build --force CASE"
                      : "make it anew with haft run --force CASE";
    open_checked(hdf, verify);
    if (hdf->status == HAFT_OK) {
        hid_t access = H5Pcreate(H5P_FILE_ACCESS);
        H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
        hdf->file = H5Fopen(path, H5F_ACC_RDONLY, access);
        H5Pclose(access);
        if (hdf->file < 0) {
            haft_hdf_refuse(hdf, "cannot be read as HDF5");
        }
    }
    check_format(hdf, format);
    if (hdf->status != HAFT_OK) {
        haft_hdf_close(hdf);
    }
    return hdf->status;
}

void haft_hdf_close(haft_hdf *hdf) {
    if (hdf->file >= 0) {
        H5Fclose(hdf->file);
        hdf->file = -1;
    }
}

/* ---- attributes ---- */

static hid_t open_attribute(haft_hdf *hdf, const char *object, const char *name, H5T_class_t class,
                            const char *kind) {
    hid_t attribute = H5Aopen_by_name(hdf->file, object, name, H5P_DEFAULT, H5P_DEFAULT);
    if (attribute < 0) {
        haft_hdf_refuse(hdf, "lacks the attribute `%s` of %s", name, object);
        return -1;
    }
    hid_t type = H5Aget_type(attribute), space = H5Aget_space(attribute);
    bool good = type >= 0 && space >= 0 && H5Tget_class(type) == class &&
                H5Sget_simple_extent_npoints(space) == 1;
    H5Sclose(space);
    H5Tclose(type);
    if (!good) {
        haft_hdf_refuse(hdf, "has an attribute `%s` of %s that is not %s", name, object, kind);
        H5Aclose(attribute);
        return -1;
    }
    return attribute;
}

void haft_hdf_read_text(haft_hdf *hdf, const char *object, const char *name, char **text) {
    *text = NULL;
    if (hdf->status != HAFT_OK) {
        return;
    }
    hid_t attribute = open_attribute(hdf, object, name, H5T_STRING, "a text");
    if (attribute < 0) {
        return;
    }
    hid_t type = H5Aget_type(attribute);
    size_t size = H5Tget_size(type);
    if (H5Tis_variable_str(type) != 0 || size == 0 || size > TEXT_MOST) {
        haft_hdf_refuse(hdf, "has an attribute `%s` of %s that is no fixed-length text", name,
                        object);
    } else if ((*text = haft_memory_alloc(size + 1, 1, hdf->error)) == NULL) {
        hdf->status = HAFT_ERROR_MEMORY;
    } else if (H5Aread(attribute, type, *text) < 0) {
        haft_hdf_refuse(hdf, "has an attribute `%s` of %s that cannot be read", name, object);
    }
    H5Tclose(type);
    H5Aclose(attribute);
    if (hdf->status != HAFT_OK) {
        haft_memory_free(*text);
        *text = NULL;
    }
}

static void read_number(haft_hdf *hdf, const char *object, const char *name, H5T_class_t class,
                        hid_t wanted, void *value) {
    if (hdf->status != HAFT_OK) {
        return;
    }
    hid_t attribute = open_attribute(hdf, object, name, class, "a number");
    if (attribute >= 0) {
        if (H5Aread(attribute, wanted, value) < 0) {
            haft_hdf_refuse(hdf, "has an attribute `%s` of %s that cannot be read", name, object);
        }
        H5Aclose(attribute);
    }
}

void haft_hdf_read_real(haft_hdf *hdf, const char *object, const char *name, double *value) {
    read_number(hdf, object, name, H5T_FLOAT, H5T_NATIVE_DOUBLE, value);
}

void haft_hdf_read_count(haft_hdf *hdf, const char *object, const char *name, uint64_t *value) {
    read_number(hdf, object, name, H5T_INTEGER, H5T_NATIVE_UINT64, value);
}

/* ---- datasets ---- */

bool haft_hdf_has(haft_hdf *hdf, const char *path) {
    if (hdf->status != HAFT_OK) {
        return false;
    }
    char part[128];
    for (const char *slash = strchr(path + 1, '/');; slash = strchr(slash + 1, '/')) {
        size_t n = slash == NULL ? strlen(path) : (size_t)(slash - path);
        if (n >= sizeof part) {
            return false;
        }
        memcpy(part, path, n);
        part[n] = '\0';
        if (H5Lexists(hdf->file, part, H5P_DEFAULT) <= 0) {
            return false;
        }
        if (slash == NULL) {
            return true;
        }
    }
}

/* Can the file hold so much? Compressed data may be larger than the file, by 1032 at most
 * (deflate); plain data may not; a dataset without storage would be a huge nothing. */
static bool is_possible(haft_hdf *hdf, hid_t dataset, const hsize_t *dims, int rank, size_t size) {
    hid_t creation = H5Dget_create_plist(dataset);
    size_t most = hdf->file_bytes;
    if (creation >= 0 && H5Pget_layout(creation) == H5D_CHUNKED &&
        __builtin_mul_overflow(hdf->file_bytes, 1032, &most)) {
        most = SIZE_MAX;
    }
    bool external = creation >= 0 && H5Pget_external_count(creation) > 0;
    H5Pclose(creation);
    size_t bytes = size;
    for (int i = 0; i < rank; i++) {
        if (dims[i] > SIZE_MAX || __builtin_mul_overflow(bytes, (size_t)dims[i], &bytes)) {
            return false;
        }
    }
    return !external && bytes <= most;
}

/* Opens a dataset and takes its shape, or refuses it. */
static hid_t open_dataset(haft_hdf *hdf, const char *path, int rank, size_t *dims) {
    hid_t dataset = haft_hdf_has(hdf, path) ? H5Dopen2(hdf->file, path, H5P_DEFAULT) : (hid_t)-1;
    if (dataset < 0) {
        haft_hdf_refuse(hdf, "lacks the dataset %s", path);
        return -1;
    }
    hsize_t extent[H5S_MAX_RANK] = {0};
    hid_t space = H5Dget_space(dataset), type = H5Dget_type(dataset);
    size_t size = H5Tget_size(type);
    int found =
        H5Sget_simple_extent_type(space) == H5S_SIMPLE ? H5Sget_simple_extent_ndims(space) : 0;
    if (found != rank || H5Sget_simple_extent_dims(space, extent, NULL) < 0) {
        haft_hdf_refuse(hdf, "has %s in %d dimensions where %d are wanted", path, found, rank);
    } else if (!is_possible(hdf, dataset, extent, rank, size)) {
        haft_hdf_refuse(hdf, "has %s of a size that the file cannot hold", path);
    }
    H5Tclose(type);
    H5Sclose(space);
    if (hdf->status != HAFT_OK) {
        H5Dclose(dataset);
        return -1;
    }
    for (int i = 0; i < rank; i++) {
        dims[i] = (size_t)extent[i];
    }
    return dataset;
}

void haft_hdf_shape(haft_hdf *hdf, const char *path, int rank, size_t *dims) {
    memset(dims, 0, (size_t)rank * sizeof *dims);
    if (hdf->status != HAFT_OK) {
        return;
    }
    hid_t dataset = open_dataset(hdf, path, rank, dims);
    if (dataset >= 0) {
        H5Dclose(dataset);
    }
}

void haft_hdf_read(haft_hdf *hdf, const char *path, haft_hdf_type type, int rank,
                   const size_t *dims, void *value) {
    size_t found[H5S_MAX_RANK] = {0};
    hid_t dataset = hdf->status == HAFT_OK ? open_dataset(hdf, path, rank, found) : (hid_t)-1;
    if (dataset < 0) {
        return;
    }
    bool real = type == HAFT_HDF_REAL;
    hid_t stored = H5Dget_type(dataset);
    bool fits = H5Tget_class(stored) == (real ? H5T_FLOAT : H5T_INTEGER);
    H5Tclose(stored);
    for (int i = 0; i < rank && hdf->status == HAFT_OK; i++) {
        if (found[i] != dims[i]) {
            haft_hdf_refuse(hdf, "has %s of extent %zu where %zu is wanted", path, found[i],
                            dims[i]);
        }
    }
    if (!fits) {
        haft_hdf_refuse(hdf, "has %s of another type than %s", path, real ? "real" : "integer");
    } else if (hdf->status == HAFT_OK && H5Dread(dataset, real ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT,
                                                 H5S_ALL, H5S_ALL, H5P_DEFAULT, value) < 0) {
        haft_hdf_refuse(hdf, "has %s that cannot be read", path);
    }
    H5Dclose(dataset);
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
