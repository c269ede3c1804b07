/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whole load cycles of beams over random laws: the ledger, the certificates checked by an
 * independent dense factorization, equilibrium, independence of the step, and Griffith's limit. */
#include "evaluate.h"
#include "haft/solve.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>

static const haft_beam_spec BEAM = {600e-6, 30e-6, 2.62e-6, 1.9e-6, 163e9};
static const haft_programme PROGRAMME = {120e-6, 0.01, INFINITY};

typedef struct scene {
    haft_model *model;
    haft_law *law;
} scene;

/* A beam of 200 sites whose laws scatter as measured ones do. */
static scene make_scene(uint64_t seed, haft_mesh_kind kind) {
    scene s = {0};
    haft_error error = {0};
    haft_mesh_spec mesh = {kind, 15e-6, 3e-6, 60e-6, 0};
    check_ok(haft_model_create_beam(&s.model, &BEAM, &mesh, &error), error);
    s.law = haft_memory_alloc(haft_model_get(s.model)->sites, sizeof *s.law, &error);
    for (size_t r = 0; r < haft_model_get(s.model)->sites; r++) {
        double z[4];
        haft_random_normals((haft_random_key){seed, HAFT_RANDOM_TEST}, 0, r, 0, 4, z);
        double d_max = 9.5e-9 + 0.35e-9 * z[2];
        haft_law_vector v = {7e-3 * exp(0.25 * z[0]), 3e6 * exp(0.15 * z[0] + 0.1 * z[1]), d_max,
                             d_max - 1.7e-9 * exp(0.1 * z[3])};
        assert_int_equal(haft_law_morse(&s.law[r], &v, 5e6), HAFT_LAW_SOUND);
    }
    return s;
}

static void drop_scene(scene *s) {
    haft_memory_free(s->law);
    haft_model_destroy(&s->model);
}

static haft_path *cycle(const scene *s, haft_path_options options) {
    haft_error error = {0};
    haft_path *path = NULL;
    check_ok(haft_solve_path(&path, s->model, s->law, &PROGRAMME, &options, &error), error);
    assert_int_equal(path->outcome, HAFT_OUTCOME_STUCK);
    return path;
}

/* GSL's dense Cholesky fails on anything but a positive definite matrix. */
static bool is_definite(const scene *s, const double *u, double load, double *defect) {
    const haft_model_data *m = haft_model_get(s->model);
    size_t n = m->dofs;
    double *g = haft_memory_alloc(n, sizeof *g, NULL);
    double *h = haft_memory_alloc(m->nonzeros, sizeof *h, NULL);
    double force = 0;
    evaluate(s->model, s->law, u, load, g, h, &force);
    gsl_matrix *dense = gsl_matrix_calloc(n, n);
    *defect = 0;
    for (size_t j = 0; j < n; j++) {
        *defect = fmax(*defect, fabs(g[j]) / force);
        for (int k = m->column[j]; k < m->column[j + 1]; k++) {
            gsl_matrix_set(dense, (size_t)m->row[k], j, h[k]);
        }
    }
    bool definite = gsl_linalg_cholesky_decomp1(dense) == GSL_SUCCESS;
    gsl_matrix_free(dense);
    haft_memory_free(g);
    haft_memory_free(h);
    return definite;
}

static void every_accepted_state_is_a_stable_equilibrium(void **state) {
    (void)state;
    gsl_error_handler_t *old = gsl_set_error_handler_off();
    scene s = make_scene(1, HAFT_MESH_UNIFORM);
    haft_path *path = cycle(&s, (haft_path_options){.keep_states = true});
    for (size_t i = 0; i < path->points; i++) {
        double defect;
        assert_true(is_definite(&s, path->state + i * haft_model_get(s.model)->dofs,
                                path->point[i].load, &defect));
        check_less(defect, 1e-10);
        assert_true(path->point[i].lambda_min > 0 && path->point[i].least_pivot > 0);
    }
    /* and the check can fail: the same beam, its tip brought into the laws' softening range */
    double *u = haft_memory_alloc(haft_model_get(s.model)->dofs, sizeof *u, NULL), defect;
    for (size_t k = 0; k < haft_model_get(s.model)->dofs; k += 2) {
        u[k] = 1 - 10.5e-9 / BEAM.gap;
    }
    assert_false(is_definite(&s, u, 0, &defect));
    haft_memory_free(u);
    haft_path_destroy(&path);
    drop_scene(&s);
    gsl_set_error_handler(old);
}

