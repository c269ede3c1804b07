/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the programs do when something is wrong: the exit code, a message with a way out, and
 * nothing changed on the disk. */
#include "program.h"

static void wrong_cases_are_told_with_place_key_and_way_out(void **state) {
    (void)state;
    static const struct {
        edit change;
        const char *says[3];
    } mistakes[] = {
        {{"thickness: 1 um", "thicknes: 1 um"}, {": beam.thicknes: ", "did you mean thickness?"}},
        {{"  thickness: 1 um\n", ""}, {": beam.thickness: is missing", "add \"thickness:"}},
        {{"thickness: 1 um", "thickness: 1 kg"}, {": beam.thickness: ", "wrong dimension"}},
        {{"thickness: 1 um", "thickness: 1"}, {": beam.thickness: ", "no unit"}},
        {{"thickness: 1 um", "thickness: nan um"}, {": beam.thickness: ", "not a finite"}},
        {{"length: 90 um", "length: -90 um"}, {": beam.length: ", "above 0 m"}},
        {{"humidity: 85 %", "humidity: 0 %"}, {"humidity: ", "leave contact.capillary out"}},
        {{"humidity: 85 %", "humidity: 100 %"}, {"humidity: ", "leave contact.capillary out"}},
        {{"grid_step: 10 nm", "grid_step: 15 nm"},
         {": surface.grid_step: ", "too coarse", "10.87"}},
        {{"l_meso: 3 um", "l_meso: 4 um"}, {": beam.l_meso: ", "does not divide", "nearest is"}},
        {{"position: 12 um", "position: 91 um"}, {": load.position: ", "off the beam", "90 um"}},
    };
    for (size_t i = 0; i < sizeof mistakes / sizeof *mistakes; i++) {
        case_folder c = case_create((edit[]){mistakes[i].change, {NULL, NULL}});
        char place[400];
        path_in(&c, "case.yaml:", place);
        const char *const *m = mistakes[i].says;
        static const char *const commands[] = {"check", "run", "info", "plot"};
        for (int k = 0; k < 4; k++) {
            check_program_refuses(&c, 3, HAFT, ARGS(commands[k], c.path),
                                  SAYS(place, m[0], m[1], m[2] != NULL ? m[2] : ""));
        }
        check_program_refuses(&c, 3, HAFT_LAWS, ARGS("build", c.path), SAYS(place, m[0], m[1]));
        case_remove(&c);
    }
}

static void wrong_usage_is_told(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    const char *p = c.path;
    check_program_refuses(
        &c, 2, HAFT, ARGS("fly", p),
        SAYS("\"fly\"",
             "try init, check, run, resume, merge, plot, info, report, budget or compare"));
    check_program_refuses(&c, 2, HAFT_LAWS, ARGS("fly", p),
                          SAYS("\"fly\"", "try build, info, study, sample, fit or inspect"));
    check_program_refuses(&c, 2, HAFT, ARGS("run"),
                          SAYS("a command and a case are needed", "haft run"));
    check_program_refuses(&c, 2, HAFT, ARGS("run", p, "x"), SAYS("\"x\" is too much"));
    check_program_refuses(&c, 2, HAFT, ARGS("run", p, "--fast"), SAYS("--fast", "--help"));
    static const char *const counts[] = {"0", "-1", "two", "", "2x", "4097", "4294967297"};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        check_program_refuses(&c, 2, HAFT, ARGS("run", p, "--threads", counts[i]),
                              SAYS("--threads", "whole number", counts[i]));
        check_program_refuses(&c, 2, HAFT_LAWS, ARGS("build", p, "--threads", counts[i]),
                              SAYS("--threads", "whole number", counts[i]));
    }
    case_remove(&c);
    ran r = run_expect(0, HAFT, ARGS("--help"));
    check_says(r.out, "Exit codes: 0 done;");
    ran_free(&r);
    r = run_expect(0, HAFT, ARGS("--version"));
    assert_true(r.out[0] != '\0');
    ran_free(&r);
}

