/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Laws with a far field: derivatives, many at a time, reach; and whole cycles of dry beams that
 * feel their substrate from 500 nm on. */
#include "landing_oracle.h"

#include <gsl/gsl_errno.h>

static const haft_beam_spec LONG = {1500e-6, 30e-6, 2.62e-6, 1.9e-6, 163e9};
static const haft_programme FAR_PROGRAMME = {600e-6, 0.01, INFINITY};

typedef struct rough {
    haft_dispersion law;
    double rms;
} rough;

static haft_dispersion_value averaged(const void *context, double distance) {
    const rough *r = context;
    return haft_dispersion_gaussian(&r->law, r->rms, distance);
}

/* Of faces as DelRio's in dry air. */
static haft_far_field make_field(void) {
    rough r = {{.substrate = 18.65e-20, .retardation = 100e-9, .cut_off = 1e-9}, 4.5e-9};
    haft_far_field field;
    haft_error error = {0};
    check_ok(haft_far_field_make(&field, HAFT_FAR_FIELD_TERMS, 3e-9, 500e-9, averaged, &r, &error),
             error);
    return field;
}

/* Dry laws: a weak pull of 1 nm, about where the highest asperities touch. */
static void dry_laws(haft_law *law, size_t sites, uint64_t seed, const haft_far_field *far) {
    for (size_t r = 0; r < sites; r++) {
        double z[4];
        haft_random_normals((haft_random_key){seed, HAFT_RANDOM_TEST}, 0, r, 0, 4, z);
        double d_max = 15e-9 + 0.5e-9 * z[2], f_max = 4e4 * exp(0.3 * z[1]);
        haft_law_vector v = {f_max * 1e-9 * exp(0.2 * z[0]), f_max, d_max, d_max - 0.8e-9};
        assert_int_equal(haft_law_morse(&law[r], &v, 5e6), HAFT_LAW_SOUND);
        law[r].far = far;
    }
}

enum { POINTS = 800 };

/* A law as a table that ends at 30 nm. */
static haft_law_table *tabulate(const haft_law *law) {
    double d[POINTS], f[POINTS];
    haft_law near = *law;
    near.far = NULL;
    for (int i = 0; i < POINTS; i++) {
        d[i] = 12e-9 + 18e-9 * i / (POINTS - 1);
        f[i] = haft_law_evaluate(&near, d[i]).force;
    }
    haft_law_table *table = NULL;
    haft_error error = {0};
    check_ok(haft_law_table_create(&table, POINTS, d, f, &error), error);
    return table;
}

/* By differences; none over the end of the field, nor over a kink of the near part. */
static void check_derivatives(const haft_law *law, double d) {
    double h = 1e-5 * d;
    haft_law_value a = haft_law_evaluate(law, d - h), b = haft_law_evaluate(law, d + h);
    haft_law_value m = haft_law_evaluate(law, d);
    double size = fabs(m.force) + fabs(m.slope) * d * 1e-3;
    check_near(m.force, (a.potential - b.potential) / (2 * h), 1e-4 * size);
    check_near(m.slope, (b.force - a.force) / (2 * h),
               1e-4 * fabs(m.slope) + 1e-3 * fabs(m.force) / d);
    check_near(m.curvature, (b.slope - a.slope) / (2 * h),
               1e-3 * fabs(m.curvature) + 1e-2 * fabs(m.slope) / d);
}

static void values_are_derivatives(void **state) {
    (void)state;
    haft_far_field far = make_field();
    haft_law law[2];
    dry_laws(law, 1, 1, &far);
    haft_law_table *table = tabulate(law);
    law[1] = haft_law_from_table(table);
    law[1].far = &far;
    for (double d = 2e-9; d < 480e-9; d *= 1.013) {
        check_derivatives(&law[0], d);
        bool knot = d > 11.9e-9 && d < 30.1e-9; /* its curvature leaps there */
        if (!knot) {
            check_derivatives(&law[1], d);
        }
    }
    haft_law_value pulls = haft_law_evaluate(law, 60e-9), gone = haft_law_evaluate(law, 500e-9);
    check_less(pulls.force, -10);
    check_less(pulls.potential, 0);
    assert_true(gone.force == 0 && gone.slope == 0 && gone.potential == 0);
    haft_law_table_destroy(&table);
}

static bool same(haft_law_value a, const double *f, const double *s, const double *c,
                 const double *p) {
    return a.force == *f && a.slope == *s && a.curvature == *c && a.potential == *p;
}

