/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Height maps and their statistics. Moments are two-pass sums over the present pixels, so a large
 * mean costs no digits. Slopes are central differences and curvatures second differences, each
 * where all its pixels are present. They cannot resolve waves shorter than two pixels, and damp
 * waves of a few pixels. The autocorrelation is that of the zero-padded map over the number of
 * pairs at each lag, from the same transforms of the mask, so it is unbiased except for the error
 * of the mean. */
#include "autocorrelation.h"

#include <math.h>
#include <string.h>

haft_status haft_map_create(haft_map **out, size_t rows, size_t columns, double step_row,
                            double step_column, haft_error *error) {
    *out = NULL;
    if (rows < 2 || columns < 2 || rows > HAFT_MAP_SIDE_MOST || columns > HAFT_MAP_SIDE_MOST) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "a map of %zu x %zu pixels; it needs 2 to %d a side", rows, columns,
                              HAFT_MAP_SIDE_MOST);
    }
    if (!(step_row > 0 && isfinite(step_row)) || !(step_column > 0 && isfinite(step_column))) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "pixels of %g m along y and %g m along x; both must be positive",
                              step_row, step_column);
    }
    haft_map *map = haft_memory_alloc(1, sizeof *map, error);
    if (map == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    *map = (haft_map){
        .rows = rows, .columns = columns, .step_row = step_row, .step_column = step_column};
    map->z = haft_memory_alloc(rows * columns, sizeof *map->z, error);
    if (map->z == NULL) {
        haft_map_destroy(&map);
        return HAFT_ERROR_MEMORY;
    }
    *out = map;
    return HAFT_OK;
}

haft_status haft_map_copy(haft_map **out, const haft_map *map, haft_error *error) {
    haft_status status =
        haft_map_create(out, map->rows, map->columns, map->step_row, map->step_column, error);
    if (status == HAFT_OK) {
        memcpy((*out)->z, map->z, map->rows * map->columns * sizeof *map->z);
        memcpy((*out)->channel, map->channel, sizeof map->channel);
        memcpy((*out)->format, map->format, sizeof map->format);
        memcpy((*out)->note, map->note, sizeof map->note);
    }
    return status;
}

void haft_map_destroy(haft_map **map) {
    if (map != NULL && *map != NULL) {
        haft_memory_free((*map)->z);
        haft_memory_free(*map);
        *map = NULL;
    }
}

static haft_status take_moments(haft_map_statistics *s, const haft_map *map, haft_error *error) {
    size_t n = map->rows * map->columns;
    double sum = 0;
    s->least = INFINITY;
    s->greatest = -INFINITY;
    for (size_t i = 0; i < n; i++) {
        if (!isnan(map->z[i])) {
            s->pixels++;
            sum += map->z[i];
            s->least = fmin(s->least, map->z[i]);
            s->greatest = fmax(s->greatest, map->z[i]);
        }
    }
    s->missing = n - s->pixels;
    s->mean = sum / (double)s->pixels;
    double m2 = 0, m3 = 0, m4 = 0;
    for (size_t i = 0; i < n; i++) {
        if (!isnan(map->z[i])) {
            double d = map->z[i] - s->mean, square = d * d;
            m2 += square;
            m3 += square * d;
            m4 += square * square;
        }
    }
    m2 /= (double)s->pixels;
    if (s->pixels < 4 || !(s->greatest > s->least) ||
        !(m2 > 0)) { /* m2 of equal heights may be rounding */
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "the map has %zu pixels and a variance of %g m^2: there is no "
                              "roughness to be read from it",
                              s->pixels, s->pixels > 0 ? m2 : 0);
    }
    s->rms = sqrt(m2);
    s->skewness = m3 / (double)s->pixels / (m2 * s->rms);
    s->kurtosis = m4 / (double)s->pixels / (m2 * m2);
    return HAFT_OK;
}

