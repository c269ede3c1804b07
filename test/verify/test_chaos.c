/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stochastic model against what is known: Gaussian data, the expansion of the normal quantile,
 * variances in closed form, the paper's rule for the error and why it is blind, bounds, threads.
 * Statistical tests have fixed seeds; their limit is five standard deviations. */
#include "chaos_model.h"

#include <gsl/gsl_integration.h>
#include <omp.h>

#define SIGMAS 5.0

/* Vectors whose q is Gaussian with independent parts. */
static haft_law_vector *gaussian_vectors(size_t m) {
    haft_law_vector *v = malloc(m * sizeof *v);
    for (size_t k = 0; k < m; k++) {
        double z[4];
        haft_random_normals((haft_random_key){21, HAFT_RANDOM_TEST}, k, 0, 0, 4, z);
        v[k] = test_vector(2e-3 * exp(0.3 * z[0]), 4e5 * exp(0.2 * z[1]), 1.1e-8 + 5e-10 * z[2],
                           3e-9 * exp(0.1 * z[3]));
    }
    return v;
}

static haft_chaos_errors measure(const haft_chaos *c, size_t maps, size_t samples) {
    haft_chaos_errors errors;
    haft_error error = {0};
    check_ok(haft_chaos_measure(c, &(haft_chaos_effort){maps, samples}, &errors, &error), error);
    return errors;
}

static void gaussian_data_need_hermite_order_one(void **state) {
    (void)state;
    enum { M = 2000 };
    haft_law_vector *v = gaussian_vectors(M);
    double total[3];
    for (int g = 0; g < 3; g++) {
        haft_chaos_spec spec = {.f_limit = TEST_F_LIMIT,
                                .components = 2,
                                .order = 1,
                                .points = 12,
                                .germ = (haft_chaos_germ)g};
        haft_chaos *c = make_model(M, v, &spec);
        total[g] = measure(c, 500, 2000).relmise_total;
        haft_chaos_destroy(&c);
    }
    /* what is left is the sample's own departure from the normal, of order m^(-2/3) */
    check_less(total[HAFT_CHAOS_GERM_HERMITE], pow(M, -2. / 3));
    check_less(10 * total[HAFT_CHAOS_GERM_HERMITE], total[HAFT_CHAOS_GERM_LEGENDRE]);
    check_less(3 * total[HAFT_CHAOS_GERM_HERMITE], total[HAFT_CHAOS_GERM_JACOBI]);
    free(v);
}

/* Sample covariances of eta drawn by kernel and exact samplers: (m - 1)/m + h^2, or the shrunk. */
static void check_covariance(const haft_chaos *c, haft_chaos_work *work, haft_chaos_sampler sampler,
                             size_t n, double expected) {
    haft_error error = {0};
    haft_law_vector *v = malloc(n * sizeof *v);
    double sum[3] = {0}, square[3][3] = {{0}}, fourth[3][3] = {{0}};
    check_ok(haft_chaos_sample(c, work, sampler, 77, 1, 0, n, v, &error), error);
    for (size_t k = 0; k < n; k++) {
        double q[4], eta[3];
        haft_chaos_q_from_vector(c, &v[k], q);
        haft_chaos_eta_from_q(c, q, eta);
        for (int i = 0; i < 3; i++) {
            sum[i] += eta[i];
            for (int j = 0; j < 3; j++) {
                square[i][j] += eta[i] * eta[j];
                fourth[i][j] += eta[i] * eta[i] * eta[j] * eta[j];
            }
        }
    }
    double count = (double)n;
    for (int i = 0; i < 3; i++) {
        check_near(sum[i] / count, 0, SIGMAS * sqrt(expected / count));
        for (int j = 0; j < 3; j++) {
            double mean = square[i][j] / count;
            double deviation = sqrt((fourth[i][j] / count - mean * mean) / count);
            check_near(mean, i == j ? expected : 0, SIGMAS * deviation);
        }
    }
    free(v);
}

