/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text files that are not what they seem: long lines, reads that fail midway, NUL characters, more
 * than a number in a field, units with more to them. Each is read right or refused with its line.
 */
#include "program.h"

#include "haft/io.h"

/* ---- a read that fails ---- */

/* In place of the C library's read(): after `left` bytes the disk is broken. */
static size_t left = SIZE_MAX;

ssize_t read(int descriptor, void *buffer, size_t size);

ssize_t read(int descriptor, void *buffer, size_t size) {
    if (left == 0) {
        errno = EIO;
        return -1;
    }
    ssize_t n =
        pread(descriptor, buffer, size < left ? size : left, lseek(descriptor, 0, SEEK_CUR));
    if (n < 0) {
        return n; /* a pipe */
    }
    lseek(descriptor, n, SEEK_CUR);
    left -= left == SIZE_MAX ? 0 : (size_t)n;
    return n;
}

static const char TITLE[] = "e [mJ/m2],f_max [MPa],d_max [nm],d_limit [nm]";

/* A table of n vectors; to be freed with free(). */
static char *table_of(int n) {
    char *text = calloc((size_t)n + 2, 64);
    assert_non_null(text);
    size_t used = (size_t)sprintf(text, "%s\n", TITLE);
    for (int i = 0; i < n; i++) {
        used += (size_t)sprintf(text + used, "%d.5,1,20,5\n", 10 + i % 80);
    }
    return text;
}

static void a_read_that_fails_is_told(void **state) {
    (void)state;
    scratch s = scratch_create();
    haft_error error = {0};
    haft_law_vector *vector = NULL;
    size_t m = 0;
    char path[400], *text = table_of(60);
    write_file(scratch_path(&s, "v.csv", path), text, strlen(text));
    check_ok(haft_vectors_read(&vector, &m, path, &error), error);
    assert_int_equal(m, 60);
    haft_memory_free(vector);
    left = strlen(text) / 2; /* in the middle of the table */
    haft_status status = haft_vectors_read(&vector, &m, path, &error);
    left = SIZE_MAX;
    assert_int_equal(status, HAFT_ERROR_IO);
    check_says(error.message, "v.csv: cannot be read: Input/output error");
    assert_null(vector);
    free(text);
    scratch_remove(&s);
}

/* ---- tables of vectors ---- */

static void check_table(const char *text, size_t size, const char *says) {
    scratch s = scratch_create();
    haft_error error = {0};
    haft_law_vector *vector = NULL;
    size_t m = 0;
    char path[400];
    write_file(scratch_path(&s, "v.csv", path), text, size);
    haft_status status = haft_vectors_read(&vector, &m, path, &error);
    if (says == NULL) {
        check_ok(status, error);
        assert_int_equal(m, 1);
        check_relative(vector[0].e, 0.05, 1e-14);
    } else {
        assert_int_equal(status, HAFT_ERROR_INPUT);
        check_says(error.message, says);
    }
    haft_memory_free(vector);
    scratch_remove(&s);
}

static void tables_are_read_whole(void **state) {
    (void)state;
    static const struct {
        const char *title, *row, *says;
    } tables[] = {
        {TITLE, "50,1,20,5", NULL}, /* no newline at the end */
        {TITLE, "50,1,20,5\r\n", NULL},
        {"e [mJ/m2] , f_max [MPa],d_max [nm],d_limit [nm]", "50,1,20,5\n", NULL},
        {TITLE, "0x32,1,20,5\n", ":2: e is \"0x32\", no finite decimal number"},
        {TITLE, "50 2,1,20,5\n", ":2: e is \"50 2\""},
        {TITLE, "inf,1,20,5\n", ":2: e is \"inf\""},
        {"e [mJ/m2 2],f_max [MPa],d_max [nm],d_limit [nm]", "50,1,20,5\n", ":1: the column e"},
        {"e [2 mJ/m2],f_max [MPa],d_max [nm],d_limit [nm]", "50,1,20,5\n", ":1: the column e"},
        {"e [mJ/m2],f_max [MPa],d_max [nm since 1990],d_limit [nm]", "50,1,20,5\n",
         ":1: the column d_max"},
        {"e [mJ/m2],f_max [MPa],d_max [1/nm],d_limit [nm]", "50,1,20,5\n", ":1: the column d_max"},
        {"e [mJ/m2],f_max [MPa],d_max [nm] 2,d_limit [nm]", "50,1,20,5\n",
         ":1: there is no column d_max"},
    };
    for (size_t i = 0; i < sizeof tables / sizeof *tables; i++) {
        char text[400];
        int n = snprintf(text, sizeof text, "%s\n%s", tables[i].title, tables[i].row);
        check_table(text, (size_t)n, tables[i].says);
    }
    static const char zero[] = "e [mJ/m2],f_max [MPa],d_max [nm],d_limit [nm]\n50,1,20,5\0\n";
    check_table(zero, sizeof zero - 1, ":2: holds a NUL character");
}

/* ---- points of a PSD ---- */

static haft_status read_psd_case(haft_case **c, const char *psd, size_t size, haft_error *error) {
    char path[400];
    case_folder f =
        case_create((edit[]){{"  zeta_max: 289 rad/um        # shortest wave\n", ""},
                             {"  zeta_0: 19.4 rad/um         # roll-off\n", ""},
                             {"  s_0: 6.46e3 nm^4            # plateau\n", ""},
                             {"  s_1: 6.46e-3 nm^4           # at zeta_max\n", "  psd: p.csv\n"},
                             {NULL, NULL}});
    write_file(path_in(&f, "p.csv", path), psd, size);
    haft_status status = haft_case_read(c, path_in(&f, "case.yaml", path), error);
    case_remove(&f);
    return status;
}

