/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The beam against exact answers of Euler-Bernoulli theory, and its energy against its gradient. */
#include "evaluate.h"
#include "haft/solve.h"

static const haft_beam_spec BEAM = {600e-6, 30e-6, 2.62e-6, 1.9e-6, 163e9};

/* Solves K u = load by the path follower, up to a load limit far from any contact. */
typedef struct solved {
    haft_model *model;
    haft_law *law;
    haft_path *path;
    const double *u; /* at the load limit */
} solved;

static solved load_beam(const haft_mesh_spec *mesh, double load) {
    solved s = {0};
    haft_error error = {0};
    check_ok(haft_model_create_beam(&s.model, &BEAM, mesh, &error), error);
    s.law = haft_memory_alloc(haft_model_get(s.model)->sites, sizeof *s.law, &error);
    for (size_t r = 0; r < haft_model_get(s.model)->sites; r++) {
        s.law[r] = nothing();
    }
    haft_programme programme = {1e-9, 0.01, load};
    haft_path_options options = {.keep_states = true};
    check_ok(haft_solve_path(&s.path, s.model, s.law, &programme, &options, &error), error);
    assert_int_equal(s.path->outcome, HAFT_OUTCOME_FREE);
    assert_true(s.path->turned_by_load);
    s.u = s.path->state + s.path->turn * haft_model_get(s.model)->dofs;
    return s;
}

static void release(solved *s) {
    haft_path_destroy(&s->path);
    haft_memory_free(s->law);
    haft_model_destroy(&s->model);
}

/* w(x) = P x^2 (3 a - x) / (6 EI) up to the load at a, then straight on. */
static double exact_deflection(double load, double a, double x) {
    double ei = haft_beam_bending_stiffness(&BEAM);
    return x <= a ? load * x * x * (3 * a - x) / (6 * ei) : load * a * a * (3 * x - a) / (6 * ei);
}

static void a_point_load_gives_the_exact_shape(void **state) {
    (void)state;
    double load = 1e-7;
    /* at the tip, at a node, and between nodes of a uniform mesh; anywhere on the exact mesh */
    static const struct {
        haft_mesh_kind kind;
        double element, position;
        bool exact_everywhere;
    } cases[] = {
        {HAFT_MESH_UNIFORM, 600e-6, 600e-6, true}, {HAFT_MESH_UNIFORM, 150e-6, 600e-6, true},
        {HAFT_MESH_UNIFORM, 150e-6, 300e-6, true}, {HAFT_MESH_UNIFORM, 150e-6, 212e-6, false},
        {HAFT_MESH_EXACT, 0, 212e-6, true},        {HAFT_MESH_EXACT, 0, 600e-6, true},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        haft_mesh_spec mesh = {cases[c].kind, cases[c].element, 120e-6, cases[c].position, 0};
        solved s = load_beam(&mesh, load);
        const double *u = s.u;
        /* Hermite elements are exact at their nodes for any load */
        for (size_t k = 1; k < haft_model_get(s.model)->nodes; k++) {
            double x = haft_model_get(s.model)->node_x[k], w, slope;
            haft_model_shape(s.model, u, x, &w, &slope);
            check_relative(w, exact_deflection(load, cases[c].position, x), 1e-12);
        }
        for (double x = 7e-6; cases[c].exact_everywhere && x < BEAM.length; x += 31e-6) {
            double w, slope;
            haft_model_shape(s.model, u, x, &w, &slope);
            check_relative(w, exact_deflection(load, cases[c].position, x), 1e-12);
        }
        haft_path_point end = s.path->point[s.path->turn];
        check_relative(end.load, load, 0);
        check_relative(end.internal_energy, 0.5 * end.load * end.deflection, 1e-12);
        check_relative(end.work, end.internal_energy, 1e-12);
        release(&s);
    }
}

/* A uniform pressure on many patches: w(L) = q L^4 / (8 EI) as the patches shrink, the midpoint
 * rule being of second order; and for every number of patches the sum of the point loads' exact
 * tips. */
static void patches_of_uniform_pressure_reach_the_uniform_load(void **state) {
    (void)state;
    double ei = haft_beam_bending_stiffness(&BEAM), l = BEAM.length, q = 1e-4, last = 0;
    for (int sites = 5; sites <= 80; sites *= 2) {
        double tip = 0;
        for (int r = 0; r < sites; r++) {
            double x = l * (r + 0.5) / sites;
            tip += q * l / sites * x * x * (3 * l - x) / (6 * ei);
        }
        haft_mesh_spec mesh = {HAFT_MESH_UNIFORM, 120e-6, l / sites, l, 0};
        solved s = load_beam(&mesh, 1e-8);
        double sum = 0; /* Betti: the tip under pressure is the work of the shape of a tip load */
        for (size_t r = 0; r < haft_model_get(s.model)->sites; r++) {
            sum += q * haft_model_get(s.model)->site[r].area / BEAM.width *
                   haft_model_displacement(&haft_model_get(s.model)->site[r], s.u) / 1e-8;
        }
        check_relative(sum, tip, 1e-12);
        double miss = fabs(sum / (q * l * l * l * l / (8 * ei)) - 1);
        if (last > 0) {
            check_near(log2(last / miss), 2.0, 0.02);
        }
        last = miss;
        release(&s);
    }
}

