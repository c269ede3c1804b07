/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Maps levelled, masked and filled against what was put in; their statistics against closed forms;
 * PSD tables against quadrature. */
#include "check.h"

#include "haft/surface_map.h"

#include <gsl/gsl_integration.h>

enum { ROWS = 60, COLUMNS = 90 };

static haft_map *new_map(size_t rows, size_t columns, double step_row, double step_column) {
    haft_map *map = NULL;
    haft_error error = {0};
    check_ok(haft_map_create(&map, rows, columns, step_row, step_column, &error), error);
    return map;
}

static void fill_noise(haft_map *map, double deviation, uint64_t stream) {
    haft_random_key key = {3, HAFT_RANDOM_TEST};
    haft_random_normals(key, stream, 0, 0, map->rows * map->columns, map->z);
    for (size_t i = 0; i < map->rows * map->columns; i++) {
        map->z[i] *= deviation;
    }
}

/* What is taken off is all that was put on: levelling twice, or after adding a background, is
 * levelling once. */
static void levelling_is_a_projection(void **state) {
    (void)state;
    haft_error error = {0};
    for (int level = HAFT_LEVEL_MEAN; level <= HAFT_LEVEL_LINES; level++) {
        haft_map *map = new_map(ROWS, COLUMNS, 2e-9, 3e-9), *other = NULL;
        fill_noise(map, 1e-9, 0);
        map->z[5] = map->z[777] = NAN;
        check_ok(haft_map_copy(&other, map, &error), error);
        for (size_t i = 0; i < ROWS; i++) {
            for (size_t j = 0; j < COLUMNS; j++) {
                double x = 3e-9 * (double)j, y = 2e-9 * (double)i, add = 4e-9;
                add += level != HAFT_LEVEL_MEAN ? 0.01 * x - 0.02 * y : 0;
                add += level == HAFT_LEVEL_QUADRATIC ? 1e5 * x * x - 2e5 * x * y + 3e5 * y * y : 0;
                add += level == HAFT_LEVEL_LINES
                           ? 1e-9 * (double)(i % 7) + 0.003 * x * (double)(i % 5)
                           : 0;
                other->z[i * COLUMNS + j] += add;
            }
        }
        check_ok(haft_map_level(map, (haft_level)level, &error), error);
        check_ok(haft_map_level(other, (haft_level)level, &error), error);
        for (size_t i = 0; i < ROWS * COLUMNS; i++) {
            if (i != 5 && i != 777) {
                check_near(other->z[i], map->z[i], 1e-21);
            } else {
                assert_true(isnan(map->z[i]));
            }
        }
        haft_map_destroy(&map);
        haft_map_destroy(&other);
    }
}

/* A particle on a tilted plane: masked whole, and the plane that it tilted levelled. */
static void particles_are_masked(void **state) {
    (void)state;
    haft_error error = {0};
    haft_map *map = new_map(ROWS, COLUMNS, 1e-9, 1e-9), *clean = NULL;
    fill_noise(map, 1e-9, 1);
    check_ok(haft_map_copy(&clean, map, &error), error);
    for (size_t i = 0; i < 6; i++) {
        for (size_t j = 0; j < 8; j++) {
            map->z[i * COLUMNS + j] = 200e-9;
            clean->z[i * COLUMNS + j] = NAN;
        }
    }
    haft_clean_spec spec = {.level = HAFT_LEVEL_PLANE, .outlier_limit = 8};
    haft_clean_facts facts;
    check_ok(haft_map_clean(map, &spec, &facts, &error), error);
    check_ok(haft_map_level(clean, HAFT_LEVEL_PLANE, &error), error);
    assert_int_equal(facts.masked, 48);
    assert_int_equal(facts.missing, 0);
    for (size_t i = 0; i < ROWS * COLUMNS; i++) {
        assert_int_equal(isnan(map->z[i]) != 0, isnan(clean->z[i]) != 0);
        if (!isnan(map->z[i])) {
            check_near(map->z[i], clean->z[i], 1e-20);
        }
    }
    size_t masked = 0;
    assert_int_equal(haft_map_mask(map, 0.1, &masked, &error), HAFT_ERROR_INPUT);
    haft_map_destroy(&map);
    haft_map_destroy(&clean);
}

