/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Areal parameters by ISO 25178-2. The decay of the autocorrelation is followed from lag 0 along
 * straight lines to all lags on the border of a rectangle of half the map's sides. So there are as
 * many directions as the map resolves. Half of the plane is enough because the autocorrelation is
 * even. Lags without any pair of pixels are skipped. */
#include "autocorrelation.h"

#include <math.h>

static const double PAIRS_LEAST = 0.5; /* pairs are integers, except for rounding */

/* ---- heights ---- */

static haft_status take_heights(haft_map_texture *t, const haft_map *map, double *mean,
                                haft_error *error) {
    size_t all = map->rows * map->columns, n = 0;
    double sum = 0, least = INFINITY, greatest = -INFINITY, m1 = 0, m2 = 0, m3 = 0, m4 = 0;
    for (size_t i = 0; i < all; i++) {
        double z = map->z[i];
        if (!isnan(z)) {
            n++;
            sum += z;
            least = fmin(least, z);
            greatest = fmax(greatest, z);
        }
    }
    *mean = sum / (double)n;
    for (size_t i = 0; i < all; i++) {
        double d = map->z[i] - *mean, square = d * d;
        if (!isnan(d)) {
            m1 += fabs(d);
            m2 += square;
            m3 += square * d;
            m4 += square * square;
        }
    }
    if (n < 4 || !(greatest > least) || !(m2 > 0)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "the map has %zu pixels, all of one height: there is no texture to "
                              "be read from it",
                              n);
    }
    t->sq = sqrt(m2 / (double)n);
    t->sa = m1 / (double)n;
    t->ssk = m3 / (double)n / (t->sq * t->sq * t->sq);
    t->sku = m4 / (double)n / (t->sq * t->sq * t->sq * t->sq);
    t->sp = greatest - *mean;
    t->sv = *mean - least;
    t->sz = greatest - least;
    return HAFT_OK;
}

/* ---- slopes ---- */

/* Each cell has four triangles, one at each corner, with the slopes of the two sides that meet
 * there. */
static void take_slopes(haft_map_texture *t, const haft_map *map) {
    double squares = 0, excess = 0;
    size_t n = 0;
    for (size_t i = 0; i + 1 < map->rows; i++) {
        for (size_t j = 0; j + 1 < map->columns; j++) {
            const double *z = map->z + i * map->columns + j;
            double x[2] = {(z[1] - z[0]) / map->step_column,
                           (z[map->columns + 1] - z[map->columns]) / map->step_column};
            double y[2] = {(z[map->columns] - z[0]) / map->step_row,
                           (z[map->columns + 1] - z[1]) / map->step_row};
            if (isnan(x[0] + x[1] + y[0] + y[1])) {
                continue;
            }
            for (int corner = 0; corner < 4; corner++) {
                double slope = x[corner % 2], other = y[corner / 2];
                double square = slope * slope + other * other;
                squares += square;
                excess +=
                    square / (sqrt(1 + square) + 1); /* sqrt(1 + q) - 1 without cancellation */
            }
            n += 4;
        }
    }
    t->sdq = n > 0 ? sqrt(squares / (double)n) : NAN;
    t->sdr = n > 0 ? excess / (double)n : NAN;
}

/* ---- the autocorrelation's decay ---- */

typedef struct decay {
    const haft_map *map;
    double *f; /* 2 rows x 2 columns, normalised to 1 at lag 0; NAN without pairs */
} decay;

static double at(const decay *d, long i, long j) {
    long rows = 2 * (long)d->map->rows, columns = 2 * (long)d->map->columns;
    return d->f[(i < 0 ? i + rows : i) * columns + (j < 0 ? j + columns : j)];
}

/* Bilinear interpolation at a lag in pixels. */
static double between(const decay *d, double y, double x) {
    double row = floor(y), column = floor(x), v = y - row, u = x - column;
    long i = (long)row, j = (long)column;
    double below = u > 0 ? (1 - u) * at(d, i, j) + u * at(d, i, j + 1) : at(d, i, j);
    if (!(v > 0)) {
        return below;
    }
    double above = u > 0 ? (1 - u) * at(d, i + 1, j) + u * at(d, i + 1, j + 1) : at(d, i + 1, j);
    return (1 - v) * below + v * above;
}

/* The smallest lag on the line to the lag (y, x), in pixels, at which f falls to HAFT_TEXTURE_DECAY
 * [m], or INFINITY; *reach: length of the line [m]. */
static double follow(const decay *d, double y, double x, double *reach) {
    double steps = 2 * ceil(fmax(fabs(y), fabs(x)));
    double before = 1, place = 0;
    *reach = hypot(y * d->map->step_row, x * d->map->step_column);
    for (double k = 1; k <= steps; k++) {
        double value = between(d, y * k / steps, x * k / steps);
        if (value <= HAFT_TEXTURE_DECAY) {
            double share = (before - HAFT_TEXTURE_DECAY) / (before - value);
            return *reach * (place + share * (k / steps - place));
        }
        if (!isnan(value)) {
            before = value;
            place = k / steps;
        }
    }
    return INFINITY;
}

/* The smallest and the largest lag over the lines to the border of the half rectangle, and the
 * longest line along which f does not fall. */
static void search(haft_map_texture *t, const decay *d) {
    long rows = (long)(d->map->rows / 2), columns = (long)(d->map->columns / 2);
    double least = INFINITY, greatest = 0, open = 0;
    for (long k = 0; k < 2 * rows + 2 * columns;
         k++) { /* along three sides of the half rectangle */
        double y = (double)(k < rows ? k : rows),
               x = (double)(k < rows ? columns : columns + rows - k);
        if (k > rows + 2 * columns) {
            x = -(double)columns;
            y = (double)(2 * rows + 2 * columns - k);
        }
        double reach, lag = follow(d, y, x, &reach);
        least = fmin(least, lag);
        greatest = fmax(greatest, lag);
        open = isinf(lag) ? fmax(open, reach) : open;
    }
    t->sal = isinf(least) ? NAN : least;
    t->slowest = greatest;
    t->reach = isinf(greatest) ? open : greatest;
    t->str = isinf(greatest) ? 0 * t->sal : t->sal / greatest;
}

static haft_status take_decay(haft_map_texture *t, const haft_map *map, double mean,
                              haft_error *error) {
    size_t n = 4 * map->rows * map->columns;
    double *sum = haft_memory_alloc(n, sizeof *sum, error);
    double *pairs = haft_memory_alloc(n, sizeof *pairs, error);
    haft_status status = sum != NULL && pairs != NULL ? HAFT_OK : HAFT_ERROR_MEMORY;
    HAFT_THEN(status, haft_surface_autocorrelate(sum, pairs, map, mean, error));
    if (status == HAFT_OK) {
        double variance = sum[0] / pairs[0];
        for (size_t k = 0; k < n; k++) {
            sum[k] = pairs[k] > PAIRS_LEAST ? sum[k] / pairs[k] / variance : NAN;
        }
        search(t, &(decay){.map = map, .f = sum});
    }
    haft_memory_free(sum);
    haft_memory_free(pairs);
    return status;
}

haft_status haft_map_get_texture(haft_map_texture *out, const haft_map *map, haft_error *error) {
    double mean = 0;
    *out = (haft_map_texture){.sq = 0};
    HAFT_TRY(take_heights(out, map, &mean, error));
    take_slopes(out, map);
    return take_decay(out, map, mean, error);
}