static void rows_are_the_laws(void **state) {
    (void)state;
    enum { LAWS = 101 };
    haft_far_field far = make_field();
    haft_law law[LAWS];
    dry_laws(law, LAWS, 2, &far);
    haft_law_table *table = tabulate(law);
    law[7] = law[40] = haft_law_from_table(table);
    law[7].far = law[40].far = &far;
    haft_error error = {0};
    for (int tables = 0; tables < 2; tables++) {
        haft_law_rows *rows = NULL;
        check_ok(haft_law_rows_create(&rows, tables ? LAWS : 7, law, &error), error);
        double d[LAWS], f[LAWS], s[LAWS], c[LAWS], p[LAWS], alone[LAWS];
        size_t n = tables ? LAWS : 7;
        for (uint64_t k = 0; k < 50; k++) {
            for (size_t i = 0; i < n;
                 i++) { /* lying down from the end, the first ones out of reach */
                double z;
                haft_random_normals((haft_random_key){3, HAFT_RANDOM_TEST}, k, i, 0, 1, &z);
                d[i] = 700e-9 * exp(-0.05 * (double)i) + fabs(z) * 1e-9;
            }
            haft_law_values all = {f, s, c, p}, force = {.force = alone};
            size_t nil = haft_law_rows_evaluate(rows, 0, n, d, &all);
            for (size_t i = 0; i < n; i++) {
                assert_true(same(haft_law_evaluate(&law[i], d[i]), f + i, s + i, c + i, p + i));
                assert_true(i >= nil || (f[i] == 0 && d[i] >= far.out));
            }
            assert_true(nil == n || nil % HAFT_SIMD_WIDTH == 0);
            assert_int_equal(haft_law_rows_evaluate(rows, 0, n, d, &force), nil);
            assert_memory_equal(alone, f, n * sizeof *f);
        }
        haft_law_rows_destroy(&rows);
    }
    haft_law_rows *rows = NULL;
    law[3].far = NULL;
    assert_int_equal(haft_law_rows_create(&rows, LAWS, law, &error), HAFT_ERROR_ARGUMENT);
    assert_null(rows);
    haft_law_table_destroy(&table);
}

static void reach_is_of_the_sum(void **state) {
    (void)state;
    haft_far_field far = make_field();
    haft_law law[2];
    dry_laws(law, 1, 4, &far);
    haft_law_table *table = tabulate(law);
    law[1] = haft_law_from_table(table);
    law[1].far = &far;
    for (int k = 0; k < 2; k++) {
        double most = 0;
        for (double d = 12e-9; d < 30e-9; d += 1e-12) {
            most = fmax(most, -haft_law_evaluate(&law[k], d).force);
        }
        for (double share = 0.5; share > 1e-4; share *= 0.3) {
            double d = haft_law_reach(&law[k], share);
            check_relative(-haft_law_evaluate(&law[k], d).force, share * most, 1e-5);
            assert_true(haft_law_extent(&law[k], share) == d);
            for (double beyond = d * 1.001; beyond < 500e-9; beyond *= 1.01) {
                check_less(-haft_law_evaluate(&law[k], beyond).force, share * most);
            }
        }
        assert_true(haft_law_extent(&law[k], 1e-16) == far.out);
        assert_true(isnan(haft_law_reach(&law[k], 1)));
    }
    haft_law_table_destroy(&table);
}

/* ---- what of the energy is where ---- */

/* Flat faces from contact to far apart: Dugdale's stress over its range, what is left of w, and
 * then dispersion from the cut-off on are the work w of the van der Waals forces without
 * dispersion. */
static void flat_faces_take_all_the_energy(void **state) {
    (void)state;
    haft_vdw_spec spec = {18.65e-20, 0.209e-9};
    haft_error error = {0};
    print_message("  cut-off nm  w' of w  stress MPa\n");
    for (double cut = 0.25e-9; cut < 3e-9; cut *= 2) {
        haft_dispersion law = {
            .substrate = 18.65e-20, .retardation = 100e-9, .cut_off = cut, .oxide = 6.5e-20};
        law.oxide_thickness[0] = law.oxide_thickness[1] = cut > 1e-9 ? 2e-9 : 0;
        haft_vdw vdw, whole;
        check_ok(haft_vdw_from_spec(&whole, &spec, &error), error);
        vdw = whole;
        check_ok(haft_vdw_leave_tail(&vdw, &law, &error), error);
        double work = vdw.stress * vdw.range, at = cut; /* and then by Simpson's rule */
        while (at < 1e-3) {
            double next = at * 1.02, middle = (at + next) / 2;
            work += (next - at) / 6 *
                    (haft_dispersion_at(&law, at).pressure +
                     4 * haft_dispersion_at(&law, middle).pressure +
                     haft_dispersion_at(&law, next).pressure);
            at = next;
        }
        check_relative(work, whole.energy, 1e-8);
        print_message("  %10.3g  %7.4f  %10.4g\n", cut * 1e9, vdw.energy / whole.energy,
                      vdw.stress * 1e-6);
    }
    haft_dispersion near = {.substrate = 18.65e-20, .cut_off = 0.165e-9};
    haft_vdw vdw;
    check_ok(haft_vdw_from_spec(&vdw, &spec, &error), error);
    assert_int_equal(haft_vdw_leave_tail(&vdw, &near, &error), HAFT_ERROR_INPUT);
}

