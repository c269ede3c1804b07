/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The laws of a realization in its record. Some runs build each beam's laws just before they follow
 * the beam; if they are killed, both are saved. */
#include "parts.h"

#include <string.h>

void haft_part_count_laws(haft_part_counts *counts, const haft_laws *laws) {
    if (laws != NULL) {
        counts->laws = laws->m;
        counts->first_site = laws->first_site;
        counts->curves = laws->curves;
        counts->distances = laws->n;
    }
}

bool haft_part_laws_size(const haft_part_counts *counts, size_t *size) {
    size_t a_law = sizeof(haft_law_vector) + sizeof(int) + HAFT_LAWS_ROWS * sizeof(double);
    size_t curve = 0, curves = 0, rows = 0;
    *size = 0;
    if (counts->laws == 0) {
        return counts->curves == 0 && counts->distances == 0;
    }
    bool over = counts->curves > counts->laws ||
                __builtin_mul_overflow(counts->distances, sizeof(double), &curve) ||
                __builtin_mul_overflow(counts->laws, a_law, &rows) ||
                __builtin_add_overflow(curve, sizeof(int), &curves) ||
                __builtin_mul_overflow(curves, counts->curves, &curves) ||
                __builtin_add_overflow(curve, rows, size) ||
                __builtin_add_overflow(*size, curves, size) ||
                __builtin_add_overflow(*size, sizeof(double), size);
    return !over;
}

static char *put(char *at, const void *from, size_t size) {
    memcpy(at, from, size);
    return at + size;
}

void haft_part_pack_laws(char *at, const haft_laws *laws) {
    size_t m = laws->m, n = laws->n;
    at = put(at, &laws->f_limit, sizeof laws->f_limit);
    at = put(at, laws->vector, m * sizeof *laws->vector);
    at = put(at, laws->fault, m * sizeof *laws->fault);
    for (int i = 0; i < HAFT_LAWS_ROWS; i++) {
        at = put(at, haft_laws_row_of(laws, &haft_laws_rows[i]), m * sizeof(double));
    }
    at = put(at, laws->distance, n * sizeof(double));
    for (size_t i = 0; i < laws->curves; i++) {
        int law = laws->curve_law == NULL ? (int)i : laws->curve_law[i];
        at = put(at, &law, sizeof law);
    }
    put(at, laws->force, laws->curves * n * sizeof(double));
}

static const char *take(void *to, const char *at, size_t size) {
    memcpy(to, at, size);
    return at + size;
}

/* Whether the laws are valid. The checksum shows only that they are as written; this protects the
 * program from invalid values. */
static bool is_sound(const haft_laws *laws) {
    for (size_t i = 0; i < laws->m; i++) {
        if ((int)laws->fault[i] < 0 || (int)laws->fault[i] >= HAFT_LAW_FAULTS) {
            return false;
        }
    }
    for (size_t i = 0; laws->curve_law != NULL && i < laws->curves; i++) {
        int law = laws->curve_law[i], before = i == 0 ? -1 : laws->curve_law[i - 1];
        if (law <= before || (size_t)law >= laws->m) {
            return false;
        }
    }
    return true;
}

haft_status haft_part_unpack_laws(haft_laws **out, const haft_part_counts *counts, const char *at,
                                  haft_error *error) {
    size_t m = counts->laws, n = counts->distances;
    *out = NULL;
    if (m == 0) {
        return HAFT_OK;
    }
    HAFT_TRY(haft_laws_create_sparse(out, m, counts->curves, n, error));
    haft_laws *laws = *out;
    laws->sites = m;
    laws->first_site = counts->first_site;
    at = take(&laws->f_limit, at, sizeof laws->f_limit);
    at = take(laws->vector, at, m * sizeof *laws->vector);
    at = take(laws->fault, at, m * sizeof *laws->fault);
    for (int i = 0; i < HAFT_LAWS_ROWS; i++) {
        at = take(haft_laws_row_of(laws, &haft_laws_rows[i]), at, m * sizeof(double));
    }
    at = take(laws->distance, at, n * sizeof(double));
    if (laws->curve_law != NULL) {
        take(laws->curve_law, at, laws->curves * sizeof(int));
    }
    at += laws->curves * sizeof(int);
    take(laws->force, at, laws->curves * n * sizeof(double));
    if (!is_sound(laws)) {
        haft_laws_destroy(out);
        return haft_error_set(error, HAFT_ERROR_INPUT, "holds no laws of this case");
    }
    return HAFT_OK;
}
