/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Height maps as text: a matrix of numbers, or points x, y, z in three columns. First the lines are
 * divided into header lines and rows; then the separator is determined from all rows; last the map
 * is made. A file has one map: what looks like a second one is rejected. */
#include "map_text.h"
#include "text.h"

#include <stdio.h>
#include <string.h>

enum { LINE_MOST = 1 << 22 }; /* bytes of a line: more than the longest row of a map needs */

/* The lines of a file, divided into header lines and rows. */
typedef struct lines {
    char *text;
    haft_map_title title;
    haft_map_row *row;
    size_t rows, room, most; /* most: lines of the file */
    size_t gap;              /* lines without numbers between the first two rows */
    size_t parting;          /* line of the first gap that differs from the first one; 0: none */
    bool remark;             /* there is a remark, not a blank line */
} lines;

/* Allocates all rows if there are more than a matrix may have and they may be points: three
 * numbers, which look like six if they have decimal commas. */
static haft_status make_room(lines *l, const haft_map_file *file, size_t number,
                             haft_error *error) {
    size_t words = 0;
    for (const char *at = l->row[0].text; *(at += strspn(at, " \t,;")) != '\0'; words++) {
        at += strcspn(at, " \t,;");
    }
    if (words < 3 || words > 6) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s:%zu: a map of more than %d rows; it needs 2 to %d pixels a side",
                              file->path, number, HAFT_MAP_SIDE_MOST, HAFT_MAP_SIDE_MOST);
    }
    haft_map_row *more = haft_memory_alloc(l->most, sizeof *more, error);
    if (more == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    memcpy(more, l->row, l->rows * sizeof *more);
    haft_memory_free(l->row);
    l->row = more;
    l->room = l->most;
    return HAFT_OK;
}

/* Adds a row of numbers after `gap` lines without numbers, the first of which is line `since`. */
static void add_row(lines *l, char *line, size_t number, size_t gap, size_t since, bool remark) {
    if (l->rows == 1) {
        l->gap = remark ? 0 : gap;
    }
    if (l->rows > 0 && l->parting == 0 && (remark || gap != l->gap)) {
        l->parting = remark || gap > l->gap ? since : number;
        l->remark = remark;
    }
    l->row[l->rows++] = (haft_map_row){line, number};
}

static haft_status tell_lines_apart(lines *l, const haft_map_file *file, haft_error *error) {
    char *rest = l->text;
    size_t number = 0, gap = 0, since = 0, second = 0;
    bool remark = false;
    for (char *line = haft_text_line(&rest); line != NULL; line = haft_text_line(&rest)) {
        bool title = false, known = false;
        size_t n = strlen(line);
        number++;
        if (n > LINE_MOST) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "%s:%zu: a line of %zu bytes; no row of a map is longer than "
                                  "%d MiB",
                                  file->path, number, n, LINE_MOST >> 20);
        }
        bool blank = line[strspn(line, " ")] == '\0';
        HAFT_TRY(blank ? HAFT_OK
                       : haft_map_read_title(&l->title, file, number, line, l->rows == 0, &title,
                                             &known, error));
        if (blank || title) {
            since = gap == 0 ? number : since;
            remark = remark || title;
            gap++;
            second = known && l->rows > 0 && second == 0 ? number : second;
            continue;
        }
        if (second > 0) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "%s:%zu: a second header in the middle of the numbers: the file "
                                  "holds more than one map; give one map a file",
                                  file->path, second);
        }
        HAFT_TRY(l->rows == l->room ? make_room(l, file, number, error) : HAFT_OK);
        add_row(l, line, number, gap, since, remark);
        gap = 0;
        remark = false;
    }
    return second == 0
               ? HAFT_OK
               : haft_error_set(error, HAFT_ERROR_INPUT,
                                "%s:%zu: a header behind the numbers: of a second map that is cut "
                                "off, or it belongs before them",
                                file->path, second);
}

