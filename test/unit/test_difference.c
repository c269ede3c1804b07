/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Two sets of beams beside each other: against GSL, brute force, and orders counted one by one. */
#include "check.h"

#include "haft/study_report.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_statistics_double.h>

/* ---- intervals ---- */

static void welch_meets_students_law(void **state) {
    (void)state;
    /* equal deviations and sizes: 2 n - 2 degrees of freedom */
    double mean[2] = {3, 5}, deviation[2] = {0.7, 0.7};
    size_t n[2] = {6, 6};
    haft_interval i = haft_study_difference_interval(mean, deviation, n, 0.95);
    double half = gsl_cdf_tdist_Qinv(0.025, 10) * 0.7 * sqrt(2.0 / 6);
    check_relative(i.high, 2 + half, 1e-9);
    check_relative(i.low, 2 - half, 1e-9);
    /* one of them without any spread: the other's own interval */
    deviation[0] = 0;
    i = haft_study_difference_interval(mean, deviation, n, 0.9);
    haft_interval own = haft_study_mean_interval(2, 0.7, 6, 0.9);
    check_relative(i.low, own.low, 1e-9);
    check_relative(i.high, own.high, 1e-9);
    deviation[1] = 0;
    i = haft_study_difference_interval(mean, deviation, n, 0.9);
    check_near(i.low, 2, 0);
    check_near(i.high, 2, 0);
    n[0] = 1;
    i = haft_study_difference_interval(mean, deviation, n, 0.9);
    assert_true(isnan(i.low) && isnan(i.high));
}

/* ---- Kolmogorov and Smirnov ---- */

/* The distance of the order whose bits say which set each value is of. */
static double distance_of_order(unsigned bits, size_t n1, size_t n2) {
    double greatest = 0;
    size_t i = 0, j = 0;
    for (size_t k = 0; k < n1 + n2; k++) {
        *((bits >> k & 1) ? &i : &j) += 1;
        greatest = fmax(greatest, fabs((double)i / (double)n1 - (double)j / (double)n2));
    }
    return greatest;
}

static void p_counts_orders(void **state) {
    (void)state;
    static const size_t size[][2] = {{1, 1}, {4, 3}, {3, 4}, {5, 5}, {2, 9}, {6, 8}};
    for (size_t s = 0; s < sizeof size / sizeof *size; s++) {
        size_t n1 = size[s][0], n2 = size[s][1];
        for (size_t a = 0; a <= n1 * n2; a++) {
            double d = (double)a / (double)(n1 * n2);
            size_t orders = 0, far = 0;
            for (unsigned bits = 0; bits < 1U << (n1 + n2); bits++) {
                if ((size_t)__builtin_popcount(bits) == n1) {
                    orders++;
                    far += distance_of_order(bits, n1, n2) >= d - 1e-9;
                }
            }
            check_near(haft_study_kolmogorov(d, n1, n2), (double)far / (double)orders, 1e-12);
        }
    }
    assert_true(isnan(haft_study_kolmogorov(0.1, 0, 5)));
}

/* Where counting hands over to the asymptotic law, both say the same. */
static void the_two_laws_of_distance_meet(void **state) {
    (void)state;
    for (double d = 0.05; d < 0.16; d += 0.02) {
        double exact = haft_study_kolmogorov(d, 200, 1000),
               far = haft_study_kolmogorov(d, 201, 1000);
        check_relative(far, exact, 0.1);
    }
    check_near(haft_study_kolmogorov(0, 5000, 5000), 1, 0);
}

/* ---- whole comparisons ---- */

enum { BEAMS = 37 };

static haft_case plain_case(uint64_t seed) {
    return (haft_case){
        .seed = seed,
        .beam = {.length = 600e-6, .gap = 2e-6, .thickness = 2e-6, .young_modulus = 1}};
}

static void fill(haft_summary *row, size_t n, uint64_t draw, double middle) {
    haft_random_key key = {11, HAFT_RANDOM_TEST};
    for (size_t k = 0; k < n; k++) {
        uint64_t w[4];
        haft_random_words(key, k, draw, 0, w);
        bool free = w[1] % 7 == 0;
        double shared = (double)(k * 29 % 37) * 1e-6, own = 20e-6 * (double)w[0] / 0x1p64;
        row[k] = (haft_summary){.outcome = w[1] % 11 == 1 ? HAFT_OUTCOME_STEP_STALLED
                                           : free         ? HAFT_OUTCOME_FREE
                                                          : HAFT_OUTCOME_STUCK,
                                .crack_length = free ? 600e-6 : middle + shared + own};
    }
}

/* Share of the beams followed that are as short as x. */
static double share_below(const haft_summary *row, size_t n, double x) {
    size_t below = 0, followed = 0;
    for (size_t k = 0; k < n; k++) {
        bool stuck = row[k].outcome == HAFT_OUTCOME_STUCK;
        followed += stuck || row[k].outcome == HAFT_OUTCOME_FREE;
        below += stuck && row[k].crack_length <= x;
    }
    return (double)below / (double)followed;
}

