/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Quantities with units. The grammar of UDUNITS-2 accepts far more than plain units: factors ("nm
 * 2"), origins ("nm since 1990", "K @ 20"), logarithms. So the number and the syntax of the unit
 * are checked here, and the library only converts plain units. Its own messages, which go to
 * standard error by default, are turned off. */
#include "haft/base.h"

#include <ctype.h>
#include <errno.h>
#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <udunits2.h>

enum { UNIT_CAPACITY = 128 };

struct haft_units {
    ut_system *system;
    locale_t plain; /* C; the library reads the numbers of its database in the current locale */
};

haft_status haft_units_create(haft_units **out, haft_error *error) {
    *out = NULL;
    haft_units *units = haft_memory_alloc(1, sizeof *units, error);
    if (units == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    units->plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (units->plain == (locale_t)0) {
        haft_memory_free(units);
        return haft_error_set(error, HAFT_ERROR_MEMORY, "out of memory for the units database");
    }
    ut_set_error_message_handler(ut_ignore);
    locale_t kept = uselocale(units->plain);
    units->system = ut_read_xml(NULL);
    ut_status why = ut_get_status();
    uselocale(kept);
    if (units->system == NULL) {
        freelocale(units->plain);
        haft_memory_free(units);
        return why == UT_OS ? haft_error_set(error, HAFT_ERROR_MEMORY,
                                             "out of memory for the units database")
                            : haft_error_set(error, HAFT_ERROR_LIBRARY,
                                             "UDUNITS-2 cannot read its units database (is "
                                             "libudunits2-data installed?)");
    }
    *out = units;
    return HAFT_OK;
}

void haft_units_destroy(haft_units **units) {
    if (units != NULL && *units != NULL) {
        ut_free_system((*units)->system);
        freelocale((*units)->plain);
        haft_memory_free(*units);
        *units = NULL;
    }
}

/* ---- the syntax of a unit ---- */

/* Length of the first of the byte sequences that `text` starts with, 0 if it starts with none. */
static size_t begins_with(const char *text, const char *const *sequences) {
    for (size_t i = 0; sequences[i] != NULL; i++) {
        size_t n = strlen(sequences[i]);
        if (strncmp(text, sequences[i], n) == 0) {
            return n;
        }
    }
    return 0;
}

static size_t skip_blanks(const char *text) {
    size_t n = 0;
    for (size_t more = 1; more > 0; n += more) {
        more = haft_text_blank(text + n);
    }
    return n;
}

/* Letters of unit names: ASCII, and micro, Omega, Angstrom and degree signs in UTF-8. */
static size_t skip_letter(const char *text) {
    static const char *const signs[] = {"\xc2\xb5", "\xce\xbc", "\xce\xa9",     "\xe2\x84\xa6",
                                        "\xc3\x85", "\xc2\xb0", "\xe2\x84\xab", "%",
                                        "_",        NULL};
    bool ascii = (*text >= 'a' && *text <= 'z') || (*text >= 'A' && *text <= 'Z');
    return ascii ? 1 : begins_with(text, signs);
}

/* "2", "-1", "^2", "^-1", or the same in superscript; 0 if there is no power. */
static size_t skip_power(const char *text) {
    static const char *const raised[] = {"\xe2\x81\xbb", "\xe2\x81\xb0", "\xc2\xb9",
                                         "\xc2\xb2",     "\xc2\xb3",     "\xe2\x81\xb4",
                                         "\xe2\x81\xb5", "\xe2\x81\xb6", "\xe2\x81\xb7",
                                         "\xe2\x81\xb8", "\xe2\x81\xb9", NULL};
    size_t n = 0;
    for (size_t more = 1; more > 0; n += more) {
        more = begins_with(text + n, raised);
    }
    if (n > 0) {
        return n;
    }
    n = *text == '^';
    n += text[n] == '-' || text[n] == '+';
    size_t digits = strspn(text + n, "0123456789");
    return digits > 0 ? n + digits : 0;
}

/* Whether UDUNITS-2 would read this word as the start of an origin. */
static bool is_origin_word(const char *text, size_t n) {
    static const char *const words[] = {"since", "after", "from", "ref", "re"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        if (strlen(words[i]) == n && strncasecmp(text, words[i], n) == 0) {
            return true;
        }
    }
    return false;
}

/* The separator between two names: blanks, a point, an asterisk or a slash. */
static size_t skip_sign(const char *text) {
    static const char *const signs[] = {"/", "*", ".", "\xc2\xb7", NULL};
    size_t before = skip_blanks(text), sign = begins_with(text + before, signs);
    return before + sign + (sign > 0 ? skip_blanks(text + before + sign) : 0);
}

/* Length of the unit name and its power at the start of `text`; 0 if there is none. */
static size_t skip_name(const char *text) {
    size_t n = 0, digits;
    for (size_t more = skip_letter(text); more > 0; more = skip_letter(text + n)) {
        n += more;
        digits = strspn(text + n, "0123456789"); /* "cmH2O" */
        n += digits > 0 && skip_letter(text + n + digits) > 0 ? digits : 0;
    }
    return n == 0 || is_origin_word(text, n) ? 0 : n + skip_power(text + n);
}

/* Checks that a text consists only of names, separators and parentheses, with no numbers but powers
 * and the 1 of "1/um". @return the place of the first error, NULL if there is none. */
static const char *find_fault(const char *text) {
    const char *at = text + (strncmp(text, "1/", 2) == 0 ? 2 : 0);
    bool per_cent = strchr(text, '%') != NULL;
    if (per_cent && text[1] != '\0') {
        return text[0] == '%' ? text + 1 : strchr(text, '%'); /* a percentage has no other unit */
    }
    size_t open = 0;
    while (true) {
        for (; *at == '('; at++) {
            open++;
        }
        size_t n = skip_name(at);
        if (n == 0) {
            return at;
        }
        at += n;
        for (; *at == ')' && open > 0; at++) {
            open--;
        }
        if (*at == '\0') {
            return open == 0 ? NULL : at;
        }
        n = skip_sign(at);
        if (n == 0) {
            return at;
        }
        at += n;
    }
}

/* Whether a unit contains radians, which UDUNITS-2 treats as dimensionless. */
static bool has_angle(const ut_unit *unit, haft_status *status) {
    char text[256] = "";
    int n = ut_format(unit, text, sizeof text, UT_ASCII | UT_DEFINITION);
    *status = n < 0 && ut_get_status() == UT_OS ? HAFT_ERROR_MEMORY : *status;
    return n > 0 && (size_t)n < sizeof text && strstr(text, "rad") != NULL;
}

/* Whether two units have the same dimension. UDUNITS-2 would also convert inverse dimensions, and
 * angles to pure numbers; both are refused here. *status reports a failed allocation. */
static bool agree(const ut_unit *from, const ut_unit *to, haft_status *status) {
    if (ut_is_dimensionless(to) && has_angle(from, status) != has_angle(to, status)) {
        return false;
    }
    ut_unit *ratio = ut_divide(from, to);
    if (ratio == NULL) {
        *status = ut_get_status() == UT_OS ? HAFT_ERROR_MEMORY : HAFT_OK;
        return false;
    }
    bool same = ut_is_dimensionless(ratio) != 0;
    ut_free(ratio);
    return same;
}

static haft_status no_memory(const char *text, haft_error *error) {
    return haft_error_set(error, HAFT_ERROR_MEMORY, "out of memory for the unit of \"%.80s\"",
                          text);
}

static haft_status convert_units(ut_unit *from, ut_unit *to, double number, const char *text,
                                 const char *wanted, double *value, haft_error *error) {
    haft_status status = HAFT_OK;
    if (!agree(from, to, &status)) {
        return status != HAFT_OK
                   ? no_memory(text, error)
                   : haft_error_set(error, HAFT_ERROR_INPUT,
                                    "\"%.80s\" has the wrong dimension; give a unit that converts "
                                    "to %s",
                                    text, strcmp(wanted, "1") == 0 ? "a pure number" : wanted);
    }
    cv_converter *converter = ut_get_converter(from, to);
    if (converter == NULL) {
        return no_memory(text, error);
    }
    *value = cv_convert_double(converter, number);
    cv_free(converter);
    return HAFT_OK;
}

static haft_status convert(const haft_units *units, double number, const char *given,
                           const char *text, const char *wanted, double *value, haft_error *error) {
    haft_status status = HAFT_OK;
    locale_t kept = uselocale(units->plain);
    ut_unit *to = ut_parse(units->system, wanted, UT_UTF8);
    bool exhausted = ut_get_status() == UT_OS;
    ut_unit *from = to != NULL && !exhausted ? ut_parse(units->system, given, UT_UTF8) : NULL;
    exhausted = exhausted || ut_get_status() == UT_OS;
    uselocale(kept);
    if (exhausted) {
        /* results of UDUNITS-2 cannot always be freed after this */
        return no_memory(text, error);
    }
    if (to == NULL) {
        status = haft_error_set(error, HAFT_ERROR_ARGUMENT, "\"%s\" is no unit", wanted);
    } else if (from == NULL) {
        status = haft_error_set(error, HAFT_ERROR_INPUT,
                                "\"%.80s\": the unit \"%.60s\" is unknown; give one that converts "
                                "to %s",
                                text, given, wanted);
    } else {
        status = convert_units(from, to, number, text, wanted, value, error);
    }
    ut_free(from);
    ut_free(to);
    return status;
}

/* ---- a quantity ---- */

/* What is wrong with the characters that follow a number; NULL if they may follow one. */
static const char *fault_of_number(const char *end) {
    if (*end == '\0') {
        return NULL;
    }
    bool more = isdigit((unsigned char)end[1]) != 0;
    return (*end == 'x' || *end == 'X') && isxdigit((unsigned char)end[1])
               ? "has a hexadecimal number; write it in decimal digits"
           : *end == ',' && more
               ? "has a comma in its number; write a decimal point, and nothing between thousands"
           : (*end == '.' && more) || ((*end == 'e' || *end == 'E') && (more || end[1] == '-'))
               ? "has a number that is none; write one decimal number, such as 1.5 or 1.5e3"
               : NULL;
}

static haft_status read_number(const char *text, double *number, const char **end,
                               haft_error *error) {
    size_t n = haft_number_scan(text, number), sign = *text == '+' || *text == '-';
    const char *what = n > 0 ? fault_of_number(text + n) : NULL;
    if (what != NULL) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "\"%.80s\" %s", text, what);
    }
    if (n == 0 && strncasecmp(text + sign, "inf", 3) != 0 &&
        strncasecmp(text + sign, "nan", 3) != 0) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "\"%.80s\" does not begin with a number",
                              text);
    }
    if (n == 0 || !isfinite(*number)) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "\"%.80s\" is not a finite number%s", text,
                              n > 0 && !isinf(*number) ? " but too small for one" : "");
    }
    *end = text + n;
    return HAFT_OK;
}

