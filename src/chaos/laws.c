/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sets of laws in memory: which curves they keep, parts of them, and sets joined. */
#include "haft/chaos_laws.h"

#include <limits.h>
#include <math.h>
#include <string.h>

static bool allocate(haft_laws *laws, haft_error *error) {
    size_t m = laws->m, n = laws->n, size = 0;
    if (__builtin_mul_overflow(laws->curves, n, &size)) {
        haft_error_set(error, HAFT_ERROR_MEMORY, "%zu curves of %zu points overflow", laws->curves,
                       n);
        return false;
    }
    laws->distance = haft_memory_alloc(n, sizeof(double), error);
    laws->force = haft_memory_alloc(size, sizeof(double), error);
    laws->vector = haft_memory_alloc(m, sizeof *laws->vector, error);
    laws->fault = haft_memory_alloc(m, sizeof *laws->fault, error);
    laws->zero_distance = haft_memory_alloc(m, sizeof(double), error);
    laws->contact_area = haft_memory_alloc(m, sizeof(double), error);
    laws->wet_area = haft_memory_alloc(m, sizeof(double), error);
    laws->asperities = haft_memory_alloc(m, sizeof(double), error);
    if (laws->curves < m) {
        laws->curve_law = haft_memory_alloc(laws->curves, sizeof(int), error);
    }
    return laws->distance && laws->force && laws->vector && laws->fault && laws->zero_distance &&
           laws->contact_area && laws->wet_area && laws->asperities &&
           (laws->curves == m || laws->curve_law);
}

haft_status haft_laws_create_sparse(haft_laws **out, size_t m, size_t curves, size_t n,
                                    haft_error *error) {
    *out = NULL;
    if (m > INT_MAX || curves > m) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT, "%zu curves of %zu laws", curves, m);
    }
    haft_laws *laws = haft_memory_alloc(1, sizeof *laws, error);
    if (laws == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    laws->m = m;
    laws->n = n;
    laws->curves = curves;
    if (!allocate(laws, error)) {
        haft_laws_destroy(&laws);
        return HAFT_ERROR_MEMORY;
    }
    for (size_t k = 0; n == 0 && k < m; k++) { /* no curves to read them off */
        laws->zero_distance[k] = laws->contact_area[k] = laws->wet_area[k] = NAN;
        laws->asperities[k] = NAN;
    }
    *out = laws;
    return HAFT_OK;
}

haft_status haft_laws_create(haft_laws **out, size_t m, size_t n, haft_error *error) {
    return haft_laws_create_sparse(out, m, m, n, error);
}

void haft_laws_destroy(haft_laws **laws) {
    if (laws == NULL || *laws == NULL) {
        return;
    }
    haft_laws *l = *laws;
    haft_memory_free(l->distance);
    haft_memory_free(l->curve_law);
    haft_memory_free(l->force);
    haft_memory_free(l->vector);
    haft_memory_free(l->fault);
    haft_memory_free(l->zero_distance);
    haft_memory_free(l->contact_area);
    haft_memory_free(l->wet_area);
    haft_memory_free(l->asperities);
    haft_chaos_destroy(&l->chaos);
    for (size_t k = 0; l->table != NULL && k < l->m; k++) {
        haft_law_table_destroy(&l->table[k]);
    }
    haft_memory_free(l->table);
    haft_memory_free(l);
    *laws = NULL;
}

const double *haft_laws_curve(const haft_laws *laws, size_t k) {
    if (laws->n == 0 || k >= laws->m) {
        return NULL;
    }
    if (laws->curve_law == NULL) {
        return laws->force + k * laws->n;
    }
    size_t low = 0, high = laws->curves;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if ((size_t)laws->curve_law[middle] < k) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    bool kept = low < laws->curves && (size_t)laws->curve_law[low] == k;
    return kept ? laws->force + low * laws->n : NULL;
}

haft_status haft_laws_tabulate(haft_laws *laws, haft_error *error) {
    if (laws->table != NULL) {
        return HAFT_OK;
    }
    laws->table = haft_memory_alloc(laws->m, sizeof *laws->table, error);
    haft_status status = laws->table == NULL ? HAFT_ERROR_MEMORY : HAFT_OK;
    for (size_t k = 0; k < laws->m && status == HAFT_OK; k++) {
        const double *curve = haft_laws_curve(laws, k);
        haft_error own = {0};
        if (curve != NULL && haft_law_table_create(&laws->table[k], laws->n, laws->distance, curve,
                                                   &own) == HAFT_ERROR_MEMORY) {
            status = haft_error_set(error, HAFT_ERROR_MEMORY, "%s", own.message);
        }
    }
    return status;
}

