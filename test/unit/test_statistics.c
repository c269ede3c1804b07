/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Confidence intervals: against closed forms, and by how often they hold the truth in simulated
 * campaigns with a fixed seed. */
#include "scratch.h"

#include "haft/study.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_randist.h>

/* ---- closed forms ---- */

static void mean_and_deviation_match_closed_forms(void **state) {
    (void)state;
    static const double confidences[] = {0.3, 0.9, 0.95, 0.999, 1 - 1e-9};
    for (size_t i = 0; i < sizeof confidences / sizeof *confidences; i++) {
        double p = 0.5 * (1 + confidences[i]), q = 0.5 * (1 - confidences[i]);
        /* one degree of freedom: Cauchy; two: (2p - 1) / sqrt(2 p q) */
        haft_interval two = haft_study_mean_interval(3, 2, 2, confidences[i]);
        check_relative(two.high - 3, tan(M_PI * (p - 0.5)) * 2 / sqrt(2), 1e-6);
        check_relative(3 - two.low, two.high - 3, 1e-12);
        haft_interval three = haft_study_mean_interval(0, 1, 3, confidences[i]);
        check_relative(three.high, (2 * p - 1) / sqrt(2 * p * q) / sqrt(3), 1e-6);
        /* chi-square with two degrees of freedom is exponential: -2 ln(1 - p) */
        haft_interval s = haft_study_deviation_interval(1, 3, confidences[i]);
        check_relative(s.low, sqrt(2 / (-2 * log(q))), 1e-6);
        check_relative(s.high, sqrt(2 / (-2 * log1p(-q))), 1e-6);
    }
    /* many: normal, and chi-square by Wilson and Hilferty */
    haft_interval mean = haft_study_mean_interval(0, 1, 1000000, 0.95);
    check_relative(mean.high, 1.959963984540054e-3, 1e-5);
    haft_interval s = haft_study_deviation_interval(1, 1000001, 0.95);
    double nu = 1e6, w = 2 / (9 * nu);
    check_relative(s.low, 1 / sqrt(pow(1 - w + 1.959963984540054 * sqrt(w), 3)), 1e-7);
    check_relative(s.high, 1 / sqrt(pow(1 - w - 1.959963984540054 * sqrt(w), 3)), 1e-7);
    haft_interval one = haft_study_mean_interval(1, NAN, 1, 0.95);
    assert_true(isnan(one.low) && isnan(one.high));
    one = haft_study_deviation_interval(NAN, 1, 0.95);
    assert_true(isnan(one.low) && isnan(one.high));
}

static void shares_match_closed_forms(void **state) {
    (void)state;
    for (size_t n = 1; n < 3000; n += 1 + n / 2) {
        haft_interval none = haft_study_share_interval(0, n, 0.95);
        haft_interval all = haft_study_share_interval(n, n, 0.95);
        check_near(none.low, 0, 0);
        check_relative(none.high, -expm1(log(0.025) / (double)n), 1e-9);
        check_relative(all.low, exp(log(0.025) / (double)n), 1e-9);
        check_near(all.high, 1, 0);
        size_t k = n / 3; /* turning the question round mirrors the interval */
        haft_interval some = haft_study_share_interval(k, n, 0.9);
        haft_interval rest = haft_study_share_interval(n - k, n, 0.9);
        check_near(some.low, 1 - rest.high, 1e-12);
        check_near(some.high, 1 - rest.low, 1e-12);
    }
    /* Clopper and Pearson's own way: quantiles of the beta distribution */
    haft_interval i = haft_study_share_interval(7, 20, 0.95);
    check_relative(i.low, gsl_cdf_beta_Pinv(0.025, 7, 14), 1e-6);
    check_relative(i.high, gsl_cdf_beta_Pinv(0.975, 8, 13), 1e-6);
    assert_true(isnan(haft_study_share_interval(0, 0, 0.95).low));
}

/* The ranks are those that sums of the binomial distribution give, and no narrower pair would do.
 */
static void quantile_ranks_are_the_narrowest(void **state) {
    (void)state;
    for (unsigned n = 1; n <= 90; n++) {
        for (size_t q = 0; q < HAFT_STUDY_QUANTILES; q++) {
            double p = haft_study_quantiles[q], sum = 0;
            size_t low = 0, high = n + 1, found_low, found_high;
            for (unsigned j = 0; j <= n; j++) {
                sum += gsl_ran_binomial_pdf(j, p, n); /* P(B <= j) */
                low = sum <= 0.025 ? j + 1 : low;
                high = 1 - sum <= 0.025 && high > n ? j + 1 : high;
            }
            haft_study_quantile_ranks(n, p, 0.95, &found_low, &found_high);
            assert_int_equal(found_low, low);
            assert_int_equal(found_high, high);
        }
    }
    size_t low, high;
    haft_study_quantile_ranks(10, 0.5, 0.95, &low, &high); /* as in every table */
    assert_true(low == 2 && high == 9);
}

