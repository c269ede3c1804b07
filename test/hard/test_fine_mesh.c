/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Digits and fine meshes. A beam of 1500 um in elements of 15, 5, 1.5 and 0.5 um: the matrix's
 * condition grows like h^-4, and a bare factorization keeps two digits at the finest (6000
 * unknowns). Yet every mesh that has its sites and its load on nodes is the exact discretisation,
 * so that all must follow one and the same path, and, out of reach, the closed form. */
#include "evaluate.h"
#include "haft/solve.h"

#include <time.h>

static const haft_beam_spec BEAM = {1500e-6, 30e-6, 2.62e-6, 1.9e-6, 163e9};
static const double ELEMENT[] = {15e-6, 5e-6, 1.5e-6, 0.5e-6};
enum { MESHES = sizeof ELEMENT / sizeof *ELEMENT };

static haft_model *make_beam(double element) {
    haft_error error = {0};
    /* patches of 30 um: sites at odd multiples of 15 um, nodes of each of the meshes */
    haft_mesh_spec mesh = {HAFT_MESH_UNIFORM, element, 30e-6, 60e-6, 0};
    haft_model *model = NULL;
    check_ok(haft_model_create_beam(&model, &BEAM, &mesh, &error), error);
    return model;
}

static haft_path *follow(const haft_model *model, const haft_law *law, double crack, double limit) {
    haft_error error = {0};
    haft_programme programme = {crack, 0.01, limit};
    haft_path_options options = {.keep_states = limit < INFINITY};
    haft_path *path = NULL;
    check_ok(haft_solve_path(&path, model, law, &programme, &options, &error), error);
    return path;
}

/* w(x) = P x^2 (3 a - x) / (6 EI) up to the load at a, then straight on. */
static double exact_deflection(double load, double a, double x) {
    double ei = haft_beam_bending_stiffness(&BEAM);
    return x <= a ? load * x * x * (3 * a - x) / (6 * ei) : load * a * a * (3 * x - a) / (6 * ei);
}

static void the_free_beam_keeps_its_digits(void **state) {
    (void)state;
    for (int e = 0; e < MESHES; e++) {
        haft_model *model = make_beam(ELEMENT[e]);
        haft_law *law = haft_memory_alloc(haft_model_get(model)->sites, sizeof *law, NULL);
        for (size_t r = 0; r < haft_model_get(model)->sites; r++) {
            law[r] = nothing();
        }
        double load = 1e-6, worst = 0;
        haft_path *path = follow(model, law, 1e-9, load);
        assert_int_equal(path->outcome, HAFT_OUTCOME_FREE);
        const double *u = path->state + path->turn * haft_model_get(model)->dofs;
        for (size_t k = 1; k < haft_model_get(model)->nodes; k++) {
            double w, slope, x = haft_model_get(model)->node_x[k];
            haft_model_shape(model, u, x, &w, &slope);
            worst = fmax(worst, fabs(w / exact_deflection(load, 60e-6, x) - 1));
        }
        haft_path_point end = path->point[path->turn];
        double energy = end.internal_energy / (0.5 * load * exact_deflection(load, 60e-6, 60e-6));
        print_message("  l_e %4.1f um: shape within %.1e, energy %.1e, ledger %.1e\n",
                      ELEMENT[e] * 1e6, worst, fabs(energy - 1), path->ledger_error);
        check_less(worst, 1e-13);
        check_less(fabs(energy - 1), 1e-13);
        haft_path_destroy(&path);
        haft_memory_free(law);
        haft_model_destroy(&model);
    }
}

static void a_sticking_beam_keeps_its_path(void **state) {
    (void)state;
    haft_path *first = NULL;
    for (int e = 0; e < MESHES; e++) {
        haft_model *model = make_beam(ELEMENT[e]);
        haft_law *law = haft_memory_alloc(haft_model_get(model)->sites, sizeof *law, NULL);
        for (size_t r = 0; r < haft_model_get(model)->sites; r++) {
            double z[2];
            haft_random_normals((haft_random_key){3, HAFT_RANDOM_TEST}, 0, r, 0, 2, z);
            haft_law_vector v = {7e-3 * exp(0.25 * z[0]), 3e6 * exp(0.15 * z[0] + 0.1 * z[1]),
                                 9.5e-9, 7.8e-9};
            assert_int_equal(haft_law_morse(&law[r], &v, 5e6), HAFT_LAW_SOUND);
        }
        clock_t start = clock();
        haft_path *path = follow(model, law, 500e-6, INFINITY);
        double seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
        if (first == NULL) {
            first = path;
        }
        assert_int_equal(path->outcome, HAFT_OUTCOME_STUCK);
        assert_true(first->jumps >= 3);
        assert_int_equal(path->jumps, first->jumps);
        double top = first->point[first->turn].load, loads = 0, losses = 0;
        for (size_t j = 0; j < path->jumps; j++) {
            assert_int_equal(path->jump[j].site, first->jump[j].site);
            loads = fmax(loads, fabs(path->jump[j].load - first->jump[j].load) / top);
            losses = fmax(losses, fabs(path->jump[j].dissipated / first->jump[j].dissipated - 1));
        }
        double crack = path->point[path->points - 1].crack_length /
                       first->point[first->points - 1].crack_length;
        print_message("  l_e %4.1f um: %zu unknowns, %zu jumps, loads within %.1e of the largest, "
                      "losses %.1e, crack %.1e, ledger %.1e; %zu steps, %zu rejected, %.2f s\n",
                      ELEMENT[e] * 1e6, haft_model_get(model)->dofs, path->jumps, loads, losses,
                      fabs(crack - 1), path->ledger_error, path->cost.steps, path->cost.rejected,
                      seconds);
        check_less(loads, 1e-8);
        check_less(losses, 1e-6);
        check_near(crack, 1, 1e-8);
        if (path != first) {
            haft_path_destroy(&path);
        }
        haft_memory_free(law);
        haft_model_destroy(&model);
    }
    haft_path_destroy(&first);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_free_beam_keeps_its_digits),
        cmocka_unit_test(a_sticking_beam_keeps_its_path),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
