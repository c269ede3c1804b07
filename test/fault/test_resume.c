/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs that were killed, cut short or damaged are resumed, and end in the same bits as one that was
 * left alone; what was computed and is whole is not computed again. */
#include "same_bits.h"

#include "haft/study.h"

#include <time.h>

enum { BEAMS = 6 };

static const edit few[] = {
    {"realizations: 2", "realizations: 6"}, {"evidence: [0]", "evidence: [1, 4]"}, {NULL, NULL}};

/* ---- kill -9 ---- */

enum { KILLS = 20, KILLS_OF_LAWS = 10 };

/* The bytes in a case's parts: how far a run that is going on has come. */
static off_t bytes_kept(const case_folder *c) {
    struct dirent **entry = NULL;
    char folder[400], path[800];
    int n = scandir(path_in(c, "out/parts", folder), &entry, NULL, NULL);
    off_t bytes = 0;
    for (int i = 0; i < n; i++) {
        struct stat facts;
        snprintf(path, sizeof path, "%s/%s", folder, entry[i]->d_name);
        if (stat(path, &facts) == 0 && S_ISREG(facts.st_mode)) {
            bytes += facts.st_size;
        }
        free(entry[i]);
    }
    free(entry);
    return bytes;
}

static void wait_for(double seconds) {
    nanosleep(
        &(struct timespec){.tv_sec = (time_t)seconds, .tv_nsec = (long)(fmod(seconds, 1) * 1e9)},
        NULL);
}

static bool has_ended(const child *c) {
    siginfo_t ended = {0};
    assert_int_equal(waitid(P_PID, (id_t)c->pid, &ended, WEXITED | WNOHANG | WNOWAIT), 0);
    return ended.si_pid != 0;
}

/* Kills a program at a drawn moment of its work, whatever else the machine does: when it has begun
 * to tell, or when its parts have grown one to three times and a share of the time of the last
 * growth has passed. It may have ended before. */
static void kill_at(uint64_t draw, const case_folder *c, const child *running) {
    uint64_t w[4];
    haft_random_words((haft_random_key){1, HAFT_RANDOM_TEST}, draw, 0, 0, w);
    int growths = (int)(w[0] % 4);
    off_t kept = bytes_kept(c);
    double last = haft_clock_seconds(), lasted = 0;
    struct stat told = {0};
    while ((growths > 0 || told.st_size == 0) && !has_ended(running)) {
        off_t bytes = bytes_kept(c);
        if (bytes > kept) {
            growths--;
            lasted = haft_clock_seconds() - last;
            last += lasted;
        }
        kept = bytes;
        assert_int_equal(fstat(fileno(running->err), &told), 0);
        wait_for(2e-4);
    }
    wait_for(haft_random_uniform(w[1]) * lasted);
    assert_int_equal(kill(running->pid, SIGKILL), 0);
}

/* How many realizations its parts hold, as `haft run` tells when it refuses; 0 if there are none.
 */
static int count_kept(const case_folder *c) {
    int kept = 0;
    if (exists(c, "out/parts/part-0-0")) {
        ran r = run_expect(5, HAFT, ARGS("run", c->path));
        check_says(r.err, "`haft resume`");
        check_says(r.err, "with ");
        const char *at = strstr(r.err, "with ");
        assert_int_equal(sscanf(at, "with %d of 16 realizations", &kept), 1);
        ran_free(&r);
    }
    return kept;
}

static const edit slow[] = {{"realizations: 2", "realizations: 16"},
                            {"evidence: [0]", "evidence: all"},
                            {"reference:", "path: {gap_step: 0.03}\nreference:"},
                            {NULL, NULL}};

/* Laws that take longer than their beams: 7.5 nm instead of 10. */
static const edit slow_laws[] = {{"realizations: 2", "realizations: 16"},
                                 {"grid_step: 10 nm", "grid_step: 7.5 nm"},
                                 {"element_length: 3 um\n  mesh: uniform ", "mesh: active "},
                                 {NULL, NULL}};

