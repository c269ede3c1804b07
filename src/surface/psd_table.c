/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A radial PSD given by points, with power laws in between: value, moments (closed forms, as in
 * psd.c), the limit due to a tip, and the PSD of two faces together. */
#include "haft/surface_map.h"

#include <math.h>
#include <string.h>

haft_status haft_psd_table_create(haft_psd_table **out, size_t n, haft_error *error) {
    *out = NULL;
    haft_psd_table *table = haft_memory_alloc(1, sizeof *table, error);
    if (table == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    table->zeta = haft_memory_alloc(n, 3 * sizeof *table->zeta, error);
    if (table->zeta == NULL) {
        haft_memory_free(table);
        return HAFT_ERROR_MEMORY;
    }
    table->n = n;
    table->s = table->zeta + n;
    table->count = table->s + n;
    *out = table;
    return HAFT_OK;
}

void haft_psd_table_destroy(haft_psd_table **table) {
    if (table != NULL && *table != NULL) {
        haft_memory_free((*table)->zeta);
        haft_memory_free(*table);
        *table = NULL;
    }
}

haft_status haft_psd_table_check(const haft_psd_table *table, haft_error *error) {
    if (table->n < 2) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "a PSD of %zu points; it needs 2 at least",
                              table->n);
    }
    for (size_t i = 0; i < table->n; i++) {
        double before = i > 0 ? table->zeta[i - 1] : 0;
        if (!(table->zeta[i] > before && isfinite(table->zeta[i]))) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "point %zu of the PSD has the wave number %g rad/m; it must be "
                                  "finite and above that before it, %g rad/m",
                                  i + 1, table->zeta[i], before);
        }
        if (!(table->s[i] > 0 && isfinite(table->s[i]))) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "point %zu of the PSD is %g m^4; it must be positive and finite",
                                  i + 1, table->s[i]);
        }
    }
    return HAFT_OK;
}

static double exponent_of(const haft_psd_table *table, size_t i) {
    return log(table->s[i + 1] / table->s[i]) / log(table->zeta[i + 1] / table->zeta[i]);
}

double haft_psd_table_value(const haft_psd_table *table, double zeta) {
    size_t low = 0, high = table->n - 1;
    if (zeta <= table->zeta[0]) {
        return table->s[0];
    }
    if (zeta > table->zeta[high]) {
        return 0;
    }
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        *(zeta > table->zeta[middle] ? &low : &high) = middle;
    }
    return table->s[low] * pow(zeta / table->zeta[low], exponent_of(table, low));
}

/* Integral of s zeta^power from zeta[i] to `end`, at most zeta[i + 1]. */
static double stretch_integral(const haft_psd_table *table, size_t i, double end, int power) {
    double span = log(end / table->zeta[i]), exponent = exponent_of(table, i) + power + 1;
    double x = exponent * span;
    double law = x == 0 ? span : expm1(x) / exponent;
    return table->s[i] * pow(table->zeta[i], power + 1) * law;
}

static double power_integral(const haft_psd_table *table, int power) {
    double sum = table->s[0] * pow(table->zeta[0], power + 1) / (power + 1);
    for (size_t i = 0; i + 1 < table->n; i++) {
        sum += stretch_integral(table, i, table->zeta[i + 1], power);
    }
    return sum;
}

haft_psd_moments haft_psd_table_get_moments(const haft_psd_table *table) {
    return (haft_psd_moments){.m0 = 2 * M_PI * power_integral(table, 1),
                              .m2 = M_PI * power_integral(table, 3),
                              .m4 = 0.75 * M_PI * power_integral(table, 5)};
}

static double count_at(const haft_psd_table *table, double zeta) {
    size_t i = 0;
    while (i + 1 < table->n && table->zeta[i + 1] <= zeta) {
        i++;
    }
    return table->count == NULL || table->count[i] == 0 ? INFINITY : table->count[i];
}

