/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The height per step of a Nanoscope map's integers.
 *
 * A height is raw / 2^bits times the hard value at the end of "@2:Z scale: V [Sens. Zsens] (0.006
 * V/LSB) 440 V" times the sensitivity that the brackets name, "@Sens. Zsens: V 10 nm/V"; without
 * brackets the hard value is itself a length. The (V/LSB) is the instrument's, and differs from
 * hard / 2^bits if an image was stored with its own range. From version 9.2 on, some files have
 * 32-bit integers and still say "Bytes/pixel: 2": then (V/LSB) decides between the two powers. Old
 * headers give "Z scale: 200 nm" for the whole 16-bit range; the oldest, without a version, give "Z
 * magnify image" in nanometres for 655.36 steps. */
#include "map_nanoscope.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NAME = 96, UNIT = 24 };

/* "V [soft] (step unit/LSB) hard unit"; missing parts are empty or 0. */
typedef struct quantity {
    char soft[NAME], unit[UNIT];
    double step, hard;
} quantity;

static const char *skip_blanks(const char *text) {
    return text + strspn(text, " \t");
}

/* Takes a word; false if it is too long. */
static bool take_word(const char **text, char *word, size_t capacity) {
    size_t n = strcspn(*text, " \t");
    if (n >= capacity) {
        return false;
    }
    memcpy(word, *text, n);
    word[n] = '\0';
    *text = skip_blanks(*text + n);
    return true;
}

/* Skips "(0.006 V/LSB)", in which parentheses may nest. */
static bool take_step(const char **text, double *step) {
    const char *at = *text;
    int depth = 0;
    if (*at != '(') {
        return true;
    }
    if (haft_number_scan(skip_blanks(at + 1), step) == 0 || !isfinite(*step)) {
        return false;
    }
    do {
        depth += *at == '(' ? 1 : *at == ')' ? -1 : 0;
        at++;
    } while (depth > 0 && *at != '\0');
    *text = skip_blanks(at);
    return depth == 0;
}

static bool read_quantity(quantity *q, const char *text) {
    char number[UNIT];
    *q = (quantity){.step = 0};
    text = skip_blanks(text);
    if (*text == 'V' && isspace((unsigned char)text[1])) {
        text = skip_blanks(text + 1);
    }
    if (*text == '[') {
        size_t n = strcspn(text, "]");
        if (text[n] == '\0' || n - 1 >= sizeof q->soft) {
            return false;
        }
        memcpy(q->soft, text + 1, n - 1);
        text = skip_blanks(text + n + 1);
    }
    return take_step(&text, &q->step) && take_word(&text, number, sizeof number) &&
           haft_number_read(number, &q->hard) && q->hard > 0 &&
           take_word(&text, q->unit, sizeof q->unit) && *text == '\0';
}

/* The share of the hard scale per step, from the bytes stored and said. */
static double step_share(const quantity *q, size_t stored, size_t said) {
    double by_said = said == 4 ? 0x1p-32 : 0x1p-16, by_stored = stored == 4 ? 0x1p-32 : 0x1p-16;
    if (by_said == by_stored || q->step == 0) {
        return by_said;
    }
    double off_said = fabs(log(fabs(q->step) / (q->hard * by_said)));
    double off_stored = fabs(log(fabs(q->step) / (q->hard * by_stored)));
    return off_stored < off_said ? by_stored : by_said;
}

/* Multiplies a hard value by a sensitivity to metres; false if their units do not give a length:
 * nm/V needs V, and nm needs a plain number. */
static bool multiply(double *length, const quantity *q, const quantity *sensitivity) {
    static const struct {
        const char *name;
        double volts;
    } known[] = {{"V", 1}, {"mV", 1e-3}, {"\xb5V", 1e-6}, {"uV", 1e-6}, {"~V", 1e-6}};
    char unit[UNIT];
    double hard = q->hard, factor = 1;
    snprintf(unit, sizeof unit, "%s", sensitivity->unit);
    char *slash = strchr(unit, '/');
    if ((slash == NULL) != (q->unit[0] == '\0')) {
        return false;
    }
    for (int k = 0; slash != NULL && k < 2; k++) {
        const char *name = k == 0 ? q->unit : slash + 1;
        size_t i = 0, n = sizeof known / sizeof *known;
        while (i < n && strcmp(known[i].name, name) != 0) {
            i++;
        }
        if (i == n) {
            return false;
        }
        hard *= k == 0 ? known[i].volts : 1;
        factor *= k == 0 ? 1 : 1 / known[i].volts;
    }
    if (slash != NULL) {
        *slash = '\0';
    }
    return haft_map_length(hard * factor * sensitivity->hard, unit, length);
}

