/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the numbers in the rows of a text map. The whole file determines the separator and whether
 * commas are decimal: semicolons or tabs are separators if there are any; commas are separators if
 * a blank follows each of them or nothing else can be the separator, otherwise they are decimal. An
 * empty cell between two tabs, commas or semicolons is a missing pixel. */
#include "map_text.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

enum { CELL_CAPACITY = 64 };

/* Whether a cell is a word that programs write for a missing height. */
static bool is_missing(const char *cell) {
    static const char *const words[] = {
        "nan",  "na",       "n/a",          "#n/a",         "#na",     "-",     "--",      "---",
        "null", "none",     "bad",          "nodata",       "void",    "nil",   "missing", "masked",
        "#n/v", "nan(ind)", "\xe2\x80\x93", "\xe2\x80\x94", "1.#qnan", "1.#ind"};
    for (size_t k = 0; k < sizeof words / sizeof *words; k++) {
        if (strcasecmp(cell, words[k]) == 0) {
            return true;
        }
    }
    bool sign = *cell == '-' || *cell == '+';
    return sign && (strncasecmp(cell + 1, "nan", 3) == 0 || strncmp(cell + 1, "1.#", 3) == 0) &&
           is_missing(cell + 1);
}

/* The first line with each of these characters between or in the numbers; 0: none. */
typedef struct evidence {
    size_t semicolon, tab, blank, point, comma;
    size_t spaced;  /* a comma next to a blank */
    size_t tight;   /* a comma without blanks, between two characters of numbers */
    size_t parting; /* a comma that cannot be decimal, since a sign follows */
} evidence;

static bool is_blank(char c) {
    return c == ' ' || c == '\t';
}

static void note(size_t *line, size_t number) {
    *line = *line == 0 ? number : *line;
}

static void look_at_comma(evidence *e, const char *text, const char *at, size_t number) {
    char before = at > text ? at[-1] : ',', after = at[1 + strspn(at + 1, " \t")];
    note(&e->comma, number);
    if (after == '-' || after == '+') {
        note(&e->parting, number);
    }
    if (before != ',' && after != ',' && after != '\0') {
        note(is_blank(before) || is_blank(at[1]) ? &e->spaced : &e->tight, number);
    }
}

static void look_at_row(evidence *e, const haft_map_row *row) {
    const char *text = row->text + strspn(row->text, " \t");
    for (const char *at = text; *at != '\0'; at++) {
        const char *next = at + 1 + strspn(at + 1, " "); /* after a run of blanks */
        switch (*at) {
        case ';':
            note(&e->semicolon, row->number);
            break;
        case '.':
            note(&e->point, row->number);
            break;
        case '\t':
            note(&e->tab, row->number);
            break;
        case ' ':
            if (strchr(" \t,;", at[-1]) == NULL && strchr("\t,;", *next) == NULL) {
                note(&e->blank, row->number);
            }
            break;
        case ',':
            look_at_comma(e, text, at, row->number);
            break;
        default:
            break;
        }
    }
}

static haft_status two_ways(const haft_map_file *file, size_t line, const char *what,
                            haft_error *error) {
    return haft_error_set(error, HAFT_ERROR_INPUT,
                          "%s:%zu: %s, so it could be read in two ways; write decimal points, and "
                          "numbers parted by blanks, tabs or semicolons",
                          file->path, line, what);
}

/* Whether a row has only blanks. */
static bool is_empty(const haft_map_row *row) {
    return row->text[strspn(row->text, " \t")] == '\0';
}

static const char *end_of(const char *text, const char *blanks) {
    const char *end = text + strlen(text);
    while (end > text && strchr(blanks, end[-1]) != NULL) {
        end--;
    }
    return end;
}

/* Finds out whether commas are decimal; complains if they could be either. */
static haft_status judge_commas(bool *decimal, const evidence *e, const haft_map_file *file,
                                haft_error *error) {
    bool apart = e->blank > 0 || e->tab > 0;
    *decimal = e->tight > 0 && e->parting == 0 && (e->semicolon > 0 || (apart && e->spaced == 0));
    if (*decimal && e->point > 0) {
        return two_ways(file, e->tight > e->point ? e->tight : e->point,
                        "some numbers have a decimal point and some a comma", error);
    }
    if (e->semicolon == 0 && e->tight > 0 && e->spaced > 0 && e->point == 0 && e->parting == 0) {
        return two_ways(file, e->tight > e->spaced ? e->tight : e->spaced,
                        "some commas have a blank beside them and some have none", error);
    }
    return HAFT_OK;
}