static void folders_that_hold_no_case_are_told(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    char path[400];
    check_program_refuses(&c, 4, HAFT, ARGS("run", path_in(&c, "nowhere", path)),
                          SAYS(path, "No such file", "give the folder of a case"));
    check_program_refuses(&c, 3, HAFT, ARGS("run", path_in(&c, "case.yaml", path)),
                          SAYS(path, "is no folder", "the folder that holds case.yaml"));
    check_program_refuses(&c, 4, HAFT, ARGS("run", c.top.folder),
                          SAYS("case.yaml", "No such file"));
    check_program_refuses(&c, 4, HAFT_LAWS, ARGS("info", c.path),
                          SAYS("laws.h5", "haft-laws build"));
    check_program_refuses(&c, 4, HAFT, ARGS("info", c.path), SAYS("results.h5", "haft run"));
    check_program_refuses(&c, 4, HAFT, ARGS("plot", c.path), SAYS(".h5", "haft"));
    case_remove(&c);
}

/* Each kind of damage to laws.h5 is refused with a way out, by both programs, and the file stays.
 */
static void damaged_laws_are_refused(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    char path[400], kept[400];
    must_run(HAFT_LAWS, ARGS("build", "--quiet", c.path));
    size_t size = 0;
    char *laws = read_whole_file(path_in(&c, "out/laws.h5", path), &size);
    char *damaged = malloc(size);
    assert_non_null(damaged);
    for (int kind = 0; kind < 4; kind++) {
        memcpy(damaged, laws, size);
        size_t now = kind == 0 ? size / 2 : kind == 1 ? 0 : kind == 2 ? 1000 : size;
        if (kind == 2) {
            memset(damaged, 'x', 1000); /* foreign */
        } else if (kind == 3) {
            damaged[size / 2] ^= 1; /* one bit */
        }
        write_file(path, damaged, now);
        check_program_refuses(&c, 3, HAFT_LAWS, ARGS("info", c.path),
                              SAYS(path, "haft-laws build"));
        check_program_refuses(&c, 3, HAFT, ARGS("run", "--quiet", c.path),
                              SAYS(path, "haft-laws build"));
        size_t after = 0;
        char *left = read_whole_file(path, &after);
        assert_int_equal(after, now);
        assert_memory_equal(left, damaged, now);
        free(left);
    }
    /* the results of a run are no laws */
    must_run(HAFT_LAWS, ARGS("build", "--quiet", "--force", c.path)); /* the way out works */
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    assert_int_equal(rename(path, path_in(&c, "kept", kept)), 0);
    char results[400];
    assert_int_equal(rename(path_in(&c, "out/results.h5", results), path), 0);
    check_program_refuses(&c, 3, HAFT_LAWS, ARGS("info", c.path), SAYS(path, "haft-laws build"));
    check_program_refuses(&c, 3, HAFT, ARGS("run", "--quiet", c.path),
                          SAYS(path, "haft-laws build"));
    free(laws);
    free(damaged);
    case_remove(&c);
}

static void damaged_results_are_refused(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    char path[400];
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    size_t size = 0;
    char *results = read_whole_file(path_in(&c, "out/results.h5", path), &size);
    results[size / 3] ^= 1;
    write_file(path, results, size);
    check_program_refuses(&c, 3, HAFT, ARGS("info", c.path), SAYS(path, "haft run"));
    write_file(path, results, size / 3);
    check_program_refuses(&c, 3, HAFT, ARGS("info", c.path), SAYS(path, "haft run"));
    must_run(HAFT, ARGS("run", "--quiet", "--force", c.path));
    must_run(HAFT, ARGS("info", c.path));
    free(results);
    case_remove(&c);
}