/* A line without pixels and one of a single pixel change nothing about the others. */
static void lines_without_pixels_are_left_out(void **state) {
    (void)state;
    haft_error error = {0};
    haft_map *map = new_map(ROWS, COLUMNS, 1e-9, 1e-9), *other = NULL;
    fill_noise(map, 1e-9, 2);
    check_ok(haft_map_copy(&other, map, &error), error);
    for (size_t j = 0; j < COLUMNS; j++) {
        other->z[5 * COLUMNS + j] = NAN;
        other->z[6 * COLUMNS + j] = j == 7 ? 3e-9 : (double)NAN;
    }
    check_ok(haft_map_level(map, HAFT_LEVEL_LINES, &error), error);
    check_ok(haft_map_level(other, HAFT_LEVEL_LINES, &error), error);
    for (size_t i = 0; i < ROWS * COLUMNS; i++) {
        if (i / COLUMNS == 5 || i / COLUMNS == 6) {
            assert_true(isnan(other->z[i]));
        } else {
            check_near(other->z[i], map->z[i], 1e-21);
        }
    }
    haft_map_destroy(&map);
    haft_map_destroy(&other);
}

/* Heights of three values, most of them one: their spread about the median is rounding alone. */
static void outliers_of_rounded_heights_cannot_be_told(void **state) {
    (void)state;
    haft_error error = {0};
    haft_map *map = new_map(ROWS, COLUMNS, 1e-9, 1e-9);
    for (size_t i = 0; i < ROWS * COLUMNS; i++) {
        map->z[i] = i % 97 == 0 ? 5e-9 : i % 89 == 0 ? -5e-9 : 0;
    }
    haft_clean_spec spec = {.level = HAFT_LEVEL_PLANE, .outlier_limit = 5};
    assert_int_equal(haft_map_clean(map, &spec, NULL, &error), HAFT_ERROR_INPUT);
    assert_non_null(strstr(error.message, "outliers cannot be told"));
    haft_map_destroy(&map);
}

/* Holes in a smooth surface are filled by what it must be; a map is always filled alike; what
 * cannot be filled is refused, and a map without holes left alone. */
static void holes_are_filled(void **state) {
    (void)state;
    enum { SIDE = 64 };
    haft_error error = {0};
    haft_map *map = new_map(SIDE, SIDE, 1e-9, 1e-9), *whole = NULL, *again = NULL;
    for (size_t i = 0; i < SIDE; i++) {
        for (size_t j = 0; j < SIDE; j++) {
            map->z[i * SIDE + j] = 1e-9 * sin(0.2 * (double)i) * cos(0.15 * (double)j) + 5e-9;
        }
    }
    check_ok(haft_map_copy(&whole, map, &error), error);
    check_ok(haft_map_fill(map, &error), error);
    assert_memory_equal(map->z, whole->z, sizeof(double) * SIDE * SIDE);
    for (size_t k = 0; k < SIDE * SIDE; k += 23) {
        map->z[k] = NAN;
    }
    assert_int_equal(haft_map_count_missing(map), 179);
    check_ok(haft_map_copy(&again, map, &error), error);
    check_ok(haft_map_fill(map, &error), error);
    check_ok(haft_map_fill(again, &error), error);
    assert_int_equal(haft_map_count_missing(map), 0);
    assert_memory_equal(map->z, again->z, sizeof(double) * SIDE * SIDE);
    for (size_t k = 0; k < SIDE * SIDE; k++) {
        check_near(map->z[k], whole->z[k], 1e-11); /* a hundredth of the amplitude */
    }
    for (size_t k = 0; k < 1300; k++) {
        map->z[k] = NAN;
    }
    assert_int_equal(haft_map_fill(map, &error), HAFT_ERROR_INPUT);
    assert_non_null(strstr(error.message, "up to 30 % can be filled"));
    haft_psd_table *table = NULL;
    const haft_map *const maps[] = {map};
    assert_int_equal(haft_psd_estimate(&table, 1, maps, HAFT_WINDOW_HANN, &error),
                     HAFT_ERROR_INPUT);
    for (size_t k = 0; k < SIDE * SIDE; k++) { /* no variance to draw from */
        map->z[k] = k == 70 ? NAN : 3e-9;
    }
    check_ok(haft_map_fill(map, &error), error);
    check_near(map->z[70], 3e-9, 1e-20);
    haft_map_destroy(&map);
    haft_map_destroy(&whole);
    haft_map_destroy(&again);
}

