/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Only what is needed: an active mesh gives what the exact one gives, says so when it began too
 * late, and a beam cut behind its crack gives the same crack as the whole one. */
#include "random_beam.h"

static random_beam make(uint64_t seed, double length, haft_mesh_kind kind, double active_from) {
    haft_beam_spec beam = random_beam_spec;
    beam.length = length;
    haft_mesh_spec mesh = {kind, 0, 3e-6, 60e-6, active_from};
    random_beam b = {NULL, NULL};
    haft_error error = {0};
    check_ok(haft_model_create_beam(&b.model, &beam, &mesh, &error), error);
    b.law = haft_memory_alloc(b.model->sites, sizeof *b.law, &error);
    random_beam_laws(b.model, seed, b.law);
    return b;
}

static void the_active_mesh_has_the_nodes_it_needs(void **state) {
    (void)state;
    random_beam b = make(1, 600e-6, HAFT_MESH_ACTIVE, 75e-6);
    assert_int_equal(b.model->sites, 200);
    assert_int_equal(b.model->inert, 25);              /* 1.5, 4.5, ..., 73.5 um */
    assert_int_equal(b.model->nodes, 1 + 1 + 175 + 1); /* clamp, load, sites, end */
    check_near(b.model->node_x[1], 60e-6, 1e-18);
    check_near(b.model->node_x[2], 76.5e-6, 1e-18);
    random_beam_destroy(&b);
}

static void the_active_mesh_gives_what_the_exact_one_gives(void **state) {
    (void)state;
    double worst_load = 0, worst_gap = 0;
    size_t jumps = 0;
    for (uint64_t seed = 1; seed <= 4; seed++) {
        random_beam whole = make(seed, 600e-6, HAFT_MESH_EXACT, 0);
        random_beam part = make(seed, 600e-6, HAFT_MESH_ACTIVE, 75e-6);
        haft_path *p = random_beam_cycle(&whole, (haft_path_options){0});
        haft_path *q = random_beam_cycle(&part, (haft_path_options){0});
        assert_int_equal(p->outcome, HAFT_OUTCOME_STUCK);
        assert_int_equal(q->outcome, HAFT_OUTCOME_STUCK);
        assert_int_equal(p->jumps, q->jumps);
        jumps += p->jumps;
        double peak = p->point[p->turn].load; /* near rest loads are differences of large forces */
        for (size_t j = 0; j < p->jumps; j++) {
            assert_int_equal(p->jump[j].site, q->jump[j].site);
            worst_load = fmax(worst_load, fabs(q->jump[j].load - p->jump[j].load) / peak);
        }
        for (size_t r = 0; r < whole.model->sites; r++) { /* the inert ones too: shape is exact */
            double miss = haft_model_displacement(&whole.model->site[r], p->final_state) -
                          haft_model_displacement(&part.model->site[r], q->final_state);
            worst_gap = fmax(worst_gap, fabs(miss));
        }
        haft_path_destroy(&p);
        haft_path_destroy(&q);
        random_beam_destroy(&whole);
        random_beam_destroy(&part);
    }
    print_message("  %zu jumps, loads within %.1e of the greatest, gaps within %.1e m\n", jumps,
                  worst_load, worst_gap);
    check_less(worst_load, 1e-9);
    check_less(worst_gap, 1e-8 * random_beam_spec.gap);
}

static void a_zone_that_begins_too_late_is_told(void **state) {
    (void)state;
    random_beam b = make(1, 600e-6, HAFT_MESH_ACTIVE, 300e-6);
    haft_path *path = random_beam_cycle(&b, (haft_path_options){0});
    assert_int_equal(path->outcome, HAFT_OUTCOME_ZONE_LEFT);
    assert_string_equal(haft_outcome_name(path->outcome), "active zone left");
    assert_true(path->points > 1); /* what was followed so far is kept */
    assert_true(isnan(path->end_influence));
    haft_path_destroy(&path);
    random_beam_destroy(&b);

    haft_error error = {0};
    haft_mesh_spec mesh = {HAFT_MESH_ACTIVE, 0, 3e-6, 60e-6, 600e-6};
    assert_int_equal(haft_model_create_beam(&b.model, &random_beam_spec, &mesh, &error),
                     HAFT_ERROR_INPUT);
    assert_non_null(strstr(error.message, "active zone"));
}

/* The tip sits at 227 to 246 um: 110 um behind it nothing is left of the end, 30 um behind it there
 * is, and the influence tells which is which. */
static void a_beam_cut_behind_its_crack_sticks_alike(void **state) {
    (void)state;
    static const struct {
        double length, most_influence, least_influence, crack;
    } cuts[] = {{900e-6, 1e-12, 0, 1e-13},
                {450e-6, 1e-7, 0, 1e-13},
                {360e-6, 1e-3, 0, 1e-12},
                {270e-6, 1, 1e-3, 1e-6}};
    for (uint64_t seed = 1; seed <= 3; seed++) {
        random_beam whole = make(seed, 600e-6, HAFT_MESH_ACTIVE, 75e-6);
        haft_path *p = random_beam_cycle(&whole, (haft_path_options){0});
        for (size_t k = 0; k < sizeof cuts / sizeof *cuts; k++) {
            random_beam cut = make(seed, cuts[k].length, HAFT_MESH_ACTIVE, 75e-6);
            haft_path *q = random_beam_cycle(&cut, (haft_path_options){0});
            double miss =
                q->point[q->points - 1].crack_length - p->point[p->points - 1].crack_length;
            print_message("  seed %d, cut to %.0f um: crack %.3f um, off by %.1e um, end's "
                          "influence %.1e\n",
                          (int)seed, 1e6 * cuts[k].length,
                          1e6 * q->point[q->points - 1].crack_length, 1e6 * miss, q->end_influence);
            assert_int_equal(q->outcome, HAFT_OUTCOME_STUCK);
            check_less(fabs(miss), cuts[k].crack);
            check_less(q->end_influence, cuts[k].most_influence);
            assert_true(q->end_influence >= cuts[k].least_influence);
            haft_path_destroy(&q);
            random_beam_destroy(&cut);
        }
        haft_path_destroy(&p);
        random_beam_destroy(&whole);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_active_mesh_has_the_nodes_it_needs),
        cmocka_unit_test(the_active_mesh_gives_what_the_exact_one_gives),
        cmocka_unit_test(a_zone_that_begins_too_late_is_told),
        cmocka_unit_test(a_beam_cut_behind_its_crack_sticks_alike),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
