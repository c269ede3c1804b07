/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A run split into shards that know nothing of each other: joined, they are the same bits as one
 * run, in whatever order they came and however often they were killed; what lacks, is at work, or
 * does not belong there is told in one message. */
#include "same_bits.h"

#include <sys/file.h>
#include <time.h>

#define DRAWN                                                                                      \
    { "  sampler: explicit ", "  sampler: gpce\n  chaos: {vectors: 60, order: 3}\n  #" }

static const edit seven[] = {
    {"realizations: 2", "realizations: 7"}, {"evidence: [0]", "evidence: [1, 5]"}, {NULL, NULL}};

#define SHARD(shard, c) ARGS("run", "--quiet", "--shard=" shard, (c).path)

static void check_joined(const case_folder *whole, const case_folder *shards) {
    static const char *const same[] = {"out/results.h5", "out/laws.h5", "out/summary.csv",
                                       "out/convergence.csv", "out/laws.csv"};
    for (size_t i = 0; i < sizeof same / sizeof *same; i++) {
        check_same_bytes(whole, shards, same[i]);
    }
    char *names = listing(whole), *others = listing(shards);
    assert_string_equal(names, others); /* no part, no lock, no temporary file */
    free(names);
    free(others);
}

/* One message, and what it says. */
static void check_message(const char *text, const char *format, ...) HAFT_PRINTF(2, 3);
static void check_message(const char *text, const char *format, ...) {
    char says[1000];
    va_list list;
    va_start(list, format);
    vsnprintf(says, sizeof says, format, list);
    va_end(list);
    check_says(text, says);
    assert_int_equal(strncmp(text, "haft: ", 6), 0);
    check_silent_about(text + 6, "haft: ");
}

/* Each beam's laws are built by the shard that follows it, as nothing was built before. */
static void shards_in_any_order_are_one_run(void **state) {
    (void)state;
    case_folder whole = case_create(seven), c = case_create(seven);
    must_run(HAFT, ARGS("run", "--quiet", whole.path));
    must_run(HAFT, SHARD("3/3", c));
    must_run(HAFT, SHARD("1/3", c));
    ran r = run_expect(3, HAFT, ARGS("merge", "--quiet", c.path));
    check_message(r.err,
                  "%s/out/parts: 5 of 7 realizations are there; shard 2 lacks the others: do it by "
                  "`haft run %s --shard=2/3`, or all that lacks by `haft resume %s`",
                  c.path, c.path, c.path);
    assert_string_equal(r.out, "");
    ran_free(&r);
    assert_false(exists(&c, "out/results.h5"));
    r = run_expect(0, HAFT, ARGS("run", "--shard=2/3", c.path));
    check_says(r.err, "shard 2/3 is done: its 2 realizations are kept in ");
    check_says(r.err, "`haft merge ");
    assert_string_equal(r.out, "");
    ran_free(&r);
    r = run_expect(0, HAFT, ARGS("merge", "--json", c.path));
    assert_true(json_number(r.out, "run") == 7);
    ran_free(&r);
    check_joined(&whole, &c);
    r = run_expect(0, HAFT, ARGS("merge", c.path)); /* again does no harm */
    check_says(r.err, "the run is complete");
    ran_free(&r);
    case_remove(&whole);
    case_remove(&c);
}

/* Shards at once; the first is killed while it works and goes on, over parts of the others. */
static void a_killed_shard_goes_on(void **state) {
    (void)state;
    static const edit slow[] = {DRAWN,
                                {"realizations: 2", "realizations: 20"},
                                {"reference:", "path: {gap_step: 0.03}\nreference:"},
                                {NULL, NULL}};
    case_folder whole = case_create(slow), c = case_create(slow);
    must_run(HAFT, ARGS("run", "--quiet", whole.path));
    copy_laws(&whole, &c);
    child first = start_program(HAFT, ARGS("run", "--threads=1", "--shard=1/2", c.path), 0);
    child second = start_program(HAFT, SHARD("2/2", c), 0);
    for (bool told = false; !told && waitpid(first.pid, NULL, WNOHANG) == 0;) {
        char *text = written(first.err);
        told = strstr(text, "3 of 10") != NULL;
        free(text);
        nanosleep(&(struct timespec){.tv_nsec = 2000000}, NULL);
    }
    assert_int_equal(kill(first.pid, SIGKILL), 0);
    ran r = end_program(first);
    assert_int_equal(r.code, 1000 + SIGKILL);
    ran_free(&r);
    r = end_program(second);
    assert_int_equal(r.code, 0);
    ran_free(&r);
    /* what a killed one leaves bars nobody */
    r = run_expect(3, HAFT, ARGS("merge", c.path));
    check_says(r.err, "; shard 1 lacks the others: do it by `haft run ");
    ran_free(&r);
    r = run_expect(0, HAFT, ARGS("run", "--shard=1/2", c.path));
    check_says(r.err, " of 10 realizations are there from the unfinished run");
    ran_free(&r);
    must_run(HAFT, ARGS("merge", "--quiet", c.path));
    check_joined(&whole, &c);
    case_remove(&whole);
    case_remove(&c);
}