static void a_comparison_is_what_it_is_defined_as(void **state) {
    (void)state;
    haft_error error = {0};
    haft_case c = plain_case(1);
    haft_summary a[BEAMS], b[BEAMS + 5];
    fill(a, BEAMS, 1, 200e-6);
    fill(b, BEAMS + 5, 2, 204e-6);
    haft_difference d;
    check_ok(haft_study_differ(&d, &c, a, BEAMS, &c, b, BEAMS + 5, &error), error);
    double x[BEAMS], y[BEAMS], difference[BEAMS], distance = 0;
    size_t pairs = 0, switched = 0;
    for (size_t k = 0; k < BEAMS; k++) {
        bool stuck[2] = {a[k].outcome == HAFT_OUTCOME_STUCK, b[k].outcome == HAFT_OUTCOME_STUCK};
        switched += (stuck[0] && b[k].outcome == HAFT_OUTCOME_FREE) ||
                    (stuck[1] && a[k].outcome == HAFT_OUTCOME_FREE);
        if (stuck[0] && stuck[1]) {
            x[pairs] = a[k].crack_length;
            y[pairs] = b[k].crack_length;
            difference[pairs] = y[pairs] - x[pairs];
            pairs++;
        }
    }
    assert_true(d.paired && pairs > 10 && switched > 1);
    assert_int_equal(d.pairs, pairs);
    assert_int_equal(d.switched, switched);
    double mean = gsl_stats_mean(difference, 1, pairs), spread = gsl_stats_sd(difference, 1, pairs);
    check_relative(d.pair_difference, mean, 1e-12);
    check_relative(d.pair_deviation, spread, 1e-9);
    check_relative(d.correlation, gsl_stats_correlation(x, 1, y, 1, pairs), 1e-9);
    haft_interval i = haft_study_mean_interval(mean, spread, pairs, 0.95);
    check_relative(d.pair_interval.low, i.low, 1e-9);
    for (size_t k = 0; k < BEAMS; k++) {
        for (int side = 0; side < 2; side++) {
            double at = side == 0 ? a[k].crack_length : b[k].crack_length;
            distance =
                fmax(distance, fabs(share_below(a, BEAMS, at) - share_below(b, BEAMS + 5, at)));
        }
    }
    check_near(d.distance, distance, 1e-12);
    haft_statistics s[2] = {haft_study_statistics(&c, a, BEAMS),
                            haft_study_statistics(&c, b, BEAMS + 5)};
    check_relative(d.difference, s[1].mean - s[0].mean, 1e-12);
    check_near(d.share_difference, s[1].stuck_share - s[0].stuck_share, 1e-15);
    assert_true(d.share_interval.low < d.share_difference &&
                d.share_difference < d.share_interval.high);

    /* the other way round everything changes its sign */
    haft_difference r;
    check_ok(haft_study_differ(&r, &c, b, BEAMS + 5, &c, a, BEAMS, &error), error);
    check_relative(r.difference_interval.low, -d.difference_interval.high, 1e-12);
    check_relative(r.pair_interval.high, -d.pair_interval.low, 1e-12);
    check_near(r.share_interval.low, -d.share_interval.high, 1e-12);
    check_near(r.p_value, d.p_value, 1e-12);

    haft_case other = plain_case(2);
    check_ok(haft_study_differ(&r, &c, a, BEAMS, &other, b, BEAMS, &error), error);
    assert_false(r.paired);
    assert_int_equal(r.pairs, 0);
    assert_true(isnan(r.pair_difference));
}

/* The same beams moved by a constant: pairs know it to the last digit, and means do not. */
static void pairs_see_a_shift_that_means_do_not(void **state) {
    (void)state;
    haft_error error = {0};
    haft_case c = plain_case(1);
    haft_summary a[BEAMS], b[BEAMS];
    fill(a, BEAMS, 1, 200e-6);
    memcpy(b, a, sizeof b);
    for (size_t k = 0; k < BEAMS; k++) {
        b[k].crack_length += b[k].outcome == HAFT_OUTCOME_STUCK ? 0x1p-21 : 0;
    }
    haft_difference d;
    check_ok(haft_study_differ(&d, &c, a, BEAMS, &c, b, BEAMS, &error), error);
    check_relative(d.pair_interval.low, 0x1p-21, 1e-6);
    check_relative(d.pair_interval.high, 0x1p-21, 1e-6);
    check_near(d.correlation, 1, 1e-9);
    assert_true(d.difference_interval.low < 0 && d.difference_interval.high > 0);
    check_ok(haft_study_differ(&d, &c, a, BEAMS, &c, a, BEAMS, &error), error);
    check_near(d.distance, 0, 0);
    check_near(d.p_value, 1, 1e-12);
}

/* No beam, or none that stuck: numbers that there are none of are NaN, and nothing fails. */
static void nothing_to_compare_is_told_as_such(void **state) {
    (void)state;
    haft_error error = {0};
    haft_case c = plain_case(1);
    haft_summary a[4], b[4];
    fill(a, 4, 1, 200e-6);
    for (size_t k = 0; k < 4; k++) {
        b[k] = (haft_summary){.outcome = HAFT_OUTCOME_FREE, .crack_length = 600e-6};
    }
    haft_difference d;
    check_ok(haft_study_differ(&d, &c, a, 4, &c, b, 4, &error), error);
    assert_true(isnan(d.difference) && isnan(d.pair_difference) && d.pairs == 0);
    check_near(d.share_difference, -share_below(a, 4, 1), 1e-15);
    check_ok(haft_study_differ(&d, &c, a, 4, &c, b, 0, &error), error);
    assert_true(isnan(d.distance) && isnan(d.p_value));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(welch_meets_students_law),
        cmocka_unit_test(p_counts_orders),
        cmocka_unit_test(the_two_laws_of_distance_meet),
        cmocka_unit_test(a_comparison_is_what_it_is_defined_as),
        cmocka_unit_test(pairs_see_a_shift_that_means_do_not),
        cmocka_unit_test(nothing_to_compare_is_told_as_such),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
