/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Laplace pressure and height of the water at each humidity: Fig. 4b of Hoang et al. (2017), for
 * a case's own liquid. */
#include "sheet.h"

enum { FIRST = 30, LAST = 99 }; /* [%] */

haft_status haft_study_write_water(const haft_case *c, const char *directory, haft_error *error) {
    static const char *const name[] = {"humidity [1]", "Laplace pressure [MPa]",
                                       "water height [nm]"};
    haft_sheet t = {0};
    haft_status status = haft_sheet_make(&t, LAST - FIRST + 1, 3, error);
    haft_case humid = *c;
    for (size_t i = 0; i < t.rows && status == HAFT_OK; i++) {
        haft_capillary water;
        humid.contact.capillary.humidity = 0.01 * (FIRST + (double)i);
        status = haft_capillary_from_spec(&water, &humid.contact.capillary, error);
        t.value[3 * i] = humid.contact.capillary.humidity;
        t.value[3 * i + 1] = water.pressure * 1e-6;
        t.value[3 * i + 2] = (water.range + 2 * haft_case_film(&humid)) * 1e9;
    }
    if (status != HAFT_OK) {
        haft_sheet_drop(&t);
        return status;
    }
    haft_sheet_name(&t, name);
    return haft_sheet_write(&t, directory, "water.csv", error);
}
