/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The error budget of the small case: its terms are what two runs differ by, and what all
 * refinements at once change lies within it. */
#include "program.h"

#include "haft/study_report.h"

static haft_budget read_budget(const case_folder *c) {
    haft_error error = {0};
    haft_case *own = NULL;
    haft_budget budget;
    char path[400];
    check_ok(haft_case_read(&own, path_in(c, "case.yaml", path), &error), error);
    check_ok(haft_study_read_budget(&budget, own, path_in(c, "out/budget.csv", path), &error),
             error);
    haft_case_destroy(&own);
    return budget;
}

static const haft_budget_term *term(const haft_budget *b, const char *name) {
    for (size_t i = 0; i < b->count; i++) {
        if (strcmp(b->term[i].name, name) == 0) {
            return &b->term[i];
        }
    }
    fail_msg("there is no term %s", name);
    return NULL;
}

static void read_cracks(const case_folder *c, double crack[2]) {
    haft_error error = {0};
    haft_results_view *view = NULL;
    char path[400];
    check_ok(haft_results_read(&view, path_in(c, "out/results.h5", path), &error), error);
    for (int k = 0; k < 2; k++) {
        assert_int_equal(view->summary[k].outcome, HAFT_OUTCOME_STUCK);
        crack[k] = view->summary[k].crack_length;
    }
    haft_results_view_destroy(&view);
}

/* Narrow patches, whose laws take less time. */
static const edit narrow[] = {{"width: 3 um", "width: 1.5 um"}, {0}};

static void the_budget_holds_what_refining_changes(void **state) {
    (void)state;
    case_folder c = case_create(narrow);
    ran r = run_expect(0, HAFT, ARGS("budget", "--quiet", "--beams", "12", c.path));
    check_says(r.out, "all refinements at once");
    check_says(r.out, "10 nm to 5 nm");
    ran_free(&r);
    haft_budget b = read_budget(&c);
    assert_int_equal(b.beams, 12);
    double sum = 0, shift = 0;
    for (size_t i = 0; i < b.count; i++) {
        bool counts = b.term[i].measured && b.term[i].refinement;
        sum += counts ? fabs(b.term[i].shift) : 0;
        shift += counts ? b.term[i].shift : 0;
    }
    check_relative(b.total, sum, 1e-9);
    assert_true(b.total > 0);
    assert_true(b.together.measured && b.together.paired);
    check_near(b.together.shift - shift, b.interaction.shift, 1e-15);
    /* one term is most of the sum here, so it holds only if what the terms do to each other is
     * small */
    check_less(fabs(b.together.shift), b.total);
    check_less(fabs(b.interaction.shift), b.interaction.half_width);
    /* and what stepping and length contribute is nothing, as said elsewhere */
    check_less(fabs(term(&b, "step tolerance")->shift), 1e-12);
    check_less(fabs(term(&b, "beam length")->shift), 1e-9);
    assert_false(term(&b, "spatial correlation")->measured);
    assert_false(term(&b, "asperity model")->refinement);
    check_relative(b.models, fabs(term(&b, "asperity model")->shift), 1e-9);
    case_remove(&c);
}

/* A term is the difference of two runs, beam by beam; the second is a case that the budget kept. */
static void a_term_is_the_difference_of_two_runs(void **state) {
    (void)state;
    static const edit exact[] = {
        {"width: 3 um", "width: 1.5 um"}, {"  mesh: uniform ", "  mesh: exact "}, {0}};
    case_folder c = case_create(narrow), other = case_create(exact);
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    must_run(HAFT, ARGS("run", "--quiet", other.path));
    must_run(HAFT, ARGS("budget", "--quiet", "--beams", "2", c.path));
    double a[2], b[2];
    read_cracks(&c, a);
    read_cracks(&other, b);
    haft_budget budget = read_budget(&c);
    const haft_budget_term *mesh = term(&budget, "l_e");
    check_near(mesh->shift, 0.5 * (b[0] - a[0] + b[1] - a[1]), 1e-15);
    check_relative(budget.mean, 0.5 * (a[0] + a[1]), 1e-11);
    assert_true(fabs(mesh->shift) > 0);
    assert_int_equal(budget.sampled, 2);
    assert_true(exists(&c, "out/budget/000.yaml"));

    /* of another case it is refused */
    haft_error error = {0};
    haft_case *changed = NULL;
    char path[400];
    check_ok(haft_case_read(&changed, path_in(&other, "case.yaml", path), &error), error);
    assert_int_equal(
        haft_study_read_budget(&budget, changed, path_in(&c, "out/budget.csv", path), &error),
        HAFT_ERROR_INPUT);
    check_says(error.message, "of another case");
    haft_case_destroy(&changed);
    case_remove(&c);
    case_remove(&other);
}

/* Laws from a stochastic model: what stands between them and explicit ones is taken apart. */
static void a_stochastic_case_has_the_other_terms(void **state) {
    (void)state;
    static const edit stochastic[] = {
        {"sampler: explicit", "sampler: gpce\n  chaos: {vectors: 60, order: 3}"},
        {"length: 90 um", "length: 60 um"},
        {"width: 3 um", "width: 1.5 um"},
        {0}};
    case_folder c = case_create(stochastic);
    must_run(HAFT, ARGS("budget", "--quiet", "--beams", "3", c.path));
    haft_budget b = read_budget(&c);
    assert_true(term(&b, "gPCE")->measured && term(&b, "gPCE")->paired);
    assert_true(term(&b, "law density")->measured && !term(&b, "law density")->paired);
    assert_true(term(&b, "spatial correlation")->measured);
    assert_false(term(&b, "spatial correlation")->paired);
    assert_true(term(&b, "Morse fit")->measured && term(&b, "Morse fit")->paired);
    assert_true(b.together.measured && !b.together.paired);
    case_remove(&c);
}

static void faults_are_told(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    ran r = run_expect(2, HAFT, ARGS("budget", "--beams", "1", c.path));
    check_says(r.err, "from 2 to");
    ran_free(&r);
    case_remove(&c);
    c = case_create((edit[]){{"  element_length: 3 um\n", ""},
                             {"study:", "sweep: {beam.element_length: [3 um, 5 um]}\nstudy:"},
                             {0}});
    r = run_expect(3, HAFT, ARGS("budget", c.path));
    check_says(r.err, "out/00_element_length-3um");
    ran_free(&r);
    assert_false(exists(&c, "out"));
    case_remove(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_budget_holds_what_refining_changes),
        cmocka_unit_test(a_term_is_the_difference_of_two_runs),
        cmocka_unit_test(a_stochastic_case_has_the_other_terms),
        cmocka_unit_test(faults_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
