/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The Rosenblatt map: against GSL's normal CDF, against numerical integrals of the kernel density
 * as one writes it down, there and back, and where conditionals are bimodal or degenerate. */
#include "chaos_model.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_integration.h>

/* One kernel: both tails are the normal's, to a rounding of its argument. */
static void one_kernel_is_the_normal_law(void **state) {
    (void)state;
    double centre = 0.25, h = 0.5, xi, tail, back;
    haft_error error = {0};
    haft_chaos *c = model_of_centres(1, 1, &centre, h);
    haft_chaos_work *work = make_work(c);
    for (double t = -35; t <= 35; t += 0.0625) {
        double eta = centre + h * t, tolerance = 2e-15 * (1 + t * t);
        haft_chaos_rosenblatt(c, work, &eta, &xi, &tail);
        check_relative(xi, gsl_cdf_ugaussian_P(t), tolerance);
        check_relative(tail, gsl_cdf_ugaussian_Q(t), tolerance);
        check_ok(haft_chaos_inverse(c, work, &xi, &tail, &back, &error), error);
        check_near(back, eta, 1e-14 * (1 + fabs(t)));
    }
    haft_chaos_work_destroy(&work);
    haft_chaos_destroy(&c);
}

/* ---- against integrals of the density ---- */

enum { M = 14 };
#define H 0.45

typedef struct density {
    const double *centre; /* [M][2] */
    double x;
} density;

static double joint(const density *d, double x, double y) {
    double sum = 0;
    for (int k = 0; k < M; k++) {
        double a = x - d->centre[2 * k], b = y - d->centre[2 * k + 1];
        sum += exp(-(a * a + b * b) / (2 * H * H));
    }
    return sum / (M * 2 * M_PI * H * H);
}

static double integrate(double (*f)(double, void *), void *context, double low, double high) {
    gsl_integration_workspace *w = gsl_integration_workspace_alloc(1000);
    double value = 0, miss = 0;
    gsl_function function = {f, context};
    gsl_integration_qag(&function, low, high, 1e-15, 1e-13, 1000, GSL_INTEG_GAUSS61, w, &value,
                        &miss);
    gsl_integration_workspace_free(w);
    return value;
}

static double along_y(double y, void *context) {
    const density *d = context;
    return joint(d, d->x, y);
}

static double along_x(double x, void *context) {
    density d = *(const density *)context;
    d.x = x;
    return integrate(along_y, &d, -8, 8);
}

static void map_is_the_integral_of_the_density(void **state) {
    (void)state;
    double centre[2 * M];
    haft_error error = {0};
    for (int k = 0; k < 2 * M; k++) {
        centre[k] = 4 * test_uniform(1, (uint64_t)k) - 2;
    }
    haft_chaos *c = model_of_centres(M, 2, centre, H);
    haft_chaos_work *work = make_work(c);
    for (uint64_t k = 0; k < 12; k++) {
        double xi[2] = {test_uniform(2, k), test_uniform(3, k)}, eta[2];
        check_ok(haft_chaos_inverse(c, work, xi, NULL, eta, &error), error);
        density d = {centre, eta[0]};
        check_near(integrate(along_x, &d, -8, eta[0]), xi[0], 1e-11);
        double whole = integrate(along_y, &d, -8, 8);
        check_near(integrate(along_y, &d, -8, eta[1]) / whole, xi[1], 1e-11);
    }
    haft_chaos_work_destroy(&work);
    haft_chaos_destroy(&c);
}

/* ---- there and back ---- */

/* xi -> eta -> xi errs by density times the rounding of eta, tails relative to themselves: by
 * |d ln xi / d eta| times that; steep where h is small beside eta. */
static void check_round_trip(const haft_chaos *c, size_t g, const double *xi, const double *tail,
                             double tolerance) {
    haft_error error = {0};
    double eta[4], back[4], back_tail[4];
    haft_chaos_work *work = make_work(c);
    check_ok(haft_chaos_inverse(c, work, xi, tail, eta, &error), error);
    haft_chaos_rosenblatt(c, work, eta, back, back_tail);
    for (size_t i = 0; i < g; i++) {
        if (xi[i] <= 0.5) {
            check_relative(back[i], xi[i], tolerance);
        } else {
            check_relative(back_tail[i], tail[i], tolerance);
        }
    }
    haft_chaos_work_destroy(&work);
}