static haft_status make_lines(lines *l, const haft_map_file *file, haft_error *error) {
    size_t size = file->size, most = 1;
    l->text = haft_memory_alloc(size + 1, 1, error);
    if (l->text == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    memcpy(l->text, file->bytes, size);
    HAFT_TRY(haft_text_decode(&l->text, &size, file->path, error));
    for (const char *at = l->text; (at = strchr(at, '\n')) != NULL; at++) {
        most++;
    }
    l->most = most;
    l->room = most > HAFT_MAP_SIDE_MOST ? HAFT_MAP_SIDE_MOST : most;
    l->row = haft_memory_alloc(l->room, sizeof *l->row, error);
    haft_status status = l->row == NULL ? HAFT_ERROR_MEMORY : tell_lines_apart(l, file, error);
    if (status == HAFT_OK && l->rows == 0) {
        status = haft_error_set(error, HAFT_ERROR_INPUT, "%s: holds no numbers", file->path);
    }
    return status;
}

/* Checks that a matrix has a valid size, agrees with its header, and is not interrupted. */
static haft_status check_matrix(const lines *l, const haft_map_file *file,
                                const haft_map_table *table, haft_error *error) {
    const haft_map_title *t = &l->title;
    size_t found[2] = {table->columns, table->rows};
    static const char *const names[] = {"columns", "rows"};
    for (int k = 0; k < 2; k++) {
        if (found[k] > HAFT_MAP_SIDE_MOST) {
            return haft_error_set(
                error, HAFT_ERROR_INPUT,
                "%s:%zu: a map of more than %d %s; it needs 2 to %d pixels a side", file->path,
                l->row[k == 0 ? 0 : HAFT_MAP_SIDE_MOST].number, HAFT_MAP_SIDE_MOST, names[k],
                HAFT_MAP_SIDE_MOST);
        }
        if (t->pixels[k] > 0 && t->pixels[k] != found[k]) {
            return haft_error_set(
                error, HAFT_ERROR_INPUT,
                "%s:%zu: the header says %zu %s, but the file holds %zu; it is cut "
                "short or damaged",
                file->path, t->pixels_line[k], t->pixels[k], names[k], found[k]);
        }
    }
    if (l->parting > 0) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s:%zu: a %s parts the rows of numbers, as if a second map began; "
                              "give one map a file, and its rows without anything between them",
                              file->path, l->parting, l->remark ? "line of text" : "blank line");
    }
    return HAFT_OK;
}

static haft_status make_map(haft_map **out, const lines *l, const haft_map_file *file,
                            const haft_map_table *table, haft_error *error) {
    const haft_map_title *t = &l->title;
    const haft_map_options *o = &file->options;
    bool sized = t->side[0].value > 0 || o->width > 0;
    bool placed = t->points || t->lateral[0].value > 0 || o->lateral_unit > 0;
    bool points = table->columns == 3 && (t->points || !sized || (placed && t->side[0].value == 0));
    haft_status status = HAFT_OK;
    if (table->columns == 3 && !points && t->side[0].value == 0) {
        status = haft_map_looks_like_points(&points, table, error);
    }
    if (status == HAFT_OK && points) {
        status = haft_map_from_points(out, file, table, t, error);
    } else if (status == HAFT_OK) {
        status = check_matrix(l, file, table, error);
        HAFT_THEN(status,
                  haft_map_from_matrix(out, file, table->rows, table->columns, t->side[0].value,
                                       t->side[1].value, t->unit.value, table->value, error));
    }
    if (status == HAFT_OK) {
        memcpy((*out)->channel, t->channel, sizeof t->channel);
        snprintf((*out)->format, sizeof(*out)->format,
                 points      ? "text, points x y z"
                 : t->titled ? "text matrix with header"
                             : "text matrix");
    }
    return status;
}

haft_status haft_map_read_text(haft_map **out, const haft_map_file *file, haft_error *error) {
    lines l = {.text = NULL};
    haft_map_table table = {.value = NULL};
    haft_map_notation notation;
    haft_status status = make_lines(&l, file, error);
    HAFT_THEN(status, haft_map_settle_title(&l.title, file, error));
    HAFT_THEN(status, haft_map_find_notation(&notation, l.row, &l.rows, file, error));
    HAFT_THEN(status,
              haft_map_read_table(&table, &notation, l.row, l.rows, file, l.title.titled, error));
    HAFT_THEN(status, make_map(out, &l, file, &table, error));
    haft_memory_free(l.text);
    haft_memory_free(l.row);
    haft_memory_free(table.value);
    return status;
}
