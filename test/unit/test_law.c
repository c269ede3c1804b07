/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Morse and table laws: closed forms against independent expressions, ends, kinks and refusals. */
#include "law_kinks.h"

#include <complex.h>
#include <float.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_integration.h>
#include <gsl/gsl_roots.h>

#include "haft/law.h"

static double uniform(uint64_t k, uint64_t j, double low, double high) {
    uint64_t words[4];
    haft_random_words((haft_random_key){7, HAFT_RANDOM_TEST}, k, j, 0, words);
    return low + (high - low) * haft_random_uniform(words[0]);
}

/* A vector anywhere in a range far wider than any surface gives, and its limit push. */
static haft_law_vector draw(uint64_t k, double *f_limit) {
    haft_law_vector v = {.f_max = pow(10, uniform(k, 0, 1, 8)),
                         .d_max = uniform(k, 1, -1e-8, 3e-8)};
    double width = pow(10, uniform(k, 2, -11, -7));
    v.d_limit = v.d_max - width;
    *f_limit = v.f_max * pow(10, uniform(k, 3, -2, 3));
    double left = log(1 + sqrt(1 + *f_limit / v.f_max)) / width;
    v.e = v.f_max / (2 * left) * (1 + pow(10, uniform(k, 4, -3, 3)));
    return v;
}

static void morse_gives_its_vector_back(void **state) {
    (void)state;
    for (uint64_t k = 0; k < 2000; k++) {
        double f_limit;
        haft_law_vector v = draw(k, &f_limit), back;
        haft_law law;
        assert_int_equal(haft_law_morse(&law, &v, f_limit), HAFT_LAW_SOUND);
        back = haft_law_morse_vector(&law);
        check_relative(back.e, v.e, 1e-12);
        check_relative(back.f_max, v.f_max, 1e-12);
        check_relative(back.d_max, v.d_max, 1e-12);
        check_relative(back.d_limit, v.d_limit, 1e-12);
    }
}

typedef struct probe {
    const haft_law *law;
    double origin, length, level;
} probe;

static double force_above_level(double x, void *parameters) {
    const probe *p = parameters;
    return haft_law_evaluate(p->law, p->origin + p->length * x).force / p->law->f_max - p->level;
}

static double pull_at(double x, void *parameters) {
    return -force_above_level(x, parameters);
}

static double find_root(probe *p, double low, double high) {
    gsl_root_fsolver *solver = gsl_root_fsolver_alloc(gsl_root_fsolver_brent);
    gsl_function f = {force_above_level, p};
    gsl_root_fsolver_set(solver, &f, low, high);
    for (int i = 0; i < 200; i++) {
        gsl_root_fsolver_iterate(solver);
        if (gsl_root_test_interval(gsl_root_fsolver_x_lower(solver),
                                   gsl_root_fsolver_x_upper(solver), 0, 1e-15) == GSL_SUCCESS) {
            break;
        }
    }
    double root = gsl_root_fsolver_root(solver);
    gsl_root_fsolver_free(solver);
    return root;
}

static double integrate(gsl_function *f, double low, double high) {
    gsl_integration_workspace *w = gsl_integration_workspace_alloc(1000);
    double value = 0, miss = 0;
    gsl_integration_qag(f, low, high, 0, 1e-13, 1000, GSL_INTEG_GAUSS61, w, &value, &miss);
    gsl_integration_workspace_free(w);
    return value;
}

/* The numbers measured on the law itself: energy by quadrature, limit by root finding. */
static void morse_has_the_energy_and_limit_it_was_given(void **state) {
    (void)state;
    gsl_error_handler_t *old = gsl_set_error_handler_off();
    for (uint64_t k = 0; k < 300; k++) {
        double f_limit;
        haft_law_vector v = draw(k, &f_limit);
        haft_law law;
        assert_int_equal(haft_law_morse(&law, &v, f_limit), HAFT_LAW_SOUND);
        double width = v.d_max - v.d_limit, noise = 8 * DBL_EPSILON * fabs(v.d_max) / width;
        probe p = {&law, v.d_max, width, f_limit / v.f_max};
        check_near(find_root(&p, -1.5, 0), -1, 1e-12 + noise);
        p.level = 0;
        gsl_function pull = {pull_at, &p};
        double e = integrate(&pull, find_root(&p, -1, 0), 0) * width;
        p.length = 1 / law.a_right;
        for (int i = 0; i < 40; i += 4) {
            e += integrate(&pull, i, i + 4) / law.a_right;
        }
        check_relative(e * v.f_max, v.e, 1e-12 + 8 * noise);
    }
    gsl_set_error_handler(old);
}

