/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ends of branches that are no simple folds, each with its known answer: sites alike that snap
 * together, a symmetric pair that must choose a side, and pairs of folds about to vanish. */
#include "check.h"
#include "haft/solve.h"

#define GAP 100e-9
#define AREA 1e-12

static const haft_law_vector VECTOR = {7e-3, 3e6, 9e-9, 7e-9};
static const double F_LIMIT = 5e6;

static haft_law make_law(void) {
    haft_law law;
    assert_int_equal(haft_law_morse(&law, &VECTOR, F_LIMIT), HAFT_LAW_SOUND);
    return law;
}

static haft_path *follow(const haft_model *model, const haft_law *law, double limit) {
    haft_error error = {0};
    haft_programme programme = {-1, 0.01, limit};
    haft_path_options options = {.keep_states = true};
    haft_path *path = NULL;
    check_ok(haft_solve_path(&path, model, law, &programme, &options, &error), error);
    return path;
}

/* n springs apart and alike, one load shared evenly: w = mean of their displacements. */
static haft_model *springs_apart(int n, double k) {
    haft_element element[HAFT_SPAN];
    haft_site site[HAFT_SPAN], load = {.dof = {-1, -1, -1, -1}};
    for (int i = 0; i < n; i++) {
        element[i] =
            (haft_element){.dof = {i, -1, -1, -1}, .mode = {{1}}, .stiffness = {1}, .mass = {1}};
        site[i] = (haft_site){.area = AREA, .dof = {i, -1, -1, -1}, .shape = {GAP}};
        load.dof[i] = i;
        load.shape[i] = GAP / n;
    }
    haft_model_parts parts = {.dofs = (size_t)n,
                              .energy_unit = k * GAP * GAP,
                              .gap = GAP,
                              .elements = (size_t)n,
                              .element = element,
                              .sites = (size_t)n,
                              .site = site,
                              .load = load};
    haft_model *model = NULL;
    haft_error error = {0};
    check_ok(haft_model_create(&model, &parts, &error), error);
    return model;
}

/* Gap at which A f' = k on the right wing's far side, and the load of one spring there. */
static double fold_load(const haft_law *law, double k, double *gap) {
    double c = k / (2 * AREA * law->f_max * law->a_right);
    double e = 2 * c / (1 + sqrt(1 - 4 * c));
    *gap = law->d_max - log(e) / law->a_right;
    return k * (GAP - *gap) + AREA * haft_law_evaluate(law, *gap).force;
}

static void sites_alike_snap_together(void **state) {
    (void)state;
    haft_law law[HAFT_SPAN];
    for (int i = 0; i < HAFT_SPAN; i++) {
        law[i] = make_law();
    }
    double k = 0.1 * AREA * law[0].f_max * law[0].a_right, gap;
    double single = fold_load(&law[0], k, &gap);
    haft_model *one = springs_apart(1, k);
    haft_path *alone = follow(one, law, 1.5 * single);
    for (int n = 2; n <= HAFT_SPAN; n++) {
        haft_model *model = springs_apart(n, k);
        haft_path *path = follow(model, law, 1.5 * n * single);
        assert_true(path->jumps >= 1);
        check_relative(path->jump[0].load, n * single, 1e-8);
        assert_int_equal(path->jump[0].sites_switched, alone->jump[0].sites_switched * n);
        check_relative(path->jump[0].dissipated, n * alone->jump[0].dissipated, 1e-6);
        assert_int_equal(path->jumps, alone->jumps);
        check_less(path->ledger_error, 1e-9);
        haft_path_destroy(&path);
        haft_model_destroy(&model);
    }
    haft_path_destroy(&alone);
    haft_model_destroy(&one);
}

/* A bar on a spring against sinking (u) and one against turning (v): gaps GAP (1 - u +- v), the
 * load on u. Upright, it sinks along P(u); it turns over where 2 A f' = k_v, which comes before the
 * fold, 2 A f' = k_u, if the spring against turning is the softer. */
static haft_model *bar(double k_sink, double k_turn, bool mirrored) {
    double unit = k_sink * GAP * GAP, way = mirrored ? -1 : 1;
    haft_element element[2] = {
        {.dof = {0, -1, -1, -1}, .mode = {{1}}, .stiffness = {1}, .mass = {1}},
        {.dof = {1, -1, -1, -1}, .mode = {{1}}, .stiffness = {k_turn / k_sink}, .mass = {1}}};
    haft_site site[2] = {{.x = 0, .area = AREA, .dof = {0, 1, -1, -1}, .shape = {GAP, -way * GAP}},
                         {.x = 1, .area = AREA, .dof = {0, 1, -1, -1}, .shape = {GAP, way * GAP}}};
    haft_model_parts parts = {.dofs = 2,
                              .energy_unit = unit,
                              .gap = GAP,
                              .elements = 2,
                              .element = element,
                              .sites = 2,
                              .site = site,
                              .load = {.dof = {0, -1, -1, -1}, .shape = {GAP}}};
    haft_model *model = NULL;
    haft_error error = {0};
    check_ok(haft_model_create(&model, &parts, &error), error);
    return model;
}