/* Points farther than Dugdale's range and nearer than the cut-off have no force, unless an asperity
 * in contact has them: what they would have, of all the energy. */
static void the_residue_is_told(void **state) {
    (void)state;
    const double range = 0.2276e-9, rms = 3.54e-9;
    print_message("  the residue, of the energy beyond a cut-off of 1 nm (rms 3.54 nm)\n"
                  "  distance nm  points between  energy J/m^2  residue  pressure kPa  residue\n");
    for (double d = 8e-9; d < 17e-9; d += 2e-9) {
        haft_dispersion law = {.substrate = 18.65e-20, .retardation = 100e-9, .cut_off = 1e-9};
        haft_dispersion all = law;
        all.cut_off = range;
        double nearer = 0.5 * erfc((d - range) / rms / sqrt(2));
        double between = 0.5 * erfc((d - 1e-9) / rms / sqrt(2)) - nearer;
        haft_dispersion_value counted = haft_dispersion_gaussian(&law, rms, d);
        haft_dispersion_value whole = haft_dispersion_gaussian(&all, rms, d);
        double inside =
            haft_dispersion_at(&all, range).energy - haft_dispersion_at(&law, 1e-9).energy;
        double residue = whole.energy - nearer * inside - counted.energy;
        print_message("  %11.0f  %14.2e  %12.3g  %7.3f  %12.4g  %7.3f\n", d * 1e9, between,
                      counted.energy, residue / counted.energy, counted.pressure * 1e-3,
                      whole.pressure / counted.pressure - 1);
        assert_true(residue < 0 && between > 0);
    }
}

/* ---- beams ---- */

typedef struct beam {
    haft_far_field far;
    haft_model *model;
    haft_law *law;
} beam;

static void make_dry_beam(beam *b, uint64_t seed, haft_mesh_spec mesh) {
    haft_error error = {0};
    b->far = make_field();
    check_ok(haft_model_create_beam(&b->model, &LONG, &mesh, &error), error);
    size_t sites = haft_model_get(b->model)->sites;
    b->law = haft_memory_alloc(sites, sizeof *b->law, &error);
    dry_laws(b->law, sites, seed, &b->far);
}

static void drop_beam(beam *b) {
    haft_memory_free(b->law);
    haft_model_destroy(&b->model);
}

static haft_path *cycle_dry(const beam *b, haft_path_options options) {
    haft_error error = {0};
    haft_path *path = NULL;
    check_ok(haft_solve_path(&path, b->model, b->law, &FAR_PROGRAMME, &options, &error), error);
    assert_int_equal(path->outcome, HAFT_OUTCOME_STUCK);
    check_less(path->ledger_error, 1e-10);
    return path;
}

/* Whether GSL's dense Cholesky takes the Hessian, and how far the forces are out of balance. */
static bool is_stable(const beam *b, const double *u, double load, double *defect) {
    const haft_model_data *m = haft_model_get(b->model);
    double *g = haft_memory_alloc(m->dofs, sizeof *g, NULL), force = 0;
    double *h = haft_memory_alloc(m->nonzeros, sizeof *h, NULL);
    evaluate(b->model, b->law, u, load, g, h, &force);
    gsl_matrix *dense = gsl_matrix_calloc(m->dofs, m->dofs);
    *defect = 0;
    for (size_t j = 0; j < m->dofs; j++) {
        *defect = fmax(*defect, fabs(g[j]) / force);
        for (int k = m->column[j]; k < m->column[j + 1]; k++) {
            gsl_matrix_set(dense, (size_t)m->row[k], j, h[k]);
        }
    }
    bool stable = gsl_linalg_cholesky_decomp1(dense) == GSL_SUCCESS;
    gsl_matrix_free(dense);
    haft_memory_free(g);
    haft_memory_free(h);
    return stable;
}

