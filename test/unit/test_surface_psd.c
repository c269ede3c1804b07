/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The self-affine PSD: moments against adaptive quadrature, the published surfaces' numbers. And
 * the correlation that a marginal makes of the Gaussian one. */
#include "check.h"

#include "haft/surface.h"
#include "surface/marginal.h"

#include <gsl/gsl_integration.h>

static const haft_psd PUBLISHED[2] = {{289e6, 19.4e6, 6.46e-33, 6.46e-39},
                                      {283e6, 40e6, 0.5e-33, 50e-39}};

typedef struct integrand {
    haft_psd psd;
    int power;
} integrand;

static double evaluate(double zeta, void *parameters) {
    const integrand *f = parameters;
    return haft_psd_value(&f->psd, zeta) * pow(zeta, f->power);
}

static double integrate(haft_psd psd, int power) {
    integrand parameters = {psd, power};
    gsl_function f = {evaluate, &parameters};
    gsl_integration_workspace *workspace = gsl_integration_workspace_alloc(1000);
    double edges[3] = {0, psd.zeta_0, psd.zeta_max}, sum = 0;
    for (int i = 0; i < 2; i++) {
        double part = 0, bound = 0;
        gsl_integration_qag(&f, edges[i], edges[i + 1], 0, 1e-13, 1000, GSL_INTEG_GAUSS61,
                            workspace, &part, &bound);
        sum += part;
    }
    gsl_integration_workspace_free(workspace);
    return sum;
}

static void moments_are_integrals(void **state) {
    (void)state;
    /* The last three have power laws of exponent -2, -4 and -6, where the closed form's divisor
     * vanishes, and the fourth a flat one. */
    haft_psd psds[] = {PUBLISHED[0],
                       PUBLISHED[1],
                       {1e8, 9.99e7, 1e-33, 1e-40},
                       {3e8, 1e7, 2e-33, 2e-33},
                       {3e8, 3e7, 1e-33, 1e-35},
                       {3e8, 3e7, 1e-33, 1e-37},
                       {3e8, 3e7, 1e-33, 1e-39}};
    for (size_t i = 0; i < sizeof psds / sizeof *psds; i++) {
        haft_psd_moments m = haft_psd_get_moments(&psds[i]);
        check_relative(m.m0, 2 * M_PI * integrate(psds[i], 1), 1e-12);
        check_relative(m.m2, M_PI * integrate(psds[i], 3), 1e-12);
        check_relative(m.m4, 0.75 * M_PI * integrate(psds[i], 5), 1e-12);
    }
}

static void value_follows_the_law(void **state) {
    (void)state;
    const haft_psd *psd = &PUBLISHED[0];
    check_near(haft_psd_value(psd, 0), psd->s_0, 0);
    check_near(haft_psd_value(psd, psd->zeta_0), psd->s_0, 0);
    check_relative(haft_psd_value(psd, psd->zeta_max), psd->s_1, 1e-13);
    check_relative(haft_psd_value(psd, sqrt(psd->zeta_0 * psd->zeta_max)),
                   sqrt(psd->s_0 * psd->s_1), 1e-13);
    check_near(haft_psd_value(psd, 1.0001 * psd->zeta_max), 0, 0);
}

/* The published parameters give the published roughness, as the paper's own parameters allow. */
static void published_parameters_give_published_roughness(void **state) {
    (void)state;
    static const double rms[2] = {3.54e-9, 2.09e-9}, slope[2] = {0.0032, 0.0053},
                        curvature[2] = {9.2e12, 44e12};
    for (int i = 0; i < 2; i++) {
        haft_psd_moments m = haft_psd_get_moments(&PUBLISHED[i]);
        check_near(sqrt(m.m0), rms[i], 0.005e-9);
        check_near(m.m2, slope[i], 0.00005);
        check_near(m.m4, curvature[i], i == 0 ? 0.05e12 : 0.5e12);
    }
}

/* Range of a Greenwood-Williamson number over all moments that round to those printed. */
static void gw_range(const double printed[3], const double half_digit[3], int which, double *low,
                     double *high) {
    *low = HUGE_VAL;
    *high = 0;
    for (int corner = 0; corner < 8; corner++) {
        double x[3];
        for (int i = 0; i < 3; i++) {
            x[i] = printed[i] + (corner >> i & 1 ? half_digit[i] : -half_digit[i]);
        }
        haft_gw gw = haft_gw_from_moments((haft_psd_moments){x[0] * x[0], x[1], x[2]});
        double value[3] = {gw.radius, gw.summit_deviation, gw.density};
        *low = fmin(*low, value[which]);
        *high = fmax(*high, value[which]);
    }
}

