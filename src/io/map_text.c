/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Height maps as text: numbers between blanks, tabs or semicolons (a comma is then a decimal one),
 * or between commas where a line has no other separator. Lines that begin with '#' are the header,
 * of which Gwyddion's "Width", "Height", "Value units" and "Channel" are read, in English or
 * German. Three columns without a given size are points x, y, z on a grid, in any order; grid
 * places without a point are missing. */
#include "map_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    TOKEN_CAPACITY = 64,
    UNIT_CAPACITY = 24,
    LINE_MOST = 1 << 22, /* bytes of a line: more than the longest row of a map needs */
};
static const double GRID_TOLERANCE = 0.01; /* of a step, by which a point may be off the grid */

/* Numbers as they stand in the file: rows of equal length. */
typedef struct table {
    double *value;
    size_t rows, columns, room;
    double width, height, unit; /* of the header, 0 if it has none */
    char channel[HAFT_CHANNEL_CAPACITY];
    bool titled; /* a header line was there */
    bool roomy;  /* there is room for all rows */
} table;

static haft_status wrong(const haft_map_file *file, size_t line, const char *what, const char *text,
                         size_t n, haft_error *error) {
    char quoted[48];
    return haft_error_set(error, HAFT_ERROR_INPUT, "%s:%zu: %s \"%s\"", file->path, line, what,
                          haft_map_quote(quoted, text, n));
}

/* ---- the header ---- */

/* What follows "# Name:" in a line, if it is one of two names. */
static const char *after(const char *line, const char *english, const char *german) {
    const char *const names[] = {english, german};
    line += strspn(line, "# \t");
    for (int k = 0; k < 2; k++) {
        size_t n = strlen(names[k]);
        if (strncmp(line, names[k], n) == 0 && line[n] == ':') {
            return line + n + 1 + strspn(line + n + 1, " \t");
        }
    }
    return NULL;
}

/* The one word that a text is, but for blanks about it; false if it is none or more. */
static bool take_word(const char *text, char word[UNIT_CAPACITY]) {
    text += strspn(text, " \t");
    size_t n = strcspn(text, " \t");
    if (n == 0 || n >= UNIT_CAPACITY || text[n + strspn(text + n, " \t")] != '\0') {
        return false;
    }
    memcpy(word, text, n);
    word[n] = '\0';
    return true;
}

/* "12,34 um" in metres: one decimal number and one unit. */
static bool read_length(const char *text, double *value) {
    char number[TOKEN_CAPACITY], unit[UNIT_CAPACITY];
    double factor = 0;
    size_t n = strcspn(text, " \t");
    if (n >= sizeof number || !take_word(text + n, unit)) {
        return false;
    }
    memcpy(number, text, n);
    number[n] = '\0';
    char *comma = strchr(number, ',');
    if (comma != NULL) {
        *comma = '.';
    }
    return haft_number_read(number, &factor) && haft_map_length(factor, unit, value) && *value > 0;
}

static haft_status read_title(table *t, const haft_map_file *file, size_t number, const char *line,
                              haft_error *error) {
    const char *width = after(line, "Width", "Breite");
    const char *height = after(line, "Height", "H\xc3\xb6he");
    const char *unit = after(line, "Value units", "Werteinheiten");
    const char *channel = after(line, "Channel", "Kanal");
    t->titled = true;
    if (height == NULL) {
        height = after(line, "H\xf6he", "Hoehe");
    }
    if (width != NULL && !read_length(width, &t->width)) {
        return wrong(file, number, "the width is no length, as in \"# Width: 10 um\", but", width,
                     strlen(width), error);
    }
    if (height != NULL && !read_length(height, &t->height)) {
        return wrong(file, number, "the height is no length, as in \"# Height: 10 um\", but",
                     height, strlen(height), error);
    }
    if (unit != NULL) {
        char name[UNIT_CAPACITY] = "";
        if (!take_word(unit, name) || !haft_map_length(1, name, &t->unit)) {
            return wrong(file, number, "the values are no heights but in", unit, strlen(unit),
                         error);
        }
    }
    if (channel != NULL) {
        haft_map_name(t->channel, channel, strcspn(channel, "\r"));
    }
    return HAFT_OK;
}

