/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The edges of what can be solved: gaps of 1e9 ranges, laws that push beyond their well, beams that
 * feel their laws at rest, a load almost on a site, walls much steeper than wells, cracks that no
 * load reaches. Each either has the known answer or an outcome that names its cause. */
#include "check.h"
#include "from_rest.h"
#include "single_spring.h"

#include <string.h>

static const haft_beam_spec BEAM = {600e-6, 30e-6, 2.62e-6, 1.9e-6, 163e9};
static const haft_mesh_spec EXACT = {HAFT_MESH_EXACT, 0, 3e-6, 60e-6, 0};
static const haft_mesh_spec COARSE = {HAFT_MESH_EXACT, 0, 15e-6, 60e-6, 0};
static const haft_mesh_spec ACTIVE = {HAFT_MESH_ACTIVE, 0, 3e-6, 60e-6, 90e-6};

/* A Morse law whose wings are alike, with a wall of 1 GPa. */
static haft_law make_law(double range, double f_max) {
    haft_law law;
    haft_law_vector v = {2 * f_max * range, f_max, 3 * range, 0};
    v.d_limit = v.d_max - range * log1p(sqrt(1 + 1e9 / f_max));
    assert_int_equal(haft_law_morse(&law, &v, 1e9), HAFT_LAW_SOUND);
    return law;
}

/* The path of a beam with the same law at every site. */
static haft_path *follow(const haft_beam_spec *beam, haft_mesh_spec mesh, haft_law law,
                         double crack, double limit) {
    haft_error error = {0};
    haft_model *model = NULL;
    check_ok(haft_model_create_beam(&model, beam, &mesh, &error), error);
    haft_law *laws = haft_memory_alloc(haft_model_get(model)->sites, sizeof *laws, &error);
    for (size_t r = 0; r < haft_model_get(model)->sites; r++) {
        laws[r] = law;
    }
    haft_programme programme = {crack, 0.01, limit};
    haft_path_options options = {.keep_states = true};
    haft_path *path = NULL;
    check_ok(haft_solve_path(&path, model, laws, &programme, &options, &error), error);
    haft_memory_free(laws);
    haft_model_destroy(&model);
    return path;
}

static bool has_answer(const haft_path *path) {
    return path->outcome == HAFT_OUTCOME_STUCK || path->outcome == HAFT_OUTCOME_FREE;
}

static double end_crack(const haft_path *path) {
    return path->point[path->points - 1].crack_length;
}

/* A gap is known to the rounding of the height, so nobody can bring it nearer to a value or to a
 * kink of its law. */
static void a_gap_of_very_many_ranges_is_followed(void **state) {
    (void)state;
    for (double gap = 1e-6; gap < 2; gap *= 10) {
        haft_beam_spec beam = BEAM;
        beam.gap = gap;
        haft_path *path = follow(&beam, COARSE, make_law(1e-9, 1e6), 200e-6, INFINITY);
        print_message("  gap %.0e m: %s, %zu points, %zu jumps, crack %.3f um\n", gap,
                      haft_outcome_name(path->outcome), path->points, path->jumps,
                      1e6 * end_crack(path));
        assert_true(has_answer(path));
        assert_true(path->points < 10000);
        check_less(path->ledger_error, 1e-10);
        haft_path_destroy(&path);
    }
}

/* What pushes beyond its well is felt before the pull is: an active mesh must not leave it out. */
static void a_law_may_push_beyond_its_well(void **state) {
    (void)state;
    double d[] = {5e-9, 8e-9, 12e-9, 20e-9, 28e-9}, f[] = {1e7, -1e6, 2e5, 1e5, 0};
    haft_error error = {0};
    haft_law_table *table = NULL;
    check_ok(haft_law_table_create(&table, 5, d, f, &error), error);
    haft_law law = haft_law_from_table(table);
    check_less(haft_law_reach(&law, 0.01), 12e-9);
    check_less(20e-9, haft_law_extent(&law, 0.01));
    check_near(haft_law_extent(&law, 1e-16), 28e-9, 1e-15);
    check_less(haft_law_evaluate(&law, haft_law_extent(&law, 0.05)).force / 5e4 - 1, 1e-12);
    haft_path *exact = follow(&BEAM, EXACT, law, 120e-6, INFINITY);
    haft_path *active = follow(&BEAM, ACTIVE, law, 120e-6, INFINITY);
    haft_mesh_spec mesh = {HAFT_MESH_UNIFORM, 1.5e-6, 3e-6, 60e-6, 0};
    haft_path *uniform = follow(&BEAM, mesh, law, 120e-6, INFINITY);
    print_message("  crack %.7f um and %zu jumps, active %.7f and %zu, uniform %.7f and %zu\n",
                  1e6 * end_crack(exact), exact->jumps, 1e6 * end_crack(active), active->jumps,
                  1e6 * end_crack(uniform), uniform->jumps);
    const haft_path *others[] = {active, uniform};
    for (int i = 0; i < 2; i++) {
        assert_int_equal(others[i]->outcome, HAFT_OUTCOME_STUCK);
        assert_int_equal(others[i]->jumps, exact->jumps);
        check_relative(end_crack(others[i]), end_crack(exact), 1e-10);
    }
    haft_path_destroy(&exact);
    haft_path_destroy(&active);
    haft_path_destroy(&uniform);
    haft_law_table_destroy(&table);
}

