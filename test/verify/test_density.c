/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Kernel densities: against closed forms, their own marginals, and the mean integrated square error
 * that theory gives for normal samples. */
#include "chaos_model.h"

enum { POINTS = 801 };

static void grid(double low, double high, size_t n, double *x) {
    for (size_t i = 0; i < n; i++) {
        x[i] = low + (high - low) * (double)i / (double)(n - 1);
    }
}

static double normal(double x, double s) {
    return exp(-0.5 * x * x / (s * s)) / (sqrt(2 * M_PI) * s);
}

static void two_kernels_are_a_sum_of_two_normals(void **state) {
    (void)state;
    double centre[] = {-1, 7, 2, 9}, x[POINTS], p[POINTS], sum = 0;
    haft_chaos_kernels k = {2, centre, 2, 0.4, HAFT_CHAOS_KERNEL_SCOTT};
    grid(-5, 6, POINTS, x);
    haft_chaos_density(&k, 0, POINTS, x, p);
    for (size_t i = 0; i < POINTS; i++) {
        check_near(p[i], 0.5 * (normal(x[i] + 1, 0.4) + normal(x[i] - 2, 0.4)), 1e-14);
        sum += p[i] * (x[1] - x[0]);
    }
    check_near(sum, 1, 1e-12);
    haft_chaos_density(&k, 1, 1, (double[]){7.1}, p);
    check_near(p[0], 0.5 * (normal(0.1, 0.4) + normal(1.9, 0.4)), 1e-14);
    haft_chaos_density(&k, 1, 1, (double[]){1e6}, p);
    check_near(p[0], 0, 0);
}

/* Scott's kernels add h^2 to the variance, preserving ones nothing. */
static void preserving_kernels_preserve_the_variance(void **state) {
    (void)state;
    enum { M = 50 };
    double centre[M], x[POINTS], p[POINTS], mean = 0, variance = 0, h = 0.6;
    for (size_t k = 0; k < M; k++) {
        centre[k] = haft_random_normal_quantile(test_uniform(k, 0));
        mean += centre[k] / M;
    }
    for (size_t k = 0; k < M; k++) {
        centre[k] -= mean;
        variance += centre[k] * centre[k] / M;
    }
    for (size_t k = 0; k < M; k++) {
        centre[k] /= sqrt(variance);
    }
    grid(-9, 9, POINTS, x);
    for (int kind = 0; kind < 2; kind++) {
        haft_chaos_kernels k = {M, centre, 1, h, (haft_chaos_kernel)kind};
        double square = 0;
        haft_chaos_density(&k, 0, POINTS, x, p);
        for (size_t i = 0; i < POINTS; i++) {
            square += x[i] * x[i] * p[i] * (x[1] - x[0]);
        }
        check_near(square, kind == HAFT_CHAOS_KERNEL_SCOTT ? 1 + h * h : 1, 1e-10);
    }
}

static void a_joint_density_holds_its_marginals(void **state) {
    (void)state;
    enum { M = 40, NX = 31, NY = 241 };
    double centre[M * 3], x[NX], y[NY], marginal[NX];
    double *joint = malloc(NX * NY * sizeof *joint);
    for (size_t k = 0; k < M * 3; k++) {
        centre[k] = haft_random_normal_quantile(test_uniform(k, 1));
    }
    grid(-3, 3, NX, x);
    grid(-7, 7, NY, y);
    for (int kind = 0; kind < 2; kind++) {
        haft_error error = {0};
        haft_chaos_kernels k = {M, centre, 3, 0.35, (haft_chaos_kernel)kind};
        check_ok(haft_chaos_joint_density(&k, 2, 1, NX, x, NY, y, joint, &error), error);
        haft_chaos_density(&k, 2, NX, x, marginal);
        for (size_t i = 0; i < NX; i++) {
            double sum = 0;
            for (size_t j = 0; j < NY; j++) {
                sum += joint[i * NY + j] * (y[1] - y[0]);
            }
            check_near(sum, marginal[i], 1e-12);
        }
    }
    free(joint);
}

/* Of m standard normals, the mean integrated square error of a kernel density is
 * (1 / (m h) + (1 - 1/m) / sqrt(1 + h^2) - 2 sqrt(2) / sqrt(2 + h^2) + 1) / (2 sqrt(pi));
 * Fryer (1976). */
static void the_error_of_normal_samples_is_what_theory_says(void **state) {
    (void)state;
    enum { TRIES = 150 };
    static const size_t ms[] = {30, 200};
    double centre[200], x[POINTS], p[POINTS];
    grid(-8, 8, POINTS, x);
    for (size_t i = 0; i < 2; i++) {
        double m = (double)ms[i], h = pow(m, -0.2), sum = 0, squares = 0;
        haft_chaos_kernels k = {ms[i], centre, 1, h, HAFT_CHAOS_KERNEL_SCOTT};
        for (uint64_t t = 0; t < TRIES; t++) {
            double error = 0;
            haft_random_normals((haft_random_key){3 + i, HAFT_RANDOM_TEST}, t, 0, 0, ms[i], centre);
            haft_chaos_density(&k, 0, POINTS, x, p);
            for (size_t j = 0; j < POINTS; j++) {
                error += pow(p[j] - normal(x[j], 1), 2) * (x[1] - x[0]);
            }
            sum += error;
            squares += error * error;
        }
        double mean = sum / TRIES, spread = sqrt((squares - sum * mean) / (TRIES - 1));
        double theory =
            (1 / (m * h) + (1 - 1 / m) / sqrt(1 + h * h) - 2 * sqrt(2 / (2 + h * h)) + 1) /
            (2 * sqrt(M_PI));
        check_near(mean, theory, 4 * spread / sqrt(TRIES));
        assert_true(spread / sqrt(TRIES) < 0.1 * theory); /* the check can fail */
    }
}

/* The density is the slope of the Rosenblatt map, which is computed otherwise. */
static void it_is_the_slope_of_the_rosenblatt_map(void **state) {
    (void)state;
    enum { M = 300 };
    haft_law_vector *v = skewed_vectors(M, 4, 0.1);
    haft_chaos_spec spec = {.f_limit = TEST_F_LIMIT, .components = 3, .order = 2};
    for (int kind = 0; kind < 2; kind++) {
        spec.kernel = (haft_chaos_kernel)kind;
        haft_chaos *c = make_model(M, v, &spec);
        haft_chaos_work *work = make_work(c);
        haft_chaos_parts p;
        haft_chaos_get_parts(c, &p);
        haft_chaos_kernels k = {p.m, p.centre, p.components, p.bandwidth, p.kernel};
        for (double x = -2.5; x < 2.6; x += 0.25) {
            double low[4], high[4], density, e = 1e-5;
            haft_chaos_rosenblatt(c, work, (double[]){x - e, 0, 0, 0}, low, NULL);
            haft_chaos_rosenblatt(c, work, (double[]){x + e, 0, 0, 0}, high, NULL);
            haft_chaos_density(&k, 0, 1, &x, &density);
            check_near((high[0] - low[0]) / (2 * e), density, 1e-8);
        }
        haft_chaos_work_destroy(&work);
        haft_chaos_destroy(&c);
    }
    free(v);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_kernels_are_a_sum_of_two_normals),
        cmocka_unit_test(preserving_kernels_preserve_the_variance),
        cmocka_unit_test(a_joint_density_holds_its_marginals),
        cmocka_unit_test(the_error_of_normal_samples_is_what_theory_says),
        cmocka_unit_test(it_is_the_slope_of_the_rosenblatt_map),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
