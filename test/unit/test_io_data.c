/* SPDX-License-Identifier: GPL-3.0-or-later */
/* laws.h5, results.h5 and CSV: what is written reads back to the same bits, twice written is the
 * same file, and another program finds its way by the documented names. */
#include "scratch.h"

#include <hdf5.h>
#include <time.h>

#include "haft/io.h"

static const char MODEL[] = HAFT_SOURCE_DIR "/cases/delrio-rh85/case.yaml";

static haft_case *read_model(size_t realizations) {
    haft_error error = {0};
    haft_case *c = NULL;
    check_ok(haft_case_read(&c, MODEL, &error), error);
    c->realizations = realizations;
    return c;
}

static haft_laws *make_laws(void) {
    enum { M = 6, N = 21 };
    haft_error error = {0};
    haft_laws *laws = NULL;
    check_ok(haft_laws_create(&laws, M, N, &error), error);
    laws->sites = 3;
    laws->f_limit = 5e6;
    for (size_t i = 0; i < N; i++) {
        laws->distance[i] = 1e-9 * (double)(i + 3);
    }
    for (size_t i = 0; i < M * N; i++) {
        laws->force[i] = sin(0.1 * (double)i) * 1e6 / 3;
    }
    for (size_t i = 0; i < M; i++) {
        double x = 1 + (double)i / 7;
        laws->vector[i] = (haft_law_vector){1e-3 * x, 2e6 * x, 9e-9 * x, 6e-9 * x};
        laws->zero_distance[i] = 8e-9 * x;
        laws->contact_area[i] = 0.003 * x;
        laws->wet_area[i] = 0.2 * x;
        laws->asperities[i] = 100 * x;
    }
    laws->fault[4] = HAFT_LAW_TWO_WELLS;
    laws->vector[4] = (haft_law_vector){NAN, NAN, NAN, NAN};
    laws->zero_distance[4] = NAN;
    return laws;
}

/* A set that has kept some curves, of sites that begin later: there and back, and what is refused
 * of its index. */
static void laws_with_some_curves_read_back(void **state) {
    (void)state;
    static const int keeps[][3] = {{0, 2, 5}, {4, -1, -1}, {-1, -1, -1}};
    scratch s = scratch_create();
    char path[400];
    scratch_path(&s, "laws.h5", path);
    haft_error error = {0};
    haft_case *c = read_model(2);
    haft_laws *laws = make_laws();
    laws->first_site = 7;
    for (size_t i = 0; i < 3; i++) {
        haft_laws *some = NULL, *back = NULL;
        bool keep[6] = {false};
        size_t kept = 0;
        for (size_t j = 0; j < 3 && keeps[i][j] >= 0; j++) {
            keep[keeps[i][j]] = true;
            kept++;
        }
        check_ok(haft_laws_select(&some, laws, 0, 6, keep, &error), error);
        assert_int_equal(some->first_site, 7);
        check_ok(haft_laws_write(some, c, path, &error), error);
        check_ok(haft_laws_read(&back, NULL, path, &error), error);
        assert_true(back->m == 6 && back->n == laws->n && back->curves == kept);
        assert_int_equal(back->first_site, 7);
        assert_memory_equal(back->vector, laws->vector, 6 * sizeof *laws->vector);
        assert_memory_equal(back->wet_area, laws->wet_area, 6 * sizeof(double));
        for (size_t k = 0; k < 6; k++) {
            const double *curve = haft_laws_curve(back, k);
            assert_int_equal(curve != NULL, keep[k]);
            if (curve != NULL) {
                assert_memory_equal(curve, laws->force + k * laws->n, laws->n * sizeof(double));
            }
        }
        haft_laws_destroy(&back);
        if (kept == 3) { /* an index that does not rise, or beyond the laws */
            some->curve_law[1] = 5;
            check_ok(haft_laws_write(some, c, path, &error), error);
            assert_int_equal(haft_laws_read(&back, NULL, path, &error), HAFT_ERROR_INPUT);
            assert_non_null(strstr(error.message, "rising laws"));
            some->curve_law[1] = 2;
            some->curve_law[2] = 6;
            check_ok(haft_laws_write(some, c, path, &error), error);
            assert_int_equal(haft_laws_read(&back, NULL, path, &error), HAFT_ERROR_INPUT);
        }
        haft_laws_destroy(&some);
    }
    haft_laws_destroy(&laws);
    haft_case_destroy(&c);
    scratch_remove(&s);
}

