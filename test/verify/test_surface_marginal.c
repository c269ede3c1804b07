/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Non-Gaussian surfaces: distributions against closed forms, generated moments within sampling
 * error, radial PSD within their scatter, and the Gaussian surface as their limit. */
#include "check.h"

#include "haft/surface_map.h"

#include <gsl/gsl_cdf.h>

static const haft_psd DELRIO = {289e6, 19.4e6, 6.46e-33, 6.46e-39};

typedef struct field {
    haft_surface_plan *plan;
    haft_surface_work *work;
    size_t side;
} field;

static field open_field(const haft_psd *psd, const haft_psd_table *table,
                        const haft_marginal *marginal, size_t side, double step) {
    haft_surface_spec spec = {.table = table,
                              .marginal = marginal,
                              .grid_step = step,
                              .rows = side,
                              .columns = side,
                              .tolerance = 1e-5,
                              .key = {21, HAFT_RANDOM_TEST}};
    if (psd != NULL) {
        spec.psd = *psd;
    }
    field f = {.side = side};
    haft_error error = {0};
    check_ok(haft_surface_plan_create(&f.plan, &spec, &error), error);
    check_ok(haft_surface_work_create(&f.work, f.plan, &error), error);
    return f;
}

static void draw(const field *f, uint64_t stream, double *z) {
    haft_error error = {0};
    check_ok(haft_surface_prepare(f->work, 0, stream, 0, &error), error);
    check_ok(haft_surface_rows(f->work, 0, f->side, z, &error), error);
}

static void close_field(field *f) {
    haft_surface_work_destroy(&f->work);
    haft_surface_plan_destroy(&f->plan);
}

static void johnson_has_the_moments_asked_for(void **state) {
    (void)state;
    static const double pairs[][2] = {
        {0, 3},  {0, 1.5}, {0, 2.4}, {0, 5},     {0.5, 3.2},    {-0.5, 3.2}, {1, 5},  {-1, 4},
        {2, 10}, {0.3, 2}, {1, 2.4}, {0.1, 3.0}, {0.545, 3.38}, {0, 3.001},  {3, 30}, {1.2, 5.7}};
    for (size_t k = 0; k < sizeof pairs / sizeof *pairs; k++) {
        haft_marginal *m = NULL;
        haft_error error = {0};
        check_ok(haft_marginal_johnson(&m, pairs[k][0], pairs[k][1], &error), error);
        haft_marginal_facts facts = haft_marginal_get_facts(m);
        print_message("%g, %g: %s\n", pairs[k][0], pairs[k][1], facts.name);
        check_near(facts.skewness, pairs[k][0], 1e-4);
        check_relative(facts.kurtosis, pairs[k][1], 1e-4);
        /* by another rule, Gauss-free: equal probabilities, 2e5 of them; and it rises */
        double mean = 0, square = 0, third = 0, before = -INFINITY;
        enum { N = 200000 };
        for (int i = 0; i < N; i++) {
            double q = haft_marginal_value(m, gsl_cdf_ugaussian_Pinv((i + 0.5) / N));
            assert_true(q >= before);
            before = q;
            mean += q / N;
            square += q * q / N;
            third += q * q * q / N;
        }
        check_near(mean, 0, 1e-4);
        check_near(square, 1, 3e-3);
        check_near(third, pairs[k][0], 0.02 + 0.02 * fabs(pairs[k][0]));
        haft_marginal_destroy(&m);
    }
}

static void lognormal_is_lognormal(void **state) {
    (void)state;
    haft_error error = {0};
    haft_marginal *m = NULL;
    double w = exp(0.3 * 0.3), skewness = (w + 2) * sqrt(w - 1),
           kurtosis = pow(w, 4) + 2 * pow(w, 3) + 3 * w * w - 3;
    check_ok(haft_marginal_johnson(&m, skewness, kurtosis, &error), error);
    for (double g = -5; g <= 5; g += 0.25) {
        double exact = (exp(0.3 * g) - sqrt(w)) / sqrt(w * (w - 1));
        check_near(haft_marginal_value(m, g), exact, 1e-6 * (1 + fabs(exact)));
    }
    haft_marginal_destroy(&m);
}

/* Each is refused, and what the message names instead is taken, and is the nearest: a kurtosis
 * lower by a two-hundredth is refused again. */