static void map_and_inverse_cancel(void **state) {
    (void)state;
    enum { COUNT = 3000 };
    double *centre = malloc(4 * COUNT * sizeof *centre);
    for (size_t g = 1; g <= 4; g++) {
        haft_random_normals((haft_random_key){5, HAFT_RANDOM_TEST}, g, 0, 0, g * COUNT, centre);
        for (size_t k = 0; k < g * COUNT; k++) {
            centre[k] += 0.3 * centre[k] * centre[k]; /* skewed */
        }
        haft_chaos *c = model_of_centres(COUNT, g, centre, 0.3);
        for (uint64_t k = 0; k < 40; k++) {
            double xi[4], tail[4];
            for (size_t i = 0; i < g; i++) {
                double p = 0.5 * pow(10, -14 * test_uniform(10 + i, k)); /* far into the tails */
                bool lower = test_uniform(20 + i, k) < 0.5;
                xi[i] = lower ? p : 1 - p;
                tail[i] = lower ? 1 - p : p;
            }
            check_round_trip(c, g, xi, tail, 1e-12);
        }
        haft_chaos_destroy(&c);
    }
    free(centre);
}

/* Two humps 200 bandwidths apart: the quantile jumps at 1/2, and plain Newton cycles near it. */
static void bimodal_conditionals_are_solved(void **state) {
    (void)state;
    haft_error error = {0};
    for (double gap = 4; gap <= 400; gap *= 10) {
        double centre[] = {0, -gap / 2, 0, -gap / 2, 0, gap / 2, 0, gap / 2}, h = 0.9;
        haft_chaos *c = model_of_centres(4, 2, centre, h);
        haft_chaos_work *work = make_work(c);
        for (double p = 1e-12; p < 0.4999; p = p < 0.2 ? 3 * p : p + 0.01) {
            double xi[2] = {0.3, p}, tail[2] = {0.7, 1 - p}, low[2], high[2];
            check_round_trip(c, 2, xi, tail, 1e-12);
            check_ok(haft_chaos_inverse(c, work, xi, tail, low, &error), error);
            check_ok(haft_chaos_inverse(c, work, tail, xi, high, &error), error);
            check_near(high[1], -low[1], 1e-12 * gap); /* the mixture is even */
            if (gap >= 40) {
                check_near(low[1], -gap / 2 + h * gsl_cdf_ugaussian_Pinv(2 * p), 1e-12 * gap);
            }
        }
        for (double p = 0.5 - 1e-6; p < 0.5 + 1e-6; p += 1e-7) {
            check_round_trip(c, 2, (double[]){0.4, p}, (double[]){0.6, 1 - p}, 1e-12);
        }
        haft_chaos_work_destroy(&work);
        haft_chaos_destroy(&c);
    }
}

/* Up to four humps, 0.1 to 1000 bandwidths apart, of weights down to 1e-12 (kernels of a first
 * component far off), deep tails: the CDF comes back to what the rounding of eta allows. */
static void any_humps_are_solved(void **state) {
    (void)state;
    haft_error error = {0};
    for (uint64_t t = 0; t < 4000; t++) {
        double centre[8], scale = pow(10, 4 * test_uniform(t, 0) - 1), eta[2], back[2], tail[2];
        size_t m = 1 + (size_t)(4 * test_uniform(t, 1));
        for (size_t k = 0; k < m; k++) {
            centre[2 * k] = test_uniform(t, 2 + k) < 0.5 ? 0 : 7.4 * test_uniform(t, 6 + k);
            centre[2 * k + 1] = scale * (test_uniform(t, 10 + k) - 0.5);
        }
        haft_chaos *c = model_of_centres(m, 2, centre, 1);
        haft_chaos_work *work = make_work(c);
        double p = 0.5 * pow(10, -14 * test_uniform(t, 20)), q = 1 - p;
        bool lower = test_uniform(t, 21) < 0.5;
        check_ok(haft_chaos_inverse(c, work, (double[]){0.001, lower ? p : q},
                                    (double[]){0.999, lower ? q : p}, eta, &error),
                 error);
        haft_chaos_rosenblatt(c, work, eta, back, tail);
        double hazard = 1 + sqrt(-2 * log(p)); /* density / tail, at most */
        check_relative(lower ? back[1] : tail[1], p, 1e-13 + 4e-16 * hazard * scale);
        haft_chaos_work_destroy(&work);
        haft_chaos_destroy(&c);
    }
}

/* Equal points are one kernel; a far outlier holds its share and no more; far from all data, where
 * every weight underflows, the nearest centre is left alone. */
