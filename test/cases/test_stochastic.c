/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cases that draw their laws from a stochastic model: built once, whatever is drawn from it and for
 * however many beams; the same bits for any number of threads; the programs' words about it. */
#include "program.h"

#include "haft/study.h"

static const char REUSED[] = "built from the same inputs: reading them";
static const char REBUILT[] = "built from other inputs: building them anew";

#define CHAOS "  chaos: {vectors: 60, components: 3, order: 3}\n"
#define SAMPLER(name)                                                                              \
    { "  sampler: explicit ", "  sampler: " name "\n" CHAOS "  #" }

/* The crack lengths of out/results.h5, which holds two beams. */
static void read_cracks(const case_folder *c, double crack[2]) {
    char path[400];
    haft_error error = {0};
    haft_results_view *view = NULL;
    check_ok(haft_results_read(&view, path_in(c, "out/results.h5", path), &error), error);
    assert_int_equal(view->realizations, 2);
    crack[0] = view->summary[0].crack_length;
    crack[1] = view->summary[1].crack_length;
    haft_results_view_destroy(&view);
}

static void a_model_is_built_once_for_all_samplers(void **state) {
    (void)state;
    static const edit samplers[][2] = {{SAMPLER("gpce"), {0}},
                                       {SAMPLER("exact"), {0}},
                                       {SAMPLER("kernel"), {0}},
                                       {SAMPLER("bootstrap"), {0}},
                                       {SAMPLER("mean"), {0}}};
    case_folder c = case_create(samplers[0]);
    ran r = run_expect(0, HAFT, ARGS("run", c.path));
    check_says(r.err, "no laws yet: building them");
    ran_free(&r);
    double first[2], next[2];
    read_cracks(&c, first);
    assert_true(first[0] > 20e-6 && first[0] < 90e-6);
    assert_true(fabs(first[0] - first[1]) > 1e-12);
    for (size_t i = 1; i < sizeof samplers / sizeof *samplers; i++) {
        case_write(&c, samplers[i]);
        r = run_expect(0, HAFT, ARGS("run", "--force", c.path));
        check_says(r.err, REUSED);
        ran_free(&r);
        read_cracks(&c, next);
        assert_true(next[0] > 20e-6 && next[0] < 90e-6);
        assert_true(fabs(next[0] - first[0]) > 1e-12);
        bool all_alike = i == 4; /* the mean law at every site of every beam */
        assert_true((fabs(next[0] - next[1]) < 1e-15) == all_alike);
    }
    static const edit finer[] = {{"  sampler: explicit ", "  sampler: gpce\n  chaos: {vectors: 60, "
                                                          "components: 3, order: 4}\n  #"},
                                 {0}};
    case_write(&c, finer);
    r = run_expect(0, HAFT, ARGS("run", "--force", c.path));
    check_says(r.err, REBUILT);
    ran_free(&r);
    case_remove(&c);
}

static void threads_do_not_change_the_model(void **state) {
    (void)state;
    static const edit edits[] = {SAMPLER("exact"), {0}};
    double crack[3][2];
    static const char *const threads[] = {"1", "2", "5"};
    char *laws[3];
    for (int i = 0; i < 3; i++) {
        case_folder c = case_create(edits);
        char path[400];
        must_run(HAFT, ARGS("run", "--quiet", "--threads", threads[i], c.path));
        read_cracks(&c, crack[i]);
        laws[i] = read_whole_file(path_in(&c, "out/laws.csv", path), NULL);
        case_remove(&c);
    }
    for (int i = 1; i < 3; i++) {
        assert_memory_equal(crack[i], crack[0], sizeof crack[0]);
        assert_string_equal(laws[i], laws[0]);
    }
    for (int i = 0; i < 3; i++) {
        free(laws[i]);
    }
}