static void the_ledger_closes_on_random_beams(void **state) {
    (void)state;
    size_t jumps = 0;
    for (uint64_t seed = 1; seed <= 12; seed++) {
        scene s = make_scene(seed, seed % 4 == 0 ? HAFT_MESH_EXACT : HAFT_MESH_UNIFORM);
        haft_path *path = cycle(&s, (haft_path_options){0});
        check_less(path->ledger_error, 1e-10);
        double lost = 0;
        for (size_t j = 0; j < path->jumps; j++) {
            assert_true(path->jump[j].dissipated > 0);
            lost += path->jump[j].dissipated;
        }
        haft_path_point end = path->point[path->points - 1];
        check_relative(end.dissipated, lost, 1e-12);
        assert_true(end.load == 0);
        haft_path_point turn = path->point[path->turn];
        assert_true(turn.crack_length <= PROGRAMME.crack_length * (1 + 1e-9));
        jumps += path->jumps;
        haft_path_destroy(&path);
        drop_scene(&s);
    }
    assert_true(jumps > 100); /* these beams do snap */
}

/* The same jumps and the same end, whatever the size of the steps, their tolerances and the linear
 * solver. */
static void the_answer_does_not_depend_on_the_step(void **state) {
    (void)state;
    static const haft_path_options variants[] = {
        {.gap_step = 0.05},
        {.gap_step = 5},
        {.ledger_tolerance = 1e-12, .residual_tolerance = 1e-13},
        {.flow_step = 0.002},
        {.linear_solver = HAFT_LINEAR_SOLVER_KLU},
        {.linear_solver = HAFT_LINEAR_SOLVER_BAND},
    };
    for (uint64_t seed = 21; seed <= 24; seed++) {
        scene s = make_scene(seed, HAFT_MESH_UNIFORM);
        haft_path *path = cycle(&s, (haft_path_options){0});
        for (size_t v = 0; v < sizeof variants / sizeof *variants; v++) {
            haft_path *other = cycle(&s, variants[v]);
            assert_int_equal(other->jumps, path->jumps);
            for (size_t j = 0; j < path->jumps; j++) {
                assert_int_equal(other->jump[j].site, path->jump[j].site);
                check_near(other->jump[j].load, path->jump[j].load, 1e-9 * path->jump[0].load);
                check_relative(other->jump[j].dissipated, path->jump[j].dissipated, 1e-6);
            }
            for (size_t i = 0; i < haft_model_get(s.model)->dofs; i++) {
                check_near(other->final_state[i], path->final_state[i], 1e-8);
            }
            haft_path_destroy(&other);
        }
        haft_path_destroy(&path);
        drop_scene(&s);
    }
}

/* Laws whose energies scatter by e^1.5 and their zeros by 1.5 nm; those that no Morse law has are
 * plain. */
static void scatter_widely(haft_law *law, size_t sites, uint64_t seed) {
    for (size_t r = 0; r < sites; r++) {
        double z[4];
        haft_random_normals((haft_random_key){seed, HAFT_RANDOM_TEST}, 0, r, 0, 4, z);
        double d_max = 11e-9 + 1.5e-9 * z[2];
        double e = 3e-5 * exp(1.5 * z[0]), range = 1e-9 * exp(0.5 * z[3]);
        haft_law_vector v = {e, e / (2 * range) * exp(0.1 * z[1]), d_max, d_max - 0.4 * range};
        haft_law_vector plain = {3e-5, 1.5e4, d_max, d_max - 0.4e-9};
        if (haft_law_morse(&law[r], &v, 5e6) != HAFT_LAW_SOUND) {
            assert_int_equal(haft_law_morse(&law[r], &plain, 5e6), HAFT_LAW_SOUND);
        }
    }
}