static size_t count_tabs(const char *text) {
    size_t n = 0;
    for (; *text != '\0'; text++) {
        n += *text == '\t';
    }
    return n;
}

/* Removes rows without text: all of them, or, if tabs are separators, those at the end that have
 * not as many tabs as the first row. */
static void drop_empty_rows(haft_map_row *row, size_t *rows, bool tabs) {
    size_t kept = 0;
    for (size_t i = 0; i < *rows; i++) {
        if (tabs || !is_empty(&row[i])) {
            row[kept++] = row[i];
        }
    }
    while (kept > 0 && is_empty(&row[kept - 1]) &&
           count_tabs(row[kept - 1].text) != count_tabs(row[0].text)) {
        kept--;
    }
    *rows = kept;
}

/* Rejects a file that begins with a word: it is not a table of numbers, whatever follows. */
static haft_status check_first(const haft_map_row *row, const haft_map_file *file,
                               haft_error *error) {
    char word[CELL_CAPACITY], quoted[48];
    const char *text = row->text + strspn(row->text, " \t\"");
    size_t n = strcspn(text, " \t,;\"");
    snprintf(word, sizeof word, "%.*s", n < sizeof word ? (int)n : 0, text);
    if (!isalpha((unsigned char)*text) || is_missing(word)) {
        return HAFT_OK;
    }
    return haft_error_set(error, HAFT_ERROR_INPUT,
                          "%s:%zu: is no height map that Haft knows: it begins with \"%s\"",
                          file->path, row->number, haft_map_quote(quoted, text, n));
}

haft_status haft_map_find_notation(haft_map_notation *notation, haft_map_row *row, size_t *rows,
                                   const haft_map_file *file, haft_error *error) {
    evidence e = {0};
    bool decimal = false;
    haft_status status = check_first(row, file, error);
    for (size_t i = 0; i < *rows; i++) {
        if (!is_empty(&row[i])) {
            look_at_row(&e, &row[i]);
        }
    }
    HAFT_THEN(status, judge_commas(&decimal, &e, file, error));
    if (status != HAFT_OK) {
        return status;
    }
    char separator = e.semicolon > 0             ? ';'
                     : e.comma > 0 && !decimal   ? ','
                     : e.tab > 0 && e.blank == 0 ? '\t'
                                                 : ' ';
    bool tabs = separator == '\t';
    drop_empty_rows(row, rows, tabs);
    *notation = (haft_map_notation){
        .separator = separator, .comma = decimal, .open = tabs, .closed = separator != ' '};
    for (size_t i = 0; i < *rows; i++) {
        const char *text = row[i].text + strspn(row[i].text, " ");
        const char *end = end_of(text, tabs ? " " : " \t");
        notation->open = notation->open && *text == '\t';
        notation->closed = notation->closed && end > text && end[-1] == separator;
    }
    return *rows > 0 ? HAFT_OK
                     : haft_error_set(error, HAFT_ERROR_INPUT, "%s: holds no numbers", file->path);
}

/* ---- one number ---- */

/* Reads the number in a cell; NAN for an empty cell or a word for a missing height. */
static bool read_cell(const haft_map_notation *notation, const char *text, size_t n,
                      double *value) {
    char cell[CELL_CAPACITY];
    if (n >= 2 && text[0] == '"' && text[n - 1] == '"') {
        text++;
        n -= 2;
    }
    if (n >= sizeof cell) {
        return false;
    }
    memcpy(cell, text, n);
    cell[n] = '\0';
    if (n == 0 || is_missing(cell)) {
        *value = NAN;
        return true;
    }
    char *comma = strchr(cell, ',');
    if (comma != NULL) {
        *comma = notation->comma ? '.' : ',';
    }
    return haft_number_read(cell, value);
}

/* ---- all numbers ---- */

typedef struct reading {
    const haft_map_notation *notation;
    const haft_map_file *file;
    haft_map_table *table;
    bool titled, *filled; /* filled: columns with a non-empty cell in any row */
} reading;

