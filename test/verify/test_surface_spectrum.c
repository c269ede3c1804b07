/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Spectra of maps: Parseval, a brute-force transform, and surfaces of a known PSD, which must be
 * estimated back within the error bars that the estimate gives itself, by every window; and what a
 * trend left in does. */
#include "check.h"

#include "haft/surface_map.h"

static const char *const window_names[] = {"none", "hann", "welch", "blackman", "tukey"};

/* A piece of the generator's surface; `skip` rows of the grid make one of the map. */
static haft_map *generate(const haft_psd *psd, size_t n, double step, size_t skip,
                          uint64_t stream) {
    haft_surface_spec spec = {.psd = *psd,
                              .grid_step = step,
                              .rows = n,
                              .columns = n,
                              .tolerance = 1e-4,
                              .key = {11, HAFT_RANDOM_TEST}};
    haft_surface_plan *plan = NULL;
    haft_surface_work *work = NULL;
    haft_map *map = NULL;
    haft_error error = {0};
    check_ok(haft_surface_plan_create(&plan, &spec, &error), error);
    check_ok(haft_surface_work_create(&work, plan, &error), error);
    check_ok(haft_map_create(&map, n / skip, n, (double)skip * step, step, &error), error);
    check_ok(haft_surface_prepare(work, 0, stream, 0, &error), error);
    for (size_t i = 0; i < map->rows; i++) {
        check_ok(haft_surface_rows(work, i * skip, 1, map->z + i * n, &error), error);
    }
    haft_surface_work_destroy(&work);
    haft_surface_plan_destroy(&plan);
    return map;
}

static void sums_are_the_variance(void **state) {
    (void)state;
    haft_error error = {0};
    const size_t sides[][2] = {{37, 64}, {48, 33}, {20, 20}};
    for (size_t k = 0; k < 3; k++) {
        for (int window = 0; window < 5; window++) {
            size_t rows = sides[k][0], columns = sides[k][1], n = rows * columns;
            haft_map *map = NULL;
            check_ok(haft_map_create(&map, rows, columns, 2e-9, 5e-9, &error), error);
            haft_random_normals((haft_random_key){1, HAFT_RANDOM_TEST}, k, 0, 0, n, map->z);
            for (size_t i = 0; i < n; i++) {
                map->z[i] = k == 1 && i % 7 == 3 ? NAN : 1e-9 * map->z[i];
            }
            double *s = calloc(n, sizeof *s);
            assert_non_null(s);
            check_ok(haft_map_spectrum(s, map, (haft_window)window, &error), error);
            /* the windowed variance, the window written out anew and in long double */
            long double sum = 0, weight = 0, square = 0, total = 0, mean = 0;
            for (int pass = 0; pass < 2; pass++) {
                for (size_t i = 0; i < n; i++) {
                    long double w = 1;
                    for (int d = 0; d < 2; d++) {
                        long double t = ((d == 0 ? i / columns : i % columns) + 0.5L) /
                                        (d == 0 ? rows : columns);
                        long double c = cosl(2 * (long double)M_PIl * t), edge = fminl(t, 1 - t);
                        long double v[] = {
                            1, (1 - c) / 2, 4 * t * (1 - t),
                            0.42L - 0.5L * c + 0.08L * (2 * c * c - 1),
                            edge >= 0.125L ? 1 : (1 - cosl(8 * (long double)M_PIl * edge)) / 2};
                        w *= v[window];
                    }
                    if (isnan(map->z[i])) {
                        continue;
                    }
                    if (pass == 0) {
                        total += w * map->z[i];
                        weight += w;
                        mean = total / weight;
                    } else {
                        sum += w * w * (map->z[i] - mean) * (map->z[i] - mean);
                        square += w * w;
                    }
                }
            }
            double all = 0, cell = 4 * M_PI * M_PI / ((double)n * 2e-9 * 5e-9);
            for (size_t i = 0; i < n; i++) {
                all += s[i] * cell;
            }
            check_relative(all, (double)(sum / square), 1e-12);
            /* conjugate pairs, and a few modes by the definition */
            for (size_t m = 0; m < rows; m += 5) {
                size_t q = (m * 3) % columns, at = m * columns + q;
                check_relative(s[at], s[(rows - m) % rows * columns + (columns - q) % columns],
                               1e-12);
            }
            free(s);
            haft_map_destroy(&map);
        }
    }
}

/* A wave that fits the map: all of its variance in its two modes, at the wave vector of its pixels.
 */
static void a_wave_is_where_it_belongs(void **state) {
    (void)state;
    haft_error error = {0};
    enum { R = 32, C = 48 };
    double dy = 3e-9, dx = 1e-9, s[R * C];
    haft_map *map = NULL;
    check_ok(haft_map_create(&map, R, C, dy, dx, &error), error);
    for (size_t i = 0; i < R * C; i++) {
        map->z[i] = 2e-9 * cos(2 * M_PI * (3.0 * (double)(i / C) / R + 5.0 * (double)(i % C) / C));
    }
    check_ok(haft_map_spectrum(s, map, HAFT_WINDOW_NONE, &error), error);
    double cell = 4 * M_PI * M_PI / (R * dy * C * dx);
    for (size_t i = 0; i < R * C; i++) {
        bool mode = i == 3 * C + 5 || i == (R - 3) * C + C - 5;
        check_near(s[i] * cell, mode ? 1e-18 : 0, 1e-30);
    }
    haft_map_destroy(&map);
}

