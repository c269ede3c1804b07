/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files that are not Haft's in the folders it works in: none is read, moved or removed, whatever is
 * begun, forced, stopped, resumed or merged, and none keeps a run from its end. */
#include "program.h"

/* Names close to Haft's own: a part is part-RANK-NUMBER or part-IofN-RANK-NUMBER, a lock is lock or
 * lock-IofN. */
static const char *const foreign[] = {
    "part-notes.txt", "part-0-0.bak",  "part-0",          "part-00-0", "part--1-0", "part-0-0-0",
    "part-1of2-0",    "part-3of2-0-0", "part-0of2-0-0",   "part- 0-0", "part-+0-0", "Part-0-0",
    "lock.txt",       "lock-1of2.old", "lockpick",        "lock-",     "lock-0of2", "notes",
    "part-1of2-0-0 ", "part-1of2-0-x", "part-1of2-0-0.h5"};
enum { FOREIGN = sizeof foreign / sizeof *foreign };

static void put_foreign(const char *folder) {
    char path[800];
    for (size_t i = 0; i < FOREIGN; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, foreign[i]);
        write_file(path, foreign[i], strlen(foreign[i]));
    }
    snprintf(path, sizeof path, "%s/subfolder", folder);
    assert_true(mkdir(path, 0777) == 0 || errno == EEXIST);
}

/* All are there as they were, and besides them `own` other entries. */
static void check_foreign(const char *folder, int own) {
    char path[800];
    for (size_t i = 0; i < FOREIGN; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, foreign[i]);
        char *text = read_whole_file(path, NULL);
        assert_string_equal(text, foreign[i]);
        free(text);
    }
    struct dirent **entry = NULL;
    int n = scandir(folder, &entry, NULL, NULL);
    for (int i = 0; i < n; i++) {
        free(entry[i]);
    }
    free(entry);
    assert_int_equal(n, FOREIGN + 3 + own); /* the folder within, . and .. */
}

/* Puts foreign files into out/parts before a run, and looks after each step. */
static void no_run_touches_foreign_files(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    char parts[400], path[400];
    assert_int_equal(mkdir(path_in(&c, "out", path), 0777), 0);
    assert_int_equal(mkdir(path_in(&c, "out/parts", parts), 0777), 0);
    put_foreign(parts);
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    check_foreign(parts, 0);
    must_run(HAFT, ARGS("run", "--quiet", "--force", c.path));
    check_foreign(parts, 0);
    must_run(HAFT, ARGS("resume", "--quiet", c.path));
    check_foreign(parts, 0);
    assert_int_equal(unlink(path_in(&c, "out/results.h5", path)), 0);
    must_run(HAFT, ARGS("run", "--quiet", "--shard=1/2", c.path));
    check_foreign(parts, 1);
    must_run(HAFT, ARGS("run", "--quiet", "--shard=2/2", c.path));
    check_foreign(parts, 2);
    must_run(HAFT, ARGS("merge", "--quiet", c.path));
    check_foreign(parts, 0);
    assert_true(exists(&c, "out/results.h5"));
    char *names = listing(&c);
    check_silent_about(names, ".tmp.");
    free(names);
    case_remove(&c);
}

/* A process that is no more, by its number. */
static pid_t dead_process(void) {
    pid_t process = fork();
    assert_true(process >= 0);
    if (process == 0) {
        _exit(0);
    }
    assert_int_equal(waitpid(process, NULL, 0), process);
    return process;
}

static bool is_there(const char *format, const char *folder, pid_t process) {
    char path[800];
    struct stat facts;
    snprintf(path, sizeof path, format, folder, (long)process);
    return lstat(path, &facts) == 0;
}

/* What a killed run leaves is removed by the next, with the parts in it; nothing else is. */
static void only_own_leavings_are_removed(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    char out[400], path[800];
    pid_t dead = dead_process();
    assert_int_equal(mkdir(path_in(&c, "out", out), 0777), 0);
    static const char *const own[] = {"%s/results.h5.tmp.%ld", "%s/laws.h5.tmp.%ld.3"};
    static const char *const others[] = {"%s/results.h5.tmp.%ld.old", "%s/results.h5.tmp.%ld..1",
                                         "%s/results.h5.tmp.0%ld", "%s/laws.h5.tmp.%ld.1.2",
                                         "%s/results.h5.tmp.%ld0000000000"};
    for (size_t i = 0; i < 2; i++) {
        snprintf(path, sizeof path, own[i], out, (long)dead);
        write_file(path, "x", 1);
    }
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        snprintf(path, sizeof path, others[i], out, (long)dead);
        write_file(path, "x", 1);
    }
    snprintf(path, sizeof path, "%s/parts.tmp.%ld", out, (long)dead);
    assert_int_equal(mkdir(path, 0777), 0);
    put_foreign(path);
    char part[900];
    snprintf(part, sizeof part, "%s/part-0-0", path);
    write_file(part, "x", 1);
    snprintf(part, sizeof part, "%s/parts.tmp.%ld.1", out, (long)dead);
    assert_int_equal(mkdir(part, 0777), 0);
    snprintf(part, sizeof part, "%s/parts.tmp.%ld.1/part-2of3-0-10", out, (long)dead);
    write_file(part, "x", 1);
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    check_foreign(path, 0); /* without the part */
    for (size_t i = 0; i < 2; i++) {
        assert_false(is_there(own[i], out, dead));
    }
    assert_false(is_there("%s/parts.tmp.%ld.1", out, dead));
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        assert_true(is_there(others[i], out, dead));
    }
    case_remove(&c);
}

/* A variant whose folder of parts holds none of a run was never begun: it is run, not refused. */
static void resuming_a_sweep_passes_over_foreign_files(void **state) {
    (void)state;
    case_folder c =
        case_create((edit[]){{"  gap: 400 nm\n", ""},
                             {"output:", "sweep:\n  beam.gap: [400 nm, 410 nm]\n\noutput:"},
                             {NULL, NULL}});
    char path[400];
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    must_run(HAFT, ARGS("resume", "--quiet", c.path));
    assert_int_equal(unlink(path_in(&c, "out/01_gap-410nm/out/results.h5", path)), 0);
    assert_int_equal(mkdir(path_in(&c, "out/01_gap-410nm/out/parts", path), 0777), 0);
    put_foreign(path);
    must_run(HAFT, ARGS("resume", "--quiet", c.path));
    assert_true(exists(&c, "out/01_gap-410nm/out/results.h5"));
    check_foreign(path, 0);
    case_remove(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_run_touches_foreign_files),
        cmocka_unit_test(only_own_leavings_are_removed),
        cmocka_unit_test(resuming_a_sweep_passes_over_foreign_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
