/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The error budget as CSV, and back. Texts are quoted, numbers have 12 digits, lengths are in um;
 * what was not measured is nan. */
#include "haft/study_report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char HEADER[] = "term,kind,change,beams,switched,from [um],to [um],shift [um],"
                             "half width [um],cost [1],case";
enum { COLUMNS = 11, BYTES_MOST = 1 << 20 };

static const char SAMPLE[] = "sample count", TOTAL[] = "sum of refinements",
                  MODELS[] = "sum of other models", INTERACTION[] = "interaction";

static haft_status digest_of(char digest[HAFT_DIGEST_CAPACITY], const haft_case *c,
                             haft_error *error) {
    char *text = NULL;
    haft_status status = haft_case_emit(&text, c, error);
    if (status == HAFT_OK) {
        haft_digest_memory(text, strlen(text), digest);
    }
    haft_memory_free(text);
    return status;
}

static void write_quoted(FILE *stream, const char *text) {
    fputc('"', stream);
    for (; *text != '\0'; text++) {
        if (*text == '"') {
            fputc('"', stream);
        }
        fputc(*text, stream);
    }
    fputc('"', stream);
}

static const char *kind_of(const haft_budget_term *t) {
    return !t->measured ? "none" : t->refinement ? "refinement" : "model";
}

static void write_row(FILE *stream, const haft_budget_term *t, const char *digest) {
    write_quoted(stream, t->name);
    fprintf(stream, ",%s%s,", kind_of(t), t->measured && !t->paired ? " unpaired" : "");
    write_quoted(stream, t->change);
    fprintf(stream, ",%zu,%zu,%.12g,%.12g,%.12g,%.12g,%.12g,%s\n", t->beams, t->switched,
            t->from * 1e6, t->to * 1e6, t->shift * 1e6, t->half_width * 1e6, t->cost, digest);
}

static void write_rows(FILE *stream, const haft_budget *b, const char *digest) {
    fprintf(stream, "%s\n", HEADER);
    for (size_t i = 0; i < b->count; i++) {
        write_row(stream, &b->term[i], digest);
    }
    fprintf(stream,
            "\"%s\",sample,\"four times as many beams halve it\",%zu,0,nan,nan,0,%.12g,4,%s\n",
            SAMPLE, b->sampled, b->sampling * 1e6, digest);
    write_row(stream, &b->together, digest);
    write_row(stream, &b->interaction, digest);
    fprintf(stream, "\"%s\",sum,\"confidence %.12g\",%zu,0,%.12g,nan,%.12g,%.12g,nan,%s\n", TOTAL,
            b->confidence, b->beams, b->mean * 1e6, b->total * 1e6, b->total_half_width * 1e6,
            digest);
    fprintf(stream, "\"%s\",sum,\"\",%zu,0,%.12g,nan,%.12g,nan,nan,%s\n", MODELS, b->beams,
            b->mean * 1e6, b->models * 1e6, digest);
}

haft_status haft_study_write_budget(const haft_budget *budget, const haft_case *c, const char *path,
                                    haft_error *error) {
    char digest[HAFT_DIGEST_CAPACITY], *text = NULL;
    size_t size = 0;
    HAFT_TRY(digest_of(digest, c, error));
    FILE *stream = open_memstream(&text, &size);
    bool failed = stream == NULL;
    if (!failed) {
        write_rows(stream, budget, digest);
        failed = ferror(stream) != 0;
        failed = fclose(stream) != 0 || failed ||
                 text == NULL; /* the last need not report its failure */
    }
    haft_status status = failed
                             ? haft_error_set(error, HAFT_ERROR_MEMORY, "%s: out of memory", path)
                             : haft_text_write(path, text, error);
    free(text);
    return status;
}

/* ---- back ---- */

/* Splits a line into its fields, in place. @return their number */
static size_t split(char *line, char *field[COLUMNS]) {
    size_t n = 0;
    char *from = line;
    while (n < COLUMNS) {
        char *to = from;
        bool quoted = *from == '"';
        field[n++] = to;
        from += quoted;
        while (*from != '\0' && *from != '\n' && (quoted || *from != ',')) {
            if (quoted && *from == '"') {
                if (from[1] != '"') {
                    from++;
                    break;
                }
                from++;
            }
            *to++ = *from++;
        }
        bool more = *from == ',';
        *to = '\0';
        if (!more) {
            break;
        }
        from++;
    }
    return n;
}

