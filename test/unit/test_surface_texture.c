/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ISO 25178 parameters of analytic surfaces against their closed values, with the orders at which
 * the pixel brings them there; of a rough surface stretched along one side; with pixels missing. */
#include "check.h"

#include "haft/surface_map.h"

#include <gsl/gsl_sf_ellint.h>

static const double HEIGHT = 3e-9;

typedef double (*shape)(double x, double y);

static double ridges(double x, double y) {
    (void)y;
    return HEIGHT * sin(2 * M_PI * x);
}

static double egg_box(double x, double y) {
    return HEIGHT * (sin(2 * M_PI * x) + sin(2 * M_PI * y));
}

static double plane(double x, double y) {
    return HEIGHT * (3 * x - 4 * y + 7);
}

static double paraboloid(double x, double y) {
    return HEIGHT * (x * x + y * y);
}

/* The shape over pixels from (x, y) on, `step` apart; lengths are in `unit` [m]. */
static haft_map *draw(shape z, size_t n, double from, double step, double unit) {
    haft_map *map = NULL;
    haft_error error = {0};
    check_ok(haft_map_create(&map, n, n, step * unit, step * unit, &error), error);
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            map->z[i * n + j] = z(from + step * (double)j, from + step * (double)i);
        }
    }
    return map;
}

static haft_map_texture texture_of(haft_map *map) {
    haft_map_texture t;
    haft_error error = {0};
    check_ok(haft_map_get_texture(&t, map, &error), error);
    haft_map_destroy(&map);
    return t;
}

/* Halving the pixel divides the error by four: second order. */
static void check_second_order(double coarse, double fine, double exact) {
    double ratio = (coarse - exact) / (fine - exact);
    check_near(ratio, 4, 0.15);
}

enum { PERIODS = 6, FEW = 24 }; /* whole ones, and pixels in each */

static void sine_ridges(void **state) {
    (void)state;
    const double unit = 40e-9, k = 2 * M_PI / unit; /* steep: slopes of 0.47 */
    haft_map_texture whole[2], closed[2];
    for (int fine = 0; fine < 2; fine++) {
        size_t m = (size_t)FEW << fine;
        double step = 1.0 / (double)m;
        whole[fine] = texture_of(draw(ridges, PERIODS * m, 0, step, unit));
        closed[fine] = texture_of(draw(ridges, PERIODS * m + 1, 0, step, unit)); /* whole edges */
        const haft_map_texture *t = &whole[fine];
        check_relative(t->sq, HEIGHT / sqrt(2), 1e-13);
        check_relative(t->sz, 2 * HEIGHT, 1e-13);
        check_relative(t->sp, HEIGHT, 1e-13);
        check_relative(t->sv, HEIGHT, 1e-13);
        check_near(t->ssk, 0, 1e-13);
        check_relative(t->sku, 1.5, 1e-11);
        /* differences of neighbours know k as 2 sin(k step / 2) / step */
        double known = 2 * sin(M_PI * step) / (step * unit);
        check_relative(closed[fine].sdq, HEIGHT * known / sqrt(2), 1e-12);
        check_relative(t->sal, acos(0.2) / k, 0.02);
        assert_true(t->str == 0 && isinf(t->slowest));
        check_near(t->reach, 0.5 * PERIODS * unit, unit);
    }
    check_second_order(whole[0].sa, whole[1].sa, 2 * HEIGHT / M_PI);
    check_relative(whole[1].sa, 2 * HEIGHT / M_PI, 2e-3);
    check_second_order(closed[0].sdq, closed[1].sdq, HEIGHT * k / sqrt(2));
    /* the length of a sine's arc is an elliptic integral */
    double slope = HEIGHT * k, modulus = slope / sqrt(1 + slope * slope);
    double arc = 2 / M_PI * sqrt(1 + slope * slope) * gsl_sf_ellint_Ecomp(modulus, GSL_PREC_DOUBLE);
    check_second_order(closed[0].sdr, closed[1].sdr, arc - 1);
}

