/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names that files and users choose, shown by every route: none steers a terminal, forges a line,
 * is markup to a browser or a command to gnuplot. And messages that once misled. */
#include "map_files.h"
#include "program.h"

#include <hdf5.h>

/* A name as bad as a file may have: escapes, line breaks, quotes of shells, of gnuplot and of HTML,
 * a mark that turns text, and bytes that are no UTF-8. */
#define BAD                                                                                        \
    "\x1b]0;x\a\nhaft: all is well\r\"'`touch ran`$(touch ran)<script>&\\\xe2\x80\xae\xff{^_"
#define SHOWN                                                                                      \
    "\\x1b]0;x\\x07\\nhaft: all is well\\r\"'`touch ran`$(touch ran)<script>&\\\\u202e\\xff{^_"

/* Only lines of printable UTF-8. */
static void check_printable(const char *text) {
    for (size_t at = 0, size = strlen(text); at < size;) {
        uint32_t code = 0;
        size_t n = haft_text_character(text + at, size - at, &code);
        bool turns = code >= 0x202a && code <= 0x202e;
        if (n == 0 || turns || (code != '\n' && !haft_text_is_printable(code))) {
            fail_msg("byte %zu is not safe to show in:\n%s", at, text);
        }
        at += n;
    }
}

static size_t count_lines(const char *text) {
    size_t lines = 0;
    for (; *text != '\0'; text++) {
        lines += *text == '\n';
    }
    return lines;
}

/* Runs, checks what is printed, and that `says` is in it, in so many lines of errors. */
static void check_shown(int code, const char *program, const char *const *args, const char *says,
                        size_t lines) {
    ran r = run_expect(code, program, args);
    check_printable(r.out);
    check_printable(r.err);
    check_says(code == 0 ? r.out : r.err, says);
    if (lines > 0 && count_lines(r.err) != lines) {
        fail_msg("not %zu lines:\n%s", lines, r.err);
    }
    ran_free(&r);
}

static void names_on_the_command_line_are_spelled_out(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    check_shown(4, HAFT, ARGS("check", BAD), SHOWN, 1);
    check_shown(2, HAFT, ARGS(BAD, c.path), SHOWN, 1);
    check_shown(2, HAFT, ARGS("check", c.path, BAD), SHOWN, 0);
    check_shown(2, HAFT, ARGS("run", "--threads=" BAD, c.path), SHOWN, 0);
    check_shown(2, HAFT, ARGS("run", "--shard=" BAD, c.path), SHOWN, 0);
    check_shown(2, HAFT_LAWS, ARGS(BAD, c.path), SHOWN, 1);
    check_shown(2, HAFT_LAWS, ARGS("build", c.path, BAD), SHOWN, 1);
    check_shown(4, HAFT_LAWS, ARGS("inspect", BAD), SHOWN, 1);
    check_shown(4, HAFT_LAWS, ARGS("fit", BAD, "table.csv"), SHOWN, 1);
    case_remove(&c);
}

/* A folder of a bad name goes through a whole life of a case. */
static void a_folder_of_a_bad_name_works(void **state) {
    (void)state;
    case_folder c = case_create((edit[]){{"realizations: 2", "realizations: 4"},
                                         {"grid_step: 10 nm", "grid_step: 7.5 nm"},
                                         {NULL, NULL}});
    char folder[400], ran_path[500];
    snprintf(folder, sizeof folder, "%s/%s", c.top.folder, BAD);
    assert_int_equal(rename(c.path, folder), 0);
    check_shown(0, HAFT, ARGS("check", folder), "case.yaml can be used", 0);
    check_shown(0, HAFT, ARGS("run", folder), "crack length at rest", 0);
    check_shown(5, HAFT, ARGS("run", folder), "is there already", 1);
    check_shown(0, HAFT, ARGS("info", folder), "crack length at rest", 0);
    check_shown(0, HAFT_LAWS, ARGS("info", folder), "laws", 0);
    ran r = run_expect(0, HAFT, ARGS("info", "--json", folder));
    check_printable(r.out);
    ran_free(&r);
    snprintf(ran_path, sizeof ran_path, "%s/ran", c.top.folder);
    assert_int_equal(access(ran_path, F_OK), -1);
    case_remove(&c);
}