static void a_long_line_is_one_point(void **state) {
    (void)state;
    enum { LONG = 5000 };
    haft_error error = {0};
    haft_case *plain = NULL, *remarks = NULL;
    static const char rows[][40] = {"0.5,6460", "19.4,6460", "100,30", "289,0.006"};
    char short_text[400] = "zeta [rad/um],s [nm^4],remark\n", *text = calloc(6, LONG);
    assert_non_null(text);
    snprintf(text, LONG, "%s", short_text);
    for (size_t i = 0; i < 4; i++) {
        /* what stands after 1023 characters would be a point itself */
        size_t used = strlen(text);
        used += (size_t)sprintf(text + used, "%s,", rows[i]);
        memset(text + used, ' ', 1023 - strlen(rows[i]) - 1);
        strcat(text, i == 1 ? "50,900000,1\n" : "remark\n");
        strcat(strcat(short_text, rows[i]), ",\n");
    }
    text[strlen(text) - 1] = '\0'; /* the last line needs no newline */
    check_ok(read_psd_case(&plain, short_text, strlen(short_text), &error), error);
    check_ok(read_psd_case(&remarks, text, strlen(text), &error), error);
    assert_int_equal(remarks->surface.table->n, 4);
    assert_true(haft_case_moments(remarks).m0 == haft_case_moments(plain).m0);
    haft_case_destroy(&plain);
    haft_case_destroy(&remarks);
    text[strlen(short_text)] = '\0';
    assert_int_equal(read_psd_case(&plain, text, strlen(short_text) + 1, &error), HAFT_ERROR_INPUT);
    check_says(error.message, "holds a NUL character");
    static const char *const bad[] = {"0x10,6460", "0.5 2,6460", "0.5,inf", "0.5,6460 nm", "0.5,"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        snprintf(text, LONG, "zeta [rad/um],s [nm^4]\n%s\n289,0.006\n", bad[i]);
        assert_int_equal(read_psd_case(&plain, text, strlen(text), &error), HAFT_ERROR_INPUT);
        check_says(error.message, "p.csv:2: has no finite number under");
    }
    free(text);
}

/* ---- maps ---- */

static void units_of_maps_are_one_word(void **state) {
    (void)state;
    static const struct {
        const char *header, *says;
    } maps[] = {
        {"# Width: 2 um\n# Height: 2 um\n# Value units: nm\n", NULL},
        {"# Width: 2 um 5\n# Height: 2 um\n# Value units: nm\n", ":1: the width is no length"},
        {"# Width: 2 um\n# Height: 0x2 um\n# Value units: nm\n", ":2: the height is no length"},
        {"# Width: 2 um\n# Height: inf um\n# Value units: nm\n", ":2: the height is no length"},
        {"# Width: 2 um\n# Height: 2 um\n# Value units: nm 2\n", ":3: the values are no heights"},
    };
    scratch s = scratch_create();
    char path[400], text[400];
    for (size_t i = 0; i < sizeof maps / sizeof *maps; i++) {
        haft_error error = {0};
        haft_map *map = NULL;
        snprintf(text, sizeof text, "%s1 2\n3 4\n", maps[i].header);
        write_file(scratch_path(&s, "m.txt", path), text, strlen(text));
        haft_status status = haft_map_read(&map, path, NULL, NULL, &error);
        if (maps[i].says == NULL) {
            check_ok(status, error);
        } else {
            assert_int_equal(status, HAFT_ERROR_INPUT);
            check_says(error.message, maps[i].says);
        }
        haft_map_destroy(&map);
    }
    scratch_remove(&s);
}

/* Options that are quantities follow the same rule. */
static void options_are_quantities(void **state) {
    (void)state;
    static const char *const wrong[] = {"--unit=nm 2",          "--unit=nm since 1990",
                                        "--unit=1 900 nm",      "--lateral-unit=0x10 um",
                                        "--size=1 um x 1 0 um", "--size=1 um x 1 um 2",
                                        "--tip-radius=8 nm 2",  "--outliers=0x10",
                                        "--unit=1/um"};
    scratch s = scratch_create();
    char path[400];
    write_file(scratch_path(&s, "m.txt", path), "1 2\n3 4\n", 8);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        ran r = run_expect(3, HAFT_LAWS, ARGS("inspect", "--output", s.folder, wrong[i], path));
        char option[40];
        snprintf(option, sizeof option, "%.*s", (int)strcspn(wrong[i], "="), wrong[i]);
        check_says(r.err, option);
        ran_free(&r);
    }
    static const char *const sizes[] = {"--size=10x5 um", "--size=10 um \xc3\x97 5 um",
                                        "--size=10umX5um",
                                        "--size=10\xc2\xa0um x 5 um\xe2\x80\xaf"};
    write_file(scratch_path(&s, "m.txt", path), "1 2\n3 5\n", 8);
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        ran r = run_program(HAFT_LAWS, ARGS("inspect", "-q", "--level=mean", "--unit=nm",
                                            "--output", s.folder, sizes[i], path));
        check_says(r.out, "10 x 5 um");
        ran_free(&r);
    }
    scratch_remove(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_read_that_fails_is_told), cmocka_unit_test(tables_are_read_whole),
        cmocka_unit_test(a_long_line_is_one_point),  cmocka_unit_test(units_of_maps_are_one_word),
        cmocka_unit_test(options_are_quantities),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
