/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One campaign against another: laws whose distances are known, and what chance does to samples of
 * one law. */
#include "check.h"

#include "haft/study_report.h"

/* n beams of crack length centre + deviation z; every tenth let go, every eleventh failed, so that
 * those are seen not to count. */
static haft_summary *beams(size_t n, double centre, double deviation, uint64_t seed, bool mixed) {
    haft_summary *s = calloc(n, sizeof *s);
    for (size_t k = 0; k < n; k++) {
        double z;
        haft_random_normals((haft_random_key){seed, HAFT_RANDOM_TEST}, k, 0, 0, 1, &z);
        s[k].crack_length = centre + deviation * z;
        s[k].outcome = HAFT_OUTCOME_STUCK;
        if (mixed && k % 10 == 3) {
            s[k] = (haft_summary){.outcome = HAFT_OUTCOME_FREE, .crack_length = 1e-3};
        } else if (mixed && k % 11 == 5) {
            s[k] = (haft_summary){.outcome = -1, .crack_length = NAN};
        }
    }
    return s;
}

static haft_difference compare(const haft_summary *a, size_t n, const haft_summary *b, size_t m) {
    haft_difference d;
    haft_error error = {0};
    static const haft_case c; /* of one seed: beams are paired too */
    check_ok(haft_study_differ(&d, &c, a, n, &c, b, m, &error), error);
    return d;
}

static void a_sample_is_at_no_distance_from_itself(void **state) {
    (void)state;
    haft_summary *a = beams(200, 240e-6, 9e-6, 1, true);
    haft_difference d = compare(a, 200, a, 200);
    check_near(d.difference, 0, 0);
    check_near(d.deviation_shift, 0, 0);
    check_near(d.distance, 0, 0);
    check_near(d.w1, 0, 0);
    check_near(d.p_value, 1, 1e-12);
    assert_true(d.pairs > 150 && d.pairs < 180);
    free(a);
}

/* Moved rigidly by s, a sample is at Wasserstein distance s, and stretched about its mean by f, at
 * |f - 1| times its mean deviation. */
static void moved_and_stretched_samples_are_at_known_distances(void **state) {
    (void)state;
    enum { NUMBER = 400 };
    haft_summary *a = beams(NUMBER, 240e-6, 9e-6, 2, false), *b = calloc(NUMBER, sizeof *b);
    for (size_t k = 0; k < NUMBER; k++) {
        b[k] = a[k];
        b[k].crack_length += 5e-6;
    }
    haft_difference d = compare(a, NUMBER, b, NUMBER);
    check_relative(d.difference, 5e-6, 1e-9);
    check_relative(d.w1, 5e-6, 1e-9);
    check_near(d.deviation_shift, 0, 1e-18);
    assert_true(d.p_value < 1e-6);
    assert_true(d.w1 > 4 * d.w1_error && d.w1 > 4 * d.w1_by_chance);
    double mean = 0, away = 0;
    for (size_t k = 0; k < NUMBER; k++) {
        mean += a[k].crack_length / NUMBER;
    }
    for (size_t k = 0; k < NUMBER; k++) {
        b[k].crack_length = mean + 1.5 * (a[k].crack_length - mean);
        away += fabs(a[k].crack_length - mean) / NUMBER;
    }
    d = compare(a, NUMBER, b, NUMBER);
    check_near(d.difference, 0, 1e-15);
    check_relative(d.w1, 0.5 * away, 1e-9);
    free(a);
    free(b);
}

/* Of normal samples the standard errors are sigma sqrt(1/n + 1/m), and sigma sqrt(1/2n + 1/2m) of
 * the deviation; between two samples of one law W1 is on average
 * sigma sqrt(1/n + 1/m) int sqrt(2/pi F (1 - F)) dx, the integral being 1.4622. */
static void chance_does_what_theory_says(void **state) {
    (void)state;
    enum { TRIES = 24, A = 150, B = 400 };
    double sigma = 9e-6, root = sqrt(1.0 / A + 1.0 / B);
    double integral = 0, seen = 0, told = 0, spread = 0, error = 0, squares = 0;
    for (int i = -4000; i < 4000; i++) {
        double x = (i + 0.5) * 2e-3, f = 0.5 * erfc(-x * M_SQRT1_2);
        integral += sqrt(2 / M_PI * f * (1 - f)) * 2e-3;
    }
    for (uint64_t t = 0; t < TRIES; t++) {
        haft_summary *a = beams(A, 240e-6, sigma, 100 + t, false),
                     *b = beams(B, 240e-6, sigma, 200 + t, false);
        haft_difference d = compare(a, A, b, B);
        check_relative(d.mean_error, sigma * root, 0.15);
        check_relative(d.deviation_error, sigma * root * M_SQRT1_2, 0.35);
        check_less(fabs(d.difference), 4 * d.mean_error);
        check_less(fabs(d.deviation_shift), 4.5 * d.deviation_error);
        seen += d.w1 / TRIES;
        told += d.w1_by_chance / TRIES;
        error += d.w1_error / TRIES;
        spread += d.w1;
        squares += d.w1 * d.w1;
        free(a);
        free(b);
    }
    check_relative(told, sigma * root * integral, 0.05);
    /* what the tries show, to the spread of their mean */
    double deviation = sqrt((squares - spread * spread / TRIES) / (TRIES - 1));
    check_near(seen, told, 4 * deviation / sqrt(TRIES));
    check_relative(error, deviation, 0.6);
}

static void it_is_the_same_every_time_and_either_way_round(void **state) {
    (void)state;
    haft_summary *a = beams(90, 240e-6, 9e-6, 5, true), *b = beams(70, 243e-6, 8e-6, 6, true);
    haft_difference first = compare(a, 90, b, 70), again = compare(a, 90, b, 70);
    assert_memory_equal(&first, &again, sizeof first);
    haft_difference back = compare(b, 70, a, 90);
    check_near(back.difference, -first.difference, 0);
    check_near(back.distance, first.distance, 0);
    check_relative(back.w1, first.w1, 1e-12);
    check_relative(back.w1_by_chance, first.w1_by_chance, 0.2);
    free(a);
    free(b);
}

static void too_few_beams_leave_it_unknown(void **state) {
    (void)state;
    haft_summary *a = beams(5, 240e-6, 9e-6, 5, false), *b = beams(5, 240e-6, 9e-6, 6, false);
    b[0].outcome = b[1].outcome = b[2].outcome = b[3].outcome = HAFT_OUTCOME_FREE;
    haft_difference d = compare(a, 5, b, 5);
    assert_true(isnan(d.mean_error) && isnan(d.deviation_shift) && isnan(d.deviation_error));
    assert_true(isnan(d.w1) && isnan(d.w1_error) && isnan(d.w1_by_chance));
    assert_true(isfinite(d.difference) && isfinite(d.distance));
    free(a);
    free(b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sample_is_at_no_distance_from_itself),
        cmocka_unit_test(moved_and_stretched_samples_are_at_known_distances),
        cmocka_unit_test(chance_does_what_theory_says),
        cmocka_unit_test(it_is_the_same_every_time_and_either_way_round),
        cmocka_unit_test(too_few_beams_leave_it_unknown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