static void an_output_that_cannot_be_written_is_told(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    char out[400], path[400];
    write_file(path_in(&c, "out", out), "mine", 4);
    check_program_refuses(&c, 4, HAFT, ARGS("run", c.path), SAYS("/out", "cannot"));
    check_program_refuses(&c, 4, HAFT_LAWS, ARGS("build", c.path), SAYS("/out", "cannot"));
    char *mine = read_whole_file(out, NULL);
    assert_string_equal(mine, "mine");
    free(mine);
    assert_int_equal(unlink(out), 0);
    /* a folder where a file shall be */
    assert_int_equal(mkdir(out, 0777), 0);
    assert_int_equal(mkdir(path_in(&c, "out/results.h5", path), 0777), 0);
    check_program_refuses(&c, 4, HAFT, ARGS("run", "--quiet", "--force", c.path),
                          SAYS("results.h5", "is a directory"));
    assert_int_equal(rmdir(path), 0);
    assert_int_equal(mkdir(path_in(&c, "out/laws.h5", path), 0777), 0);
    check_program_refuses(&c, 4, HAFT_LAWS, ARGS("build", "--quiet", "--force", c.path),
                          SAYS("laws.h5", "is a directory"));
    if (geteuid() != 0) { /* nobody forbids root */
        assert_int_equal(rmdir(path), 0);
        assert_int_equal(chmod(out, 0555), 0);
        check_program_refuses(&c, 4, HAFT, ARGS("run", "--quiet", c.path), SAYS("/out", "denied"));
        check_program_refuses(&c, 4, HAFT_LAWS, ARGS("build", "--quiet", c.path),
                              SAYS("/out", "denied"));
        assert_int_equal(chmod(out, 0777), 0);
    }
    case_remove(&c);
}

/* The disk is full, as far as the programs can tell: at every size of a file something is told and
 * nothing stays, and what was there before is whole. */
static void a_full_disk_leaves_nothing_half_written(void **state) {
    (void)state;
    /* laws that are there already and take no room beside a beam's path */
    case_folder c = case_create(
        (edit[]){{"  sampler: explicit ", "  sampler: gpce\n  chaos: {vectors: 60, order: 3}\n  #"},
                 {"evidence: [0]", "evidence: [1]"}, /* the second record is the one too large */
                 {NULL, NULL}});
    static const rlim_t limits[] = {600, 20000};
    for (size_t i = 0; i < 2; i++) {
        ran r = end_program(start_program(HAFT, ARGS("run", "--quiet", c.path), limits[i]));
        assert_int_equal(r.code, 4);
        check_says(r.err, "File too large");
        ran_free(&r);
        char *names = listing(&c);
        assert_string_equal(names, "case.yaml ");
        free(names);
    }
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    char path[400], *names = listing(&c);
    size_t size = 0, again = 0;
    char *before = read_whole_file(path_in(&c, "out/results.h5", path), &size);
    /* the results do not fit, or not even a beam's record: what is done stays for `haft resume` */
    const rlim_t tight[] = {(rlim_t)size - 1, (rlim_t)size / 2};
    static const char *const says[] = {"results.h5: cannot be written", "out/parts/part-0-0: "};
    for (size_t i = 0; i < 2; i++) {
        ran r = end_program(start_program(
            HAFT, ARGS("run", "--quiet", "--force", "--threads", "1", c.path), tight[i]));
        assert_int_equal(r.code, 4);
        check_says(r.err, says[i]);
        check_says(r.err, "File too large");
        check_says(r.err, "are kept, and `haft resume` goes on");
        ran_free(&r);
        char *after = read_whole_file(path, &again), *names_after = listing(&c);
        assert_int_equal(size, again);
        assert_memory_equal(before, after, size);
        char *expected = replaced(names, "laws.h5 ", "laws.h5 out/parts ");
        assert_string_equal(expected, names_after);
        must_run(HAFT, ARGS("resume", "--quiet", c.path));
        free(after);
        free(expected);
        free(names_after);
        names_after = listing(&c);
        assert_string_equal(names, names_after);
        free(names_after);
        after = read_whole_file(path, &again); /* a new one, of other times */
        assert_int_equal(size, again);
        free(before);
        before = after;
    }
    free(before);
    free(names);
    case_remove(&c);
}

/* A summary that nobody gets is no success. */
static void a_full_standard_output_is_told(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    must_run(HAFT_LAWS, ARGS("build", "--quiet", c.path));
    static const char *const programs[] = {HAFT, HAFT_LAWS};
    for (int i = 0; i < 2; i++) {
        char command[800];
        snprintf(command, sizeof command, "exec '%s' %s '%s' > /dev/full", programs[i],
                 i == 0 ? "check" : "info", c.path);
        ran r = run_expect(4, "/bin/sh", ARGS("-c", command));
        check_says(r.err, "standard output");
        ran_free(&r);
    }
    case_remove(&c);
}

