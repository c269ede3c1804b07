/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opens a data file: reads it whole and verifies the header's checksum before HDF5 sees a byte. If
 * the header is missing or does not match, HDF5 does not open the file in this process: a child
 * process copies its contents. A program that opens a file for writing changes its bytes even if
 * the data stay the same; so the copied data are compared with the digests in the file. */
#include "hdf.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* ---- the bytes ---- */

static void load(haft_hdf *hdf, const char *format) {
    char *bytes = NULL;
    hdf->status = haft_file_read(&bytes, &hdf->file_bytes, hdf->path, SIZE_MAX - 1, hdf->error);
    hdf->bytes = bytes;
    if (hdf->status == HAFT_ERROR_IO && access(hdf->path, F_OK) != 0 && errno == ENOENT) {
        haft_error_set(hdf->error, HAFT_ERROR_IO, "%s: cannot be opened: %s; %s", hdf->path,
                       strerror(ENOENT),
                       strcmp(format, HAFT_HDF_LAWS) == 0 ? "build it with haft-laws build CASE"
                                                          : "make it with haft run CASE");
    }
}

/* Where the HDF5 part begins: at byte 0, or after a user block of 512, 1024, 2048 ... bytes. */
static bool find_signature(const haft_hdf *hdf, size_t *at) {
    static const char signature[] = "\211HDF\r\n\032\n";
    enum { LENGTH = sizeof signature - 1 };
    for (*at = 0; *at + LENGTH <= hdf->file_bytes; *at = *at == 0 ? HAFT_HDF_HEADER : 2 * *at) {
        if (memcmp((const char *)hdf->bytes + *at, signature, LENGTH) == 0) {
            return true;
        }
    }
    return false;
}

/* ---- the header ---- */

typedef struct vouch {
    bool headed, valid;
    char reason[100]; /* why the header is not valid */
} vouch;

static vouch check_header(const haft_hdf *hdf) {
    vouch v = {.valid = false};
    char header[HAFT_HDF_HEADER + 1] = {0};
    char digest[HAFT_DIGEST_CAPACITY] = "", actual[HAFT_DIGEST_CAPACITY];
    unsigned long long size = 0;
    size_t n = hdf->file_bytes < HAFT_HDF_HEADER ? hdf->file_bytes : HAFT_HDF_HEADER;
    memcpy(header, hdf->bytes, n);
    const char *line = strchr(header, '\n');
    v.headed = strncmp(header, "haft data:", 10) == 0;
    if (n < HAFT_HDF_HEADER || line == NULL ||
        sscanf(line, " size %20llu xxh3-128 %32[0-9a-f]", &size, digest) != 2) {
        snprintf(v.reason, sizeof v.reason, "its header is incomplete");
    } else if (hdf->file_bytes - HAFT_HDF_HEADER != size) {
        snprintf(v.reason, sizeof v.reason, "it should be %llu bytes long and is %zu",
                 size + HAFT_HDF_HEADER, hdf->file_bytes);
    } else {
        haft_digest_memory((const char *)hdf->bytes + HAFT_HDF_HEADER,
                           hdf->file_bytes - HAFT_HDF_HEADER, actual);
        v.valid = v.headed && strcmp(actual, digest) == 0;
        snprintf(v.reason, sizeof v.reason, "its contents do not match their checksum");
    }
    return v;
}

/* ---- files without a valid checksum ---- */

/* Copies the file in a child process. If that fails and the file has a header, the message begins
 * with what is wrong with the header. */
static void copy_apart(haft_hdf *hdf, const vouch *v) {
    haft_error own = {0}, *error = hdf->error;
    hdf->error = &own;
    haft_hdf_copy_apart(hdf);
    hdf->error = error;
    if (hdf->status == HAFT_OK) {
        return;
    }
    size_t n = strlen(hdf->path);
    bool named = strncmp(own.message, hdf->path, n) == 0 && strncmp(own.message + n, ": ", 2) == 0;
    if (hdf->status == HAFT_ERROR_INPUT && v->headed && named) {
        haft_error_set(error, hdf->status, "%s: is damaged: %s, and the HDF5 part %s", hdf->path,
                       v->reason, own.message + n + 2);
    } else {
        haft_error_set(error, hdf->status, "%s", own.message);
    }
}

/* Verifies a file that another program has written. It has a list of digests if Haft wrote it
 * first. */
static void verify(haft_hdf *hdf, const vouch *v) {
    hdf->rewritten = haft_hdf_verify(hdf);
    if (hdf->status == HAFT_OK && !hdf->rewritten && v->headed) {
        haft_hdf_refuse(hdf,
                        "was changed since Haft wrote it (%s), and has no digests of its datasets, "
                        "which older versions did not write, to tell where; if the data are right, "
                        "take off the first %d bytes",
                        v->reason, HAFT_HDF_HEADER);
    }
}

/* ---- all files ---- */

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

/* Opens the bytes if their checksum is valid, otherwise the copy that a child process has made. */
static void open_bytes(haft_hdf *hdf, const char *format) {
    size_t at = 0;
    bool found = find_signature(hdf, &at);
    vouch v = check_header(hdf);
    if (v.valid) {
        at = HAFT_HDF_HEADER;
    } else if (found) {
        copy_apart(hdf, &v);
        at = 0;
    } else if (v.headed) {
        haft_hdf_refuse(hdf, "is damaged: %s, and no HDF5 follows", v.reason);
    } else {
        haft_hdf_refuse(hdf, hdf->file_bytes == 0 ? "is empty" : "is no HDF5 file");
    }
    if (hdf->status == HAFT_OK) {
        hdf->file = haft_hdf_open_image((const char *)hdf->bytes + at, hdf->file_bytes - at);
        if (hdf->file < 0) {
            haft_hdf_refuse(hdf, "cannot be read as HDF5");
        }
    }
    check_format(hdf, format);
    if (hdf->status == HAFT_OK && !v.valid) {
        verify(hdf, &v);
    }
}

/* The advice for a damaged file; it destroys no data. */
static const char *choose_remedy(const char *path, const char *format) {
    char parts[4096];
    if (strcmp(format, HAFT_HDF_LAWS) == 0) {
        return "put back a copy of it, or move it away and build it anew with haft-laws build CASE";
    }
    const char *slash = strrchr(path, '/');
    int n = snprintf(parts, sizeof parts, "%.*sparts", slash == NULL ? 0 : (int)(slash - path + 1),
                     path);
    return n < (int)sizeof parts && haft_parts_are_in(parts)
               ? "put back a copy of it, or move it away: haft resume CASE makes it anew from the "
                 "beams that are done"
               : "put back a copy of it, or move it away and make it anew with haft run CASE";
}

haft_status haft_hdf_open(haft_hdf *hdf, const char *path, const char *format, haft_error *error) {
    *hdf = (haft_hdf){.file = -1, .path = path, .error = error};
    hdf->remedy = choose_remedy(path, format);
    load(hdf, format);
    if (hdf->status == HAFT_OK) {
        open_bytes(hdf, format);
    }
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
