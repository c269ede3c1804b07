/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Header lines of text maps, as Gwyddion (in the languages it speaks), SPIP, WSxM and others write
 * them: "# Width: 10 um", "# x-length = 10000", "X Amplitude: 10 um", and lines that name the
 * columns, "x [um], y [um], z [nm]". Their lengths and units are used, and the options must not
 * contradict them. */
#include "map_text.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

enum { TEXT_CAPACITY = 256, WORD_CAPACITY = 64 };

typedef enum key {
    SIDE_X,
    SIDE_Y,
    LATERAL_X,
    LATERAL_Y,
    LATERAL,
    UNIT,
    BIT,
    PIXELS_X,
    PIXELS_Y,
    CHANNEL,
    KEYS
} key;

/* Names of keys, in lower case, without blanks, '-' and '_'. */
static const char *const names[KEYS][16] = {
    [SIDE_X] = {"width", "breite", "largeur", "larghezza", "anchura", "largura",
                "\xc5\xa0\xc3\xad\xc5\x99ka", "\xd0\xa8\xd0\xb8\xd1\x80\xd0\xb8\xd0\xbd\xd0\xb0",
                "\xe5\xb9\x85", "\xed\x8f\xad", "xlength", "xamplitude"},
    [SIDE_Y] = {"height", "h\xc3\xb6he", "h\xf6he", "hoehe", "hauteur", "altezza", "altura",
                "v\xc3\xbd\xc5\xa1ka", "\xd0\x92\xd1\x8b\xd1\x81\xd0\xbe\xd1\x82\xd0\xb0",
                "\xe9\xab\x98\xe3\x81\x95", "\xeb\x86\x92\xec\x9d\xb4", "ylength", "yamplitude"},
    [LATERAL_X] = {"xunit", "xunits", "unitx", "xeinheit", "xeinheiten"},
    [LATERAL_Y] = {"yunit", "yunits", "unity", "yeinheit", "yeinheiten"},
    [LATERAL] = {"lateralunit", "lateralunits", "xyunit", "xyunits", "lateraleinheit",
                 "lateraleinheiten", "lateraleeinheit", "lateraleeinheiten", "xyeinheit",
                 "xyeinheiten", "unit\xc3\xa9slat\xc3\xa9rales", "later\xc3\xa1ln\xc3\xadjednotky"},
    [UNIT] = {"valueunit", "valueunits", "zunit", "zunits", "werteinheit", "werteinheiten",
              "einheiten", "zeinheit", "zeinheiten", "jednotkyhodnot", "unit\xc3\xa9s",
              "unit\xc3\xa0valore", "unidadesdevalor", "unitdata", "heightunit", "heightunits"},
    [BIT] = {"bit2nm"},
    [PIXELS_X] = {"xpixels", "xres", "nx"},
    [PIXELS_Y] = {"ypixels", "yres", "ny"},
    [CHANNEL] = {"channel", "kanal", "kan\xc3\xa1l", "canal", "canale"},
};

/* ---- a line ---- */

/* Copies a line with all blanks as plain spaces and none at its ends; cuts a very long one. */
static void copy_plain(char text[TEXT_CAPACITY], const char *line) {
    size_t used = 0;
    for (size_t n = 0; line[n] != '\0' && used + 1 < TEXT_CAPACITY;) {
        size_t blank = haft_text_blank(line + n);
        bool latin = line[n] == '\xa0' && n > 0 && (unsigned char)line[n - 1] < 0x80;
        text[used] = blank > 0 || latin ? ' ' : line[n];
        used += used > 0 || text[used] != ' ';
        n += blank > 0 ? blank : 1;
    }
    while (used > 0 && text[used - 1] == ' ') {
        used--;
    }
    text[used] = '\0';
}

/* The length of a remark mark and the blanks after it. Words for a missing height may begin with
 * the same character. */