/* Kills, resumes and compares; with the laws there from the start, or built beam by beam. */
static void kill_often(const edit *edits, bool laws_first, uint64_t kills) {
    case_folder whole = case_create(edits), killed = case_create(edits);
    if (laws_first) {
        must_run(HAFT_LAWS, ARGS("build", "--quiet", whole.path));
        copy_laws(&whole, &killed);
    }
    must_run(HAFT, ARGS("run", "--quiet", "--threads", "2", whole.path));
    int kept = 0;
    uint64_t halfway = 0;
    for (uint64_t i = 0; i < kills; i++) {
        const char *const *args = kept > 0 ? ARGS("resume", "--threads", "2", killed.path)
                                           : ARGS("run", "--force", "--threads", "2", killed.path);
        child c = start_program(HAFT, args, 0);
        kill_at(i, &killed, &c);
        ran r = end_program(c);
        bool complete = r.code == 0;
        assert_true(complete || r.code == 1000 + SIGKILL);
        ran_free(&r);
        int found = count_kept(&killed);
        assert_true(complete || found >= kept || found == 0);
        if (!complete && found < kept) { /* all are in the results, or some are lost */
            r = run_expect(0, HAFT, ARGS("resume", killed.path));
            check_says(r.err, "nothing is left to do");
            ran_free(&r);
        }
        halfway += found > 0 && found < 16;
        if (!laws_first && found == 0) { /* what is begun anew builds its laws anew */
            char path[400];
            unlink(path_in(&killed, "out/laws.h5", path));
        }
        kept = found;
    }
    assert_true(5 * halfway >= 2 * kills); /* the kills came where they hurt */
    must_run(HAFT, kept > 0 ? ARGS("resume", "--quiet", killed.path)
                            : ARGS("run", "--quiet", "--force", killed.path));
    check_same_bytes(&whole, &killed, "out/results.h5");
    check_same_bytes(&whole, &killed, "out/summary.csv");
    check_same_bytes(&whole, &killed, "out/convergence.csv");
    check_same_bytes(&whole, &killed, "out/laws.h5");
    char *names = listing(&whole), *names_after = listing(&killed);
    assert_string_equal(names, names_after); /* no temporary file either */
    free(names);
    free(names_after);
    case_remove(&whole);
    case_remove(&killed);
}

static void a_run_killed_twenty_times_gives_the_same_files(void **state) {
    (void)state;
    kill_often(slow, true, KILLS);
}

static void so_does_one_killed_while_it_builds_laws(void **state) {
    (void)state;
    kill_often(slow_laws, false, KILLS_OF_LAWS);
}

/* ---- damage ---- */

/* A case whose run failed at the last moment, so that all its realizations are in one part, in
 * their order. */
typedef struct broken_run {
    case_folder c;
    char part[400], results[400];
    char *bytes;
    size_t size;
    size_t record[BEAMS + 1]; /* where each begins; and the end */
} broken_run;

/* The run that nothing happened to, the same for all tests, and only read. */
static case_folder few_whole;

static int run_whole(void **state) {
    (void)state;
    few_whole = case_create(few);
    must_run(HAFT, ARGS("run", "--quiet", few_whole.path));
    return 0;
}

static int remove_whole(void **state) {
    (void)state;
    case_remove(&few_whole);
    return 0;
}

static broken_run break_run(void) {
    broken_run b = {.c = case_create(few)};
    char path[400];
    copy_laws(&few_whole, &b.c);
    assert_int_equal(mkdir(path_in(&b.c, "out/summary.csv", path), 0777), 0);
    ran r = run_expect(4, HAFT, ARGS("run", "--quiet", "--threads", "1", b.c.path));
    check_says(r.err, "the 6 realizations done are kept");
    ran_free(&r);
    assert_int_equal(rmdir(path), 0);
    path_in(&b.c, "out/results.h5", b.results);
    b.bytes = read_whole_file(path_in(&b.c, "out/parts/part-0-0", b.part), &b.size);
    size_t n = 0;
    for (size_t i = 0; i + 8 <= b.size; i++) {
        if (memcmp(b.bytes + i, "haftreal", 8) == 0) {
            assert_true(n < BEAMS);
            b.record[n++] = i;
        }
    }
    assert_int_equal(n, BEAMS);
    b.record[BEAMS] = b.size;
    return b;
}