/* Gradient and Hessian against central differences of the energy, contact included. */
static void derivatives_follow_the_energy(void **state) {
    (void)state;
    haft_error error = {0};
    haft_mesh_spec mesh = {HAFT_MESH_UNIFORM, 150e-6, 30e-6, 60e-6, 0};
    haft_model *model = NULL;
    check_ok(haft_model_create_beam(&model, &BEAM, &mesh, &error), error);
    size_t n = haft_model_get(model)->dofs;
    double *u = haft_memory_alloc(n, sizeof *u, &error);
    double *g = haft_memory_alloc(3 * n, sizeof *g, &error);
    double *h = haft_memory_alloc(haft_model_get(model)->nonzeros, sizeof *h, &error);
    haft_law *law = haft_memory_alloc(haft_model_get(model)->sites, sizeof *law, &error);
    for (size_t r = 0; r < haft_model_get(model)->sites; r++) {
        haft_law_vector v = {0.3, 1e5, 1.2e-6, 0.8e-6}; /* wide: its range is the beam's own */
        assert_int_equal(haft_law_morse(&law[r], &v, 1e5), HAFT_LAW_SOUND);
    }
    haft_random_normals((haft_random_key){1, HAFT_RANDOM_TEST}, 0, 0, 0, n, u);
    for (size_t i = 0; i < n; i++) {
        u[i] *= 0.2;
    }
    double load = 3e-5;
    evaluate(model, law, u, load, g, h, NULL);
    double step = 1e-5, scale = 0;
    for (size_t i = 0; i < n; i++) {
        scale = fmax(scale, fabs(g[i]));
    }
    for (size_t j = 0; j < n; j++) {
        double keep = u[j], pi[2];
        for (int side = 0; side < 2; side++) {
            u[j] = keep + (side ? step : -step);
            haft_energy e = evaluate(model, law, u, load, g + (size_t)(1 + side) * n, NULL, NULL);
            pi[side] = (e.strain + e.contact -
                        load * haft_model_displacement(&haft_model_get(model)->load, u)) /
                       haft_model_get(model)->energy_unit;
        }
        u[j] = keep;
        check_near((pi[1] - pi[0]) / (2 * step), g[j], 1e-7 * scale);
        for (int k = haft_model_get(model)->column[j]; k < haft_model_get(model)->column[j + 1];
             k++) {
            size_t i = (size_t)haft_model_get(model)->row[k];
            double difference = (g[2 * n + i] - g[n + i]) / (2 * step);
            check_near(difference, h[k], 1e-7 * (fabs(h[k]) + scale));
        }
    }
    haft_memory_free(u), haft_memory_free(g), haft_memory_free(h), haft_memory_free(law);
    haft_model_destroy(&model);
}

/* Consistent mass: the mass of a rigid translation is the integral of 1/L, of w = x/L it is 1/3. */
static void the_mass_matrix_integrates_squares(void **state) {
    (void)state;
    haft_error error = {0};
    haft_mesh_spec mesh = {HAFT_MESH_EXACT, 0, 50e-6, 60e-6, 0};
    haft_model *model = NULL;
    check_ok(haft_model_create_beam(&model, &BEAM, &mesh, &error), error);
    size_t n = haft_model_get(model)->dofs;
    double *u = haft_memory_alloc(n, sizeof *u, &error);
    for (size_t k = 1; k < haft_model_get(model)->nodes; k++) { /* w = gap x^2/L^2 */
        double s = haft_model_get(model)->node_x[k] / BEAM.length;
        u[2 * (k - 1)] = s * s;
        u[2 * (k - 1) + 1] =
            2 * s / BEAM.length * BEAM.gap / haft_model_get(model)->scale[2 * (k - 1) + 1];
    }
    double sum = 0;
    for (size_t j = 0; j < n; j++) {
        for (int k = haft_model_get(model)->column[j]; k < haft_model_get(model)->column[j + 1];
             k++) {
            sum += u[haft_model_get(model)->row[k]] * haft_model_get(model)->mass[k] * u[j];
        }
    }
    check_relative(sum, 1.0 / 5, 1e-13);
    haft_memory_free(u);
    haft_model_destroy(&model);
}