static size_t skip_mark(const char *text) {
    static const char *const missing[] = {"#n/a", "#na", "#n/v"};
    for (size_t k = 0; k < sizeof missing / sizeof *missing; k++) {
        size_t n = strlen(missing[k]);
        if (strncasecmp(text, missing[k], n) == 0 && !isalnum((unsigned char)text[n])) {
            return 0;
        }
    }
    size_t n = strspn(text, "#%");
    return n > 0 ? n + strspn(text + n, " ") : 0;
}

/* The key of "name: value" or "name = value", KEYS if none; *value is the text after it. */
static key find_key(const char *text, const char **value) {
    char name[WORD_CAPACITY];
    size_t n = strcspn(text, ":="), used = 0, sign = 1;
    const char *wide = strstr(text, "\xef\xbc\x9a"); /* a full-width colon */
    if (wide != NULL && (size_t)(wide - text) < n) {
        n = (size_t)(wide - text);
        sign = 3;
    }
    if (text[n] == '\0' || n >= sizeof name) {
        return KEYS;
    }
    for (size_t i = 0; i < n; i++) {
        if (strchr(" -_", text[i]) == NULL) {
            name[used++] = text[i];
        }
    }
    name[used] = '\0';
    *value = text + n + sign + strspn(text + n + sign, " ");
    for (int k = 0; k < KEYS; k++) {
        for (size_t i = 0; i < 16 && names[k][i] != NULL; i++) {
            if (strcasecmp(name, names[k][i]) == 0) {
                return (key)k;
            }
        }
    }
    return KEYS;
}

/* Takes a unit without brackets or quotes; "" if there is none. False for more than one word. */
static bool take_word(const char *text, char word[WORD_CAPACITY]) {
    text += strspn(text, " [(\"'");
    size_t n = strcspn(text, " ])\"'");
    if (n >= WORD_CAPACITY || text[n + strspn(text + n, " ])\"'")] != '\0') {
        return false;
    }
    memcpy(word, text, n);
    word[n] = '\0';
    return true;
}

/* ---- the value of a key ---- */

static haft_status wrong(const haft_map_file *file, size_t line, const char *what, const char *text,
                         haft_error *error) {
    char quoted[48];
    return haft_error_set(error, HAFT_ERROR_INPUT, "%s:%zu: %s \"%s\"", file->path, line, what,
                          haft_map_quote(quoted, text, strlen(text)));
}

static haft_status say(haft_map_said *said, haft_map_said next, const haft_map_file *file,
                       haft_error *error) {
    if (said->value > 0 && said->value != next.value) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s:%zu: the header contradicts its line %zu: %g m, and there %g m; "
                              "is this a second map? Give one map a file",
                              file->path, next.line, said->line, next.value, said->value);
    }
    *said = next;
    return HAFT_OK;
}

/* Reads "12,34 um", or only a number if the key allows it. */
static bool read_length(const char *text, haft_map_said *said) {
    char number[WORD_CAPACITY], unit[WORD_CAPACITY];
    double factor = 0;
    size_t n = strspn(text, "+-.,0123456789eE");
    if (n == 0 || n >= sizeof number || !take_word(text + n, unit)) {
        return false;
    }
    memcpy(number, text, n);
    number[n] = '\0';
    char *comma = strchr(number, ',');
    if (comma != NULL) {
        *comma = '.';
    }
    said->bare = unit[0] == '\0';
    if (!haft_number_read(number, &factor) || !(factor > 0)) {
        return false;
    }
    said->value = factor;
    return said->bare || (haft_map_length(factor, unit, &said->value) && said->value > 0);
}

static haft_status read_side(haft_map_title *t, int side, const char *text, bool bare,
                             size_t number, const haft_map_file *file, haft_error *error) {
    haft_map_said said = {.line = number};
    if (!read_length(text, &said) || (said.bare && !bare)) {
        return wrong(file, number,
                     side == 0 ? "the width is no length, as in \"# Width: 10 um\", but"
                               : "the height is no length, as in \"# Height: 10 um\", but",
                     text, error);
    }
    return say(&t->side[side], said, file, error);
}