/* Whole periods of a wave: everything about it is known, differences included. */
static void statistics_of_a_wave(void **state) {
    (void)state;
    haft_error error = {0};
    size_t rows = 240, columns = 160;
    double dy = 2e-9, dx = 5e-9, k = 2 * M_PI * 4 / (160 * dx), h = 3e-9;
    haft_map *map = new_map(rows, columns, dy, dx);
    for (size_t i = 0; i < rows * columns; i++) {
        map->z[i] = 1e-6 + h * cos(k * dx * (double)(i % columns));
    }
    haft_map_statistics s;
    check_ok(haft_map_get_statistics(&s, map, &error), error);
    check_relative(s.mean, 1e-6, 1e-12);
    check_relative(s.rms, h / sqrt(2), 1e-11);
    check_near(s.skewness, 0, 1e-8);
    check_relative(s.kurtosis, 1.5, 1e-10);
    check_near(s.slope_y, 0, 1e-20);
    /* central differences of a wave: amplitude sin(k dx)/dx and (2 - 2 cos(k dx))/dx^2; the border
     * columns are left out, hence the tolerance */
    check_relative(s.slope_x, 0.5 * pow(h * sin(k * dx) / dx, 2), 0.02);
    check_relative(s.curvature_x, 0.5 * pow(h * (2 - 2 * cos(k * dx)) / (dx * dx), 2), 0.02);
    check_relative(s.moments.m2, 0.5 * s.slope_x, 1e-14);
    haft_map_destroy(&map);
}

/* Moving averages of white noise: the autocorrelation is a triangle (in each direction), so along
 * the radius it is known; holes must not bias it. */
static void correlation_length_of_known_noise(void **state) {
    (void)state;
    haft_error error = {0};
    enum { N = 300, WIDTH = 12 };
    haft_map *noise = new_map(N + WIDTH, N + WIDTH, 1e-9, 1e-9), *map = new_map(N, N, 1e-9, 1e-9);
    fill_noise(noise, 1e-9, 4);
    for (size_t i = 0; i < N; i++) {
        for (size_t j = 0; j < N; j++) {
            double sum = 0;
            for (size_t a = 0; a < WIDTH; a++) {
                for (size_t b = 0; b < WIDTH; b++) {
                    sum += noise->z[(i + a) * (N + WIDTH) + j + b];
                }
            }
            map->z[i * N + j] = (i / 30 + j / 40) % 5 == 0 ? NAN : sum;
        }
    }
    haft_map_statistics s;
    check_ok(haft_map_get_statistics(&s, map, &error), error);
    /* mean over angles of (1 - r cos t/W)(1 - r sin t/W) = 1 - 4r/(pi W) + r^2/(pi W^2) = 1/e */
    double r = WIDTH * (2 - sqrt(4 - M_PI * (1 - exp(-1))));
    check_relative(s.correlation_length, r * 1e-9, 0.06);
    haft_map_destroy(&noise);
    haft_map_destroy(&map);
}

/* ---- tables ---- */

typedef struct integrand {
    const haft_psd_table *table;
    int power;
} integrand;

static double evaluate(double zeta, void *parameters) {
    const integrand *f = parameters;
    return haft_psd_table_value(f->table, zeta) * pow(zeta, f->power);
}

static haft_psd_table *new_table(size_t n, const double *zeta, const double *s) {
    haft_psd_table *table = NULL;
    haft_error error = {0};
    check_ok(haft_psd_table_create(&table, n, &error), error);
    memcpy(table->zeta, zeta, n * sizeof *zeta);
    memcpy(table->s, s, n * sizeof *s);
    return table;
}

