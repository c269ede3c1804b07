/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The report of all errors of a case: complaints are kept with their position, sorted by it and
 * written one per line until the message is full. */
#include "case.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void haft_case_complain(haft_case_reader *reader, haft_mark mark, const char *path,
                        const char *format, ...) {
    size_t i = reader->complaints++;
    if (i >= HAFT_COMPLAINTS_MAX) {
        return;
    }
    haft_complaint *complaint = &reader->complaint[i];
    complaint->mark = mark;
    int n = snprintf(complaint->text, sizeof complaint->text, "%s: ", path);
    size_t used = n < 0 ? 0 : (size_t)n;
    if (used < sizeof complaint->text) {
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(complaint->text + used, sizeof complaint->text - used, format, arguments);
        va_end(arguments);
    }
}

static int by_place(const void *left, const void *right) {
    const haft_complaint *a = left, *b = right;
    if (a->mark.line != b->mark.line) {
        return a->mark.line < b->mark.line ? -1 : 1;
    }
    if (a->mark.column != b->mark.column) {
        return a->mark.column < b->mark.column ? -1 : 1;
    }
    return strcmp(a->text, b->text);
}

haft_status haft_case_report(haft_case_reader *reader, const char *file, haft_error *error) {
    size_t kept =
        reader->complaints < HAFT_COMPLAINTS_MAX ? reader->complaints : HAFT_COMPLAINTS_MAX;
    qsort(reader->complaint, kept, sizeof *reader->complaint, by_place);
    enum { TAIL = 32 }; /* room for "and N more" */
    size_t told = 0;
    for (bool fits = true; fits && told < kept; told += fits) {
        const haft_complaint *complaint = &reader->complaint[told];
        if (told == 0) {
            haft_error_set(error, HAFT_ERROR_INPUT, "%s:%zu:%zu: %s", file, complaint->mark.line,
                           complaint->mark.column, complaint->text);
        } else {
            fits = haft_error_add(error, TAIL, "%s:%zu:%zu: %s", file, complaint->mark.line,
                                  complaint->mark.column, complaint->text);
        }
    }
    if (told < reader->complaints) {
        haft_error_add(error, 0, "and %zu more", reader->complaints - told);
    }
    return HAFT_ERROR_INPUT;
}

/* Levenshtein distance between words of at most HAFT_KEY_CAPACITY characters. */
static size_t edit_distance(const char *a, const char *b) {
    size_t row[HAFT_KEY_CAPACITY + 1];
    size_t n = strlen(b);
    for (size_t j = 0; j <= n; j++) {
        row[j] = j;
    }
    for (size_t i = 1; a[i - 1] != '\0'; i++) {
        size_t corner = row[0];
        row[0] = i;
        for (size_t j = 1; j <= n; j++) {
            size_t best = corner + (a[i - 1] != b[j - 1]);
            corner = row[j];
            best = best < row[j - 1] + 1 ? best : row[j - 1] + 1;
            row[j] = best < row[j] + 1 ? best : row[j] + 1;
        }
    }
    return row[n];
}

const char *haft_case_nearest(const char *word, const char *const *words, size_t n) {
    size_t length = strlen(word);
    if (length > HAFT_KEY_CAPACITY) {
        return NULL;
    }
    const char *nearest = NULL;
    size_t least = length / 3 > 2 ? length / 3 + 1 : 3; /* more edits are no likely typing error */
    for (size_t i = 0; i < n; i++) {
        size_t distance =
            strlen(words[i]) > HAFT_KEY_CAPACITY ? SIZE_MAX : edit_distance(word, words[i]);
        if (distance < least) {
            least = distance;
            nearest = words[i];
        }
    }
    return nearest;
}
