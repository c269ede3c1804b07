/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Programs stopped by a signal end by themselves, with code 130 and no file half-written; beams
 * that were done are saved, and count. */
#include "program.h"

#include "haft/study.h"

#include <time.h>

/* Waits until the program has told its first beams or laws, and sends the signal; there is far more
 * to do then than is done. */
static ran stop_program(const char *program, const char *const *args, const char *once_told,
                        int number) {
    child c = start_program(program, args, 0);
    for (bool told = false; !told;) {
        int state;
        char *text = written(c.err);
        told = strstr(text, once_told) != NULL;
        if (!told && waitpid(c.pid, &state, WNOHANG) != 0) {
            fail_msg("%s ended before it could be stopped: %s", program, text);
        }
        free(text);
        nanosleep(&(struct timespec){.tv_nsec = 2000000}, NULL);
    }
    assert_int_equal(kill(c.pid, number), 0);
    return end_program(c);
}

static void check_listing(const case_folder *c, const char *expected) {
    char *names = listing(c);
    assert_string_equal(names, expected);
    free(names);
}

/* A model of so many patches that it is not built before it is stopped. */
static const edit great_model[] = {
    {"  sampler: explicit ", "  sampler: gpce\n  chaos: {vectors: 20000, order: 3}\n  #"},
    {NULL, NULL}};

static void laws_that_are_stopped_leave_nothing(void **state) {
    (void)state;
    case_folder c = case_create(great_model);
    static const struct {
        const char *program, *command, *says;
        int number;
    } runs[] = {{HAFT, "run", "haft: stopped while the laws were being built", SIGINT},
                {HAFT, "run", "haft: stopped while the laws were being built", SIGTERM},
                {HAFT_LAWS, "build", "haft-laws: stopped while the laws were being built", SIGINT}};
    for (size_t i = 0; i < sizeof runs / sizeof *runs; i++) {
        /* the first tenth of the patches is told after seconds: stop at the words before them */
        bool laws = strcmp(runs[i].command, "build") == 0;
        if (laws) {
            case_write(&c, (edit[]){{"realizations: 2", "realizations: 40"}, {NULL, NULL}});
        }
        ran r = stop_program(runs[i].program, ARGS(runs[i].command, c.path),
                             laws ? "laws  " : "building them", runs[i].number);
        assert_int_equal(r.code, 130);
        check_says(r.err, runs[i].says);
        assert_string_equal(r.out, "");
        ran_free(&r);
        check_listing(&c, "case.yaml ");
    }
    case_remove(&c);
}

/* Stopped before it has anything new, a forced run leaves the old one as it was. */
static void a_forced_run_that_is_stopped_leaves_the_old(void **state) {
    (void)state;
    static const char *const names[] = {"out/laws.h5", "out/laws.csv", "out/results.h5",
                                        "out/resolved.yaml", "out/summary.csv"};
    enum { FILES = sizeof names / sizeof *names };
    case_folder c = case_create(NULL);
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    char path[400], *before[FILES];
    size_t size[FILES];
    for (int i = 0; i < FILES; i++) {
        before[i] = read_whole_file(path_in(&c, names[i], path), &size[i]);
    }
    case_write(&c, great_model);
    ran r = stop_program(HAFT, ARGS("run", "--force", c.path), "building them", SIGTERM);
    assert_int_equal(r.code, 130);
    ran_free(&r);
    for (int i = 0; i < FILES; i++) {
        size_t now = 0;
        char *after = read_whole_file(path_in(&c, names[i], path), &now);
        assert_int_equal(now, size[i]);
        assert_memory_equal(after, before[i], now);
        free(after);
        free(before[i]);
    }
    case_remove(&c);
}

/* Many beams in very small steps over few laws. */
static const edit slow_beams[] = {
    {"realizations: 2", "realizations: 10"},
    {"evidence: [0]", "evidence: all"},
    {"reference:", "path: {gap_step: 0.005}\nreference:"},
    {NULL, NULL},
};

static void beams_that_are_done_are_saved(void **state) {
    (void)state;
    static const int numbers[] = {SIGINT, SIGTERM};
    for (int i = 0; i < 2; i++) {
        case_folder c = case_create(slow_beams);
        ran r = stop_program(HAFT, ARGS("run", "--threads", "1", c.path), "beams  ", numbers[i]);
        assert_int_equal(r.code, 130);
        check_says(r.err, "haft: stopped after ");
        check_says(r.err, " of 10 realizations; these are kept");
        check_says(r.out, "standard deviation");
        ran_free(&r);
        check_listing(&c, "case.yaml out out/convergence.csv out/laws.csv out/laws.h5 out/parts "
                          "out/resolved.yaml out/results.h5 out/summary.csv ");
        char path[400];
        haft_error error = {0};
        haft_results_view *view = NULL;
        check_ok(haft_results_read(&view, path_in(&c, "out/results.h5", path), &error), error);
        assert_int_equal(view->realizations, 10);
        size_t done = 0;
        for (size_t k = 0; k < 10; k++) {
            bool has = view->summary[k].outcome >= 0;
            assert_int_equal(has, isfinite(view->summary[k].crack_length));
            haft_path *p = NULL;
            haft_status status = haft_results_read_path(&p, path, k, &error);
            assert_int_equal(status == HAFT_OK, has);
            haft_path_destroy(&p);
            done += has;
        }
        assert_true(done >= 1 && done < 10);
        haft_results_view_destroy(&view);
        r = run_expect(0, HAFT, ARGS("info", "--json", c.path));
        assert_true(json_number(r.out, "run") == (double)done);
        ran_free(&r);
        r = run_expect(5, HAFT, ARGS("run", c.path));
        check_says(r.err, "an unfinished run is there already");
        check_says(r.err, "go on with it by `haft resume`, or start anew with --force");
        ran_free(&r);
        r = run_expect(0, HAFT, ARGS("resume", "--json", c.path)); /* and does what is left */
        assert_true(json_number(r.out, "run") == 10);
        ran_free(&r);
        assert_false(exists(&c, "out/parts"));
        case_remove(&c);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(laws_that_are_stopped_leave_nothing),
        cmocka_unit_test(a_forced_run_that_is_stopped_leaves_the_old),
        cmocka_unit_test(beams_that_are_done_are_saved),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