static void the_model_is_told_sampled_and_fitted(void **state) {
    (void)state;
    static const edit edits[] = {SAMPLER("gpce"), {0}};
    case_folder c = case_create(edits);
    char table[400], other[400];
    ran r = run_expect(0, HAFT_LAWS, ARGS("build", c.path));
    check_says(r.out, "60 laws, on 111 distances");
    check_says(r.out, "strict bounds, 3 of 4 components");
    check_says(r.out, "germ legendre, order 3: 20 terms from 4 points a direction");
    check_says(r.out, "drawn vectors without a Morse law: 0 %");
    ran_free(&r);
    r = run_expect(0, HAFT_LAWS, ARGS("sample", "--count", "500", c.path));
    check_says(r.out, "500 vectors in ");
    ran_free(&r);
    haft_error error = {0};
    haft_law_vector *v = NULL;
    size_t m = 0;
    check_ok(haft_vectors_read(&v, &m, path_in(&c, "out/sample.csv", table), &error), error);
    assert_int_equal(m, 500);
    haft_law law;
    for (size_t k = 0; k < m; k++) {
        assert_int_equal(haft_law_morse(&law, &v[k], 5e6), HAFT_LAW_SOUND);
    }
    haft_memory_free(v);

    /* the vectors written by a build, fitted again, make the same model to the table's digits */
    path_in(&c, "vectors.csv", other);
    assert_int_equal(rename(path_in(&c, "out/laws.csv", table), other), 0);
    r = run_expect(5, HAFT_LAWS, ARGS("fit", c.path, other));
    check_says(r.err, "add --force");
    ran_free(&r);
    r = run_expect(0, HAFT_LAWS, ARGS("fit", "--force", c.path, other));
    check_says(r.out, " laws, vectors alone");
    check_says(r.out, "germ legendre, order 3");
    ran_free(&r);
    r = run_expect(0, HAFT, ARGS("run", c.path));
    check_says(r.err, "the laws were fitted to a table of vectors: reading them");
    ran_free(&r);

    /* built again they are other laws: what was computed with the fitted ones is not gone on with
     */
    must_run(HAFT_LAWS, ARGS("build", "--quiet", "--force", c.path));
    char before[HAFT_DIGEST_CAPACITY], origin[HAFT_DIGEST_CAPACITY];
    check_ok(haft_laws_peek(before, origin, path_in(&c, "out/laws.h5", table), &error), error);
    assert_string_equal(origin, "");
    case_remove(&c);
}

static void a_sample_is_drawn_from_the_case_s_own_model(void **state) {
    (void)state;
    static const edit first[] = {SAMPLER("gpce"), {0}};
    static const edit finer[] = {{"  sampler: explicit ", "  sampler: gpce\n  chaos: {vectors: 60, "
                                                          "components: 3, order: 4}\n  #"},
                                 {0}};
    case_folder c = case_create(first);
    must_run(HAFT_LAWS, ARGS("build", "--quiet", c.path));
    case_write(&c, finer);
    ran r = run_expect(3, HAFT_LAWS, ARGS("sample", c.path));
    check_says(r.err, "was built from other inputs than the case has now");
    ran_free(&r);
    case_remove(&c);
}

static void a_stochastic_case_is_drawn(void **state) {
    (void)state;
    if (access("/usr/bin/gnuplot", X_OK) != 0) {
        skip();
    }
    static const edit edits[] = {SAMPLER("gpce"), {0}};
    case_folder c = case_create(edits);
    char table[400], other[400];
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    static const char *const figures[] = {"laws",      "generated", "reduction", "components",
                                          "marginals", "vectors",   "orders"};
    ran r = run_expect(0, HAFT, ARGS("plot", c.path));
    assert_string_equal(r.err, "");
    ran_free(&r);
    for (size_t i = 0; i < sizeof figures / sizeof *figures; i++) {
        char name[100];
        snprintf(name, sizeof name, "out/plots/%s.png", figures[i]);
        assert_true(exists(&c, name));
        snprintf(name, sizeof name, "out/plots/%s.svg", figures[i]);
        assert_true(exists(&c, name));
    }
    assert_false(exists(&c, "out/plots/correlation.png")); /* of independent patches: 0 */
    path_in(&c, "vectors.csv", other);
    assert_int_equal(rename(path_in(&c, "out/laws.csv", table), other), 0);
    must_run(HAFT_LAWS, ARGS("fit", "--quiet", "--force", c.path, other));
    must_run(HAFT, ARGS("run", "--quiet", "--force", c.path));
    must_run(HAFT, ARGS("plot", "--quiet", c.path));
    case_remove(&c);
}

static void a_model_is_studied(void **state) {
    (void)state;
    static const edit edits[] = {SAMPLER("gpce"), {0}};
    static const edit finer[] = {{"  sampler: explicit ", "  sampler: gpce\n  chaos: {vectors: 60, "
                                                          "components: 3, order: 4}\n  #"},
                                 {0}};
    case_folder c = case_create(edits);
    must_run(HAFT_LAWS, ARGS("build", "--quiet", c.path));
    ran r = run_expect(0, HAFT_LAWS, ARGS("study", c.path));
    check_says(r.out, "in 3 components; relMISE by 32768 maps");
    check_says(r.out, "  hermite      14    680 ");
    check_says(r.out, "Models of m of the vectors, mean over disjoint parts");
    assert_null(strstr(r.out, "nan"));
    ran_free(&r);
    case_write(&c, finer);
    r = run_expect(3, HAFT_LAWS, ARGS("study", c.path));
    check_says(r.err, "was built from other inputs than the case has now");
    ran_free(&r);
    case_remove(&c);
    c = case_create(NULL);
    must_run(HAFT_LAWS, ARGS("build", "--quiet", c.path));
    r = run_expect(3, HAFT_LAWS, ARGS("study", c.path));
    check_says(r.err, "these laws hold no stochastic model to study; set law.sampler: gpce");
    ran_free(&r);
    case_remove(&c);
}

/* Every site has the curve of one of the patches, drawn anew for each beam and as often as chance
 * has it; no model is built, so patches without a Morse law do no harm. */
