/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names do not matter: a beam put together with its unknowns and its sites numbered backwards (so
 * another pivot order, and other ties) makes the same jumps and ends in the same state. */
#include "check.h"
#include "haft/solve.h"

static const haft_beam_spec BEAM = {600e-6, 30e-6, 2.62e-6, 1.9e-6, 163e9};

static void make_laws(const haft_model *model, uint64_t seed, haft_law *law) {
    for (size_t r = 0; r < haft_model_get(model)->sites; r++) {
        double z[4];
        haft_random_normals((haft_random_key){seed, HAFT_RANDOM_TEST}, 0, r, 0, 4, z);
        double d_max = 9.5e-9 + 0.35e-9 * z[2];
        haft_law_vector v = {7e-3 * exp(0.25 * z[0]), 3e6 * exp(0.15 * z[0] + 0.1 * z[1]), d_max,
                             d_max - 1.7e-9 * exp(0.1 * z[3])};
        assert_int_equal(haft_law_morse(&law[r], &v, 5e6), HAFT_LAW_SOUND);
    }
}

static void turn_dofs(int dof[HAFT_SPAN], size_t dofs) {
    for (int k = 0; k < HAFT_SPAN; k++) {
        dof[k] = dof[k] < 0 ? -1 : (int)dofs - 1 - dof[k];
    }
}

/* The same structure, its parts in reverse order. */
static haft_model *backwards(const haft_model *m) {
    const haft_model_data *data = haft_model_get(m);
    haft_error error = {0};
    haft_element *element = haft_memory_alloc(data->elements, sizeof *element, &error);
    haft_site *site = haft_memory_alloc(data->sites, sizeof *site, &error);
    haft_site load = data->load;
    turn_dofs(load.dof, data->dofs);
    for (size_t e = 0; e < data->elements; e++) {
        element[e] = data->element[data->elements - 1 - e];
        turn_dofs(element[e].dof, data->dofs);
    }
    for (size_t r = 0; r < data->sites; r++) {
        site[r] = data->site[data->sites - 1 - r];
        turn_dofs(site[r].dof, data->dofs);
    }
    haft_model_parts parts = {.dofs = data->dofs,
                              .energy_unit = data->energy_unit,
                              .gap = data->gap,
                              .elements = data->elements,
                              .element = element,
                              .sites = data->sites,
                              .site = site,
                              .load = load};
    haft_model *out = NULL;
    check_ok(haft_model_create(&out, &parts, &error), error);
    haft_memory_free(element);
    haft_memory_free(site);
    return out;
}

static haft_path *follow(const haft_model *model, const haft_law *law, double limit) {
    haft_error error = {0};
    haft_programme programme = {-1, 0.01, limit};
    haft_path *path = NULL;
    check_ok(haft_solve_path(&path, model, law, &programme, NULL, &error), error);
    assert_int_equal(path->outcome, HAFT_OUTCOME_STUCK);
    return path;
}

static void the_numbering_changes_nothing(void **state) {
    (void)state;
    size_t jumps = 0;
    double worst_load = 0, worst_state = 0;
    for (uint64_t seed = 41; seed <= 44; seed++) {
        haft_error error = {0};
        haft_mesh_spec mesh = {seed % 2 ? HAFT_MESH_UNIFORM : HAFT_MESH_EXACT, 15e-6, 3e-6, 60e-6,
                               0};
        haft_model *model = NULL;
        check_ok(haft_model_create_beam(&model, &BEAM, &mesh, &error), error);
        haft_model *turned = backwards(model);
        size_t n = haft_model_get(model)->dofs, sites = haft_model_get(model)->sites;
        haft_law *law = haft_memory_alloc(2 * sites, sizeof *law, &error);
        make_laws(model, seed, law);
        for (size_t r = 0; r < sites; r++) {
            law[sites + r] = law[sites - 1 - r];
        }
        double limit = 4e-4;
        haft_path *one = follow(model, law, limit), *other = follow(turned, law + sites, limit);
        assert_int_equal(one->jumps, other->jumps);
        for (size_t j = 0; j < one->jumps; j++) {
            const haft_jump *a = &one->jump[j], *b = &other->jump[j];
            assert_int_equal(a->site, (int)sites - 1 - b->site);
            assert_int_equal(a->kind, b->kind);
            assert_int_equal(a->phase, b->phase);
            assert_int_equal(a->sites_switched, b->sites_switched);
            check_near(b->load, a->load, 1e-9 * limit);
            check_relative(b->dissipated, a->dissipated, 1e-6);
            worst_load = fmax(worst_load, fabs(a->load - b->load) / limit);
        }
        for (size_t i = 0; i < n; i++) {
            double miss = fabs(one->final_state[i] - other->final_state[n - 1 - i]);
            check_less(miss, 1e-8);
            worst_state = fmax(worst_state, miss);
        }
        check_less(other->ledger_error, 1e-10);
        jumps += one->jumps;
        haft_path_destroy(&one), haft_path_destroy(&other);
        haft_memory_free(law);
        haft_model_destroy(&model), haft_model_destroy(&turned);
    }
    print_message("  %zu jumps, loads within %.1e, final states within %.1e\n", jumps, worst_load,
                  worst_state);
    assert_true(jumps > 40);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_numbering_changes_nothing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
