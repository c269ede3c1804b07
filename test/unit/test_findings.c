/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The correlation length of a surface against its PSD's Hankel transform by quadrature. */
#include "check.h"

#include "haft/study_report.h"

#include <gsl/gsl_sf_bessel.h>

/* 2 pi int s(z) z J0(z r) dz by the midpoint rule, piecewise up to zeta_0 and on. */
static double covariance(const haft_psd *psd, double r) {
    enum { N = 4000 };
    double sum = 0, bound[3] = {0, psd->zeta_0, psd->zeta_max};
    for (int piece = 0; piece < 2; piece++) {
        double step = (bound[piece + 1] - bound[piece]) / N;
        for (int i = 0; i < N; i++) {
            double z = bound[piece] + (i + 0.5) * step;
            sum += step * haft_psd_value(psd, z) * z * gsl_sf_bessel_J0(z * r);
        }
    }
    return 2 * M_PI * sum;
}

static void the_correlation_length_is_that_of_the_psd(void **state) {
    (void)state;
    haft_error error = {0};
    haft_psd psd = {.zeta_max = 289e6, .zeta_0 = 19.4e6, .s_0 = 6.46e-33, .s_1 = 6.46e-39};
    haft_case c = {.seed = 1,
                   .surface = {.psd = psd, .grid_step = 10e-9, .kernel_tolerance = 1e-4},
                   .law = {.sampler = HAFT_SAMPLER_PATCHES},
                   .beam = {.length = 30e-6, .width = 3e-6},
                   .mesh = {.l_meso = 3e-6}};
    static const double shares[] = {0.5, 0.1, 0.05};
    check_relative(covariance(&psd, 0), haft_psd_get_moments(&psd).m0, 1e-5);
    for (size_t i = 0; i < sizeof shares / sizeof *shares; i++) {
        double length, r = 2e-6, variance = covariance(&psd, 0);
        check_ok(haft_study_correlation_length(&length, &c, shares[i], &error), error);
        while (fabs(covariance(&psd, r)) < shares[i] * variance) {
            r -= 10e-9; /* waves are 22 nm long at least */
        }
        for (r += 10e-9; fabs(covariance(&psd, r)) < shares[i] * variance;) {
            r -= 1e-9;
        }
        check_near(length, r, 15e-9); /* a grid step and the kernel's taper */
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_correlation_length_is_that_of_the_psd),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
