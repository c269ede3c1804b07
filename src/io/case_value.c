/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads one value of a case from its text into its field, or complains and suggests the nearest
 * valid value. */
#include "case.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { QUANTITY_CAPACITY = 200 }; /* length of the longest text read as a quantity */

static void *field_of(haft_case_reader *reader, const haft_key *key) {
    return (char *)reader->c + key->offset;
}

static bool store_text(haft_case_reader *reader, const haft_key *key, const char *text,
                       size_t length, haft_mark mark) {
    bool name = key->type == HAFT_KEY_NAME;
    size_t capacity = name ? HAFT_NAME_CAPACITY : HAFT_TEXT_CAPACITY;
    if (length >= capacity) {
        haft_case_complain(reader, mark, key->path, "has %zu bytes; %zu is the most", length,
                           capacity - 1);
        return false;
    }
    if (name && length == 0) {
        haft_case_complain(reader, mark, key->path, "is empty; give it as in \"%s: %s\"",
                           haft_case_leaf(key->path), key->example);
        return false;
    }
    for (size_t i = 0; i < length;) {
        uint32_t code = 0;
        size_t n = haft_text_character(text + i, length - i, &code);
        if (n == 0 || !haft_text_is_printable(code)) { /* it could not be read back */
            haft_case_complain(reader, mark, key->path,
                               "holds a control character or a line break; write it on one line");
            return false;
        }
        if (name && !(code < 0x80 && (isalnum((int)code) || strchr("._-", (int)code) != NULL))) {
            haft_case_complain(reader, mark, key->path,
                               "\"%s\" is no name; use letters, digits, '.', '_' and '-'", text);
            return false;
        }
        i += n;
    }
    char *field = field_of(reader, key);
    memset(field, 0, capacity);
    memcpy(field, text, length);
    return true;
}

/* Reads an unsigned integer; complains if the text is not one or it is too large. */
static bool read_whole(haft_case_reader *reader, const haft_key *key, const char *text,
                       uint64_t *value, haft_mark mark) {
    size_t digits = strspn(text, "0123456789");
    if (digits == 0 || text[digits] != '\0') {
        haft_case_complain(reader, mark, key->path,
                           "\"%.60s\" is not a whole number >= %.0f; write it in digits as in "
                           "\"%s: %s\"",
                           text, key->type == HAFT_KEY_COUNT ? key->low : 0,
                           haft_case_leaf(key->path), key->example);
        return false;
    }
    errno = 0;
    unsigned long long number = strtoull(text, NULL, 10);
    if (errno == ERANGE) {
        haft_case_complain(reader, mark, key->path, "%.60s is too large; %llu is the most", text,
                           key->type == HAFT_KEY_COUNT ? (unsigned long long)key->high
                                                       : (unsigned long long)UINT64_MAX);
        return false;
    }
    *value = number;
    return true;
}

static bool store_whole(haft_case_reader *reader, const haft_key *key, const char *text,
                        haft_mark mark) {
    uint64_t value = 0;
    if (!read_whole(reader, key, text, &value, mark)) {
        return false;
    }
    if (key->type == HAFT_KEY_SEED) {
        memcpy(field_of(reader, key), &value, sizeof value);
        return true;
    }
    if ((double)value < key->low || (double)value > key->high) {
        haft_case_complain(reader, mark, key->path, "%s is out of range; give %.0f to %.0f", text,
                           key->low, key->high);
        return false;
    }
    size_t count = (size_t)value;
    memcpy(field_of(reader, key), &count, sizeof count);
    return true;
}

/* Describes the allowed range: "above 0 and below 0.5 Pa". */
static void describe_range(const haft_key *key, char *text, size_t size) {
    const char *unit = strcmp(key->unit, "1") == 0 ? "" : key->unit;
    const char *space = *unit == '\0' ? "" : " ";
    int n = snprintf(text, size, "%s %.6g%s%s", key->low_in ? "at least" : "above", key->low, space,
                     unit);
    if (isfinite(key->high) && n > 0 && (size_t)n < size) {
        snprintf(text + n, size - (size_t)n, " and %s %.6g%s%s", key->high_in ? "at most" : "below",
                 key->high, space, unit);
    }
}

/* Complains of a number that is out of range, and suggests what the user may have meant. */
static void complain_of_range(haft_case_reader *reader, const haft_key *key, const char *text,
                              double value, haft_mark mark) {
    char range[96];
    describe_range(key, range, sizeof range);
    if (strcmp(key->path, "contact.capillary.humidity") == 0) {
        bool percent = value > 1 && value < 100 && strchr(text, '%') == NULL;
        haft_case_complain(reader, mark, key->path,
                           "\"%s\" is out of range: water condenses only above 0 %% and below "
                           "100 %%; %s%s%s leave contact.capillary out for dry contact",
                           text, percent ? "write \"" : "", percent ? text : "",
                           percent ? " %\", or" : "give such a humidity, or");
        return;
    }
    haft_case_complain(reader, mark, key->path,
                       "\"%s\" is out of range; give a value %s, such as "
                       "%s",
                       text, range, key->example);
}

