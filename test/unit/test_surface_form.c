/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The two forms of a self-affine PSD: the autocorrelation against quadrature and closed forms, from
 * either form to the other and back, what has no other form, and the length of maps generated. */
#include "check.h"

#include "haft/surface_map.h"

#include <gsl/gsl_integration.h>
#include <gsl/gsl_sf_bessel.h>

typedef struct transform {
    const haft_psd *psd;
    double r;
} transform;

static double integrand(double zeta, void *user) {
    const transform *t = user;
    return haft_psd_value(t->psd, zeta) * zeta * gsl_sf_bessel_J0(zeta * t->r);
}

/* 2 pi int s zeta J0(zeta r) dzeta over the plateau and the power law by GSL. */
static double by_quadrature(const haft_psd *psd, double r) {
    gsl_integration_workspace *work = gsl_integration_workspace_alloc(4000);
    transform t = {psd, r};
    gsl_function f = {integrand, &t};
    double low, high, error, close = 1e-13 * haft_psd_get_moments(psd).m0;
    assert_int_equal(gsl_integration_qag(&f, 0, psd->zeta_0, close, 0, 4000, 6, work, &low, &error),
                     0);
    assert_int_equal(
        gsl_integration_qag(&f, psd->zeta_0, psd->zeta_max, close, 0, 4000, 6, work, &high, &error),
        0);
    gsl_integration_workspace_free(work);
    return 2 * M_PI * (low + high);
}

static void the_autocorrelation_is_the_hankel_transform(void **state) {
    (void)state;
    static const haft_psd psds[] = {{289e6, 19.4e6, 6.46e-33, 6.46e-39},
                                    {289e6, 2e6, 6.46e-33, 6.46e-40},
                                    {100e6, 30e6, 1e-33, 1e-33},
                                    {1000e6, 5e6, 1e-33, 1e-38}};
    for (size_t k = 0; k < sizeof psds / sizeof *psds; k++) {
        double m0 = haft_psd_get_moments(&psds[k]).m0;
        assert_true(haft_psd_correlation(&psds[k], 0) == 1);
        for (double r = 1e-10; r < 30e-6; r *= 2.3) {
            check_near(haft_psd_correlation(&psds[k], r), by_quadrature(&psds[k], r) / m0, 3e-12);
        }
    }
    /* a disc of wave vectors, s_1 = s_0: 2 J1(x)/x */
    for (double r = 1e-9; r < 1e-5; r *= 1.7) {
        double x = 100e6 * r;
        check_near(haft_psd_correlation(&psds[2], r), 2 * gsl_sf_bessel_J1(x) / x, 1e-13);
    }
    /* by points, those of the same PSD */
    haft_psd_table *table = NULL;
    haft_error error = {0};
    check_ok(haft_psd_table_create(&table, 40, &error), error);
    for (size_t i = 0; i < 40; i++) {
        table->zeta[i] = 19.4e6 * pow(289. / 19.4, (double)i / 39);
        table->s[i] = haft_psd_value(&psds[0], table->zeta[i]);
    }
    check_relative(haft_psd_table_get_correlation_length(table),
                   haft_psd_get_correlation_length(&psds[0]), 1e-9);
    haft_psd_table_destroy(&table);
}

static void the_forms_give_each_other(void **state) {
    (void)state;
    haft_error error = {0};
    double worst = 0;
    for (uint64_t k = 0; k < 100; k++) {
        uint64_t words[4];
        haft_random_words((haft_random_key){24, HAFT_RANDOM_TEST}, k, 0, 0, words);
        double hurst = k % 10 == 0 ? 1 : 0.01 + 0.98 * haft_random_uniform(words[0]);
        double ratio = pow(10, 0.02 + 3.5 * haft_random_uniform(words[1]));
        haft_psd a = {.zeta_max = 1e6 * pow(10, 3 * haft_random_uniform(words[2])),
                      .s_0 = 1e-36 * pow(10, 6 * haft_random_uniform(words[3]))};
        a.zeta_0 = a.zeta_max / ratio;
        a.s_1 = a.s_0 * pow(ratio, -2 * (1 + hurst));
        haft_roughness b = {.rms = sqrt(haft_psd_get_moments(&a).m0),
                            .correlation_length = haft_psd_get_correlation_length(&a),
                            .hurst = haft_psd_get_hurst(&a),
                            .zeta_max = a.zeta_max};
        haft_psd again;
        check_near(haft_psd_correlation(&a, b.correlation_length), exp(-1), 1e-12);
        b.hurst = fmin(b.hurst, 1); /* 1 but for rounding */
        check_ok(haft_psd_from_roughness(&again, &b, &error), error);
        check_relative(again.zeta_0, a.zeta_0, 1e-10);
        check_relative(again.s_0, a.s_0, 1e-10);
        check_relative(again.s_1, a.s_1, 1e-10);
        worst = fmax(worst, fabs(again.s_0 / a.s_0 - 1));
        check_relative(sqrt(haft_psd_get_moments(&again).m0), b.rms, 1e-12);
        check_relative(haft_psd_get_correlation_length(&again), b.correlation_length, 1e-10);
    }
    print_message("plateau there and back: off by %.1e at most\n", worst);
}

