/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dispersion forces: refusals, and the edges of point law, averages and far field. */
#include "check.h"

#include "contact/dispersion.h"

static const haft_dispersion bare = {
    .substrate = 1.9e-19, .retardation = HAFT_DISPERSION_RETARDATION, .cut_off = 1e-9};

static haft_dispersion layered(void) {
    haft_dispersion law = bare;
    law.oxide = 6.5e-20;
    law.film = 3.7e-20;
    law.oxide_thickness[0] = 2e-9;
    law.film_thickness[0] = 0.6e-9;
    law.oxide_thickness[1] = 1e-9;
    law.film_thickness[1] = 0.9e-9;
    return law;
}

static void check_refused(haft_dispersion law, const char *said) {
    haft_error error = {0};
    assert_int_equal(haft_dispersion_check(&law, &error), HAFT_ERROR_INPUT);
    assert_non_null(strstr(error.message, said));
    assert_int_equal(haft_dispersion_check(&law, NULL), HAFT_ERROR_INPUT);
}

static void bad_laws_are_refused(void **state) {
    (void)state;
    haft_error error = {0};
    haft_dispersion good = layered(), law = good;
    check_ok(haft_dispersion_check(&good, &error), error);
    check_ok(haft_dispersion_check(&bare, &error), error);
    const double bad[] = {0, -1e-20, NAN, INFINITY};
    for (size_t i = 0; i < 4; i++) {
        law = good, law.substrate = bad[i];
        check_refused(law, "substrate");
        law = good, law.oxide = bad[i];
        check_refused(law, "oxide has");
        law = good, law.film = bad[i];
        check_refused(law, "film has");
    }
    const double thick[] = {-1e-12, 101e-9, NAN, INFINITY};
    for (size_t i = 0; i < 4; i++) {
        law = good, law.oxide_thickness[1] = thick[i];
        check_refused(law, "oxide of face 2");
        law = good, law.film_thickness[0] = thick[i];
        check_refused(law, "film of face 1");
    }
    const double cut[] = {0, 0.164e-9, 101e-9, -1e-9, NAN, INFINITY};
    for (size_t i = 0; i < 6; i++) {
        law = good, law.cut_off = cut[i];
        check_refused(law, "cut-off");
    }
    const double wave[] = {-1e-9, NAN, INFINITY};
    for (size_t i = 0; i < 3; i++) {
        law = good, law.retardation = wave[i];
        check_refused(law, "retardation");
    }
    law = good, law.retardation = 0;
    check_ok(haft_dispersion_check(&law, &error), error);
    law.oxide_thickness[0] = law.oxide_thickness[1] = 0; /* what is not there need not be known */
    law.oxide = 0;
    check_ok(haft_dispersion_check(&law, &error), error);
}

/* The mean over a range of gaps against a sum of points in it, and where the range shrinks. */
static void means_are_of_the_point_law(void **state) {
    (void)state;
    for (int layers = 0; layers < 2; layers++) {
        haft_dispersion law = layers ? layered() : bare;
        haft_dispersion_terms terms = haft_dispersion_terms_of(&law);
        const double low = 1e-9, high = 3e-9;
        haft_dispersion_value sum = {0}, mean = haft_dispersion_mean(&terms, low, high);
        const int n = 20000;
        for (int i = 0; i < n; i++) {
            double gap = low + (high - low) * (i + 0.5) / n;
            haft_dispersion_value v = haft_dispersion_at(&law, gap);
            sum.energy += v.energy / n;
            sum.pressure += v.pressure / n;
            sum.slope += v.slope / n;
        }
        check_relative(mean.energy, sum.energy, 1e-8);
        check_relative(mean.pressure, sum.pressure, 1e-8);
        check_relative(mean.slope, sum.slope, 1e-8);
        for (double width = 0; width < 1e-11; width = 10 * width + 1e-22) {
            haft_dispersion_value v = haft_dispersion_at(&law, 100e-9);
            mean = haft_dispersion_mean(&terms, 100e-9 - width / 2, 100e-9 + width / 2);
            check_relative(mean.energy, v.energy, 1e-8);
            check_relative(mean.pressure, v.pressure, 1e-8);
            check_relative(mean.slope, v.slope, 2e-8);
        }
    }
}

static void heights_are_refused(void **state) {
    (void)state;
    haft_height_bins *bins = NULL;
    haft_error error = {0};
    double z[3] = {0, 1e-9, 2e-9};
    assert_int_equal(haft_height_bins_create(&bins, z, 0, 5, &error), HAFT_ERROR_ARGUMENT);
    assert_int_equal(haft_height_bins_create(&bins, z, 3, 0, &error), HAFT_ERROR_ARGUMENT);
    z[1] = NAN;
    assert_int_equal(haft_height_bins_create(&bins, z, 3, 5, &error), HAFT_ERROR_INPUT);
    assert_non_null(strstr(error.message, "height 2 of 3"));
    assert_null(bins);
    haft_height_bins_destroy(&bins);
    haft_height_bins_destroy(NULL);
}