/* A stream that came closed gives its number to no file of results. */
static void closed_standard_streams_harm_nothing(void **state) {
    (void)state;
    static const struct {
        const char *closed;
        int code;
    } runs[] = {{"2>&-", 0}, {"<&-", 0}, {">&-", 4}, {"<&- >&- 2>&-", 4}};
    case_folder c = case_create(NULL);
    for (size_t i = 0; i < sizeof runs / sizeof *runs; i++) {
        char command[800], path[400];
        unlink(path_in(&c, "out/laws.h5", path));
        snprintf(command, sizeof command, "exec '%s' run --force '%s' %s", HAFT, c.path,
                 runs[i].closed);
        ran r = run_expect(runs[i].code, "/bin/sh", ARGS("-c", command));
        ran_free(&r);
        must_run(HAFT, ARGS("info", c.path));
        must_run(HAFT_LAWS, ARGS("info", c.path));
    }
    case_remove(&c);
}

static void two_runs_at_once_leave_one_result(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    child first = start_program(HAFT, ARGS("run", c.path), 0);
    child second = start_program(HAFT, ARGS("run", c.path), 0);
    ran a = end_program(first), b = end_program(second);
    if (!(a.code == 0 && b.code == 5) && !(a.code == 5 && b.code == 0)) {
        fail_msg("two runs at once ended with %d and %d\n%s%s", a.code, b.code, a.err, b.err);
    }
    check_says(a.code == 5 ? a.err : b.err, "is there already");
    char *names = listing(&c);
    assert_string_equal(names, "case.yaml out out/convergence.csv out/laws.csv out/laws.h5 "
                               "out/resolved.yaml out/results.h5 out/summary.csv ");
    free(names);
    must_run(HAFT, ARGS("info", c.path));
    must_run(HAFT_LAWS, ARGS("info", c.path));
    ran_free(&a);
    ran_free(&b);
    case_remove(&c);
}

static void beams_that_fail_are_told_and_kept(void **state) {
    (void)state;
    case_folder c =
        case_create((edit[]){{"reference:", "path: {step_limit: 20}\nreference:"}, {NULL, NULL}});
    ran r = run_expect(1, HAFT, ARGS("run", "--json", c.path));
    assert_true(json_number(r.out, "failed") == 2 && json_number(r.out, "run") == 2);
    check_says(r.err, "2 of 2 beams could not be followed to the end");
    check_says(r.err, "realization 0");
    check_says(r.err, "out/results.h5");
    ran_free(&r);
    assert_true(exists(&c, "out/summary.csv") && exists(&c, "out/resolved.yaml"));
    r = run_expect(0, HAFT, ARGS("info", c.path));
    check_says(r.out, "0 stuck, 0 free, 2 failed");
    ran_free(&r);
    case_remove(&c);
}

static void a_curve_without_a_law_stops_where_asked(void **state) {
    (void)state;
    case_folder c = case_create((edit[]){
        {"f_limit: 5 MPa", "f_limit: 500 MPa"}, {"unfit: table", "unfit: stop"}, {NULL, NULL}});
    must_run(HAFT_LAWS, ARGS("build", "--quiet", c.path));
    check_program_refuses(
        &c, 3, HAFT, ARGS("run", "--quiet", c.path),
        SAYS("realization 0", "no Morse law fits the curve of site 0", "set law.unfit: table"));
    case_remove(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wrong_cases_are_told_with_place_key_and_way_out),
        cmocka_unit_test(wrong_usage_is_told),
        cmocka_unit_test(folders_that_hold_no_case_are_told),
        cmocka_unit_test(damaged_laws_are_refused),
        cmocka_unit_test(damaged_results_are_refused),
        cmocka_unit_test(an_output_that_cannot_be_written_is_told),
        cmocka_unit_test(a_full_disk_leaves_nothing_half_written),
        cmocka_unit_test(a_full_standard_output_is_told),
        cmocka_unit_test(closed_standard_streams_harm_nothing),
        cmocka_unit_test(two_runs_at_once_leave_one_result),
        cmocka_unit_test(beams_that_fail_are_told_and_kept),
        cmocka_unit_test(a_curve_without_a_law_stops_where_asked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
