/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs spread over MPI ranks: the same bits for any number of them, also where they are killed and
 * resumed or end by themselves; what goes wrong is told once. */
#include "same_bits.h"

#include <time.h>

#define ON_RANKS(n, ...) ARGS("-n", n, HAFT, __VA_ARGS__)

static const edit stopping[] = {
    {"realizations: 2", "realizations: 60\n  stop: {crack_length_mean: 1.2 um}"},
    {"evidence: [0]", "evidence: [0, 29, 55]"},
    {NULL, NULL}};

static void check_same_run(const case_folder *a, const case_folder *b) {
    check_same_bytes(a, b, "out/laws.h5");
    check_same_bytes(a, b, "out/results.h5");
    check_same_bytes(a, b, "out/summary.csv");
    check_same_bytes(a, b, "out/convergence.csv");
    char *names = listing(a), *others = listing(b);
    assert_string_equal(names, others);
    free(names);
    free(others);
}

static void any_number_of_ranks_gives_the_same_files(void **state) {
    (void)state;
    case_folder alone = case_create(stopping), many = case_create(stopping);
    must_run(HAFT, ARGS("run", "--quiet", "--threads", "1", alone.path));
    static const char *const ranks[] = {"1", "2", "4"};
    for (int i = 0; i < 3; i++) {
        ran r = run_expect(
            0, HAFT_MPIEXEC,
            ON_RANKS(ranks[i], "run", "--force", "--threads", i == 1 ? "2" : "1", many.path));
        const char *first = strstr(r.out, "crack length at rest");
        assert_non_null(first);
        check_silent_about(first + 1, "crack length at rest"); /* one rank speaks */
        check_says(r.err, "study.stop: ");
        ran_free(&r);
        check_same_run(&alone, &many);
    }
    case_remove(&alone);
    case_remove(&many);
}

/* Kills the ranks that mpirun started here; it ends by itself then. */
static void kill_ranks(pid_t mpirun) {
    char path[100], text[1000] = "";
    snprintf(path, sizeof path, "/proc/%ld/task/%ld/children", (long)mpirun, (long)mpirun);
    FILE *stream = fopen(path, "r");
    assert_non_null(stream);
    assert_true(fgets(text, sizeof text, stream) != NULL);
    fclose(stream);
    char *at = text;
    for (long rank = strtol(at, &at, 10); rank > 0; rank = strtol(at, &at, 10)) {
        kill((pid_t)rank, SIGKILL);
    }
}

/* Parts of ranks that were killed, taken up by another number of them; some beams have their laws
 * before, the ranks build those of the others. */
static void killed_ranks_are_resumed_by_others(void **state) {
    (void)state;
    static const edit first[] = {{"realizations: 2", "realizations: 7"}, {NULL, NULL}};
    static const edit slow[] = {{"realizations: 2", "realizations: 40"},
                                {"reference:", "path: {gap_step: 0.03}\nreference:"},
                                {NULL, NULL}};
    case_folder alone = case_create(slow), many = case_create(slow);
    must_run(HAFT, ARGS("run", "--quiet", alone.path));
    case_write(&many, first);
    must_run(HAFT_LAWS, ARGS("build", "--quiet", many.path));
    case_write(&many, slow);
    static const char *const ranks[] = {"3", "2"};
    for (int i = 0; i < 2; i++) {
        child c = start_program(
            HAFT_MPIEXEC,
            ON_RANKS(ranks[i], i == 0 ? "run" : "resume", "--threads", "1", many.path), 0);
        const char *says = i == 0 ? "beams      12 of 40" : "beams      24 of 40";
        for (bool told = false; !told && waitpid(c.pid, NULL, WNOHANG) == 0;) {
            char *text = written(c.err);
            told = strstr(text, says) != NULL;
            free(text);
            nanosleep(&(struct timespec){.tv_nsec = 2000000}, NULL);
        }
        kill_ranks(c.pid);
        ran r = end_program(c);
        assert_int_not_equal(r.code, 0);
        ran_free(&r);
    }
    ran r = run_expect(0, HAFT_MPIEXEC, ON_RANKS("4", "resume", many.path));
    check_says(r.err, "of 40 realizations are there from the unfinished run");
    ran_free(&r);
    check_same_run(&alone, &many);
    case_remove(&alone);
    case_remove(&many);
}

/* Says it once, and leaves nothing. */
static void check_told_once(const case_folder *c, int code, const char *says,
                            const char *const *args) {
    ran r = run_expect(code, HAFT_MPIEXEC, args);
    check_says(r.err, says);
    const char *first = strstr(r.err, "haft: ");
    assert_non_null(first);
    check_silent_about(first + 6, "haft: ");
    assert_string_equal(r.out, "");
    ran_free(&r);
    (void)c;
}

static void what_goes_wrong_is_told_once(void **state) {
    (void)state;
    case_folder c = case_create((edit[]){{"realizations: 2", "realizations: 6"},
                                         {"f_limit: 5 MPa", "f_limit: 500 MPa"},
                                         {"unfit: table", "unfit: stop"},
                                         {NULL, NULL}});
    char path[400];
    check_told_once(&c, 3, "realization 0: ", ON_RANKS("3", "run", "--quiet", c.path));
    assert_false(exists(&c, "out/parts"));
    case_write(&c, (edit[]){{"thickness: 1 um", "thicknes: 1 um"}, {NULL, NULL}});
    check_told_once(&c, 3, "did you mean thickness?", ON_RANKS("3", "run", "--quiet", c.path));
    check_told_once(&c, 2, "no command \"fly\"", ON_RANKS("3", "fly", c.path));
    case_write(&c, NULL);
    assert_int_equal(mkdir(path_in(&c, "out", path), 0777), 0);
    write_file(path_in(&c, "out/laws.h5", path), "no laws", 7);
    check_told_once(&c, 3, "haft-laws build", ON_RANKS("3", "run", "--quiet", c.path));
    unlink(path);
    must_run(HAFT_MPIEXEC, ON_RANKS("3", "run", "--quiet", c.path));
    check_told_once(&c, 5, "is there already", ON_RANKS("3", "run", "--quiet", c.path));
    case_remove(&c);
}

/* A sweep ends on all ranks where it ends on one: a second run is refused, and no rank waits on. */
static void a_refused_sweep_ends_on_all_ranks(void **state) {
    (void)state;
    static const edit swept[] = {{"  element_length: 3 um\n", ""},
                                 {"study:", "sweep: {beam.element_length: [3 um, 5 um]}\nstudy:"},
                                 {0}};
    case_folder c = case_create(swept);
    must_run(HAFT_MPIEXEC, ON_RANKS("2", "run", "--quiet", "--threads", "1", c.path));
    ran r = run_expect(5, HAFT_MPIEXEC, ON_RANKS("2", "run", "--threads", "1", c.path));
    check_says(r.err, "variant 00_element_length-3um");
    ran_free(&r);
    case_remove(&c);
}

int main(void) {
    /* of Open MPI: more ranks than processors, and whoever runs the tests */
    setenv("OMPI_MCA_rmaps_base_oversubscribe", "1", 1);
    setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
    setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_number_of_ranks_gives_the_same_files),
        cmocka_unit_test(killed_ranks_are_resumed_by_others),
        cmocka_unit_test(what_goes_wrong_is_told_once),
        cmocka_unit_test(a_refused_sweep_ends_on_all_ranks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
