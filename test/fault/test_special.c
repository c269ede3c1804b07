/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pipes, devices and folders in the place of every file that is read: refused at once, with a
 * message, never waited for; and none of them is replaced by a file that is written. */
#include "program.h"

#include "haft/study_report.h"

enum { PATIENCE = 60 }; /* [s] after which a test that waits for a pipe is ended */

/* Reads one kind of file at a path. */
typedef haft_status reader(const case_folder *c, const char *path, haft_error *error);

static haft_case *read_small(const case_folder *c) {
    char path[400];
    haft_error error = {0};
    haft_case *read = NULL;
    check_ok(haft_case_read(&read, path_in(c, "case.yaml", path), &error), error);
    return read;
}

static haft_status read_map(const case_folder *c, const char *path, haft_error *error) {
    (void)c;
    haft_map *map = NULL;
    haft_status status = haft_map_read(&map, path, NULL, NULL, error);
    haft_map_destroy(&map);
    return status;
}

static haft_status read_vectors(const case_folder *c, const char *path, haft_error *error) {
    (void)c;
    haft_law_vector *vector = NULL;
    size_t m = 0;
    haft_status status = haft_vectors_read(&vector, &m, path, error);
    haft_memory_free(vector);
    return status;
}

static haft_status read_budget(const case_folder *c, const char *path, haft_error *error) {
    haft_budget budget;
    haft_case *read = read_small(c);
    haft_status status = haft_study_read_budget(&budget, read, path, error);
    haft_case_destroy(&read);
    return status;
}

static haft_status read_laws(const case_folder *c, const char *path, haft_error *error) {
    (void)c;
    haft_laws *laws = NULL;
    haft_status status = haft_laws_read(&laws, NULL, path, error);
    haft_laws_destroy(&laws);
    return status;
}

static haft_status read_results(const case_folder *c, const char *path, haft_error *error) {
    (void)c;
    haft_results_view *view = NULL;
    haft_status status = haft_results_read(&view, path, error);
    haft_results_view_destroy(&view);
    return status;
}

static haft_status read_case(const case_folder *c, const char *path, haft_error *error) {
    (void)c;
    haft_case *read = NULL;
    haft_status status = haft_case_read(&read, path, error);
    haft_case_destroy(&read);
    return status;
}

/* The case itself, with the file in the place of what an edit names. */
static haft_status read_with(const case_folder *c, const edit *edits, haft_error *error) {
    char path[400];
    case_write(c, edits);
    haft_status status = read_case(c, path_in(c, "case.yaml", path), error);
    case_write(c, NULL);
    return status == HAFT_ERROR_INPUT ? HAFT_ERROR_IO : status; /* a complaint of the case */
}

static const edit no_parameters[] = {{"  zeta_max: 289 rad/um        # shortest wave\n", ""},
                                     {"  zeta_0: 19.4 rad/um         # roll-off\n", ""},
                                     {"  s_0: 6.46e3 nm^4            # plateau\n", ""},
                                     {"  s_1: 6.46e-3 nm^4           # at zeta_max\n", ""}};

static haft_status read_surface(const case_folder *c, const char *key, const char *path,
                                haft_error *error) {
    char line[500];
    snprintf(line, sizeof line, "surface:\n  %s: %s\n", key, path);
    const edit edits[] = {no_parameters[0], no_parameters[1],     no_parameters[2],
                          no_parameters[3], {"surface:\n", line}, {NULL, NULL}};
    return read_with(c, edits, error);
}

static haft_status read_case_maps(const case_folder *c, const char *path, haft_error *error) {
    return read_surface(c, "maps", path, error);
}

static haft_status read_case_psd(const case_folder *c, const char *path, haft_error *error) {
    return read_surface(c, "psd", path, error);
}

static haft_status read_case_film(const case_folder *c, const char *path, haft_error *error) {
    char line[500];
    snprintf(line, sizeof line,
             "molar_volume: 18 cm^3/mol\n    adsorbed: table\n    adsorbed_table: %s\n", path);
    return read_with(c, (edit[]){{"molar_volume: 18 cm^3/mol\n", line}, {NULL, NULL}}, error);
}

static reader *const readers[] = {read_map,       read_vectors,  read_budget,
                                  read_laws,      read_results,  read_case,
                                  read_case_maps, read_case_psd, read_case_film};

