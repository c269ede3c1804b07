/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads quantities from the options of haft-laws inspect. */
#include "inspect_words.h"

#include <stdio.h>
#include <string.h>

enum { SIDE_CAPACITY = 120 };

haft_status words_read_length(double *value, const haft_units *units, const char *option,
                              const char *text, const char *example, haft_error *error) {
    if (text == NULL) {
        return HAFT_OK;
    }
    haft_error own = {0};
    double length = 0;
    haft_status status = haft_units_parse(units, text, "m", &length, &own);
    if (status == HAFT_ERROR_MEMORY) {
        return haft_error_set(error, status, "%s", own.message);
    }
    if (status != HAFT_OK || !(length > 0)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "--%s \"%.80s\" is no positive length%s%s; give it as %s", option,
                              text, status != HAFT_OK ? ": " : "", own.message, example);
    }
    *value = length;
    return HAFT_OK;
}

/* Finds the sign between width and height; *n is its length in bytes. NULL if there is none. */
static const char *find_cross(const char *text, size_t *n) {
    static const char TIMES[] = "\xc3\x97";
    size_t at = strcspn(text, "xX*");
    const char *times = strstr(text, TIMES);
    bool first = times != NULL && (size_t)(times - text) < at;
    *n = first ? strlen(TIMES) : 1;
    return first ? times : text[at] != '\0' ? text + at : NULL;
}

/* Skips the number at the beginning of a text, and the blanks before and after it. */
static const char *skip_number(const char *text) {
    double number = 0;
    size_t n = 0, blank;
    while ((blank = haft_text_blank(text + n)) > 0) {
        n += blank;
    }
    n += haft_number_scan(text + n, &number);
    while ((blank = haft_text_blank(text + n)) > 0) {
        n += blank;
    }
    return text + n;
}

haft_status words_read_size(double size[2], const haft_units *units, const char *text,
                            haft_error *error) {
    if (text == NULL) {
        return HAFT_OK;
    }
    size_t cross = 0;
    const char *at = find_cross(text, &cross);
    char width[2 * SIDE_CAPACITY] = "", height[SIDE_CAPACITY] = "";
    if (at == NULL || (size_t)(at - text) >= SIDE_CAPACITY || strlen(at + cross) >= SIDE_CAPACITY) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "--size \"%.80s\" is no width and height; give it as \"10 um x 5 um\"", text);
    }
    snprintf(height, sizeof height, "%s", at + cross);
    snprintf(width, sizeof width, "%.*s", (int)(at - text), text);
    if (*skip_number(width) == '\0') { /* "10 x 5 um": one unit for both */
        snprintf(width, sizeof width, "%.*s %s", (int)(at - text), text, skip_number(height));
    }
    static const char example[] = "\"10 um x 5 um\"";
    haft_status status = words_read_length(&size[0], units, "size", width, example, error);
    return status != HAFT_OK ? status
                             : words_read_length(&size[1], units, "size", height, example, error);
}

haft_status words_read_unit(double *unit, const haft_units *units, const char *option,
                            const char *text, haft_error *error) {
    char quantity[SIDE_CAPACITY + 2] = "";
    if (text == NULL) {
        return HAFT_OK;
    }
    if (strlen(text) >= SIDE_CAPACITY) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "--%s has %zu characters; give a unit such as nm", option,
                              strlen(text));
    }
    bool bare = strpbrk(text, "0123456789") == NULL;
    snprintf(quantity, sizeof quantity, "%s%s", bare ? "1 " : "", text);
    return words_read_length(unit, units, option, quantity, "nm", error);
}
