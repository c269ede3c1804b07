/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every choice a case offers runs whole: samplers, asperities, laws, meshes; stuck, free and with a
 * load limit. */
#include "program.h"

#include "haft/study.h"

/* Every accepted state of every realization is stable, and the path ends without load. */
static void check_paths(const case_folder *c, haft_outcome outcome) {
    char path[400];
    haft_error error = {0};
    haft_results_view *view = NULL;
    path_in(c, "out/results.h5", path);
    check_ok(haft_results_read(&view, path, &error), error);
    for (size_t k = 0; k < view->realizations; k++) {
        haft_path *p = NULL;
        check_ok(haft_results_read_path(&p, path, k, &error), error);
        assert_int_equal(view->summary[k].outcome, outcome);
        assert_int_equal(p->outcome, outcome);
        assert_true(p->points > 20 && p->turn > 0 && p->turn < p->points - 1);
        for (size_t i = 0; i < p->points; i++) {
            assert_true(p->point[i].lambda_min > 0 && p->point[i].least_pivot > 0);
        }
        for (size_t j = 0; j < p->jumps; j++) {
            assert_true(p->jump[j].dissipated > 0);
        }
        assert_true(p->point[p->points - 1].load == 0);
        haft_path_destroy(&p);
    }
    haft_results_view_destroy(&view);
}

static void run_whole(const edit *edits, haft_outcome outcome) {
    case_folder c = case_create(edits);
    ran r = run_expect(0, HAFT, ARGS("run", "--json", c.path));
    check_less(json_number(r.out, "ledger_error"), 1e-9);
    assert_true(json_number(r.out, "failed") == 0);
    bool is_free = outcome == HAFT_OUTCOME_FREE;
    assert_true(json_number(r.out, is_free ? "free" : "stuck") == 2);
    assert_true(isnan(json_number(r.out, "crack_length_mean_m")) == is_free);
    ran_free(&r);
    check_paths(&c, outcome);
    case_remove(&c);
}

static void every_choice_runs_whole(void **state) {
    (void)state;
    const edit patches = {"sampler: explicit", "sampler: patches"},
               summits = {"asperities: islands", "asperities: summits"},
               fitted = {"asperities: islands", "asperities: fitted_islands"},
               table = {"kind: morse", "kind: table"}, exact = {"mesh: uniform", "mesh: exact"},
               gap = {"contact:",
                      "contact:\n  dispersion: {hamaker: 18.65e-20 J, reach: 200 nm, oxide: "
                      "{thickness: 2 nm, hamaker: 6.5e-20 J}}"};
    const edit variants[][5] = {
        {patches},
        {summits},
        {table},
        {fitted},
        {exact},
        {patches, summits},
        {summits, exact},
        {table, patches},
        {table, exact},
        {patches, summits, table, exact},
        {gap},
        {gap, table, exact},
    };
    for (size_t i = 0; i < sizeof variants / sizeof *variants; i++) {
        run_whole(variants[i], HAFT_OUTCOME_STUCK);
    }
}

static void a_beam_that_lets_go_is_a_result(void **state) {
    (void)state;
    run_whole((edit[]){{"thickness: 1 um", "thickness: 10 um"}, {NULL, NULL}}, HAFT_OUTCOME_FREE);
}

/* Dry, with nothing that pulls: no curve has a Morse law, the tables push alone. */
static void a_dry_beam_without_adhesion_comes_back(void **state) {
    (void)state;
    run_whole((edit[]){{"  capillary:\n"
                        "    humidity: 85 %\n"
                        "    temperature: 300 K\n"
                        "    surface_energy: 72 mN/m\n"
                        "    molar_volume: 18 cm^3/mol\n"
                        "    contact_angles: [0 deg, 0 deg]\n",
                        ""},
                       {NULL, NULL}},
              HAFT_OUTCOME_FREE);
}

/* A limit far below what brings the beam down: it comes back without a jump. */
static void a_load_limit_ends_the_loading(void **state) {
    (void)state;
    case_folder c = case_create((edit[]){
        {"  crack_threshold: 1 %", "  limit: 1 nN\n  crack_threshold: 1 %"}, {NULL, NULL}});
    ran r = run_expect(0, HAFT, ARGS("run", "--json", c.path));
    assert_true(json_number(r.out, "free") == 2 && json_number(r.out, "jumps_per_beam") == 0);
    ran_free(&r);
    r = run_expect(0, HAFT, ARGS("info", c.path));
    check_says(r.out, "2 run, 0 stuck, 2 free, 0 failed");
    ran_free(&r);
    case_remove(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_choice_runs_whole),
        cmocka_unit_test(a_beam_that_lets_go_is_a_result),
        cmocka_unit_test(a_dry_beam_without_adhesion_comes_back),
        cmocka_unit_test(a_load_limit_ends_the_loading),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
