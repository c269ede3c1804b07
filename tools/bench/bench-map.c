/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How long a map takes from file to PSD, against a bare FFT of the same size; and how long a
 * non-Gaussian surface takes, against a Gaussian one.
 *
 *     bench-map [pixels a side] [repetitions] */
#include "bench.h"

#include "haft/io.h"

#include <fftw3.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

static double time_floor(size_t side, int repetitions) {
    double *in = fftw_alloc_real(side * side), time[64];
    fftw_complex *out = fftw_alloc_complex(side * (side / 2 + 1));
    fftw_plan plan = fftw_plan_dft_r2c_2d((int)side, (int)side, in, out, FFTW_ESTIMATE);
    for (int r = 0; r < repetitions; r++) {
        for (size_t i = 0; i < side * side; i++) {
            in[i] = (double)(i % 101);
        }
        double start = haft_clock_seconds();
        fftw_execute(plan);
        time[r] = haft_clock_seconds() - start;
    }
    fftw_destroy_plan(plan);
    fftw_free(in);
    fftw_free(out);
    return median(time, repetitions);
}

/* Times the three stages of the way: medians of import, cleaning and spectrum. */
static void time_way(const char *path, int repetitions, double stage[3]) {
    haft_error error = {0};
    double time[3][64];
    for (int r = 0; r < repetitions; r++) {
        haft_map *map = NULL;
        haft_psd_table *table = NULL;
        double a = haft_clock_seconds();
        must(haft_map_read(&map, path, NULL, NULL, &error), &error);
        double b = haft_clock_seconds();
        must(haft_map_level(map, HAFT_LEVEL_PLANE, &error), &error);
        double c = haft_clock_seconds();
        const haft_map *const maps[] = {map};
        must(haft_psd_estimate(&table, 1, maps, HAFT_WINDOW_HANN, &error), &error);
        double d = haft_clock_seconds();
        time[0][r] = b - a;
        time[1][r] = c - b;
        time[2][r] = d - c;
        haft_psd_table_destroy(&table);
        haft_map_destroy(&map);
    }
    for (int k = 0; k < 3; k++) {
        stage[k] = median(time[k], repetitions);
    }
}

static double time_surface(const haft_marginal *marginal, int repetitions, double *planning) {
    haft_error error = {0};
    haft_surface_spec spec = {.psd = {289e6, 19.4e6, 6.46e-33, 6.46e-39},
                              .marginal = marginal,
                              .grid_step = 5e-9,
                              .rows = 600,
                              .columns = 6000,
                              .key = {1, HAFT_RANDOM_TEST}};
    haft_surface_plan *plan = NULL;
    haft_surface_work *work = NULL;
    double time[64], *z = fftw_alloc_real(spec.rows * spec.columns), start = haft_clock_seconds();
    must(haft_surface_plan_create(&plan, &spec, &error), &error);
    *planning = haft_clock_seconds() - start;
    must(haft_surface_work_create(&work, plan, &error), &error);
    for (int r = 0; r < repetitions; r++) {
        start = haft_clock_seconds();
        must(haft_surface_prepare(work, 0, (uint64_t)r, 0, &error), &error);
        must(haft_surface_rows(work, 0, spec.rows, z, &error), &error);
        time[r] = haft_clock_seconds() - start;
    }
    haft_surface_work_destroy(&work);
    haft_surface_plan_destroy(&plan);
    fftw_free(z);
    return median(time, repetitions);
}

int main(int count, char **arguments) {
    size_t side = count > 1 ? (size_t)atol(arguments[1]) : 1024;
    int repetitions = count > 2 ? atoi(arguments[2]) : 9;
    if (side < 8 || side > 8192 || repetitions < 1 || repetitions > 64) {
        fprintf(stderr, "bench-map: 8 to 8192 pixels a side, 1 to 64 repetitions\n");
        return 2;
    }
    haft_error error = {0};
    haft_map *map = NULL;
    char path[] = "/tmp/haft-bench-map-XXXXXX";
    int descriptor = mkstemp(path);
    if (descriptor < 0) {
        perror("bench-map");
        return 1;
    }
    close(descriptor);
    must(haft_map_create(&map, side, side, 5e-9, 5e-9, &error), &error);
    haft_random_normals((haft_random_key){1, HAFT_RANDOM_TEST}, 0, 0, 0, side * side, map->z);
    for (size_t i = 0; i < side * side; i++) {
        map->z[i] *= 1e-9;
    }
    must(haft_map_write(map, path, &error), &error);
    haft_map_destroy(&map);
    double stage[3], floor = time_floor(side, repetitions);
    time_way(path, repetitions, stage);
    unlink(path);
    double all = stage[0] + stage[1] + stage[2];
    printf("map of %zu x %zu: import %.4f s, levelling %.4f s, PSD %.4f s\n", side, side, stage[0],
           stage[1], stage[2]);
    printf("floor, a bare FFT  %.4f s\n", floor);
    printf("ratio              %.2f\n", all / floor);

    haft_marginal *m = NULL;
    must(haft_marginal_johnson(&m, 0.5, 3.5, &error), &error);
    double planning[2], plain = time_surface(NULL, repetitions, &planning[0]);
    double translated = time_surface(m, repetitions, &planning[1]);
    printf("Gaussian surface   %.4f s (planning %.2f s)\n", plain, planning[0]);
    printf("non-Gaussian       %.4f s (planning %.2f s)\n", translated, planning[1]);
    printf("ratio              %.2f\n", translated / plain);
    haft_marginal_destroy(&m);
    return 0;
}