/* A spring k from a gap of 24 nm over a well that it feels there: gradient flow in one dimension
 * goes to the first state of balance on its way down, which bisection finds. */
static void a_path_begins_where_the_flow_from_rest_leads(void **state) {
    (void)state;
    const double area = 1e-9, gap = 24e-9;
    haft_law law = make_law(3e-9, 5e6);
    int far = 0;
    for (double k = 1e4; k < 1e7; k *= 1.3) {
        double w = 0, dw = gap * 1e-6, load = 0;
        while ((load = k * w + area * haft_law_evaluate(&law, gap - w).force) < 0) {
            w += dw;
        }
        double low = w - dw;
        for (int i = 0; i < 60; i++) {
            double middle = 0.5 * (low + w);
            load = k * middle + area * haft_law_evaluate(&law, gap - middle).force;
            *(load < 0 ? &low : &w) = middle;
        }
        haft_model *model = single_spring(k, gap, area);
        haft_programme programme = {-1, 0.01, k * gap};
        haft_path_options options = {.keep_states = true};
        haft_path *path = NULL;
        haft_error error = {0};
        check_ok(haft_solve_path(&path, model, &law, &programme, &options, &error), error);
        check_near(path->state[0] * gap, w, 1e-15);
        double rest = area * haft_law_evaluate(&law, gap).potential;
        double landed = 0.5 * k * w * w + area * haft_law_evaluate(&law, gap - w).potential;
        if (jumps_from_rest(path) == 1) {
            far++;
            assert_int_equal(path->point[0].jump, 0);
            assert_int_equal(path->jump[0].kind, HAFT_JUMP_PULL_IN);
            assert_true(path->jump[0].load == 0 && path->jump[0].flow_steps > 0);
            check_relative(path->jump[0].dissipated, rest - landed, 1e-9);
            check_relative(path->point[0].dissipated, rest - landed, 1e-9);
        } else {
            check_less(w / 3e-9, 0.06);
            assert_true(path->point[0].dissipated == 0);
        }
        check_less(path->ledger_error, 1e-10);
        haft_path_destroy(&path);
        haft_model_destroy(&model);
    }
    assert_true(far > 10 && far < 26);
}

/* Two sites of one beam between which the flow chooses: only the second is caught. */
static void a_beam_begins_in_the_valley_below_it(void **state) {
    (void)state;
    haft_beam_spec beam = {70e-6, 30e-6, 2.62e-6, 24e-9, 163e9};
    haft_mesh_spec mesh = {HAFT_MESH_EXACT, 0, 35e-6, 60e-6, 0};
    haft_law law;
    haft_law_vector v = {0.02, 5e6, 3e-9, 1e-9};
    assert_int_equal(haft_law_morse(&law, &v, 1e7), HAFT_LAW_SOUND);
    haft_path *path = follow(&beam, mesh, law, -1, 1e-3);
    haft_model *model = NULL;
    haft_error error = {0};
    check_ok(haft_model_create_beam(&model, &beam, &mesh, &error), error);
    double first = beam.gap - haft_model_displacement(&haft_model_get(model)->site[0], path->state);
    double second =
        beam.gap - haft_model_displacement(&haft_model_get(model)->site[1], path->state);
    print_message("  gaps %.4f and %.4f nm\n", 1e9 * first, 1e9 * second);
    check_near(first, 20.5e-9, 0.05e-9); /* as a stiff integrator of the flow finds them */
    check_near(second, 1.62e-9, 0.005e-9);
    assert_true(has_answer(path));
    haft_path_destroy(&path);
    haft_model_destroy(&model);
}

/* A load that does next to no work beside the energies that are there: their rounding is no open
 * ledger. */
static void a_load_without_work_leaves_the_ledger_closed(void **state) {
    (void)state;
    const double area = 1e-9, gap = 24e-9, k = 1e5;
    haft_law law = make_law(3e-9, 5e6);
    haft_model *model = single_spring(k, gap, area);
    for (double share = 1e-6; share > 1e-17; share /= 10) {
        haft_programme programme = {-1, 0.01, share * k * gap};
        haft_path *path = NULL;
        haft_error error = {0};
        check_ok(haft_solve_path(&path, model, &law, &programme, NULL, &error), error);
        assert_int_equal(path->outcome, HAFT_OUTCOME_STUCK);
        check_less(path->ledger_error, 1e-9);
        haft_path_destroy(&path);
    }
    haft_model_destroy(&model);
}

