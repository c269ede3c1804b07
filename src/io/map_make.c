/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the readers of all kinds of maps share: units, texts for messages, and the making of the
 * map, from its size to its scaled heights. */
#include "map_file.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

bool haft_map_length(double number, const char *unit, double *value) {
    /* The units database takes longer to load than most maps to read. The micro sign occurs as "~",
     * in Latin-1, and in UTF-8 as either code point. */
    static const struct {
        const char *name;
        double length;
    } units[] = {{"m", 1},
                 {"meter", 1},
                 {"metre", 1},
                 {"meters", 1},
                 {"metres", 1},
                 {"micron", 1e-6},
                 {"microns", 1e-6},
                 {"micrometer", 1e-6},
                 {"micrometre", 1e-6},
                 {"micrometers", 1e-6},
                 {"micrometres", 1e-6},
                 {"nanometer", 1e-9},
                 {"nanometre", 1e-9},
                 {"nanometers", 1e-9},
                 {"nanometres", 1e-9},
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

void haft_map_remark(haft_map *map, const char *format, ...) {
    size_t used = strlen(map->note);
    if (used > 0 && used + 2 < sizeof map->note) {
        memcpy(map->note + used, "; ", 3);
        used += 2;
    }
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(map->note + used, sizeof map->note - used, format, arguments);
    va_end(arguments);
}

/* Whether the file and the options give different lengths. */
static bool contradicts(double own, double given) {
    return own > 0 && given > 0 && fabs(given / own - 1) > 1e-6;
}

haft_status haft_map_begin(haft_map **out, const haft_map_file *file, size_t rows, size_t columns,
                           double width, double height, double *unit, haft_error *error) {
    const haft_map_options *o = &file->options;
    bool size = contradicts(width, o->width) || contradicts(height, o->height);
    bool scale = contradicts(*unit, o->unit);
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
    } else if (size || scale) {
        haft_map_remark(*out, "not used, since the file says its own: the %s given",
                        !scale ? "size"
                        : size ? "size and unit"
                               : "unit");
    }
    return status;
}

haft_status haft_map_end(haft_map **out, const haft_map_file *file, double unit,
                         haft_error *error) {
    haft_map *map = *out;
    haft_status status = HAFT_OK;
    for (size_t i = 0; status == HAFT_OK && i < map->rows * map->columns; i++) {
        if (isinf(map->z[i])) {
            status =
                haft_error_set(error, HAFT_ERROR_INPUT,
                               "%s: the height in row %zu, column %zu is not finite; a missing "
                               "one is written nan",
                               file->path, i / map->columns + 1, i % map->columns + 1);
        }
    }
    HAFT_THEN(status, haft_map_check_marks(map, file, unit, error));
    for (size_t i = 0; status == HAFT_OK && i < map->rows * map->columns; i++) {
        map->z[i] *= unit;
    }
    if (status != HAFT_OK) {
        haft_map_destroy(out);
    }
    return status;
}

haft_status haft_map_from_matrix(haft_map **out, const haft_map_file *file, size_t rows,
                                 size_t columns, double width, double height, double unit,
                                 const double *z, haft_error *error) {
    HAFT_TRY(haft_map_begin(out, file, rows, columns, width, height, &unit, error));
    memcpy((*out)->z, z, rows * columns * sizeof *z);
    return haft_map_end(out, file, unit, error);
}
