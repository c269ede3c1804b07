/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads law vectors from a table made by another program: CSV whose first line names the columns
 * and their units. */
#include "haft/io.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { COLUMNS = HAFT_CHAOS_DIMENSION, FIELDS_LIMIT = 256, NAME_CAPACITY = 64 };
static const size_t BYTES_MOST = (size_t)1 << 31;

static const struct {
    const char *name, *unit, *example;
} wanted[COLUMNS] = {
    {"e", "J/m^2", "e [mJ/m2]"},
    {"f_max", "Pa", "f_max [MPa]"},
    {"d_max", "m", "d_max [nm]"},
    {"d_limit", "m", "d_limit [nm]"},
};

/* The field of each number in a line, and its factor to SI. */
typedef struct layout {
    size_t field[COLUMNS], fault; /* fault: SIZE_MAX if there is none */
    double factor[COLUMNS];
    size_t fields;
} layout;

/* Splits a line at its commas, in place. @return the number of fields, more than FIELDS_LIMIT if
 * there are too many */
static size_t split(char *line, char *field[FIELDS_LIMIT]) {
    size_t n = 0;
    for (char *at = line; at != NULL; n++) {
        if (n == FIELDS_LIMIT) {
            return n + 1;
        }
        field[n] = at;
        at = strchr(at, ',');
        if (at != NULL) {
            *at++ = '\0';
        }
    }
    return n;
}

/* Splits "e [mJ/m2]" into name and unit; false if it is neither a name alone nor both. */
static bool name_and_unit(const char *field, char name[NAME_CAPACITY], char unit[NAME_CAPACITY]) {
    field += strspn(field, " \t\"");
    size_t n = strcspn(field, "[] \t\"");
    const char *rest = field + n + strspn(field + n, " \t");
    size_t m = *rest == '[' ? strcspn(rest + 1, "[]") : 0;
    if (n == 0 || n >= NAME_CAPACITY || m >= NAME_CAPACITY) {
        return false;
    }
    memcpy(name, field, n);
    name[n] = '\0';
    memcpy(unit, rest + (*rest == '['), m);
    unit[m] = '\0';
    const char *end = *rest == '[' ? rest + 1 + m : rest;
    end += *rest == '[' && *end == ']';
    return end[strspn(end, " \t\"")] == '\0' && (*rest != '[' || end[-1] == ']');
}

static haft_status read_factor(const haft_units *units, const char *path, size_t i,
                               const char *unit, double *factor, haft_error *error) {
    char text[NAME_CAPACITY + 4];
    snprintf(text, sizeof text, "1 %s", unit);
    haft_error own = {0};
    haft_status status = unit[0] == '\0'
                             ? HAFT_ERROR_INPUT
                             : haft_units_parse(units, text, wanted[i].unit, factor, &own);
    if (status == HAFT_ERROR_MEMORY) {
        return haft_error_set(error, status, "%s: %s", path, own.message);
    }
    if (status != HAFT_OK) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s:1: the column %s has no unit of %s, but \"%s\"; name it as in "
                              "\"%s\"",
                              path, wanted[i].name, wanted[i].unit, unit, wanted[i].example);
    }
    return HAFT_OK;
}

static haft_status read_layout(layout *l, const haft_units *units, const char *path, char *line,
                               haft_error *error) {
    char *field[FIELDS_LIMIT], name[NAME_CAPACITY], unit[NAME_CAPACITY];
    bool found[COLUMNS] = {false};
    l->fields = split(line, field);
    l->fault = SIZE_MAX;
    if (l->fields > FIELDS_LIMIT) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "%s:1: has more than %d columns", path,
                              FIELDS_LIMIT);
    }
    for (size_t k = 0; k < l->fields; k++) {
        if (!name_and_unit(field[k], name, unit)) {
            continue;
        }
        l->fault = strcmp(name, "fault") == 0 ? k : l->fault;
        for (size_t i = 0; i < COLUMNS; i++) {
            if (strcmp(name, wanted[i].name) == 0) {
                HAFT_TRY(read_factor(units, path, i, unit, &l->factor[i], error));
                found[i] = true;
                l->field[i] = k;
            }
        }
    }
    for (size_t i = 0; i < COLUMNS; i++) {
        if (!found[i]) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "%s:1: there is no column %s; the first line names the columns, "
                                  "as in \"e [mJ/m2],f_max [MPa],d_max [nm],d_limit [nm]\"",
                                  path, wanted[i].name);
        }
    }
    return HAFT_OK;
}