static void an_egg_box(void **state) {
    (void)state;
    const double unit = 1e-6, k = 2 * M_PI / unit;
    haft_map_texture t[2], closed[2];
    for (int fine = 0; fine < 2; fine++) {
        size_t m = (size_t)FEW << fine;
        t[fine] = texture_of(draw(egg_box, PERIODS * m, 0, 1.0 / (double)m, unit));
        closed[fine] = texture_of(draw(egg_box, PERIODS * m + 1, 0, 1.0 / (double)m, unit));
        check_relative(t[fine].sq, HEIGHT, 1e-13);
        check_relative(t[fine].sz, 4 * HEIGHT, 1e-13);
        check_near(t[fine].ssk, 0, 1e-13);
        check_relative(t[fine].sku, 2.25, 1e-11);
        double known = 2 * sin(M_PI / (double)m) * (double)m / unit;
        check_relative(closed[fine].sdq, HEIGHT * known, 1e-12);
        /* f = (cos kx + cos ky) / 2: fastest along the diagonal, slowest along a side */
        check_relative(t[fine].sal, sqrt(2) * acos(0.2) / k, 0.02);
        check_relative(t[fine].slowest, acos(-0.6) / k, 0.03);
        check_relative(t[fine].str, sqrt(2) * acos(0.2) / acos(-0.6), 0.03);
        assert_true(t[fine].reach == t[fine].slowest);
    }
    check_second_order(t[0].sa, t[1].sa, 8 * HEIGHT / (M_PI * M_PI));
    check_second_order(closed[0].sdq, closed[1].sdq, HEIGHT * k);
}

static void a_plane(void **state) {
    (void)state;
    enum { N = 50 };
    const double unit = 1e-9, n = N; /* slopes of 9 and -12 */
    haft_map_texture t = texture_of(draw(plane, N, 0, 0.5, unit));
    double uniform = (n * n - 1) / 12 * 0.25, step = HEIGHT / unit;
    check_relative(t.sq, HEIGHT * 5 * sqrt(uniform), 1e-13);
    check_relative(t.sz, HEIGHT * 7 * 0.5 * (n - 1), 1e-13);
    check_near(t.ssk, 0, 1e-12);
    double flat = -1.2 * (n * n + 1) / (n * n - 1); /* excess of a row's numbers */
    check_relative(t.sku, 3 + flat * (81 + 256) / 625.0, 1e-12);
    check_relative(t.sdq, 5 * step, 1e-13);
    check_relative(t.sdr, sqrt(1 + 25 * step * step) - 1, 1e-13);
}

static void a_paraboloid(void **state) {
    (void)state;
    haft_map_texture t[2];
    for (int fine = 0; fine < 2; fine++) { /* pixels' centres over -1 to 1 */
        size_t n = (size_t)40 << fine;
        double step = 2.0 / (double)n;
        t[fine] = texture_of(draw(paraboloid, n, -1 + 0.5 * step, step, 1e-6));
    }
    check_second_order(t[0].sq, t[1].sq, HEIGHT * sqrt(8 / 45.));
    check_second_order(t[0].ssk, t[1].ssk, 16 / 945. / pow(4 / 45., 1.5) / sqrt(2));
    check_second_order(t[0].sku, t[1].sku, 18 / 7.);
    check_relative(t[1].sku, 18 / 7., 1e-3);
    check_relative(t[1].sdq, HEIGHT / 1e-6 * sqrt(8 / 3.), 0.03);
    check_near(t[1].sp / t[1].sv, 2, 0.08); /* corners against the middle, about the mean */
}

/* A rough surface whose rows are three times as far apart as its columns: f falls to 0.2 three
 * times as late along them, within the scatter over maps. */