/* Table 2 of Hoang et al. (2017): each printed number within half a digit of what moments that
 * print as the table's can give. */
static void published_moments_give_published_asperities(void **state) {
    (void)state;
    static const struct {
        double moments[3], half_digit[3];
        double gw[3], gw_half_digit[3];
    } table[2] = {
        {{3.5e-9, 0.0035, 9.1e12},
         {0.05e-9, 0.00005, 0.05e12},
         {220e-9, 3.3e-9, 80.1e12},
         {0.5e-9, 0.05e-9, 0.05e12}},
        {{2.2e-9, 0.0057, 45e12},
         {0.05e-9, 0.00005, 0.5e12},
         {100e-9, 2.1e-9, 242e12},
         {1e-9, 0.05e-9, 0.5e12}},
    };
    for (int i = 0; i < 2; i++) {
        for (int which = 0; which < 3; which++) {
            double low = 0, high = 0;
            gw_range(table[i].moments, table[i].half_digit, which, &low, &high);
            check_less(low - table[i].gw_half_digit[which], table[i].gw[which]);
            check_less(table[i].gw[which], high + table[i].gw_half_digit[which]);
            check_less(high / low, 1.07); /* the range is narrow enough to mean something */
        }
    }
}

static void bad_parameters_are_named(void **state) {
    (void)state;
    static const struct {
        haft_psd psd;
        const char *says;
    } bad[] = {
        {{0, 1e7, 1e-33, 1e-39}, "zeta_max"},
        {{NAN, 1e7, 1e-33, 1e-39}, "zeta_max"},
        {{INFINITY, 1e7, 1e-33, 1e-39}, "zeta_max"},
        {{3e8, 3e8, 1e-33, 1e-39}, "zeta_0"},
        {{3e8, 0, 1e-33, 1e-39}, "zeta_0"},
        {{3e8, 1e7, 0, 1e-39}, "s_0"},
        {{3e8, 1e7, INFINITY, 1e-39}, "s_0"},
        {{3e8, 1e7, 1e-33, 2e-33}, "s_1"},
        {{3e8, 1e7, 1e-33, 0}, "s_1"},
        {{3e8, 1e7, 1e-33, NAN}, "s_1"},
    };
    haft_error error = {0};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(haft_psd_check(&bad[i].psd, &error), HAFT_ERROR_INPUT);
        assert_int_equal(strncmp(error.message, bad[i].says, strlen(bad[i].says)), 0);
    }
    check_ok(haft_psd_check(&PUBLISHED[0], &error), error);
    check_ok(haft_psd_check(&PUBLISHED[1], &error), error);
}

/* E[q(g) q(g')] by the trapezoidal rule over the plane of independent normal numbers. */
static double correlation_by_integral(const haft_marginal *m, double rho) {
    const double h = 0.04, reach = 7.2;
    double sum = 0, weight = 0, root = sqrt(1 - rho * rho);
    for (double x = -reach; x <= reach; x += h) {
        double first = haft_marginal_value(m, x);
        for (double y = -reach; y <= reach; y += h) {
            double w = exp(-0.5 * (x * x + y * y));
            sum += w * first * haft_marginal_value(m, rho * x + root * y);
            weight += w;
        }
    }
    return sum / weight;
}

static void correlations_are_double_integrals(void **state) {
    (void)state;
    static const double pairs[][2] = {{0.545, 3.38}, {-1, 4}, {0, 2}, {1, 5}, {2, 9}, {0, 8}};
    static const double rho[] = {-0.9, -0.3, 0.1, 0.5, 0.8, 0.95, 0.999, 1};
    for (size_t k = 0; k < sizeof pairs / sizeof *pairs; k++) {
        haft_marginal *m = NULL;
        haft_error error = {0};
        double worst = 0;
        check_ok(haft_marginal_johnson(&m, pairs[k][0], pairs[k][1], &error), error);
        for (size_t i = 0; i < sizeof rho / sizeof *rho; i++) {
            double integral = correlation_by_integral(m, rho[i]);
            worst = fmax(worst, fabs(haft_marginal_correlation(m, rho[i]) - integral));
        }
        print_message("skewness %g, kurtosis %g: series and integral differ by %.1e at most\n",
                      pairs[k][0], pairs[k][1], worst);
        check_less(worst, 1e-7);
        haft_marginal_destroy(&m);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(moments_are_integrals),
        cmocka_unit_test(value_follows_the_law),
        cmocka_unit_test(published_parameters_give_published_roughness),
        cmocka_unit_test(published_moments_give_published_asperities),
        cmocka_unit_test(bad_parameters_are_named),
        cmocka_unit_test(correlations_are_double_integrals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