/* The law written once more, plainly, for complex gaps: f'(d) = Im f(d + i s) / s to round-off. */
static double complex plain_force(const haft_law *law, bool right, double complex d) {
    double a = right ? law->a_right : law->a_left;
    return law->f_max * (cexp(-2 * a * (d - law->d_max)) - 2 * cexp(-a * (d - law->d_max)));
}

static double complex plain_slope(const haft_law *law, bool right, double complex d) {
    double a = right ? law->a_right : law->a_left;
    return law->f_max *
           (-2 * a * cexp(-2 * a * (d - law->d_max)) + 2 * a * cexp(-a * (d - law->d_max)));
}

static double complex plain_potential(const haft_law *law, bool right, double complex d) {
    double a = right ? law->a_right : law->a_left;
    double complex wing =
        law->f_max * (cexp(-2 * a * (d - law->d_max)) - 4 * cexp(-a * (d - law->d_max))) / (2 * a);
    return right ? wing : wing + 1.5 * law->f_max * (1 / law->a_left - 1 / law->a_right);
}

static void check_wing(const haft_law *law, bool right, double d) {
    double a = right ? law->a_right : law->a_left, s = 1e-30 / a;
    double size = cabs(plain_force(law, right, d)) + law->f_max * exp(-a * (d - law->d_max));
    haft_law_value value = haft_law_evaluate(law, d);
    double tolerance = 1e-12;
    check_near(value.force, creal(plain_force(law, right, d)), tolerance * size);
    check_near(value.force, -cimag(plain_potential(law, right, d + I * s)) / s, tolerance * size);
    check_near(value.slope, cimag(plain_force(law, right, d + I * s)) / s, tolerance * size * a);
    check_near(value.curvature, cimag(plain_slope(law, right, d + I * s)) / s,
               3 * tolerance * size * a * a);
    check_near(value.potential, creal(plain_potential(law, right, d)),
               tolerance * (size / a + law->f_max * (1 / law->a_left + 1 / law->a_right)));
}

static void morse_derivatives_agree_with_a_complex_step(void **state) {
    (void)state;
    for (uint64_t k = 0; k < 300; k++) {
        double f_limit;
        haft_law_vector v = draw(k, &f_limit);
        v.d_max -= v.d_limit, v.d_limit = 0; /* keeps d - d_max free of cancellation */
        haft_law law;
        assert_int_equal(haft_law_morse(&law, &v, f_limit), HAFT_LAW_SOUND);
        for (uint64_t j = 10; j < 20; j++) {
            check_wing(&law, true, v.d_max + uniform(k, j, 0, 10) / law.a_right);
            check_wing(&law, false, uniform(k, j, 0, 1) * v.d_max);
        }
        check_wing(&law, true, v.d_max);
        check_wing(&law, false, nextafter(v.d_max, 0));
        check_wing(&law, false, 0);
    }
}

static void morse_is_smooth_at_its_kinks(void **state) {
    (void)state;
    haft_law law = typical();
    double length = 1 / fmax(law.a_left, law.a_right);
    check_continuous(&law, law.d_max, length, 1e-11);
    check_continuous(&law, law.wall_distance, length, 1e-11);
    haft_law_value bottom = haft_law_evaluate(&law, law.d_max);
    assert_true(bottom.force == -law.f_max && bottom.slope == 0);
    haft_law_value above = haft_law_evaluate(&law, law.wall_distance);
    haft_law_value below = haft_law_evaluate(&law, law.wall_distance - 1e-15);
    assert_true(above.curvature > 0 && below.curvature == 0);
    /* The potential is least, and equals -e, where the force vanishes. */
    double zero = law.d_max - log(2) / law.a_left;
    check_relative(haft_law_evaluate(&law, zero).potential, -haft_law_morse_vector(&law).e, 1e-14);
    check_near(haft_law_evaluate(&law, zero).force, 0, 1e-9 * law.f_max);
}