/* Checks that the text after the number, without surrounding blanks, is one plain unit. */
static haft_status check_unit(const char *given, const char *text, const char *wanted,
                              haft_error *error) {
    const char *fault = find_fault(given);
    if (fault == NULL) {
        return HAFT_OK;
    }
    bool pure = strcmp(wanted, "1") == 0;
    bool number = isdigit((unsigned char)*fault) != 0;
    return haft_error_set(error, HAFT_ERROR_INPUT,
                          "\"%.80s\" is not one number and one unit: \"%.40s\" is %s; write one "
                          "decimal number and %s%s",
                          text, *fault != '\0' ? fault : given,
                          number           ? "a second number"
                          : *fault != '\0' ? "no part of a unit"
                                           : "cut short",
                          pure ? "at most a %" : "a unit that converts to ", pure ? "" : wanted);
}

/* Copies the unit, with a space for each blank and without trailing blanks. @return its length in
 * the text, without trailing blanks */
static size_t copy_unit(char given[UNIT_CAPACITY], const char *text) {
    size_t length = 0, used = 0, n = 0;
    while (text[n] != '\0') {
        size_t blank = haft_text_blank(text + n);
        if (used + 1 < UNIT_CAPACITY) {
            given[used++] = blank > 0 ? ' ' : text[n];
        }
        n += blank > 0 ? blank : 1;
        length = blank > 0 ? length : n;
    }
    while (used > 0 && given[used - 1] == ' ') {
        used--;
    }
    given[used] = '\0';
    return length;
}

haft_status haft_units_parse(const haft_units *units, const char *text, const char *unit,
                             double *value, haft_error *error) {
    const char *end = NULL;
    char given[UNIT_CAPACITY];
    double number = 0;
    text += skip_blanks(text);
    haft_status status = read_number(text, &number, &end, error);
    if (status != HAFT_OK) {
        return status;
    }
    end += skip_blanks(end);
    size_t length = copy_unit(given, end);
    if (length >= sizeof given) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "\"%.40s...\" has a unit of %zu bytes; give one that converts to %s",
                              text, length, unit);
    }
    if (length == 0 && strcmp(unit, "1") != 0) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "\"%.80s\" has no unit; give one that converts to %s", text, unit);
    }
    double result = number;
    if (length > 0) {
        status = check_unit(given, text, unit, error);
        HAFT_THEN(status, convert(units, number, given, text, unit, &result, error));
    }
    if (status == HAFT_OK && !isfinite(result)) {
        status =
            haft_error_set(error, HAFT_ERROR_INPUT, "\"%.80s\" is not finite in %s", text, unit);
    }
    *value = status == HAFT_OK ? result : *value;
    return status;
}