/* ---- numbers ---- */

static haft_status make_room(table *t, size_t room, size_t kept, haft_error *error) {
    double *more = haft_memory_alloc(room, sizeof *more, error);
    if (more == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    if (kept > 0) {
        memcpy(more, t->value, kept * sizeof *more);
    }
    haft_memory_free(t->value);
    t->value = more;
    t->room = room;
    return HAFT_OK;
}

/* Keeps a number of the first row, or of a later one if that is no longer than the first. */
static haft_status push(table *t, double value, size_t column, haft_error *error) {
    size_t at = t->rows * t->columns + column;
    haft_status status = HAFT_OK;
    if (t->rows > 0 && column >= t->columns) {
        return HAFT_OK;
    }
    if (at == t->room) {
        status = make_room(t, t->room == 0 ? 4096 : 2 * t->room, at, error);
    }
    if (status == HAFT_OK) {
        t->value[at] = value;
    }
    return status;
}

/* Columns are points x, y, z where three stand without the size of a map. */
static bool holds_points(const table *t, const haft_map_file *file) {
    return t->columns == 3 && !(t->width > 0 || file->options.width > 0);
}

/* Once the first row is known: room for as many rows as there are lines left, all at once. A number
 * and what parts it from the next take two bytes, so there can be no more than that allows. */
static haft_status make_room_for_rest(table *t, const haft_map_file *file, const char *rest,
                                      size_t bytes, haft_error *error) {
    size_t lines = 2, most = t->columns + bytes / 2 + 1;
    if (t->columns == 0) { /* separators alone */
        return HAFT_OK;
    }
    for (const char *at = rest; (at = memchr(at, '\n', (size_t)(rest + bytes - at))) != NULL;
         at++) {
        lines++;
    }
    if (lines > HAFT_MAP_SIDE_MOST && !holds_points(t, file)) {
        lines = HAFT_MAP_SIDE_MOST;
    }
    size_t room = lines < most / t->columns ? lines * t->columns : most;
    return room > t->room ? make_room(t, room, t->columns, error) : HAFT_OK;
}

/* A map that is too large is refused before it is read to its end. */
static haft_status check_sides(const table *t, const haft_map_file *file, size_t number,
                               size_t columns, haft_error *error) {
    bool wide = columns > HAFT_MAP_SIDE_MOST;
    if (!wide && (t->rows < HAFT_MAP_SIDE_MOST || holds_points(t, file))) {
        return HAFT_OK;
    }
    return haft_error_set(
        error, HAFT_ERROR_INPUT, "%s:%zu: a map of more than %d %s; it needs 2 to %d pixels a side",
        file->path, number, HAFT_MAP_SIDE_MOST, wide ? "columns" : "rows", HAFT_MAP_SIDE_MOST);
}

/* One number from a token; a comma in it is a decimal one. */
static bool read_number(const char *text, size_t n, double *value) {
    char token[TOKEN_CAPACITY];
    if (n == 0 || n >= sizeof token) {
        return false;
    }
    memcpy(token, text, n);
    token[n] = '\0';
    char *comma = strchr(token, ',');
    if (comma != NULL) {
        *comma = '.';
    }
    if (strcasecmp(token + (token[0] == '-' || token[0] == '+'), "nan") == 0) {
        *value = NAN; /* a missing pixel */
        return true;
    }
    return haft_number_read(token, value);
}

static haft_status read_row(table *t, const haft_map_file *file, size_t number, const char *line,
                            haft_error *error) {
    const char *separators = line[strcspn(line, " \t;")] == '\0' ? "," : " \t;";
    line += strspn(line, " \t");
    size_t columns = 0, length = strlen(line);
    while (length > 0 && strchr(" \t;", line[length - 1]) != NULL) {
        length--;
    }
    if (strcspn(line, " \t;") >= length) {
        separators = ",";
    }
    for (const char *at = line; at < line + length;) {
        size_t n = strcspn(at, separators);
        n = at + n > line + length ? (size_t)(line + length - at) : n;
        double value = 0;
        if (!read_number(at, n, &value)) {
            return wrong(file, number,
                         t->rows == 0 && columns == 0 && !t->titled
                             ? "is no height map that Haft knows: it begins with"
                             : "this is no number:",
                         at, n, error);
        }
        haft_status status = check_sides(t, file, number, columns + 1, error);
        if (status == HAFT_OK) {
            status = push(t, value, columns++, error);
        }
        if (status != HAFT_OK) {
            return status;
        }
        at += n;
        at += *separators == ',' ? (*at == ',') : strspn(at, separators);
    }
    if (t->rows > 0 && columns != t->columns) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "%s:%zu: has %zu numbers where the lines before have %zu; the file is "
            "cut short or damaged",
            file->path, number, columns, t->columns);
    }
    t->columns = columns;
    t->rows++;
    return HAFT_OK;
}