static void no_reader_waits_or_takes_what_is_no_file(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    char pipe[400], device[400], folder[400];
    assert_int_equal(mkfifo(path_in(&c, "pipe", pipe), 0600), 0);
    assert_int_equal(symlink("/dev/zero", path_in(&c, "device", device)), 0);
    assert_int_equal(mkdir(path_in(&c, "folder", folder), 0777), 0);
    const struct {
        const char *path, *says;
    } files[] = {{pipe, "is a pipe; give a regular file"},
                 {device, "is a device or a socket; give a regular file"},
                 {folder, "is a directory; give a regular file"}};
    for (size_t i = 0; i < sizeof readers / sizeof *readers; i++) {
        for (size_t k = 0; k < sizeof files / sizeof *files; k++) {
            haft_error error = {0};
            alarm(PATIENCE);
            haft_status status = readers[i](&c, files[k].path, &error);
            alarm(0);
            bool hdf = readers[i] == read_laws || readers[i] == read_results; /* words of its own */
            if (status != HAFT_ERROR_IO ||
                strstr(error.message, hdf ? "is a" : files[k].says) == NULL) {
                fail_msg("reader %zu, %s: status %d, %s", i, files[k].path, status, error.message);
            }
            check_silent_about(error.message, "zeta_0");
        }
    }
    case_remove(&c);
}

/* A part and its lock. */
static void parts_that_are_pipes_are_told(void **state) {
    (void)state;
    static const char *const names[] = {"out/parts/part-0-0", "out/parts/lock"};
    for (size_t i = 0; i < 2; i++) {
        case_folder c = case_create(NULL);
        char path[400];
        assert_int_equal(mkdir(path_in(&c, "out", path), 0777), 0);
        assert_int_equal(mkdir(path_in(&c, "out/parts", path), 0777), 0);
        assert_int_equal(mkfifo(path_in(&c, names[i], path), 0600), 0);
        ran r = run_expect(i == 0 ? 4 : 0, HAFT, ARGS("run", "--quiet", c.path));
        check_says(i == 0 ? r.err : "part-0-0: is a pipe", "part-0-0: is a pipe");
        ran_free(&r);
        case_remove(&c);
    }
}

/* /dev/null named as the file to be written must stay a device. */
static void what_is_no_file_is_not_replaced(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    char device[400], pipe[400];
    assert_int_equal(symlink("/dev/null", path_in(&c, "device", device)), 0);
    assert_int_equal(mkfifo(path_in(&c, "pipe", pipe), 0600), 0);
    const char *const paths[] = {device, pipe, c.path};
    for (size_t i = 0; i < 3; i++) {
        haft_error error = {0};
        struct stat before, after;
        assert_int_equal(lstat(paths[i], &before), 0);
        assert_int_equal(haft_text_write(paths[i], "text\n", &error), HAFT_ERROR_IO);
        check_says(error.message, paths[i]);
        assert_int_equal(lstat(paths[i], &after), 0);
        assert_true(before.st_ino == after.st_ino && before.st_mode == after.st_mode);
    }
    case_remove(&c);
}

static void files_are_read_whole_or_refused(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400], *bytes = NULL;
    size_t size = 0;
    haft_error error = {0};
    scratch_path(&s, "file", path);
    write_file(path, "abc\0def", 7);
    check_ok(haft_file_read(&bytes, &size, path, 7, &error), error);
    assert_int_equal(size, 7);
    assert_memory_equal(bytes, "abc\0def", 8);
    haft_memory_free(bytes);
    assert_int_equal(haft_file_read(&bytes, &size, path, 6, &error), HAFT_ERROR_INPUT);
    assert_null(bytes);
    check_says(error.message, "is larger than");
    write_file(path, "", 0);
    check_ok(haft_file_read(&bytes, &size, path, 7, &error), error);
    assert_int_equal(size, 0);
    haft_memory_free(bytes);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(haft_file_read(&bytes, &size, path, 7, &error), HAFT_ERROR_IO);
    check_says(error.message, "cannot be opened: No such file");
    scratch_remove(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_reader_waits_or_takes_what_is_no_file),
        cmocka_unit_test(parts_that_are_pipes_are_told),
        cmocka_unit_test(what_is_no_file_is_not_replaced),
        cmocka_unit_test(files_are_read_whole_or_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
