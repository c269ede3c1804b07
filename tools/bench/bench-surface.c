/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How long the surface of a beam takes, against a floor: a bare FFTW complex-to-real 2-D transform
 * of the same number of interior points, planned with the same flag.
 *
 *     bench-surface [PSD 1 or 2] [tolerance] [rows in a block] [repetitions] */
#include "bench.h"

#include "haft/surface.h"

#include <fftw3.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static double least(double a, double b) {
    return a < b ? a : b;
}

static double time_floor(int rows, int columns, int repetitions) {
    size_t half = (size_t)rows * ((size_t)columns / 2 + 1);
    fftw_complex *in = fftw_alloc_complex(half);
    double *out = fftw_alloc_real((size_t)rows * (size_t)columns);
    fftw_plan plan = fftw_plan_dft_c2r_2d(rows, columns, in, out, FFTW_ESTIMATE);
    double best = HUGE_VAL;
    for (int r = 0; r < repetitions; r++) {
        for (size_t i = 0; i < half; i++) {
            in[i][0] = in[i][1] = (double)(i % 7) - 3;
        }
        double start = haft_clock_seconds();
        fftw_execute(plan);
        best = least(best, haft_clock_seconds() - start);
    }
    fftw_destroy_plan(plan);
    fftw_free(in);
    fftw_free(out);
    return best;
}

/* Times the normal random numbers of the block alone. */
static double time_noise(const haft_surface_spec *spec, const haft_surface_facts *facts) {
    double lattice = (double)facts->lattice_ratio * spec->grid_step;
    size_t halo = (size_t)(facts->reach / lattice + 0.5);
    size_t rows = spec->rows / facts->lattice_ratio + 2 * halo;
    size_t columns = spec->columns / facts->lattice_ratio + 2 * halo;
    double *z = fftw_alloc_real(columns);
    double start = haft_clock_seconds();
    for (size_t i = 0; i < rows; i++) {
        haft_random_normals(spec->key, 0, i, 0, columns, z);
    }
    double time = haft_clock_seconds() - start;
    fftw_free(z);
    printf("noise lattice      %zu x %zu\n", rows, columns);
    return time;
}

static int run(const haft_surface_spec *spec, int repetitions, haft_error *error) {
    double start = haft_clock_seconds();
    haft_surface_plan *plan = NULL;
    haft_surface_work *work = NULL;
    if (haft_surface_plan_create(&plan, spec, error) != HAFT_OK ||
        haft_surface_work_create(&work, plan, error) != HAFT_OK) {
        return 1;
    }
    double planning = haft_clock_seconds() - start, prepare = HUGE_VAL, rows = HUGE_VAL,
           noise = HUGE_VAL;
    haft_surface_facts facts;
    haft_surface_get_facts(plan, &facts);
    double *z = fftw_alloc_real(64 * spec->columns);
    for (int r = 0; r < repetitions; r++) {
        start = haft_clock_seconds();
        if (haft_surface_prepare(work, 0, 0, r * (long)spec->rows, error) != HAFT_OK) {
            return 1;
        }
        double middle = haft_clock_seconds();
        for (size_t row = 0; row < spec->rows; row += 64) {
            size_t n = spec->rows - row < 64 ? spec->rows - row : 64;
            if (haft_surface_rows(work, row, n, z, error) != HAFT_OK) {
                return 1;
            }
        }
        rows = least(rows, haft_clock_seconds() - middle);
        prepare = least(prepare, middle - start);
    }
    noise = time_noise(spec, &facts);
    haft_psd_moments m = haft_psd_get_moments(&spec->psd);
    double floor = time_floor((int)spec->rows, (int)spec->columns, repetitions);
    printf("reach              %.3f um, taper loss %.3g, leak %.3g\n", 1e6 * facts.reach,
           facts.taper_loss, facts.leak);
    printf("moments off by     %.3g %.3g %.3g\n", facts.moments.m0 / m.m0 - 1,
           facts.moments.m2 / m.m2 - 1, facts.moments.m4 / m.m4 - 1);
    printf("work               %.1f MB; fine points with halo %.1f M of %.1f M\n",
           1e-6 * (double)facts.work_bytes, 1e-6 * (double)facts.halo_points,
           1e-6 * (double)(spec->rows * spec->columns));
    printf("plan               %.3f s, once\n", planning);
    printf("prepare            %.3f s, of which noise %.3f s\n", prepare, noise);
    printf("rows               %.3f s\n", rows);
    printf("floor              %.3f s\n", floor);
    printf("ratio              %.2f\n", (prepare + rows) / floor);
    fftw_free(z);
    haft_surface_work_destroy(&work);
    haft_surface_plan_destroy(&plan);
    return 0;
}

int main(int count, char **arguments) {
    static const haft_psd psds[2] = {{289e6, 19.4e6, 6.46e-33, 6.46e-39},
                                     {283e6, 40e6, 0.5e-33, 50e-39}};
    int which = count > 1 ? atoi(arguments[1]) : 1;
    haft_surface_spec spec = {
        .psd = psds[which == 2],
        .grid_step = 5e-9,
        .rows = count > 3 ? (size_t)atol(arguments[3]) : 2400,
        .columns = 6000,
        .tolerance = count > 2 ? atof(arguments[2]) : 1e-6,
        .key = {1, HAFT_RANDOM_TEST},
    };
    haft_error error = {0};
    if (run(&spec, count > 4 ? atoi(arguments[4]) : 3, &error) != 0) {
        fprintf(stderr, "bench-surface: %s\n", error.message);
        return 1;
    }
    return 0;
}
