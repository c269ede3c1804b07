/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The correlation of laws along surfaces, as a table. */
#include "sheet.h"

#include <math.h>

haft_status haft_study_write_correlation(const haft_case *c, const haft_laws *laws,
                                         const char *directory, haft_error *error) {
    enum { COLUMNS = 14, MOST = 20 };
    static const char *const name[COLUMNS] = {
        "patches apart", "distance [um]", "e [1]",       "e low",       "e high",
        "f_max [1]",     "f_max low",     "f_max high",  "d_max [1]",   "d_max low",
        "d_max high",    "d_limit [1]",   "d_limit low", "d_limit high"};
    haft_correlation value[4][MOST + 1], *out[4] = {value[0], value[1], value[2], value[3]};
    size_t lags = laws->sites - 1 < MOST ? laws->sites - 1 : MOST, n = laws->m / laws->sites;
    double confidence = c->stop.confidence > 0 ? c->stop.confidence : HAFT_STUDY_CONFIDENCE;
    haft_sheet t;
    haft_status status = haft_study_correlate_laws(laws, lags, out, error);
    HAFT_THEN(status, haft_sheet_make(&t, lags + 1, COLUMNS, error));
    if (status != HAFT_OK) {
        return status;
    }
    for (size_t l = 0; l <= lags; l++) {
        double *row = t.value + l * COLUMNS;
        row[0] = (double)l;
        row[1] = (double)l * c->mesh.l_meso * 1e6;
        for (int i = 0; i < 4; i++) {
            haft_interval band = haft_study_mean_interval(
                value[i][l].value, value[i][l].error * sqrt((double)n), n, confidence);
            row[2 + 3 * i] = value[i][l].value;
            row[3 + 3 * i] = band.low;
            row[4 + 3 * i] = band.high;
        }
    }
    haft_sheet_name(&t, name);
    return haft_sheet_write(&t, directory, "correlation.csv", error);
}