/* Puts other bytes in the part's place, as if the results had never been written. */
static void put_part(const broken_run *b, const char *bytes, size_t size) {
    char path[400];
    mkdir(path_in(&b->c, "out/parts", path), 0777);
    write_file(b->part, bytes, size);
    unlink(b->results);
}

/* Resumes, and checks what is said, how many were found, and that the results are those of the
 * whole run; those found were not computed again: their times are what they were. */
static void check_resumed(const broken_run *b, const char *says, int found) {
    char text[100];
    snprintf(text, sizeof text, "%d of 6 realizations are there", found);
    ran r = run_expect(0, HAFT, ARGS("resume", b->c.path));
    if (says != NULL) {
        check_says(r.err, says);
        check_says(r.err, b->part);
    }
    check_says(r.err, text);
    ran_free(&r);
    check_same_bytes(&few_whole, &b->c, "out/results.h5");
    check_same_bytes(&few_whole, &b->c, "out/summary.csv");
    assert_false(exists(&b->c, "out/parts"));
}

static void end_broken(broken_run *b) {
    free(b->bytes);
    case_remove(&b->c);
}

static void a_torn_tail_is_dropped(void **state) {
    (void)state;
    broken_run b = break_run();
    check_resumed(&b, NULL, 6); /* the results were there, what lies beside them was not */
    size_t last = b.record[5], cuts[] = {last + 1, last + 87, last + 88, b.size - 1};
    for (size_t i = 0; i < sizeof cuts / sizeof *cuts; i++) {
        put_part(&b, b.bytes, cuts[i]);
        check_resumed(&b, "its last record was cut short", 5);
    }
    put_part(&b, b.bytes, last); /* nothing is torn */
    check_resumed(&b, NULL, 5);
    put_part(&b, b.bytes, 100);
    check_resumed(&b, "ends within its head", 0);
    end_broken(&b);
}

static double seconds_of(const char *path, size_t realization) {
    haft_error error = {0};
    haft_results_view *view = NULL;
    check_ok(haft_results_read(&view, path, &error), error);
    double seconds = view->summary[realization].seconds;
    haft_results_view_destroy(&view);
    return seconds;
}

static void a_damaged_record_is_told_and_skipped(void **state) {
    (void)state;
    broken_run b = break_run();
    double seconds[BEAMS];
    for (size_t k = 0; k < BEAMS; k++) {
        seconds[k] = seconds_of(b.results, k);
    }
    haft_random_key key = {2, HAFT_RANDOM_TEST};
    for (uint64_t i = 0; i < 8; i++) {
        uint64_t w[4];
        haft_random_words(key, i, 0, 0, w);
        size_t k = w[0] % BEAMS, from = b.record[k], length = b.record[k + 1] - from;
        size_t at = from + w[1] % (i % 2 == 0 ? 88 : length); /* its head, or anywhere */
        b.bytes[at] ^= (char)(1 << w[2] % 8);
        put_part(&b, b.bytes, b.size);
        char says[100];
        snprintf(says, sizeof says, at < from + 88 ? "bytes %zu to " : "the record at byte %zu, of",
                 from);
        check_resumed(&b, says, 5);
        b.bytes[at] ^= (char)(1 << w[2] % 8);
        for (size_t j = 0; j < BEAMS; j++) { /* the others are the very records of before */
            assert_true(j == k || seconds_of(b.results, j) == seconds[j]);
        }
    }
    b.bytes[60] ^= 1; /* in the head: whose records these are cannot be told */
    put_part(&b, b.bytes, b.size);
    check_resumed(&b, "its head is damaged", 0);
    end_broken(&b);
}