static void laws_read_back_to_the_same_bits(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400], digest[HAFT_DIGEST_CAPACITY], expected[HAFT_DIGEST_CAPACITY];
    scratch_path(&s, "laws.h5", path);
    haft_error error = {0};
    haft_case *c = read_model(2);
    haft_laws *laws = make_laws(), *back = NULL;
    check_ok(haft_laws_write(laws, c, path, &error), error);
    check_ok(haft_laws_read(&back, digest, path, &error), error);
    check_ok(haft_case_laws_digest(c, expected, &error), error);
    assert_string_equal(digest, expected);
    assert_int_equal(back->m, laws->m);
    assert_int_equal(back->n, laws->n);
    assert_int_equal(back->sites, laws->sites);
    check_near(back->f_limit, laws->f_limit, 0);
    size_t row = laws->m * sizeof(double);
    assert_memory_equal(back->distance, laws->distance, laws->n * sizeof(double));
    assert_memory_equal(back->force, laws->force, laws->n * row);
    assert_memory_equal(back->vector, laws->vector, laws->m * sizeof *laws->vector);
    assert_memory_equal(back->fault, laws->fault, laws->m * sizeof *laws->fault);
    assert_memory_equal(back->zero_distance, laws->zero_distance, row);
    assert_memory_equal(back->contact_area, laws->contact_area, row);
    assert_memory_equal(back->wet_area, laws->wet_area, row);
    assert_memory_equal(back->asperities, laws->asperities, row);
    assert_int_equal(scratch_count(&s), 1); /* no temporary file */
    haft_laws_destroy(&back);
    haft_laws_destroy(&laws);
    haft_case_destroy(&c);
    scratch_remove(&s);
}

/* A path of `points` states on a beam of 4 nodes, and all that goes with it. */
typedef struct sample {
    haft_path path;
    haft_path_point point[5];
    haft_jump jump[2];
    double state[5 * 6];
    haft_model_data model;
    haft_site site[2];
    double node_x[4], scale[6];
    haft_law laws[2];
    haft_law_vector vectors[2];
    haft_summary summary;
} sample;

static void make_sample(sample *x, double seed) {
    *x = (sample){.path = {.points = 5, .jumps = 2, .turn = 3, .outcome = HAFT_OUTCOME_FREE}};
    x->path.point = x->point;
    x->path.jump = x->jump;
    x->path.state = x->state;
    x->path.ledger_error = 1e-12 * seed;
    x->path.cost = (haft_path_cost){5, 1, 17, 18, 60, 2, 40, 0};
    for (int i = 0; i < 5; i++) {
        double v = seed + i / 3.0;
        x->point[i] =
            (haft_path_point){v, 2 * v, 3 * v, 4 * v, 5 * v, 6 * v, 7 * v, 8 * v, 9 * v, i > 3, -1};
    }
    x->point[2].jump = 0;
    x->point[4].jump = 1;
    for (int i = 0; i < 2; i++) {
        double v = seed * (i + 1) / 7;
        x->jump[i] = (haft_jump){.kind = i == 0 ? HAFT_JUMP_PULL_IN : HAFT_JUMP_PULL_OUT,
                                 .phase = i,
                                 .departure = HAFT_DEPARTURE_MULTIPLE_FOLD - i,
                                 .load = v,
                                 .site = i + 3,
                                 .sites_switched = 4 - i,
                                 .crack_before = 2 * v,
                                 .crack_after = 3 * v,
                                 .dissipated = 4 * v,
                                 .internal_before = 5 * v,
                                 .internal_after = 6 * v,
                                 .flow_steps = 20 + i,
                                 .fold_defect = 7 * v};
        x->site[i] = (haft_site){.x = 1e-4 * (i + 1), .area = 9e-11 * (i + 1)};
        x->laws[i].kind = i == 0 ? HAFT_LAW_MORSE : HAFT_LAW_TABLE;
        x->vectors[i] = (haft_law_vector){1e-3 * v, 2e6 * v, 9e-9 * v, i == 0 ? 6e-9 : NAN};
    }
    for (int i = 0; i < 30; i++) {
        x->state[i] = sin(seed + i);
    }
    for (int i = 0; i < 6; i++) {
        x->scale[i] = i % 2 == 0 ? 1.9e-6 : 0.0127;
    }
    for (int i = 0; i < 4; i++) {
        x->node_x[i] = 2e-4 * i;
    }
    x->model = (haft_model_data){.dofs = 6,
                                 .scale = x->scale,
                                 .gap = 1.9e-6,
                                 .sites = 2,
                                 .site = x->site,
                                 .load = {.x = 6e-5},
                                 .nodes = 4,
                                 .node_x = x->node_x};
    x->summary = (haft_summary){.crack_length = 2e-4 * seed,
                                .loaded_crack_length = 1e-4,
                                .gamma = 3e-5,
                                .work = 1e-12,
                                .dissipated = 4e-13,
                                .ledger_error = 1e-15,
                                .seconds = 1.5,
                                .outcome = HAFT_OUTCOME_FREE,
                                .jumps = 2,
                                .steps = 5,
                                .unfit = 1};
}