static void kernels_have_the_covariance_they_say(void **state) {
    (void)state;
    enum { M = 200 };
    haft_law_vector *v = skewed_vectors(M, 6, 0.3);
    for (int kernel = 0; kernel < 2; kernel++) {
        haft_chaos_spec spec = {.f_limit = TEST_F_LIMIT,
                                .components = 3,
                                .order = 3,
                                .kernel = (haft_chaos_kernel)kernel};
        haft_chaos *c = make_model(M, v, &spec);
        haft_chaos_work *work = make_work(c);
        haft_chaos_parts p;
        haft_chaos_get_parts(c, &p);
        double h2 = p.bandwidth * p.bandwidth;
        check_relative(p.bandwidth, pow(M, -1. / 7), 1e-14);
        double expected = (M - 1.) / M + h2;
        expected /= kernel == HAFT_CHAOS_KERNEL_PRESERVING ? 1 + h2 : 1;
        check_covariance(c, work, HAFT_CHAOS_SAMPLER_KERNEL, 400000, expected);
        check_covariance(c, work, HAFT_CHAOS_SAMPLER_EXACT, 5000, expected);
        haft_chaos_errors errors = measure(c, 100, 2000);
        for (int j = 0; j < 3; j++) {
            check_relative(errors.variance[j], expected, 1e-12);
        }
        haft_chaos_work_destroy(&work);
        haft_chaos_destroy(&c);
    }
    free(v);
}

static double quantile_times_polynomial(double z, void *context) {
    double psi[HAFT_CHAOS_ORDER_LIMIT + 1], u = 0.5 * erfc(-z / sqrt(2));
    size_t order = *(const size_t *)context;
    haft_chaos_polynomials(HAFT_CHAOS_GERM_LEGENDRE, order, u, psi);
    return z * psi[order] * exp(-0.5 * z * z) / sqrt(2 * M_PI);
}

/* 1 less the squares of the coefficients of Phi^-1, integrated over z = Phi^-1(u). */
static double left_out_by(size_t order) {
    gsl_integration_workspace *w = gsl_integration_workspace_alloc(1000);
    double rest = 1;
    for (size_t k = 1; k <= order; k += 2) { /* odd */
        gsl_function f = {quantile_times_polynomial, &k};
        double c = 0, miss = 0;
        gsl_integration_qag(&f, -10, 10, 1e-13, 1e-12, 1000, GSL_INTEG_GAUSS61, w, &c, &miss);
        rest -= c * c;
    }
    gsl_integration_workspace_free(w);
    return rest;
}

/* The normal quantile in Legendre polynomials. Its ends are logarithmic, so the share left out
 * falls no faster than N_d^-2, here as N_d^-1.87. A wide kernel on two centres is a normal law to
 * 1e-8. */
static void legendre_converges_slowly_to_the_normal(void **state) {
    (void)state;
    enum { FIRST = 3, LAST = 15 };
    haft_law_vector v[2] = {test_vector(2e-3, 4e5, 1.1e-8, 3e-9),
                            test_vector(3e-3, 5e5, 1.2e-8, 3.5e-9)};
    double before = 1, sx = 0, sy = 0, sxx = 0, sxy = 0, n = 0;
    for (size_t order = FIRST; order <= LAST; order += 2) {
        haft_chaos_spec spec = {.f_limit = TEST_F_LIMIT,
                                .components = 1,
                                .order = order,
                                .points = 128,
                                .bandwidth = 1e4};
        haft_chaos *c = make_model(2, v, &spec);
        haft_chaos_errors errors = measure(c, 50000, 1000);
        double x = log((double)order), y = log(errors.relmise_total);
        check_less(errors.relmise_total, before);
        check_relative(errors.relmise_total, left_out_by(order), 0.02);
        /* by the model's own coefficients: less what 128 points alias */
        check_relative(errors.relmise_total, errors.variance_error[0], 0.2);
        before = errors.relmise_total;
        sx += x;
        sy += y;
        sxx += x * x;
        sxy += x * y;
        n++;
        haft_chaos_destroy(&c);
    }
    double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
    check_near(slope, -1.87, 0.05);
}

/* One variable and N_d + 1 points: the expansion passes through every point the rule looks at. */
static void the_own_rule_is_blind(void **state) {
    (void)state;
    enum { M = 500 };
    haft_law_vector *v = skewed_vectors(M, 6, 0.3);
    for (size_t g = 1; g <= 3; g += 2) {
        haft_chaos_spec spec = {.f_limit = TEST_F_LIMIT, .components = g, .order = 8};
        haft_chaos *c = make_model(M, v, &spec);
        haft_chaos_errors errors = measure(c, 2000, 2000);
        check_less(errors.relmise_own[0], 1e-24);
        assert_true(errors.relmise[0] > 1e-4);
        if (g == 1) {
            check_less(errors.relmise_own_total, 1e-24);
        } else {
            check_less(3 * errors.relmise_own_total, errors.relmise_total);
        }
        haft_chaos_destroy(&c);
    }
    /* more points than the order needs, and it sees */
    haft_chaos_spec spec = {.f_limit = TEST_F_LIMIT, .components = 1, .order = 8, .points = 64};
    haft_chaos *c = make_model(M, v, &spec);
    haft_chaos_errors errors = measure(c, 100000, 2000);
    check_relative(errors.relmise_own_total, errors.relmise_total, 0.2);
    haft_chaos_destroy(&c);
    free(v);
}