/* Spells "deg" as "degree", the only form that UDUNITS-2 knows. */
static void spell_degrees(const haft_key *key, const char *text,
                          char spelled[QUANTITY_CAPACITY + sizeof "ree"]) {
    size_t length = strlen(text);
    bool degrees = strcmp(key->unit, "rad") == 0 && length > 3 &&
                   strcmp(text + length - 3, "deg") == 0 &&
                   !isalpha((unsigned char)text[length - 4]);
    snprintf(spelled, QUANTITY_CAPACITY + sizeof "ree", "%s%s", text, degrees ? "ree" : "");
}

/* Complains of a quantity and adds an example, unless the failure is of memory or a library. */
static void complain_of_quantity(haft_case_reader *reader, const haft_key *key,
                                 const haft_error *problem, haft_mark mark) {
    if (problem->status == HAFT_ERROR_MEMORY || problem->status == HAFT_ERROR_LIBRARY) {
        haft_error_set(reader->error, problem->status, "%s: %s", reader->path, problem->message);
        reader->failure = problem->status;
        return;
    }
    haft_case_complain(reader, mark, key->path, "%s%s \"%s: %s\"", problem->message,
                       strchr(problem->message, ';') != NULL ? ", as in" : "; write it as in",
                       haft_case_leaf(key->path), key->example);
}

static bool store_real(haft_case_reader *reader, const haft_key *key, size_t entry,
                       const char *text, size_t length, haft_mark mark) {
    if (length > QUANTITY_CAPACITY) {
        haft_case_complain(reader, mark, key->path,
                           "is %zu characters long; give a quantity such as %s", length,
                           key->example);
        return false;
    }
    char spelled[QUANTITY_CAPACITY + sizeof "ree"];
    spell_degrees(key, text, spelled);
    haft_error problem = {0};
    double value = 0;
    haft_status status = haft_units_parse(reader->units, spelled, key->unit, &value, &problem);
    if (status != HAFT_OK) {
        complain_of_quantity(reader, key, &problem, mark);
        return false;
    }
    bool inside = (key->low_in ? value >= key->low : value > key->low) &&
                  (key->high_in ? value <= key->high : value < key->high);
    if (!inside) {
        complain_of_range(reader, key, text, value, mark);
        return false;
    }
    value += 0.0; /* no negative zero */
    memcpy((double *)field_of(reader, key) + entry, &value, sizeof value);
    return true;
}

static bool store_choice(haft_case_reader *reader, const haft_key *key, const char *text,
                         haft_mark mark) {
    char all[160] = "";
    size_t used = 0;
    int n = 0;
    for (; key->choices[n] != NULL; n++) {
        if (strcmp(key->choices[n], text) == 0) {
            memcpy(field_of(reader, key), &n, sizeof n);
            return true;
        }
        int wrote =
            snprintf(all + used, sizeof all - used, "%s%s", n > 0 ? " or " : "", key->choices[n]);
        used += wrote < 0 ? 0 : (size_t)wrote;
        used = used < sizeof all ? used : sizeof all - 1;
    }
    const char *nearest = haft_case_nearest(text, key->choices, (size_t)n);
    haft_case_complain(reader, mark, key->path, "\"%.60s\" is no choice; %s%s%sgive %s", text,
                       nearest != NULL ? "did you mean " : "", nearest != NULL ? nearest : "",
                       nearest != NULL ? "? " : "", all);
    return false;
}

/* Stores one entry of the list of realizations; the caller has allocated the list. */
static bool store_evidence(haft_case_reader *reader, const haft_key *key, size_t entry,
                           const char *text, haft_mark mark) {
    uint64_t value = 0;
    if (!read_whole(reader, key, text, &value, mark)) {
        return false;
    }
    for (size_t i = 0; i < entry; i++) {
        if (reader->c->evidence.realization[i] == value) {
            haft_case_complain(reader, mark, key->path, "names realization %s twice; leave one out",
                               text);
            return false;
        }
    }
    reader->c->evidence.realization[entry] = (size_t)value;
    reader->evidence_mark[entry] = mark;
    reader->c->evidence.count = entry + 1;
    return true;
}

/* Whether a path is UTF-8. If it is not, it cannot be written into a resolved case. */
static bool is_text(const char *text) {
    size_t size = strlen(text);
    for (size_t i = 0, n; i < size; i += n) {
        uint32_t code = 0;
        n = haft_text_character(text + i, size - i, &code);
        if (n == 0) {
            return false;
        }
    }
    return true;
}

