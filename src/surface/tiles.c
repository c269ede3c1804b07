/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Windows of measured maps as patches. Maps are resampled once, by natural cubic splines through
 * the pixel centres in one direction after the other. This keeps the heights at the pixels and adds
 * hardly any waves shorter than the pixels resolve. */
#include "haft/surface_map.h"

#include <gsl/gsl_spline.h>
#include <math.h>
#include <string.h>

typedef struct sheet {
    size_t rows, columns;
    double *z;
} sheet;

typedef struct face {
    size_t n;
    sheet *sheet;
} face;

struct haft_tiling {
    face face[2];
    size_t rows, columns, tiles[2];
    haft_random_key key;
};

/* Resamples one line of n points, `stride` apart, from spacing `from` to spacing `to`. */
static void resample_line(gsl_spline *spline, gsl_interp_accel *accel, double *x, double *y,
                          const double *z, size_t n, size_t stride, double from, double to,
                          double *out, size_t m, size_t out_stride) {
    for (size_t i = 0; i < n; i++) {
        x[i] = (double)i * from;
        y[i] = z[i * stride];
    }
    gsl_spline_init(spline, x, y, n);
    gsl_interp_accel_reset(accel);
    for (size_t i = 0; i < m; i++) {
        out[i * out_stride] = gsl_spline_eval(spline, fmin((double)i * to, x[n - 1]), accel);
    }
}

/* Resamples `lines` lines of n points to m points each. */
static haft_status resample(const double *z, size_t lines, size_t n, size_t stride, size_t next,
                            double from, double to, double *out, size_t m, size_t out_stride,
                            size_t out_next, haft_error *error) {
    const gsl_interp_type *kind = n > 2 ? gsl_interp_cspline : gsl_interp_linear;
    gsl_spline *spline = gsl_spline_alloc(kind, n);
    gsl_interp_accel *accel = gsl_interp_accel_alloc();
    double *x = haft_memory_alloc(n, 2 * sizeof *x, error);
    haft_status status = HAFT_OK;
    if (spline == NULL || accel == NULL || x == NULL) {
        status = haft_error_set(error, HAFT_ERROR_MEMORY, "out of memory for a map's splines");
    }
    for (size_t line = 0; line < lines && status == HAFT_OK; line++) {
        resample_line(spline, accel, x, x + n, z + line * next, n, stride, from, to,
                      out + line * out_next, m, out_stride);
    }
    if (spline != NULL) {
        gsl_spline_free(spline);
    }
    if (accel != NULL) {
        gsl_interp_accel_free(accel);
    }
    haft_memory_free(x);
    return status;
}

static haft_status make_sheet(sheet *s, const haft_map *map, double step, haft_error *error) {
    s->columns = (size_t)((double)(map->columns - 1) * map->step_column / step * (1 + 1e-12)) + 1;
    s->rows = (size_t)((double)(map->rows - 1) * map->step_row / step * (1 + 1e-12)) + 1;
    for (size_t i = 0; i < map->rows * map->columns; i++) {
        if (isnan(map->z[i])) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "a map has missing pixels; set surface.missing: fill to use its "
                                  "windows");
        }
    }
    if (s->columns < 4 || s->rows < 4 || s->columns > 65536 || s->rows > 65536) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "a map of %zu x %zu points on a grid of %g nm; its windows need 4 to "
                              "65536 a side",
                              s->rows, s->columns, step * 1e9);
    }
    double *half = haft_memory_alloc(map->rows * s->columns, sizeof *half, error);
    s->z = haft_memory_alloc(s->rows * s->columns, sizeof *s->z, error);
    haft_status status = half != NULL && s->z != NULL ? HAFT_OK : HAFT_ERROR_MEMORY;
    HAFT_THEN(status, resample(map->z, map->rows, map->columns, 1, map->columns, map->step_column,
                               step, half, s->columns, 1, s->columns, error));
    HAFT_THEN(status, resample(half, s->columns, map->rows, s->columns, 1, map->step_row, step,
                               s->z, s->rows, s->columns, 1, error));
    haft_memory_free(half);
    return status;
}

static haft_status make_face(face *f, size_t n, const haft_map *const *maps, double step,
                             haft_error *error) {
    f->sheet = haft_memory_alloc(n, sizeof *f->sheet, error);
    haft_status status = f->sheet != NULL ? HAFT_OK : HAFT_ERROR_MEMORY;
    for (size_t k = 0; k < n && status == HAFT_OK; k++) {
        f->n = k + 1;
        status = make_sheet(&f->sheet[k], maps[k], step, error);
    }
    return status;
}