static haft_status wrong_cell(const reading *r, const haft_map_row *row, size_t column,
                              const char *cell, size_t n, haft_error *error) {
    char quoted[48];
    bool foreign = r->table->rows == 0 && column == 0 && !r->titled;
    haft_map_quote(quoted, cell, n);
    return foreign ? haft_error_set(error, HAFT_ERROR_INPUT,
                                    "%s:%zu: is no height map that Haft knows: it begins with "
                                    "\"%s\"",
                                    r->file->path, row->number, quoted)
                   : haft_error_set(error, HAFT_ERROR_INPUT,
                                    "%s:%zu: this is no number: \"%s\", in column %zu; a missing "
                                    "pixel is written nan",
                                    r->file->path, row->number, quoted, column + 1);
}

/* Reads the cells of a row, or only counts them if `keep` is false. */
static haft_status read_row(const reading *r, const haft_map_row *row, bool keep, size_t *columns,
                            haft_error *error) {
    char separator = r->notation->separator;
    const char *blanks = separator == '\t' ? " " : " \t";
    const char *at = row->text + strspn(row->text, blanks), *end = end_of(at, blanks);
    haft_map_table *t = r->table;
    at += r->notation->open && at < end;
    end -= r->notation->closed && at < end;
    *columns = 0;
    for (bool more = true; more; ++*columns) {
        const char *stop = at;
        while (stop < end && (separator == ' ' ? !is_blank(*stop) : *stop != separator)) {
            stop++;
        }
        more = stop < end;
        const char *next = more ? stop + 1 : stop;
        while (separator == ' ' && next < end && is_blank(*next)) {
            next++;
        }
        while (at < stop && strchr(blanks, *at) != NULL) {
            at++;
        }
        while (stop > at && strchr(blanks, stop[-1]) != NULL) {
            stop--;
        }
        if (keep && *columns < t->columns) {
            double *value = &t->value[t->rows * t->columns + *columns];
            if (!read_cell(r->notation, at, (size_t)(stop - at), value)) {
                return wrong_cell(r, row, *columns, at, (size_t)(stop - at), error);
            }
            r->filled[*columns] = r->filled[*columns] || stop > at;
        }
        at = next;
    }
    return HAFT_OK;
}

/* Appends the numbers of all rows, row by row. */
static haft_status read_rows(reading *r, const haft_map_row *row, size_t rows, haft_error *error) {
    haft_map_table *t = r->table;
    for (size_t i = 0; i < rows; i++) {
        size_t columns = 0;
        haft_status status = read_row(r, &row[i], false, &columns, error);
        if (status == HAFT_OK && columns == t->columns) {
            status = read_row(r, &row[i], true, &columns, error);
        } else if (status == HAFT_OK) {
            status = haft_error_set(
                error, HAFT_ERROR_INPUT,
                "%s:%zu: has %zu numbers where the lines before have %zu; the file is "
                "cut short or damaged%s",
                r->file->path, row[i].number, columns, t->columns,
                r->notation->separator == ' ' ? ", or a missing pixel is not written nan" : "");
        }
        if (status != HAFT_OK) {
            return status;
        }
        t->rows++;
    }
    return HAFT_OK;
}

haft_status haft_map_read_table(haft_map_table *table, const haft_map_notation *notation,
                                const haft_map_row *row, size_t rows, const haft_map_file *file,
                                bool titled, haft_error *error) {
    *table = (haft_map_table){.value = NULL};
    reading r = {.notation = notation, .file = file, .table = table, .titled = titled};
    HAFT_TRY(read_row(&r, row, false, &table->columns, error));
    size_t most = file->size + 1; /* of numbers: each has a byte behind it, but for the last */
    size_t room = table->columns > most / rows ? most : rows * table->columns;
    table->value = haft_memory_alloc(room, sizeof *table->value, error);
    r.filled = table->value != NULL ? haft_memory_alloc(table->columns, 1, error) : NULL;
    haft_status status = r.filled == NULL ? HAFT_ERROR_MEMORY : HAFT_OK;
    HAFT_THEN(status, read_rows(&r, row, rows, error));
    for (size_t j = 0; status == HAFT_OK && j < table->columns; j++) {
        if (!r.filled[j]) {
            status = haft_error_set(error, HAFT_ERROR_INPUT,
                                    "%s:%zu: column %zu is empty in every row; write one separator "
                                    "between two numbers",
                                    file->path, row[0].number, j + 1);
        }
    }
    haft_memory_free(r.filled);
    return status;
}