/* Stores the path of a file; a relative path starts from the folder of the case. */
static bool store_file(haft_case_reader *reader, const haft_key *key, size_t entry,
                       const char *text, haft_mark mark) {
    haft_case_files *files = field_of(reader, key);
    const char *slash = strrchr(reader->path, '/');
    int folder = text[0] == '/' || slash == NULL ? 0 : (int)(slash - reader->path) + 1;
    char joined[HAFT_PATH_CAPACITY];
    int n = snprintf(joined, sizeof joined, "%.*s%s", folder, reader->path, text);
    errno = 0;
    char *whole = n > 0 && n < HAFT_PATH_CAPACITY ? realpath(joined, NULL) : NULL;
    if (whole == NULL && errno == ENOMEM) {
        reader->failure = haft_error_set(reader->error, HAFT_ERROR_MEMORY,
                                         "%s: out of memory for a path", reader->path);
        return false;
    }
    if (whole != NULL && !is_text(whole)) {
        haft_case_complain(reader, mark, key->path,
                           "lies in a folder, or is a file, whose name is not UTF-8; rename it");
        free(whole);
        return false;
    }
    if (whole == NULL || strlen(whole) >= HAFT_PATH_CAPACITY) {
        haft_case_complain(reader, mark, key->path,
                           "there is no file %.300s; give a path from the "
                           "case's folder",
                           joined);
        free(whole);
        return false;
    }
    snprintf(files->path[entry], HAFT_PATH_CAPACITY, "%s", whole);
    free(whole);
    files->count = entry + 1;
    return true;
}

/* Strips blanks at both ends, which quotes and no-break spaces can leave. */
static void trim(char trimmed[QUANTITY_CAPACITY + 1], const char *text, size_t *length) {
    size_t used = 0, last = 0, blank;
    for (size_t n = 0; n<*length; n += blank> 0 ? blank : 1) {
        blank = haft_text_blank(text + n);
        for (size_t k = 0; k < (blank > 0 ? blank : 1) && (used > 0 || blank == 0); k++) {
            trimmed[used++] = text[n + k];
        }
        last = blank > 0 ? last : used;
    }
    trimmed[last] = '\0';
    *length = last;
}

double haft_case_number(const haft_case *c, const haft_key *key) {
    const char *field = (const char *)c + key->offset;
    double real;
    size_t count;
    uint64_t seed;
    int choice;
    switch (key->type) {
    case HAFT_KEY_REAL:
        memcpy(&real, field, sizeof real);
        return real;
    case HAFT_KEY_COUNT:
        memcpy(&count, field, sizeof count);
        return (double)count;
    case HAFT_KEY_SEED:
        memcpy(&seed, field, sizeof seed);
        return (double)seed;
    case HAFT_KEY_CHOICE:
        memcpy(&choice, field, sizeof choice);
        return choice;
    default:
        return NAN;
    }
}

bool haft_case_store(haft_case_reader *reader, int index, size_t entry, const char *text,
                     size_t length, haft_mark mark) {
    const haft_key *key = &haft_case_keys[index];
    if (memchr(text, 0, length) != NULL) {
        haft_case_complain(reader, mark, key->path, "holds a NUL character; take it out");
        return false;
    }
    char trimmed[QUANTITY_CAPACITY + 1];
    bool plain =
        key->type != HAFT_KEY_TEXT && key->type != HAFT_KEY_NAME && key->type != HAFT_KEY_FILES;
    if (plain && length <= QUANTITY_CAPACITY) {
        trim(trimmed, text, &length);
        text = trimmed;
    }
    if (length == 0 && key->type != HAFT_KEY_TEXT && key->type != HAFT_KEY_NAME) {
        haft_case_complain(reader, mark, key->path, "has no value; give it as in \"%s: %s\"",
                           haft_case_leaf(key->path), key->example);
        return false;
    }
    switch (key->type) {
    case HAFT_KEY_NAME:
    case HAFT_KEY_TEXT:
        return store_text(reader, key, text, length, mark);
    case HAFT_KEY_SEED:
    case HAFT_KEY_COUNT:
        return store_whole(reader, key, text, mark);
    case HAFT_KEY_REAL:
        return store_real(reader, key, entry, text, length, mark);
    case HAFT_KEY_CHOICE:
        return store_choice(reader, key, text, mark);
    case HAFT_KEY_EVIDENCE:
        return store_evidence(reader, key, entry, text, mark);
    case HAFT_KEY_FILES:
        return store_file(reader, key, entry, text, mark);
    }
    return false;
}

bool haft_case_is_sound(const haft_case_reader *reader, const char *path) {
    int key = haft_case_find_key(path);
    return key >= 0 && (reader->state[key] == HAFT_GOOD || reader->state[key] == HAFT_DEFAULTED);
}

bool haft_case_is_given(const haft_case_reader *reader, const char *path) {
    int key = haft_case_find_key(path);
    return key >= 0 && reader->state[key] == HAFT_GOOD;
}