static void a_symmetric_pair_turns_over_by_rule(void **state) {
    (void)state;
    haft_law law[2] = {make_law(), make_law()};
    double k_turn = 0.1 * AREA * law[0].f_max * law[0].a_right, k_sink = 2 * k_turn, gap;
    fold_load(&law[0], k_turn / 2, &gap);
    double load = k_sink * (GAP - gap) + 2 * AREA * haft_law_evaluate(&law[0], gap).force;
    double final[2] = {0};
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        haft_model *model = bar(k_sink, k_turn, mirrored);
        haft_path *path = follow(model, law, 1.5 * load);
        assert_true(path->jumps >= 1);
        assert_int_equal(path->jump[0].departure, HAFT_DEPARTURE_BIFURCATION);
        check_relative(path->jump[0].load, load, 1e-7);
        assert_true(path->jump[0].dissipated > 0);
        assert_true(path->outcome == HAFT_OUTCOME_FREE || path->outcome == HAFT_OUTCOME_STUCK);
        check_less(path->ledger_error, 1e-9);
        for (size_t i = 0; i < path->points; i++) {
            if (path->point[i].jump == 0) { /* the first site closes, whichever it is */
                double d[2];
                haft_model_gaps(model, path->state + 2 * i, d);
                assert_true(d[0] < d[1]);
                final[mirrored] = d[0];
            }
        }
        haft_path_destroy(&path);
        haft_model_destroy(&model);
    }
    check_relative(final[1], final[0], 1e-9);
}

/* A spring barely softer than its law: both folds exist, ever closer, and both must be found. */
static void two_folds_about_to_vanish_are_found(void **state) {
    (void)state;
    haft_law law = make_law();
    for (double distance = 1e-2; distance > 0.9e-6; distance /= 10) {
        double k = (1 - distance) * AREA * law.f_max * law.a_right / 2, gap;
        double load = fold_load(&law, k, &gap);
        haft_model *model = springs_apart(1, k);
        haft_path *path = follow(model, &law, 1.2 * load);
        assert_int_equal(path->jumps, 2);
        check_relative(path->jump[0].load, load, 1e-10);
        assert_true(path->jump[0].kind == HAFT_JUMP_PULL_IN && path->jump[0].dissipated > 0);
        assert_true(path->jump[1].kind == HAFT_JUMP_PULL_OUT && path->jump[1].dissipated > 0);
        assert_true(path->jump[1].load < path->jump[0].load);
        check_less(path->ledger_error, 1e-10);
        haft_path_destroy(&path);
        haft_model_destroy(&model);
    }
    double k = (1 + 1e-6) * AREA * law.f_max * law.a_right / 2; /* and beyond there is none */
    haft_model *model = springs_apart(1, k);
    haft_path *path = follow(model, &law, k * GAP);
    assert_int_equal(path->jumps, 0);
    assert_int_equal(path->outcome, HAFT_OUTCOME_FREE);
    haft_path_destroy(&path);
    haft_model_destroy(&model);
}

/* Two springs apart whose folds' loads differ by ever less: shifting a law by s shifts its fold's
 * load by -k s, so both are known, and each must jump at its own. */
static void two_folds_side_by_side_are_told_apart(void **state) {
    (void)state;
    haft_law law[2] = {make_law(), make_law()};
    double k = 0.1 * AREA * law[0].f_max * law[0].a_right, gap;
    double single = fold_load(&law[0], k, &gap);
    haft_model *model = springs_apart(2, k);
    for (double apart = 1e-4; apart > 0.9e-10; apart /= 10) {
        double shift = -apart * single / k;
        law[1] = make_law();
        law[1].d_max += shift;
        law[1].wall_distance += shift;
        haft_path *path = follow(model, law, 3 * single);
        assert_true(path->jumps >= 2);
        for (int j = 0; j < 2; j++) {
            assert_int_equal(path->jump[j].site, j);
            assert_int_equal(path->jump[j].departure, HAFT_DEPARTURE_FOLD);
        }
        check_relative(path->jump[0].load, 2 * single, 1e-12);
        double between = path->jump[1].load - path->jump[0].load;
        check_near(between / (2 * single * apart), 1, 1e-12 / apart);
        check_less(path->ledger_error, 1e-9);
        haft_path_destroy(&path);
    }
    haft_model_destroy(&model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sites_alike_snap_together),
        cmocka_unit_test(a_symmetric_pair_turns_over_by_rule),
        cmocka_unit_test(two_folds_about_to_vanish_are_found),
        cmocka_unit_test(two_folds_side_by_side_are_told_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