static void every_state_is_a_stable_equilibrium(void **state) {
    (void)state;
    gsl_error_handler_t *old = gsl_set_error_handler_off();
    for (uint64_t seed = 11; seed < 13; seed++) {
        beam b;
        make_dry_beam(&b, seed, (haft_mesh_spec){HAFT_MESH_UNIFORM, 15e-6, 3e-6, 60e-6, 0});
        haft_path *path = cycle_dry(&b, (haft_path_options){.keep_states = true});
        for (size_t i = 0; i < path->points; i++) {
            double defect;
            const double *u = path->state + i * haft_model_get(b.model)->dofs;
            assert_true(is_stable(&b, u, path->point[i].load, &defect));
            check_less(defect, 1e-10);
            assert_true(path->point[i].lambda_min > 0);
        }
        print_message("  crack %.1f um, %zu points, %zu jumps, ledger %.1e\n",
                      path->point[path->points - 1].crack_length * 1e6, path->points, path->jumps,
                      path->ledger_error);
        haft_path_destroy(&path);
        drop_beam(&b);
    }
    gsl_set_error_handler(old);
}

/* On the mesh that leaves out what is not in reach, as cases have it. */
static void the_answer_does_not_depend_on_the_step(void **state) {
    (void)state;
    static const haft_path_options ways[] = {{.gap_step = 0.25},
                                             {.gap_step = 0.05, .flow_step = 0.02},
                                             {.ledger_tolerance = 1e-12},
                                             {.whole_mesh = true},
                                             {.linear_solver = HAFT_LINEAR_SOLVER_KLU}};
    double worst_load = 0, worst_end = 0;
    size_t jumps = 0;
    for (uint64_t seed = 21; seed < 24; seed++) {
        beam b;
        make_dry_beam(&b, seed, (haft_mesh_spec){HAFT_MESH_ACTIVE, 0, 3e-6, 60e-6, 300e-6});
        haft_path *path = cycle_dry(&b, (haft_path_options){0});
        jumps += path->jumps;
        for (size_t k = 0; k < sizeof ways / sizeof *ways; k++) {
            haft_path *other = cycle_dry(&b, ways[k]);
            assert_int_equal(other->jumps, path->jumps);
            for (size_t j = 0; j < path->jumps; j++) {
                double miss = fabs(other->jump[j].load - path->jump[j].load) / path->jump[0].load;
                assert_int_equal(other->jump[j].site, path->jump[j].site);
                worst_load = fmax(worst_load, miss);
            }
            for (size_t i = 0; i < haft_model_get(b.model)->dofs; i++) {
                worst_end = fmax(worst_end, fabs(other->final_state[i] - path->final_state[i]));
            }
            haft_path_destroy(&other);
        }
        haft_path_destroy(&path);
        drop_beam(&b);
    }
    print_message("  %zu jumps, loads within %.1e, final states within %.1e h\n", jumps, worst_load,
                  worst_end);
    check_less(worst_load, 1e-8);
    check_less(worst_end, 1e-7);
}

static void jumps_land_where_cvode_does(void **state) {
    (void)state;
    size_t jumps = 0;
    double worst = 0;
    for (uint64_t seed = 31; seed < 33; seed++) {
        beam b;
        make_dry_beam(&b, seed, (haft_mesh_spec){HAFT_MESH_UNIFORM, 50e-6, 10e-6, 60e-6, 0});
        oracle o = make_oracle(b.model, b.law);
        haft_path *path = cycle_dry(&b, (haft_path_options){.keep_states = true});
        jumps += check_landings_of(b.model, path, let_flow, &o, &worst);
        haft_path_destroy(&path);
        free_oracle(&o);
        drop_beam(&b);
    }
    print_message("  %zu jumps, gaps within %.1e m of CVODE's\n", jumps, worst);
    assert_true(jumps > 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_are_derivatives),
        cmocka_unit_test(rows_are_the_laws),
        cmocka_unit_test(reach_is_of_the_sum),
        cmocka_unit_test(flat_faces_take_all_the_energy),
        cmocka_unit_test(the_residue_is_told),
        cmocka_unit_test(every_state_is_a_stable_equilibrium),
        cmocka_unit_test(the_answer_does_not_depend_on_the_step),
        cmocka_unit_test(jumps_land_where_cvode_does),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
