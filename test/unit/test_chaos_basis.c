/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Germs: polynomials orthonormal by rules that are not theirs, Gauss rules against GSL's, CDFs,
 * multi-indices, and projection of maps whose coefficients are known. */
#include "check.h"

#include <gsl/gsl_integration.h>

#include "haft/chaos.h"

static const haft_chaos_germ germs[] = {HAFT_CHAOS_GERM_LEGENDRE, HAFT_CHAOS_GERM_HERMITE,
                                        HAFT_CHAOS_GERM_JACOBI};
enum { GERMS = 3, ORDER = 20, RULE = 64 };

/* GSL's rule for the density of a germ, from the densities as one writes them down. */
static void gsl_rule(haft_chaos_germ germ, size_t n, double *x, double *w) {
    const gsl_integration_fixed_type *type = germ == HAFT_CHAOS_GERM_HERMITE
                                                 ? gsl_integration_fixed_hermite
                                                 : gsl_integration_fixed_legendre;
    double b = germ == HAFT_CHAOS_GERM_HERMITE ? 0.5 : 1;
    gsl_integration_fixed_workspace *rule = gsl_integration_fixed_alloc(type, n, 0, b, 0, 0);
    assert_non_null(rule);
    for (size_t k = 0; k < n; k++) {
        x[k] = gsl_integration_fixed_nodes(rule)[k];
        w[k] = gsl_integration_fixed_weights(rule)[k];
        if (germ == HAFT_CHAOS_GERM_HERMITE) {
            w[k] /= sqrt(2 * M_PI);
        } else if (germ == HAFT_CHAOS_GERM_JACOBI) {
            w[k] *= 6 * x[k] * (1 - x[k]);
        }
    }
    gsl_integration_fixed_free(rule);
}

static void polynomials_are_orthonormal(void **state) {
    (void)state;
    for (int g = 0; g < GERMS; g++) {
        double x[RULE], w[RULE], gram[ORDER + 1][ORDER + 1] = {{0}};
        gsl_rule(germs[g], RULE, x, w);
        for (int k = 0; k < RULE; k++) {
            double psi[ORDER + 1];
            haft_chaos_polynomials(germs[g], ORDER, x[k], psi);
            for (int a = 0; a <= ORDER; a++) {
                for (int b = 0; b <= ORDER; b++) {
                    gram[a][b] += w[k] * psi[a] * psi[b];
                }
            }
        }
        for (int a = 0; a <= ORDER; a++) {
            for (int b = 0; b <= ORDER; b++) {
                check_near(gram[a][b], a == b, 1e-12);
            }
        }
    }
}

/* Gauss rules integrate to degree 2 n - 1 exactly, and no rule of n points does more. */
static void gauss_rules_have_their_degree(void **state) {
    (void)state;
    haft_error error = {0};
    for (int g = 0; g < GERMS; g++) {
        for (size_t n = 1; n <= HAFT_CHAOS_POINTS_LIMIT; n = n < 16 ? n + 1 : 2 * n) {
            double x[HAFT_CHAOS_POINTS_LIMIT], w[HAFT_CHAOS_POINTS_LIMIT], sum = 0, top = 0;
            double psi[HAFT_CHAOS_POINTS_LIMIT + 1];
            check_ok(haft_chaos_gauss(germs[g], n, x, w, &error), error);
            for (size_t k = 0; k < n; k++) {
                assert_true(w[k] > 0 && (k == 0 || x[k] > x[k - 1]));
                haft_chaos_polynomials(germs[g], n, x[k], psi);
                sum += w[k];
                top += w[k] * psi[n - 1] * psi[n - 1]; /* degree 2 n - 2: 1 */
            }
            check_near(sum, 1, 1e-13);
            check_near(top, 1, 1e-12);
        }
    }
}

static void gauss_rules_agree_with_gsl(void **state) {
    (void)state;
    haft_error error = {0};
    for (int g = 0; g < 2; g++) { /* GSL has no rule for Beta(2,2) in this form */
        for (size_t n = 1; n <= 40; n += 3) {
            double x[40], w[40], gx[40], gw[40];
            check_ok(haft_chaos_gauss(germs[g], n, x, w, &error), error);
            gsl_rule(germs[g], n, gx, gw);
            for (size_t k = 0; k < n; k++) {
                check_near(x[k], gx[k], 1e-13 * (1 + fabs(gx[k])));
                check_near(w[k], gw[k], 1e-12);
            }
        }
    }
    double x[1], w[1];
    assert_int_equal(haft_chaos_gauss(HAFT_CHAOS_GERM_LEGENDRE, 0, x, w, &error),
                     HAFT_ERROR_ARGUMENT);
    assert_int_equal(
        haft_chaos_gauss(HAFT_CHAOS_GERM_LEGENDRE, HAFT_CHAOS_POINTS_LIMIT + 1, x, w, &error),
        HAFT_ERROR_ARGUMENT);
}

/* Quantile and CDF are each other's inverse in both tails; the CDF is the density's integral. */
static void germ_quantiles_invert_their_cdf(void **state) {
    (void)state;
    for (int g = 0; g < GERMS; g++) {
        for (double p = 1e-14; p < 1; p = p < 0.1 ? p * 3 : p + 0.03) {
            double x = haft_chaos_germ_quantile(germs[g], p), xi, tail;
            haft_chaos_germ_cdf(germs[g], x, &xi, &tail);
            check_near(xi, p, 1e-13 * p);
            check_near(xi + tail, 1, 1e-15);
        }
    }
    double x[RULE], w[RULE], xi, tail, sum = 0;
    gsl_rule(HAFT_CHAOS_GERM_LEGENDRE, RULE, x, w);
    for (int k = 0; k < RULE; k++) { /* of 6 x (1 - x) from 0 to 0.3 */
        double at = 0.3 * x[k];
        sum += 0.3 * w[k] * 6 * at * (1 - at);
    }
    haft_chaos_germ_cdf(HAFT_CHAOS_GERM_JACOBI, 0.3, &xi, &tail);
    check_near(xi, sum, 1e-14);
}

