/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Marks of missing pixels that no file declares, and heights that look like some, in text and in
 * Gwyddion's simple field; and what else a simple field may not be. */
#include "map_files.h"

enum { SIDE = 12 };

static double height(size_t k) {
    return (double)((7 * k * k + 3 * k) % 101) - 40;
}

static haft_status read_text(haft_map **map, const double *z, haft_error *error) {
    scratch s = scratch_create();
    char path[400], text[SIDE * SIDE * 30];
    size_t used = 0;
    for (size_t k = 0; k < SIDE * SIDE; k++) {
        used += (size_t)sprintf(text + used, "%.17g%s", z[k], k % SIDE == SIDE - 1 ? "\n" : " ");
    }
    write_file(scratch_path(&s, "m.txt", path), text, used);
    haft_map_options options = {.width = 1e-6, .height = 1e-6, .unit = 1e-9};
    haft_status status = haft_map_read(map, path, &options, NULL, error);
    scratch_remove(&s);
    return status;
}

/* A simple field with these lines of header, its NULs and data. */
static haft_status read_gsf(haft_map **map, const char *lines, size_t nuls, const double *z,
                            haft_error *error) {
    scratch s = scratch_create();
    char path[400], bytes[2000 + 4 * SIDE * SIDE];
    size_t n = (size_t)snprintf(bytes, 1900, "Gwyddion Simple Field 1.0\n%s", lines);
    size_t count = nuls > 0 ? nuls : 4 - n % 4;
    memset(bytes + n, 0, count);
    n += count;
    for (size_t k = 0; z != NULL && k < SIDE * SIDE; k++) {
        float value = (float)z[k];
        memcpy(bytes + n, &value, 4);
        n += 4;
    }
    write_file(scratch_path(&s, "m.gsf", path), bytes, n);
    haft_map_options options = {.width = 1e-6, .height = 1e-6, .unit = 1e-9};
    haft_status status = haft_map_read(map, path, &options, NULL, error);
    scratch_remove(&s);
    return status;
}

#define PIXELS "XRes = 12\nYRes = 12\n"

static void marks_are_refused(void **state) {
    (void)state;
    static const double marks[] = {-9999,      -999, 99999,     -99999,        -32768,
                                   65535,      1e38, -1e38,     3.4028235e38,  9.96921e36,
                                   1.70141e38, 1e20, -123456.7, -2147483648.0, 4294967295.0};
    for (size_t m = 0; m < sizeof marks / sizeof *marks; m++) {
        double z[SIDE * SIDE];
        char value[40];
        for (size_t k = 0; k < SIDE * SIDE; k++) {
            z[k] = k % 50 == 3 ? marks[m] : height(k);
        }
        haft_map *map = NULL;
        haft_error error = {0};
        assert_int_equal(read_text(&map, z, &error), HAFT_ERROR_INPUT);
        assert_null(map);
        snprintf(value, sizeof value, "the value %.9g", marks[m]);
        if (strstr(error.message, value) == NULL || strstr(error.message, "3 times") == NULL ||
            strstr(error.message, "nan") == NULL) {
            fail_msg("%g: %s", marks[m], error.message);
        }
        assert_int_equal(read_gsf(&map, PIXELS, 0, z, &error), HAFT_ERROR_INPUT);
        assert_non_null(strstr(error.message, "3 times"));
        for (size_t k = 0; k < SIDE * SIDE; k++) { /* told as missing, it is read */
            z[k] = k % 50 == 3 ? NAN : height(k);
        }
        check_ok(read_text(&map, z, &error), error);
        assert_true(isnan(map->z[3]));
        check_relative(map->z[4], 1e-9 * height(4), 1e-14);
        haft_map_destroy(&map);
    }
}

/* Heights that are not apart from the others: a map that fills the type's range or was clipped, one
 * of three values, a spike, a flat map, a range about -9999. */
static void heights_are_kept(void **state) {
    (void)state;
    for (int form = 0; form < 7; form++) {
        double z[SIDE * SIDE];
        for (size_t k = 0; k < SIDE * SIDE; k++) {
            double h = height(k);
            z[k] = form == 0   ? (k == 3   ? -32768
                                  : k == 9 ? 32767
                                           : 500 * h)
                   : form == 1 ? fmax(-32768, fmin(32767, 1500 * h))
                   : form == 2 ? (k % 40 == 3   ? 5
                                  : k % 40 == 9 ? -5
                                                : 0)
                   : form == 3 ? (k == 77 ? 5000 : h)
                   : form == 4 ? 7
                   : form == 5 ? (k == 5 ? -9999 : -10000 + 20 * h)
                               : (k % 2 == 0 ? 0 : 10000);
        }
        haft_map *map = NULL;
        haft_error error = {0};
        check_ok(read_text(&map, z, &error), error);
        for (size_t k = 0; k < SIDE * SIDE; k++) {
            check_near(map->z[k], 1e-9 * z[k], 1e-14 * fabs(1e-9 * z[k]));
        }
        haft_map_destroy(&map);
    }
}