static void the_wall_is_linear_and_nothing_overflows(void **state) {
    (void)state;
    haft_law law = typical();
    haft_law_value at = haft_law_evaluate(&law, law.wall_distance);
    for (double x = 1e-12; x < 1e101; x *= 10) {
        haft_law_value deep = haft_law_evaluate(&law, law.wall_distance - x);
        haft_law_value far = haft_law_evaluate(&law, law.d_max + x);
        double depth = law.wall_distance - (law.wall_distance - x);
        check_relative(deep.force, at.force - at.slope * depth, 1e-12);
        check_relative(deep.slope, at.slope, 1e-12);
        check_relative(deep.potential,
                       at.potential + at.force * depth - at.slope * depth * depth / 2, 1e-12);
        assert_true(far.force <= 0 && far.slope >= 0 && far.potential <= 0);
        assert_true(isfinite(far.force) && isfinite(far.slope) && isfinite(far.curvature));
    }
    haft_law_value free = haft_law_evaluate(&law, 1e-4);
    assert_true(free.force == 0 && free.slope == 0 && free.curvature == 0 && free.potential == 0);
}

static void the_bound_is_sharp(void **state) {
    (void)state;
    for (uint64_t k = 0; k < 200; k++) {
        double f_limit;
        haft_law_vector v = draw(k, &f_limit);
        double left = log1p(sqrt(1 + f_limit / v.f_max)) / (v.d_max - v.d_limit);
        haft_law law = {.f_max = -1};
        v.e = v.f_max / (2 * left);
        assert_int_equal(haft_law_morse(&law, &v, f_limit), HAFT_LAW_BOUND);
        v.e = v.f_max / (2 * left) * (1 - 1e-12);
        assert_int_equal(haft_law_morse(&law, &v, f_limit), HAFT_LAW_BOUND);
        assert_true(law.f_max == -1);
        v.e = v.f_max / (2 * left) * (1 + 1e-12);
        assert_int_equal(haft_law_morse(&law, &v, f_limit), HAFT_LAW_SOUND);
        check_relative(haft_law_morse_vector(&law).e, v.e, 1e-12);
        assert_true(isfinite(haft_law_evaluate(&law, v.d_max + 1e-9).force));
    }
}

static void morse_refuses_what_is_no_vector(void **state) {
    (void)state;
    const haft_law_vector good = {.e = 2e-3, .f_max = 4e5, .d_max = 1.1e-8, .d_limit = 7.5e-9};
    haft_law law;
    static const double bad[] = {0, -1, NAN, INFINITY};
    for (int i = 0; i < 4; i++) {
        haft_law_vector v = good;
        v.e = bad[i];
        assert_int_equal(haft_law_morse(&law, &v, 5e6), HAFT_LAW_INVALID);
        v = good;
        v.f_max = bad[i];
        assert_int_equal(haft_law_morse(&law, &v, 5e6), HAFT_LAW_INVALID);
        assert_int_equal(haft_law_morse(&law, &good, bad[i]),
                         bad[i] == -1 ? HAFT_LAW_SOUND : HAFT_LAW_INVALID);
    }
    haft_law_vector v = good;
    v.d_limit = v.d_max;
    assert_int_equal(haft_law_morse(&law, &v, 5e6), HAFT_LAW_INVALID);
    v.d_limit = -INFINITY;
    assert_int_equal(haft_law_morse(&law, &v, 5e6), HAFT_LAW_INVALID);
    assert_int_equal(haft_law_morse(&law, &good, 5e6), HAFT_LAW_SOUND);
}