static void refuse(haft_roughness r, const char *says) {
    haft_psd psd;
    haft_error error = {0};
    assert_int_equal(haft_psd_from_roughness(&psd, &r, &error), HAFT_ERROR_INPUT);
    if (strstr(error.message, says) == NULL) {
        fail_msg("\"%s\" does not say \"%s\"", error.message, says);
    }
}

static void what_cannot_be_is_refused(void **state) {
    (void)state;
    haft_error error = {0};
    haft_psd psd;
    haft_roughness good = {5e-9, 200e-9, 0.8, 289e6}, r = good;
    check_ok(haft_psd_from_roughness(&psd, &good, &error), error);
    r.hurst = 1.01;
    refuse(r, "at most 1");
    r.hurst = 0;
    refuse(r, "above 0");
    r = good;
    r.rms = 0;
    refuse(r, "positive");
    r = good;
    r.correlation_length = 1e-9;
    refuse(r, "nm at least");
    r.correlation_length = 1;
    refuse(r, "um at most");
    r.correlation_length = NAN;
    refuse(r, "at least");
    /* whatever it is told, it ends, with a PSD or a reason */
    for (int k = 0; k < 200; k++) {
        uint64_t words[4];
        haft_random_words((haft_random_key){25, HAFT_RANDOM_TEST}, (uint64_t)k, 0, 0, words);
        r = (haft_roughness){pow(10, 600 * haft_random_uniform(words[0]) - 300),
                             pow(10, 600 * haft_random_uniform(words[1]) - 300),
                             fmin(1, pow(10, -300 * haft_random_uniform(words[2]))),
                             pow(10, 600 * haft_random_uniform(words[3]) - 300)};
        assert_true(haft_psd_from_roughness(&psd, &r, &error) == HAFT_OK ||
                    error.message[0] != '\0');
    }
    /* the nearest that is named can be used */
    static const double wished[] = {1e-9, 1};
    for (int k = 0; k < 2; k++) {
        r = good;
        r.correlation_length = wished[k];
        assert_int_equal(haft_psd_from_roughness(&psd, &r, &error), HAFT_ERROR_INPUT);
        r.correlation_length = strtod(strstr(error.message, "; give ") + 7, NULL);
        r.correlation_length *= k == 0 ? 1e-9 : 1e-6;
        check_ok(haft_psd_from_roughness(&psd, &r, &error), error);
    }
}

/* Maps of the PSD, none of them far larger than its waves: their own correlation length, which the
 * map's mean shortens a little, is the PSD's within three errors of the mean over maps. */
static void generated_maps_have_the_length(void **state) {
    (void)state;
    enum { SIDE = 768, MAPS = 8 };
    haft_error error = {0};
    haft_roughness r = {5e-9, 200e-9, 0.8, 100e6};
    haft_psd psd;
    haft_surface_plan *plan = NULL;
    haft_surface_work *work = NULL;
    check_ok(haft_psd_from_roughness(&psd, &r, &error), error);
    haft_surface_spec spec = {.psd = psd,
                              .grid_step = 25e-9,
                              .rows = SIDE,
                              .columns = SIDE,
                              .key = {7, HAFT_RANDOM_TEST}};
    check_ok(haft_surface_plan_create(&plan, &spec, &error), error);
    check_ok(haft_surface_work_create(&work, plan, &error), error);
    double sum = 0, squares = 0, rms = 0;
    for (uint64_t k = 0; k < MAPS; k++) {
        haft_map *map = NULL;
        haft_map_statistics s;
        check_ok(haft_map_create(&map, SIDE, SIDE, 25e-9, 25e-9, &error), error);
        check_ok(haft_surface_prepare(work, 0, k, 0, &error), error);
        check_ok(haft_surface_rows(work, 0, SIDE, map->z, &error), error);
        check_ok(haft_map_get_statistics(&s, map, &error), error);
        sum += s.correlation_length;
        squares += s.correlation_length * s.correlation_length;
        rms += s.rms * s.rms / MAPS;
        haft_map_destroy(&map);
    }
    haft_surface_work_destroy(&work);
    haft_surface_plan_destroy(&plan);
    double mean = sum / MAPS, deviation = sqrt((squares / MAPS - mean * mean) / (MAPS - 1));
    print_message("correlation length %.1f nm asked, %.1f +- %.1f found\n",
                  r.correlation_length * 1e9, mean * 1e9, deviation * 1e9);
    check_less(deviation, 0.03 * r.correlation_length);
    check_near(mean, r.correlation_length, 3 * deviation);
    check_relative(sqrt(rms), r.rms, 0.03);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_autocorrelation_is_the_hankel_transform),
        cmocka_unit_test(the_forms_give_each_other),
        cmocka_unit_test(what_cannot_be_is_refused),
        cmocka_unit_test(generated_maps_have_the_length),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
