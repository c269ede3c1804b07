/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A case with a sweep, run: each variant is a case of its own, with the numbers it would have
 * alone; laws of the same inputs are built once; what is there is neither redone nor overwritten.
 */
#include "program.h"

#include "haft/study.h"

/* Elements of 3 um and of 5 um, the same laws. */
static const edit elements[] = {
    {"  element_length: 3 um\n", ""},
    {"study:", "sweep: {beam.element_length: [3 um, 5 um]}\nstudy:"},
    {0},
};

/* Patches of 3 um and of 6 um, laws of their own. */
static const edit patches[] = {
    {"  l_meso: 3 um\n", ""},
    {"study:", "sweep: {beam.l_meso: [3 um, 6 um]}\nstudy:"},
    {0},
};

static ino_t inode_of(const case_folder *c, const char *name) {
    char path[400];
    struct stat facts;
    assert_int_equal(stat(path_in(c, name, path), &facts), 0);
    return facts.st_ino;
}

static double crack_of(const char *path) {
    haft_error error = {0};
    haft_results_view *view = NULL;
    check_ok(haft_results_read(&view, path, &error), error);
    double crack = view->summary[0].crack_length;
    haft_results_view_destroy(&view);
    return crack;
}

static void a_variant_is_what_it_would_be_alone(void **state) {
    (void)state;
    case_folder swept = case_create(elements), alone = case_create(NULL);
    ran r = run_expect(0, HAFT, ARGS("run", swept.path));
    check_says(r.out, "element_length");
    check_says(r.out, "3 um");
    check_says(r.out, "5 um");
    check_says(r.err, "01_element_length-5um");
    ran_free(&r);
    must_run(HAFT, ARGS("run", "--quiet", alone.path));
    char path[400], other[400];
    path_in(&swept, "out/00_element_length-3um/out/results.h5", path);
    double first = crack_of(path);
    check_near(first, crack_of(path_in(&alone, "out/results.h5", other)), 0);
    path_in(&swept, "out/01_element_length-5um/out/results.h5", path);
    assert_true(fabs(crack_of(path) - first) > 0);

    /* the variant is a case folder: it can be told and drawn alone, and checks */
    path_in(&swept, "out/01_element_length-5um", path);
    must_run(HAFT, ARGS("check", "--quiet", path));
    r = run_expect(0, HAFT, ARGS("info", path));
    check_says(r.out, "beams: 2 run");
    ran_free(&r);

    /* the table has a line a variant, swept values in SI */
    char *table = read_whole_file(path_in(&swept, "out/sweep.csv", path), NULL);
    check_says(table, "variant,beam.element_length [m],run,stuck");
    check_says(table, "\n0,3e-06,2,2,0,0,");
    check_says(table, "\n1,5e-06,2,2,0,0,");
    free(table);
    case_remove(&swept);
    case_remove(&alone);
}

/* What others found, a value a variant, stands beside ours with the difference. */
static void variants_stand_beside_their_references(void **state) {
    (void)state;
    static const edit listed[] = {
        {"  element_length: 3 um\n", ""},
        {"  paper_crack_length: 219 um\n  measured_crack_length: 200 um\n", ""},
        {"study:", "sweep:\n  reference.paper_crack_length: [10 um, 20 um]\n  "
                   "beam.element_length: [3 um, 5 um]\nstudy:"},
        {0}};
    case_folder c = case_create(listed);
    char path[400];
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    ran r = run_expect(0, HAFT, ARGS("info", c.path));
    const char *at = strstr(r.out, "mean crack length at rest");
    assert_non_null(at);
    check_says(at, "element_length"); /* not the reference's key, though it comes first */
    for (int i = 0; i < 2; i++) {
        double paper, shift, share, ours, error, free_share;
        const char *row = strstr(at, i == 0 ? "\n              3 um" : "\n              5 um");
        assert_non_null(row);
        assert_int_equal(sscanf(row, " %*s um %lf %lf %lf %lf %lf %lf", &ours, &error, &free_share,
                                &paper, &shift, &share),
                         6);
        check_near(paper, 10 * (i + 1), 1e-9);
        check_near(shift, ours - paper, 0.11);
        check_near(share, 100 * (ours / paper - 1), 1.1);
        check_near(free_share, 0, 0);
        assert_true(error > 0);
    }
    ran_free(&r);
    char *table = read_whole_file(path_in(&c, "out/sweep.csv", path), NULL);
    check_says(table, "standard error [um],free share [1],over paper [1],over measured "
                      "[1],quantile 5 % [um],quantile 95 % [um]\n");
    free(table);
    case_remove(&c);
}

static void laws_of_the_same_inputs_are_built_once(void **state) {
    (void)state;
    case_folder c = case_create(elements);
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    assert_int_equal(inode_of(&c, "out/00_element_length-3um/out/laws.h5"),
                     inode_of(&c, "out/01_element_length-5um/out/laws.h5"));
    case_remove(&c);
    c = case_create(patches);
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    assert_int_not_equal(inode_of(&c, "out/00_l_meso-3um/out/laws.h5"),
                         inode_of(&c, "out/01_l_meso-6um/out/laws.h5"));
    case_remove(&c);
}