/* Divides a patch into windows that are at most half as long as the smallest map. */
static void lay_out(haft_tiling *t) {
    size_t least[2] = {SIZE_MAX, SIZE_MAX}, whole[2] = {t->rows, t->columns};
    for (int k = 0; k < 2; k++) {
        for (size_t i = 0; i < t->face[k].n; i++) {
            const sheet *s = &t->face[k].sheet[i];
            least[0] = s->rows < least[0] ? s->rows : least[0];
            least[1] = s->columns < least[1] ? s->columns : least[1];
        }
    }
    for (int k = 0; k < 2; k++) {
        size_t most = least[k] / 2;
        t->tiles[k] = (whole[k] + most - 1) / most;
    }
}

haft_status haft_tiling_create(haft_tiling **out, const haft_tiling_spec *spec, haft_error *error) {
    *out = NULL;
    if (spec->n == 0 || spec->rows == 0 || spec->columns == 0 || !(spec->grid_step > 0)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "patches of maps need a map, a grid and a size");
    }
    haft_tiling *t = haft_memory_alloc(1, sizeof *t, error);
    if (t == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    *t = (haft_tiling){
        .rows = spec->rows, .columns = spec->columns, .key = {spec->seed, HAFT_RANDOM_MAP_WINDOW}};
    haft_status status = make_face(&t->face[0], spec->n, spec->maps, spec->grid_step, error);
    if (status == HAFT_OK && spec->opposite_n > 0) {
        status = make_face(&t->face[1], spec->opposite_n, spec->opposite, spec->grid_step, error);
    }
    if (status == HAFT_OK) {
        lay_out(t);
    } else {
        haft_tiling_destroy(&t);
    }
    *out = t;
    return status;
}

void haft_tiling_destroy(haft_tiling **tiling) {
    if (tiling == NULL || *tiling == NULL) {
        return;
    }
    for (int k = 0; k < 2; k++) {
        face *f = &(*tiling)->face[k];
        for (size_t i = 0; i < f->n; i++) {
            haft_memory_free(f->sheet[i].z);
        }
        haft_memory_free(f->sheet);
    }
    haft_memory_free(*tiling);
    *tiling = NULL;
}

void haft_tiling_count(const haft_tiling *tiling, size_t count[2]) {
    count[0] = tiling->tiles[0];
    count[1] = tiling->tiles[1];
}

/* Adds a window of the face to rows [i0, i1) and columns [j0, j1). */
static void add_window(const haft_tiling *t, const face *f, const uint64_t words[4], size_t i0,
                       size_t i1, size_t j0, size_t j1, double *z) {
    const sheet *s = &f->sheet[words[0] % f->n];
    size_t rows = i1 - i0, columns = j1 - j0;
    size_t top = words[1] % (s->rows - rows + 1), left = words[2] % (s->columns - columns + 1);
    bool upside = words[3] >> 63, mirrored = words[3] >> 62 & 1;
    for (size_t i = 0; i < rows; i++) {
        const double *from = s->z + (top + (upside ? rows - 1 - i : i)) * s->columns + left;
        double *to = z + (i0 + i) * t->columns + j0;
        for (size_t j = 0; j < columns; j++) {
            to[j] += from[mirrored ? columns - 1 - j : j];
        }
    }
}

void haft_tiling_fill(const haft_tiling *tiling, uint64_t realization, uint64_t stream, double *z) {
    const haft_tiling *t = tiling;
    memset(z, 0, t->rows * t->columns * sizeof *z);
    for (size_t i = 0; i < t->tiles[0]; i++) {
        for (size_t j = 0; j < t->tiles[1]; j++) {
            for (uint64_t k = 0; k < 2; k++) {
                uint64_t words[4], draw = 2 * (i * t->tiles[1] + j) + k;
                if (t->face[k].n > 0) {
                    haft_random_words(t->key, realization, stream, draw, words);
                    add_window(t, &t->face[k], words, t->rows * i / t->tiles[0],
                               t->rows * (i + 1) / t->tiles[0], t->columns * j / t->tiles[1],
                               t->columns * (j + 1) / t->tiles[1], z);
                }
            }
        }
    }
}
