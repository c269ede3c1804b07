/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Long beams, whose solver freezes what lies behind the front of the contact, against the same
 * beams solved for all unknowns at every step: the same jumps, the same states. */
#include "random_beam.h"

static const haft_beam_spec LONG_BEAM = {1500e-6, 30e-6, 2.62e-6, 1.9e-6, 163e9};
static const double LIMIT = 4e-4; /* of the load [N] */

static haft_path *follow(const haft_model *model, const haft_law *law, bool whole_mesh) {
    haft_error error = {0};
    haft_programme programme = {-1, 0.01, LIMIT};
    haft_path *path = NULL;
    haft_path_options options = {.whole_mesh = whole_mesh};
    check_ok(haft_solve_path(&path, model, law, &programme, &options, &error), error);
    assert_int_equal(path->outcome, HAFT_OUTCOME_STUCK);
    check_less(path->ledger_error, 1e-10);
    return path;
}

/* Unknowns a factorization, as a share of all. */
static double moving(const haft_path *path, const haft_model *model) {
    return (double)path->cost.unknowns /
           ((double)path->cost.factorizations * (double)haft_model_get(model)->dofs);
}

typedef struct misses {
    double load, state, loss;
} misses;

static void compare(const haft_path *held, const haft_path *whole, size_t dofs, misses *worst) {
    assert_int_equal(held->jumps, whole->jumps);
    double lost = 0, loss = 0;
    for (size_t j = 0; j < whole->jumps; j++) {
        const haft_jump *a = &whole->jump[j], *b = &held->jump[j];
        assert_int_equal(b->site, a->site);
        assert_int_equal(b->kind, a->kind);
        assert_int_equal(b->sites_switched, a->sites_switched);
        worst->load = fmax(worst->load, fabs(b->load - a->load) / LIMIT);
        loss = fmax(loss, fabs(b->dissipated - a->dissipated));
        lost += a->dissipated;
    }
    worst->loss = fmax(worst->loss, loss / lost);
    for (size_t i = 0; i < dofs; i++) {
        worst->state = fmax(worst->state, fabs(held->final_state[i] - whole->final_state[i]));
    }
}

static void holding_changes_nothing(void **state) {
    (void)state;
    haft_error error = {0};
    const haft_mesh_spec meshes[] = {{HAFT_MESH_EXACT, 0, 3e-6, 60e-6, 0},
                                     {HAFT_MESH_UNIFORM, 15e-6, 3e-6, 60e-6, 0}};
    for (int kind = 0; kind < 2; kind++) {
        misses worst = {0};
        size_t jumps = 0;
        double most = 0;
        haft_model *model = NULL;
        check_ok(haft_model_create_beam(&model, &LONG_BEAM, &meshes[kind], &error), error);
        haft_law *law = haft_memory_alloc(haft_model_get(model)->sites, sizeof *law, &error);
        for (uint64_t seed = 61; seed <= 64; seed++) {
            random_beam_laws(model, seed, law);
            haft_path *held = follow(model, law, false), *whole = follow(model, law, true);
            check_near(moving(whole, model), 1, 1e-15);
            most = fmax(most, moving(held, model));
            compare(held, whole, haft_model_get(model)->dofs, &worst);
            jumps += held->jumps;
            haft_path_destroy(&held);
            haft_path_destroy(&whole);
        }
        print_message(
            "  %s mesh: %zu jumps, at most %.0f %% of the unknowns a factorization, loads "
            "within %.1e, losses %.1e, final states %.1e h\n",
            kind == 0 ? "exact" : "uniform", jumps, 100 * most, worst.load, worst.loss,
            worst.state);
        check_less(most, 0.7);
        assert_true(jumps > 40);
        check_less(worst.load, 1e-9);
        check_less(worst.loss, 1e-9);
        check_less(worst.state, 1e-8);
        haft_memory_free(law);
        haft_model_destroy(&model);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(holding_changes_nothing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
