/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Laws as tables: the curve between its points, its wall, its end, its potential, and refusals. */
#include "law_kinks.h"

/* A curve with a wall, one well and a tail, at even or uneven distances. */
enum { POINTS = 40 };
static void make_curve(double *x, double *f, bool even) {
    haft_law law = typical();
    for (int i = 0; i < POINTS; i++) {
        double s = (double)i / (POINTS - 1);
        x[i] = 7.3e-9 + 3.5e-8 * (even ? s : s * (0.4 + 0.6 * s));
        f[i] = haft_law_evaluate(&law, x[i]).force;
    }
}

static void a_table_passes_through_its_points_monotonely(void **state) {
    (void)state;
    for (int even = 0; even < 2; even++) {
        double x[POINTS], f[POINTS];
        make_curve(x, f, even);
        haft_error error = {0};
        haft_law_table *table = NULL;
        check_ok(haft_law_table_create(&table, POINTS, x, f, &error), error);
        haft_law law = haft_law_from_table(table);
        assert_int_equal(law.kind, HAFT_LAW_TABLE);
        for (int i = 0; i + 1 < POINTS; i++) {
            check_near(haft_law_evaluate(&law, x[i]).force, f[i], 0);
            double end = i + 2 < POINTS ? f[i + 1] : 0, last = f[i];
            for (int j = 1; j <= 50; j++) {
                double g = haft_law_evaluate(&law, x[i] + (x[i + 1] - x[i]) * j / 50).force;
                assert_true((g - last) * (end - f[i]) >= -1e-12 * law.f_max * fabs(end - f[i]));
                last = g;
            }
        }
        haft_law_value past = haft_law_evaluate(&law, x[POINTS - 1]);
        assert_true(past.force == 0 && past.slope == 0 && past.potential == 0);
        haft_law_table_destroy(&table);
        assert_null(table);
        haft_law_table_destroy(&table);
    }
}

/* Inside a piece Phi is a quartic and f a cubic: five-point differences are exact. */
static void a_tables_derivatives_agree(void **state) {
    (void)state;
    double x[POINTS], f[POINTS];
    make_curve(x, f, false);
    haft_error error = {0};
    haft_law_table *table = NULL;
    check_ok(haft_law_table_create(&table, POINTS, x, f, &error), error);
    haft_law law = haft_law_from_table(table);
    for (int i = 0; i + 1 < POINTS; i++) {
        double h = (x[i + 1] - x[i]) / 5, d = 0.5 * (x[i] + x[i + 1]);
        haft_law_value v[5];
        double size = 0, energy = 0;
        for (int j = 0; j < 5; j++) {
            v[j] = haft_law_evaluate(&law, d + (j - 2) * h);
            size = fmax(size, fabs(v[j].force));
            energy = fmax(energy, fabs(v[j].potential));
        }
#define DIFFERENCE(what) ((v[0].what - v[4].what + 8 * (v[3].what - v[1].what)) / (12 * h))
        double rounding = 1e-15 / h;
        check_near(DIFFERENCE(potential), -v[2].force, 1e-9 * size + 10 * rounding * energy);
        check_near(DIFFERENCE(force), v[2].slope, 1e-9 * fabs(v[2].slope) + 10 * rounding * size);
        check_near(DIFFERENCE(slope), v[2].curvature,
                   1e-9 * fabs(v[2].curvature) + 10 * rounding * size / h);
#undef DIFFERENCE
        check_continuous(&law, x[i], h, 1e-10);
    }
    check_continuous(&law, x[POINTS - 1], x[POINTS - 1] - x[POINTS - 2], 1e-10);
    haft_law_table_destroy(&table);
}

