/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steep walls and short ranges: the gap from 10 to 1e5 ranges of the law, walls from 1 GPa to 1 TPa
 * under deep compression. Behind the wall the law is a straight line, so a spring's place there has
 * a closed form; in front of it, the wall's height must not matter at all. A gap is known to
 * the rounding of the height h it is measured from, so a step's energy to force * h * 2^-53 at
 * best: no ledger may ask for more where the law's range is h / 1e5. */
#include "from_rest.h"
#include "haft/solve.h"
#include "single_spring.h"

static haft_law steep_law(double range, double f_max, double wall) {
    haft_law law;
    haft_law_vector v = {.f_max = f_max, .d_max = 3 * range};
    v.e = 2 * f_max * range; /* both wings alike: a = 1 / range */
    v.d_limit = v.d_max - range * log1p(sqrt(1 + wall / f_max));
    assert_int_equal(haft_law_morse(&law, &v, wall), HAFT_LAW_SOUND);
    check_relative(law.a_left, 1 / range, 1e-13);
    check_relative(law.a_right, 1 / range, 1e-13);
    return law;
}

/* Loads of the two folds, E (1 - E) = k / (2 A f_max a), and f there. */
static double fold_load(const haft_law *law, double k, double gap, double area, bool far) {
    double c = k / (2 * area * law->f_max * law->a_right);
    double e = far ? 2 * c / (1 + sqrt(1 - 4 * c)) : (1 + sqrt(1 - 4 * c)) / 2;
    double d = law->d_max - log(e) / law->a_right;
    return k * (gap - d) + area * law->f_max * e * (e - 2);
}

static void a_spring_behind_a_steep_wall(void **state) {
    (void)state;
    const double area = 1e-12, f_max = 3e6, gap = 1.9e-6;
    double worst = 0;
    for (double ratio = 10; ratio < 2e5; ratio *= 10) {
        for (double wall = 1e9; wall < 2e12; wall *= 10) {
            haft_law law = steep_law(gap / ratio, f_max, wall);
            double k = 0.05 * area * f_max * law.a_right / 2;
            double load = area * wall * 1e3; /* a thousand times the wall's height */
            haft_model *model = single_spring(k, gap, area);
            haft_programme programme = {-1, 0.01, load};
            haft_path_options options = {.keep_states = true};
            haft_error error = {0};
            haft_path *path = NULL;
            check_ok(haft_solve_path(&path, model, &law, &programme, &options, &error), error);
            double in = fold_load(&law, k, gap, area, true);
            double out = fold_load(&law, k, gap, area, false);
            size_t first = jumps_from_rest(path);
            assert_int_equal(path->jumps, first + (out > 0 ? 2 : 1));
            check_relative(path->jump[first].load, in, 1e-10);
            if (out > 0) {
                check_near(path->jump[first + 1].load, out, 1e-10 * (in + area * f_max));
            }
            double stiffness = -law.wall_slope * area, d0 = law.wall_distance;
            /* P = k (gap - d) + A wall + stiffness (d0 - d) */
            double depth = (load - k * (gap - d0) - area * wall) / (k + stiffness);
            double d = gap * (1 - path->state[path->turn]);
            assert_true(depth > 0);
            check_near((d0 - d) / depth, 1, 1e-10 + 8 * gap * 0x1p-52 / depth);
            assert_int_equal(path->outcome, out > 0 ? HAFT_OUTCOME_FREE : HAFT_OUTCOME_STUCK);
            worst = fmax(worst, path->ledger_error);
            check_less(path->ledger_error, 1e-10);
            haft_path_destroy(&path);
            haft_model_destroy(&model);
        }
    }
    print_message("  springs: ledger to %.1e\n", worst);
}

static const haft_beam_spec BEAM = {600e-6, 30e-6, 2.62e-6, 1.9e-6, 163e9};

/* Laws that differ only where the pressure is above 1 GPa: a beam that never presses so hard takes
 * the same path over all of them. */