static void table_moments_are_integrals(void **state) {
    (void)state;
    const double zeta[] = {1e6, 5e6, 9e6, 3e7, 8e7},
                 s[] = {1e-32, 3e-32, 2e-32, 2e-32 / pow(30 / 9., 2), 1e-36};
    haft_psd_table *table = new_table(5, zeta, s);
    const int powers[] = {1, 3, 5};
    const double factors[] = {2 * M_PI, M_PI, 0.75 * M_PI};
    haft_psd_moments m = haft_psd_table_get_moments(table);
    const double moments[] = {m.m0, m.m2, m.m4};
    gsl_integration_workspace *work = gsl_integration_workspace_alloc(1000);
    for (int k = 0; k < 3; k++) {
        integrand parameters = {table, powers[k]};
        gsl_function f = {evaluate, &parameters};
        double sum = 0;
        for (int i = 0; i < 5; i++) {
            double part = 0, bound = 0;
            gsl_integration_qag(&f, i == 0 ? 0 : zeta[i - 1], zeta[i], 0, 1e-13, 1000,
                                GSL_INTEG_GAUSS61, work, &part, &bound);
            sum += part;
        }
        check_relative(moments[k], factors[k] * sum, 1e-12);
    }
    /* The tip's limit: the curvature up to it is its share of the tip's. */
    double radius = HAFT_TIP_SHARE * sqrt(3 / m.m4), limit = haft_psd_tip_limit(table, radius);
    haft_error error = {0};
    assert_true(limit > zeta[0] && limit < zeta[4]);
    assert_true(isinf(haft_psd_tip_limit(table, 1e-12)));
    check_ok(haft_psd_table_cut(table, limit, &error), error);
    check_relative(table->zeta[table->n - 1], limit, 1e-15);
    check_relative(2 * haft_psd_table_get_moments(table).m4 / 3, pow(HAFT_TIP_SHARE / radius, 2),
                   1e-11);
    assert_int_equal(haft_psd_table_cut(table, 1e5, &error), HAFT_ERROR_INPUT);
    gsl_integration_workspace_free(work);
    haft_psd_table_destroy(&table);
}

static void two_faces(void **state) {
    (void)state;
    haft_error error = {0};
    const double za[] = {1e6, 1e8}, sa[] = {4e-32, 4e-36}, zb[] = {2e6, 1e7, 5e7},
                 sb[] = {1e-32, 1e-33, 1e-35};
    haft_psd_table *a = new_table(2, za, sa), *b = new_table(3, zb, sb), *sum = NULL;
    check_ok(haft_psd_combine(&sum, a, b, 0, &error), error);
    assert_int_equal(sum->n, 4);
    for (double zeta = 1e6; zeta < 5e7; zeta *= 1.5) {
        /* between points the table's power is an interpolation of the sum */
        double exact = haft_psd_table_value(a, zeta) + haft_psd_table_value(b, zeta);
        check_relative(haft_psd_table_value(sum, zeta), exact, 0.1);
    }
    for (size_t i = 0; i < sum->n; i++) {
        check_relative(
            sum->s[i],
            haft_psd_table_value(a, sum->zeta[i]) + haft_psd_table_value(b, sum->zeta[i]), 1e-14);
    }
    haft_psd_table_destroy(&sum);
    check_ok(haft_psd_combine(&sum, a, a, 1, &error), error);
    check_relative(sum->s[0], 4 * sa[0], 1e-14);
    haft_psd_table_destroy(&sum);
    assert_int_equal(haft_psd_combine(&sum, a, a, -1, &error), HAFT_ERROR_INPUT);
    assert_non_null(strstr(error.message, "leave no roughness"));
    assert_int_equal(haft_psd_combine(&sum, a, b, 1.5, &error), HAFT_ERROR_INPUT);
    haft_psd_table_destroy(&a);
    haft_psd_table_destroy(&b);
}