static void a_table_goes_on_as_a_wall(void **state) {
    (void)state;
    double x[POINTS], f[POINTS];
    make_curve(x, f, true);
    haft_error error = {0};
    haft_law_table *table = NULL;
    check_ok(haft_law_table_create(&table, POINTS, x, f, &error), error);
    haft_law law = haft_law_from_table(table);
    haft_law_value at = haft_law_evaluate(&law, x[0]);
    assert_true(at.slope < 0 && law.wall_slope == at.slope && law.wall_force == f[0]);
    for (double depth = 1e-12; depth < 1e101; depth *= 100) {
        haft_law_value v = haft_law_evaluate(&law, x[0] - depth);
        double t = x[0] - (x[0] - depth);
        check_relative(v.force, at.force - at.slope * t, 1e-12);
        check_relative(v.potential, at.potential + at.force * t - at.slope * t * t / 2, 1e-12);
    }
    double share = 0.3, d = haft_law_reach(&law, share);
    assert_true(d > law.d_max);
    check_relative(haft_law_evaluate(&law, d).force, -share * law.f_max, 1e-10);
    assert_true(haft_law_range(&law) > 0 && haft_law_range(&law) < x[POINTS - 1] - x[0]);
    haft_law_table_destroy(&table);
    /* Points that rise are left out: the wall begins where the curve falls, and never ends. */
    double up[] = {1, 3, 3, 1, -2, -1, 0}, gap[] = {0, 1, 2, 3, 4, 5, 6};
    check_ok(haft_law_table_create(&table, 7, gap, up, &error), error);
    law = haft_law_from_table(table);
    check_near(law.wall_distance, 2, 0);
    check_less(100, haft_law_evaluate(&law, -100).force);
    haft_law_table_destroy(&table);
    /* A start that hardly falls, before a steep fall, is a wall too. */
    double slow[] = {3, 2.99, -2, -1, 0};
    check_ok(haft_law_table_create(&table, 5, gap, slow, &error), error);
    law = haft_law_from_table(table);
    check_less(haft_law_evaluate(&law, 0).slope, -0.004);
    haft_law_table_destroy(&table);
}

static void a_pushing_table_never_pulls(void **state) {
    (void)state;
    double x[] = {1, 2, 3, 4, 5, 6}, f[] = {9, 4, 1, 0, 0, 0};
    haft_error error = {0};
    haft_law_table *table = NULL;
    check_ok(haft_law_table_create(&table, 6, x, f, &error), error);
    haft_law law = haft_law_from_table(table);
    assert_true(law.f_max == 0 && isnan(law.d_max));
    check_near(haft_law_reach(&law, 0.5), 4, 0);
    assert_true(haft_law_evaluate(&law, 2.5).force > 0 && haft_law_range(&law) > 0);
    haft_law_table_destroy(&table);
}

static void check_refused(size_t n, const double *x, const double *f, haft_status status,
                          const char *says) {
    haft_error error = {0};
    haft_law_table *table = NULL;
    assert_int_equal(haft_law_table_create(&table, n, x, f, &error), status);
    assert_null(table);
    assert_non_null(strstr(error.message, says));
}

static void a_table_refuses_what_is_no_law(void **state) {
    (void)state;
    double x[] = {1, 2, 3, 4, 5}, f[] = {3, -4, -2, -1, 0};
    check_refused(3, x, f, HAFT_ERROR_ARGUMENT, "at least 4");
    f[4] = -0.21;
    check_refused(5, x, f, HAFT_ERROR_INPUT, "died away");
    f[4] = NAN;
    check_refused(5, x, f, HAFT_ERROR_INPUT, "finite");
    f[4] = 0, x[2] = 2;
    check_refused(5, x, f, HAFT_ERROR_INPUT, "increasing");
    x[2] = 3, f[0] = -1;
    check_refused(5, x, f, HAFT_ERROR_INPUT, "needs a wall");
    f[0] = 0;
    check_refused(5, x, f, HAFT_ERROR_INPUT, "needs a wall");
    double up[] = {1, 2, 3, 0.1, 0}, level[] = {1, 1, 1, 1, 1};
    check_refused(5, x, up, HAFT_ERROR_INPUT, "needs a wall");
    check_refused(5, x, level, HAFT_ERROR_INPUT, "needs a wall");
    f[0] = 3, f[4] = -0.19;
    haft_law_table *table = NULL;
    haft_error error = {0};
    check_ok(haft_law_table_create(&table, 5, x, f, &error), error);
    haft_law law = haft_law_from_table(table);
    check_near(haft_law_evaluate(&law, 5).force, 0, 0);
    haft_law_table_destroy(&table);
}
/* Next to the right end of a steep piece force and potential are small beside what they are at its
 * left end, and keep their digits all the same: against the cubic in long double. */
