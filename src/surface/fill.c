/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws heights for missing pixels. Each is normal, with mean and variance conditional on the
 * nearest known heights under the covariance of the map's own PSD; once drawn, it counts as known.
 * Coarse grids are drawn first, so that a wide hole gets its long waves before its short ones. The
 * covariance is the transform of the radial PSD of the map as filled in the pass before, up to the
 * corners of the plane of wave vectors, on the map's own lattice. It is periodic with the map,
 * which does not matter for neighbours. The first pass has no PSD yet: it uses zeta^-3.6 and draws
 * only means. Each pass reduces the effect of a wrong first guess to about the share of missing
 * pixels. */
#include "spectrum.h"

#include <fftw3.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NEIGHBOURS = 24, REACH_MOST = 48, LEVELS = 6 };
static const double GUESS_EXPONENT = -3.6;
static const double REDUNDANT =
    1e-11; /* share of the variance; with less conditional variance a neighbour is redundant */

typedef struct place {
    size_t pixel;
    uint64_t order; /* drawn in increasing order */
} place;

typedef struct offset {
    long row, column;
    double distance;
} offset;

typedef struct filling {
    haft_map *map;
    size_t missing;
    place *place;         /* missing of them, in drawing order */
    size_t offsets;       /* to neighbours */
    offset *offset;       /* offsets of them, the nearest first */
    unsigned char *known; /* of each pixel */
    double *covariance;   /* rows x 2 (columns/2 + 1), the layout of FFTW's in-place transform */
    size_t stride;        /* of the covariance's rows */
} filling;

size_t haft_map_count_missing(const haft_map *map) {
    size_t missing = 0;
    for (size_t i = 0; i < map->rows * map->columns; i++) {
        missing += isnan(map->z[i]) != 0;
    }
    return missing;
}

static int compare_places(const void *a, const void *b) {
    const place *x = a, *y = b;
    return x->order != y->order ? (x->order > y->order) - (x->order < y->order)
                                : (x->pixel > y->pixel) - (x->pixel < y->pixel);
}

static int compare_offsets(const void *a, const void *b) {
    const offset *x = a, *y = b;
    if (x->distance != y->distance) {
        return (x->distance > y->distance) - (x->distance < y->distance);
    }
    return x->row != y->row ? (x->row > y->row) - (x->row < y->row)
                            : (x->column > y->column) - (x->column < y->column);
}

/* Coarse grids first; in random order within a grid. */
static void order_places(filling *f) {
    haft_random_key key = {0, HAFT_RANDOM_MISSING_PIXELS};
    size_t n = 0;
    for (size_t k = 0; k < f->map->rows * f->map->columns; k++) {
        f->known[k] = !isnan(f->map->z[k]);
        if (f->known[k]) {
            continue;
        }
        size_t bits = (k / f->map->columns) | (k % f->map->columns);
        uint64_t level = 0, words[4];
        while (level < LEVELS && !(bits >> level & 1)) {
            level++;
        }
        haft_random_words(key, 0, k, 0, words);
        f->place[n++] = (place){k, (LEVELS - level) << 56 | words[0] >> 8};
    }
    qsort(f->place, f->missing, sizeof *f->place, compare_places);
}

static void order_offsets(filling *f, long reach) {
    const haft_map *map = f->map;
    double least = fmin(map->step_row, map->step_column);
    f->offsets = 0;
    for (long i = -reach; i <= reach; i++) {
        for (long j = -reach; j <= reach; j++) {
            double d = hypot((double)i * map->step_row, (double)j * map->step_column) / least;
            if (i != 0 || j != 0) {
                f->offset[f->offsets++] = (offset){i, j, d};
            }
        }
    }
    qsort(f->offset, f->offsets, sizeof *f->offset, compare_offsets);
}

static double covariance_at(const filling *f, long i, long j) {
    size_t row = (size_t)(i < 0 ? i + (long)f->map->rows : i);
    size_t column = (size_t)(j < 0 ? j + (long)f->map->columns : j);
    return f->covariance[row * f->stride + column];
}

/* ---- one height ---- */

/* A Cholesky factor of the neighbours' covariance, extended by one neighbour at a time. `cross` and
 * `height` are the neighbours' covariances with the pixel and their heights, after forward
 * substitution with it. */
typedef struct factor {
    int n;
    long row[NEIGHBOURS], column[NEIGHBOURS];
    double l[NEIGHBOURS][NEIGHBOURS], cross[NEIGHBOURS], height[NEIGHBOURS];
} factor;