static void impossible_pairs_are_refused(void **state) {
    (void)state;
    static const double pairs[][2] = {{0, 1},      {0, 0.5},   {2, 5},       {-2, 4.9},
                                      {0, 1.001},  {3, 10.01}, {-3, -7},     {20, 3},
                                      {0.5, 2001}, {-1, 1e9},  {0, INFINITY}};
    for (size_t k = 0; k < sizeof pairs / sizeof *pairs; k++) {
        haft_marginal *m = NULL;
        haft_error error = {0};
        assert_int_equal(haft_marginal_johnson(&m, pairs[k][0], pairs[k][1], &error),
                         HAFT_ERROR_INPUT);
        assert_null(m);
        const char *named = strstr(error.message, "can be had is ");
        assert_non_null(named);
        double nearest = strtod(named + strlen("can be had is "), NULL);
        check_ok(haft_marginal_johnson(&m, pairs[k][0], nearest, &error), error);
        check_relative(haft_marginal_get_facts(m).kurtosis, nearest, 3e-3); /* of 2000, by tails */
        haft_marginal_destroy(&m);
        assert_int_equal(haft_marginal_johnson(&m, pairs[k][0],
                                               nearest * (pairs[k][1] < nearest ? 0.995 : 1.005),
                                               &error),
                         HAFT_ERROR_INPUT);
    }
    static const double senseless[][2] = {{NAN, 3}, {0, NAN}, {20.1, 500}, {-INFINITY, 3}};
    for (size_t k = 0; k < sizeof senseless / sizeof *senseless; k++) {
        haft_marginal *m = NULL;
        haft_error error = {0};
        assert_int_equal(haft_marginal_johnson(&m, senseless[k][0], senseless[k][1], &error),
                         HAFT_ERROR_INPUT);
        assert_non_null(strstr(error.message, "kurtosis"));
        assert_null(m);
    }
}

/* Heights of a known distribution give that back, and their tails go on. */
static void heights_give_their_own_distribution(void **state) {
    (void)state;
    haft_error error = {0};
    enum { N = 100000 };
    double *z = malloc(N * sizeof *z);
    haft_marginal *known = NULL, *own = NULL;
    assert_non_null(z);
    check_ok(haft_marginal_johnson(&known, 0.8, 4.5, &error), error);
    for (size_t i = 0; i < N; i++) {
        size_t place = i * 77777 % N; /* any order */
        z[place] = i == 5 ? NAN
                          : 7e-9 + 3e-9 * haft_marginal_value(
                                              known, gsl_cdf_ugaussian_Pinv((i + 0.5) / (double)N));
    }
    check_ok(haft_marginal_from_heights(&own, N, z, &error), error);
    for (double g = -4; g <= 4; g += 0.1) {
        check_near(haft_marginal_value(own, g), haft_marginal_value(known, g),
                   fabs(g) < 3.5 ? 0.02 : 0.06);
    }
    assert_true(haft_marginal_value(own, 6) > haft_marginal_value(own, 4.3));
    haft_marginal_destroy(&own);
    assert_int_equal(haft_marginal_from_heights(&own, 99, z, &error), HAFT_ERROR_INPUT);
    for (size_t i = 0; i < N; i++) {
        z[i] = 1;
    }
    assert_int_equal(haft_marginal_from_heights(&own, N, z, &error), HAFT_ERROR_INPUT);
    haft_marginal_destroy(&known);
    free(z);
}

/* The self-affine PSD as a table of its two corners is the same surface. */
static void a_table_of_two_points_is_the_self_affine_form(void **state) {
    (void)state;
    enum { SIDE = 120 };
    static double a[SIDE * SIDE], b[SIDE * SIDE];
    double zeta[] = {DELRIO.zeta_0, DELRIO.zeta_max}, s[] = {DELRIO.s_0, DELRIO.s_1};
    haft_psd_table table = {2, zeta, s, NULL};
    field first = open_field(&DELRIO, NULL, NULL, SIDE, 5e-9),
          second = open_field(NULL, &table, NULL, SIDE, 5e-9);
    draw(&first, 3, a);
    draw(&second, 3, b);
    for (size_t i = 0; i < SIDE * SIDE; i++) {
        check_near(b[i], a[i], 1e-9 * 3.5e-9);
    }
    haft_surface_facts facts;
    haft_surface_get_facts(second.plan, &facts);
    check_relative(facts.moments.m0, haft_psd_table_get_moments(&table).m0, 2e-5);
    close_field(&first);
    close_field(&second);
}

