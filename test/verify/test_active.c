/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Only what is needed: an active mesh, and the shorter ones it comes with, give what the exact one
 * gives; it says so when it began too late, and a beam cut behind its crack gives the same crack as
 * the whole one. */
#include "random_beam.h"

static random_beam make(uint64_t seed, double length, haft_mesh_kind kind, double active_from) {
    haft_beam_spec beam = random_beam_spec;
    beam.length = length;
    haft_mesh_spec mesh = {kind, 0, 3e-6, 60e-6, active_from};
    random_beam b = {NULL, NULL};
    haft_error error = {0};
    check_ok(haft_model_create_beam(&b.model, &beam, &mesh, &error), error);
    b.law = haft_memory_alloc(haft_model_get(b.model)->sites, sizeof *b.law, &error);
    random_beam_laws(b.model, seed, b.law);
    return b;
}

static void the_active_mesh_has_the_nodes_it_needs(void **state) {
    (void)state;
    random_beam b = make(1, 600e-6, HAFT_MESH_ACTIVE, 75e-6);
    assert_int_equal(haft_model_get(b.model)->sites, 200);
    assert_int_equal(haft_model_get(b.model)->inert, 25);              /* 1.5, 4.5, ..., 73.5 um */
    assert_int_equal(haft_model_get(b.model)->nodes, 1 + 1 + 175 + 1); /* clamp, load, sites, end */
    check_near(haft_model_get(b.model)->node_x[1], 60e-6, 1e-18);
    check_near(haft_model_get(b.model)->node_x[2], 76.5e-6, 1e-18);
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
        for (size_t r = 0; r < haft_model_get(whole.model)->sites;
             r++) { /* the inert ones too: shape is exact */
            double miss =
                haft_model_displacement(&haft_model_get(whole.model)->site[r], p->final_state) -
                haft_model_displacement(&haft_model_get(part.model)->site[r], q->final_state);
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

static double distance_between(const haft_model *a, const double *u, const haft_model *b,
                               const double *v) {
    double most = 0;
    for (size_t r = 0; r < haft_model_get(a)->sites; r++) {
        most = fmax(most, fabs(haft_model_displacement(&haft_model_get(a)->site[r], u) -
                               haft_model_displacement(&haft_model_get(b)->site[r], v)));
    }
    return most;
}

/* How many sites from the first on are where their laws are nil. */
static size_t clear_sites(const haft_model *m, const haft_law *law, const double *u) {
    const haft_model_data *data = haft_model_get(m);
    size_t r = 0;
    while (r < data->sites && data->gap - haft_model_displacement(&data->site[r], u) >
                                  haft_law_reach(&law[r], 1e-16)) {
        r++;
    }
    return r;
}

typedef struct balance {
    haft_energy energy;
    double residual; /* relative to the greatest force */
} balance;

static balance weigh(const random_beam *b, const haft_model *m, const double *u, double load) {
    const haft_model_data *data = haft_model_get(m);
    haft_error error = {0};
    haft_law_rows *rows = NULL;
    check_ok(haft_law_rows_create(&rows, data->sites, b->law, &error), error);
    double *gradient = haft_memory_alloc(data->dofs, sizeof *gradient, &error), scale = 0;
    balance x = {haft_model_evaluate(m, rows, u, load, gradient, NULL, &scale, NULL, NULL), 0};
    for (size_t i = 0; i < data->dofs; i++) {
        x.residual = fmax(x.residual, fabs(gradient[i]) / scale);
    }
    haft_law_rows_destroy(&rows);
    haft_memory_free(gradient);
    return x;
}

/* States followed on the exact mesh, on each shorter one that leaves out only what is out of reach:
 * in equilibrium there too, with the same energy, and the same when they come back. */
static void states_are_the_same_on_shorter_meshes(void **state) {
    (void)state;
    random_beam whole = make(1, 600e-6, HAFT_MESH_EXACT, 0);
    random_beam part = make(1, 600e-6, HAFT_MESH_ACTIVE, 75e-6);
    haft_path *p = random_beam_cycle(&whole, (haft_path_options){.keep_states = true});
    haft_error error = {0};
    double *u = haft_memory_alloc(haft_model_get(whole.model)->dofs, sizeof *u, &error);
    double *back = haft_memory_alloc(haft_model_get(whole.model)->dofs, sizeof *back, &error);
    double way = 0, returned = 0, energy = 0, residual = 0;
    size_t compared = 0, meshes = 0;
    for (const haft_model *m = part.model; m != NULL; m = haft_model_shorter(m), meshes++) {
        assert_int_equal(haft_model_get(m)->sites, 200);
        for (size_t i = 0; i < p->points; i += 2) {
            const double *v = p->state + i * haft_model_get(whole.model)->dofs;
            if (clear_sites(whole.model, whole.law, v) < haft_model_get(m)->inert) {
                continue;
            }
            haft_model_carry(whole.model, m, v, u);
            haft_model_carry(m, whole.model, u, back);
            way = fmax(way, distance_between(whole.model, v, m, u));
            returned = fmax(returned, distance_between(whole.model, v, whole.model, back));
            balance a = weigh(&whole, whole.model, v, p->point[i].load);
            balance b = weigh(&whole, m, u, p->point[i].load);
            double size = fabs(a.energy.strain) + fabs(a.energy.contact);
            energy = fmax(energy, fabs(a.energy.strain + a.energy.contact - b.energy.strain -
                                       b.energy.contact) /
                                      (size > 0 ? size : 1));
            residual = fmax(residual, b.residual);
            compared++;
        }
    }
    print_message("  %zu states on %zu meshes: gaps within %.1e m, %.1e m back again; energies "
                  "%.1e, forces %.1e\n",
                  compared, meshes, way, returned, energy, residual);
    assert_true(meshes > 10 && compared > 150);
    check_less(way, 1e-13 * random_beam_spec.gap);
    check_less(returned, 1e-13 * random_beam_spec.gap);
    check_less(energy, 1e-10);
    check_less(residual, 1e-8); /* what rounding of u is worth in elements of 3 um */
    haft_memory_free(u);
    haft_memory_free(back);
    haft_path_destroy(&p);
    random_beam_destroy(&whole);
    random_beam_destroy(&part);
}

/* What the solver follows on shorter meshes is in equilibrium on the exact one: every state, in
 * long beams whose contact opens and closes from one end to the other, over laws down to a
 * thousandth. */
static void no_force_is_missed_on_the_way(void **state) {
    (void)state;
    for (int k = 0; k < 3; k++) {
        double share = pow(0.03, k), residual = 0;
        random_beam whole = make(7, 1200e-6, HAFT_MESH_EXACT, 0);
        random_beam part = make(7, 1200e-6, HAFT_MESH_ACTIVE, 75e-6);
        for (size_t r = 0; r < haft_model_get(part.model)->sites; r++) {
            haft_law_vector v = haft_law_morse_vector(&part.law[r]);
            v.e *= share;
            v.f_max *= share;
            assert_int_equal(haft_law_morse(&part.law[r], &v, 5e6 * share), HAFT_LAW_SOUND);
            whole.law[r] = part.law[r];
        }
        haft_path *p = random_beam_cycle(&part, (haft_path_options){.keep_states = true});
        haft_path *q = random_beam_cycle(&whole, (haft_path_options){0});
        haft_path *all = random_beam_cycle(&part, (haft_path_options){.whole_mesh = true});
        haft_error error = {0};
        double *u = haft_memory_alloc(haft_model_get(whole.model)->dofs, sizeof *u, &error);
        for (size_t i = 0; i < p->points; i++) {
            haft_model_carry(part.model, whole.model,
                             p->state + i * haft_model_get(part.model)->dofs, u);
            residual = fmax(residual, weigh(&whole, whole.model, u, p->point[i].load).residual);
        }
        double used = (double)p->cost.unknowns / (double)p->cost.factorizations;
        print_message("  laws of %.1e: %zu states, %zu jumps, %s with a crack of %.1f um; forces "
                      "%.1e, %.0f unknowns of %zu in use\n",
                      share, p->points, p->jumps, haft_outcome_name(p->outcome),
                      1e6 * p->point[p->points - 1].crack_length, residual, used,
                      haft_model_get(whole.model)->dofs);
        assert_int_equal(p->outcome, q->outcome);
        assert_int_equal(p->jumps, q->jumps);
        check_near(p->point[p->points - 1].crack_length, q->point[q->points - 1].crack_length,
                   1e-12);
        assert_int_equal(p->jumps, all->jumps);
        check_near(p->point[p->points - 1].crack_length, all->point[all->points - 1].crack_length,
                   1e-12);
        assert_int_equal(all->cost.unknowns,
                         all->cost.factorizations * haft_model_get(part.model)->dofs);
        check_less(residual, 1e-8);
        check_less(used, 0.8 * (double)haft_model_get(whole.model)->dofs);
        haft_memory_free(u);
        haft_path_destroy(&p);
        haft_path_destroy(&q);
        haft_path_destroy(&all);
        random_beam_destroy(&whole);
        random_beam_destroy(&part);
    }
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
        cmocka_unit_test(states_are_the_same_on_shorter_meshes),
        cmocka_unit_test(no_force_is_missed_on_the_way),
        cmocka_unit_test(a_zone_that_begins_too_late_is_told),
        cmocka_unit_test(a_beam_cut_behind_its_crack_sticks_alike),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