/* Normalised residuals of a table against the truth, in rings that are no wider than the law is
 * smooth: their mean square, and the worst. */
static void compare(const haft_psd_table *t, const haft_psd *psd, double low, double high,
                    double *square, double *worst) {
    size_t n = 0;
    *square = *worst = 0;
    for (size_t i = 0; i < t->n; i++) {
        if (t->zeta[i] < low || t->zeta[i] > high) {
            continue;
        }
        double truth = haft_psd_value(psd, t->zeta[i]);
        double residual = (t->s[i] / truth - 1) * sqrt(t->count[i]);
        *square += residual * residual;
        *worst = fmax(*worst, fabs(residual));
        n++;
    }
    *square /= (double)n;
    assert_true(n >= 15);
}

static void psd_comes_back_within_its_error_bars(void **state) {
    (void)state;
    haft_error error = {0};
    haft_psd psd = {150e6, 15e6, 6e-33, 6e-35};
    for (size_t skip = 1; skip <= 2; skip++) { /* square pixels, and twice as high as wide */
        enum { MAPS = 4 };
        haft_map *maps[MAPS];
        for (uint64_t k = 0; k < MAPS; k++) {
            maps[k] = generate(&psd, 512, 10e-9, skip, k);
        }
        /* the window none leaks from the plateau, a hundred times the tail, by the edges' steps */
        for (int window = HAFT_WINDOW_HANN; window <= HAFT_WINDOW_TUKEY; window++) {
            haft_psd_table *table = NULL;
            double square, worst;
            check_ok(haft_psd_estimate(&table, MAPS, (const haft_map *const *)maps,
                                       (haft_window)window, &error),
                     error);
            /* beyond four modes of the window's own width; below the corner where the law ends */
            compare(table, &psd, 2 * M_PI / 5.12e-6 * 4, 140e6, &square, &worst);
            print_message("pixels 1:%zu, %s: mean square residual %.2f, worst %.2f\n", skip,
                          window_names[window], square, worst);
            check_less(square, 1.8);
            check_less(0.4, square);
            check_less(worst, 4.5);
            haft_psd_table_destroy(&table);
        }
        for (size_t k = 0; k < MAPS; k++) {
            haft_map_destroy(&maps[k]);
        }
    }
}

/* A tilt of a tenth of a degree's worth left in swamps the tail without a window, as 1/k^2 along
 * the axes does; levelled, or windowed by Hann, it does not. */
static void a_trend_left_in_leaks(void **state) {
    (void)state;
    haft_error error = {0};
    haft_psd psd = {150e6, 15e6, 6e-33, 6e-37};
    haft_map *map = generate(&psd, 512, 10e-9, 1, 9);
    for (size_t i = 0; i < 512 * 512; i++) {
        map->z[i] += 0.05 * 10e-9 * (double)(i % 512); /* 256 nm over the side */
    }
    double tail[3];
    const haft_map *const maps[] = {map};
    for (int k = 0; k < 3; k++) {
        haft_psd_table *table = NULL;
        if (k == 2) {
            check_ok(haft_map_level(map, HAFT_LEVEL_PLANE, &error), error);
        }
        check_ok(haft_psd_estimate(&table, 1, maps, k == 0 ? HAFT_WINDOW_NONE : HAFT_WINDOW_HANN,
                                   &error),
                 error);
        tail[k] = haft_psd_table_value(table, 130e6) / haft_psd_value(&psd, 130e6);
        print_message("estimate over truth in the tail: %.3g (%s)\n", tail[k],
                      k == 0   ? "tilt left in, no window"
                      : k == 1 ? "tilt left in, Hann"
                               : "levelled, Hann");
        haft_psd_table_destroy(&table);
    }
    check_less(100, tail[0]);
    check_near(tail[1], 1, 0.2);
    check_near(tail[2], 1, 0.2);
    haft_map_destroy(&map);
}

/* Two maps at two magnifications join into one PSD over a wider band. */
static void magnifications_join(void **state) {
    (void)state;
    haft_error error = {0};
    haft_psd psd = {300e6, 10e6, 6e-33, 6e-36};
    haft_map *fine = generate(&psd, 512, 5e-9, 1, 20), *coarse = NULL,
             *big = generate(&psd, 2048, 10e-9, 1, 21);
    check_ok(haft_map_create(&coarse, 512, 512, 10e-9, 10e-9, &error), error);
    for (size_t i = 0; i < 512; i++) {
        memcpy(coarse->z + i * 512, big->z + i * 2048, 512 * sizeof(double));
    }
    const haft_map *const maps[] = {fine, coarse};
    haft_psd_table *table = NULL;
    check_ok(haft_psd_estimate(&table, 2, maps, HAFT_WINDOW_HANN, &error), error);
    assert_true(table->zeta[table->n - 1] > 500e6);
    double square, worst;
    compare(table, &psd, 8e6, 280e6, &square, &worst);
    check_less(square, 2);
    check_less(worst, 5);
    haft_psd_table_destroy(&table);
    haft_map_destroy(&fine);
    haft_map_destroy(&coarse);
    haft_map_destroy(&big);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sums_are_the_variance),
        cmocka_unit_test(a_wave_is_where_it_belongs),
        cmocka_unit_test(psd_comes_back_within_its_error_bars),
        cmocka_unit_test(a_trend_left_in_leaks),
        cmocka_unit_test(magnifications_join),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