static void indices_are_all_of_total_order(void **state) {
    (void)state;
    for (size_t d = 1; d <= 4; d++) {
        for (size_t order = 0; order <= 7; order++) {
            size_t terms = haft_chaos_terms(d, order), expected = 1;
            for (size_t i = 0; i < d; i++) { /* (order + d)! / (order! d!) */
                expected = expected * (order + d - i);
            }
            expected /= d == 1 ? 1 : d == 2 ? 2 : d == 3 ? 6 : 24;
            assert_int_equal(terms, expected);
            unsigned *index = malloc(terms * d * sizeof *index);
            haft_chaos_indices(d, order, index);
            size_t before = 0;
            for (size_t t = 0; t < terms; t++) {
                size_t sum = 0, code = 0;
                for (size_t i = 0; i < d; i++) {
                    sum += index[t * d + i];
                    code = code * (order + 1) + index[t * d + i];
                }
                assert_true(sum <= order && (t == 0 ? code == 0 : code > before));
                before = code;
            }
            free(index);
        }
    }
}

/* Values of a sum of products with coefficients c at the tensor points. */
static void fill_map(haft_chaos_germ germ, size_t d, size_t order, size_t n, const double *c,
                     double *value) {
    haft_error error = {0};
    double x[HAFT_CHAOS_POINTS_LIMIT], w[HAFT_CHAOS_POINTS_LIMIT];
    check_ok(haft_chaos_gauss(germ, n, x, w, &error), error);
    size_t size = 1, terms = haft_chaos_terms(d, order);
    unsigned *index = malloc(terms * d * sizeof *index);
    haft_chaos_indices(d, order, index);
    for (size_t i = 0; i < d; i++) {
        size *= n;
    }
    for (size_t k = 0; k < size; k++) {
        double psi[4][HAFT_CHAOS_ORDER_LIMIT + 1];
        size_t rest = k;
        for (size_t i = d; i-- > 0; rest /= n) {
            haft_chaos_polynomials(germ, order, x[rest % n], psi[i]);
        }
        value[k] = 0;
        for (size_t t = 0; t < terms; t++) {
            double product = c[t];
            for (size_t i = 0; i < d; i++) {
                product *= psi[i][index[t * d + i]];
            }
            value[k] += product;
        }
    }
    free(index);
}

static void projection_recovers_a_polynomial_map(void **state) {
    (void)state;
    haft_error error = {0};
    for (int g = 0; g < GERMS; g++) {
        for (size_t d = 1; d <= 4; d++) {
            size_t order = d < 4 ? 6 : 4, n = order + (d % 2) + 1, size = 1;
            size_t terms = haft_chaos_terms(d, order);
            for (size_t i = 0; i < d; i++) {
                size *= n;
            }
            double *c = malloc(terms * sizeof *c), *found = malloc(2 * terms * sizeof *found);
            double *value = malloc(size * sizeof *value);
            for (size_t t = 0; t < terms; t++) {
                c[t] = sin(1.7 * (double)t + (double)d);
            }
            fill_map(germs[g], d, order, n, c, value);
            check_ok(haft_chaos_project(germs[g], d, order, n, value, found, 2, &error), error);
            for (size_t t = 0; t < terms; t++) {
                check_near(found[2 * t], c[t], 1e-12);
            }
            free(c);
            free(found);
            free(value);
        }
    }
}

/* x^3 in each germ, by hand. */
static void projection_gives_textbook_coefficients(void **state) {
    (void)state;
    static const double expected[GERMS][4] = {{1. / 4, 3 * 0.086602540378443864676,
                                               1 / (4 * 2.2360679774997896964),
                                               1 / (20 * 2.6457513110645905905)},
                                              {0, 3, 0, 2.4494897427831780982},
                                              {1. / 5, 0, 0, 0}};
    haft_error error = {0};
    for (int g = 0; g < GERMS; g++) {
        double x[5], w[5], value[5], c[5];
        check_ok(haft_chaos_gauss(germs[g], 5, x, w, &error), error);
        for (int k = 0; k < 5; k++) {
            value[k] = x[k] * x[k] * x[k];
        }
        check_ok(haft_chaos_project(germs[g], 1, 4, 5, value, c, 1, &error), error);
        for (int a = 0; a < (g == 2 ? 1 : 4); a++) {
            check_near(c[a], expected[g][a], 1e-14);
        }
        check_near(c[4], 0, 1e-14);
    }
    double value[1] = {0}, c[4];
    assert_int_equal(haft_chaos_project(germs[0], 1, 2, 2, value, c, 1, &error),
                     HAFT_ERROR_ARGUMENT);
    assert_int_equal(haft_chaos_project(germs[0], 5, 0, 1, value, c, 1, &error),
                     HAFT_ERROR_ARGUMENT);
    assert_int_equal(haft_chaos_project(germs[0], 0, 0, 1, value, c, 1, &error),
                     HAFT_ERROR_ARGUMENT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(polynomials_are_orthonormal),
        cmocka_unit_test(gauss_rules_have_their_degree),
        cmocka_unit_test(gauss_rules_agree_with_gsl),
        cmocka_unit_test(germ_quantiles_invert_their_cdf),
        cmocka_unit_test(indices_are_all_of_total_order),
        cmocka_unit_test(projection_recovers_a_polynomial_map),
        cmocka_unit_test(projection_gives_textbook_coefficients),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