/* Reads a unit of length; a header may leave it empty. */
static haft_status read_unit(haft_map_said *said, const char *text, bool heights, size_t number,
                             const haft_map_file *file, haft_error *error) {
    char word[WORD_CAPACITY] = "";
    haft_map_said next = {.line = number};
    bool one = take_word(text, word);
    if (one && word[0] == '\0') {
        return HAFT_OK;
    }
    if (!one || !haft_map_length(1, word, &next.value)) {
        return wrong(file, number,
                     heights ? "the values are no heights but in" : "x and y are no lengths but in",
                     text, error);
    }
    return say(said, next, file, error);
}

static haft_status read_pixels(haft_map_title *t, int side, const char *text, size_t number,
                               const haft_map_file *file, haft_error *error) {
    double count = 0;
    if (!haft_number_read(text, &count) || !(count >= 1) || count > 1e9 || count != round(count)) {
        return wrong(file, number, "the number of pixels is none:", text, error);
    }
    if (t->pixels[side] > 0 && t->pixels[side] != (size_t)count) {
        return wrong(file, number,
                     "the header contradicts itself: it has another number of pixels,", text,
                     error);
    }
    t->pixels[side] = (size_t)count;
    t->pixels_line[side] = number;
    return HAFT_OK;
}

/* Reads SPIP's factor from numbers to nm. */
static haft_status read_bit(haft_map_title *t, const char *text, size_t number,
                            const haft_map_file *file, haft_error *error) {
    haft_map_said said = {.line = number};
    if (!read_length(text, &said) || !said.bare) {
        return wrong(file, number, "the height of a bit in nm is no positive number but", text,
                     error);
    }
    said.value *= 1e-9;
    return said.value > 0 ? say(&t->bit, said, file, error)
                          : wrong(file, number, "the height of a bit is too small:", text, error);
}

static haft_status read_value(haft_map_title *t, key k, bool bare, const char *value, size_t number,
                              const haft_map_file *file, haft_error *error) {
    haft_status status;
    switch (k) {
    case SIDE_X:
    case SIDE_Y:
        return read_side(t, k == SIDE_Y, value, bare, number, file, error);
    case LATERAL_X:
    case LATERAL_Y:
        return read_unit(&t->lateral[k == LATERAL_Y], value, false, number, file, error);
    case LATERAL:
        status = read_unit(&t->lateral[0], value, false, number, file, error);
        return status != HAFT_OK ? status
                                 : read_unit(&t->lateral[1], value, false, number, file, error);
    case UNIT:
        return read_unit(&t->unit, value, true, number, file, error);
    case BIT:
        return read_bit(t, value, number, file, error);
    case PIXELS_X:
    case PIXELS_Y:
        return read_pixels(t, k == PIXELS_Y, value, number, file, error);
    case CHANNEL:
        haft_map_name(t->channel, value, strlen(value));
        return HAFT_OK;
    case KEYS:
        break;
    }
    return HAFT_OK;
}

/* ---- names of columns ---- */

/* Finds the units in "x [um], y [um], z [nm]", "X(nm) Y(nm) Z(nm)" or "x,y,z"; "" for none. */
static bool find_columns(const char *text, char unit[3][WORD_CAPACITY]) {
    for (int k = 0; k < 3; k++) {
        text += strspn(text, " \"");
        if (tolower((unsigned char)*text) != "xyz"[k]) {
            return false;
        }
        text += 1 + strspn(text + 1, " ");
        unit[k][0] = '\0';
        const char *close = *text == '['   ? strchr(text, ']')
                            : *text == '(' ? strchr(text, ')')
                                           : NULL;
        if (close != NULL) {
            size_t n = (size_t)(close - text) - 1;
            if (n >= WORD_CAPACITY) {
                return false;
            }
            memcpy(unit[k], text + 1, n);
            unit[k][n] = '\0';
            text = close + 1;
        } else if (isalnum((unsigned char)*text) &&
                   (k == 2 || "xyz"[k + 1] != tolower((unsigned char)*text))) {
            return false;
        }
        text += strspn(text, " \"");
        text += k < 2 && (*text == ',' || *text == ';');
    }
    return *text == '\0';
}