/* A run takes over what shards have done, and sees to the rest. */
static void resuming_does_what_shards_lack(void **state) {
    (void)state;
    case_folder whole = case_create(seven), c = case_create(seven);
    must_run(HAFT, ARGS("run", "--quiet", whole.path));
    must_run(HAFT, SHARD("4/4", c));
    ran r = run_expect(3, HAFT, ARGS("merge", c.path));
    check_says(r.err, "shards 1, 2 and 3 lack the others: do each of them by `haft run ");
    check_says(r.err, "--shard=I/4`");
    ran_free(&r);
    r = run_expect(5, HAFT, ARGS("run", c.path));
    check_says(r.err, "`haft resume`");
    ran_free(&r);
    must_run(HAFT, ARGS("resume", "--quiet", c.path));
    check_joined(&whole, &c);
    r = run_expect(5, HAFT, SHARD("1/4", c));
    check_says(r.err, "results.h5 is there already; add --force to replace it");
    ran_free(&r);
    case_remove(&whole);
    case_remove(&c);
}

/* Shards of machines that share nothing: their parts are copied into one folder. Among them may be
 * realizations twice; a stop rule is looked at where they are joined. */
static void copied_parts_are_joined(void **state) {
    (void)state;
    static const edit stopping[] = {
        {"realizations: 2", "realizations: 40\n  stop: {crack_length_mean: 4 um}"},
        DRAWN,
        {NULL, NULL}};
    case_folder whole = case_create(stopping), a = case_create(stopping), b = case_create(stopping);
    ran r = run_expect(0, HAFT, ARGS("run", whole.path));
    copy_laws(&whole, &a);
    copy_laws(&whole, &b);
    check_says(r.err, "after 30 of 40 realizations");
    ran_free(&r);
    must_run(HAFT, SHARD("1/2", a));
    must_run(HAFT, SHARD("2/2", b));
    char from[400], to[400];
    size_t size = 0;
    char *part = read_whole_file(path_in(&b, "out/parts/part-2of2-0-0", from), &size);
    write_file(path_in(&a, "out/parts/part-2of2-0-0", to), part, size);
    write_file(path_in(&a, "out/parts/part-2of2-0-1", to), part, size);
    free(part);
    r = run_expect(0, HAFT, ARGS("merge", a.path));
    check_says(r.err, "20 realizations are there more than once, to the same bits");
    check_says(r.err, "study.stop: ");
    ran_free(&r);
    check_joined(&whole, &a);
    case_remove(&whole);
    case_remove(&a);
    case_remove(&b);
}

static void what_does_not_belong_together_is_told(void **state) {
    (void)state;
    case_folder c = case_create(seven);
    must_run(HAFT, SHARD("1/3", c));
    ran r = run_expect(5, HAFT, SHARD("1/2", c));
    check_message(r.err,
                  "out/parts/part-1of3-0-0: the run is split into 3 shards, not into 2; go on with "
                  "those, or move their parts away");
    ran_free(&r);
    case_write(&c, (edit[]){seven[0], {"thickness: 1 um", "thickness: 1.1 um"}, {NULL, NULL}});
    must_run(HAFT, SHARD("2/3", c)); /* it sees its own alone */
    const char *const *tries[] = {ARGS("merge", c.path), SHARD("1/3", c)};
    for (int i = 0; i < 2; i++) {
        r = run_expect(3, HAFT, tries[i]);
        check_message(r.err, "part-1of3-0-0: belongs to another case: there \"thickness: 9.99");
        ran_free(&r);
    }
    assert_false(exists(&c, "out/results.h5"));
    must_run(HAFT, ARGS("run", "--quiet", "--force", "--shard=1/3", c.path));
    must_run(HAFT, SHARD("3/3", c));
    must_run(HAFT, ARGS("merge", "--quiet", c.path));
    case_remove(&c);
}