static void a_rough_surface_stretched(void **state) {
    (void)state;
    enum { SIDE = 384, MAPS = 8 };
    const double step = 20e-9, stretch = 3;
    haft_error error = {0};
    haft_psd psd;
    haft_roughness rough = {4e-9, 150e-9, 0.8, 120e6};
    haft_surface_plan *plan = NULL;
    haft_surface_work *work = NULL;
    check_ok(haft_psd_from_roughness(&psd, &rough, &error), error);
    haft_surface_spec spec = {
        .psd = psd, .grid_step = step, .rows = SIDE, .columns = SIDE, .key = {3, HAFT_RANDOM_TEST}};
    check_ok(haft_surface_plan_create(&plan, &spec, &error), error);
    check_ok(haft_surface_work_create(&work, plan, &error), error);
    double low = 0, high = 1e-6, sum[2] = {0}, squares[2] = {0};
    while (high - low > 1e-13) {
        double middle = 0.5 * (low + high);
        *(haft_psd_correlation(&psd, middle) > 0.2 ? &low : &high) = middle;
    }
    for (uint64_t k = 0; k < MAPS; k++) {
        haft_map *map = NULL;
        check_ok(haft_map_create(&map, SIDE, SIDE, stretch * step, step, &error), error);
        check_ok(haft_surface_prepare(work, 0, k, 0, &error), error);
        check_ok(haft_surface_rows(work, 0, SIDE, map->z, &error), error);
        haft_map_texture t = texture_of(map);
        const double found[2] = {t.sal / low, t.str * stretch};
        for (int q = 0; q < 2; q++) {
            sum[q] += found[q] / MAPS;
            squares[q] += found[q] * found[q] / MAPS;
        }
    }
    for (int q = 0; q < 2; q++) {
        double scatter = sqrt((squares[q] - sum[q] * sum[q]) / (MAPS - 1));
        print_message("%s over its value: %.3f +- %.3f\n", q == 0 ? "Sal" : "Str", sum[q], scatter);
        check_less(scatter, 0.05);
        check_near(sum[q], 1, 3 * scatter + 0.03); /* least and greatest of a scattering f */
    }
    haft_surface_work_destroy(&work);
    haft_surface_plan_destroy(&plan);
}

static void missing_pixels_are_left_out(void **state) {
    (void)state;
    enum { M = FEW, N = PERIODS * M + 1 };
    haft_map *map = draw(ridges, N, 0, 1.0 / M, 1e-6);
    haft_map_texture t, full;
    haft_error error = {0};
    check_ok(haft_map_get_texture(&full, map, &error), error);
    for (size_t j = 0; j < N; j++) { /* whole lines, which all are alike */
        map->z[10 * N + j] = map->z[11 * N + j] = map->z[90 * N + j] = NAN;
    }
    check_ok(haft_map_get_texture(&t, map, &error), error);
    check_relative(t.sq, full.sq, 1e-13);
    check_relative(t.sa, full.sa, 1e-13);
    check_relative(t.sku, full.sku, 1e-12);
    check_relative(t.sdq, full.sdq, 1e-13);
    check_relative(t.sdr, full.sdr, 1e-12);
    check_relative(t.sal, full.sal, 1e-9);
    assert_true(t.str == 0);
    for (size_t i = 0; i < (size_t)N * N; i++) {
        map->z[i] = i % 2 ? NAN : map->z[i]; /* no four together */
    }
    check_ok(haft_map_get_texture(&t, map, &error), error);
    assert_true(isnan(t.sdq) && isnan(t.sdr) && isfinite(t.sq) && isfinite(t.sal));
    for (size_t i = 0; i < (size_t)N * N; i++) {
        map->z[i] = 1e-9;
    }
    haft_map_statistics s;
    assert_int_equal(haft_map_get_texture(&t, map, &error), HAFT_ERROR_INPUT);
    assert_int_equal(haft_map_get_statistics(&s, map, &error), HAFT_ERROR_INPUT);
    haft_map_destroy(&map);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sine_ridges),
        cmocka_unit_test(an_egg_box),
        cmocka_unit_test(a_plane),
        cmocka_unit_test(a_paraboloid),
        cmocka_unit_test(a_rough_surface_stretched),
        cmocka_unit_test(missing_pixels_are_left_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