/* Where each bin holds equal heights the average is the sum over points. */
static void few_heights_are_summed(void **state) {
    (void)state;
    haft_dispersion law = layered();
    const double z[4] = {-2e-9, 2e-9, 2e-9, -2e-9}, d = 4e-9, flat[3] = {1e-9, 1e-9, 1e-9};
    haft_height_bins *bins = NULL;
    haft_error error = {0};
    check_ok(haft_height_bins_create(&bins, z, 4, 7, &error), error);
    haft_dispersion_value far = haft_dispersion_at(&law, 6e-9), got, want, cut;
    want = haft_dispersion_at(&law, 2e-9);
    got = haft_dispersion_average(&law, bins, d);
    check_relative(got.energy, (far.energy + want.energy) / 2, 1e-12);
    check_relative(got.pressure, (far.pressure + want.pressure) / 2, 1e-12);
    check_relative(got.slope, (far.slope + want.slope) / 2, 1e-12);
    law.cut_off = 3e-9;
    cut = haft_dispersion_at(&law, 3e-9);
    got = haft_dispersion_average(&law, bins, d);
    check_relative(got.energy, (far.energy + cut.energy) / 2, 1e-12);
    check_relative(got.pressure, far.pressure / 2, 1e-12);
    got = haft_dispersion_average(&law, bins, -1);
    check_relative(got.energy, cut.energy, 1e-12);
    assert_true(got.pressure == 0 && got.slope == 0);
    haft_height_bins_destroy(&bins);
    assert_null(bins);
    check_ok(haft_height_bins_create(&bins, flat, 3, 100, &error), error);
    got = haft_dispersion_average(&law, bins, 8e-9);
    want = haft_dispersion_at(&law, 7e-9);
    check_relative(got.pressure, want.pressure, 1e-12);
    haft_height_bins_destroy(&bins);
}

static void smooth_faces_are_a_limit_of_normal_heights(void **state) {
    (void)state;
    haft_dispersion law = layered();
    const double rms[] = {0, 1e-30, 1e-13};
    for (size_t i = 0; i < 3; i++) {
        haft_dispersion_value got = haft_dispersion_gaussian(&law, rms[i], 5e-9);
        haft_dispersion_value want = haft_dispersion_at(&law, 5e-9);
        check_relative(got.energy, want.energy, 1e-8);
        check_relative(got.pressure, want.pressure, 1e-8);
        check_relative(got.slope, want.slope, 1e-7);
        got = haft_dispersion_gaussian(&law, rms[i], 0.5e-9);
        want = haft_dispersion_at(&law, law.cut_off);
        check_relative(got.energy, want.energy, 1e-12);
        assert_true(got.pressure == 0);
    }
}

static haft_dispersion_value plates(const void *context, double distance) {
    return haft_dispersion_at(context, distance);
}

static haft_dispersion_value nothing(const void *context, double distance) {
    (void)context;
    (void)distance;
    return (haft_dispersion_value){0};
}

static void bad_far_fields_are_refused(void **state) {
    (void)state;
    haft_far_field field;
    haft_error error = {0};
#define MAKE(terms, first, far, source)                                                            \
    haft_far_field_make(&field, terms, first, far, source, &bare, &error)
    check_ok(MAKE(8, 3e-9, 500e-9, plates), error);
    assert_int_equal(MAKE(0, 3e-9, 500e-9, plates), HAFT_ERROR_ARGUMENT);
    assert_int_equal(MAKE(HAFT_FAR_FIELD_TERMS + 1, 3e-9, 5e-7, plates), HAFT_ERROR_ARGUMENT);
    assert_int_equal(MAKE(8, -3e-9, 500e-9, plates), HAFT_ERROR_ARGUMENT);
    assert_int_equal(MAKE(8, 3e-9, 3e-9, plates), HAFT_ERROR_ARGUMENT);
    assert_int_equal(MAKE(8, 3e-9, INFINITY, plates), HAFT_ERROR_ARGUMENT);
    assert_int_equal(MAKE(8, NAN, 500e-9, plates), HAFT_ERROR_ARGUMENT);
    assert_int_equal(MAKE(8, 0, 500e-9, plates), HAFT_ERROR_INPUT); /* plates that touch */
    assert_int_equal(MAKE(8, 3e-9, 500e-9, nothing), HAFT_ERROR_INPUT);
    double d[3] = {1e-9, 2e-9, 3e-9}, u[3] = {-3, -2, -1}, p[3] = {3, 2, 1};
#define FIT(terms, points) haft_far_field_fit(&field, terms, points, d, u, p, &error)
    check_ok(FIT(3, 3), error);
    assert_int_equal(FIT(1, 1), HAFT_ERROR_ARGUMENT);
    assert_int_equal(FIT(4, 3), HAFT_ERROR_ARGUMENT);
    d[1] = 3e-9;
    assert_int_equal(FIT(2, 3), HAFT_ERROR_ARGUMENT);
    d[1] = NAN;
    assert_int_equal(FIT(2, 3), HAFT_ERROR_INPUT);
}

/* A polynomial of its own kind is got back; below the first distance is the tangent of the force,
 * from the last on nothing, and the slope is continuous there. */
