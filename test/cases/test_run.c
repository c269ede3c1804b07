/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A small case from the command line: what is printed, what is written, what is built anew. */
#include "program.h"

#include "haft/study.h"

static const char REUSED[] = "built from the same inputs: reading them";
static const char EXTENDED[] = "1 beams have no laws yet: building them";
static const char REBUILT[] = "built from other inputs: building them anew";

static void a_case_is_checked_without_writing(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    ran r = run_expect(0, HAFT, ARGS("check", c.path));
    check_says(r.out, "case.yaml can be used");
    check_says(r.out, "3.54 nm rms");
    check_says(r.out, "30 patches, 2 realizations");
    assert_string_equal(r.err, "");
    ran_free(&r);
    r = run_expect(0, HAFT, ARGS("check", "--quiet", c.path));
    assert_string_equal(r.out, "");
    assert_string_equal(r.err, "");
    ran_free(&r);
    char *names = listing(&c);
    assert_string_equal(names, "case.yaml ");
    free(names);
    case_remove(&c);
}

/* Plain JSON: strings, numbers and null in one object, commas between members alone. */
static void check_json(const char *json) {
    const char *at = json;
    assert_true(strncmp(at, "{\n", 2) == 0);
    at += 2;
    for (bool more = true; more;) {
        char key[100], value[200];
        int used = 0;
        assert_int_equal(sscanf(at, "  \"%99[a-zA-Z0-9_]\": %199[^,\n]%n", key, value, &used), 2);
        at += used;
        char *end = value;
        double number = strtod(value, &end);
        bool text = value[0] == '"' && value[strlen(value) - 1] == '"';
        if (!text && strcmp(value, "null") != 0 && (*end != '\0' || !isfinite(number))) {
            fail_msg("%s has the value %s", key, value);
        }
        more = *at == ',';
        at += more;
        assert_true(*at++ == '\n');
    }
    assert_string_equal(at, "}\n");
}

/* The statistics printed agree with the rows of the results. */
static void check_against_rows(const case_folder *c, const char *json) {
    haft_error error = {0};
    haft_results_view *view = NULL;
    char path[400];
    check_ok(haft_results_read(&view, path_in(c, "out/results.h5", path), &error), error);
    assert_int_equal(view->realizations, 2);
    double a = view->summary[0].crack_length, b = view->summary[1].crack_length;
    check_relative(json_number(json, "crack_length_mean_m"), (a + b) / 2, 1e-10);
    check_relative(json_number(json, "crack_length_deviation_m"), fabs(a - b) / sqrt(2), 1e-9);
    check_relative(json_number(json, "crack_length_standard_error_m"), fabs(a - b) / 2, 1e-9);
    check_relative(json_number(json, "crack_length_least_m"), fmin(a, b), 1e-10);
    check_relative(json_number(json, "crack_length_greatest_m"), fmax(a, b), 1e-10);
    check_relative(json_number(json, "gamma_J_per_m2"),
                   1.5 * 163e9 * pow(400e-9, 2) * pow(1e-6, 3) / pow((a + b) / 2, 4), 1e-9);
    check_less(json_number(json, "ledger_error"), 1e-9);
    assert_true(json_number(json, "run") == 2 && json_number(json, "stuck") == 2 &&
                json_number(json, "free") == 0 && json_number(json, "failed") == 0);
    check_relative(json_number(json, "paper_crack_length_m"), 219e-6, 1e-12);
    haft_results_view_destroy(&view);
}

static void a_run_writes_all_its_files_and_says_what_came_of_it(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    ran r = run_expect(0, HAFT, ARGS("run", c.path));
    check_says(r.err, "no laws yet: building them");
    check_says(r.err, "laws ");
    check_says(r.err, "beams       2 of 2, 100 %");
    check_says(r.out, "Haft 95 % interval            paper  measured");
    check_says(r.out, "standard deviation ");
    check_says(r.out, "     219.0     200.0\n");
    check_says(r.out, "beams: 2 run, 2 stuck, 0 free, 0 failed");
    ran_free(&r);
    char *names = listing(&c);
    assert_string_equal(names, "case.yaml out out/convergence.csv out/laws.csv out/laws.h5 "
                               "out/resolved.yaml out/results.h5 out/summary.csv ");
    free(names);
    r = run_expect(0, HAFT, ARGS("info", c.path, "--json"));
    check_json(r.out);
    check_against_rows(&c, r.out);
    ran_free(&r);
    r = run_expect(0, HAFT, ARGS("info", c.path));
    check_says(r.out, "standard deviation ");
    ran_free(&r);
    r = run_expect(0, HAFT_LAWS, ARGS("info", c.path));
    check_says(r.out, "60 laws, 30 a beam");
    check_says(r.out, "Morse law fits ");
    ran_free(&r);
    char path[400], *csv = read_whole_file(path_in(&c, "out/summary.csv", path), NULL);
    check_says(csv, "crack length [um]");
    check_says(csv, "\n1,");
    free(csv);
    case_remove(&c);
}