/* ---- coverage ---- */

enum { ROUNDS = 4000 };

/* How far the share of hits may lie from a truth by chance: four standard errors. */
static double allowance(double confidence) {
    return 4 * sqrt(confidence * (1 - confidence) / ROUNDS);
}

static void intervals_hold_the_truth_as_often_as_they_say(void **state) {
    (void)state;
    enum { N = 12 };
    static const double confidences[] = {0.8, 0.95};
    haft_random_key key = {11, HAFT_RANDOM_TEST};
    for (size_t i = 0; i < 2; i++) {
        double c = confidences[i];
        int mean_hits = 0, deviation_hits = 0;
        for (uint64_t round = 0; round < ROUNDS; round++) {
            double z[N], mean = 0, squares = 0;
            haft_random_normals(key, round, i, 0, N, z);
            for (int j = 0; j < N; j++) {
                mean += z[j] / N;
            }
            for (int j = 0; j < N; j++) {
                squares += (z[j] - mean) * (z[j] - mean);
            }
            double s = sqrt(squares / (N - 1));
            haft_interval m = haft_study_mean_interval(mean, s, N, c);
            haft_interval d = haft_study_deviation_interval(s, N, c);
            mean_hits += m.low <= 0 && 0 <= m.high;
            deviation_hits += d.low <= 1 && 1 <= d.high;
        }
        check_near((double)mean_hits / ROUNDS, c, allowance(c));
        check_near((double)deviation_hits / ROUNDS, c, allowance(c));
    }
}

/* By summing up all outcomes, so without chance: never less than said. */
static void shares_are_covered_whatever_the_truth(void **state) {
    (void)state;
    enum { N = 25 };
    haft_interval interval[N + 1];
    for (unsigned k = 0; k <= N; k++) {
        interval[k] = haft_study_share_interval(k, N, 0.9);
    }
    double least = 1;
    for (int i = 1; i < 200; i++) {
        double p = i / 200.0, covered = 0;
        for (unsigned k = 0; k <= N; k++) {
            covered +=
                interval[k].low <= p && p <= interval[k].high ? gsl_ran_binomial_pdf(k, p, N) : 0;
        }
        least = fmin(least, covered);
    }
    assert_true(least >= 0.9 && least < 0.95); /* honest, and no wider than it must be */
}

/* A skew distribution of which a fifth is free: what lies among the free is not known, and below
 * them the quantiles are as well known as if all had stuck. */
static void quantiles_hold_among_the_free(void **state) {
    (void)state;
    enum { N = 70 };
    haft_random_key key = {12, HAFT_RANDOM_TEST};
    const double end = -log(0.2); /* in lengths of 100 um, exponential */
    const haft_case c = {
        .beam = {
            .length = end * 100e-6, .gap = 1.9e-6, .thickness = 2.62e-6, .young_modulus = 163e9}};
    int hits[HAFT_STUDY_QUANTILES] = {0}, beyond = 0;
    haft_summary row[N + 2];
    for (uint64_t round = 0; round < ROUNDS; round++) {
        for (uint64_t k = 0; k < N; k++) {
            uint64_t w[4];
            haft_random_words(key, round, k, 0, w);
            double x = -log(haft_random_uniform(w[0]));
            row[k] = (haft_summary){.crack_length = fmin(x, end) * 100e-6,
                                    .outcome = x < end ? HAFT_OUTCOME_STUCK : HAFT_OUTCOME_FREE};
        }
        row[N] = (haft_summary){.crack_length = NAN, .outcome = HAFT_OUTCOME_STEP_LIMIT};
        row[N + 1] = (haft_summary){.crack_length = NAN, .outcome = -1};
        haft_statistics s = haft_study_statistics(&c, row, N + 2);
        for (size_t i = 0; i < HAFT_STUDY_QUANTILES; i++) {
            double truth = -log1p(-haft_study_quantiles[i]) * 100e-6;
            hits[i] += s.quantile_interval[i].low <= truth && truth <= s.quantile_interval[i].high;
        }
        beyond += isinf(s.quantile[2]);
        assert_true(s.failed == 1 && s.run == N + 1 && s.stuck + s.free == N);
        assert_true(s.stuck_share == (double)s.stuck / N);
    }
    for (size_t i = 0; i < HAFT_STUDY_QUANTILES; i++) {
        assert_true((double)hits[i] / ROUNDS >= 0.95 - allowance(0.95));
    }
    assert_true(hits[1] < ROUNDS * 0.985); /* the median's is not needlessly wide */
    assert_int_equal(beyond, ROUNDS);
}

