/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gwyddion Simple Field: a magic line, lines "name = value", one to four NUL so that the data begin
 * at a multiple of four, then little-endian 32-bit numbers row by row. */
#include "map_file.h"
#include "store.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct gsf_header {
    double columns, rows, width, height; /* 0: not there */
    char lateral[24], unit[24], title[HAFT_CHANNEL_CAPACITY];
} gsf_header;

/* "name = value" without the blanks around either; false for a line that is none. */
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

static haft_status read_header(gsf_header *h, const haft_map_file *file, const char *end,
                               haft_error *error) {
    static const char *const names[] = {"XRes", "YRes", "XReal", "YReal"};
    double *const values[] = {&h->columns, &h->rows, &h->width, &h->height};
    const char *line = (const char *)memchr(file->bytes, '\n', file->size) + 1;
    while (line < end) {
        const char *stop = memchr(line, '\n', (size_t)(end - line));
        size_t n = (size_t)((stop != NULL ? stop : end) - line);
        char name[32], value[128], quoted[48];
        if (!split(line, n, name, value)) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "%s: the header line \"%s\" is no \"name = value\"", file->path,
                                  haft_map_quote(quoted, line, n));
        }
        for (int k = 0; k < 4; k++) {
            if (strcmp(name, names[k]) == 0) {
                if (!haft_number_read(value, values[k]) || !(*values[k] > 0)) {
                    return haft_error_set(error, HAFT_ERROR_INPUT,
                                          "%s: %s is \"%s\"; it must be a positive number",
                                          file->path, name, haft_map_quote(quoted, value, 40));
                }
            }
        }
        if (strcmp(name, "XYUnits") == 0) {
            snprintf(h->lateral, sizeof h->lateral, "%.23s", value);
        } else if (strcmp(name, "ZUnits") == 0) {
            snprintf(h->unit, sizeof h->unit, "%.23s", value);
        } else if (strcmp(name, "Title") == 0) {
            haft_map_name(h->title, value, strlen(value));
        }
        line += n + 1;
    }
    return HAFT_OK;
}

/* The header's units in metres, 0 where it gives none. */
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
    const char *end = memchr(file->bytes, '\0', file->size);
    gsf_header h = {.columns = 0};
    double unit = 0;
    if (end == NULL) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "%s: is cut short: no NUL ends the header",
                              file->path);
    }
    haft_status status = read_header(&h, file, end, error);
    if (status == HAFT_OK && !(h.columns >= 1 && h.rows >= 1 && h.columns == floor(h.columns) &&
                               h.rows == floor(h.rows) && h.columns * h.rows < 1e9)) {
        status = haft_error_set(error, HAFT_ERROR_INPUT,
                                "%s: its header must give XRes and YRes, whole numbers of pixels",
                                file->path);
    }
    if (status == HAFT_OK) {
        status = read_units(&h, file, &unit, error);
    }
    if (status != HAFT_OK) {
        return status;
    }
    size_t rows = (size_t)h.rows, columns = (size_t)h.columns;
    size_t start = ((size_t)(end - file->bytes) / 4 + 1) * 4, needed = start + 4 * rows * columns;
    if (file->size != needed) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: has %zu bytes where %zu x %zu pixels need %zu; it is %s",
                              file->path, file->size, rows, columns, needed,
                              file->size < needed ? "cut short" : "damaged");
    }
    status = haft_map_begin(out, file, rows, columns, h.width, h.height, &unit, error);
    for (size_t i = 0; status == HAFT_OK && i < rows * columns; i++) {
        (*out)->z[i] = read_single((const unsigned char *)file->bytes + start + 4 * i);
    }
    if (status == HAFT_OK) {
        status = haft_map_end(out, file, unit, error);
    }
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