/* Keys and values of a case. */
static void keys_and_values_are_spelled_out(void **state) {
    (void)state;
    static const struct {
        edit change;
        const char *says;
    } edits[] = {
        {{"  gap:", "  \"g\\e[2Jap\": 1 um\n  gap:"}, "beam.g\\x1b[2Jap: is no key"},
        {{"gap: 400 nm", "gap: \"400 \\e[31mnm\\n\\nhaft: fine\""}, "\\x1b[31mnm"},
        {{"kind: morse ", "kind: \"mo\\rrse\""}, "\"mo\\rrse\" is no choice"},
        {{"name: delrio", "name: \"a\\u202eb\"\n#"}, "\"a\\u202eb\" is no name"},
        {{"realizations: 2", "realizations: \"2\\b3\""}, "\"2\\x083\" is not a whole number"},
        {{"output:", "sweep: {\"beam.\\u009bgap\": [1 um]}\noutput:"}, "\"beam.\\u009bgap\""},
        {{"  zeta_max: 289", "  maps: \"no\\nfile\"\n  zeta_max: 289"}, "no\\nfile"},
        {{"surface:\n", "surface:\n  psd: [\"\\e[1m\"]\n"}, "\\x1b[1m"},
    };
    for (size_t i = 0; i < sizeof edits / sizeof *edits; i++) {
        case_folder c = case_create((edit[]){edits[i].change, {NULL, NULL}});
        check_shown(3, HAFT, ARGS("check", c.path), edits[i].says, 0);
        case_remove(&c);
    }
}

/* An HDF5 map whose datasets have bad names, and a Gwyddion field whose title has one. */
static void names_in_maps_are_spelled_out(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400];
    scratch_path(&s, "map.h5", path);
    hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    hid_t space = H5Screate_simple(2, (hsize_t[]){4, 4}, NULL);
    for (int i = 0; i < 2; i++) {
        hid_t set = H5Dcreate(file, i == 0 ? "\x1b[2Ja\nb" : "\xc2\x9bz", H5T_NATIVE_DOUBLE, space,
                              H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
        assert_true(set >= 0);
        H5Dclose(set);
    }
    H5Sclose(space);
    H5Fclose(file);
    check_shown(3, HAFT_LAWS, ARGS("inspect", path, "--channel=x"), "", 1);
    check_shown(3, HAFT_LAWS, ARGS("inspect", path), "", 1);
    char map[4096];
    int n = snprintf(map, sizeof map,
                     "Gwyddion Simple Field 1.0\nXRes = 2\nYRes = 2\nXReal = 1e-6\nYReal = 1e-6\n"
                     "XYUnits = m\nZUnits = \x1b[31mfurlong\n");
    memset(map + n, 0, 64);
    scratch_path(&s, "map.gsf", path);
    write_file(path, map, ((size_t)n / 4 + 1) * 4 + 16);
    check_shown(3, HAFT_LAWS, ARGS("inspect", path), "furlong", 1);
    scratch_remove(&s);
}

/* A map whose file's name would be commands in gnuplot, a shell or HTML is drawn under that name.
 */
static void a_name_is_no_command_to_gnuplot(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    char from[400], map[500], out[500], path[600];
    size_t size = 0;
    snprintf(from, sizeof from, "%s/cases/afm-demo/surface.gsf", HAFT_SOURCE_DIR);
    char *bytes = read_whole_file(from, &size);
    snprintf(map, sizeof map,
             "%s/'; system('touch ran'); set title '`touch ran`\n\x1b\"$(touch ran)", c.path);
    write_file(map, bytes, size);
    free(bytes);
    snprintf(out, sizeof out, "--output=%s/drawn", c.path);
    ran r = run_program(HAFT_LAWS, ARGS("inspect", out, map));
    check_printable(r.out);
    check_printable(r.err);
    check_says(r.out, "set title '`touch ran`\\n\\x1b\"$(touch ran): Gwyddion Simple Field");
    assert_true(r.code == 0 || strstr(r.err, "gnuplot cannot be run") != NULL);
    ran_free(&r);
    snprintf(path, sizeof path, "%s/drawn/ran", c.path);
    assert_int_equal(access(path, F_OK), -1);
    assert_int_equal(access("ran", F_OK), -1);
    case_remove(&c);
}

/* ---- messages that misled ---- */

static void a_map_that_cannot_be_read_is_all_that_is_told(void **state) {
    (void)state;
    case_folder c =
        case_create((edit[]){{"  zeta_max: 289 rad/um        # shortest wave\n", ""},
                             {"  zeta_0: 19.4 rad/um         # roll-off\n", ""},
                             {"  s_0: 6.46e3 nm^4            # plateau\n", ""},
                             {"  s_1: 6.46e-3 nm^4           # at zeta_max\n", "  maps: map.txt\n"},
                             {NULL, NULL}});
    char path[400];
    static const char *const maps[] = {"",          "words\n",   "1 2\n3\n",          "1 2\n3 4\n",
                                       ";;\n1;2\n", ";\n;\n;\n", "# Width: 1 um\n;\n"};
    for (size_t i = 0; i < sizeof maps / sizeof *maps; i++) {
        write_file(path_in(&c, "map.txt", path), maps[i], strlen(maps[i]));
        ran r = run_expect(3, HAFT, ARGS("check", c.path));
        check_says(r.err, "case.yaml:8:9: surface.maps: ");
        check_silent_about(r.err, "zeta_0");
        assert_int_equal(count_lines(r.err), 1);
        ran_free(&r);
    }
    case_remove(&c);
}

