/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The autocorrelation by Fourier transforms of the zero-padded map, and the number of pairs at each
 * lag by the same transforms of the mask. For any missing pixels their ratio is unbiased, except
 * for the error of the mean. */
#include "autocorrelation.h"

#include <complex.h>
#include <fftw3.h>
#include <math.h>

/* Replaces a padded real field by its correlation sums, the inverse transform of |transform|^2. */
static haft_status correlate(double *field, size_t rows, size_t columns, haft_error *error) {
    size_t half = columns / 2 + 1;
    fftw_complex *spectrum = haft_memory_alloc(rows * half, sizeof *spectrum, error);
    if (spectrum == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    fftw_plan forward =
        fftw_plan_dft_r2c_2d((int)rows, (int)columns, field, spectrum, FFTW_ESTIMATE);
    fftw_plan inverse =
        fftw_plan_dft_c2r_2d((int)rows, (int)columns, spectrum, field, FFTW_ESTIMATE);
    haft_status status = HAFT_OK;
    if (forward != NULL && inverse != NULL) {
        fftw_execute(forward);
        for (size_t i = 0; i < rows * half; i++) {
            double re = creal(spectrum[i]), im = cimag(spectrum[i]);
            spectrum[i] = (re * re + im * im) / (double)(rows * columns);
        }
        fftw_execute(inverse);
    } else {
        status = haft_error_set(error, HAFT_ERROR_LIBRARY,
                                "FFTW makes no plan for a map of %zu x %zu", rows, columns);
    }
    if (forward != NULL) {
        fftw_destroy_plan(forward);
    }
    if (inverse != NULL) {
        fftw_destroy_plan(inverse);
    }
    haft_memory_free(spectrum);
    return status;
}

haft_status haft_surface_autocorrelate(double *sum, double *pairs, const haft_map *map, double mean,
                                       haft_error *error) {
    size_t rows = 2 * map->rows, columns = 2 * map->columns;
    for (size_t k = 0; k < rows * columns; k++) {
        sum[k] = pairs[k] = 0;
    }
    for (size_t i = 0; i < map->rows; i++) {
        for (size_t j = 0; j < map->columns; j++) {
            double z = map->z[i * map->columns + j];
            sum[i * columns + j] = isnan(z) ? 0 : z - mean;
            pairs[i * columns + j] = isnan(z) ? 0 : 1;
        }
    }
    haft_status status = correlate(sum, rows, columns, error);
    return status == HAFT_OK ? correlate(pairs, rows, columns, error) : status;
}
