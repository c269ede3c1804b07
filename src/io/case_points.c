/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads two columns of a CSV file that a case names: the first line gives the columns' names and
 * units, other columns are ignored. The table of the water film is given in this form. */
#include "case.h"

#include <string.h>

enum { POINTS_MOST = 4096, NUMBER_CAPACITY = 400, BYTES_MOST = 1 << 22 };

static bool find_columns(const char *line, const char *const names[2], size_t place[2]) {
    bool found[2] = {false, false};
    size_t column = 0;
    for (const char *at = line; *at != '\0'; column++) {
        const char *name = at + strspn(at, " \t\"");
        at += strcspn(at, ",");
        size_t n = at > name ? (size_t)(at - name) : 0;
        while (n > 0 && strchr(" \t\"", name[n - 1]) != NULL) {
            n--;
        }
        for (int k = 0; k < 2; k++) {
            if (n == strlen(names[k]) && strncmp(name, names[k], n) == 0) {
                place[k] = column;
                found[k] = true;
            }
        }
        at += *at == ',' ? 1 : strlen(at);
    }
    return found[0] && found[1];
}

/* Reads the number in one column of a line, and cuts the line there. */
static bool find_number(const char *line, size_t place, double *value) {
    for (size_t k = 0; k < place; k++) {
        line = strchr(line, ',');
        if (line == NULL) {
            return false;
        }
        line++;
    }
    char field[NUMBER_CAPACITY];
    size_t n = strcspn(line, ",");
    if (n >= sizeof field) {
        return false;
    }
    memcpy(field, line, n);
    field[n] = '\0';
    return haft_number_read(field, value);
}

static haft_status read_lines(double *points, size_t *n, char *text, const char *path,
                              const char *const names[2], const double factors[2],
                              haft_error *error) {
    size_t place[2] = {0, 0}, number = 1;
    char *line = haft_text_line(&text);
    if (line == NULL || !find_columns(line, names, place)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s:1: the first line must name the columns, as in \"%s,%s\"", path,
                              names[0], names[1]);
    }
    for (line = haft_text_line(&text); line != NULL; line = haft_text_line(&text)) {
        number++;
        if (line[strspn(line, " \t")] == '\0') {
            continue;
        }
        double value[2];
        for (int k = 0; k < 2; k++) {
            if (!find_number(line, place[k], &value[k])) {
                return haft_error_set(error, HAFT_ERROR_INPUT,
                                      "%s:%zu: has no finite number under \"%s\"", path, number,
                                      names[k]);
            }
        }
        if (*n == POINTS_MOST) {
            return haft_error_set(error, HAFT_ERROR_INPUT, "%s: has more than %d points", path,
                                  POINTS_MOST);
        }
        points[2 * *n] = value[0] * factors[0];
        points[2 * *n + 1] = value[1] * factors[1];
        ++*n;
    }
    return HAFT_OK;
}

/* Digest and lines come from the same bytes, so that they agree even if the file changes. */
haft_status haft_case_read_points(double **points, size_t *n, haft_case_files *files,
                                  const char *const names[2], const double factors[2],
                                  haft_error *error) {
    const char *path = files->path[0];
    char *text = NULL;
    size_t size = 0;
    *n = 0;
    *points = haft_memory_alloc(POINTS_MOST, 2 * sizeof **points, error);
    haft_status status =
        *points == NULL ? HAFT_ERROR_MEMORY : haft_text_read(&text, &size, path, BYTES_MOST, error);
    if (status == HAFT_OK && size == 0) {
        status = haft_error_set(error, HAFT_ERROR_INPUT, "%s: is empty", path);
    }
    if (status == HAFT_OK) {
        haft_digest_memory(text, size, files->digest[0]);
        status = read_lines(*points, n, text, path, names, factors, error);
    }
    haft_memory_free(text);
    return status;
}

void haft_case_load_film(haft_case_reader *reader) {
    static const char *const names[] = {"humidity [%]", "thickness [nm]"};
    static const double factors[] = {1e-2, 1e-9};
    haft_case *c = reader->c;
    int table = haft_case_find_key("contact.capillary.adsorbed_table");
    int kind = haft_case_find_key("contact.capillary.adsorbed");
    bool given = reader->state[table] == HAFT_GOOD;
    if (!haft_case_is_sound(reader, haft_case_keys[kind].path)) {
        return;
    }
    if (given != (c->contact.adsorbed == HAFT_ADSORBED_TABLE)) {
        haft_case_complain(reader, reader->mark[given ? table : kind],
                           haft_case_keys[given ? table : kind].path,
                           given ? "needs adsorbed: table beside it"
                                 : "table needs adsorbed_table: film.csv beside it");
        return;
    }
    if (!given) {
        return;
    }
    haft_error error = {0};
    size_t n = 0;
    double *points = NULL;
    haft_status status =
        haft_case_read_points(&points, &n, &c->contact.adsorbed_file, names, factors, &error);
    double *data = status == HAFT_OK ? haft_memory_alloc(2 * n + 1, sizeof *data, &error) : NULL;
    if (data != NULL) {
        for (size_t i = 0; i < n; i++) {
            data[i] = points[2 * i];
            data[n + i] = points[2 * i + 1];
        }
        c->contact.film_data = data;
        c->contact.film = (haft_adsorption){n, data, data + n};
        status = haft_adsorption_check(&c->contact.film, &error);
    }
    haft_memory_free(points);
    if (status != HAFT_OK || data == NULL) {
        haft_case_complain(reader, reader->mark[table], haft_case_keys[table].path, "%.400s",
                           error.message);
    }
}
