/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text maps as programs export them: each is the same small map, or refused with its line. */
#include "scratch.h"

#include "haft/io.h"

static const char HEAD[] = "# Width: 2 um\n# Height: 3 um\n# Value units: nm\n";

/* Reads a text whose heights are 1.5, 2.5; -3, 4; 5, nan [nm]; or that is refused, saying `says`.
 */
static void check_text(const char *head, const char *rows, const haft_map_options *options,
                       const char *says) {
    scratch s = scratch_create();
    char path[400], text[1000];
    haft_map *map = NULL;
    haft_error error = {0};
    int n = snprintf(text, sizeof text, "%s%s", head, rows);
    write_file(scratch_path(&s, "m.txt", path), text, (size_t)n);
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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(notations),
        cmocka_unit_test(headers_and_options),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