static int hold(const case_folder *c, const char *name, int how) {
    char path[400];
    int descriptor = open(path_in(c, name, path), O_RDWR | O_CREAT, 0666);
    assert_true(descriptor >= 0);
    assert_int_equal(flock(descriptor, how), 0);
    return descriptor;
}

static void shards_at_work_are_left_alone(void **state) {
    (void)state;
    case_folder c = case_create(seven);
    must_run(HAFT, SHARD("1/2", c));
    int folder = hold(&c, "out/parts/lock", LOCK_SH),
        own = hold(&c, "out/parts/lock-1of2", LOCK_EX);
    ran r = run_expect(5, HAFT, SHARD("1/2", c));
    check_message(r.err, "out/parts: shard 1/2 is at work already; wait for its end or stop it");
    ran_free(&r);
    r = run_expect(5, HAFT, ARGS("merge", c.path));
    check_message(r.err, "a run of this case is there already, at work");
    ran_free(&r);
    must_run(HAFT, SHARD("2/2", c));
    close(own);
    close(folder);
    folder = hold(&c, "out/parts/lock", LOCK_EX); /* a run that joins them */
    r = run_expect(5, HAFT, SHARD("2/2", c));
    check_message(r.err, "a run of this case is there already, at work");
    ran_free(&r);
    close(folder);
    must_run(HAFT, ARGS("merge", "--quiet", c.path));
    assert_false(exists(&c, "out/parts"));
    case_remove(&c);
}

static void shards_share_a_model_that_was_built_before(void **state) {
    (void)state;
    static const edit drawn[] = {DRAWN, {NULL, NULL}};
    case_folder whole = case_create(drawn), c = case_create(drawn);
    ran r = run_expect(3, HAFT, SHARD("1/2", c));
    check_message(r.err,
                  "%s/out/laws.h5 is not there, the model that all shards draw from; build it by "
                  "`haft-laws build %s`",
                  c.path, c.path);
    ran_free(&r);
    char *names = listing(&c);
    assert_string_equal(names, "case.yaml ");
    free(names);
    must_run(HAFT, ARGS("run", "--quiet", whole.path));
    must_run(HAFT_LAWS, ARGS("build", "--quiet", c.path));
    must_run(HAFT, SHARD("2/2", c));
    must_run(HAFT, SHARD("1/2", c));
    must_run(HAFT, ARGS("merge", "--quiet", c.path));
    check_joined(&whole, &c);
    case_remove(&whole);
    case_remove(&c);
}

static void wrong_command_lines_are_told(void **state) {
    (void)state;
    static const edit swept[] = {{"  element_length: 3 um\n", ""},
                                 {"study:", "sweep: {beam.element_length: [3 um, 5 um]}\nstudy:"},
                                 {NULL, NULL}};
    case_folder c = case_create(swept);
    static const char *const wrong[] = {"0/3", "4/3", "1", "1/3x", "-1/3", "1/", "/3", "1/3/4"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        ran r = run_expect(2, HAFT, ARGS("run", "--shard", wrong[i], c.path));
        check_says(r.err, "--shard must be I/N, as in 2/8, with I from 1 to N");
        ran_free(&r);
    }
    ran r = run_expect(2, HAFT, ARGS("merge", "--shard=1/3", c.path));
    check_says(r.err, "--shard belongs to run");
    ran_free(&r);
    r = run_expect(2, HAFT, ARGS("run", "--json", "--shard=1/3", c.path));
    check_says(r.err, "without --json");
    ran_free(&r);
    r = run_expect(3, HAFT, SHARD("1/3", c));
    check_says(r.err, "holds a sweep; this is for one case");
    ran_free(&r);
    case_write(&c, NULL);
    r = run_expect(3, HAFT, ARGS("merge", c.path));
    check_message(r.err, "there is no unfinished run to merge; start one with `haft run`");
    ran_free(&r);
    char *names = listing(&c);
    assert_string_equal(names, "case.yaml ");
    free(names);
    case_remove(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shards_in_any_order_are_one_run),
        cmocka_unit_test(a_killed_shard_goes_on),
        cmocka_unit_test(resuming_does_what_shards_lack),
        cmocka_unit_test(copied_parts_are_joined),
        cmocka_unit_test(what_does_not_belong_together_is_told),
        cmocka_unit_test(shards_at_work_are_left_alone),
        cmocka_unit_test(shards_share_a_model_that_was_built_before),
        cmocka_unit_test(wrong_command_lines_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
