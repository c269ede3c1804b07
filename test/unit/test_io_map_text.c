/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text maps as programs export them: each is the same small map, or refused with its line. */
#include "scratch.h"

#include "haft/io.h"

static const char HEAD[] = "# Width: 2 um\n# Height: 3 um\n# Value units: nm\n";

/* Reads a text whose heights are 1.5, 2.5; -3, 4; 5, nan [nm]; or that is refused, saying `says`.
 */
static void check_bytes(const char *bytes, size_t n, const haft_map_options *options,
                        const char *says) {
    scratch s = scratch_create();
    char path[400];
    haft_map *map = NULL;
    haft_error error = {0};
    write_file(scratch_path(&s, "m.txt", path), bytes, n);
    haft_status status = haft_map_read(&map, path, options, NULL, &error);
    if (says != NULL) {
        assert_int_equal(status, HAFT_ERROR_INPUT);
        if (strstr(error.message, says) == NULL) {
            fail_msg("\"%s\" does not say \"%s\"", error.message, says);
        }
    } else {
        static const double z[] = {1.5e-9, 2.5e-9, -3e-9, 4e-9, 5e-9};
        check_ok(status, error);
        assert_int_equal(map->rows, 3);
        assert_int_equal(map->columns, 2);
        for (size_t i = 0; i < 5; i++) {
            check_relative(map->z[i], z[i], 1e-14);
        }
        assert_true(isnan(map->z[5]));
    }
    haft_map_destroy(&map);
    scratch_remove(&s);
}

static void check_text(const char *head, const char *rows, const haft_map_options *options,
                       const char *says) {
    char text[1000];
    int n = snprintf(text, sizeof text, "%s%s", head, rows);
    check_bytes(text, (size_t)n, options, says);
}

static void notations(void **state) {
    (void)state;
    static const char *const rows[] = {"1.5, 2.5\n-3, 4\n5, NA\n", "1,5 2,5\n-3 4\n5 --\n",
                                       "1.5,2.5\n-3,4\n5,\n",      "1,5;2,5\n-3;4\n5;\n",
                                       "1.5\t2.5\n-3\t4\n5\t\n",   "1.5\t2.5\t\n-3\t4\t\n5\t\t\n",
                                       "1.5,2.5\r-3,4\r5,#N/A\r",  "1.5 2.5\n\n-3 4\n\n5 -\n"};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        check_text(HEAD, rows[k], NULL, NULL);
    }
    check_text("\xef\xbb\xbf# Width: 2 um\n# Height: 3 um\n# Value units: nm\n",
               "1.5 2.5\n-3 4\n5 nan\n", NULL, NULL);
    check_text(HEAD, "1,5, 2,5\n3, 4\n", NULL, "two ways");
    check_text(HEAD, "1 2\n3 4\n\n5 6\n", NULL, "a second map");
    check_text(HEAD, "1 2\n# Width: 2 um\n3 4\n", NULL, ":5: a second header");
}

static void headers_and_options(void **state) {
    (void)state;
    static const char rows[] = "1.5 2.5\n-3 4\n5 nan\n";
    haft_map_options nm = {.unit = 1e-9}, um = {.unit = 1e-6};
    check_text("# Width: 2 um\n# Height: 3 um\n# Value units: \n", rows, &nm, NULL);
    check_text("# x-length = 2000\n# y-length = 3000\n# z-unit = nm\n", rows, NULL, NULL);
    check_text(HEAD, rows, &um, ":3: the header says that the unit of heights");
}

/* The same text in UTF-16 of either byte order, with its mark. */
static void utf_16(void **state) {
    (void)state;
    static const char text[] = "# Width: 2 um\r\n# Height: 3 um\r\n# Value units: nm\r\n"
                               "1,5\t2,5\r\n-3\t4\r\n5\tnan\r\n";
    for (int big = 0; big < 2; big++) {
        char wide[2 * sizeof text] = {big ? '\xfe' : '\xff', big ? '\xff' : '\xfe'};
        for (size_t i = 0; i + 1 < sizeof text; i++) {
            wide[2 + 2 * i + (size_t)big] = text[i];
        }
        check_bytes(wide, 2 * sizeof text, NULL, NULL);
    }
}

/* Points of the same map, 1 um apart, y upwards; the last one is not there. */
static void points(void **state) {
    (void)state;
    static const char units[] = "# Channel: Topo\n# Lateral units: m\n# Value units: m\n";
    static const char metres[] = "0\t0\t-3e-09\n1e-06\t0\t4e-09\n0\t-1e-06\t5e-09\n"
                                 "0\t1e-06\t1.5e-09\n1e-06\t1e-06\t2.5e-09\n";
    haft_map_options um = {.unit = 1e-9, .lateral_unit = 1e-6}, wrong = {.lateral_unit = 1e-6};
    check_text(units, metres, NULL, NULL);
    check_text(units, metres, &wrong, ":2: the header says that the unit of x and y is 1 m");
    static const char spaced[] = "0.000, 2.000, 1.5\n1.000, 2.000, 2.5\n0.000, 1.000, -3\n"
                                 "1.000, 1.000, 4\n0.000, 0.000, 5\n1.000, 0.000, nan\n";
    check_text("", spaced, &um, NULL);
}

/* Coordinates rounded to a digit of which their step is no multiple: 64 columns 0.333 um apart. */
static void rounded_coordinates(void **state) {
    (void)state;
    enum { SIDE = 64 };
    scratch s = scratch_create();
    char path[400];
    haft_map *map = NULL;
    haft_error error = {0};
    FILE *stream = fopen(scratch_path(&s, "p.xyz", path), "w");
    assert_non_null(stream);
    for (int i = 0; i < SIDE * SIDE; i++) {
        fprintf(stream, "%.1f %.1f %d\n", i % SIDE / 3.0, i / SIDE / 3.0, i);
    }
    assert_int_equal(fclose(stream), 0);
    const double side = SIDE * 1e-6 / 3;
    const haft_map_options options[] = {{.unit = 1e-9, .lateral_unit = 1e-6},
                                        {.unit = 1e-9, .width = side, .height = side}};
    for (int k = 0; k < 2; k++) {
        check_ok(haft_map_read(&map, path, &options[k], NULL, &error), error);
        assert_int_equal(map->rows, SIDE);
        assert_int_equal(map->columns, SIDE);
        check_relative(map->step_column, 1e-6 / 3, 1e-3);
        for (int i = 0; i < SIDE * SIDE; i++) { /* the first row is that of the greatest y */
            check_near(map->z[i], 1e-9 * ((SIDE - 1 - i / SIDE) * SIDE + i % SIDE), 1e-20);
        }
        haft_map_destroy(&map);
    }
    scratch_remove(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(notations),
        cmocka_unit_test(headers_and_options),
        cmocka_unit_test(utf_16),
        cmocka_unit_test(points),
        cmocka_unit_test(rounded_coordinates),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