static haft_status read_lines(table *t, const haft_map_file *file, haft_error *error) {
    const char *at = file->bytes, *end = at + file->size;
    char *line = NULL;
    size_t capacity = 0, number = 0;
    haft_status status = HAFT_OK;
    while (at < end && status == HAFT_OK) {
        size_t n = strcspn(at, "\n");
        number++;
        if (n > LINE_MOST) {
            status = haft_error_set(error, HAFT_ERROR_INPUT,
                                    "%s:%zu: a line of %zu bytes; no row of a map is longer than "
                                    "%d MiB",
                                    file->path, number, n, LINE_MOST >> 20);
            break;
        }
        if (n + 1 > capacity) {
            haft_memory_free(line);
            capacity = 2 * n + 256;
            line = haft_memory_alloc(capacity, 1, error);
            if (line == NULL) {
                return HAFT_ERROR_MEMORY;
            }
        }
        memcpy(line, at, n);
        line[n] = '\0';
        if (n > 0 && line[n - 1] == '\r') {
            line[n - 1] = '\0';
        }
        if (line[strspn(line, " \t")] == '#') {
            status = read_title(t, file, number, line, error);
        } else if (line[strspn(line, " \t")] != '\0') {
            status = read_row(t, file, number, line, error);
        }
        at += n + 1;
        if (status == HAFT_OK && t->rows == 1 && at < end && !t->roomy) {
            status = make_room_for_rest(t, file, at, (size_t)(end - at), error);
            t->roomy = true;
        }
    }
    haft_memory_free(line);
    return status;
}

