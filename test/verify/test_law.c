/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Orders of convergence of tables and of characteristic numbers, observed against theory. */
#include "check.h"

#include <gsl/gsl_integration.h>

#include "haft/law.h"

static haft_law typical(void) {
    haft_law law;
    haft_law_vector v = {.e = 2.1e-3, .f_max = 4e5, .d_max = 1.1e-8, .d_limit = 7.5e-9};
    assert_int_equal(haft_law_morse(&law, &v, 5e6), HAFT_LAW_SOUND);
    return law;
}

/* An even grid of n intervals over [low, high]. */
static void sample(const haft_law *law, double low, double high, size_t n, double *x, double *f) {
    for (size_t i = 0; i <= n; i++) {
        x[i] = low + (high - low) * (double)i / (double)n;
        f[i] = haft_law_evaluate(law, x[i]).force;
    }
}

enum { MOST = 1 << 14 };

typedef struct table_misses {
    double tail, all, potential;
} table_misses;

/* Where a table of this step is compared: all over it, and closely about its extremum. */
static double place(const haft_law *law, double low, double step, int i) {
    enum { ALL = 8000, ABOUT = 400 };
    return i <= ALL ? low + (5e-8 - low) * i / ALL
                    : law->d_max + 2 * step * ((i - ALL) * 2.0 / ABOUT - 1);
}

/* The largest misfits of a table of n intervals, averaged over 16 positions of its grid. */
static table_misses table_error(const haft_law *law, size_t n) {
    double *x = malloc((MOST + 1) * sizeof *x), *f = malloc((MOST + 1) * sizeof *f);
    table_misses mean = {0};
    for (int k = 0; k < 16; k++) {
        double low = 7.52e-9 + 1.2e-7 / (double)n * k / 16, high = low + 1.2e-7;
        sample(law, low, high, n, x, f);
        haft_error error = {0};
        haft_law_table *table = NULL;
        check_ok(haft_law_table_create(&table, n + 1, x, f, &error), error);
        haft_law copy = haft_law_from_table(table);
        table_misses worst = {0};
        for (int i = 0; i <= 8400; i++) {
            double d = place(law, low, 1.2e-7 / (double)n, i);
            haft_law_value a = haft_law_evaluate(&copy, d), b = haft_law_evaluate(law, d);
            double miss = fabs(a.force - b.force) / law->f_max;
            worst.all = fmax(worst.all, miss);
            worst.tail = d > 1.4e-8 ? fmax(worst.tail, miss) : worst.tail;
            worst.potential = fmax(worst.potential, fabs(a.potential - b.potential) / 2.1e-3);
        }
        mean.tail += worst.tail / 16;
        mean.all += worst.all / 16;
        mean.potential += worst.potential / 16;
        haft_law_table_destroy(&table);
    }
    free(x);
    free(f);
    return mean;
}

/* Fourth order where the law is monotone, second about the extremum (and there the potential third,
 * the misfit being confined to a step or two). */
static void tables_converge_at_the_order_of_theory(void **state) {
    (void)state;
    haft_law law = typical();
    double tail = 0, all = 0, potential = 0;
    table_misses coarse = table_error(&law, 512);
    for (size_t n = 1024; n <= MOST; n *= 2) {
        table_misses fine = table_error(&law, n);
        tail = log2(coarse.tail / fine.tail);
        all = log2(coarse.all / fine.all);
        potential = log2(coarse.potential / fine.potential);
        print_message("n %5zu: tail %.2e (%.2f)  all %.2e (%.2f)  potential %.2e (%.2f)\n", n,
                      fine.tail, tail, fine.all, all, fine.potential, potential);
        coarse = fine;
    }
    check_near(tail, 4, 0.15);
    check_near(all, 2, 0.25);
    assert_true(potential > 2.7);
}

/* Where the left wing begins to pull, E = 2, its slope is 4 a f_max. */
static void a_tables_range_is_that_of_its_law(void **state) {
    (void)state;
    haft_law law = typical();
    double *x = malloc((MOST + 1) * sizeof *x), *f = malloc((MOST + 1) * sizeof *f);
    sample(&law, 7.4e-9, 1.2e-7, MOST, x, f);
    haft_error error = {0};
    haft_law_table *table = NULL;
    check_ok(haft_law_table_create(&table, MOST + 1, x, f, &error), error);
    haft_law copy = haft_law_from_table(table);
    /* The piece that crosses zero is left out: a step's change of the slope. */
    check_relative(haft_law_range(&copy), haft_law_range(&law), 3 * law.a_left * (x[1] - x[0]));
    for (double share = 0.01; share < 1; share *= 2) {
        check_near(haft_law_reach(&copy, share), haft_law_reach(&law, share), 1e-13);
    }
    haft_law_table_destroy(&table);
    free(x);
    free(f);
}