/* From jump to jump the load only grows in loading and only falls in unloading, to its rounding: a
 * step that met a kink by a gap which turned on the way would go back. These beams have such gaps,
 * and long steps look that far. */
static void the_load_never_goes_back(void **state) {
    (void)state;
    static const uint64_t seeds[] = {17, 26, 36};
    haft_beam_spec beam = BEAM;
    beam.length = 900e-6;
    haft_mesh_spec mesh = {HAFT_MESH_ACTIVE, 0, 3e-6, 60e-6, 150e-6};
    haft_programme programme = {300e-6, 0.01, INFINITY};
    for (size_t k = 0; k < sizeof seeds / sizeof *seeds; k++) {
        haft_error error = {0};
        scene s = {0};
        check_ok(haft_model_create_beam(&s.model, &beam, &mesh, &error), error);
        s.law = haft_memory_alloc(haft_model_get(s.model)->sites, sizeof *s.law, &error);
        scatter_widely(s.law, haft_model_get(s.model)->sites, seeds[k]);
        haft_path *path = NULL;
        check_ok(haft_solve_path(&path, s.model, s.law, &programme,
                                 &(haft_path_options){.gap_step = 1}, &error),
                 error);
        assert_int_equal(path->outcome, HAFT_OUTCOME_STUCK);
        for (size_t i = 1; i < path->points; i++) {
            haft_path_point a = path->point[i - 1], b = path->point[i];
            double sign = b.phase == 0 ? 1 : -1;
            assert_true(a.phase != b.phase || sign * (b.load - a.load) >= -1e-12 * a.load);
        }
        haft_path_destroy(&path);
        drop_scene(&s);
    }
}

/* A uniform law of energy e whose range goes to zero: unloaded, the crack is Griffith's (Eq. 36).
 * The tip's zone, over which the pull acts, is as long as (EI range / (width f_max))^(1/4), which
 * at fixed energy is range^(1/2): so the error must fall with that order. */
static void a_short_range_gives_griffiths_crack(void **state) {
    (void)state;
    haft_error error = {0};
    haft_mesh_spec mesh = {HAFT_MESH_EXACT, 0, 1e-6, 60e-6, 0};
    haft_model *model = NULL;
    check_ok(haft_model_create_beam(&model, &BEAM, &mesh, &error), error);
    haft_law *law = haft_memory_alloc(haft_model_get(model)->sites, sizeof *law, &error);
    double e = 7e-3, griffith = haft_beam_equilibrium_crack(&BEAM, e), last = 0;
    for (double range = 32e-9; range > 1.9e-9; range /= 4) {
        haft_law_vector v = {e, e / (2 * range), range, 0.4 * range};
        haft_law one;
        assert_int_equal(haft_law_morse(&one, &v, v.f_max), HAFT_LAW_SOUND);
        for (size_t r = 0; r < haft_model_get(model)->sites; r++) {
            law[r] = one;
        }
        haft_path *path = NULL;
        haft_programme programme = {griffith - 40e-6, 0.01, INFINITY};
        check_ok(haft_solve_path(&path, model, law, &programme, NULL, &error), error);
        assert_int_equal(path->outcome, HAFT_OUTCOME_STUCK);
        double miss = fabs(path->point[path->points - 1].crack_length / griffith - 1);
        print_message("  range %5.1f nm: crack %.3f um, Griffith %.3f um, %.3f %% off\n",
                      range * 1e9, path->point[path->points - 1].crack_length * 1e6, griffith * 1e6,
                      100 * miss);
        if (last > 0) {
            check_near(log(last / miss) / log(4), 0.5, 0.06);
        }
        last = miss;
        haft_path_destroy(&path);
    }
    haft_memory_free(law);
    haft_model_destroy(&model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_accepted_state_is_a_stable_equilibrium),
        cmocka_unit_test(the_ledger_closes_on_random_beams),
        cmocka_unit_test(the_answer_does_not_depend_on_the_step),
        cmocka_unit_test(the_load_never_goes_back),
        cmocka_unit_test(a_short_range_gives_griffiths_crack),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
