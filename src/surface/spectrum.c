/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Spectra of maps: a windowed periodogram, normalised to the windowed variance, and its ring means.
 * Callers fill missing pixels first, with heights drawn from the map's own spectrum: left out, they
 * would spread the power of long waves over all wave numbers. A window widens every line to a few
 * modes. It does not remove a trend, whose lines fall off only as 1/k^2 along the axes; levelling
 * does. */
#include "spectrum.h"

#include <fftw3.h>
#include <math.h>

static const double TUKEY_FLANK = 0.125;
static const double RING_RATIO = 1.0592537251772889; /* 10^(1/40) */

/* The window along one side, at the centre of pixel i. */
double haft_window_value(haft_window window, size_t i, size_t n) {
    double t = ((double)i + 0.5) / (double)n;
    double flank = fmin(t, 1 - t) / TUKEY_FLANK;
    switch (window) {
    case HAFT_WINDOW_HANN:
        return pow(sin(M_PI * t), 2);
    case HAFT_WINDOW_WELCH:
        return 1 - pow(2 * t - 1, 2);
    case HAFT_WINDOW_BLACKMAN:
        return 0.42 - 0.5 * cos(2 * M_PI * t) + 0.08 * cos(4 * M_PI * t);
    case HAFT_WINDOW_TUKEY:
        return flank >= 1 ? 1 : pow(sin(0.5 * M_PI * flank), 2);
    default:
        return 1;
    }
}

typedef struct weights {
    double square;     /* sum w^2 */
    double dependence; /* N sum w^4 / (sum w^2)^2 */
} weights;