static haft_status read_columns(haft_map_title *t, char unit[3][WORD_CAPACITY], size_t number,
                                const haft_map_file *file, haft_error *error) {
    t->points = true;
    for (int k = 0; k < 3; k++) {
        HAFT_TRY(
            read_unit(k < 2 ? &t->lateral[k] : &t->unit, unit[k], k == 2, number, file, error));
    }
    return HAFT_OK;
}

/* ---- a whole line ---- */

/* Whether a line is a header line without a mark, as some kinds of files have. */
static bool is_loose(haft_map_title *t, const char *text) {
    t->loose = t->loose || strncmp(text, "WSxM file", 9) == 0;
    bool named = *text == '[' || strncmp(text, "WSxM", 4) == 0 ||
                 (isalpha((unsigned char)*text) && strpbrk(text, ":=") != NULL);
    return (t->loose && named) || strncasecmp(text, "sep=", 4) == 0;
}

haft_status haft_map_read_title(haft_map_title *title, const haft_map_file *file, size_t number,
                                const char *line, bool first, bool *is_title, bool *known,
                                haft_error *error) {
    char text[TEXT_CAPACITY], unit[3][WORD_CAPACITY];
    const char *value = NULL, *begin = line + strspn(line, " \t");
    *is_title = *known = false;
    if (isdigit((unsigned char)*begin) || (*begin == '-' && isdigit((unsigned char)begin[1]))) {
        return HAFT_OK; /* a row of numbers, as most lines are */
    }
    copy_plain(text, line);
    size_t mark = skip_mark(text);
    key k = find_key(text + mark, &value);
    bool columns = find_columns(text + mark, unit);
    bool loose = mark == 0 && is_loose(title, text);
    *known = k != KEYS || columns || strncmp(text + mark, "WSxM file", 9) == 0;
    *is_title = mark > 0 || loose || *known;
    if (*is_title && !first) {
        return HAFT_OK; /* a header line after numbers is not about them */
    }
    title->titled = title->titled || *is_title;
    if (columns) {
        return read_columns(title, unit, number, file, error);
    }
    bool bare = strchr("xyXY", text[mark]) != NULL; /* "x-length = 1000" is in nm */
    return k != KEYS ? read_value(title, k, bare, value, number, file, error) : HAFT_OK;
}

/* ---- options ---- */

static haft_status compare(haft_map_said said, double given, double tolerance, const char *what,
                           const haft_map_file *file, haft_error *error) {
    if (!(said.value > 0) || !(given > 0) || fabs(given - said.value) <= tolerance * said.value) {
        return HAFT_OK;
    }
    return haft_error_set(error, HAFT_ERROR_INPUT,
                          "%s:%zu: the header says that %s is %g m, but %g m is given beside the "
                          "file; leave that out, or mend the header",
                          file->path, said.line, what, said.value, given);
}

haft_status haft_map_settle_title(haft_map_title *t, const haft_map_file *file, haft_error *error) {
    const haft_map_options *o = &file->options;
    const double size[2] = {o->width, o->height};
    static const char *const sides[] = {"the width", "the height"};
    if (t->bit.value > 0 && t->unit.value > 0 && t->bit.value != 1e-9) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "%s:%zu: the header gives heights both by a unit (line %zu) and by the "
            "height of a bit; leave one out",
            file->path, t->bit.line, t->unit.line);
    }
    t->unit = t->bit.value > 0 && !(t->unit.value > 0) ? t->bit : t->unit;
    haft_status status = compare(t->unit, o->unit, 1e-9, "the unit of heights", file, error);
    for (int k = 0; k < 2 && status == HAFT_OK; k++) {
        if (t->side[k].bare) {
            t->side[k].value *= t->lateral[k].value > 0 ? t->lateral[k].value : 1e-9;
            t->side[k].bare = false;
        }
        /* sizes in headers are rounded */
        status = compare(t->side[k], size[k], 0.01, sides[k], file, error);
        HAFT_THEN(status, compare(t->lateral[k], o->lateral_unit, 1e-9, "the unit of x and y", file,
                                  error));
    }
    return status;
}
