/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Height maps from files: which kind one is, by its contents, and what all kinds need. A file is
 * read whole; whatever it says of its own layout is checked against its size before a pixel is
 * touched. */
#include "map_file.h"
#include "text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const size_t FILE_MOST = (size_t)1 << 31;

bool haft_map_length(double number, const char *unit, double *value) {
    /* The units database would do, but takes longer to load than most maps to read. The micro sign
     * comes as "~", in Latin-1, and in UTF-8 by either code point. */
    static const struct {
        const char *name;
        double length;
    } units[] = {{"m", 1},
                 {"cm", 1e-2},
                 {"mm", 1e-3},
                 {"um", 1e-6},
                 {"~m", 1e-6},
                 {"\xc2\xb5m", 1e-6},
                 {"\xce\xbcm", 1e-6},
                 {"\xb5m", 1e-6},
                 {"nm", 1e-9},
                 {"pm", 1e-12},
                 {"A", 1e-10},
                 {"Angstrom", 1e-10},
                 {"angstrom", 1e-10},
                 {"\xc3\x85", 1e-10},
                 {"\xe2\x84\xab", 1e-10},
                 {"\xc5", 1e-10}};
    *value = 0;
    for (size_t k = 0; k < sizeof units / sizeof *units; k++) {
        if (strcmp(unit, units[k].name) == 0) {
            *value = number * units[k].length;
            return isfinite(*value);
        }
    }
    return false;
}

const char *haft_map_quote(char quoted[48], const char *text, size_t n) {
    size_t length = 0;
    while (length < n && length < 40 && text[length] != '\0' && text[length] != '\n') {
        unsigned char c = (unsigned char)text[length];
        quoted[length] = c >= 32 && c < 127 ? (char)c : '?';
        length++;
    }
    quoted[length] = '\0';
    return quoted;
}

void haft_map_name(char *destination, const char *text, size_t n) {
    n = n < HAFT_CHANNEL_CAPACITY - 1 ? n : HAFT_CHANNEL_CAPACITY - 1;
    for (size_t i = 0; i < n; i++) {
        destination[i] = (unsigned char)text[i] < 32 ? '?' : text[i];
    }
    destination[n] = '\0';
}

haft_status haft_map_begin(haft_map **out, const haft_map_file *file, size_t rows, size_t columns,
                           double width, double height, double *unit, haft_error *error) {
    const haft_map_options *o = &file->options;
    width = width > 0 ? width : o->width;
    height = height > 0 ? height : o->height;
    *unit = *unit > 0 ? *unit : o->unit;
    if (!(width > 0 && height > 0)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: does not say how large the map is; give its size, width and "
                              "height",
                              file->path);
    }
    if (!(*unit > 0)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: does not say the unit of its heights; give it, as nm",
                              file->path);
    }
    haft_status status =
        haft_map_create(out, rows, columns, height / (double)rows, width / (double)columns, error);
    if (status != HAFT_OK) {
        haft_error_prefix(error, "%s: ", file->path);
    }
    return status;
}

haft_status haft_map_end(haft_map **out, const haft_map_file *file, double unit,
                         haft_error *error) {
    haft_map *map = *out;
    for (size_t i = 0; i < map->rows * map->columns; i++) {
        map->z[i] *= unit;
        if (isinf(map->z[i])) {
            haft_status status =
                haft_error_set(error, HAFT_ERROR_INPUT,
                               "%s: the height in row %zu, column %zu is not finite; a missing "
                               "one is written nan",
                               file->path, i / map->columns + 1, i % map->columns + 1);
            haft_map_destroy(out);
            return status;
        }
    }
    return HAFT_OK;
}

haft_status haft_map_from_matrix(haft_map **out, const haft_map_file *file, size_t rows,
                                 size_t columns, double width, double height, double unit,
                                 const double *z, haft_error *error) {
    haft_status status = haft_map_begin(out, file, rows, columns, width, height, &unit, error);
    if (status == HAFT_OK) {
        memcpy((*out)->z, z, rows * columns * sizeof *z);
        status = haft_map_end(out, file, unit, error);
    }
    return status;
}

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

static haft_status read_kind(haft_map **out, const haft_map_file *file, haft_error *error) {
    if (file->size == 0) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "%s: is empty", file->path);
    }
    if (begins(file, "\\*Force file list")) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: holds Nanoscope force curves, no height map", file->path);
    }
    if (begins(file, "\\*File list") || begins(file, "\\*NC")) {
        return haft_map_read_nanoscope(out, file, error);
    }
    if (begins(file, "Gwyddion Simple Field 1.0\n")) {
        return haft_map_read_gsf(out, file, error);
    }
    if (is_hdf(file)) {
        return haft_map_read_hdf(out, file, error);
    }
    if (is_text(file)) {
        return haft_map_read_text(out, file, error);
    }
    return haft_error_set(
        error, HAFT_ERROR_INPUT,
        "%s: is no height map that Haft knows: Nanoscope (binary), Gwyddion Simple "
        "Field, HDF5, or text (a matrix, or columns x y z)",
        file->path);
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