/* Realizations 2 and 0 of 3, in that order; 0 leaves evidence. */
static void write_results(const char *path, bool overwrite) {
    haft_error error = {0};
    haft_case *c = read_model(3);
    haft_results *results = NULL;
    check_ok(haft_results_create(&results, path, c, "0123456789abcdef0123456789abcdef", overwrite,
                                 &error),
             error);
    for (int k = 2; k >= 0; k -= 2) {
        sample x;
        make_sample(&x, k + 1.25);
        check_ok(haft_results_add(results, (size_t)k, &x.path, &x.model, x.laws, x.vectors,
                                  &x.summary, &error),
                 error);
        assert_int_equal(haft_results_add(results, (size_t)k, &x.path, &x.model, x.laws, x.vectors,
                                          &x.summary, &error),
                         HAFT_ERROR_ARGUMENT);
    }
    check_ok(haft_results_finish(&results, &error), error);
    assert_null(results);
    haft_case_destroy(&c);
}

static void check_path(const char *file, size_t realization, const sample *x) {
    haft_error error = {0};
    haft_path *path = NULL;
    check_ok(haft_results_read_path(&path, file, realization, &error), error);
    assert_int_equal(path->points, 5);
    assert_int_equal(path->jumps, 2);
    assert_memory_equal(path->point, x->point, sizeof x->point);
    for (int i = 0; i < 2; i++) { /* by member: the struct has padding */
        const haft_jump *a = &path->jump[i], *b = &x->jump[i];
        assert_true(a->kind == b->kind && a->phase == b->phase && a->departure == b->departure &&
                    a->load == b->load && a->site == b->site &&
                    a->sites_switched == b->sites_switched);
        assert_true(a->crack_before == b->crack_before && a->crack_after == b->crack_after &&
                    a->dissipated == b->dissipated && a->flow_steps == b->flow_steps);
        assert_true(a->internal_before == b->internal_before &&
                    a->internal_after == b->internal_after && a->fold_defect == b->fold_defect);
    }
    assert_int_equal(path->turn, 3);
    assert_int_equal(path->outcome, HAFT_OUTCOME_FREE);
    check_near(path->ledger_error, x->path.ledger_error, 0);
    assert_memory_equal(&path->cost, &x->path.cost, sizeof path->cost);
    assert_null(path->state);
    haft_path_destroy(&path);
}

static void results_read_back_to_the_same_bits(void **state) {
    (void)state;
    scratch s = scratch_create();
    char file[400];
    scratch_path(&s, "results.h5", file);
    write_results(file, false);
    haft_error error = {0};
    haft_results_view *view = NULL;
    check_ok(haft_results_read(&view, file, &error), error);
    assert_int_equal(view->realizations, 3);
    sample x;
    make_sample(&x, 3.25);
    assert_memory_equal(&view->summary[2], &x.summary, sizeof x.summary);
    assert_int_equal(view->summary[1].outcome, -1);
    assert_true(isnan(view->summary[1].crack_length) && isnan(view->summary[1].seconds));
    haft_case *c = read_model(3);
    char *text = NULL;
    check_ok(haft_case_emit(&text, c, &error), error);
    assert_string_equal(view->resolved_case, text);
    haft_memory_free(text);
    haft_case_destroy(&c);
    haft_results_view_destroy(&view);
    check_path(file, 2, &x);
    make_sample(&x, 1.25);
    check_path(file, 0, &x);

    haft_results_shapes *shapes = NULL;
    check_ok(haft_results_read_shapes(&shapes, file, 0, &error), error);
    assert_int_equal(shapes->points, 5);
    assert_int_equal(shapes->nodes, 4);
    assert_memory_equal(shapes->node_x, x.node_x, sizeof x.node_x);
    for (size_t p = 0; p < 5; p++) {
        check_near(shapes->deflection[4 * p], 0, 0);
        check_near(shapes->rotation[4 * p], 0, 0);
        for (size_t k = 1; k < 4; k++) {
            size_t i = 2 * (k - 1);
            check_near(shapes->deflection[4 * p + k], x.scale[i] * x.state[6 * p + i], 0);
            check_near(shapes->rotation[4 * p + k], x.scale[i + 1] * x.state[6 * p + i + 1], 0);
        }
    }
    haft_results_shapes_destroy(&shapes);
    assert_int_equal(haft_results_read_shapes(&shapes, file, 2, &error), HAFT_ERROR_INPUT);
    assert_non_null(strstr(error.message, "evidence: [2]"));
    haft_path *path = NULL;
    assert_int_equal(haft_results_read_path(&path, file, 1, &error), HAFT_ERROR_INPUT);
    assert_non_null(strstr(error.message, "no realization 1"));
    assert_int_equal(scratch_count(&s), 1);
    scratch_remove(&s);
}

