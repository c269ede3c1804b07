/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads height maps and determines the kind of a file by its contents. A file is read whole; what
 * it says about its layout is checked against its size before a pixel is read. */
#include "map_file.h"
#include "text.h"

#include <string.h>

static const size_t FILE_MOST = (size_t)1 << 31;

/* ---- which kind ---- */

static bool begins(const haft_map_file *file, const char *text) {
    size_t n = strlen(text);
    return file->size >= n && memcmp(file->bytes, text, n) == 0;
}

static bool is_hdf(const haft_map_file *file) {
    for (size_t at = 0; at + 8 <= file->size; at = at == 0 ? 512 : 2 * at) {
        if (memcmp(file->bytes + at, "\211HDF\r\n\032\n", 8) == 0) {
            return true;
        }
    }
    return false;
}

static bool is_text(const haft_map_file *file) {
    if (haft_text_is_marked(file->bytes, file->size)) {
        return true;
    }
    for (size_t i = 0; i < file->size; i++) {
        unsigned char c = (unsigned char)file->bytes[i];
        if (c < 32 && strchr("\t\n\r\f", c) == NULL) {
            return false;
        }
    }
    return file->size > 0;
}

static bool is_nanoscope(const haft_map_file *file) {
    return begins(file, "\\*") || begins(file, "?*File list");
}

static bool is_gsf(const haft_map_file *file) {
    return begins(file, "Gwyddion Simple Field ");
}

static bool is_gwy(const haft_map_file *file) {
    return begins(file, "GWYP");
}

static bool is_npy(const haft_map_file *file) {
    return begins(file, "\223NUMPY");
}

/* Binary WSxM files have the same beginning. */
static bool is_wsxm_text(const haft_map_file *file) {
    return begins(file, "WSxM file") && is_text(file);
}

static bool is_any(const haft_map_file *file) {
    (void)file;
    return true;
}

/* The first kind that matches a file reads it, or says why it cannot. Formats that are known only
 * by name may begin like a text, so text comes after them. */
static const struct kind {
    bool (*is)(const haft_map_file *file);
    haft_status (*read)(haft_map **out, const haft_map_file *file, haft_error *error);
} kinds[] = {
    {is_nanoscope, haft_map_read_nanoscope},
    {is_gsf, haft_map_read_gsf},
    {is_gwy, haft_map_read_gwy},
    {is_npy, haft_map_read_npy},
    {is_hdf, haft_map_read_hdf},
    {is_wsxm_text, haft_map_read_text},
    {haft_map_is_known, haft_map_refuse_known},
    {is_text, haft_map_read_text},
    {is_any, haft_map_refuse_unknown},
};

static haft_status read_kind(haft_map **out, const haft_map_file *file, haft_error *error) {
    if (file->size == 0) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "%s: is empty", file->path);
    }
    const struct kind *kind = kinds;
    while (!kind->is(file)) {
        kind++;
    }
    return kind->read(out, file, error);
}

haft_status haft_map_read(haft_map **out, const char *path, const haft_map_options *options,
                          char digest[HAFT_DIGEST_CAPACITY], haft_error *error) {
    *out = NULL;
    char *bytes = NULL;
    haft_map_file file = {.path = path};
    haft_status status = haft_file_read(&bytes, &file.size, path, FILE_MOST, error);
    if (status == HAFT_OK) {
        file.bytes = bytes;
        if (options != NULL) {
            file.options = *options;
        }
        if (file.options.channel == NULL) {
            file.options.channel = "";
        }
        status = read_kind(out, &file, error);
    }
    if (status == HAFT_OK && digest != NULL) {
        haft_digest_memory(bytes, file.size, digest);
    }
    haft_memory_free(bytes);
    return status;
}