static void far_fields_keep_their_ends(void **state) {
    (void)state;
    const double first = 3e-9, out = 200e-9;
    haft_far_field field;
    haft_error error = {0};
    check_ok(haft_far_field_make(&field, 16, first, out, plates, &bare, &error), error);
    const double d[] = {first, first - 2e-9, -20e-9, out, 1, out * (1 - 1e-9), INFINITY};
    enum { N = sizeof d / sizeof *d };
    double u[N], p[N], s[N];
    haft_far_field_evaluate(&field, N, d, &(haft_far_field_values){u, p, s, NULL});
    for (int i = 1; i < 3; i++) {
        double x = d[i] - first;
        check_relative(p[i], p[0] + s[0] * x, 1e-12);
        check_relative(u[i], u[0] + p[0] * x + s[0] * x * x / 2, 1e-12);
        check_relative(s[i], s[0], 1e-12);
    }
    for (int i = 3; i < N; i++) {
        double tiny = i == 5 ? 1e-8 : 0;
        check_near(u[i], 0, tiny * fabs(u[0]));
        check_near(p[i], 0, tiny * fabs(p[0]));
        check_near(s[i], 0, tiny * fabs(s[0]));
    }
}

static void no_number_gives_none(void **state) {
    (void)state;
    haft_far_field field;
    haft_error error = {0};
    double d = NAN, u, p, s;
    check_ok(haft_far_field_make(&field, 8, 3e-9, 200e-9, plates, &bare, &error), error);
    haft_far_field_evaluate(&field, 1, &d, &(haft_far_field_values){&u, &p, &s, NULL});
    assert_true(isnan(u) && isnan(p) && isnan(s));
}

static void far_fields_find_a_field_again(void **state) {
    (void)state;
    enum { N = 64 };
    haft_far_field known, again;
    haft_error error = {0};
    double d[N], u[N], p[N], s[N], v[N], q[N], r[N];
    check_ok(haft_far_field_make(&known, 8, 2e-9, 200e-9, plates, &bare, &error), error);
    for (int i = 0; i < N; i++) {
        d[i] = 2e-9 * pow(100, i / (N - 1.0));
    }
    d[N - 1] = 200e-9;
    haft_far_field_evaluate(&known, N, d, &(haft_far_field_values){u, p, s, NULL});
    check_ok(haft_far_field_fit(&again, 24, N, d, u, p, &error), error);
    check_less(again.energy_error, 1e-7);
    check_less(again.pressure_error, 1e-7);
    haft_far_field_evaluate(&again, N, d, &(haft_far_field_values){v, q, r, NULL});
    for (int i = 0; i < N; i++) {
        check_near(v[i], u[i], 1e-7 * fabs(u[0]));
        check_near(q[i], p[i], 1e-7 * fabs(p[0]));
    }
    for (int i = 1; i < N; i++) { /* in any lane of a vector */
        double one[3];
        haft_far_field_evaluate(&again, 1, d + i,
                                &(haft_far_field_values){one, one + 1, one + 2, NULL});
        assert_true(one[0] == v[i] && one[1] == q[i] && one[2] == r[i]);
    }
}

/* The curvature is the slope's derivative, and asking for it changes nothing else. */
static void far_fields_bend(void **state) {
    (void)state;
    enum { N = 3 };
    haft_far_field field;
    haft_error error = {0};
    check_ok(haft_far_field_make(&field, 24, 3e-9, 200e-9, plates, &bare, &error), error);
    for (double d = 3.1e-9; d < 199e-9; d *= 1.07) {
        double h = 1e-4 * d, at[N] = {d - h, d, d + h}, u[N], p[N], s[N], b[N], alone[N], v[N];
        haft_far_field_evaluate(&field, N, at, &(haft_far_field_values){u, p, s, b});
        check_near(b[1], (s[2] - s[0]) / (2 * h), 1e-5 * fabs(b[1]) + 1e-6 * fabs(s[1]) / d);
        haft_far_field_evaluate(&field, N, at, &(haft_far_field_values){.pressure = alone});
        assert_true(alone[1] == p[1]);
        haft_far_field_evaluate(&field, N, at, &(haft_far_field_values){v, alone, s, NULL});
        assert_true(alone[1] == p[1] && v[1] == u[1]);
    }
    double ends[N] = {2e-9, 200e-9, 300e-9}, u[N], p[N], s[N], b[N];
    haft_far_field_evaluate(&field, N, ends, &(haft_far_field_values){u, p, s, b});
    assert_true(b[0] == 0 && b[1] == 0 && b[2] == 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bad_laws_are_refused),
        cmocka_unit_test(means_are_of_the_point_law),
        cmocka_unit_test(heights_are_refused),
        cmocka_unit_test(few_heights_are_summed),
        cmocka_unit_test(smooth_faces_are_a_limit_of_normal_heights),
        cmocka_unit_test(bad_far_fields_are_refused),
        cmocka_unit_test(far_fields_keep_their_ends),
        cmocka_unit_test(no_number_gives_none),
        cmocka_unit_test(far_fields_find_a_field_again),
        cmocka_unit_test(far_fields_bend),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