static void the_gaussian_limit_is_the_gaussian_surface(void **state) {
    (void)state;
    enum { SIDE = 120 };
    static double a[SIDE * SIDE], b[SIDE * SIDE];
    haft_error error = {0};
    haft_marginal *m = NULL;
    field plain = open_field(&DELRIO, NULL, NULL, SIDE, 5e-9);
    draw(&plain, 1, a);
    check_ok(haft_marginal_johnson(&m, 0, 3, &error), error);
    field limit = open_field(&DELRIO, NULL, m, SIDE, 5e-9);
    draw(&limit, 1, b);
    assert_memory_equal(a, b, sizeof a);
    close_field(&limit);
    haft_marginal_destroy(&m);
    /* and it is approached */
    double off[2];
    for (int k = 0; k < 2; k++) {
        double square = 0;
        check_ok(haft_marginal_johnson(&m, k == 0 ? 0.02 : 0.002, 3.001, &error), error);
        limit = open_field(&DELRIO, NULL, m, SIDE, 5e-9);
        draw(&limit, 1, b);
        for (size_t i = 0; i < SIDE * SIDE; i++) {
            square += (b[i] - a[i]) * (b[i] - a[i]) / (SIDE * SIDE);
        }
        off[k] = sqrt(square) / 3.5e-9;
        close_field(&limit);
        haft_marginal_destroy(&m);
    }
    print_message(
        "rms distance to the Gaussian surface, of its rms: %.2e at skewness 0.02, %.2e at 0.002\n",
        off[0], off[1]);
    check_less(off[0], 0.005);
    check_less(off[1], 0.15 * off[0]); /* in proportion */
    close_field(&plain);
}

enum { PATCH = 400, PATCHES = 48 };

/* Patches as maps, and the mean of each one's z^1 .. z^4 in units of `deviation`. */
static void draw_maps(const field *f, double deviation, haft_map *maps[PATCHES],
                      double moment[PATCHES][4]) {
    haft_error error = {0};
    for (size_t p = 0; p < PATCHES; p++) {
        check_ok(haft_map_create(&maps[p], PATCH, PATCH, 5e-9, 5e-9, &error), error);
        draw(f, p, maps[p]->z);
        memset(moment[p], 0, 4 * sizeof(double));
        for (size_t i = 0; i < PATCH * PATCH; i++) {
            double z = maps[p]->z[i] / deviation, power = z;
            for (int q = 0; q < 4; q++, power *= z) {
                moment[p][q] += power / (PATCH * PATCH);
            }
        }
    }
}

enum { RINGS = 120 };

/* PSD of each patch by itself, all on the same rings; @return how many. */
static size_t estimate(haft_map *maps[PATCHES], double s[PATCHES][RINGS], double zeta[RINGS]) {
    haft_error error = {0};
    size_t n = 0;
    for (size_t p = 0; p < PATCHES; p++) {
        haft_psd_table *table = NULL;
        check_ok(haft_psd_estimate(&table, 1, (const haft_map *const *)&maps[p], HAFT_WINDOW_HANN,
                                   &error),
                 error);
        n = table->n;
        assert_true(n <= RINGS);
        memcpy(s[p], table->s, n * sizeof(double));
        memcpy(zeta, table->zeta, n * sizeof(double));
        haft_psd_table_destroy(&table);
        haft_map_destroy(&maps[p]);
    }
    return n;
}

/* Within four standard errors of the mean, by the patches' own scatter. */
static void check_moments(double moment[PATCHES][4], double skewness, double kurtosis) {
    const double exact[4] = {0, 1, skewness, kurtosis};
    for (int q = 0; q < 4; q++) {
        double mean = 0, spread = 0;
        for (size_t p = 0; p < PATCHES; p++) {
            mean += moment[p][q] / PATCHES;
        }
        for (size_t p = 0; p < PATCHES; p++) {
            spread += pow(moment[p][q] - mean, 2) / (PATCHES - 1);
        }
        check_near(mean, exact[q], 4 * sqrt(spread / PATCHES));
    }
}

/* By how much rings are off the Gaussian surface's of the same noise, as the same estimate sees
 * both: at most, and beyond four standard errors (of 45 rings one is likely to be off by three) by
 * the patches' own scatter. */
