/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opening a data file: it is read whole, and the header's checksum is verified before HDF5 sees a
 * byte. Of a file without the header (rewritten by another tool) HDF5 sees nothing here either: a
 * child process copies what it holds. */
#include "hdf.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* ---- the bytes ---- */

static void load(haft_hdf *hdf) {
    char *bytes = NULL;
    hdf->status = haft_file_read(&bytes, &hdf->file_bytes, hdf->path, SIZE_MAX - 1, hdf->error);
    hdf->bytes = bytes;
    if (hdf->status == HAFT_ERROR_IO && access(hdf->path, F_OK) != 0 && errno == ENOENT) {
        haft_error_set(hdf->error, HAFT_ERROR_IO, "%s: cannot be opened: %s; %s", hdf->path,
                       strerror(ENOENT), hdf->remedy);
    }
}

/* ---- the header ---- */

static void check_header(haft_hdf *hdf) {
    char header[HAFT_HDF_HEADER + 1] = {0};
    char digest[HAFT_DIGEST_CAPACITY] = "", actual[HAFT_DIGEST_CAPACITY];
    unsigned long long size = 0;
    size_t n = hdf->file_bytes < HAFT_HDF_HEADER ? hdf->file_bytes : HAFT_HDF_HEADER;
    memcpy(header, hdf->bytes, n);
    const char *line = strchr(header, '\n');
    if (strncmp(header, "haft data:", 10) != 0) {
        haft_hdf_refuse(hdf, n == 0 ? "is empty" : "is no HDF5 file");
    } else if (n < HAFT_HDF_HEADER || line == NULL ||
               sscanf(line, " size %20llu xxh3-128 %32[0-9a-f]", &size, digest) != 2) {
        haft_hdf_refuse(hdf, "is damaged: its header is incomplete");
    } else if (hdf->file_bytes - HAFT_HDF_HEADER != size) {
        haft_hdf_refuse(hdf, "is damaged: it should be %llu bytes long and is %zu",
                        size + HAFT_HDF_HEADER, hdf->file_bytes);
    } else {
        haft_digest_memory((const char *)hdf->bytes + HAFT_HDF_HEADER,
                           hdf->file_bytes - HAFT_HDF_HEADER, actual);
        if (strcmp(actual, digest) != 0) {
            haft_hdf_refuse(hdf, "is damaged: its contents do not match their checksum");
        }
    }
}

/* HDF5 opens what the checksum vouches for, or what a child process copied. */
static void open_bytes(haft_hdf *hdf) {
    bool bare = hdf->file_bytes >= 8 && memcmp(hdf->bytes, "\211HDF\r\n\032\n", 8) == 0;
    size_t skipped = bare ? 0 : HAFT_HDF_HEADER;
    if (bare) {
        haft_hdf_copy_apart(hdf);
    } else {
        check_header(hdf);
    }
    if (hdf->status == HAFT_OK) {
        hdf->file =
            haft_hdf_open_image((const char *)hdf->bytes + skipped, hdf->file_bytes - skipped);
        if (hdf->file < 0) {
            haft_hdf_refuse(hdf, "cannot be read as HDF5");
        }
    }
}

static void check_format(haft_hdf *hdf, const char *format) {
    char *found = NULL;
    uint64_t layout = 0;
    if (!haft_hdf_has_attribute(hdf, "/", "format")) {
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

haft_status haft_hdf_open(haft_hdf *hdf, const char *path, const char *format, haft_error *error) {
    *hdf = (haft_hdf){.file = -1, .path = path, .error = error};
    hdf->remedy = strcmp(format, HAFT_HDF_LAWS) == 0
                      ? "build it anew with haft-laws build --force CASE"
                      : "make it anew with haft run --force CASE";
    load(hdf);
    if (hdf->status == HAFT_OK) {
        open_bytes(hdf);
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
    haft_memory_free(hdf->bytes);
    hdf->bytes = NULL;
}