/* The tip of the crack of a known cubic shape, on both meshes. */
static void the_crack_tip_is_found_in_the_shape(void **state) {
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        haft_error error = {0};
        haft_mesh_spec mesh = {(haft_mesh_kind)kind, 75e-6, 6e-6, 60e-6, 0};
        haft_model *model = NULL;
        check_ok(haft_model_create_beam(&model, &BEAM, &mesh, &error), error);
        const double felt = 13e-9;
        double reach[100];
        for (size_t r = 0; r < haft_model_get(model)->sites; r++) {
            reach[r] = felt;
        }
        double *u = haft_memory_alloc(haft_model_get(model)->dofs, sizeof *u, &error);
        check_near(haft_model_crack_length(model, reach, u), BEAM.length, 0);
        for (size_t k = 1; k < haft_model_get(model)->nodes;
             k++) { /* w = gap (x/L)^3: cubic, so exact */
            double s = haft_model_get(model)->node_x[k] / BEAM.length;
            u[2 * (k - 1)] = s * s * s;
            u[2 * (k - 1) + 1] =
                3 * s * s / BEAM.length * BEAM.gap / haft_model_get(model)->scale[2 * (k - 1) + 1];
        }
        double expected = BEAM.length * cbrt(1 - felt / BEAM.gap);
        check_relative(haft_model_crack_length(model, reach, u), expected, 1e-12);
        haft_memory_free(u);
        haft_model_destroy(&model);
    }
}

static void closed_forms_invert_each_other(void **state) {
    (void)state;
    double gamma = haft_beam_effective_energy(&BEAM, 219e-6);
    check_relative(haft_beam_equilibrium_crack(&BEAM, gamma), 219e-6, 1e-14);
    check_relative(haft_beam_bending_stiffness(&BEAM),
                   163e9 * 30e-6 * 2.62e-6 * 2.62e-6 * 2.62e-6 / 12, 1e-14);
}

static void bad_meshes_are_refused(void **state) {
    (void)state;
    static const struct {
        haft_mesh_spec mesh;
        const char *says;
    } bad[] = {
        {{HAFT_MESH_UNIFORM, 15e-6, 7e-6, 60e-6, 0}, "l_meso"},
        {{HAFT_MESH_UNIFORM, 17e-6, 3e-6, 60e-6, 0}, "element_length"},
        {{HAFT_MESH_UNIFORM, 15e-6, 3e-6, 700e-6, 0}, "off the beam"},
        {{HAFT_MESH_UNIFORM, 15e-6, 3e-6, 0, 0}, "off the beam"},
        {{HAFT_MESH_EXACT, 0, -3e-6, 60e-6, 0}, "l_meso"},
        {{HAFT_MESH_UNIFORM, NAN, 3e-6, 60e-6, 0}, "element_length"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        haft_error error = {0};
        haft_model *model = NULL;
        assert_int_equal(haft_model_create_beam(&model, &BEAM, &bad[i].mesh, &error),
                         HAFT_ERROR_INPUT);
        assert_non_null(strstr(error.message, bad[i].says));
        assert_null(model);
    }
}

/* Displacements and forces of sites taken together, on every kind of mesh, against site by site. */
static void sites_together_are_as_site_by_site(void **state) {
    (void)state;
    for (int kind = 0; kind < 3; kind++) {
        haft_error error = {0};
        haft_mesh_spec mesh = {(haft_mesh_kind)kind, 75e-6, 6e-6, 60e-6, 99e-6};
        haft_model *m = NULL;
        check_ok(haft_model_create_beam(&m, &BEAM, &mesh, &error), error);
        double *u = haft_memory_alloc(haft_model_get(m)->dofs, sizeof *u, &error);
        double *w = haft_memory_alloc(haft_model_get(m)->sites, sizeof *w, &error);
        double *force = haft_memory_alloc(haft_model_get(m)->sites, sizeof *force, &error);
        double *sum = haft_memory_alloc(haft_model_get(m)->dofs, sizeof *sum, &error);
        double *expected = haft_memory_alloc(haft_model_get(m)->dofs, sizeof *expected, &error);
        for (size_t i = 0; i < haft_model_get(m)->dofs; i++) {
            u[i] = sin(3.7 * (double)i + 1);
            sum[i] = expected[i] = (double)i;
        }
        haft_model_displacements(m, u, w);
        for (size_t r = haft_model_get(m)->inert; r < haft_model_get(m)->sites; r++) {
            assert_true(w[r] == haft_model_displacement(&haft_model_get(m)->site[r], u));
            force[r] = 1e6 * cos(2.3 * (double)r);
            for (int k = 0; k < haft_model_get(m)->site[r].terms; k++) {
                expected[haft_model_get(m)->site[r].dof[k]] +=
                    force[r] * haft_model_get(m)->site[r].shape[k];
            }
        }
        haft_model_add_forces(m, force, sum);
        for (size_t i = 0; i < haft_model_get(m)->dofs; i++) {
            check_near(sum[i], expected[i], 1e-14 * (double)haft_model_get(m)->dofs);
        }
        haft_memory_free(u), haft_memory_free(w), haft_memory_free(force);
        haft_memory_free(sum), haft_memory_free(expected);
        haft_model_destroy(&m);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_point_load_gives_the_exact_shape),
        cmocka_unit_test(patches_of_uniform_pressure_reach_the_uniform_load),
        cmocka_unit_test(derivatives_follow_the_energy),
        cmocka_unit_test(the_mass_matrix_integrates_squares),
        cmocka_unit_test(the_crack_tip_is_found_in_the_shape),
        cmocka_unit_test(sites_together_are_as_site_by_site),
        cmocka_unit_test(closed_forms_invert_each_other),
        cmocka_unit_test(bad_meshes_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