static void add_neighbour(factor *g, const filling *f, long row, long column, double z) {
    int n = g->n;
    double variance = f->covariance[0], pivot = variance;
    double cross = covariance_at(f, row, column), *line = g->l[n];
    for (int p = 0; p < n; p++) {
        double rest = covariance_at(f, row - g->row[p], column - g->column[p]);
        for (int m = 0; m < p; m++) {
            rest -= line[m] * g->l[p][m];
        }
        line[p] = rest / g->l[p][p];
        pivot -= line[p] * line[p];
        cross -= line[p] * g->cross[p];
        z -= line[p] * g->height[p];
    }
    if (pivot > REDUNDANT * variance) {
        line[n] = sqrt(pivot);
        g->cross[n] = cross / line[n];
        g->height[n] = z / line[n];
        g->row[n] = row;
        g->column[n] = column;
        g->n = n + 1;
    }
}

static void condition(const filling *f, size_t pixel, double *mean, double *variance) {
    long rows = (long)f->map->rows, columns = (long)f->map->columns;
    long i = (long)pixel / columns, j = (long)pixel % columns;
    factor g;
    g.n = 0;
    int seen = 0;
    for (size_t k = 0; k < f->offsets && seen < NEIGHBOURS; k++) {
        long row = i + f->offset[k].row, column = j + f->offset[k].column;
        if (row < 0 || row >= rows || column < 0 || column >= columns ||
            !f->known[row * columns + column]) {
            continue;
        }
        seen++;
        add_neighbour(&g, f, f->offset[k].row, f->offset[k].column,
                      f->map->z[row * columns + column]);
    }
    *mean = 0;
    *variance = f->covariance[0];
    for (int p = 0; p < g.n; p++) {
        *mean += g.cross[p] * g.height[p];
        *variance -= g.cross[p] * g.cross[p];
    }
}

/* Redraws all missing heights; the first pass sets them to their means. */
static void draw_heights(filling *f, uint64_t pass) {
    haft_random_key key = {0, HAFT_RANDOM_MISSING_PIXELS};
    for (size_t k = 0; k < f->missing; k++) {
        f->known[f->place[k].pixel] = 0;
    }
    for (size_t k = 0; k < f->missing; k++) {
        size_t pixel = f->place[k].pixel;
        double mean, variance, normal;
        condition(f, pixel, &mean, &variance);
        haft_random_normals(key, pass, pixel, 4, 1, &normal);
        f->map->z[pixel] = mean + (pass > 0 ? sqrt(fmax(0, variance)) * normal : 0);
        f->known[pixel] = 1;
    }
}

/* ---- the covariance ---- */

/* The PSD of the filled map, up to the corners of the plane of wave vectors. */
static haft_status take_psd(haft_psd_table **psd, const filling *f, haft_error *error) {
    const haft_map *map = f->map;
    haft_rings rings = {.n = 0};
    double side = fmin((double)map->rows * map->step_row, (double)map->columns * map->step_column);
    double most = M_PI * hypot(1 / map->step_row, 1 / map->step_column);
    haft_status status = haft_rings_create(&rings, 2 * M_PI / side, most, error);
    HAFT_THEN(status, haft_rings_enter(&rings, map, HAFT_WINDOW_HANN, most, 1, error));
    HAFT_THEN(status, haft_rings_to_table(psd, &rings, error));
    haft_rings_destroy(&rings);
    return status;
}

/* s of the PSD, or of a power law if there is no PSD yet. */
static double power_at(const haft_psd_table *psd, double zeta, double least) {
    return psd != NULL
               ? haft_psd_table_value(psd, fmin(fmax(zeta, psd->zeta[0]), psd->zeta[psd->n - 1]))
               : pow(fmax(zeta, least) / least, GUESS_EXPONENT);
}

/* The covariance: sum over the lattice's modes of s cos(k r) times the area of a mode's cell. The
 * factor of the first guess does not matter, since only means depend on it. */
