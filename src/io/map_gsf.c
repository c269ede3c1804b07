/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gwyddion Simple Field: a magic line, lines "name = value", one to four NUL so that the data begin
 * at a multiple of four, then little-endian 32-bit numbers row by row. Without a unit, sides and
 * heights are not lengths, and the options must give them. */
#include "map_file.h"
#include "store.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAMES = 7 };

typedef struct gsf_header {
    double columns, rows, width, height; /* 0: not given */
    char lateral[24], unit[24], title[HAFT_CHANNEL_CAPACITY];
    bool seen[NAMES];
} gsf_header;

/* Splits "name = value" and strips blanks; false for any other line. */
static bool split(const char *line, size_t n, char name[32], char value[128]) {
    const char *sign = memchr(line, '=', n);
    if (sign == NULL) {
        return false;
    }
    const char *from[2] = {line, sign + 1}, *to[2] = {sign, line + n};
    char *into[2] = {name, value};
    size_t room[2] = {32, 128};
    for (int k = 0; k < 2; k++) {
        while (from[k] < to[k] && strchr(" \t\r", *from[k]) != NULL) {
            from[k]++;
        }
        while (to[k] > from[k] && strchr(" \t\r", to[k][-1]) != NULL) {
            to[k]--;
        }
        snprintf(into[k], room[k], "%.*s", (int)(to[k] - from[k]), from[k]);
    }
    return true;
}

/* Stores the value of a line; complains of a repeated name. */
static haft_status take(gsf_header *h, const haft_map_file *file, size_t line, const char *name,
                        const char *value, haft_error *error) {
    static const char *const names[NAMES] = {"XRes",    "YRes",   "XReal", "YReal",
                                             "XYUnits", "ZUnits", "Title"};
    double *const numbers[] = {&h->columns, &h->rows, &h->width, &h->height};
    char quoted[48];
    int k = 0;
    while (k < NAMES && strcmp(name, names[k]) != 0) {
        k++;
    }
    if (k == NAMES) {
        return HAFT_OK; /* other information about the map */
    }
    if (h->seen[k]) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "%s:%zu: %s stands there twice", file->path,
                              line, name);
    }
    h->seen[k] = true;
    if (k < 4 && (!haft_number_read(value, numbers[k]) || !(*numbers[k] > 0))) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s:%zu: %s is \"%s\"; it must be a positive number", file->path,
                              line, name, haft_map_quote(quoted, value, 40));
    }
    if (k == 4) {
        snprintf(h->lateral, sizeof h->lateral, "%.23s", value);
    } else if (k == 5) {
        snprintf(h->unit, sizeof h->unit, "%.23s", value);
    } else if (k == 6) {
        haft_map_name(h->title, value, strlen(value));
    }
    return HAFT_OK;
}

static haft_status read_header(gsf_header *h, const haft_map_file *file, const char *end,
                               haft_error *error) {
    const char *line = (const char *)memchr(file->bytes, '\n', file->size) + 1;
    for (size_t number = 2; line < end; number++) {
        const char *stop = memchr(line, '\n', (size_t)(end - line));
        size_t n = (size_t)((stop != NULL ? stop : end) - line);
        char name[32], value[128], quoted[48];
        if (!split(line, n, name, value)) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "%s:%zu: the header line \"%s\" is no \"name = value\"",
                                  file->path, number, haft_map_quote(quoted, line, n));
        }
        HAFT_TRY(take(h, file, number, name, value, error));
        line += n + 1;
    }
    return HAFT_OK;
}

/* Checks the magic line and finds the end of the header. */
static haft_status find_end(const char **end, const haft_map_file *file, haft_error *error) {
    static const char magic[] = "Gwyddion Simple Field 1.0\n";
    size_t n = sizeof magic - 1;
    if (file->size > n && memcmp(file->bytes, magic, n - 1) == 0 && file->bytes[n - 1] == '\r') {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "%s: was changed by a transfer as text: its header's lines end in CR, "
            "so its data have gained bytes; copy it anew in binary mode",
            file->path);
    }
    if (file->size < n || memcmp(file->bytes, magic, n) != 0) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: is no Gwyddion Simple Field 1.0, the one version that is known",
                              file->path);
    }
    *end = memchr(file->bytes, '\0', file->size);
    return *end != NULL ? HAFT_OK
                        : haft_error_set(error, HAFT_ERROR_INPUT,
                                         "%s: is cut short: no NUL ends the header", file->path);
}