/* However near to a site the load is, the answer is the same but for the distance. */
static void a_load_may_be_almost_on_a_site(void **state) {
    (void)state;
    haft_law law;
    haft_law_vector v = {3.6e-3, 1e6, 11e-9, 8.2e-9};
    assert_int_equal(haft_law_morse(&law, &v, 5e6), HAFT_LAW_SOUND);
    haft_path *on[2] = {NULL, NULL};
    for (double apart = 0; apart < 2e-7; apart = apart == 0 ? 1e-12 : 10 * apart) {
        for (int side = -1; side <= 1; side += 2) {
            for (int m = 0; m < 2; m++) {
                haft_mesh_spec mesh = m == 0 ? EXACT : ACTIVE;
                mesh.load_position = 61.5e-6 + side * apart;
                haft_path *path = follow(&BEAM, mesh, law, 120e-6, INFINITY);
                assert_int_equal(path->outcome, HAFT_OUTCOME_STUCK);
                check_less(path->ledger_error, 1e-10);
                if (on[m] == NULL) {
                    on[m] = path;
                    continue;
                }
                assert_int_equal(path->jumps, on[m]->jumps);
                for (size_t j = 0; j < path->jumps; j++) {
                    double load = on[m]->jump[j].load; /* P x^2 (3 L - x) moves the rest */
                    check_near(path->jump[j].load / load, 1, 1e-9 + 2.2 * apart / 61.5e-6);
                }
                check_relative(end_crack(path), end_crack(on[m]), 1e-9);
                haft_path_destroy(&path);
            }
        }
    }
    haft_path_destroy(&on[0]);
    haft_path_destroy(&on[1]);
}

/* A wall may be much narrower than the well in front of it: steps are as long as the well is wide,
 * and the answers go to that of the thinnest wall as the wall's width does. */
static void a_thin_wall_costs_no_steps(void **state) {
    (void)state;
    double last = 0, change = INFINITY;
    for (double width = 1e-9; width > 0.9e-13; width /= 10) {
        haft_law law;
        haft_law_vector v = {3.6e-3, 1e6, 11e-9, 11e-9 - width};
        assert_int_equal(haft_law_morse(&law, &v, 5e6), HAFT_LAW_SOUND);
        haft_path *path = follow(&BEAM, EXACT, law, 120e-6, INFINITY);
        double crack = end_crack(path);
        print_message("  wall %.0e m wide: %zu points, %zu jumps, crack %.5f um\n", width,
                      path->points, path->jumps, 1e6 * crack);
        assert_int_equal(path->outcome, HAFT_OUTCOME_STUCK);
        assert_true(path->points < 2000);
        if (last > 0) {
            assert_true(fabs(crack - last) < 0.3 * change);
            change = fabs(crack - last);
        }
        last = crack;
        haft_path_destroy(&path);
    }
}

/* Behind the wall the law is linear: however deep it is pressed, that costs a few steps. */
static void deep_pressing_costs_no_steps(void **state) {
    (void)state;
    haft_law law = make_law(1e-9, 1e6);
    haft_path *path = follow(&BEAM, COARSE, law, 200e-6, INFINITY);
    double load = path->point[path->turn].load;
    size_t points = 0;
    haft_path_destroy(&path);
    for (double harder = 1e2; harder < 1e7; harder *= 10) {
        path = follow(&BEAM, COARSE, law, -1, harder * load);
        print_message("  pressed %.0e times harder: %zu points\n", harder, path->points);
        assert_true(has_answer(path));
        assert_true(points == 0 || path->points < points + 150);
        points = path->points;
        haft_path_destroy(&path);
    }
}

static void a_crack_that_no_load_reaches_ends_the_path(void **state) {
    (void)state;
    haft_path *path = follow(&BEAM, COARSE, make_law(1e-9, 1e6), 1e-6, INFINITY);
    assert_int_equal(path->outcome, HAFT_OUTCOME_CRACK_UNREACHED);
    assert_true(path->points < 2000);
    assert_true(strlen(haft_outcome_advice(path->outcome)) > 0);
    haft_path_destroy(&path);
}

static void every_outcome_has_a_name_and_advice(void **state) {
    (void)state;
    for (int i = 0; i < HAFT_OUTCOMES; i++) {
        bool answer = i == HAFT_OUTCOME_STUCK || i == HAFT_OUTCOME_FREE;
        assert_true(strlen(haft_outcome_name((haft_outcome)i)) > 0);
        assert_true(answer == (strlen(haft_outcome_advice((haft_outcome)i)) == 0));
        for (int j = 0; j < i; j++) {
            assert_string_not_equal(haft_outcome_name((haft_outcome)i),
                                    haft_outcome_name((haft_outcome)j));
        }
    }
}