/* A beam that found no state leaves evidence without states, beside the others' results. */
static void beam_without_a_state_is_a_row(void **state) {
    (void)state;
    scratch s = scratch_create();
    char file[400];
    scratch_path(&s, "results.h5", file);
    haft_error error = {0};
    haft_case *c = read_model(3);
    haft_results *results = NULL;
    check_ok(haft_results_create(&results, file, c, "", false, &error), error);
    sample x;
    make_sample(&x, 1.25);
    x.path = (haft_path){.outcome = HAFT_OUTCOME_STEP_STALLED, .end_influence = NAN};
    x.summary = (haft_summary){
        .crack_length = NAN, .loaded_crack_length = NAN, .outcome = HAFT_OUTCOME_STEP_STALLED};
    assert_true(haft_case_wants_evidence(c, 0));
    check_ok(haft_results_add(results, 0, &x.path, &x.model, x.laws, x.vectors, &x.summary, &error),
             error);
    check_ok(haft_results_finish(&results, &error), error);
    haft_case_destroy(&c);
    haft_results_view *view = NULL;
    check_ok(haft_results_read(&view, file, &error), error);
    assert_int_equal(view->summary[0].outcome, HAFT_OUTCOME_STEP_STALLED);
    assert_true(isnan(view->summary[0].crack_length));
    assert_int_equal(view->summary[1].outcome, -1);
    haft_results_view_destroy(&view);
    haft_path *path = NULL;
    check_ok(haft_results_read_path(&path, file, 0, &error), error);
    assert_true(path->points == 0 && path->jumps == 0);
    assert_int_equal(path->outcome, HAFT_OUTCOME_STEP_STALLED);
    haft_path_destroy(&path);
    haft_results_shapes *shapes = NULL;
    check_ok(haft_results_read_shapes(&shapes, file, 0, &error), error);
    assert_true(shapes->points == 0 && shapes->nodes == 4);
    haft_results_shapes_destroy(&shapes);
    scratch_remove(&s);
}

static void check_same_files(const char *a, const char *b) {
    size_t m = 0, n = 0;
    char *left = read_whole_file(a, &m), *right = read_whole_file(b, &n);
    assert_int_equal(m, n);
    assert_memory_equal(left, right, m);
    free(left);
    free(right);
}

/* More than a second lies between, so that a time stamp anywhere would show. */
static void written_twice_is_the_same_file(void **state) {
    (void)state;
    scratch s = scratch_create();
    char a[400], b[400], l[400], m[400];
    haft_error error = {0};
    haft_case *c = read_model(2);
    haft_laws *laws = make_laws();
    write_results(scratch_path(&s, "a.h5", a), false);
    check_ok(haft_laws_write(laws, c, scratch_path(&s, "l.h5", l), &error), error);
    nanosleep(&(struct timespec){1, 100000000}, NULL);
    write_results(scratch_path(&s, "b.h5", b), false);
    check_ok(haft_laws_write(laws, c, scratch_path(&s, "m.h5", m), &error), error);
    check_same_files(a, b);
    check_same_files(l, m);
    write_results(a, true);
    check_same_files(a, b);
    haft_laws_destroy(&laws);
    haft_case_destroy(&c);
    scratch_remove(&s);
}

/* ---- as another program sees it ---- */

typedef struct visit_count {
    int datasets;
} visit_count;

static herr_t visit(hid_t root, const char *name, const H5O_info_t *info, void *data) {
    visit_count *count = data;
    if (info->type != H5O_TYPE_DATASET) {
        return 0;
    }
    count->datasets++;
    static const char *const wanted[] = {"unit", "description"};
    for (int i = 0; i < 2; i++) {
        if (H5Aexists_by_name(root, name, wanted[i], H5P_DEFAULT) <= 0) {
            fail_msg("%s has no attribute %s", name, wanted[i]);
        }
    }
    return 0;
}