/* ---- points ---- */

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The even grid that one coordinate's values lie on. */
static haft_status find_axis(const haft_map_file *file, const table *t, size_t column,
                             double *first, double *step, size_t *n, haft_error *error) {
    double *value = haft_memory_alloc(t->rows, sizeof *value, error);
    if (value == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    for (size_t i = 0; i < t->rows; i++) {
        value[i] = t->value[3 * i + column];
    }
    qsort(value, t->rows, sizeof *value, compare);
    double range = value[t->rows - 1] - value[0], smallest = range;
    for (size_t i = 1; i < t->rows; i++) {
        double gap = value[i] - value[i - 1];
        smallest = gap > 1e-6 * range && gap < smallest ? gap : smallest;
    }
    double count = range > 0 ? round(range / smallest) : 0;
    *first = value[0];
    *step = count > 0 ? range / count : 0;
    bool even = count >= 1 && count < 32768;
    for (size_t i = 0; i < t->rows && even; i++) {
        double place = (value[i] - *first) / *step;
        even = fabs(place - round(place)) <= GRID_TOLERANCE;
    }
    *n = (size_t)count + 1;
    haft_memory_free(value);
    return even
               ? HAFT_OK
               : haft_error_set(error, HAFT_ERROR_INPUT,
                                "%s: the points' %s are not on an even grid; interpolate them onto "
                                "one first",
                                file->path, column == 0 ? "x" : "y");
}

static haft_status place_points(haft_map *map, const haft_map_file *file, const table *t,
                                const double first[2], const double step[2], haft_error *error) {
    double unit = t->unit > 0 ? t->unit : file->options.unit;
    for (size_t i = 0; i < map->rows * map->columns; i++) {
        map->z[i] = NAN;
    }
    for (size_t k = 0; k < t->rows; k++) {
        const double *point = t->value + 3 * k;
        size_t j = (size_t)llround((point[0] - first[0]) / step[0]);
        size_t i = map->rows - 1 - (size_t)llround((point[1] - first[1]) / step[1]);
        double *z = &map->z[i * map->columns + j];
        if (!isnan(*z)) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "%s: two points at x = %g, y = %g; leave one out", file->path,
                                  point[0], point[1]);
        }
        *z = unit * point[2];
    }
    return HAFT_OK;
}

static haft_status make_from_points(haft_map **out, const haft_map_file *file, const table *t,
                                    haft_error *error) {
    double first[2], step[2], lateral = file->options.lateral_unit;
    size_t n[2];
    if (!(lateral > 0) || !(t->unit > 0 || file->options.unit > 0)) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "%s: three columns of points x, y, z; give the unit of x and y, as um, "
            "and that of heights, as nm (for a matrix three pixels wide give its "
            "size)",
            file->path);
    }
    for (size_t i = 0; i < 3 * t->rows; i++) {
        if (isnan(t->value[i]) && i % 3 != 2) {
            return haft_error_set(error, HAFT_ERROR_INPUT, "%s: point %zu has no place", file->path,
                                  i / 3 + 1);
        }
    }
    haft_status status = find_axis(file, t, 0, &first[0], &step[0], &n[0], error);
    if (status == HAFT_OK) {
        status = find_axis(file, t, 1, &first[1], &step[1], &n[1], error);
    }
    if (status == HAFT_OK && (double)n[0] * (double)n[1] > 2 * (double)t->rows) {
        status = haft_error_set(error, HAFT_ERROR_INPUT,
                                "%s: %zu points on a grid of %zu x %zu leave more than half of it "
                                "empty; the file is cut short, or the points are on no grid",
                                file->path, t->rows, n[1], n[0]);
    }
    if (status == HAFT_OK) {
        status = haft_map_create(out, n[1], n[0], lateral * step[1], lateral * step[0], error);
    }
    if (status == HAFT_OK) {
        status = place_points(*out, file, t, first, step, error);
        if (status != HAFT_OK) {
            haft_map_destroy(out);
        }
    }
    return status;
}

haft_status haft_map_read_text(haft_map **out, const haft_map_file *file, haft_error *error) {
    table t = {.value = NULL};
    haft_status status = read_lines(&t, file, error);
    if (status == HAFT_OK && t.rows == 0) {
        status = haft_error_set(error, HAFT_ERROR_INPUT, "%s: holds no numbers", file->path);
    }
    bool points = holds_points(&t, file);
    if (status == HAFT_OK) {
        status = points ? make_from_points(out, file, &t, error)
                        : haft_map_from_matrix(out, file, t.rows, t.columns, t.width, t.height,
                                               t.unit, t.value, error);
    }
    if (status == HAFT_OK) {
        memcpy((*out)->channel, t.channel, sizeof t.channel);
        snprintf((*out)->format, sizeof(*out)->format,
                 points     ? "text, points x y z"
                 : t.titled ? "text matrix with header"
                            : "text matrix");
    }
    haft_memory_free(t.value);
    return status;
}