/* Several sites alike snap together, and the path goes on with whole steps. */
static void steps_are_whole_again_after_many_null_vectors(void **state) {
    (void)state;
    enum { SPRINGS = 4 };
    const double area = 1e-12, gap = 100e-9;
    haft_law law = make_law(3e-9, 1e6), laws[SPRINGS] = {law, law, law, law};
    double k = 0.1 * area * law.f_max * law.a_right;
    haft_element element[SPRINGS] = {{{0}, {{0}}, {0}, {0}}};
    haft_site site[SPRINGS] = {{0}}, load = {.terms = 0};
    for (int i = 0; i < SPRINGS; i++) {
        element[i] = (haft_element){{i, -1, -1, -1}, {{1}}, {1}, {1}};
        site[i] = (haft_site){.area = area, .dof = {i, -1, -1, -1}, .shape = {gap}};
        load.dof[i] = i;
        load.shape[i] = gap;
    }
    haft_model_parts parts = {.dofs = SPRINGS,
                              .energy_unit = k * gap * gap,
                              .gap = gap,
                              .elements = SPRINGS,
                              .element = element,
                              .sites = SPRINGS,
                              .site = site,
                              .load = load};
    haft_model *model = NULL;
    haft_error error = {0};
    check_ok(haft_model_create(&model, &parts, &error), error);
    haft_programme programme = {-1, 0.01, 2 * SPRINGS * k * gap};
    haft_path *path = NULL;
    check_ok(haft_solve_path(&path, model, laws, &programme, NULL, &error), error);
    assert_true(has_answer(path) && path->jumps >= 2);
    assert_int_not_equal(path->jump[0].departure, HAFT_DEPARTURE_FOLD);
    print_message("  %zu points, %zu jumps\n", path->points, path->jumps);
    assert_true(path->points < 200);
    haft_path_destroy(&path);
    haft_model_destroy(&model);
}

static void check_refused(haft_programme programme, const char *says) {
    haft_model *model = single_spring(1, 1e-7, 1e-12);
    haft_law law = make_law(3e-9, 1e6);
    haft_path *path = NULL;
    haft_error error = {0};
    assert_int_equal(haft_solve_path(&path, model, &law, &programme, NULL, &error),
                     HAFT_ERROR_ARGUMENT);
    assert_null(path);
    assert_non_null(strstr(error.message, says));
    haft_model_destroy(&model);
}

static void what_makes_no_sense_is_refused(void **state) {
    (void)state;
    check_refused((haft_programme){-1, 0.01, 0}, "load limit");
    check_refused((haft_programme){-1, 0.01, -1e-6}, "load limit");
    check_refused((haft_programme){1e-4, 0.01, NAN}, "load limit");
    check_refused((haft_programme){-1, 0.01, INFINITY}, "crack length");
    check_refused((haft_programme){NAN, 0.01, 1e-6}, "crack length");
    check_refused((haft_programme){1e-4, NAN, 1e-6}, "threshold");
    haft_model *model = NULL;
    haft_error error = {0};
    haft_mesh_spec uniform = {HAFT_MESH_UNIFORM, 600e-6 / 20000, 3e-6, 60e-6, 0};
    assert_int_equal(haft_model_create_beam(&model, &BEAM, &uniform, &error), HAFT_ERROR_INPUT);
    assert_non_null(strstr(error.message, "element_length"));
    haft_mesh_spec exact = {HAFT_MESH_EXACT, 0, 600e-6 / 30000, 60e-6, 0};
    assert_int_equal(haft_model_create_beam(&model, &BEAM, &exact, &error), HAFT_ERROR_INPUT);
    assert_non_null(strstr(error.message, "l_meso"));
    assert_null(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_gap_of_very_many_ranges_is_followed),
        cmocka_unit_test(a_law_may_push_beyond_its_well),
        cmocka_unit_test(a_path_begins_where_the_flow_from_rest_leads),
        cmocka_unit_test(a_beam_begins_in_the_valley_below_it),
        cmocka_unit_test(a_load_without_work_leaves_the_ledger_closed),
        cmocka_unit_test(a_load_may_be_almost_on_a_site),
        cmocka_unit_test(a_thin_wall_costs_no_steps),
        cmocka_unit_test(deep_pressing_costs_no_steps),
        cmocka_unit_test(a_crack_that_no_load_reaches_ends_the_path),
        cmocka_unit_test(every_outcome_has_a_name_and_advice),
        cmocka_unit_test(steps_are_whole_again_after_many_null_vectors),
        cmocka_unit_test(what_makes_no_sense_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