static double force_of(double d, void *law) {
    return haft_law_evaluate(law, d * 1e-9).force;
}

static void a_tables_potential_is_its_forces_integral(void **state) {
    (void)state;
    haft_law law = typical();
    double x[61], f[61];
    sample(&law, 7.3e-9, 6e-8, 60, x, f);
    haft_error error = {0};
    haft_law_table *table = NULL;
    check_ok(haft_law_table_create(&table, 61, x, f, &error), error);
    haft_law copy = haft_law_from_table(table);
    gsl_integration_workspace *w = gsl_integration_workspace_alloc(1000);
    gsl_function force = {force_of, &copy};
    for (int k = 0; k < 40; k++) {
        double d = 7.05e-9 + 1.3e-9 * k, sum = 0;
        for (int i = -1; i < 60; i++) { /* a smooth integrand in each piece */
            double low = fmax(d, i < 0 ? -1 : x[i]), high = x[i + 1], value, miss;
            if (low < high) {
                gsl_integration_qag(&force, low * 1e9, high * 1e9, 0, 1e-11, 1000,
                                    GSL_INTEG_GAUSS21, w, &value, &miss);
                sum += value * 1e-9;
            }
        }
        check_near(haft_law_evaluate(&copy, d).potential, sum, 1e-12 * 2.1e-3);
    }
    gsl_integration_workspace_free(w);
    haft_law_table_destroy(&table);
}

typedef struct misses {
    double e, f_max, d_max, d_limit;
} misses;

/* Root mean square misses over 32 positions of a grid of n intervals against the law. */
static misses characterise_error(const haft_law *law, double f_limit, size_t n) {
    double *x = malloc((MOST + 1) * sizeof *x), *f = malloc((MOST + 1) * sizeof *f);
    haft_law_vector v = haft_law_morse_vector(law), got;
    v.d_limit = v.d_max - log(1 + sqrt(1 + f_limit / v.f_max)) / law->a_left;
    misses m = {0};
    for (int k = 0; k < 32; k++) {
        double step = 1.2e-7 / (double)n, low = 7.2e-9 - step * k / 32;
        sample(law, low, low + 1.2e-7, n, x, f);
        assert_int_equal(haft_law_characterise(n + 1, x, f, f_limit, &got), HAFT_LAW_SOUND);
        m.e += pow(got.e / v.e - 1, 2) / 32;
        m.f_max += pow(got.f_max / v.f_max - 1, 2) / 32;
        m.d_max += pow((got.d_max - v.d_max) * law->a_left, 2) / 32;
        m.d_limit += pow((got.d_limit - v.d_limit) * law->a_left, 2) / 32;
    }
    free(x);
    free(f);
    return (misses){sqrt(m.e), sqrt(m.f_max), sqrt(m.d_max), sqrt(m.d_limit)};
}

/* The second derivative of a Morse law jumps at d_max: the parabola across the jump puts d_max off
 * by O(h) and f_max by O(h^2); d_limit lies where the interpolant is fourth order; the energy's
 * O(h^2) misfit is confined to O(h) about d_max, so at least third order too. */
static void characteristic_numbers_converge(void **state) {
    (void)state;
    haft_law law = typical();
    double order[4] = {0};
    misses last = {0};
    for (size_t n = 512; n < MOST; n *= 2) {
        misses a = characterise_error(&law, 4e6, n);
        last = characterise_error(&law, 4e6, 2 * n);
        order[0] = log2(a.e / last.e);
        order[1] = log2(a.f_max / last.f_max);
        order[2] = log2(a.d_max / last.d_max);
        order[3] = log2(a.d_limit / last.d_limit);
        print_message("n %5zu: e %.1e (%.2f)  f_max %.1e (%.2f)  d_max %.1e (%.2f)  d_limit %.1e "
                      "(%.2f)\n",
                      2 * n, last.e, order[0], last.f_max, order[1], last.d_max, order[2],
                      last.d_limit, order[3]);
    }
    assert_true(order[0] > 2.9);
    check_near(order[1], 2, 0.15);
    check_near(order[2], 1, 0.15);
    check_near(order[3], 4, 0.15);
    check_less(last.e, 1e-8);
    check_less(last.d_limit, 1e-8);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tables_converge_at_the_order_of_theory),
        cmocka_unit_test(a_tables_range_is_that_of_its_law),
        cmocka_unit_test(a_tables_potential_is_its_forces_integral),
        cmocka_unit_test(characteristic_numbers_converge),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
