/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The Maugis sphere against its limits (Hertz, DMT, JKR), against the published equations solved
 * in extended precision, and at the joint of its branches; the table against the solution. */
#include "check.h"

#include "haft/contact.h"

static haft_maugis solve(double lambda, double approach) {
    haft_maugis m;
    haft_error error = {0};
    check_ok(haft_maugis_solve(&m, lambda, approach, HAFT_VDW_SEPARATION, &error), error);
    return m;
}

static haft_maugis_range limits(double lambda) {
    haft_maugis_range range;
    haft_error error = {0};
    check_ok(haft_maugis_limits(&range, lambda, &error), error);
    return range;
}

/* The greatest pull along the stable branch, by golden section. */
static double pull_off(double lambda) {
    const double golden = 0.5 * (sqrt(5) - 1);
    double low = limits(lambda).fold, high = 1;
    while (high - low > 1e-9) {
        double left = high - golden * (high - low), right = low + golden * (high - low);
        if (solve(lambda, left).force < solve(lambda, right).force) {
            high = right;
        } else {
            low = left;
        }
    }
    return -solve(lambda, 0.5 * (low + high)).force;
}

static void pull_off_goes_from_2_to_3_halves(void **state) {
    (void)state;
    /* The distances to the limits fall with lambda^(4/3) at least, and with lambda^-2. */
    check_near(pull_off(1e-3), 2, 1e-4);
    check_near(pull_off(1e-4), 2, 1e-5);
    check_less(2 - pull_off(1e-4), 0.1001 * (2 - pull_off(1e-3)));
    check_near(pull_off(100), 1.5, 1e-4);
    double far = pull_off(25) - 1.5, near = pull_off(50) - 1.5;
    check_less(0, near);
    check_near(far / near, 4, 0.05);
    double last = INFINITY;
    for (double x = log(1e-4); x < log(100); x += 0.05) {
        double pull = pull_off(exp(x));
        check_less(pull, last);
        last = pull;
    }
}

static void curves_have_their_limits(void **state) {
    (void)state;
    for (double approach = 0.25; approach < 10; approach *= 1.7) {
        /* DMT: Hertz less 2, but for the root of lambda. */
        double dmt = pow(approach, 1.5) - 2;
        check_near(solve(1e-4, approach).force, dmt, 3 * sqrt(1e-4 * (1 + approach)));
        check_less(fabs(solve(1e-4, approach).force - dmt),
                   0.35 * fabs(solve(1e-3, approach).force - dmt));
    }
    for (double a = 0.7; a < 6; a *= 1.3) {
        /* JKR in its parameter. */
        double jkr = a * a * a - a * sqrt(6 * a), approach = a * a - 2.0 / 3 * sqrt(6 * a);
        check_near(solve(100, approach).force, jkr, 1e-3);
        check_near(solve(100, approach).radius, a, 1e-3);
    }
    for (double lambda = 1e-4; lambda < 100; lambda *= 10) {
        /* Hertz, as adhesion is lost beside the push. */
        check_relative(solve(lambda, 1e8).force, 1e12, 1e-5);
        check_relative(solve(lambda, 1e8).radius, 1e4, 1e-5);
        check_relative(solve(lambda, 1e8).slope, 1.5e4, 1e-5);
    }
}

/* The energy balance less 1, as it is printed. */
static long double balance(long double lambda, long double a, long double m) {
    long double root = sqrtl(m * m - 1), arc = acosl(1 / m);
    return 0.5L * lambda * a * a * ((m * m - 2) * arc + root) +
           4.0L / 3 * lambda * lambda * a * (root * arc - m + 1) - 1;
}

static long double radius_at(long double lambda, long double m) {
    long double low = 0, high = 1;
    while (balance(lambda, high, m) < 0) {
        high *= 2;
    }
    for (int i = 0; i < 120; i++) {
        long double a = 0.5L * (low + high);
        *(balance(lambda, a, m) < 0 ? &low : &high) = a;
    }
    return 0.5L * (low + high);
}

static long double approach_at(long double lambda, long double m) {
    long double a = radius_at(lambda, m);
    return a * a - 4.0L / 3 * lambda * a * sqrtl(m * m - 1);
}

/* Approach falls with m on the stable part. */
static void check_touching(double lambda, double approach, double m_fold) {
    long double low = 1 + 1e-9L, high = m_fold;
    for (int i = 0; i < 90; i++) {
        long double m = 0.5L * (low + high);
        *(approach_at(lambda, m) > approach ? &low : &high) = m;
    }
    long double m = 0.5L * (low + high), a = radius_at(lambda, m);
    long double force = a * a * a - lambda * a * a * (sqrtl(m * m - 1) + m * m * acosl(1 / m));
    haft_maugis found = solve(lambda, approach);
    double scale = fmax(1, fabs((double)force));
    check_near(found.force, (double)force, 2e-12 * scale);
    check_near(found.radius, (double)a, 2e-12 * fmax(1, (double)a));
    check_near(found.reach, (double)(m * a), 2e-12 * fmax(1, (double)(m * a)));
}