haft_status haft_psd_table_cut(haft_psd_table *table, double zeta_max, haft_error *error) {
    size_t n = table->n;
    if (zeta_max >= table->zeta[n - 1]) {
        return HAFT_OK;
    }
    while (n > 0 && table->zeta[n - 1] >= zeta_max) {
        n--;
    }
    if (n == 0) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "a cut at %.4g rad/um leaves nothing of a PSD that begins at %.4g "
                              "rad/um",
                              zeta_max * 1e-6, table->zeta[0] * 1e-6);
    }
    double value = haft_psd_table_value(table, zeta_max);
    double ratio = table->zeta[n] / zeta_max;
    table->zeta[n] = zeta_max;
    table->s[n] = value;
    table->n = n + 1;
    if (n > 1 && zeta_max / table->zeta[n - 1] < 1 + 1e-9 && ratio > 1) {
        table->zeta[n - 1] = zeta_max; /* merge coincident points */
        table->s[n - 1] = value;
        table->n = n;
    }
    return HAFT_OK;
}

double haft_psd_tip_limit(const haft_psd_table *table, double radius) {
    double curvature = HAFT_TIP_SHARE / radius;
    double wanted = 2 / M_PI * curvature * curvature; /* of int s k^5 dk */
    double sum = table->s[0] * pow(table->zeta[0], 6) / 6;
    if (sum >= wanted) {
        return table->zeta[0] * pow(wanted / sum, 1.0 / 6);
    }
    for (size_t i = 0; i + 1 < table->n; i++) {
        double part = stretch_integral(table, i, table->zeta[i + 1], 5);
        if (sum + part < wanted) {
            sum += part;
            continue;
        }
        double low = table->zeta[i], high = table->zeta[i + 1];
        for (int step = 0; step < 200 && high - low > 1e-14 * high; step++) {
            double middle = 0.5 * (low + high);
            *(sum + stretch_integral(table, i, middle, 5) < wanted ? &low : &high) = middle;
        }
        return 0.5 * (low + high);
    }
    return INFINITY;
}

/* The points of both tables within their common range, sorted, without duplicates. */
static size_t merge(double *zeta, const haft_psd_table *a, const haft_psd_table *b) {
    double most = fmin(a->zeta[a->n - 1], b->zeta[b->n - 1]);
    size_t i = 0, j = 0, n = 0;
    while (i < a->n || j < b->n) {
        bool first = j >= b->n || (i < a->n && a->zeta[i] <= b->zeta[j]);
        double next = first ? a->zeta[i++] : b->zeta[j++];
        if (next <= most && (n == 0 || next > zeta[n - 1] * (1 + 1e-9))) {
            zeta[n++] = next;
        }
    }
    return n;
}

haft_status haft_psd_combine(haft_psd_table **out, const haft_psd_table *first,
                             const haft_psd_table *second, double coherence, haft_error *error) {
    *out = NULL;
    haft_status status = haft_psd_table_check(first, error);
    HAFT_THEN(status, haft_psd_table_check(second, error));
    if (status == HAFT_OK && !(coherence >= -1 && coherence <= 1)) {
        status = haft_error_set(error, HAFT_ERROR_INPUT,
                                "a coherence of %g; it must lie between -1 and 1", coherence);
    }
    HAFT_THEN(status, haft_psd_table_create(out, first->n + second->n, error));
    if (status != HAFT_OK) {
        return status;
    }
    haft_psd_table *t = *out;
    t->n = merge(t->zeta, first, second);
    for (size_t i = 0; i < t->n; i++) {
        double a = haft_psd_table_value(first, t->zeta[i]);
        double b = haft_psd_table_value(second, t->zeta[i]);
        double m = count_at(first, t->zeta[i]), n = count_at(second, t->zeta[i]);
        double spread = a * a / m + b * b / n;
        t->s[i] = a + b + 2 * coherence * sqrt(a * b);
        t->count[i] = spread > 0 ? t->s[i] * t->s[i] / spread : 0;
    }
    status = haft_psd_table_check(t, error);
    if (status != HAFT_OK) {
        haft_error_prefix(error,
                          "two faces of coherence %g leave no roughness between them: ", coherence);
        haft_psd_table_destroy(out);
    }
    return status;
}
