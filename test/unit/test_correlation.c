/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Spatial correlation: against autoregressive sequences, whose correlation is known, and by how
 * often its intervals hold the truth. */
#include "check.h"

#include "haft/study.h"

enum { REALIZATIONS = 300, SITES = 120, LAGS = 12 };

/* Stationary x_{t+1} = phi x_t + sqrt(1 - phi^2) z, of correlation phi^l, moved and stretched. */
static double *sequences(size_t realizations, size_t sites, double phi, uint64_t seed) {
    double *x = malloc(realizations * sites * sizeof *x), *z = malloc(sites * sizeof *z);
    for (size_t j = 0; j < realizations; j++) {
        haft_random_normals((haft_random_key){seed, HAFT_RANDOM_TEST}, j, 0, 0, sites, z);
        double at = z[0];
        for (size_t r = 0; r < sites; r++) {
            at = r == 0 ? z[0] : phi * at + sqrt(1 - phi * phi) * z[r];
            x[j * sites + r] = 1e-8 + 3e-10 * at;
        }
    }
    free(z);
    return x;
}

static void correlate(size_t realizations, size_t sites, const double *x, size_t stride,
                      haft_correlation *out) {
    haft_error error = {0};
    check_ok(haft_study_correlation(realizations, sites, x, stride, LAGS, out, &error), error);
}

static void an_autoregressive_sequence_has_its_correlation(void **state) {
    (void)state;
    static const double phis[] = {-0.5, 0, 0.3, 0.8};
    for (size_t i = 0; i < sizeof phis / sizeof *phis; i++) {
        haft_correlation rho[LAGS + 1];
        double *x = sequences(REALIZATIONS, SITES, phis[i], 7 + i);
        correlate(REALIZATIONS, SITES, x, 1, rho);
        check_near(rho[0].value, 1, 1e-12);
        check_near(rho[0].error, 0, 1e-12);
        for (size_t l = 1; l <= LAGS; l++) {
            assert_int_equal(rho[l].pairs, REALIZATIONS * (SITES - l));
            check_near(rho[l].value, pow(phis[i], (double)l), 4 * rho[l].error);
            assert_true(rho[l].error < 0.03);
        }
        free(x);
    }
}

/* Bartlett (1946): the variance of rho_l of n numbers is, for phi^l,
 * ((1 + p)(1 - p^l) / (1 - p) - 2 l p^l) / n, with p = phi^2. */
static void its_error_is_bartlett_s(void **state) {
    (void)state;
    static const double phis[] = {0, 0.5, 0.8};
    for (size_t i = 0; i < sizeof phis / sizeof *phis; i++) {
        haft_correlation rho[LAGS + 1];
        double *x = sequences(1200, SITES, phis[i], 70 + i), p = phis[i] * phis[i];
        correlate(1200, SITES, x, 1, rho);
        for (size_t l = 1; l <= LAGS; l++) {
            double power = pow(p, (double)l);
            double variance = (1 + p) * (1 - power) / (1 - p) - 2 * (double)l * power;
            double expected = sqrt(variance / (1200.0 * SITES));
            check_relative(rho[l].error, expected, 0.12); /* itself known to 1/sqrt(2400) = 2 % */
        }
        free(x);
    }
}

static void intervals_hold_the_truth_as_often_as_they_say(void **state) {
    (void)state;
    enum { TRIES = 60, FEW = 20 };
    size_t held = 0, all = 0;
    for (uint64_t t = 0; t < TRIES; t++) {
        haft_correlation rho[LAGS + 1];
        double *x = sequences(FEW, SITES, 0.4, 1000 + t);
        correlate(FEW, SITES, x, 1, rho);
        for (size_t l = 1; l <= LAGS; l++) {
            haft_interval band =
                haft_study_mean_interval(rho[l].value, rho[l].error * sqrt(FEW), FEW, 0.9);
            double truth = pow(0.4, (double)l);
            held += band.low <= truth && truth <= band.high;
            all++;
        }
        free(x);
    }
    /* 720 intervals, the lags of one try hanging together: 5 % is 4 standard deviations */
    check_near((double)held / (double)all, 0.9, 0.05);
}

static void numbers_that_are_none_are_left_out(void **state) {
    (void)state;
    haft_correlation plain[LAGS + 1], holed[LAGS + 1], strided[LAGS + 1];
    double *x = sequences(50, SITES, 0.6, 5);
    correlate(50, SITES, x, 1, plain);
    double *wide = malloc(50 * SITES * 3 * sizeof *wide);
    for (size_t k = 0; k < 50 * SITES; k++) {
        wide[3 * k] = x[k];
        wide[3 * k + 1] = wide[3 * k + 2] = NAN;
    }
    correlate(50, SITES, wide, 3, strided);
    /* a realization of nothing is as good as none */
    double *longer = malloc(51 * SITES * sizeof *longer);
    memcpy(longer, x, 50 * SITES * sizeof *x);
    for (size_t r = 0; r < SITES; r++) {
        longer[50 * SITES + r] = NAN;
    }
    correlate(51, SITES, longer, 1, holed);
    for (size_t l = 0; l <= LAGS; l++) {
        check_near(strided[l].value, plain[l].value, 0);
        check_near(strided[l].error, plain[l].error, 0);
        check_near(holed[l].value, plain[l].value, 1e-15);
        assert_int_equal(holed[l].pairs, plain[l].pairs);
    }
    longer[3] = INFINITY;
    correlate(50, SITES, longer, 1, holed);
    assert_int_equal(holed[0].pairs, 50 * SITES - 1);
    assert_int_equal(holed[1].pairs, 50 * (SITES - 1) - 2);
    check_near(holed[1].value, plain[1].value, 1e-3);
    free(longer);
    free(wide);
    free(x);
}

static void one_realization_has_no_error(void **state) {
    (void)state;
    haft_correlation rho[LAGS + 1];
    double *x = sequences(1, SITES, 0.3, 9);
    correlate(1, SITES, x, 1, rho);
    check_near(rho[0].value, 1, 1e-12);
    assert_true(isfinite(rho[1].value) && isnan(rho[1].error));
    for (size_t r = 0; r < SITES; r++) {
        x[r] = 4;
    }
    correlate(1, SITES, x, 1, rho);
    assert_true(isnan(rho[0].value) && isnan(rho[1].value)); /* nothing varies */
    free(x);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_autoregressive_sequence_has_its_correlation),
        cmocka_unit_test(its_error_is_bartlett_s),
        cmocka_unit_test(intervals_hold_the_truth_as_often_as_they_say),
        cmocka_unit_test(numbers_that_are_none_are_left_out),
        cmocka_unit_test(one_realization_has_no_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