/* A realization that two parts hold, and a file that is none. */
static void parts_that_overlap_or_are_none_do_no_harm(void **state) {
    (void)state;
    broken_run b = break_run();
    char other[400];
    put_part(&b, b.bytes, b.record[4]);
    write_file(path_in(&b.c, "out/parts/part-1-0", other), b.bytes, b.record[5]);
    write_file(path_in(&b.c, "out/parts/part-7-0", other),
               "some text of no part, long enough to "
               "hold a head if it were one: 0123456789 0123456789 0123456789 0123456789 0123456789 "
               "0123456789 0123456789 0123456789",
               153);
    ran r = run_expect(0, HAFT, ARGS("resume", b.c.path));
    check_says(r.err, "5 of 6 realizations are there");
    check_says(r.err, "part-7-0: ");
    ran_free(&r);
    check_same_bytes(&few_whole, &b.c, "out/results.h5");
    assert_false(exists(&b.c, "out/parts"));
    end_broken(&b);
}

/* ---- what does not fit ---- */

static void parts_of_another_case_are_refused(void **state) {
    (void)state;
    broken_run b = break_run();
    edit changed[4] = {few[0], few[1], {"thickness: 1 um", "thickness: 1.1 um"}, {NULL, NULL}};
    unlink(b.results);
    case_write(&b.c, changed);
    ran r = run_expect(3, HAFT, ARGS("resume", b.c.path));
    check_says(r.err, b.part);
    check_says(r.err, "there \"thickness: 9.9999999999999995e-07 m\"");
    check_says(r.err, "here \"thickness: 1.1000000000000001e-06 m\"");
    check_says(r.err, "put case.yaml back as it was; to start anew, give `haft run --force`");
    ran_free(&r);
    r = run_expect(5, HAFT, ARGS("run", b.c.path));
    check_says(r.err, "an unfinished run is there already");
    check_says(r.err, "belongs to another case");
    ran_free(&r);
    size_t size = 0;
    char *kept = read_whole_file(b.part, &size);
    assert_int_equal(size, b.size);
    assert_memory_equal(kept, b.bytes, size);
    free(kept);
    /* both ways out work */
    case_write(&b.c, few);
    check_resumed(&b, NULL, 6);
    put_part(&b, b.bytes, b.size);
    case_write(&b.c, changed);
    must_run(HAFT, ARGS("run", "--quiet", "--force", b.c.path));
    assert_false(exists(&b.c, "out/parts"));
    end_broken(&b);
}

/* Sets a text in a part's head, under a checksum that fits. */
static void forge(broken_run *b, size_t offset, const char *text) {
    enum { DIGEST = 128, TEXT = 168 }; /* where they are in the head */
    char digest[HAFT_DIGEST_CAPACITY];
    size_t size = b->record[0] - TEXT;
    char *all = malloc(DIGEST + size);
    assert_non_null(all);
    memcpy(b->bytes + offset, text, strlen(text));
    memcpy(all, b->bytes, DIGEST);
    memcpy(all + DIGEST, b->bytes + TEXT, size);
    haft_digest_memory(all, DIGEST + size, digest);
    memcpy(b->bytes + DIGEST, digest, sizeof digest);
    free(all);
    put_part(b, b->bytes, b->size);
}

