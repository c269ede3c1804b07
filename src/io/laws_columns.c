/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The columns of law vectors and of a law's other numbers in a file, and the attributes of f_limit.
 */
#include "hdf.h"

#include <math.h>
#include <string.h>

const haft_hdf_column haft_hdf_vector_columns[HAFT_CHAOS_DIMENSION] = {
    {"e", HAFT_HDF_REAL, offsetof(haft_law_vector, e), "J/m^2",
     "energy of the attractive part; NaN where the fault forbids it"},
    {"f_max", HAFT_HDF_REAL, offsetof(haft_law_vector, f_max), "Pa", "greatest pull"},
    {"d_max", HAFT_HDF_REAL, offsetof(haft_law_vector, d_max), "m", "gap of the greatest pull"},
    {"d_limit", HAFT_HDF_REAL, offsetof(haft_law_vector, d_limit), "m",
     "gap at which the push reaches f_limit"},
};

const haft_laws_row haft_laws_rows[HAFT_LAWS_ROWS] = {
    {"zero_distance", "m", "greatest gap at which the force vanishes; NaN if there is none",
     offsetof(haft_laws, zero_distance)},
    {"contact_area", "1", "share of the area in contact there", offsetof(haft_laws, contact_area)},
    {"wet_area", "1", "share of the area under menisci or in contact there",
     offsetof(haft_laws, wet_area)},
    {"asperities", "1", "asperities in contact there, a patch", offsetof(haft_laws, asperities)},
};

double *haft_laws_row_of(const haft_laws *laws, const haft_laws_row *row) {
    double *values;
    memcpy(&values, (const char *)laws + row->member, sizeof values);
    return values;
}

void haft_hdf_write_limit(haft_hdf *hdf, const char *object, double f_limit) {
    haft_hdf_write_real(hdf, object, "f_limit", fabs(f_limit));
    haft_hdf_write_text(hdf, object, "f_limit_unit", f_limit > 0 ? "Pa" : "f_max");
}

void haft_hdf_read_limit(haft_hdf *hdf, const char *object, double *f_limit) {
    char *unit = NULL;
    haft_hdf_read_real(hdf, object, "f_limit", f_limit);
    haft_hdf_read_text(hdf, object, "f_limit_unit", &unit);
    if (hdf->status == HAFT_OK) {
        bool share = strcmp(unit, "f_max") == 0;
        if (!share && strcmp(unit, "Pa") != 0) {
            haft_hdf_refuse(hdf, "has an f_limit in \"%.40s\", neither Pa nor f_max", unit);
        } else if (!(*f_limit > 0)) {
            haft_hdf_refuse(hdf, "has an f_limit that is not above 0");
        }
        *f_limit = share ? haft_law_share(*f_limit) : *f_limit;
    }
    haft_memory_free(unit);
}