static void refuse_gsf(const char *lines, size_t nuls, const char *says) {
    double z[SIDE * SIDE];
    for (size_t k = 0; k < SIDE * SIDE; k++) {
        z[k] = height(k);
    }
    haft_map *map = NULL;
    haft_error error = {0};
    if (read_gsf(&map, lines, nuls, z, &error) != HAFT_ERROR_INPUT ||
        strstr(error.message, says) == NULL) {
        fail_msg("\"%s\" was to be said: %s", says, error.message);
    }
}

static void simple_fields_are_strict(void **state) {
    (void)state;
    double z[SIDE * SIDE];
    for (size_t k = 0; k < SIDE * SIDE; k++) {
        z[k] = height(k);
    }
    refuse_gsf("XRes = 0xc\nYRes = 12\n", 0, ":2: XRes is \"0xc\"");
    refuse_gsf("XRes = 12\nYRes = -12\n", 0, ":3: YRes is \"-12\"");
    refuse_gsf("XRes = 12\nYRes = 12.5\n", 0, "whole numbers of pixels");
    refuse_gsf("XRes = 12\nYRes = \n", 0, ":3: YRes is \"\"");
    refuse_gsf("XRes = 12\n", 0, "must give XRes and YRes");
    refuse_gsf(PIXELS "YRes = 12\n", 0, ":4: YRes stands there twice");
    refuse_gsf(PIXELS "XReal = nan\n", 0, ":4: XReal is \"nan\"");
    refuse_gsf(PIXELS "XReal = 2 um\n", 0, ":4: XReal is \"2 um\"");
    refuse_gsf(PIXELS "ZUnits = V\n", 0, "its values are in \"V\", no heights");
    refuse_gsf(PIXELS "XReal = 1\nYReal = 1\nXYUnits = Hz\n", 0, "its sides are in \"Hz\"");
    refuse_gsf(PIXELS, 8, "has 630 bytes where 12 x 12 pixels need 624; it is damaged");
    refuse_gsf("XRes = 13\nYRes = 12\n", 0, "it is cut short");
    haft_map *map = NULL;
    haft_error error = {0};
    check_ok(read_gsf(&map, PIXELS "XReal = 3\nYReal = 6\nXYUnits = um\nZUnits = pm\nNote = x\n", 0,
                      z, &error),
             error);
    check_relative(map->step_column, 0.25e-6, 1e-14);
    check_relative(map->step_row, 0.5e-6, 1e-14);
    check_relative(map->z[1], 1e-12 * height(1), 1e-14);
    assert_string_equal(map->note,
                        "not used, since the file says its own: the size and unit given");
    haft_map_destroy(&map);
    /* plain numbers are no lengths: the options give them */
    check_ok(read_gsf(&map, PIXELS "XReal = 3\nYReal = 6\n", 0, z, &error), error);
    check_relative(map->step_row * SIDE, 1e-6, 1e-14);
    check_relative(map->z[1], 1e-9 * height(1), 1e-14);
    assert_string_equal(map->note, "");
    haft_map_destroy(&map);
}

static void simple_fields_sent_as_text(void **state) {
    (void)state;
    static const char returns[] = "Gwyddion Simple Field 1.0\r\nXRes = 2\r\n";
    static const char newer[] = "Gwyddion Simple Field 2.0\nXRes = 2\n";
    static const char padded[] = "Gwyddion Simple Field 1.0\nXRes = 2\nYRes = 2\nX=1\n\0\1\0\0data";
    static const struct {
        const char *text, *says;
        size_t size;
    } files[] = {{returns, "a transfer as text", sizeof returns - 1},
                 {newer, "no Gwyddion Simple Field 1.0", sizeof newer - 1},
                 {padded, "one to four NUL", sizeof padded - 1}};
    for (size_t k = 0; k < 3; k++) {
        scratch s = scratch_create();
        char path[400];
        write_file(scratch_path(&s, "m.gsf", path), files[k].text, files[k].size);
        haft_map *map = NULL;
        haft_error error = {0};
        assert_int_equal(haft_map_read(&map, path, NULL, NULL, &error), HAFT_ERROR_INPUT);
        if (strstr(error.message, files[k].says) == NULL) {
            fail_msg("\"%s\" was to be said: %s", files[k].says, error.message);
        }
        scratch_remove(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(marks_are_refused),
        cmocka_unit_test(heights_are_kept),
        cmocka_unit_test(simple_fields_are_strict),
        cmocka_unit_test(simple_fields_sent_as_text),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