static void a_limit_may_be_a_share_of_the_pull(void **state) {
    (void)state;
    const haft_law_vector v = {.e = 2e-6, .f_max = 2.5e3, .d_max = 1.5e-8, .d_limit = 1.47e-8};
    haft_law by_share, by_push;
    assert_int_equal(haft_law_morse(&by_share, &v, haft_law_share(0.2)), HAFT_LAW_SOUND);
    assert_int_equal(haft_law_morse(&by_push, &v, 500), HAFT_LAW_SOUND);
    check_relative(by_share.a_left, by_push.a_left, 1e-14);
    check_relative(by_share.a_right, by_push.a_right, 1e-14);
    check_relative(by_share.wall_force, 500.0, 1e-14);
    check_relative(haft_law_evaluate(&by_share, v.d_limit).force, 500.0, 1e-12);
    check_relative(haft_law_limit(haft_law_share(0.2), v.f_max), 500.0, 1e-15);
    assert_true(haft_law_limit(5e6, v.f_max) == 5e6);
    /* Read off its own curve it is the same law; a share that the curve does not reach is told. */
    enum { N = 4001 };
    static double d[N], f[N];
    for (int i = 0; i < N; i++) {
        d[i] = 1.46e-8 + 2e-12 * i;
        f[i] = haft_law_evaluate(&by_share, d[i]).force;
    }
    haft_law_vector found;
    assert_int_equal(haft_law_characterise(N, d, f, haft_law_share(0.2), &found), HAFT_LAW_SOUND);
    check_near(found.d_limit, v.d_limit, 1e-14);
    check_relative(found.e, v.e, 1e-4);
    assert_int_equal(haft_law_characterise(N, d, f, haft_law_share(1e3), &found),
                     HAFT_LAW_RANGE_LEFT);
}

static void misfit_is_the_energy_out_of_place(void **state) {
    (void)state;
    enum { N = 2001 };
    static double d[N], f[N], moved[N];
    const haft_law_vector v = {.e = 2e-3, .f_max = 4e5, .d_max = 1.1e-8, .d_limit = 7.5e-9};
    haft_law law;
    assert_int_equal(haft_law_morse(&law, &v, 5e6), HAFT_LAW_SOUND);
    for (int i = 0; i < N; i++) {
        d[i] = 7e-9 + 4e-11 * i;
        f[i] = haft_law_evaluate(&law, d[i]).force;
        moved[i] = f[i] - (i >= 500 && i < 600 ? 1e4 : 0); /* a flat second well of 40 uJ/m2 */
    }
    check_near(haft_law_misfit(&law, N, d, f), 0, 1e-15);
    check_relative(haft_law_misfit(&law, N, d, moved), 4e-5 / (v.e + 4e-5), 1e-3);
    memset(moved, 0, sizeof moved);
    assert_true(!isfinite(haft_law_misfit(&law, N, d, moved)));
}

/* Of one well it is the vector's e; of two, which have no vector, the sum, by either one's own. */
static void energy_is_that_of_all_wells(void **state) {
    (void)state;
    enum { N = 801 };
    double d[N], near[N], far[N], both[N];
    for (size_t i = 0; i < N; i++) {
        d[i] = 0.05 * (double)i;
        double a = (d[i] - 8) / 3, b = (d[i] - 25) / 2;
        near[i] = i == 0 ? 5 : fabs(a) < 1 ? -4 * (1 - a * a) * (1 - a * a) : 0;
        far[i] = fabs(b) < 1 ? -(1 - b * b) * (1 - b * b) : 0;
        both[i] = near[i] + far[i];
    }
    /* int (1 - x^2)^2 = 16/15 */
    check_relative(haft_law_energy(N, d, near), 4 * 3 * 16.0 / 15, 1e-4);
    check_relative(haft_law_energy(N, d, far), 2 * 16.0 / 15, 1e-4);
    check_relative(haft_law_energy(N, d, both),
                   haft_law_energy(N, d, near) + haft_law_energy(N, d, far), 1e-12);
    haft_law_vector v;
    assert_int_equal(haft_law_characterise(N, d, both, 3, &v), HAFT_LAW_TWO_WELLS);
    assert_int_equal(haft_law_characterise(N, d, near, 3, &v), HAFT_LAW_SOUND);
    assert_true(v.e == haft_law_energy(N, d, near));
}

static void reach_inverts_the_pull(void **state) {
    (void)state;
    haft_law law = typical();
    for (double share = 1e-12; share < 1; share *= 3) {
        double d = haft_law_reach(&law, share);
        assert_true(d > law.d_max);
        check_relative(haft_law_evaluate(&law, d).force, -share * law.f_max, 1e-11);
    }
    assert_true(isnan(haft_law_reach(&law, 0)) && isnan(haft_law_reach(&law, 1)));
    check_relative(haft_law_range(&law), fmin(1 / law.a_left, 1 / law.a_right), 1e-15);
}