static void parts_of_another_build_or_other_laws_are_refused(void **state) {
    (void)state;
    enum { LAYOUT = 8, PROGRAM = 24, LAWS = 88 };
    broken_run b = break_run();
    static const struct {
        size_t offset;
        const char *text, *says;
    } forgeries[] = {{LAWS, "0123456789abcdef", "was computed with other laws"},
                     {PROGRAM, "9.9.9", "was made by another build of the program, 9.9.9"},
                     {LAYOUT, "\x7f", "another layout"}};
    for (size_t i = 0; i < sizeof forgeries / sizeof *forgeries; i++) {
        forge(&b, forgeries[i].offset, forgeries[i].text);
        ran r = run_expect(3, HAFT, ARGS("resume", b.c.path));
        check_says(r.err, b.part);
        check_says(r.err, forgeries[i].says);
        check_says(r.err, "haft run --force`");
        ran_free(&r);
        assert_true(exists(&b.c, "out/parts/part-0-0"));
    }
    must_run(HAFT, ARGS("run", "--quiet", "--force", b.c.path));
    check_same_bytes(&few_whole, &b.c, "out/results.h5");
    end_broken(&b);
}

static void a_complete_run_is_left_as_it_is(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    ran r = run_expect(3, HAFT, ARGS("resume", c.path));
    check_says(r.err, "there is no unfinished run to resume; start one with `haft run`");
    ran_free(&r);
    char *names = listing(&c), path[400];
    assert_string_equal(names, "case.yaml ");
    free(names);
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    size_t size = 0, again = 0;
    char *before = read_whole_file(path_in(&c, "out/results.h5", path), &size);
    r = run_expect(0, HAFT, ARGS("resume", "--json", c.path));
    check_says(r.err, "the run is complete: nothing is left to do");
    assert_true(json_number(r.out, "run") == 2);
    ran_free(&r);
    case_write(&c, (edit[]){{"thickness: 1 um", "thickness: 1.1 um"}, {NULL, NULL}});
    r = run_expect(3, HAFT, ARGS("resume", c.path));
    check_says(r.err, "is of another case.yaml");
    check_says(r.err, "`haft run --force`");
    ran_free(&r);
    char *after = read_whole_file(path, &again);
    assert_int_equal(size, again);
    assert_memory_equal(before, after, size);
    assert_false(exists(&c, "out/parts"));
    free(before);
    free(after);
    case_remove(&c);
}

/* Killed at the very end, while the parts were removed: whichever were left, nothing is done again.
 */
static void parts_half_removed_are_none(void **state) {
    (void)state;
    broken_run b = break_run();
    char path[400], aside[500], part[600], names[600];
    must_run(HAFT, ARGS("resume", "--quiet", b.c.path));
    char *whole = listing(&b.c);
    child gone = start_program(HAFT, ARGS("--version"), 0);
    snprintf(aside, sizeof aside, "%s.tmp.%ld", path_in(&b.c, "out/parts", path), (long)gone.pid);
    ran r = end_program(gone);
    ran_free(&r);
    assert_int_equal(mkdir(aside, 0777), 0);
    snprintf(part, sizeof part, "%s/part-1-0", aside);
    write_file(part, b.bytes, b.record[3]);
    snprintf(names, sizeof names, "%s/lock", aside);
    write_file(names, "", 0);
    r = run_expect(0, HAFT, ARGS("resume", b.c.path));
    check_says(r.err, "the run is complete: nothing is left to do");
    ran_free(&r);
    char *after = listing(&b.c);
    assert_string_equal(whole, after);
    free(whole);
    free(after);
    end_broken(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_run_killed_twenty_times_gives_the_same_files),
        cmocka_unit_test(so_does_one_killed_while_it_builds_laws),
        cmocka_unit_test(a_torn_tail_is_dropped),
        cmocka_unit_test(a_damaged_record_is_told_and_skipped),
        cmocka_unit_test(parts_that_overlap_or_are_none_do_no_harm),
        cmocka_unit_test(parts_of_another_case_are_refused),
        cmocka_unit_test(parts_of_another_build_or_other_laws_are_refused),
        cmocka_unit_test(a_complete_run_is_left_as_it_is),
        cmocka_unit_test(parts_half_removed_are_none),
    };
    return cmocka_run_group_tests(tests, run_whole, remove_whole);
}
