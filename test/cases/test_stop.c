/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A campaign that ends by itself: at the same realization and with the same bits for any number of
 * threads and after interruptions; and no sooner or later than its rule says. */
#include "same_bits.h"

#include "haft/study.h"

enum { MOST = 50 };

static const edit stopping[] = {
    {"realizations: 2", "realizations: 50\n  stop: {crack_length_mean: 1.2 um}"}, {NULL, NULL}};

/* Half widths of the mean's interval over the first n, n in tens from 30 on: the first that is
 * small enough. */
static size_t expected_end(const haft_results_view *view, const haft_case *c, double goal) {
    for (size_t n = 30; n < MOST; n += 10) {
        haft_statistics s = haft_study_statistics(c, view->summary, n);
        if (0.5 * (s.mean_interval.high - s.mean_interval.low) <= goal) {
            return n;
        }
    }
    return MOST;
}

static size_t count_run(const haft_results_view *view) {
    size_t n = 0;
    while (n < view->realizations && view->summary[n].outcome >= 0) {
        n++;
    }
    for (size_t k = n; k < view->realizations; k++) {
        assert_int_equal(view->summary[k].outcome, -1);
    }
    return n;
}

static void a_campaign_ends_where_its_rule_says(void **state) {
    const case_folder *all = *state;
    case_folder one = case_create(stopping), more = case_create(stopping);
    char path[400];
    haft_error error = {0};
    haft_results_view *whole = NULL, *part = NULL;
    check_ok(haft_results_read(&whole, path_in(all, "out/results.h5", path), &error), error);
    assert_int_equal(count_run(whole), MOST);
    haft_case c = {.stop = {.confidence = 0.95}};
    size_t end = expected_end(whole, &c, 1.2e-6);
    assert_true(end > 30 && end < MOST); /* else this test says little */
    copy_laws(all, &one);                /* the stop rule is none of the laws' inputs */
    copy_laws(all, &more);
    ran r = run_expect(0, HAFT, ARGS("run", "--threads", "1", one.path));
    check_says(r.err, "the laws were built from the same inputs");
    check_says(r.err, "study.stop: the mean crack length is known to +- 1.2 um (95 % confidence)");
    ran_free(&r);
    check_ok(haft_results_read(&part, path_in(&one, "out/results.h5", path), &error), error);
    assert_int_equal(count_run(part), end);
    for (size_t k = 0; k < end; k++) {
        assert_true(part->summary[k].crack_length == whole->summary[k].crack_length);
    }
    static const char *const threads[] = {"2", "5"};
    for (int i = 0; i < 2; i++) {
        must_run(HAFT, ARGS("run", "--quiet", "--force", "--threads", threads[i], more.path));
        check_same_bytes(&one, &more, "out/results.h5");
        check_same_bytes(&one, &more, "out/summary.csv");
        check_same_bytes(&one, &more, "out/convergence.csv");
        assert_false(exists(&more, "out/parts"));
    }
    r = run_expect(0, HAFT, ARGS("resume", more.path)); /* complete, though not all were run */
    check_says(r.err, "the run is complete");
    ran_free(&r);
    haft_results_view_destroy(&whole);
    haft_results_view_destroy(&part);
    case_remove(&one);
    case_remove(&more);
}

/* Parts that hold more than the rule needs, or stop short of it, as runs that were killed leave. */
static void interruptions_do_not_move_the_end(void **state) {
    const case_folder *all = *state;
    case_folder one = case_create(stopping), broken = case_create(stopping);
    copy_laws(all, &one);
    copy_laws(all, &broken);
    must_run(HAFT, ARGS("run", "--quiet", one.path));
    for (int tries = 0; tries < 3; tries++) {
        child c = start_program(
            HAFT, ARGS(tries == 0 ? "run" : "resume", "--threads", "5", broken.path), 0);
        for (bool told = false; !told && waitpid(c.pid, NULL, WNOHANG) == 0;) {
            char *text = written(c.err);
            told = strstr(text, "beams  ") != NULL;
            free(text);
        }
        kill(c.pid, SIGKILL);
        (void)waitpid(c.pid, NULL, 0);
        fclose(c.out);
        fclose(c.err);
    }
    must_run(HAFT, ARGS("resume", "--quiet", broken.path));
    check_same_bytes(&one, &broken, "out/results.h5");
    check_same_bytes(&one, &broken, "out/summary.csv");
    case_remove(&one);
    case_remove(&broken);
}

/* All realizations of the case without a rule: run once for all tests. */
static int run_all(void **state) {
    static case_folder all;
    all = case_create((edit[]){{"realizations: 2", "realizations: 50"}, {NULL, NULL}});
    must_run(HAFT, ARGS("run", "--quiet", all.path));
    *state = &all;
    return 0;
}

static int remove_all(void **state) {
    case_remove(*state);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_campaign_ends_where_its_rule_says),
        cmocka_unit_test(interruptions_do_not_move_the_end),
    };
    return cmocka_run_group_tests(tests, run_all, remove_all);
}