static haft_status take_covariance(filling *f, const haft_psd_table *psd, haft_error *error) {
    const haft_map *map = f->map;
    size_t rows = map->rows, columns = map->columns;
    double across = 2 * M_PI / ((double)rows * map->step_row);
    double along = 2 * M_PI / ((double)columns * map->step_column);
    double least = 4 * fmax(across, along), cell = psd != NULL ? across * along : 1;
    fftw_plan plan = fftw_plan_dft_c2r_2d((int)rows, (int)columns, (fftw_complex *)f->covariance,
                                          f->covariance, FFTW_ESTIMATE);
    if (plan == NULL) {
        return haft_error_set(error, HAFT_ERROR_LIBRARY,
                              "FFTW makes no plan for a map of %zu x %zu", rows, columns);
    }
    for (size_t i = 0; i < rows; i++) {
        double ky = across * (double)(i <= rows / 2 ? i : rows - i);
        for (size_t j = 0; j < columns / 2 + 1; j++) {
            double *mode = f->covariance + i * f->stride + 2 * j;
            mode[0] = cell * power_at(psd, hypot(ky, along * (double)j), least);
            mode[1] = 0;
        }
    }
    fftw_execute(plan);
    fftw_destroy_plan(plan);
    return HAFT_OK;
}

/* ---- the passes ---- */

static haft_status run_passes(filling *f, haft_error *error) {
    double share = (double)f->missing / (double)(f->map->rows * f->map->columns);
    uint64_t passes = 3 + (uint64_t)ceil(-2 / log10(share));
    haft_status status = take_covariance(f, NULL, error);
    for (uint64_t pass = 0; pass <= passes && status == HAFT_OK; pass++) {
        haft_psd_table *psd = NULL;
        draw_heights(f, pass);
        if (pass < passes) {
            status = take_psd(&psd, f, error);
            HAFT_THEN(status, take_covariance(f, psd, error));
        }
        haft_psd_table_destroy(&psd);
    }
    return status;
}

static haft_status allocate(filling *f, long reach, haft_error *error) {
    size_t pixels = f->map->rows * f->map->columns, side = 2 * (size_t)reach + 1;
    f->stride = 2 * (f->map->columns / 2 + 1);
    f->place = haft_memory_alloc(f->missing, sizeof *f->place, error);
    f->offset = haft_memory_alloc(side * side, sizeof *f->offset, error);
    f->known = haft_memory_alloc(pixels, sizeof *f->known, error);
    f->covariance = haft_memory_alloc(f->map->rows * f->stride, sizeof *f->covariance, error);
    return f->place != NULL && f->offset != NULL && f->known != NULL && f->covariance != NULL
               ? HAFT_OK
               : HAFT_ERROR_MEMORY;
}

/* Adds a constant to the known heights, or to all (known == NULL). */
static void shift(haft_map *map, const unsigned char *known, double by) {
    for (size_t k = 0; k < map->rows * map->columns; k++) {
        map->z[k] += known == NULL || known[k] ? by : 0;
    }
}

haft_status haft_map_fill(haft_map *map, haft_error *error) {
    size_t pixels = map->rows * map->columns,
           side = map->rows < map->columns ? map->rows : map->columns;
    filling f = {.map = map, .missing = haft_map_count_missing(map)};
    if (f.missing == 0) {
        return HAFT_OK;
    }
    if ((double)f.missing > HAFT_MISSING_MOST * (double)pixels) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%zu of the map's %zu pixels are missing or masked, %.3g %%; up to "
                              "%.0f %% can be filled, and a PSD told: crop the map to where it is "
                              "whole, or mask less",
                              f.missing, pixels, 100 * (double)f.missing / (double)pixels,
                              100 * HAFT_MISSING_MOST);
    }
    double mean = 0, square = 0, n = (double)(pixels - f.missing);
    for (size_t k = 0; k < pixels; k++) {
        mean += isnan(map->z[k]) ? 0 : map->z[k] / n;
    }
    for (size_t k = 0; k < pixels; k++) {
        square += isnan(map->z[k]) ? 0 : (map->z[k] - mean) * (map->z[k] - mean);
    }
    long reach = (long)(side - 1) / 2 < REACH_MOST ? (long)(side - 1) / 2 : REACH_MOST;
    reach = reach > 1 ? reach : 1;
    haft_status status = allocate(&f, reach, error);
    if (status == HAFT_OK) {
        order_places(&f);
        order_offsets(&f, reach);
        shift(map, f.known, -mean);
        if (square > 0) {
            status = run_passes(&f, error);
        }
        for (size_t k = 0; k < f.missing && !(square > 0); k++) {
            map->z[f.place[k].pixel] = 0;
        }
        shift(map, NULL, mean);
    }
    haft_memory_free(f.place);
    haft_memory_free(f.offset);
    haft_memory_free(f.known);
    haft_memory_free(f.covariance);
    return status;
}