/* Mean squares of central and second differences along one direction. */
static void difference(const haft_map *map, size_t stride, size_t along, size_t across,
                       size_t other, double step, double *slope, double *curvature) {
    double first = 0, second = 0;
    size_t n = 0;
    for (size_t j = 0; j < across; j++) {
        const double *z = map->z + j * other;
        for (size_t i = 1; i + 1 < along; i++) {
            double below = z[(i - 1) * stride], here = z[i * stride], above = z[(i + 1) * stride];
            double tilt = (above - below) / (2 * step);
            double bend = (above - 2 * here + below) / (step * step);
            if (!isnan(bend)) {
                first += tilt * tilt;
                second += bend * bend;
                n++;
            }
        }
    }
    *slope = n > 0 ? first / (double)n : NAN;
    *curvature = n > 0 ? second / (double)n : NAN;
}

/* The smallest radius at which the ring mean of sum/pairs falls below 1/e of its value at lag 0. */
static double falling_radius(const haft_map *map, const double *sum, const double *pairs,
                             size_t padded) {
    double step = fmax(map->step_row, map->step_column);
    double side = fmin((double)map->rows * map->step_row, (double)map->columns * map->step_column);
    size_t rings = (size_t)(0.5 * side / step);
    double last_value = 1, last_radius = 0, variance = sum[0] / pairs[0];
    for (size_t ring = 1; ring < rings; ring++) {
        double total = 0, weight = 0, radius = 0;
        size_t most_i = (size_t)((double)(ring + 1) * step / map->step_row);
        for (size_t i = 0; i <= most_i && i < map->rows; i++) {
            for (size_t j = 0; j < map->columns; j++) {
                double r = hypot((double)i * map->step_row, (double)j * map->step_column);
                if (r >= ((double)ring + 0.5) * step) {
                    break;
                }
                size_t at = i * padded + j;
                if (r >= ((double)ring - 0.5) * step && pairs[at] > 0.5) {
                    total += sum[at];
                    weight += pairs[at];
                    radius += r * pairs[at];
                }
            }
        }
        if (weight == 0) {
            continue;
        }
        double value = total / weight / variance;
        radius /= weight;
        if (value < exp(-1)) {
            double share = (last_value - exp(-1)) / (last_value - value);
            return last_radius + share * (radius - last_radius);
        }
        last_value = value;
        last_radius = radius;
    }
    return NAN;
}

static haft_status find_correlation_length(haft_map_statistics *s, const haft_map *map,
                                           haft_error *error) {
    size_t rows = 2 * map->rows, columns = 2 * map->columns;
    double *sum = haft_memory_alloc(rows * columns, sizeof *sum, error);
    double *pairs = haft_memory_alloc(rows * columns, sizeof *pairs, error);
    haft_status status = sum != NULL && pairs != NULL ? HAFT_OK : HAFT_ERROR_MEMORY;
    HAFT_THEN(status, haft_surface_autocorrelate(sum, pairs, map, s->mean, error));
    if (status == HAFT_OK) {
        s->correlation_length = falling_radius(map, sum, pairs, columns);
    }
    haft_memory_free(sum);
    haft_memory_free(pairs);
    return status;
}

haft_status haft_map_get_statistics(haft_map_statistics *out, const haft_map *map,
                                    haft_error *error) {
    *out = (haft_map_statistics){.pixels = 0};
    HAFT_TRY(take_moments(out, map, error));
    difference(map, 1, map->columns, map->rows, map->columns, map->step_column, &out->slope_x,
               &out->curvature_x);
    difference(map, map->columns, map->rows, map->columns, 1, map->step_row, &out->slope_y,
               &out->curvature_y);
    out->moments = (haft_psd_moments){.m0 = out->rms * out->rms,
                                      .m2 = 0.5 * (out->slope_x + out->slope_y),
                                      .m4 = 0.5 * (out->curvature_x + out->curvature_y)};
    return find_correlation_length(out, map, error);
}
