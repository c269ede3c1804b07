/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The same law everywhere, where scatter breaks no tie: the crack closes in loading and opens in
 * unloading, two exact meshes agree, and where the load turned is forgotten once the crack has
 * opened past it. Then structures that cannot snap: no jump, and a cycle that loses nothing. */
#include "check.h"
#include "from_rest.h"
#include "haft/solve.h"

static const haft_beam_spec BEAM = {600e-6, 30e-6, 2.62e-6, 1.9e-6, 163e9};

typedef struct scene {
    haft_model *model;
    haft_law *law;
} scene;

static scene make_scene(const haft_beam_spec *beam, haft_mesh_spec mesh, haft_law_vector v,
                        double f_limit) {
    scene s = {0};
    haft_error error = {0};
    check_ok(haft_model_create_beam(&s.model, beam, &mesh, &error), error);
    s.law = haft_memory_alloc(haft_model_get(s.model)->sites, sizeof *s.law, &error);
    for (size_t r = 0; r < haft_model_get(s.model)->sites; r++) {
        assert_int_equal(haft_law_morse(&s.law[r], &v, f_limit), HAFT_LAW_SOUND);
    }
    return s;
}

static haft_path *follow(const scene *s, double crack, double limit) {
    haft_error error = {0};
    haft_programme programme = {crack, 0.01, limit};
    haft_path_options options = {.keep_states = true};
    haft_path *path = NULL;
    check_ok(haft_solve_path(&path, s->model, s->law, &programme, &options, &error), error);
    check_less(path->ledger_error, 1e-10);
    return path;
}

static void drop(scene *s) {
    haft_memory_free(s->law);
    haft_model_destroy(&s->model);
}

static void check_monotone(const haft_path *path) {
    for (size_t i = 1; i < path->points; i++) {
        const haft_path_point *a = &path->point[i - 1], *b = &path->point[i];
        double slack = 1e-9 * a->crack_length;
        if (b->phase == 0) {
            assert_true(b->crack_length <= a->crack_length + slack);
        } else {
            assert_true(b->crack_length >= a->crack_length - slack);
        }
        assert_true(b->dissipated >= a->dissipated);
    }
}

static void a_uniform_law_closes_and_opens_the_crack(void **state) {
    (void)state;
    /* sites at odd multiples of 3 um: nodes of both meshes, each the exact discretisation */
    static const haft_mesh_spec mesh[2] = {{HAFT_MESH_EXACT, 0, 6e-6, 60e-6, 0},
                                           {HAFT_MESH_UNIFORM, 3e-6, 6e-6, 60e-6, 0}};
    static const haft_law_vector laws[2] = {{7e-3, 3e6, 9.5e-9, 7.8e-9}, {7e-3, 2e5, 25e-9, 10e-9}};
    for (int l = 0; l < 2; l++) {
        haft_path *path[3];
        scene s[2];
        for (int m = 0; m < 2; m++) {
            s[m] = make_scene(&BEAM, mesh[m], laws[l], 5e6);
            path[m] = follow(&s[m], 120e-6, INFINITY);
            assert_int_equal(path[m]->outcome, HAFT_OUTCOME_STUCK);
            check_monotone(path[m]);
        }
        double top = path[0]->point[path[0]->turn].load, worst = 0;
        assert_int_equal(path[0]->jumps, path[1]->jumps);
        for (size_t j = 0; j < path[0]->jumps; j++) {
            assert_int_equal(path[0]->jump[j].site, path[1]->jump[j].site);
            check_near(path[1]->jump[j].load, path[0]->jump[j].load, 1e-9 * top);
            worst = fmax(worst, fabs(path[1]->jump[j].load - path[0]->jump[j].load) / top);
        }
        double crack = path[0]->point[path[0]->points - 1].crack_length;
        check_relative(path[1]->point[path[1]->points - 1].crack_length, crack, 1e-9);
        path[2] = follow(&s[0], 150e-6, INFINITY); /* turned earlier, ends the same */
        check_relative(path[2]->point[path[2]->points - 1].crack_length, crack, 1e-9);
        print_message("  pull %.0e Pa: %zu jumps, meshes within %.1e, crack %.3f um (Griffith "
                      "%.3f), ledger %.1e\n",
                      laws[l].f_max, path[0]->jumps, worst, crack * 1e6,
                      haft_beam_equilibrium_crack(&BEAM, laws[l].e) * 1e6, path[0]->ledger_error);
        for (int m = 0; m < 3; m++) {
            haft_path_destroy(&path[m]);
        }
        drop(&s[0]), drop(&s[1]);
    }
}

/* Loads and unloads; the way back is the way forth. */
static void check_reversible(const scene *s, double limit, const char *what) {
    const haft_model_data *m = haft_model_get(s->model);
    haft_path *path = follow(s, -1, limit);
    assert_int_equal(path->jumps, jumps_from_rest(path));
    assert_true(path->turned_by_load);
    haft_path_point first = path->point[0], end = path->point[path->points - 1];
    double work = path->point[path->turn].work;
    assert_true(end.dissipated == first.dissipated && end.load == 0);
    print_message("  %s: %zu points, cycle closed to %.1e, gap at the tip %.3g nm at the turn\n",
                  what, path->points, fabs(end.work / work),
                  1e9 * (m->gap - haft_model_displacement(&m->site[m->sites - 1],
                                                          path->state + path->turn * m->dofs)));
    check_near(end.work / work, 0, 1e-10);
    check_near((end.internal_energy - first.internal_energy) / work, 0, 1e-10);
    for (size_t i = 0; i < m->dofs; i++) {
        check_near(path->final_state[i], path->state[i], 1e-9);
    }
    haft_path_destroy(&path);
}

static void what_cannot_snap_does_not(void **state) {
    (void)state;
    /* a block of a beam: its softest mode, EI (1.875/L)^4 / w, outweighs the law's slope */
    haft_beam_spec block = {60e-6, 30e-6, 20e-6, 0.7e-6, 163e9};
    haft_mesh_spec fine = {HAFT_MESH_UNIFORM, 3e-6, 6e-6, 60e-6, 0};
    haft_law_vector soft = {7e-3, 1.75e5, 25e-9, 5e-9};
    scene s = make_scene(&block, fine, soft, 1e6);
    double mode = haft_beam_bending_stiffness(&block) * pow(1.8751 / block.length, 4) / block.width;
    assert_true(mode > 0.5 * soft.f_max * s.law[0].a_right);
    check_reversible(&s, 0.15, "a stiff short beam");
    drop(&s);
    /* pulls that are felt from the first */
    block.gap = 0.1e-6;
    s = make_scene(&block, fine, soft, 1e6);
    check_reversible(&s, 0.1, "a stiff short beam in reach");
    drop(&s);
    /* long-ranged laws under the long beam */
    haft_mesh_spec mesh = {HAFT_MESH_UNIFORM, 30e-6, 6e-6, 300e-6, 0};
    haft_law_vector faint = {10e-6, 10, 100e-9, 20e-9};
    s = make_scene(&BEAM, mesh, faint, 1e4);
    mode = haft_beam_bending_stiffness(&BEAM) * pow(1.8751 / BEAM.length, 4) / BEAM.width;
    assert_true(mode > 0.5 * faint.f_max * s.law[0].a_right);
    check_reversible(&s, 1e-6, "long-ranged laws");
    drop(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_uniform_law_closes_and_opens_the_crack),
        cmocka_unit_test(what_cannot_snap_does_not),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