/* Whether a field is 0, in any notation. */
static bool is_zero(const char *field) {
    double value = 1;
    return haft_number_read(field, &value) && value == 0;
}

/* Reads one line into a vector; *sound is false if the line has a fault and so no vector. */
static haft_status read_row(const layout *l, const char *path, size_t number, char *line,
                            haft_law_vector *vector, bool *sound, haft_error *error) {
    char *field[FIELDS_LIMIT];
    size_t fields = split(line, field);
    if (fields != l->fields) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s:%zu: %zu fields where the first line "
                              "names %zu columns",
                              path, number, fields, l->fields);
    }
    *sound = l->fault == SIZE_MAX || is_zero(field[l->fault]);
    double value[COLUMNS] = {0};
    for (size_t i = 0; i < COLUMNS && *sound; i++) {
        if (!haft_number_read(field[l->field[i]], &value[i]) ||
            !isfinite(value[i] * l->factor[i])) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "%s:%zu: %s is \"%.40s\", no finite decimal number; mend it or "
                                  "leave the line out",
                                  path, number, wanted[i].name, field[l->field[i]]);
        }
        value[i] *= l->factor[i];
    }
    *vector = (haft_law_vector){value[0], value[1], value[2], value[3]};
    return HAFT_OK;
}

static haft_status grow(haft_law_vector **vector, size_t held, size_t *room, haft_error *error) {
    size_t next = *room == 0 ? 1024 : 2 * *room;
    haft_law_vector *more = haft_memory_alloc(next, sizeof *more, error);
    if (more == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    if (held > 0) {
        memcpy(more, *vector, held * sizeof *more);
    }
    haft_memory_free(*vector);
    *vector = more;
    *room = next;
    return HAFT_OK;
}

static haft_status read_lines(haft_law_vector **vector, size_t *m, const haft_units *units,
                              char *text, const char *path, haft_error *error) {
    size_t room = 0, number = 1;
    layout l = {.fields = 0};
    char *line = haft_text_line(&text);
    haft_status status = line != NULL ? read_layout(&l, units, path, line, error) : HAFT_OK;
    while (status == HAFT_OK && (line = haft_text_line(&text)) != NULL) {
        number++;
        if (line[strspn(line, " \t")] == '\0') {
            continue;
        }
        if (*m == room) {
            status = grow(vector, *m, &room, error);
        }
        bool sound = false;
        HAFT_THEN(status, read_row(&l, path, number, line, *vector + *m, &sound, error));
        *m += status == HAFT_OK && sound;
    }
    if (status == HAFT_OK && *m == 0) {
        status = haft_error_set(error, HAFT_ERROR_INPUT,
                                "%s: holds no law vector; give a line that names the columns and "
                                "a line a vector",
                                path);
    }
    return status;
}

haft_status haft_vectors_read(haft_law_vector **vector, size_t *m, const char *path,
                              haft_error *error) {
    *vector = NULL;
    *m = 0;
    haft_units *units = NULL;
    char *text = NULL;
    size_t size = 0;
    haft_status status = haft_text_read(&text, &size, path, BYTES_MOST, error);
    HAFT_THEN(status, haft_units_create(&units, error));
    HAFT_THEN(status, read_lines(vector, m, units, text, path, error));
    haft_units_destroy(&units);
    haft_memory_free(text);
    if (status != HAFT_OK) {
        haft_memory_free(*vector);
        *vector = NULL;
        *m = 0;
    }
    return status;
}