static void published_equations_hold_in_extended_precision(void **state) {
    (void)state;
    static const double lambdas[] = {0.01, 0.1, 0.35, 0.7, 0.9, 0.95, 1.2, 2, 5, 20};
    for (size_t k = 0; k < sizeof lambdas / sizeof *lambdas; k++) {
        double lambda = lambdas[k];
        haft_maugis_range range = limits(lambda);
        /* The largest m on the stable part: where the fold was found, or near the point contact. */
        double m_fold = range.fold < range.touch ? 1e6 : 0;
        if (m_fold == 0) {
            haft_maugis at_fold = solve(lambda, range.fold);
            m_fold = at_fold.reach / at_fold.radius;
        }
        static const double above[] = {1e-3, 0.1, 0.7, 2, 9, 60};
        for (int i = 0; i < 6; i++) {
            check_touching(lambda, range.touch + above[i], m_fold);
        }
        for (int i = 1; i < 5 && range.fold < range.touch; i++) {
            double approach = range.fold + 0.25 * i * (range.touch - range.fold);
            haft_maugis found = solve(lambda, approach);
            double c = found.reach;
            check_near(0.5 * c * c - 8 / (3 * M_PI) * lambda * c - 2 / (M_PI * lambda), approach,
                       1e-13 * (1 + fabs(approach)));
            check_near(found.force, -0.5 * M_PI * lambda * c * c, 1e-14);
            assert_true(c >= 8 / (3 * M_PI) * lambda);
        }
    }
}

/* Value at s = 0 of the polynomial through values at s = 1 .. 8 times some unit. */
static double extrapolate(const double v[8]) {
    return 8 * (v[0] + v[6]) - 28 * (v[1] + v[5]) + 56 * (v[2] + v[4]) - 70 * v[3] - v[7];
}

static void branches_join_smoothly(void **state) {
    (void)state;
    static const double lambdas[] = {1e-3, 0.03, 0.2, 0.36, 0.6, 0.8};
    for (int k = 0; k < 6; k++) {
        haft_maugis_range range = limits(lambdas[k]);
        haft_maugis joint = solve(lambdas[k], range.touch); /* of the untouched branch */
        double force[8], slope[8];
        for (int i = 0; i < 8; i++) { /* the touching branch is smooth in the root of approach */
            double s = 0.0015 * (i + 1);
            haft_maugis m = solve(lambdas[k], range.touch + s * s);
            force[i] = m.force;
            slope[i] = m.slope;
        }
        assert_true(joint.radius == 0);
        check_near(extrapolate(force), joint.force, 1e-10);
        check_near(extrapolate(slope), joint.slope, 1e-10 * fmax(1, fabs(joint.slope)));
    }
}

static void slope_is_that_of_the_force(void **state) {
    (void)state;
    for (double lambda = 0.01; lambda < 50; lambda *= 1.7) {
        haft_maugis_range range = limits(lambda);
        for (double s = 0.2; s < 5; s *= 1.4) {
            double at = range.fold + s * s, h = 1e-4 * s * s;
            if (fabs(at - range.touch) < 3 * h) {
                continue;
            }
            double ratio = (solve(lambda, at + h).force - solve(lambda, at - h).force) / (2 * h);
            check_near(solve(lambda, at).slope, ratio, 1e-5 * (1 + fabs(ratio)));
        }
    }
}

static void ways_differ_between_fold_and_jump_alone(void **state) {
    (void)state;
    haft_error error = {0};
    for (double lambda = 0.01; lambda < 50; lambda *= 1.9) {
        haft_maugis_range range = limits(lambda);
        assert_true(range.fold <= range.touch && range.fold < range.jump);
        check_relative(range.jump, -2 / (M_PI * lambda), 1e-15);
        for (int i = -4; i < 12; i++) {
            double approach = range.fold + (i + 0.5) / 4 * (range.jump - range.fold);
            haft_maugis in, out = solve(lambda, approach);
            check_ok(haft_maugis_solve(&in, lambda, approach, HAFT_VDW_APPROACH, &error), error);
            if (i >= 0 && i < 4) {
                assert_true(in.force == 0 && in.reach == 0 && out.force < 0 && out.reach > 0);
            } else {
                assert_memory_equal(&in, &out, sizeof in);
                assert_true(i < 0 ? out.force == 0 : out.force != 0);
            }
        }
    }
}