/* Copies all but curves of `count` laws, to the places from `at` on. */
static void copy_rows(haft_laws *to, size_t at, const haft_laws *from, size_t first, size_t count) {
    memcpy(to->vector + at, from->vector + first, count * sizeof *to->vector);
    memcpy(to->fault + at, from->fault + first, count * sizeof *to->fault);
    memcpy(to->zero_distance + at, from->zero_distance + first, count * sizeof(double));
    memcpy(to->contact_area + at, from->contact_area + first, count * sizeof(double));
    memcpy(to->wet_area + at, from->wet_area + first, count * sizeof(double));
    memcpy(to->asperities + at, from->asperities + first, count * sizeof(double));
}

haft_status haft_laws_select(haft_laws **out, const haft_laws *laws, size_t first, size_t count,
                             const bool *keep, haft_error *error) {
    *out = NULL;
    if (count == 0 || first > laws->m || count > laws->m - first) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT, "laws %zu to %zu of %zu", first,
                              first + count, laws->m);
    }
    size_t curves = 0, n = laws->n;
    for (size_t i = 0; i < count; i++) {
        curves += keep[i] && haft_laws_curve(laws, first + i) != NULL;
    }
    HAFT_TRY(haft_laws_create_sparse(out, count, curves, n, error));
    haft_laws *set = *out;
    set->sites = count;
    set->first_site = laws->first_site + first % laws->sites;
    set->f_limit = laws->f_limit;
    memcpy(set->distance, laws->distance, n * sizeof(double));
    copy_rows(set, 0, laws, first, count);
    for (size_t i = 0, at = 0; i < count; i++) {
        const double *curve = keep[i] ? haft_laws_curve(laws, first + i) : NULL;
        if (curve != NULL) {
            memcpy(set->force + at * n, curve, n * sizeof(double));
            if (set->curve_law != NULL) {
                set->curve_law[at] = (int)i;
            }
            at++;
        }
    }
    return HAFT_OK;
}

static void copy_curves(haft_laws *to, size_t at, size_t law, const haft_laws *from) {
    memcpy(to->force + at * to->n, from->force, from->curves * from->n * sizeof(double));
    for (size_t i = 0; to->curve_law != NULL && i < from->curves; i++) {
        size_t own = from->curve_law == NULL ? i : (size_t)from->curve_law[i];
        to->curve_law[at + i] = (int)(law + own);
    }
}

haft_status haft_laws_join(haft_laws **out, haft_laws **set, size_t count, haft_error *error) {
    *out = NULL;
    size_t curves = 0, m = 0;
    for (size_t k = 0; k < count; k++) {
        bool alike = set[k]->m == set[0]->m && set[k]->n == set[0]->n &&
                     set[k]->first_site == set[0]->first_site &&
                     memcmp(set[k]->distance, set[0]->distance, set[0]->n * sizeof(double)) == 0;
        if (!alike) {
            return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                                  "the laws of realizations 0 and %zu are of different sites or "
                                  "distances",
                                  k);
        }
        curves += set[k]->curves;
        m += set[k]->m;
    }
    HAFT_TRY(count == 0 ? haft_error_set(error, HAFT_ERROR_ARGUMENT, "no laws to join")
                        : haft_laws_create_sparse(out, m, curves, set[0]->n, error));
    haft_laws *laws = *out;
    laws->sites = set[0]->m;
    laws->first_site = set[0]->first_site;
    laws->f_limit = set[0]->f_limit;
    memcpy(laws->distance, set[0]->distance, laws->n * sizeof(double));
    for (size_t k = 0, at = 0; k < count; k++) {
        copy_rows(laws, k * laws->sites, set[k], 0, laws->sites);
        copy_curves(laws, at, k * laws->sites, set[k]);
        at += set[k]->curves;
        haft_laws_destroy(&set[k]);
    }
    return HAFT_OK;
}