/* The offset of the data; 0 if the bytes between header and data are not all NUL. */
static size_t find_data(const haft_map_file *file, const char *end) {
    size_t at = (size_t)(end - file->bytes), start = (at / 4 + 1) * 4;
    for (; at < start && at < file->size; at++) {
        if (file->bytes[at] != '\0') {
            return 0;
        }
    }
    return start;
}

/* The header's units in metres, 0 if it gives none. */
static haft_status read_units(gsf_header *h, const haft_map_file *file, double *unit,
                              haft_error *error) {
    *unit = 0;
    if (h->unit[0] != '\0' && !haft_map_length(1, h->unit, unit)) {
        char quoted[48];
        return haft_error_set(error, HAFT_ERROR_INPUT, "%s: its values are in \"%s\", no heights",
                              file->path, haft_map_quote(quoted, h->unit, 24));
    }
    if (h->lateral[0] != '\0' && (!haft_map_length(h->width, h->lateral, &h->width) ||
                                  !haft_map_length(h->height, h->lateral, &h->height))) {
        char quoted[48];
        return haft_error_set(error, HAFT_ERROR_INPUT, "%s: its sides are in \"%s\", no lengths",
                              file->path, haft_map_quote(quoted, h->lateral, 24));
    }
    if (h->lateral[0] == '\0') {
        h->width = h->height = 0; /* pure numbers */
    }
    return HAFT_OK;
}

static double read_single(const unsigned char *bytes) {
    uint32_t word = (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 |
                    (uint32_t)bytes[3] << 24;
    float value;
    memcpy(&value, &word, sizeof value);
    return value;
}

haft_status haft_map_read_gsf(haft_map **out, const haft_map_file *file, haft_error *error) {
    const char *end = NULL;
    gsf_header h = {.columns = 0};
    double unit = 0;
    haft_status status = find_end(&end, file, error);
    HAFT_THEN(status, read_header(&h, file, end, error));
    if (status == HAFT_OK && !(h.columns >= 1 && h.rows >= 1 && h.columns == floor(h.columns) &&
                               h.rows == floor(h.rows) && h.columns * h.rows < 1e9)) {
        status = haft_error_set(error, HAFT_ERROR_INPUT,
                                "%s: its header must give XRes and YRes, whole numbers of pixels",
                                file->path);
    }
    HAFT_THEN(status, read_units(&h, file, &unit, error));
    if (status != HAFT_OK) {
        return status;
    }
    size_t rows = (size_t)h.rows, columns = (size_t)h.columns;
    size_t start = find_data(file, end), needed = start + 4 * rows * columns;
    if (start == 0) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: is damaged: one to four NUL must end the header", file->path);
    }
    if (file->size != needed) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: has %zu bytes where %zu x %zu pixels need %zu; it is %s",
                              file->path, file->size, columns, rows, needed,
                              file->size < needed ? "cut short" : "damaged");
    }
    status = haft_map_begin(out, file, rows, columns, h.width, h.height, &unit, error);
    for (size_t i = 0; status == HAFT_OK && i < rows * columns; i++) {
        (*out)->z[i] = read_single((const unsigned char *)file->bytes + start + 4 * i);
    }
    HAFT_THEN(status, haft_map_end(out, file, unit, error));
    if (status == HAFT_OK) {
        memcpy((*out)->channel, h.title, sizeof h.title);
        snprintf((*out)->format, sizeof(*out)->format, "Gwyddion Simple Field");
    }
    return status;
}

haft_status haft_map_write(const haft_map *map, const char *path, haft_error *error) {
    char header[512];
    size_t points = map->rows * map->columns;
    int n = snprintf(header, sizeof header,
                     "Gwyddion Simple Field 1.0\nXRes = %zu\nYRes = %zu\nXReal = %.17g\nYReal = "
                     "%.17g\nXYUnits = m\nZUnits = m\nTitle = %s\n",
                     map->columns, map->rows, map->step_column * (double)map->columns,
                     map->step_row * (double)map->rows,
                     map->channel[0] != '\0' ? map->channel : "Height");
    size_t start = ((size_t)n / 4 + 1) * 4;
    unsigned char *bytes = haft_memory_alloc(start + 4 * points, 1, error);
    if (bytes == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    memcpy(bytes, header, (size_t)n);
    for (size_t i = 0; i < points; i++) {
        float value = (float)map->z[i];
        uint32_t word;
        memcpy(&word, &value, sizeof word);
        for (size_t k = 0; k < 4; k++) {
            bytes[start + 4 * i + k] = (unsigned char)(word >> (8 * k));
        }
    }
    haft_status status = haft_store_put(path, bytes, start + 4 * points, error);
    haft_memory_free(bytes);
    return status;
}