static void table_keeps_its_accuracy(void **state) {
    (void)state;
    haft_error error = {0};
    haft_maugis_table *table = NULL;
    check_ok(haft_maugis_table_create(&table, &error), error);
    check_less(haft_maugis_table_gaps(table), 0.05);
    for (uint64_t k = 0; k < 60000; k++) {
        uint64_t words[4];
        haft_random_words((haft_random_key){23, HAFT_RANDOM_TEST}, k, 0, 0, words);
        double u = haft_random_uniform(words[0]), v = haft_random_uniform(words[1]);
        double lambda = 1e-4 * pow(1e6, u);
        if (k % 4 == 0) { /* about the meeting of the beginnings, where the table has its gaps */
            lambda = 0.9379474572107123 * (1 + pow(v, 4) * (k % 8 == 0 ? 1 : -1));
        }
        haft_maugis_range range = limits(lambda);
        double s = 1 / pow(1 - 0.85 * haft_random_uniform(words[2]), 2) - 1;
        double approach =
            k % 3 == 0 ? range.fold + 1e-9 + v * (range.touch - range.fold) : range.touch + s * s;
        /* At the fold itself the force is a step, on which side is a matter of rounding. */
        haft_vdw_path path = k % 2 == 0 ? HAFT_VDW_SEPARATION : HAFT_VDW_APPROACH;
        haft_maugis exact;
        check_ok(haft_maugis_solve(&exact, lambda, approach, path, &error), error);
        double radius = NAN, force = haft_maugis_lookup(table, lambda, approach, path, &radius);
        check_near(force, exact.force, HAFT_MAUGIS_ACCURACY);
        check_near(radius, exact.radius, HAFT_MAUGIS_ACCURACY);
    }
    haft_maugis_table_destroy(&table);
    assert_null(table);
}

static void bad_numbers_are_refused(void **state) {
    (void)state;
    static const double bad[] = {0, -1, 0.99e-4, 100.1, NAN, INFINITY};
    haft_maugis m;
    haft_error error = {0};
    for (int k = 0; k < 6; k++) {
        assert_int_equal(haft_maugis_solve(&m, bad[k], 0, HAFT_VDW_SEPARATION, &error),
                         HAFT_ERROR_ARGUMENT);
        assert_non_null(strstr(error.message, "0.0001 to 100"));
    }
    assert_int_equal(haft_maugis_solve(&m, 1, NAN, HAFT_VDW_SEPARATION, &error),
                     HAFT_ERROR_ARGUMENT);
    assert_int_equal(haft_maugis_solve(&m, 1, 1e13, HAFT_VDW_SEPARATION, &error),
                     HAFT_ERROR_ARGUMENT);
}

static void table_1_follows_from_hamaker_constants(void **state) {
    (void)state;
    haft_vdw dry, humid;
    haft_error error = {0};
    check_ok(haft_vdw_from_spec(&dry, &(haft_vdw_spec){18.65e-20, 2.09e-10}, &error), error);
    check_ok(haft_vdw_from_spec(&humid, &(haft_vdw_spec){9.75e-20, 2.09e-10}, &error), error);
    /* The printed energies come with D_0 = 1.49 A, which is 1.494 A. */
    check_relative(dry.energy, 167.1e-3, 0.006);
    check_relative(humid.energy, 87.4e-3, 0.006);
    check_relative(dry.energy * pow(1.49396 / 1.49, 2), 167.1e-3, 5e-4);
    check_relative(dry.range, 0.228e-9, 0.002);
    check_relative(dry.stress, 732e6, 0.005);
    check_relative(humid.stress, 383e6, 0.005);
    static const double bad[] = {0, -18.65e-20, NAN, INFINITY};
    for (int k = 0; k < 4; k++) {
        assert_int_equal(haft_vdw_from_spec(&dry, &(haft_vdw_spec){bad[k], 2e-10}, &error),
                         HAFT_ERROR_INPUT);
        assert_int_equal(haft_vdw_from_spec(&dry, &(haft_vdw_spec){1e-19, bad[k]}, &error),
                         HAFT_ERROR_INPUT);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pull_off_goes_from_2_to_3_halves),
        cmocka_unit_test(curves_have_their_limits),
        cmocka_unit_test(published_equations_hold_in_extended_precision),
        cmocka_unit_test(branches_join_smoothly),
        cmocka_unit_test(slope_is_that_of_the_force),
        cmocka_unit_test(ways_differ_between_fold_and_jump_alone),
        cmocka_unit_test(table_keeps_its_accuracy),
        cmocka_unit_test(bad_numbers_are_refused),
        cmocka_unit_test(table_1_follows_from_hamaker_constants),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
