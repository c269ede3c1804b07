/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cleaning of maps: levelling by least squares (normal equations of monomials in coordinates from
 * -1 to 1, solved by Cholesky factorization), and masking of particles by a robust threshold. */
#include "haft/surface_map.h"

#include <math.h>
#include <stdlib.h>

enum { TERMS_MOST = 6 };

/* Powers of x and y in the terms 1, x, y, x^2, xy, y^2. */
static const int POWER_X[TERMS_MOST] = {0, 1, 0, 2, 1, 0}, POWER_Y[TERMS_MOST] = {0, 0, 1, 0, 1, 2};

/* Solves the normal equations in place by Cholesky factorization; false if the pixels do not
 * determine the terms. */
static bool solve(double *a, double *b, size_t terms) {
    for (size_t k = 0; k < terms; k++) {
        double *row = a + k * TERMS_MOST, whole = row[k];
        for (size_t l = 0; l < k; l++) {
            const double *other = a + l * TERMS_MOST;
            for (size_t m = 0; m < l; m++) {
                row[l] -= row[m] * other[m];
            }
            row[l] /= other[l];
            row[k] -= row[l] * row[l];
            b[k] -= row[l] * b[l];
        }
        if (!(row[k] > 1e-12 * whole)) {
            return false;
        }
        row[k] = sqrt(row[k]);
        b[k] /= row[k];
    }
    for (size_t k = terms; k-- > 0;) {
        for (size_t l = k + 1; l < terms; l++) {
            b[k] -= a[l * TERMS_MOST + k] * b[l];
        }
        b[k] /= a[k * TERMS_MOST + k];
    }
    return true;
}

static double coordinate(size_t i, size_t n) {
    return (2.0 * (double)i - (double)(n - 1)) / (double)(n - 1);
}

/* Sums of x^p and of x^p z over a line's present pixels. */
typedef struct line_sums {
    double x[5], z[3];
} line_sums;

static line_sums sum_line(const double *z, const double *x, size_t n) {
    line_sums s = {{0}, {0}};
    for (size_t j = 0; j < n; j++) {
        double present = isnan(z[j]) ? 0 : 1, value = isnan(z[j]) ? 0 : z[j];
        double square = present * x[j] * x[j];
        s.x[0] += present;
        s.x[1] += present * x[j];
        s.x[2] += square;
        s.x[3] += square * x[j];
        s.x[4] += square * x[j] * x[j];
        s.z[0] += value;
        s.z[1] += value * x[j];
        s.z[2] += value * x[j] * x[j];
    }
    return s;
}

/* Subtracts the best fit of the first `terms` monomials from rows [first, end). */
static haft_status take_off(haft_map *map, const double *x, size_t first, size_t end, size_t terms,
                            haft_error *error) {
    double matrix[TERMS_MOST * TERMS_MOST] = {0}, right[TERMS_MOST] = {0};
    for (size_t i = first; i < end; i++) {
        line_sums s = sum_line(map->z + i * map->columns, x, map->columns);
        double y = coordinate(i, map->rows), power[5] = {1, y, y * y, y * y * y, y * y * y * y};
        for (size_t k = 0; k < terms; k++) {
            right[k] += power[POWER_Y[k]] * s.z[POWER_X[k]];
            for (size_t l = 0; l <= k; l++) {
                matrix[k * TERMS_MOST + l] +=
                    power[POWER_Y[k] + POWER_Y[l]] * s.x[POWER_X[k] + POWER_X[l]];
            }
        }
    }
    if (!solve(matrix, right, terms)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "rows %zu to %zu of the map have too few pixels for a level of %zu "
                              "terms; level it by less",
                              first, end - 1, terms);
    }
    for (size_t i = first; i < end; i++) {
        double y = coordinate(i, map->rows);
        double share[3] = {right[0] + right[2] * y + right[5] * y * y, right[1] + right[4] * y,
                           right[3]};
        for (size_t j = 0; j < map->columns; j++) {
            map->z[i * map->columns + j] -= share[0] + x[j] * (share[1] + x[j] * share[2]);
        }
    }
    return HAFT_OK;
}

/* Subtracts mean and slope of each line. A line with a single pixel has no slope, and its height
 * cannot be compared with other lines, so the pixel becomes missing. */
static haft_status level_lines(haft_map *map, const double *x, haft_error *error) {
    haft_status status = HAFT_OK;
    size_t levelled = 0;
    for (size_t i = 0; status == HAFT_OK && i < map->rows; i++) {
        double *z = map->z + i * map->columns;
        size_t there = 0;
        for (size_t j = 0; j < map->columns; j++) {
            there += !isnan(z[j]);
        }
        if (there >= 2) {
            status = take_off(map, x, i, i + 1, 2, error);
            levelled++;
        }
        for (size_t j = 0; there == 1 && j < map->columns; j++) {
            z[j] = NAN;
        }
    }
    return status == HAFT_OK && levelled == 0
               ? haft_error_set(error, HAFT_ERROR_INPUT,
                                "no line of the map has two pixels, so none can be levelled by "
                                "itself; level it by less")
               : status;
}