static void check_names(const char *file, const char *const *names, const char *const *attributes,
                        int datasets) {
    hid_t id = H5Fopen(file, H5F_ACC_RDONLY, H5P_DEFAULT);
    assert_true(id >= 0);
    for (; *names != NULL; names++) {
        hid_t dataset = H5Dopen2(id, *names, H5P_DEFAULT);
        if (dataset < 0) {
            fail_msg("%s is not there", *names);
        }
        H5Dclose(dataset);
    }
    for (; *attributes != NULL; attributes++) {
        if (H5Aexists(id, *attributes) <= 0) {
            fail_msg("the root has no attribute %s", *attributes);
        }
    }
    visit_count count = {0};
    assert_true(H5Ovisit(id, H5_INDEX_NAME, H5_ITER_NATIVE, visit, &count) >= 0);
    assert_int_equal(count.datasets, datasets);
    H5Fclose(id);
}

static const char *const root_names[] = {
    "format", "layout_version", "haft_version", "haft_revision", "compiler",        "hdf5_version",
    "seed",   "laws_digest",    "case_digest",  "case",          "contents_digest", NULL};
static const char *const laws_names[] = {"/curves/distance",
                                         "/curves/force",
                                         "/curves/zero_distance",
                                         "/curves/contact_area",
                                         "/curves/wet_area",
                                         "/curves/asperities",
                                         "/laws/e",
                                         "/laws/f_max",
                                         "/laws/d_max",
                                         "/laws/d_limit",
                                         "/laws/fault",
                                         "/contents",
                                         NULL};
static const char *const results_names[] = {"/summary/crack_length",
                                            "/summary/loaded_crack_length",
                                            "/summary/gamma",
                                            "/summary/status",
                                            "/summary/work",
                                            "/summary/dissipated",
                                            "/summary/internal_energy",
                                            "/summary/end_influence",
                                            "/summary/ledger_error",
                                            "/summary/jumps",
                                            "/summary/steps",
                                            "/summary/unfit",
                                            "/summary/seconds",
                                            "/realizations/0/path/load",
                                            "/realizations/0/path/crack_length",
                                            "/realizations/0/path/internal_energy",
                                            "/realizations/0/path/contact_energy",
                                            "/realizations/0/path/work",
                                            "/realizations/0/path/dissipated",
                                            "/realizations/0/path/lambda_min",
                                            "/realizations/0/path/jump",
                                            "/realizations/0/jumps/load",
                                            "/realizations/0/jumps/site",
                                            "/realizations/0/jumps/dissipated",
                                            "/realizations/0/evidence/site_x",
                                            "/realizations/0/evidence/site_area",
                                            "/realizations/0/evidence/e",
                                            "/realizations/0/evidence/f_max",
                                            "/realizations/0/evidence/d_max",
                                            "/realizations/0/evidence/d_limit",
                                            "/realizations/0/evidence/node_x",
                                            "/realizations/0/evidence/load",
                                            "/realizations/0/evidence/displacement",
                                            "/contents",
                                            NULL};

static void documented_names_are_there(void **state) {
    (void)state;
    scratch s = scratch_create();
    char file[400];
    scratch_path(&s, "x.h5", file);
    haft_error error = {0};
    haft_case *c = read_model(2);
    haft_laws *laws = make_laws();
    check_ok(haft_laws_write(laws, c, file, &error), error);
    check_names(file, laws_names, root_names, 11 + 1);
    write_results(file, true);
    check_names(file, results_names, root_names, 13 + 2 * (11 + 13) + 10 + 1);
    haft_laws_destroy(&laws);
    haft_case_destroy(&c);
    scratch_remove(&s);
}

static void csv_holds_rows_and_columns(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400];
    scratch_path(&s, "x.csv", path);
    haft_error error = {0};
    double value[] = {1, 2, 3, 4, 1.0 / 3, NAN};
    haft_csv_column column[] = {
        {.name = "d [nm]", .value = value, .stride = 2, .factor = 1e9},
        {.name = "a, \"b\"", .value = value + 1, .stride = 2},
        {.name = "c", .value = value},
    };
    check_ok(haft_csv_write(path, 3, 3, column, &error), error);
    char *text = read_whole_file(path, NULL);
    assert_string_equal(text, "d [nm],\"a, \"\"b\"\"\",c\n1000000000,2,1\n3000000000,4,2\n"
                              "333333333.333,nan,3\n");
    free(text);
    assert_int_equal(scratch_count(&s), 1);
    scratch_remove(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(laws_read_back_to_the_same_bits),
        cmocka_unit_test(laws_with_some_curves_read_back),
        cmocka_unit_test(results_read_back_to_the_same_bits),
        cmocka_unit_test(beam_without_a_state_is_a_row),
        cmocka_unit_test(written_twice_is_the_same_file),
        cmocka_unit_test(documented_names_are_there),
        cmocka_unit_test(csv_holds_rows_and_columns),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