static void quantiles_are_order_statistics(void **state) {
    (void)state;
    const haft_case c = {.beam = {.gap = 1.9e-6, .thickness = 2.62e-6, .young_modulus = 163e9},
                         .stop = {.confidence = 0.8}};
    haft_summary row[20];
    for (int k = 0; k < 20; k++) { /* 1 to 20 um, in disorder */
        row[k] = (haft_summary){.crack_length = ((7 * k) % 20 + 1) * 1e-6, .outcome = 0};
    }
    haft_statistics s = haft_study_statistics(&c, row, 20);
    check_relative(s.quantile[0], 1e-6, 1e-15);
    check_relative(s.quantile[1], 10e-6, 1e-15);
    check_relative(s.quantile[2], 19e-6, 1e-15);
    size_t low, high;
    haft_study_quantile_ranks(20, 0.5, 0.8, &low, &high);
    check_relative(s.quantile_interval[1].low, (double)low * 1e-6, 1e-15);
    check_relative(s.quantile_interval[1].high, (double)high * 1e-6, 1e-15);
    assert_true(isinf(s.quantile_interval[0].low) && s.confidence == 0.8);
    haft_statistics none = haft_study_statistics(&c, row, 0);
    assert_true(isnan(none.quantile[1]) && isnan(none.stuck_share) &&
                isnan(none.mean_interval.low) && isnan(none.deviation_interval.high) &&
                isnan(none.stuck_interval.low));
}

/* ---- the running table ---- */

static void the_running_table_is_the_statistics_of_every_start(void **state) {
    (void)state;
    enum { N = 2600 };
    scratch d = scratch_create();
    char path[400];
    scratch_path(&d, "convergence.csv", path);
    const haft_case c = {.beam = {.gap = 1.9e-6, .thickness = 2.62e-6, .young_modulus = 163e9}};
    haft_summary row[N];
    double z[N];
    haft_random_normals((haft_random_key){13, HAFT_RANDOM_TEST}, 0, 0, 0, N, z);
    for (int k = 0; k < N; k++) {
        row[k] = (haft_summary){.crack_length = 200e-6 + 10e-6 * z[k],
                                .outcome = k % 7 == 3 ? HAFT_OUTCOME_FREE : HAFT_OUTCOME_STUCK};
    }
    static const size_t counts[] = {1, 2, 50, N};
    for (size_t i = 0; i < 4; i++) {
        haft_error error = {0};
        check_ok(haft_study_write_convergence(&c, row, counts[i], path, &error), error);
        char *text = read_whole_file(path, NULL);
        size_t rows = 0;
        for (char *line = strchr(text, '\n') + 1; *line != '\0'; line = strchr(line, '\n') + 1) {
            double v[8];
            int got = sscanf(line, "%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf", v, v + 1, v + 2, v + 3, v + 4,
                             v + 5, v + 6, v + 7);
            assert_int_equal(got, 8);
            haft_statistics s = haft_study_statistics(&c, row, (size_t)v[0]);
            double expected[8] = {(double)s.run,
                                  (double)s.stuck,
                                  s.mean,
                                  s.mean_interval.low,
                                  s.mean_interval.high,
                                  s.deviation,
                                  s.deviation_interval.low,
                                  s.deviation_interval.high};
            for (int j = 0; j < 8; j++) {
                double x = j < 2 ? expected[j] : expected[j] * 1e6;
                assert_true(isnan(x) ? isnan(v[j]) : fabs(v[j] - x) <= 1e-9 * fabs(x));
            }
            rows++;
        }
        free(text);
        assert_int_equal(rows, counts[i] <= 50 ? counts[i] : N / 2); /* the last is in */
    }
    scratch_remove(&d);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mean_and_deviation_match_closed_forms),
        cmocka_unit_test(shares_match_closed_forms),
        cmocka_unit_test(quantile_ranks_are_the_narrowest),
        cmocka_unit_test(intervals_hold_the_truth_as_often_as_they_say),
        cmocka_unit_test(shares_are_covered_whatever_the_truth),
        cmocka_unit_test(quantiles_hold_among_the_free),
        cmocka_unit_test(quantiles_are_order_statistics),
        cmocka_unit_test(the_running_table_is_the_statistics_of_every_start),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