static void degenerate_conditionals_are_solved(void **state) {
    (void)state;
    double same[20], h = 1e-3, eta[2], xi[2], tail[2];
    haft_error error = {0};
    for (int k = 0; k < 20; k++) {
        same[k] = 0.75;
    }
    haft_chaos *c = model_of_centres(10, 2, same, h);
    haft_chaos_work *work = make_work(c);
    check_ok(haft_chaos_inverse(c, work, (double[]){1e-9, 0.9}, NULL, eta, &error), error);
    check_near(eta[0], 0.75 + h * gsl_cdf_ugaussian_Pinv(1e-9), 1e-15);
    check_near(eta[1], 0.75 + h * gsl_cdf_ugaussian_Pinv(0.9), 1e-15);
    haft_chaos_work_destroy(&work);
    haft_chaos_destroy(&c);

    double centre[] = {0, 0, 1, 3, -1, -2, 1e6, 5};
    c = model_of_centres(4, 2, centre, h);
    work = make_work(c);
    check_ok(haft_chaos_inverse(c, work, (double[]){0.9, 0.2}, NULL, eta, &error), error);
    check_near(eta[0], 1e6 + h * gsl_cdf_ugaussian_Pinv((0.9 - 0.75) / 0.25), 1e-9);
    check_near(eta[1], 5 + h * gsl_cdf_ugaussian_Pinv(0.2), 1e-14);
    eta[0] = 4000; /* nearest in the first component: (1, 3), four million bandwidths away */
    eta[1] = 3 + h;
    haft_chaos_rosenblatt(c, work, eta, xi, tail);
    check_relative(xi[1], gsl_cdf_ugaussian_P(1), 1e-9);
    check_relative(tail[1], gsl_cdf_ugaussian_Q(1), 1e-9);
    haft_chaos_work_destroy(&work);
    haft_chaos_destroy(&c);
}

static void probabilities_must_lie_inside(void **state) {
    (void)state;
    double centre[] = {0, 0}, eta[2];
    static const double bad[] = {0, 1, -0.1, 1.1, NAN, INFINITY, 1e-290};
    haft_error error = {0};
    haft_chaos *c = model_of_centres(1, 2, centre, 1);
    haft_chaos_work *work = make_work(c);
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        double xi[2] = {0.5, bad[k]};
        assert_int_equal(haft_chaos_inverse(c, work, xi, NULL, eta, &error), HAFT_ERROR_ARGUMENT);
        assert_non_null(strstr(error.message, "xi[1]"));
    }
    check_ok(haft_chaos_inverse(c, work, (double[]){1e-280, 1}, (double[]){1, 1e-200}, eta, &error),
             error);
    check_near(eta[0], gsl_cdf_ugaussian_Pinv(1e-280), 1e-12);
    check_near(eta[1], gsl_cdf_ugaussian_Qinv(1e-200), 1e-12);
    haft_chaos_work_destroy(&work);
    haft_chaos_destroy(&c);
}

/* Which component comes first in the map changes the conditionals, not the law: the density, being
 * the product of the conditionals' slopes, is the same. */
static double density_by_slopes(const haft_chaos *c, haft_chaos_work *work, const double *eta,
                                const size_t *order) {
    double product = 1, step = 1e-4;
    for (size_t i = 0; i < 2; i++) {
        double high[2] = {eta[0], eta[1]}, low[2] = {eta[0], eta[1]}, a[2], b[2];
        high[order[i]] += step;
        low[order[i]] -= step;
        haft_chaos_rosenblatt(c, work, high, a, NULL);
        haft_chaos_rosenblatt(c, work, low, b, NULL);
        product *= (a[i] - b[i]) / (2 * step);
    }
    return product;
}

static void component_order_keeps_the_law(void **state) {
    (void)state;
    enum { COUNT = 400 };
    haft_law_vector *v = skewed_vectors(COUNT, 3, 0.3);
    double found[2];
    for (int turn = 0; turn < 2; turn++) {
        haft_chaos_spec spec = {
            .f_limit = TEST_F_LIMIT, .components = 2, .order = 2, .component_order = {turn, !turn}};
        size_t order[2] = {(size_t)turn, (size_t)!turn};
        haft_chaos *c = make_model(COUNT, v, &spec);
        haft_chaos_work *work = make_work(c);
        found[turn] = density_by_slopes(c, work, (double[]){0.4, -0.7}, order);
        haft_chaos_work_destroy(&work);
        haft_chaos_destroy(&c);
    }
    check_relative(found[0], found[1], 1e-6);
    free(v);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_kernel_is_the_normal_law),
        cmocka_unit_test(map_is_the_integral_of_the_density),
        cmocka_unit_test(map_and_inverse_cancel),
        cmocka_unit_test(bimodal_conditionals_are_solved),
        cmocka_unit_test(any_humps_are_solved),
        cmocka_unit_test(degenerate_conditionals_are_solved),
        cmocka_unit_test(probabilities_must_lie_inside),
        cmocka_unit_test(component_order_keeps_the_law),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
