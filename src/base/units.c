/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Quantities with units. The number is read by strtod and the unit by UDUNITS-2, so that "1e-6 m"
 * and "nan um" are told apart before the units library guesses; the library's own messages, which
 * go to standard error by default, are turned off. */
#include "haft/base.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <udunits2.h>

struct haft_units {
    ut_system *system;
};

haft_status haft_units_create(haft_units **out, haft_error *error) {
    *out = NULL;
    haft_units *units = haft_memory_alloc(1, sizeof *units, error);
    if (units == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    ut_set_error_message_handler(ut_ignore);
    units->system = ut_read_xml(NULL);
    if (units->system == NULL) {
        haft_memory_free(units);
        return haft_error_set(error, HAFT_ERROR_LIBRARY,
                              "UDUNITS-2 cannot read its units database (is libudunits2-data "
                              "installed?)");
    }
    *out = units;
    return HAFT_OK;
}

void haft_units_destroy(haft_units **units) {
    if (units != NULL && *units != NULL) {
        ut_free_system((*units)->system);
        haft_memory_free(*units);
        *units = NULL;
    }
}

static haft_status convert(const haft_units *units, double number, const char *given,
                           const char *text, const char *wanted, double *value, haft_error *error) {
    haft_status status = HAFT_OK;
    ut_unit *from = ut_parse(units->system, given, UT_UTF8);
    ut_unit *to = ut_parse(units->system, wanted, UT_UTF8);
    cv_converter *converter = NULL;
    if (to == NULL) {
        status = haft_error_set(error, HAFT_ERROR_ARGUMENT, "\"%s\" is no unit", wanted);
    } else if (from == NULL) {
        status = haft_error_set(error, HAFT_ERROR_INPUT,
                                "\"%s\": the unit \"%s\" is unknown; give one that converts to %s",
                                text, given, wanted);
    } else if (!ut_are_convertible(from, to)) {
        status = haft_error_set(error, HAFT_ERROR_INPUT,
                                "\"%s\" has the wrong dimension; give a unit that converts to %s",
                                text, strcmp(wanted, "1") == 0 ? "a pure number" : wanted);
    } else {
        converter = ut_get_converter(from, to);
        *value = cv_convert_double(converter, number);
    }
    cv_free(converter);
    ut_free(from);
    ut_free(to);
    return status;
}

haft_status haft_units_parse(const haft_units *units, const char *text, const char *unit,
                             double *value, haft_error *error) {
    while (isspace((unsigned char)*text)) {
        text++;
    }
    char *end = NULL;
    double number = strtod(text, &end);
    if (end == text) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "\"%s\" does not begin with a number", text);
    }
    if (!isfinite(number)) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "\"%s\" is not a finite number", text);
    }
    while (isspace((unsigned char)*end)) {
        end++;
    }
    bool pure = strcmp(unit, "1") == 0;
    if (*end == '\0' && !pure) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "\"%s\" has no unit; give one that converts to %s", text, unit);
    }
    double result = number;
    if (*end != '\0') {
        haft_status status = convert(units, number, end, text, unit, &result, error);
        if (status != HAFT_OK) {
            return status;
        }
    }
    if (!isfinite(result)) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "\"%s\" is not finite in %s", text, unit);
    }
    *value = result;
    return HAFT_OK;
}