static haft_laws *laws_of(const char *path) {
    haft_error error = {0};
    haft_laws *laws = NULL;
    check_ok(haft_laws_read(&laws, NULL, path, &error), error);
    return laws;
}

static void check_same_laws(const haft_laws *a, const haft_laws *b) {
    assert_int_equal(a->m, b->m);
    assert_int_equal(a->n, b->n);
    assert_memory_equal(a->distance, b->distance, a->n * sizeof(double));
    assert_memory_equal(a->force, b->force, a->m * a->n * sizeof(double));
    assert_memory_equal(a->vector, b->vector, a->m * sizeof *a->vector);
    assert_memory_equal(a->asperities, b->asperities, a->m * sizeof(double));
    assert_int_equal(a->chaos != NULL, b->chaos != NULL);
}

/* Humidities, distances and samplers of the first two variants are read off the same surfaces, one
 * after the other; the third has wider patches; each has the laws that it would have alone. */
static void laws_of_the_same_patches_are_built_together(void **state) {
    (void)state;
    static const edit mixed[] = {
        {"  l_meso: 3 um\n", ""},
        {"    humidity: 85 %\n", ""},
        {", step: 0.2 nm}", "}"},
        {"  kind: morse ", "  #"},
        {"  sampler: explicit ", "  chaos: {vectors: 40, components: 3, order: 3}\n  #"},
        {"study:", "sweep:\n  contact.capillary.humidity: [85 %, 90 %, 85 %]\n"
                   "  contact.distance.step: [0.1 nm, 0.2 nm, 0.1 nm]\n"
                   "  law.sampler: [bootstrap, gpce, gpce]\n"
                   "  law.kind: [table, morse, morse]\n"
                   "  beam.l_meso: [3 um, 3 um, 6 um]\nstudy:"},
        {0}};
    case_folder c = case_create(mixed);
    ran r = run_expect(0, HAFT, ARGS("run", c.path));
    check_says(r.err, "building the laws of 2 variants at once, off the same patches");
    const char *third = strstr(r.err, "02_humidity");
    assert_non_null(third);
    check_says(third, "no laws yet: building them");
    ran_free(&r);
    static const char *const folder[] = {
        "out/00_humidity-85%_step-0.1nm_sampler-bootstrap_kind-table_l_meso-3um",
        "out/01_humidity-90%_step-0.2nm_sampler-gpce_kind-morse_l_meso-3um",
        "out/02_humidity-85%_step-0.1nm_sampler-gpce_kind-morse_l_meso-6um"};
    for (int i = 0; i < 3; i++) {
        char variant[400], path[420];
        path_in(&c, folder[i], variant);
        snprintf(path, sizeof path, "%s/out/laws.h5", variant);
        haft_laws *together = laws_of(path);
        assert_int_equal(unlink(path), 0);
        must_run(HAFT_LAWS, ARGS("build", "--quiet", variant));
        haft_laws *alone = laws_of(path);
        check_same_laws(together, alone);
        assert_true(i == 0 || alone->chaos != NULL);
        haft_laws_destroy(&together);
        haft_laws_destroy(&alone);
    }
    case_remove(&c);
}

/* Patches that make no model stop their own variant alone, and at its turn. */
static void a_variant_without_a_model_stops_no_other(void **state) {
    (void)state;
    static const edit few[] = {
        {"  kind: morse ", "  #"},
        {"  asperities: islands ", "  #"},
        {"f_limit: 5 MPa", "f_limit: 900 GPa"}, /* which no patch reaches */
        {"  sampler: explicit ", "  chaos: {vectors: 12, components: 3, order: 3}\n  #"},
        {"study:", "sweep:\n  law.sampler: [bootstrap, gpce]\n  law.kind: [table, morse]\n"
                   "  contact.asperities: [islands, summits]\nstudy:"},
        {0}};
    case_folder c = case_create(few);
    ran r = run_expect(3, HAFT, ARGS("run", c.path));
    check_says(r.err, "variant 01_sampler-gpce");
    check_says(r.err, "0 law vectors are too few for 3 components");
    ran_free(&r);
    assert_true(
        exists(&c, "out/00_sampler-bootstrap_kind-table_asperities-islands/out/results.h5"));
    case_remove(&c);
}