static haft_status wrong(const haft_nanoscope *h, size_t line, const char *key, const char *value,
                         const char *what, haft_error *error) {
    char quoted[48];
    return haft_error_set(error, HAFT_ERROR_INPUT, "%s:%zu: \"%s\" is \"%s\", %s", h->file->path,
                          line, key, haft_map_quote(quoted, value, 40), what);
}

static const char no_length[] = "no z-scale in metres; choose a channel of heights";
static const char unreadable[] = "which gives no positive number; the header is damaged";

/* Reads "V [Sens. Zsens] (0.006 V/LSB) 440 V". */
static haft_status new_scale(double *scale, const haft_nanoscope *h, size_t line, const char *text,
                             size_t stored, size_t said, haft_error *error) {
    quantity q, s;
    char key[NAME + 1], value[HAFT_NANOSCOPE_VALUE], what[160];
    if (!read_quantity(&q, text)) {
        return wrong(h, line, "Z scale", text, unreadable, error);
    }
    double share = step_share(&q, stored, said), length = 0;
    if (q.soft[0] == '\0') {
        if (!haft_map_length(q.hard, q.unit, &length)) {
            return wrong(h, line, "Z scale", text, no_length, error);
        }
        *scale = share * length;
        return HAFT_OK;
    }
    snprintf(key, sizeof key, "@%s", q.soft);
    size_t where = haft_nanoscope_find_scan(h, key, value);
    if (where == 0) {
        snprintf(what, sizeof what, "and no list gives \"%.60s\": %s", key, no_length);
        return wrong(h, line, "Z scale", text, what, error);
    }
    if (!read_quantity(&s, value)) {
        return wrong(h, where, key, value, unreadable, error);
    }
    if (!multiply(&length, &q, &s)) {
        snprintf(what, sizeof what, "and the Z scale in \"%.20s\": %s", q.unit, no_length);
        return wrong(h, where, key, value, what, error);
    }
    *scale = share * length;
    return HAFT_OK;
}

/* Reads "200 nm (65536)". */
static haft_status old_scale(double *scale, const haft_nanoscope *h, size_t line, const char *text,
                             haft_error *error) {
    char number[UNIT], unit[UNIT];
    const char *at = skip_blanks(text);
    double value = 0, length = 0;
    if (!take_word(&at, number, sizeof number) || !haft_number_read(number, &value) ||
        !(value > 0)) {
        return wrong(h, line, "Z scale", text, unreadable, error);
    }
    if (!take_word(&at, unit, sizeof unit) || !haft_map_length(value, unit, &length)) {
        return wrong(h, line, "Z scale", text, no_length, error);
    }
    *scale = 0x1p-16 * length;
    return HAFT_OK;
}

haft_status haft_nanoscope_get_scale(double *scale, const haft_nanoscope *h,
                                     const haft_nanoscope_list *l, size_t stored, size_t said,
                                     haft_error *error) {
    char text[HAFT_NANOSCOPE_VALUE], version[HAFT_NANOSCOPE_VALUE];
    size_t line = haft_nanoscope_find(l, "@*:Z scale", text);
    if (line > 0) {
        return new_scale(scale, h, line, text, stored, said, error);
    }
    line = haft_nanoscope_find(l, "Z scale", text);
    if (line > 0 && haft_nanoscope_find_scan(h, "Version", version) > 0) {
        return old_scale(scale, h, line, text, error);
    }
    line = haft_nanoscope_find(l, "Z magnify image", text);
    if (line == 0) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "%s:%zu: the channel has %s", h->file->path,
                              l->line, no_length);
    }
    double magnify = 0;
    if (!haft_number_read(text, &magnify) || !(magnify > 0)) {
        return wrong(h, line, "Z magnify image", text, unreadable, error);
    }
    *scale = magnify * 1e-9 / 655.36;
    return HAFT_OK;
}