/* Points on the law give the law; noisy ones give it inside the intervals as often as they say. */
static void fits_find_what_was_put_in(void **state) {
    (void)state;
    haft_error error = {0};
    haft_psd psd = {289e6, 19.4e6, 6.46e-33, 6.46e-38};
    double hurst = -0.5 * log(psd.s_1 / psd.s_0) / log(psd.zeta_max / psd.zeta_0) - 1;
    enum { N = 40, TRIALS = 200 };
    double zeta[N], s[N];
    for (int i = 0; i < N; i++) {
        zeta[i] = psd.zeta_max * pow(10, -2 * (1 - (double)i / (N - 1)));
        s[i] = haft_psd_value(&psd, fmin(zeta[i], psd.zeta_max));
    }
    haft_psd_table *table = new_table(N, zeta, s);
    haft_psd_fit fit;
    check_ok(haft_psd_fit_self_affine(&fit, table, &error), error);
    check_relative(fit.psd.zeta_0, psd.zeta_0, 1e-6);
    check_relative(fit.psd.s_0, psd.s_0, 1e-6);
    check_relative(fit.psd.s_1, psd.s_1, 1e-6);
    check_near(fit.hurst, hurst, 1e-6);
    int inside[3] = {0};
    for (int t = 0; t < TRIALS; t++) {
        for (int i = 0; i < N; i++) {
            /* the mean of `count` exponential numbers */
            int count = 3 + 2 * i;
            double sum = 0;
            for (int k = 0; k < count; k++) {
                uint64_t w[4];
                haft_random_words((haft_random_key){5, HAFT_RANDOM_TEST}, (uint64_t)t, (uint64_t)i,
                                  (uint64_t)k, w);
                sum -= log(haft_random_uniform(w[0]));
            }
            table->s[i] = s[i] * sum / count;
            table->count[i] = count;
        }
        check_ok(haft_psd_fit_self_affine(&fit, table, &error), error);
        const double truth[3] = {psd.s_0, psd.zeta_0, hurst};
        for (int k = 0; k < 3; k++) {
            inside[k] += fit.low[k] <= truth[k] && truth[k] <= fit.high[k];
        }
    }
    for (int k = 0; k < 3; k++) { /* 95 %, give or take four deviations of the count */
        print_message("truth inside the 95 %% interval: %.1f %%\n", 100.0 * inside[k] / TRIALS);
        check_near(inside[k] / (double)TRIALS, 0.95, 4 * sqrt(0.95 * 0.05 / TRIALS));
    }
    for (int i = 0; i < N; i++) {
        table->s[i] = 1e-33 * zeta[i];
    }
    assert_int_equal(haft_psd_fit_self_affine(&fit, table, &error), HAFT_ERROR_NUMERIC);
    table->n = 5;
    assert_int_equal(haft_psd_fit_self_affine(&fit, table, &error), HAFT_ERROR_INPUT);
    haft_psd_table_destroy(&table);
}

/* A table of the law, with an edge, a floor, or a bump on it. */
static haft_psd_table *shaped_table(double edge, double floor, double bump) {
    enum { N = 60 };
    haft_psd psd = {300e6, 20e6, 6e-33, 6e-33 * pow(15, -3.6)};
    double zeta[N], s[N];
    for (int i = 0; i < N; i++) {
        zeta[i] = 3e6 * pow(100, (double)i / (N - 1));
        s[i] = haft_psd_value(&psd, fmin(zeta[i], 300e6)) * (zeta[i] > edge ? 1e-5 : 1) + floor;
        s[i] *= i > 40 && i < 50 ? 1 + bump : 1;
    }
    haft_psd_table *table = new_table(N, zeta, s);
    for (int i = 0; i < N; i++) {
        table->count[i] = 2 + 5e-14 * zeta[i] * zeta[i];
    }
    return table;
}

/* The limits are found, the form comes back from inside them, and what does not fit is told. */
static void fits_know_their_limits(void **state) {
    (void)state;
    haft_error error = {0};
    haft_psd_fit fit;
    haft_psd_table *table = shaped_table(150e6, 0, 0);
    check_ok(haft_psd_fit_self_affine(&fit, table, &error), error);
    check_relative(fit.cut_off, 150e6, 0.05);
    check_relative(fit.psd.zeta_max, fit.cut_off, 0);
    check_relative(fit.psd.zeta_0, 20e6, 0.01);
    check_near(fit.hurst, 0.8, 0.01);
    assert_true(isinf(fit.noise_limit) && fit.p_value > 0.9);
    haft_psd_table_destroy(&table);
    table = shaped_table(INFINITY, 6e-36, 0);
    check_ok(haft_psd_fit_self_affine(&fit, table, &error), error);
    check_relative(fit.floor, 6e-36, 0.02);
    check_relative(fit.noise_limit, 20e6 * pow(1000, 1 / 3.6), 0.02);
    check_relative(fit.psd.zeta_max, fit.noise_limit, 0);
    check_near(fit.hurst, 0.8, 0.02);
    assert_true(isinf(fit.cut_off));
    haft_psd_table_destroy(&table);
    table = shaped_table(INFINITY, 0, 0.5);
    check_ok(haft_psd_fit_self_affine(&fit, table, &error), error);
    check_less(fit.p_value, 1e-3);
    check_less(0.1, fit.deviation);
    assert_true(fit.deviation_at > 60e6 && fit.deviation_at < 150e6);
    haft_psd_table_destroy(&table);
    table = shaped_table(INFINITY, 0, 0); /* a few long waves have most of the heights */
    for (size_t i = 0; i < table->n; i++) {
        table->s[i] *= table->zeta[i] > 7e6 && table->zeta[i] < 9e6 ? 300 : 1;
    }
    assert_int_equal(haft_psd_fit_self_affine(&fit, table, &error), HAFT_ERROR_NUMERIC);
    assert_non_null(strstr(error.message, "times the rms height of the map"));
    haft_psd_table_destroy(&table);
}