/* Counts in fields 3 and 4, numbers or "nan" in 5 to 9. */
static bool are_numbers(char *field[COLUMNS]) {
    bool good = true;
    for (size_t k = 3; k < COLUMNS - 1; k++) {
        double value = NAN;
        const char *word = field[k] + (field[k][0] == '-');
        bool count = field[k][0] != '\0' && field[k][strspn(field[k], "0123456789")] == '\0';
        good = good && (k < 5 ? count
                              : haft_number_read(field[k], &value) || strcmp(word, "nan") == 0 ||
                                    strcmp(word, "inf") == 0);
    }
    return good;
}

static void take_term(haft_budget_term *t, char *field[COLUMNS]) {
    *t = (haft_budget_term){.measured = strcmp(field[1], "none") != 0,
                            .refinement = strncmp(field[1], "model", 5) != 0,
                            .paired = strstr(field[1], "unpaired") == NULL,
                            .beams = strtoul(field[3], NULL, 10),
                            .switched = strtoul(field[4], NULL, 10),
                            .from = strtod(field[5], NULL) * 1e-6,
                            .to = strtod(field[6], NULL) * 1e-6,
                            .shift = strtod(field[7], NULL) * 1e-6,
                            .half_width = strtod(field[8], NULL) * 1e-6,
                            .cost = strtod(field[9], NULL)};
    snprintf(t->name, sizeof t->name, "%s", field[0]);
    snprintf(t->change, sizeof t->change, "%s", field[2]);
}

static void take_row(haft_budget *out, char *field[COLUMNS]) {
    haft_budget_term t;
    take_term(&t, field);
    if (strcmp(t.name, SAMPLE) == 0) {
        out->sampled = t.beams;
        out->sampling = t.half_width;
    } else if (strcmp(t.name, TOTAL) == 0) {
        out->beams = t.beams;
        out->mean = t.from;
        out->total = t.shift;
        out->total_half_width = t.half_width;
        out->confidence = strtod(t.change + strlen("confidence"), NULL);
    } else if (strcmp(t.name, MODELS) == 0) {
        out->models = t.shift;
    } else if (strncmp(t.name, "all ", 4) == 0) {
        out->together = t;
    } else if (strcmp(t.name, INTERACTION) == 0) {
        out->interaction = t;
    } else if (out->count < HAFT_BUDGET_TERMS_MAX) {
        out->term[out->count++] = t;
    }
}

/* Checks that every row has all fields and belongs to this case, and that the last row is the
 * last one written. */
static haft_status read_rows(haft_budget *out, const char *digest, char *text, const char *path,
                             haft_error *error) {
    char *field[COLUMNS], *line = haft_text_line(&text);
    bool good = line != NULL && strcmp(line, HEADER) == 0, whole = false;
    while (good && (line = haft_text_line(&text)) != NULL) {
        good = split(line, field) == COLUMNS && are_numbers(field);
        if (good && strcmp(field[COLUMNS - 1], digest) != 0) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "%s is of another case than there is now; measure it anew with "
                                  "`haft budget`",
                                  path);
        }
        if (good) {
            take_row(out, field);
            whole = strcmp(field[0], MODELS) == 0;
        }
    }
    if (!good || !whole || out->beams < 2 || out->count == 0) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s is no budget that Haft wrote, or damaged; measure it anew with "
                              "`haft budget`",
                              path);
    }
    return HAFT_OK;
}

haft_status haft_study_read_budget(haft_budget *out, const haft_case *c, const char *path,
                                   haft_error *error) {
    char digest[HAFT_DIGEST_CAPACITY], *text = NULL;
    size_t size = 0;
    *out = (haft_budget){0};
    haft_status status = digest_of(digest, c, error);
    HAFT_THEN(status, haft_text_read(&text, &size, path, BYTES_MOST, error));
    HAFT_THEN(status, read_rows(out, digest, text, path, error));
    haft_memory_free(text);
    return status;
}
