/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs beside each other: a sweep stands for its variants, beams of the same seed are paired, and
 * what cannot be compared is told. */
#include "program.h"

#include "haft/study_report.h"

static const edit humidities[] = {
    {"    humidity: 85 %\n", ""},
    {"study:", "sweep: {contact.capillary.humidity: [80 %, 90 %]}\nstudy:"},
    {0},
};

static void read_mean(const case_folder *c, const char *name, double *mean) {
    haft_error error = {0};
    haft_results_view *view = NULL;
    char path[400];
    check_ok(haft_results_read(&view, path_in(c, name, path), &error), error);
    *mean = 0.5 * (view->summary[0].crack_length + view->summary[1].crack_length);
    assert_int_equal(view->summary[0].outcome, HAFT_OUTCOME_STUCK);
    assert_int_equal(view->summary[1].outcome, HAFT_OUTCOME_STUCK);
    haft_results_view_destroy(&view);
}

/* The row of a case in compare.csv. */
static void read_row(const case_folder *c, int row, double value[23]) {
    char path[400], *text = read_whole_file(path_in(c, "out/compare/compare.csv", path), NULL);
    char *at = text;
    for (int i = 0; i <= row; i++) {
        at = strchr(at, '\n');
        assert_non_null(at);
        at++;
    }
    for (int j = 0; j < 23; j++) {
        value[j] = strtod(at, &at);
        at++;
    }
    free(text);
}

static void variants_are_compared_with_the_first(void **state) {
    (void)state;
    case_folder c = case_create(humidities), same = case_create(NULL);
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    must_run(HAFT, ARGS("run", "--quiet", same.path));
    char command[1200], path[400];
    snprintf(command, sizeof command, "PATH=/nowhere exec '%s' compare '%s' '%s'", HAFT, c.path,
             same.path);
    ran r = run_expect(4, "/bin/sh", ARGS("-c", command)); /* all but the figure is there */
    check_says(r.out, "case/01_humidity-90%");
    check_says(r.err, "gnuplot cannot be run");
    ran_free(&r);
    double mean[3], row[23];
    read_mean(&c, "out/00_humidity-80%/out/results.h5", &mean[0]);
    read_mean(&c, "out/01_humidity-90%/out/results.h5", &mean[1]);
    read_mean(&same, "out/results.h5", &mean[2]);
    for (int i = 1; i < 3; i++) {
        read_row(&c, i, row);
        check_relative(row[4], mean[i] * 1e6, 1e-11);
        check_relative(row[11], (mean[i] - mean[0]) * 1e6, 1e-9); /* of means and of pairs */
        check_relative(row[17], (mean[i] - mean[0]) * 1e6, 1e-9);
        check_near(row[16], 2, 0);
        assert_true(row[12] < row[11] && row[11] < row[13]);
    }
    assert_true(exists(&c, "out/compare/distributions.csv"));
    if (system("gnuplot --version > /dev/null 2>&1") == 0) {
        snprintf(path, sizeof path, "%s/side", c.top.folder);
        must_run(HAFT, ARGS("compare", "--quiet", "--output", path, c.path, same.path));
        strcat(path, "/compare.svg");
        assert_int_equal(access(path, R_OK), 0);
    }
    case_remove(&c);
    case_remove(&same);
}

static void what_cannot_be_compared_is_told(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    ran r = run_expect(4, HAFT, ARGS("compare", c.path, c.path));
    check_says(r.err, "results.h5");
    ran_free(&r);
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    r = run_expect(3, HAFT, ARGS("compare", c.path));
    check_says(r.err, "alone cannot be compared");
    ran_free(&r);
    case_write(&c, (edit[]){{"seed: 85", "seed: 86"}, {0}});
    r = run_expect(3, HAFT, ARGS("compare", c.path, c.path));
    check_says(r.err, "is of another case than there is now");
    ran_free(&r);
    r = run_expect(2, HAFT, ARGS("info", c.path, c.path));
    check_says(r.err, "one command and one case");
    ran_free(&r);
    case_remove(&c);
}

/* ---- findings ---- */

static const haft_finding *finding(const haft_findings *all, const char *subject) {
    for (size_t i = 0; i < all->count; i++) {
        if (strcmp(all->finding[i].subject, subject) == 0) {
            return &all->finding[i];
        }
    }
    fail_msg("nothing is said of \"%s\"", subject);
    return NULL;
}

/* What a run of the small case with these edits rests on. */
static haft_findings find(const edit *edits) {
    case_folder c = case_create(edits);
    haft_error error = {0};
    haft_case *own = NULL;
    haft_laws *laws = NULL;
    haft_results_view *view = NULL;
    haft_findings all;
    char path[400], results[400];
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    check_ok(haft_case_read(&own, path_in(&c, "case.yaml", path), &error), error);
    check_ok(haft_laws_read(&laws, NULL, path_in(&c, "out/laws.h5", path), &error), error);
    path_in(&c, "out/results.h5", results);
    check_ok(haft_results_read(&view, results, &error), error);
    check_ok(haft_study_find(&all, own, laws, results, view->summary, 0, &error), error);
    haft_results_view_destroy(&view);
    haft_laws_destroy(&laws);
    haft_case_destroy(&own);
    case_remove(&c);
    return all;
}

static void findings_follow_the_case(void **state) {
    (void)state;
    haft_findings as_is = find(NULL);
    assert_int_equal(finding(&as_is, "every state is stable")->verdict, HAFT_VERDICT_HOLDS);
    assert_int_equal(finding(&as_is, "the energy ledger closes")->verdict, HAFT_VERDICT_HOLDS);
    const haft_finding *grid = finding(&as_is, "the grid resolves the roughness");
    check_relative(grid->value, 2 * M_PI / 289e6 / 10e-9, 1e-12);
    assert_int_equal(grid->verdict, HAFT_VERDICT_DOUBTFUL);
    assert_int_equal(finding(&as_is, "asperities stay elastic")->verdict, HAFT_VERDICT_UNKNOWN);
    assert_int_equal(finding(&as_is, "enough beams")->verdict, HAFT_VERDICT_DOUBTFUL);
    const edit soft[] = {{"poisson_ratio: 0.22", "hardness: 1 GPa\n  poisson_ratio: 0.22"},
                         {"10 nm\n", "5 nm\n"},
                         {"mesh: uniform", "mesh: exact"},
                         {0}};
    haft_findings other = find(soft);
    assert_int_equal(finding(&other, "asperities stay elastic")->verdict, HAFT_VERDICT_BROKEN);
    assert_int_equal(finding(&other, "the grid resolves the roughness")->verdict,
                     HAFT_VERDICT_HOLDS);
    assert_int_equal(finding(&other, "the elements resolve the beam")->verdict, HAFT_VERDICT_HOLDS);
    const edit hard[] = {{"poisson_ratio: 0.22", "hardness: 11 GPa\n  poisson_ratio: 0.22"},
                         {"realizations: 2", "realizations: 12"},
                         {0}};
    haft_findings third = find(hard);
    assert_int_equal(finding(&third, "asperities stay elastic")->verdict, HAFT_VERDICT_HOLDS);
    check_less(finding(&third, "enough beams")->value, finding(&as_is, "enough beams")->value);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(variants_are_compared_with_the_first),
        cmocka_unit_test(what_cannot_be_compared_is_told),
        cmocka_unit_test(findings_follow_the_case),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