static haft_law_fault fault_of(size_t n, const double *f, double f_limit) {
    double x[16];
    for (size_t i = 0; i < n; i++) {
        x[i] = 5 + 0.5 * (double)i;
    }
    haft_law_vector v = {.e = -7};
    haft_law_fault fault = haft_law_characterise(n, x, f, f_limit, &v);
    assert_true((fault == HAFT_LAW_SOUND) == (v.e > 0));
    return fault;
}

static void each_fault_is_told_apart(void **state) {
    (void)state;
    const double sound[] = {40, 10, -20, -60, -100, -70, -30, -4, 0};
    assert_int_equal(fault_of(9, sound, 30), HAFT_LAW_SOUND);
    assert_int_equal(fault_of(9, sound, 40), HAFT_LAW_SOUND);
    assert_int_equal(fault_of(9, sound, 40.1), HAFT_LAW_RANGE_LEFT);
    assert_int_equal(fault_of(8, sound, 30), HAFT_LAW_SOUND);
    assert_int_equal(fault_of(7, sound, 30), HAFT_LAW_RANGE_RIGHT);
    assert_int_equal(fault_of(5, sound, 30), HAFT_LAW_RANGE_RIGHT);
    assert_int_equal(fault_of(3, sound, 30), HAFT_LAW_INVALID);
    assert_int_equal(fault_of(9, sound, 0), HAFT_LAW_INVALID);
    assert_int_equal(fault_of(9, sound, NAN), HAFT_LAW_INVALID);
    const double push[] = {40, 10, 2, 0, 0, 0};
    assert_int_equal(fault_of(6, push, 30), HAFT_LAW_NO_ATTRACTION);
    const double left[] = {-100, -60, -20, -2, 0};
    assert_int_equal(fault_of(5, left, 30), HAFT_LAW_RANGE_LEFT);
    const double unknown[] = {40, 10, NAN, -60, -100, -70, 0};
    assert_int_equal(fault_of(7, unknown, 30), HAFT_LAW_INVALID);
    /* Barriers of 4 and 6 % of the greatest pull, on either side of it; noise in the push. */
    const double shallow[] = {40, 50, 10, -46, -42, -100, -66, -70, -30, 0};
    assert_int_equal(fault_of(10, shallow, 30), HAFT_LAW_SOUND);
    const double right[] = {40, 10, -46, -42, -100, -64, -70, -30, 0};
    assert_int_equal(fault_of(9, right, 30), HAFT_LAW_TWO_WELLS);
    const double near[] = {40, 10, -46, -40, -100, -66, -70, -30, 0};
    assert_int_equal(fault_of(9, near, 30), HAFT_LAW_TWO_WELLS);
    const double apart[] = {40, -30, 10, -46, -100, -66, 0};
    assert_int_equal(fault_of(7, apart, 30), HAFT_LAW_TWO_WELLS);
    double uneven_x[] = {1, 2, 3, 4.1, 5}, uneven_f[] = {9, -1, -2, -1, 0};
    haft_law_vector v;
    assert_int_equal(haft_law_characterise(5, uneven_x, uneven_f, 5, &v), HAFT_LAW_INVALID);
    for (int a = 0; a < HAFT_LAW_FAULTS; a++) {
        for (int b = 0; b < a; b++) {
            assert_string_not_equal(haft_law_fault_name(a), haft_law_fault_name(b));
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(morse_gives_its_vector_back),
        cmocka_unit_test(morse_has_the_energy_and_limit_it_was_given),
        cmocka_unit_test(morse_derivatives_agree_with_a_complex_step),
        cmocka_unit_test(morse_is_smooth_at_its_kinks),
        cmocka_unit_test(the_wall_is_linear_and_nothing_overflows),
        cmocka_unit_test(the_bound_is_sharp),
        cmocka_unit_test(morse_refuses_what_is_no_vector),
        cmocka_unit_test(a_limit_may_be_a_share_of_the_pull),
        cmocka_unit_test(misfit_is_the_energy_out_of_place),
        cmocka_unit_test(energy_is_that_of_all_wells),
        cmocka_unit_test(reach_inverts_the_pull),
        cmocka_unit_test(each_fault_is_told_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
