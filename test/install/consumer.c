/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A user's program, valid as C and as C++: the version must be the package's, and a conversion of
 * units must run, which needs a library beneath Haft. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <haft/haft.h>

int main(int argc, char **argv) {
    if (argc != 2 || strcmp(argv[1], haft_version()) != 0) {
        fprintf(stderr, "version %s is not the package's\n", haft_version());
        return 1;
    }
    haft_error error = {HAFT_OK, ""};
    haft_units *units = NULL;
    double length = 0;
    if (haft_units_create(&units, &error) != HAFT_OK ||
        haft_units_parse(units, "600 um", "m", &length, &error) != HAFT_OK ||
        !(fabs(length - 600e-6) < 1e-15)) {
        fprintf(stderr, "600 um are not %g m: %s\n", length, error.message);
        return 1;
    }
    haft_units_destroy(&units);
    printf("haft %s: 600 um are %g m\n", haft_version(), length);
    return 0;
}