static void results_are_replaced_by_force_alone(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    char path[400];
    ran r = run_expect(0, HAFT, ARGS("run", "--quiet", "--json", c.path));
    check_json(r.out);
    check_against_rows(&c, r.out);
    assert_string_equal(r.err, "");
    ran_free(&r);
    size_t size = 0, again = 0;
    char *before = read_whole_file(path_in(&c, "out/results.h5", path), &size);
    /* even a case that has changed meanwhile leaves the old run whole */
    char *resolved = read_whole_file(path_in(&c, "out/resolved.yaml", path), NULL);
    case_write(&c, (edit[]){{"seed: 85", "seed: 86"}, {NULL, NULL}});
    r = run_expect(5, HAFT, ARGS("run", c.path));
    check_says(r.err, "results.h5 is there already; add --force");
    ran_free(&r);
    char *after = read_whole_file(path_in(&c, "out/results.h5", path), &again);
    assert_int_equal(size, again);
    assert_memory_equal(before, after, size);
    char *resolved_after = read_whole_file(path_in(&c, "out/resolved.yaml", path), NULL);
    assert_string_equal(resolved, resolved_after);
    case_write(&c, NULL);
    r = run_expect(0, HAFT, ARGS("run", "--force", c.path));
    check_says(r.err, REUSED);
    check_silent_about(r.err, "laws   ");
    ran_free(&r);
    r = run_expect(5, HAFT_LAWS, ARGS("build", c.path));
    check_says(r.err, "laws.h5 is there already; add --force");
    ran_free(&r);
    free(before);
    free(after);
    free(resolved);
    free(resolved_after);
    case_remove(&c);
}

/* One change of the case, and whether the laws must be built again. */
static void laws_are_built_anew_where_their_inputs_changed(void **state) {
    (void)state;
    static const struct {
        edit change;
        const char *says;
    } changes[] = {
        {{"position: 12 um", "position: 15 um"}, REUSED},
        {{"thickness: 1 um", "thickness: 1.1 um"}, REUSED},
        {{"kind: morse", "kind: table"}, REUSED},
        {{"title: DelRio", "title: Other"}, REUSED},
        {{"seed: 85", "seed: 86"}, REBUILT},
        {{"grid_step: 10 nm", "grid_step: 7.5 nm"}, REBUILT},
        {{"humidity: 85 %", "humidity: 80 %"}, REBUILT},
        {{"realizations: 2", "realizations: 3"}, EXTENDED}, /* the others are read */
        {{"realizations: 2", "realizations: 1"}, REUSED},
        {{"length: 90 um", "length: 75 um"}, REUSED}, /* of laws to spare */
    };
    case_folder c = case_create(NULL);
    char path[400], kept[400];
    path_in(&c, "out/laws.h5", path);
    path_in(&c, "kept", kept);
    must_run(HAFT_LAWS, ARGS("build", "--quiet", c.path));
    assert_int_equal(rename(path, kept), 0);
    size_t size = 0;
    char *laws = read_whole_file(kept, &size);
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        write_file(path, laws, size);
        case_write(&c, (edit[]){changes[i].change, {NULL, NULL}});
        ran r = run_expect(0, HAFT, ARGS("run", "--force", c.path));
        check_says(r.err, changes[i].says);
        ran_free(&r);
        size_t now = 0;
        char *after = read_whole_file(path, &now);
        bool same = now == size && memcmp(after, laws, size) == 0;
        assert_int_equal(same, changes[i].says == REUSED);
        free(after);
    }
    free(laws);
    case_remove(&c);
}

static void info_tells_of_a_run_that_no_longer_fits_its_case(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    case_write(&c, (edit[]){{"realizations: 2", "realizations: 5"}, {NULL, NULL}});
    ran r = run_expect(3, HAFT, ARGS("info", c.path));
    check_says(r.err, "holds 2 realizations, the case asks for 5");
    check_says(r.err, "--force");
    ran_free(&r);
    case_remove(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_case_is_checked_without_writing),
        cmocka_unit_test(a_run_writes_all_its_files_and_says_what_came_of_it),
        cmocka_unit_test(results_are_replaced_by_force_alone),
        cmocka_unit_test(laws_are_built_anew_where_their_inputs_changed),
        cmocka_unit_test(info_tells_of_a_run_that_no_longer_fits_its_case),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
