/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Quantities. The first byte tells which unit is wanted, the others are the text. */
#include "entry.h"

#include <math.h>
#include <stdio.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const wanted[] = {"m", "Pa", "1", "rad/m", "m^4", "J/m^2", "K", "m^3/mol"};
    static haft_units *units;
    haft_error error = {0};
    if (size == 0 || size > 200) {
        return -1;
    }
    if (units == NULL && haft_units_create(&units, &error) != HAFT_OK) {
        abort();
    }
    char *text = malloc(size); /* of this very size, so that the sanitizer sees its end */
    memcpy(text, data + 1, size - 1);
    text[size - 1] = '\0';
    const char *unit = wanted[data[0] % (sizeof wanted / sizeof *wanted)];
    double value = NAN;
    haft_status status = haft_units_parse(units, text, unit, &value, &error);
    fuzz_check_status(status, &error);
    FUZZ_DEMAND(status != HAFT_OK || isfinite(value), "\"%s\" is %g %s", text, value, unit);
    if (status == HAFT_OK) { /* what was read is a number and can be written and read again */
        char again[64];
        double back = NAN;
        snprintf(again, sizeof again, "%.17g %s", value, strcmp(unit, "1") == 0 ? "" : unit);
        status = haft_units_parse(units, again, unit, &back, &error);
        FUZZ_DEMAND(status == HAFT_OK && back == value, "\"%s\" is %s and then %.17g: %s", text,
                    again, back, error.message);
    }
    free(text);
    return 0;
}