static void a_grid_too_fine_is_told_so(void **state) {
    (void)state;
    static const struct {
        const char *step, *says;
    } steps[] = {{"grid_step: 1e-6 nm", "is finer than the shortest wave"},
                 {"grid_step: 0.1 nm", "give 0.1699 nm (pi/zeta_max/64) at least"},
                 {"grid_step: 15 nm", "15 nm is too coarse"}};
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        case_folder c = case_create((edit[]){{"grid_step: 10 nm", steps[i].step}, {NULL, NULL}});
        ran r = run_expect(3, HAFT, ARGS("check", c.path));
        check_says(r.err, "surface.grid_step: ");
        check_says(r.err, steps[i].says);
        ran_free(&r);
        case_remove(&c);
    }
}

/* A part that cannot be opened for want of descriptors has not changed. */
static void too_few_descriptors_are_told(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    char path[400];
    must_run(HAFT_LAWS, ARGS("build", "--quiet", c.path));
    must_run(HAFT, ARGS("run", "--quiet", "--shard=1/1", c.path));
    haft_error error = {0};
    haft_case *read = NULL;
    haft_parts *parts = NULL;
    haft_path *beam = NULL;
    haft_summary summary;
    char digest[HAFT_DIGEST_CAPACITY];
    check_ok(haft_case_read(&read, path_in(&c, "case.yaml", path), &error), error);
    check_ok(haft_case_laws_digest(read, digest, &error), error);
    check_ok(haft_parts_hold(&parts, path_in(&c, "out/parts", path), 0, 0, &error), error);
    check_ok(haft_parts_scan(parts, read, digest, NULL, NULL, &error), error);
    assert_int_equal(haft_parts_found(parts), 2);
    struct rlimit kept, none;
    assert_int_equal(getrlimit(RLIMIT_NOFILE, &kept), 0);
    none = (struct rlimit){0, kept.rlim_max};
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &none), 0);
    haft_status status = haft_parts_read(&beam, &summary, NULL, parts, 0, 62, &error);
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &kept), 0);
    assert_int_equal(status, HAFT_ERROR_IO);
    check_says(error.message, "Too many open files");
    check_silent_about(error.message, "changed");
    haft_parts_release(&parts);
    haft_case_destroy(&read);
    case_remove(&c);
}

/* ---- sizes ---- */

/* A text of a repeated piece, in a file; refused by a reader that may have so much memory. */
static void check_too_large(const char *piece, size_t bytes, const char *says) {
    scratch s = scratch_create();
    char path[400];
    scratch_path(&s, "map.txt", path);
    size_t n = strlen(piece), times = bytes / n;
    char *text = malloc(times * n);
    assert_non_null(text);
    for (size_t i = 0; i < times; i++) {
        memcpy(text + i * n, piece, n);
    }
    write_file(path, text, times * n);
    free(text);
    fflush(NULL);
    pid_t process = fork();
    assert_true(process >= 0);
    if (process == 0) {
        haft_error error = {0};
        haft_map *map = NULL;
        haft_status status = haft_map_read(&map, path, NULL, NULL, &error);
        struct rusage used;
        bool known = getrusage(RUSAGE_SELF, &used) == 0;
#if defined(__SANITIZE_ADDRESS__)
        used.ru_maxrss = 0; /* its own memory is the most */
#endif
        size_t most = (2 * times * n + ((size_t)1 << 26)) / 1024; /* [KiB] */
        bool said = status == HAFT_ERROR_INPUT && strstr(error.message, says) != NULL;
        _exit(!said ? 1 : !known || (size_t)used.ru_maxrss > most ? 2 : 0);
    }
    int state = 0;
    assert_int_equal(waitpid(process, &state, 0), process);
    assert_true(WIFEXITED(state));
    assert_int_equal(WEXITSTATUS(state), 0);
    scratch_remove(&s);
}

static void a_text_too_large_is_refused_before_it_fills_memory(void **state) {
    (void)state;
    enum { BYTES = 60 << 20 };
    check_too_large("0 ", BYTES, "no row of a map is longer");
    check_too_large("0\n", BYTES, "a map of more than 32768 rows");
    check_too_large("1 2 3 4 5 6 7\n", BYTES, "a map of more than 32768 rows");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_on_the_command_line_are_spelled_out),
        cmocka_unit_test(a_folder_of_a_bad_name_works),
        cmocka_unit_test(keys_and_values_are_spelled_out),
        cmocka_unit_test(names_in_maps_are_spelled_out),
        cmocka_unit_test(a_name_is_no_command_to_gnuplot),
        cmocka_unit_test(a_map_that_cannot_be_read_is_all_that_is_told),
        cmocka_unit_test(a_grid_too_fine_is_told_so),
        cmocka_unit_test(too_few_descriptors_are_told),
        cmocka_unit_test(a_text_too_large_is_refused_before_it_fills_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