/* Spread-out right wings beside strong left ones: many of the laws by the paper's bounds are none.
 */
static void strict_bounds_are_never_broken(void **state) {
    (void)state;
    enum { M = 400, SAMPLES = 100000 };
    haft_law_vector *v = skewed_vectors(M, 8, 0.3), *out = malloc(SAMPLES * sizeof *out);
    haft_error error = {0};
    for (size_t k = 0; k < M; k++) {
        double z[2];
        haft_random_normals((haft_random_key){8, HAFT_RANDOM_TEST}, k, 1, 0, 2, z);
        v[k] =
            test_vector(3e-5 * exp(1.5 * z[0]), v[k].f_max, v[k].d_max, v[k].d_max - v[k].d_limit);
    }
    for (int bounds = 0; bounds < 2; bounds++) {
        haft_chaos_spec spec = {.f_limit = TEST_F_LIMIT,
                                .bounds = (haft_chaos_bounds)bounds,
                                .components = 4,
                                .order = 6,
                                .germ = HAFT_CHAOS_GERM_HERMITE};
        haft_chaos *c = make_model(M, v, &spec);
        haft_chaos_work *work = make_work(c);
        double measured = measure(c, 100, SAMPLES).outside;
        for (int s = 0; s < HAFT_CHAOS_SAMPLER_BOOTSTRAP; s++) {
            haft_chaos_sampler sampler = (haft_chaos_sampler)s;
            size_t broken = 0, n = sampler == HAFT_CHAOS_SAMPLER_EXACT ? SAMPLES / 25 : SAMPLES;
            check_ok(haft_chaos_sample(c, work, sampler, 5, 0, 0, n, out, &error), error);
            for (size_t k = 0; k < n; k++) {
                haft_law law;
                broken += haft_law_morse(&law, &out[k], TEST_F_LIMIT) != HAFT_LAW_SOUND;
            }
            if (bounds == HAFT_CHAOS_BOUNDS_STRICT) {
                assert_int_equal(broken, 0);
                assert_true(measured == 0);
            } else {
                assert_true(broken > n / 20);
                if (sampler == HAFT_CHAOS_SAMPLER_GPCE) {
                    check_near((double)broken / (double)n, measured,
                               SIGMAS * sqrt(measured / (double)n));
                }
            }
        }
        haft_chaos_work_destroy(&work);
        haft_chaos_destroy(&c);
    }
    free(out);
    free(v);
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Kernel and exact samplers draw the same law: two-sample Kolmogorov-Smirnov on every number. */
static void kernel_and_exact_draw_one_law(void **state) {
    (void)state;
    enum { M = 300, SAMPLES = 6000 };
    haft_law_vector *v = skewed_vectors(M, 9, 0.3), *out[2];
    haft_error error = {0};
    haft_chaos_spec spec = {.f_limit = TEST_F_LIMIT, .components = 3, .order = 2};
    haft_chaos *c = make_model(M, v, &spec);
    haft_chaos_work *work = make_work(c);
    double *x[2];
    for (int s = 0; s < 2; s++) {
        out[s] = malloc(SAMPLES * sizeof *out[s]);
        x[s] = malloc(SAMPLES * sizeof *x[s]);
        check_ok(haft_chaos_sample(c, work,
                                   s == 0 ? HAFT_CHAOS_SAMPLER_KERNEL : HAFT_CHAOS_SAMPLER_EXACT,
                                   (uint64_t)s, 0, 0, SAMPLES, out[s], &error),
                 error);
    }
    for (int i = 0; i < 4; i++) {
        double worst = 0;
        for (int s = 0; s < 2; s++) {
            for (size_t k = 0; k < SAMPLES; k++) {
                double q[4];
                haft_chaos_q_from_vector(c, &out[s][k], q);
                x[s][k] = q[i] - 0.5 * q[(i + 1) % 4]; /* joint law as well */
            }
            qsort(x[s], SAMPLES, sizeof *x[s], compare);
        }
        for (size_t a = 0, b = 0; a < SAMPLES && b < SAMPLES;) {
            x[0][a] < x[1][b] ? a++ : b++;
            worst = fmax(worst, fabs((double)a - (double)b) / SAMPLES);
        }
        /* exceeded by chance once in 1e6: sqrt(-ln(0.5e-6) / SAMPLES) */
        check_less(worst, sqrt(14.5 / SAMPLES));
    }
    for (int s = 0; s < 2; s++) {
        free(out[s]);
        free(x[s]);
    }
    haft_chaos_work_destroy(&work);
    haft_chaos_destroy(&c);
    free(v);
}

/* The same germ, expanded and not: their mean square difference is relMISE by a third rule. */
static void gpce_and_exact_share_their_germ(void **state) {
    (void)state;
    enum { M = 300, SAMPLES = 6000 };
    haft_law_vector *v = skewed_vectors(M, 9, 0.3), *a = malloc(SAMPLES * sizeof *a),
                    *b = malloc(SAMPLES * sizeof *b);
    haft_error error = {0};
    for (int g = 0; g < 3; g++) {
        haft_chaos_spec spec = {.f_limit = TEST_F_LIMIT,
                                .components = 2,
                                .order = 8,
                                .points = 12,
                                .germ = (haft_chaos_germ)g};
        haft_chaos *c = make_model(M, v, &spec);
        haft_chaos_work *work = make_work(c);
        check_ok(haft_chaos_sample(c, NULL, HAFT_CHAOS_SAMPLER_GPCE, 3, 0, 0, SAMPLES, a, &error),
                 error);
        check_ok(haft_chaos_sample(c, work, HAFT_CHAOS_SAMPLER_EXACT, 3, 0, 0, SAMPLES, b, &error),
                 error);
        double difference = 0, size = 0;
        for (size_t k = 0; k < SAMPLES; k++) {
            double q[4], x[2], y[2];
            haft_chaos_q_from_vector(c, &a[k], q);
            haft_chaos_eta_from_q(c, q, x);
            haft_chaos_q_from_vector(c, &b[k], q);
            haft_chaos_eta_from_q(c, q, y);
            for (int i = 0; i < 2; i++) {
                difference += (x[i] - y[i]) * (x[i] - y[i]);
                size += y[i] * y[i];
            }
        }
        double expected = measure(c, 6000, 1000).relmise_total;
        check_less(difference / size, 3 * expected); /* rare far germs carry much of it */
        check_less(expected, 3 * difference / size);
        haft_chaos_work_destroy(&work);
        haft_chaos_destroy(&c);
    }
    free(a);
    free(b);
    free(v);
}

static void threads_do_not_change_a_bit(void **state) {
    (void)state;
    enum { M = 700 };
    haft_law_vector *v = skewed_vectors(M, 12, 0.3);
    haft_chaos_spec spec = {.f_limit = TEST_F_LIMIT, .components = 3, .order = 6};
    haft_chaos *c[2];
    haft_chaos_errors errors[2];
    haft_chaos_parts p[2];
    int usual = omp_get_max_threads();
    for (int k = 0; k < 2; k++) {
        omp_set_num_threads(k == 0 ? 1 : 5);
        c[k] = make_model(M, v, &spec);
        errors[k] = measure(c[k], 300, 3000);
        haft_chaos_get_parts(c[k], &p[k]);
    }
    omp_set_num_threads(usual);
    assert_memory_equal(p[0].coefficient, p[1].coefficient,
                        p[0].terms * 3 * sizeof *p[0].coefficient);
    assert_memory_equal(&errors[0], &errors[1], sizeof errors[0]);
    haft_chaos_destroy(&c[0]);
    haft_chaos_destroy(&c[1]);
    free(v);
}

/* Distances of the marginals: those of a shift and of a poor expansion are what they must be. */
static void distances_see_cut_tails(void **state) {
    (void)state;
    enum { M = 500 };
    haft_law_vector *v = gaussian_vectors(M);
    haft_chaos_spec spec = {.f_limit = TEST_F_LIMIT, .components = 1, .order = 1, .points = 40};
    haft_chaos *c = make_model(M, v, &spec);
    haft_chaos_parts p;
    haft_chaos_get_parts(c, &p);
    haft_chaos_errors errors = measure(c, 2000, 20000);
    /* order 1 in a uniform germ is a uniform law, c_0 + sqrt(3) c_1 (2 u - 1) */
    double h2 = p.bandwidth * p.bandwidth, s = sqrt((M - 1.) / M + h2), a = fabs(p.coefficient[1]);
    check_near(a, s * sqrt(3 / M_PI), 0.02); /* of the normal: E[Phi^-1(u) psi_1(u)] */
    haft_chaos_work *work = make_work(c);
    haft_error error = {0};
    for (int side = 0; side < 2; side++) {
        double xi = side == 0 ? 0.001 : 0.999, exact;
        check_ok(haft_chaos_inverse(c, work, &xi, NULL, &exact, &error), error);
        double uniform = p.coefficient[0] + sqrt(3) * p.coefficient[1] * (2 * xi - 1);
        check_near(side == 0 ? errors.kernel[0].low_quantile : errors.kernel[0].high_quantile,
                   uniform - exact, 1e-3);
        assert_true(fabs(uniform - exact) > 1);
    }
    haft_chaos_work_destroy(&work);
    check_near(errors.kernel[0].ks, 0.0575, 0.02); /* of these two laws, if exactly normal */
    assert_true(errors.kernel[0].w1 > 0.1 && errors.kernel[0].w1 < 0.2);
    assert_true(errors.data[0].ks > errors.kernel[0].ks);
    haft_chaos_destroy(&c);
    spec.germ = HAFT_CHAOS_GERM_HERMITE;
    spec.order = 10;
    c = make_model(M, v, &spec);
    errors = measure(c, 2000, 20000);
    check_less(errors.kernel[0].ks, 0.01);
    check_less(errors.kernel[0].w1, 0.01);
    check_less(fabs(errors.kernel[0].low_quantile), 0.1);
    haft_chaos_destroy(&c);
    free(v);
}

/* Order 0 is one point, whose distances from any law are known: E|X - c|, and the greater share on
 * one side of it. */
static void distances_from_a_point_are_exact(void **state) {
    (void)state;
    enum { M = 300 };
    haft_law_vector *v = skewed_vectors(M, 4, 0.3);
    haft_chaos_spec spec = {.f_limit = TEST_F_LIMIT, .components = 2};
    haft_chaos *c = make_model(M, v, &spec);
    haft_chaos_errors errors = measure(c, 10, 1000);
    haft_chaos_parts p;
    haft_chaos_get_parts(c, &p);
    double h = p.bandwidth;
    for (size_t j = 0; j < 2; j++) {
        double at = p.coefficient[j], w1[2] = {0}, below[2] = {0};
        for (size_t k = 0; k < M; k++) {
            double d = p.centre[2 * k + j] - at, t = d / h;
            w1[0] += fabs(d) / M;
            below[0] += (d < 0) / (double)M;
            w1[1] += (h * sqrt(2 / M_PI) * exp(-0.5 * t * t) + d * erf(t / sqrt(2))) / M;
            below[1] += 0.5 * erfc(t / sqrt(2)) / M;
        }
        check_relative(errors.data[j].w1, w1[0], 1e-12);
        check_near(errors.data[j].ks, fmax(below[0], 1 - below[0]), 1e-12);
        check_relative(errors.kernel[j].w1, w1[1], 1e-3); /* the table's step */
        check_near(errors.kernel[j].ks, fmax(below[1], 1 - below[1]), 1e-6);
        assert_true(errors.variance_error[j] == 1);
    }
    check_relative(errors.reduction, (p.eigenvalue[2] + p.eigenvalue[3]) / 4, 1e-12);
    haft_chaos_destroy(&c);
    free(v);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gaussian_data_need_hermite_order_one),
        cmocka_unit_test(kernels_have_the_covariance_they_say),
        cmocka_unit_test(legendre_converges_slowly_to_the_normal),
        cmocka_unit_test(the_own_rule_is_blind),
        cmocka_unit_test(strict_bounds_are_never_broken),
        cmocka_unit_test(kernel_and_exact_draw_one_law),
        cmocka_unit_test(gpce_and_exact_share_their_germ),
        cmocka_unit_test(threads_do_not_change_a_bit),
        cmocka_unit_test(distances_see_cut_tails),
        cmocka_unit_test(distances_from_a_point_are_exact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