static void a_beam_does_not_feel_how_high_the_wall_is(void **state) {
    (void)state;
    haft_error error = {0};
    haft_mesh_spec mesh = {HAFT_MESH_UNIFORM, 30e-6, 6e-6, 60e-6, 0};
    haft_model *model = NULL;
    check_ok(haft_model_create_beam(&model, &BEAM, &mesh, &error), error);
    haft_law *law = haft_memory_alloc(haft_model_get(model)->sites, sizeof *law, &error);
    for (double range = 4e-9; range > 0.9e-10; range /= 6) {
        haft_path *first = NULL;
        for (double wall = 1e9; wall < 2e12; wall *= 10) {
            for (size_t r = 0; r < haft_model_get(model)->sites; r++) {
                double z[1];
                haft_random_normals((haft_random_key){7, HAFT_RANDOM_TEST}, 0, r, 0, 1, z);
                law[r] = steep_law(range * exp(0.1 * z[0]), 3e-3 / range, wall);
            }
            haft_programme programme = {150e-6, 0.01, INFINITY};
            haft_path *path = NULL;
            check_ok(haft_solve_path(&path, model, law, &programme, NULL, &error), error);
            assert_int_equal(path->outcome, HAFT_OUTCOME_STUCK);
            check_less(path->ledger_error, 1e-10);
            if (first == NULL) {
                print_message("  range %.2g m: %zu points, %zu jumps, ledger %.1e\n", range,
                              path->points, path->jumps, path->ledger_error);
                first = path;
                continue;
            }
            assert_int_equal(path->jumps, first->jumps);
            for (size_t j = 0; j < path->jumps; j++) {
                assert_int_equal(path->jump[j].site, first->jump[j].site);
                check_near(path->jump[j].load, first->jump[j].load,
                           1e-9 * first->point[first->turn].load);
            }
            check_relative(path->point[path->points - 1].crack_length,
                           first->point[first->points - 1].crack_length, 1e-9);
            haft_path_destroy(&path);
        }
        haft_path_destroy(&first);
    }
    haft_memory_free(law);
    haft_model_destroy(&model);
}

/* Pressed a thousand times harder than its walls are high: no overflow, and the ledger closes. */
static void a_beam_pressed_deep_into_its_walls(void **state) {
    (void)state;
    haft_error error = {0};
    haft_mesh_spec mesh = {HAFT_MESH_UNIFORM, 30e-6, 6e-6, 300e-6, 0};
    haft_model *model = NULL;
    check_ok(haft_model_create_beam(&model, &BEAM, &mesh, &error), error);
    haft_law *law = haft_memory_alloc(haft_model_get(model)->sites, sizeof *law, &error);
    for (double wall = 1e9; wall < 2e12; wall *= 1000) {
        for (size_t r = 0; r < haft_model_get(model)->sites; r++) {
            law[r] = steep_law(1e-9, 3e6, wall);
        }
        double load = 100 * wall * haft_model_get(model)->site[0].area;
        haft_programme programme = {-1, 0.01, load};
        haft_path_options options = {.keep_states = true};
        haft_path *path = NULL;
        check_ok(haft_solve_path(&path, model, law, &programme, &options, &error), error);
        print_message("  wall %.0e Pa: %s, %zu points, %zu jumps, ledger %.1e\n", wall,
                      haft_outcome_name(path->outcome), path->points, path->jumps,
                      path->ledger_error);
        assert_true(path->turned_by_load);
        assert_int_equal(path->outcome, HAFT_OUTCOME_STUCK);
        check_less(path->ledger_error, 1e-10);
        /* far below the wall under the load, and vertical equilibrium of the whole: what the sites
         * push, the load carries less the clamp's share, which its shape gives (EI w''' at 0) */
        const double *u = path->state + path->turn * haft_model_get(model)->dofs;
        double deepest = INFINITY, push = 0;
        for (size_t r = 0; r < haft_model_get(model)->sites; r++) {
            double d = BEAM.gap - haft_model_displacement(&haft_model_get(model)->site[r], u);
            push += haft_model_get(model)->site[r].area * haft_law_evaluate(&law[r], d).force;
            deepest = fmin(deepest, d - law[r].wall_distance);
        }
        assert_true(deepest < 0);
        double w, slope, l = haft_model_get(model)->node_x[1];
        haft_model_shape(model, u, l, &w, &slope);
        double shear = 0; /* EI w''' in the first element, less the sites' share that it carries */
        double ei = haft_beam_bending_stiffness(&BEAM);
        shear = -ei * (-12 * w + 6 * l * slope) / (l * l * l);
        for (size_t r = 0; r < haft_model_get(model)->sites && haft_model_get(model)->site[r].x < l;
             r++) {
            double xi = haft_model_get(model)->site[r].x / l;
            double d = BEAM.gap - haft_model_displacement(&haft_model_get(model)->site[r], u);
            double f = haft_model_get(model)->site[r].area * haft_law_evaluate(&law[r], d).force;
            shear -= f * (1 - xi * xi * (3 - 2 * xi));
        }
        check_near((push + shear) / load, 1, 1e-6);
        haft_path_destroy(&path);
    }
    haft_memory_free(law);
    haft_model_destroy(&model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_spring_behind_a_steep_wall),
        cmocka_unit_test(a_beam_does_not_feel_how_high_the_wall_is),
        cmocka_unit_test(a_beam_pressed_deep_into_its_walls),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