static void compare(double s[PATCHES][RINGS], double twin[PATCHES][RINGS], const double *zeta,
                    size_t n, double *most, double *beyond) {
    *most = *beyond = 0;
    for (size_t i = 0; i < n && zeta[i] < 0.95 * DELRIO.zeta_max; i++) {
        double level = 0, mean = 0, spread = 0;
        for (size_t p = 0; p < PATCHES; p++) {
            level += twin[p][i] / PATCHES;
            mean += (s[p][i] - twin[p][i]) / PATCHES;
        }
        for (size_t p = 0; p < PATCHES; p++) {
            spread += pow(s[p][i] - twin[p][i] - mean, 2) / (PATCHES - 1);
        }
        double off = fabs(mean) / level;
        *most = fmax(*most, off);
        *beyond = fmax(*beyond, off - 4 * sqrt(spread / PATCHES) / level);
    }
}

/* Many independent patches: moments within sampling error, and the PSD the Gaussian surface's
 * within the patches' own scatter. (That the PSD is the one asked for is shown without sampling in
 * test_surface_translation.c.) */
static void surfaces_have_marginal_and_psd(void **state) {
    (void)state;
    static const double pairs[][2] = {{-0.8, 4}, {0, 2.4}};
    static haft_map *maps[PATCHES];
    static double moment[PATCHES][4], twin[PATCHES][RINGS], s[PATCHES][RINGS], zeta[RINGS];
    haft_error error = {0};
    field gaussian = open_field(&DELRIO, NULL, NULL, PATCH, 5e-9);
    draw_maps(&gaussian, 1, maps, moment);
    estimate(maps, twin, zeta);
    close_field(&gaussian);
    for (size_t k = 0; k < sizeof pairs / sizeof *pairs; k++) {
        haft_marginal *m = NULL;
        check_ok(haft_marginal_johnson(&m, pairs[k][0], pairs[k][1], &error), error);
        field f = open_field(&DELRIO, NULL, m, PATCH, 5e-9);
        haft_surface_facts facts;
        haft_surface_get_facts(f.plan, &facts);
        draw_maps(&f, facts.deviation, maps, moment);
        check_moments(moment, pairs[k][0], pairs[k][1]);
        double most, beyond;
        size_t n = estimate(maps, s, zeta);
        compare(s, twin, zeta, n, &most, &beyond);
        print_message("skewness %g, kurtosis %g: PSD error %.1e by the plan; rings off by %.3f at "
                      "most, by %.4f "
                      "beyond their errors; %.1e of the variance beyond the band\n",
                      pairs[k][0], pairs[k][1], facts.psd_error, most, beyond, facts.beyond);
        check_less(facts.psd_error, 0.002);
        check_less(beyond, 0.005);
        close_field(&f);
        haft_marginal_destroy(&m);
    }
}

/* Blocks join, and the field is the same however it is cut. */
static void translated_blocks_join(void **state) {
    (void)state;
    enum { SIDE = 100 };
    static double whole[2 * SIDE * SIDE], part[SIDE * SIDE];
    haft_error error = {0};
    haft_marginal *m = NULL;
    check_ok(haft_marginal_johnson(&m, 0.7, 4, &error), error);
    haft_surface_spec spec = {.psd = DELRIO,
                              .marginal = m,
                              .grid_step = 5e-9,
                              .rows = 2 * SIDE,
                              .columns = SIDE,
                              .key = {2, HAFT_RANDOM_TEST}};
    haft_surface_plan *plan = NULL;
    haft_surface_work *work = NULL;
    for (int k = 0; k < 2; k++) {
        spec.rows = k == 0 ? 2 * SIDE : SIDE;
        check_ok(haft_surface_plan_create(&plan, &spec, &error), error);
        check_ok(haft_surface_work_create(&work, plan, &error), error);
        check_ok(haft_surface_prepare(work, 0, 0, k == 0 ? 0 : SIDE, &error), error);
        check_ok(haft_surface_rows(work, 0, spec.rows, k == 0 ? whole : part, &error), error);
        haft_surface_work_destroy(&work);
        haft_surface_plan_destroy(&plan);
    }
    for (size_t i = 0; i < SIDE * SIDE; i++) {
        check_near(part[i], whole[SIDE * SIDE + i], 1e-11 * 3.5e-9);
    }
    haft_marginal_destroy(&m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(johnson_has_the_moments_asked_for),
        cmocka_unit_test(lognormal_is_lognormal),
        cmocka_unit_test(impossible_pairs_are_refused),
        cmocka_unit_test(heights_give_their_own_distribution),
        cmocka_unit_test(a_table_of_two_points_is_the_self_affine_form),
        cmocka_unit_test(the_gaussian_limit_is_the_gaussian_surface),
        cmocka_unit_test(surfaces_have_marginal_and_psd),
        cmocka_unit_test(translated_blocks_join),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