haft_status haft_map_level(haft_map *map, haft_level level, haft_error *error) {
    static const size_t terms[] = {1, 3, 6, 3};
    double *x = haft_memory_alloc(map->columns, sizeof *x, error);
    if (x == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    for (size_t j = 0; j < map->columns; j++) {
        x[j] = coordinate(j, map->columns);
    }
    haft_status status = take_off(map, x, 0, map->rows, terms[level], error);
    if (level == HAFT_LEVEL_LINES && status == HAFT_OK) {
        status = level_lines(map, x, error);
    }
    haft_memory_free(x);
    return status;
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median_of(double *value, size_t n) {
    qsort(value, n, sizeof *value, compare);
    return n % 2 == 1 ? value[n / 2] : 0.5 * (value[n / 2 - 1] + value[n / 2]);
}

/* The step that heights are rounded to, 0 if none is found. From pixel to pixel along a line,
 * rounded heights change by a multiple of the step, plus what levelling subtracted, which is nearly
 * constant along the line. So the changes minus their median are either almost zero or at least a
 * step. `work` is overwritten. */
static double find_step(const haft_map *map, double *work) {
    static const double JUMP = 1e4,
                        SHARE = 0.01; /* ratio of a step to rounding errors; least share of zeros */
    size_t n = 0;
    for (size_t i = 0; i < map->rows; i++) {
        const double *z = map->z + i * map->columns;
        size_t first = n;
        for (size_t j = 0; j + 1 < map->columns; j++) {
            work[n] = z[j + 1] - z[j];
            n += !isnan(work[n]);
        }
        double median = n > first ? median_of(work + first, n - first) : 0;
        for (size_t k = first; k < n; k++) {
            work[k] = fabs(work[k] - median);
        }
    }
    qsort(work, n, sizeof *work, compare);
    double floor = n > 0 ? 1e-13 * work[n - 1] : 0;
    for (size_t k = (size_t)(SHARE * (double)n) + 1; k < n; k++) {
        if (work[k] > JUMP * fmax(work[k - 1], floor)) {
            return work[k];
        }
    }
    return 0;
}

haft_status haft_map_mask(haft_map *map, double limit, size_t *masked, haft_error *error) {
    size_t all = map->rows * map->columns, n = 0;
    *masked = 0;
    double *value = haft_memory_alloc(all, sizeof *value, error);
    if (value == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    double step = find_step(map, value);
    for (size_t i = 0; i < all; i++) {
        value[n] = map->z[i];
        n += !isnan(map->z[i]);
    }
    double median = n > 0 ? median_of(value, n) : 0;
    for (size_t i = 0; i < n; i++) {
        value[i] = fabs(value[i] - median);
    }
    double deviation = n > 0 ? 1.4826 * median_of(value, n) : 0;
    haft_memory_free(value);
    if (!(deviation > 0) || !(limit > 0)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "outliers cannot be told: half of the map's pixels or more have the "
                              "same height; leave the outlier limit out");
    }
    if (deviation < step) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "outliers cannot be told: heights are rounded to steps of %.3g nm, and "
            "most pixels are less than one step off the median; leave the outlier "
            "limit out, or give a map with finer heights",
            step * 1e9);
    }
    for (size_t i = 0; i < all; i++) {
        if (fabs(map->z[i] - median) > limit * deviation) {
            map->z[i] = NAN;
            ++*masked;
        }
    }
    if (2 * *masked > n) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "an outlier limit of %g masks %zu of %zu pixels; give a higher one",
                              limit, *masked, n);
    }
    return HAFT_OK;
}

haft_status haft_map_clean(haft_map *map, const haft_clean_spec *spec, haft_clean_facts *facts,
                           haft_error *error) {
    haft_clean_facts found = {0};
    haft_status status = haft_map_level(map, spec->level, error);
    found.missing =
        haft_map_count_missing(map); /* including those that levelling by lines removed */
    if (status == HAFT_OK && spec->outlier_limit > 0) {
        status = haft_map_mask(map, spec->outlier_limit, &found.masked, error);
        if (status == HAFT_OK) {
            status = haft_map_level(map, spec->level, error);
            found.masked = haft_map_count_missing(map) - found.missing;
        }
    }
    if (status == HAFT_OK && spec->missing == HAFT_MISSING_FILL) {
        status = haft_map_fill(map, error);
    }
    if (facts != NULL) {
        *facts = found;
    }
    return status;
}