/* Without a plateau there is no roll-off, and no rms; with a slow fall no Hurst exponent. */
static void what_is_not_seen_is_not_determined(void **state) {
    (void)state;
    haft_error error = {0};
    haft_psd_fit fit;
    haft_psd_table *table = shaped_table(INFINITY, 0, 0);
    for (size_t i = 0; i < table->n; i++) {
        table->s[i] = 1e-33 * pow(table->zeta[i] / 1e7, -3.4);
    }
    check_ok(haft_psd_fit_self_affine(&fit, table, &error), error);
    assert_true(fit.low[1] == 0 && isinf(fit.high[0]) && isinf(fit.rms[2]));
    assert_true(!fit.determined[0] && !fit.determined[1] && fit.determined[2]);
    check_near(fit.hurst, 0.7, 0.01);
    for (size_t i = 0; i < table->n; i++) {
        table->s[i] = 1e-33 * pow(table->zeta[i] / 1e7, -1.5);
    }
    assert_int_equal(haft_psd_fit_self_affine(&fit, table, &error), HAFT_ERROR_NUMERIC);
    assert_non_null(strstr(error.message, "slower than that of any self-affine"));
    haft_psd_table_destroy(&table);
}

static void bad_maps_are_refused(void **state) {
    (void)state;
    haft_error error = {0};
    haft_map *map = NULL;
    assert_int_equal(haft_map_create(&map, 1, 5, 1, 1, &error), HAFT_ERROR_INPUT);
    assert_int_equal(haft_map_create(&map, 5, 40000, 1, 1, &error), HAFT_ERROR_INPUT);
    assert_int_equal(haft_map_create(&map, 5, 5, 0, 1, &error), HAFT_ERROR_INPUT);
    assert_int_equal(haft_map_create(&map, 5, 5, 1, NAN, &error), HAFT_ERROR_INPUT);
    map = new_map(8, 8, 1e-9, 1e-9);
    haft_map_statistics s;
    assert_int_equal(haft_map_get_statistics(&s, map, &error), HAFT_ERROR_INPUT);
    haft_psd_table *table = NULL;
    const haft_map *const maps[] = {map};
    assert_int_equal(haft_psd_estimate(&table, 1, maps, HAFT_WINDOW_HANN, &error),
                     HAFT_ERROR_INPUT);
    assert_int_equal(haft_psd_estimate(&table, 0, maps, HAFT_WINDOW_HANN, &error),
                     HAFT_ERROR_INPUT);
    assert_null(table);
    haft_map_destroy(&map);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(levelling_is_a_projection),
        cmocka_unit_test(particles_are_masked),
        cmocka_unit_test(lines_without_pixels_are_left_out),
        cmocka_unit_test(outliers_of_rounded_heights_cannot_be_told),
        cmocka_unit_test(holes_are_filled),
        cmocka_unit_test(statistics_of_a_wave),
        cmocka_unit_test(correlation_length_of_known_noise),
        cmocka_unit_test(table_moments_are_integrals),
        cmocka_unit_test(two_faces),
        cmocka_unit_test(fits_find_what_was_put_in),
        cmocka_unit_test(fits_know_their_limits),
        cmocka_unit_test(what_is_not_seen_is_not_determined),
        cmocka_unit_test(bad_maps_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