static void a_bootstrap_of_tables_draws_the_patches_curves(void **state) {
    (void)state;
    static const edit edits[] = {SAMPLER("bootstrap"), {"kind: morse", "kind: table"}, {0}};
    case_folder folder = case_create(edits);
    char path[400];
    must_run(HAFT, ARGS("run", "--quiet", folder.path));
    haft_error error = {0};
    haft_case *c = NULL;
    haft_laws *laws = NULL;
    check_ok(haft_case_read(&c, path_in(&folder, "case.yaml", path), &error), error);
    char digest[HAFT_DIGEST_CAPACITY];
    check_ok(haft_laws_read(&laws, digest, path_in(&folder, "out/laws.h5", path), &error), error);
    assert_int_equal(laws->m, 60);
    assert_null(laws->chaos);
    size_t again = 0, drawn[60] = {0}, sites = haft_study_sites(c);
    for (size_t realization = 0; realization < 2; realization++) {
        haft_site_laws *s = NULL;
        if (realization > 0) { /* beams may share their tables */
            check_ok(haft_laws_tabulate(laws, &error), error);
        }
        check_ok(haft_study_site_laws(&s, c, laws, realization, &error), error);
        for (size_t r = 0; r < sites; r++) {
            size_t k = haft_chaos_draw_patch(c->seed, realization, r, laws->m);
            assert_true(realization == 0 || s->law[r].table == laws->table[k]);
            again += r > 0 && k == haft_chaos_draw_patch(c->seed, realization, r - 1, laws->m);
            drawn[k]++;
            const double *curve = haft_laws_curve(laws, k);
            for (size_t i = 0; i + 1 < laws->n; i++) {
                assert_true(haft_law_evaluate(&s->law[r], laws->distance[i]).force == curve[i]);
            }
        }
        haft_site_laws_destroy(&s);
    }
    size_t different = 0;
    for (size_t k = 0; k < 60; k++) {
        different += drawn[k] > 0;
    }
    assert_true(again < sites / 5);
    assert_true(different > sites / 3); /* of 60, two beams' sites draw most */
    double first[2], next[2];
    read_cracks(&folder, first);
    must_run(HAFT, ARGS("run", "--quiet", "--force", "--threads", "1", folder.path));
    read_cracks(&folder, next);
    assert_memory_equal(first, next, sizeof first);
    must_run(HAFT, ARGS("plot", "--quiet", folder.path));
    haft_laws_destroy(&laws);
    haft_case_destroy(&c);
    case_remove(&folder);
}

static void what_cannot_be_drawn_is_told(void **state) {
    (void)state;
    static const edit table[] = {SAMPLER("gpce"), {"kind: morse", "kind: table"}, {0}};
    static const edit points[] = {
        {"  sampler: explicit ", "  sampler: gpce\n  chaos: {order: 5, points: 5}\n  #"}, {0}};
    static const edit few[] = {
        {"  sampler: explicit ", "  sampler: gpce\n  chaos: {vectors: 9}\n  #"}, {0}};
    static const edit germ[] = {
        {"  sampler: explicit ", "  sampler: gpce\n  chaos: {germ: legendr}\n  #"}, {0}};
    static const edit sampler[] = {{"sampler: explicit", "sampler: gpcee"}, {0}};
    static const struct {
        const edit *edits;
        const char *says;
    } wrong[] = {
        {table, "law.kind: table needs curves"},
        {points, "law.chaos.points: 5 points a direction cannot tell order 5; give 6 at least"},
        {few, "law.chaos.vectors: "},
        {germ, "law.chaos.germ: \"legendr\" is no choice; did you mean legendre?"},
        {sampler, "did you mean gpce?"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        case_folder c = case_create(wrong[i].edits);
        ran r = run_expect(3, HAFT, ARGS("check", c.path));
        check_says(r.err, wrong[i].says);
        ran_free(&r);
        case_remove(&c);
    }
    case_folder c = case_create(NULL);
    must_run(HAFT_LAWS, ARGS("build", "--quiet", c.path));
    ran r = run_expect(3, HAFT_LAWS, ARGS("sample", c.path));
    check_says(r.err, "set law.sampler: gpce");
    ran_free(&r);
    r = run_expect(3, HAFT_LAWS, ARGS("fit", c.path, "none.csv"));
    check_says(r.err, "set law.sampler: gpce");
    ran_free(&r);
    r = run_expect(2, HAFT_LAWS, ARGS("fit", c.path));
    check_says(r.err, "fit needs a table");
    ran_free(&r);
    case_remove(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_model_is_built_once_for_all_samplers),
        cmocka_unit_test(threads_do_not_change_the_model),
        cmocka_unit_test(the_model_is_told_sampled_and_fitted),
        cmocka_unit_test(a_sample_is_drawn_from_the_case_s_own_model),
        cmocka_unit_test(a_stochastic_case_is_drawn),
        cmocka_unit_test(a_model_is_studied),
        cmocka_unit_test(a_bootstrap_of_tables_draws_the_patches_curves),
        cmocka_unit_test(what_cannot_be_drawn_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