static void a_sweep_is_told_resumed_and_not_overwritten(void **state) {
    (void)state;
    case_folder c = case_create(elements);
    char path[400];
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    ran r = run_expect(5, HAFT, ARGS("run", c.path));
    check_says(r.err, "variant 00_element_length-3um");
    check_says(r.err, "--force");
    ran_free(&r);
    ran told = run_expect(0, HAFT, ARGS("info", c.path));
    check_says(told.out, "5 um");
    check_says(told.out,
               "mean crack length at rest of the beams that stuck"); /* it has references */

    /* a variant lost is all that a resume does */
    double kept = crack_of(path_in(&c, "out/01_element_length-5um/out/results.h5", path));
    assert_int_equal(unlink(path), 0);
    r = run_expect(0, HAFT, ARGS("resume", c.path));
    check_says(r.err, "nothing is left to do");
    ran_free(&r);
    check_near(crack_of(path), kept, 0);
    r = run_expect(0, HAFT, ARGS("info", "--json", c.path));
    assert_true(r.out[0] == '[');
    check_says(r.out, "}\n,\n{");
    check_says(r.out, "\"variant\": \"01_element_length-5um\"");
    check_says(r.out, "\"beam.element_length\": 5e-06");
    ran_free(&r);
    ran_free(&told);

    /* laws are built for a variant, not for the sweep */
    r = run_expect(3, HAFT_LAWS, ARGS("build", c.path));
    check_says(r.err, "out/00_element_length-3um");
    ran_free(&r);
    case_remove(&c);
}

/* A run that is refused leaves variants of another case.yaml as they are. */
static void a_refused_sweep_changes_nothing(void **state) {
    (void)state;
    static const edit other[] = {{"  element_length: 3 um\n", ""},
                                 {"gap: 400 nm", "gap: 401 nm"},
                                 {"study:", "sweep: {beam.element_length: [3 um, 5 um]}\nstudy:"},
                                 {0}};
    static const char *const kept[] = {"out/00_element_length-3um/case.yaml",
                                       "out/01_element_length-5um/case.yaml",
                                       "out/01_element_length-5um/out/results.h5"};
    case_folder c = case_create(elements);
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    char path[400], *before[3];
    size_t size[3], now = 0;
    for (int i = 0; i < 3; i++) {
        before[i] = read_whole_file(path_in(&c, kept[i], path), &size[i]);
    }
    case_write(&c, other);
    for (int resume = 0; resume < 2; resume++) {
        ran r = run_expect(5, HAFT, ARGS(resume ? "resume" : "run", c.path));
        check_says(r.err, "00_element_length-3um/case.yaml is of another case.yaml");
        check_says(r.err, "haft run --force");
        ran_free(&r);
    }
    for (int i = 0; i < 3; i++) {
        char *after = read_whole_file(path_in(&c, kept[i], path), &now);
        assert_int_equal(now, size[i]);
        assert_memory_equal(after, before[i], now);
        free(after);
        free(before[i]);
    }
    must_run(HAFT, ARGS("run", "--quiet", "--force", c.path));
    case_remove(&c);
}

static void every_variant_is_checked(void **state) {
    (void)state;
    static const edit second_wrong[] = {
        {"  element_length: 3 um\n", ""},
        {"study:", "sweep: {beam.element_length: [3 um, 7 um]}\nstudy:"},
        {0}};
    case_folder c = case_create(second_wrong);
    for (int i = 0; i < 2; i++) {
        ran r = run_expect(3, HAFT, ARGS(i == 0 ? "check" : "run", c.path));
        check_says(r.err, "beam.element_length: 7 um does not divide beam.length, 90 um");
        ran_free(&r);
    }
    assert_false(exists(&c, "out")); /* told before anything is made */
    case_remove(&c);
}

static void a_sweep_is_drawn(void **state) {
    (void)state;
    if (access("/usr/bin/gnuplot", X_OK) != 0) {
        skip();
    }
    case_folder c = case_create(elements);
    ran r = run_expect(4, HAFT, ARGS("plot", c.path));
    check_says(r.err, "results.h5");
    ran_free(&r);
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    must_run(HAFT, ARGS("plot", "--quiet", c.path));
    assert_true(exists(&c, "out/plots/sweep.png"));
    assert_true(exists(&c, "out/plots/sweep.svg"));
    assert_true(exists(&c, "out/plots/psd.svg"));
    case_remove(&c);
    static const edit kinds[] = {{"asperities:", "# "},
                                 {"study:", "sweep: {contact.asperities: [islands, summits]}\n"
                                            "study:"},
                                 {0}};
    c = case_create(kinds);
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    must_run(HAFT, ARGS("plot", "--quiet", c.path));
    char path[400];
    size_t size;
    char *svg = read_whole_file(path_in(&c, "out/plots/sweep.svg", path), &size);
    assert_non_null(memmem(svg, size, "summits", 7)); /* a choice stands on the axis as a word */
    free(svg);
    case_remove(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_variant_is_what_it_would_be_alone),
        cmocka_unit_test(variants_stand_beside_their_references),
        cmocka_unit_test(laws_of_the_same_inputs_are_built_once),
        cmocka_unit_test(laws_of_the_same_patches_are_built_together),
        cmocka_unit_test(a_variant_without_a_model_stops_no_other),
        cmocka_unit_test(a_sweep_is_told_resumed_and_not_overwritten),
        cmocka_unit_test(a_refused_sweep_changes_nothing),
        cmocka_unit_test(every_variant_is_checked),
        cmocka_unit_test(a_sweep_is_drawn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