/* Writes w (z - mean_w) to `field`, whose lines are `stride` apart. */
static haft_status weigh(double *field, size_t stride, weights *sums, const haft_map *map,
                         haft_window window, haft_error *error) {
    size_t rows = map->rows, columns = map->columns;
    double *along = haft_memory_alloc(columns, sizeof *along, error);
    if (along == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    for (size_t j = 0; j < columns; j++) {
        along[j] = haft_window_value(window, j, columns);
    }
    double sum = 0, total = 0, fourth = 0;
    *sums = (weights){.square = 0};
    for (size_t i = 0; i < rows; i++) {
        double across = haft_window_value(window, i, rows);
        for (size_t j = 0; j < columns; j++) {
            double z = map->z[i * columns + j], w = isnan(z) ? 0 : across * along[j];
            double square = w * w;
            sum += w;
            total += isnan(z) ? 0 : w * z;
            sums->square += square;
            fourth += square * square;
        }
    }
    double mean = total / sum;
    for (size_t i = 0; i < rows; i++) {
        double across = haft_window_value(window, i, rows);
        for (size_t j = 0; j < columns; j++) {
            double z = map->z[i * columns + j];
            field[i * stride + j] = isnan(z) ? 0 : across * along[j] * (z - mean);
        }
    }
    haft_memory_free(along);
    sums->dependence = (double)(rows * columns) * fourth / (sums->square * sums->square);
    return sums->square > 0 ? HAFT_OK
                            : haft_error_set(error, HAFT_ERROR_INPUT, "the map has no pixel");
}

/* The scaled half spectrum [rows][columns/2 + 1] of the windowed map. It is transformed and squared
 * in place, since memory access takes as long as the transform. */
static haft_status half_spectrum(double **out, weights *sums, const haft_map *map,
                                 haft_window window, haft_error *error) {
    size_t rows = map->rows, columns = map->columns, half = columns / 2 + 1;
    double *field = haft_memory_alloc(rows * half, 2 * sizeof *field, error);
    haft_status status = field != NULL ? HAFT_OK : HAFT_ERROR_MEMORY;
    HAFT_THEN(status, weigh(field, 2 * half, sums, map, window, error));
    fftw_plan plan = NULL;
    if (status == HAFT_OK) {
        plan = fftw_plan_dft_r2c_2d((int)rows, (int)columns, field, (fftw_complex *)field,
                                    FFTW_ESTIMATE);
        status = plan != NULL
                     ? HAFT_OK
                     : haft_error_set(error, HAFT_ERROR_LIBRARY,
                                      "FFTW makes no plan for a map of %zu x %zu", rows, columns);
    }
    if (status == HAFT_OK) {
        fftw_execute(plan);
        fftw_destroy_plan(plan);
        double scale = map->step_row * map->step_column / (4 * M_PI * M_PI * sums->square);
        for (size_t i = 0; i < rows * half; i++) {
            double re = field[2 * i], im = field[2 * i + 1];
            field[i] = scale * (re * re + im * im);
        }
    } else {
        haft_memory_free(field);
        field = NULL;
    }
    *out = field;
    return status;
}

haft_status haft_map_spectrum(double *s, const haft_map *map, haft_window window,
                              haft_error *error) {
    double *half = NULL;
    weights sums;
    haft_status status = half_spectrum(&half, &sums, map, window, error);
    size_t rows = map->rows, columns = map->columns, kept = columns / 2 + 1;
    for (size_t i = 0; status == HAFT_OK && i < rows; i++) {
        for (size_t j = 0; j < columns; j++) {
            s[i * columns + j] =
                j < kept ? half[i * kept + j] : half[(rows - i) % rows * kept + (columns - j)];
        }
    }
    haft_memory_free(half);
    return status;
}

/* ---- rings ---- */

void haft_rings_destroy(haft_rings *r) {
    haft_memory_free(r->edge);
}

haft_status haft_rings_create(haft_rings *r, double width, double most, haft_error *error) {
    double constant = width / (RING_RATIO - 1); /* above this wave number, ring widths grow */
    size_t room =
        (size_t)(fmin(most, constant) / width) + (size_t)(40 * log10(fmax(1, most / width))) + 8;
    double *data = haft_memory_alloc(room + 1, 4 * sizeof *data, error);
    if (data == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    *r = (haft_rings){.edge = data,
                      .weight = data + (room + 1),
                      .zeta = data + 2 * (room + 1),
                      .s = data + 3 * (room + 1)};
    r->edge[0] = 0.5 * width;
    while (r->edge[r->n] < most && r->n < room) {
        double here = r->edge[r->n];
        r->edge[++r->n] = here + fmax(width, (RING_RATIO - 1) * here);
    }
    return HAFT_OK;
}

/* Adds a mode to its ring. The search starts at *ring, that of the line's mode before, since zeta
 * increases along a line. */
static void enter_mode(haft_rings *r, size_t *ring, double zeta, double s, double independent) {
    if (zeta < r->edge[0] || zeta >= r->edge[r->n]) {
        return;
    }
    while (zeta >= r->edge[*ring + 1]) {
        ++*ring;
    }
    r->weight[*ring] += independent;
    r->zeta[*ring] += independent * zeta;
    r->s[*ring] += independent * s;
}

haft_status haft_rings_enter(haft_rings *r, const haft_map *map, haft_window window, double most,
                             double known, haft_error *error) {
    double *s = NULL;
    weights sums;
    HAFT_TRY(half_spectrum(&s, &sums, map, window, error));
    size_t rows = map->rows, columns = map->columns, half = columns / 2 + 1;
    double across = 2 * M_PI / ((double)rows * map->step_row);
    double along = 2 * M_PI / ((double)columns * map->step_column);
    for (size_t i = 0; i < rows; i++) {
        double ky = across * (double)(i <= rows / 2 ? i : rows - i);
        size_t ring = 0;
        for (size_t j = 0; j < half; j++) {
            double kx = along * (double)j, zeta = sqrt(kx * kx + ky * ky);
            bool twice = j > 0 && 2 * j < columns; /* its conjugate is not in the half spectrum */
            if (zeta > 0 && zeta <= most) {
                enter_mode(r, &ring, zeta, s[i * half + j],
                           (twice ? 1 : 0.5) * known / sums.dependence);
            }
        }
    }
    haft_memory_free(s);
    return HAFT_OK;
}

haft_status haft_rings_to_table(haft_psd_table **out, const haft_rings *r, haft_error *error) {
    size_t n = 0;
    for (size_t k = 0; k < r->n; k++) {
        n += r->s[k] > 0;
    }
    if (n < 2) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "the maps have no variance, or too few pixels for a spectrum");
    }
    haft_status status = haft_psd_table_create(out, n, error);
    size_t at = 0;
    for (size_t k = 0; status == HAFT_OK && k < r->n; k++) {
        if (r->s[k] > 0) {
            (*out)->zeta[at] = r->zeta[k] / r->weight[k];
            (*out)->s[at] = r->s[k] / r->weight[k];
            (*out)->count[at] = fmax(r->weight[k], 0.5);
            at++;
        }
    }
    return status;
}