static void a_steep_piece_keeps_its_digits(void **state) {
    (void)state;
    double x[] = {0, 1e-9, 2e-9, 3e-9, 4e-9}, f[] = {1e12, 0, 1, -1, 0};
    haft_error error = {0};
    haft_law_table *table = NULL;
    check_ok(haft_law_table_create(&table, 5, x, f, &error), error);
    haft_law law = haft_law_from_table(table);
    double next = haft_law_evaluate(&law, 1e-9).potential;
    for (double t = 1e-10; t > 1e-17; t /= 7) {
        double d = 1e-9 - t;
        long double h = 1e-9L, y = ((long double)x[1] - d) / h, s0 = law.wall_slope * h;
        long double exact =
            y * y * (f[0] * (3 - 2 * y) + s0 * (1 - y)); /* level at its right end */
        long double area =
            h * (f[0] * (y * y * y - y * y * y * y / 2) + s0 * (y * y * y / 3 - y * y * y * y / 4));
        haft_law_value v = haft_law_evaluate(&law, d);
        double known = 4 * 0x1p-52 / (double)y; /* of d itself */
        check_near((double)(v.force / exact), 1, known + 1e-13);
        check_near(v.potential, (double)(next + area),
                   (known + 1e-13) * (double)area + 4 * 0x1p-52 * fabs(next));
    }
    haft_law_table_destroy(&table);
}

/* A thin wall before a wide well has two lengths; a law as steep everywhere has one. */
static void a_thin_wall_has_a_length_of_its_own(void **state) {
    (void)state;
    double x[] = {0, 1e-12, 2e-12, 4e-9, 8e-9, 12e-9}, f[] = {5e6, 0, -1e6, -6e5, -2e5, 0};
    haft_error error = {0};
    haft_law_table *table = NULL;
    check_ok(haft_law_table_create(&table, 6, x, f, &error), error);
    haft_law law = haft_law_from_table(table);
    haft_law_lengths lengths = haft_law_find_lengths(&law);
    check_near(lengths.range, haft_law_range(&law), 0);
    check_near(lengths.edge, 2e-12, 0);
    assert_true(lengths.range < 1e-11 && lengths.wide > 1e-9);
    haft_law_table_destroy(&table);
    double even_x[POINTS], even_f[POINTS];
    make_curve(even_x, even_f, true);
    check_ok(haft_law_table_create(&table, POINTS, even_x, even_f, &error), error);
    law = haft_law_from_table(table);
    lengths = haft_law_find_lengths(&law);
    check_near(lengths.wide, lengths.range, 0);
    haft_law_table_destroy(&table);
    law = typical();
    lengths = haft_law_find_lengths(&law);
    check_near(lengths.wide, lengths.range, 0);
    haft_law_vector v = {.e = 2.1e-3, .f_max = 4e5, .d_max = 1.1e-8, .d_limit = 1.0999e-8};
    assert_int_equal(haft_law_morse(&law, &v, 5e6), HAFT_LAW_SOUND);
    lengths = haft_law_find_lengths(&law);
    check_relative(lengths.range, 1 / law.a_left, 1e-15);
    check_relative(lengths.wide, 1 / law.a_right, 1e-15);
    check_near(lengths.edge, 1.1e-8, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_table_passes_through_its_points_monotonely),
        cmocka_unit_test(a_tables_derivatives_agree),
        cmocka_unit_test(a_table_goes_on_as_a_wall),
        cmocka_unit_test(a_pushing_table_never_pulls),
        cmocka_unit_test(a_table_refuses_what_is_no_law),
        cmocka_unit_test(a_steep_piece_keeps_its_digits),
        cmocka_unit_test(a_thin_wall_has_a_length_of_its_own),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
