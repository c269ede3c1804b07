/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Height maps cut short anywhere, with bytes changed anywhere, and files that are something else:
 * refused with a message, or read as what they still say. */
#include "map_files.h"

#include <hdf5.h>

/* A good file in memory, and the map it makes. */
typedef struct sample {
    const char *name;
    char *bytes;
    size_t size;
    bool binary; /* no part of its pixels may change unseen when it is cut */
    haft_map_options options;
    haft_map *map;
} sample;

static void check_read(const scratch *s, const sample *a, const char *bytes, size_t size,
                       bool cut) {
    char path[400];
    write_file(scratch_path(s, "cut", path), bytes, size);
    haft_map *map = NULL;
    haft_error error = {0};
    haft_status status = haft_map_read(&map, path, &a->options, NULL, &error);
    if (status != HAFT_OK) {
        assert_int_equal(status, HAFT_ERROR_INPUT);
        assert_null(map);
        assert_true(strlen(error.message) > strlen(path));
        assert_memory_equal(error.message, path, strlen(path));
        return;
    }
    for (size_t i = 0; i < map->rows * map->columns; i++) {
        assert_false(isinf(map->z[i]));
    }
    assert_true(map->step_row > 0 && map->step_column > 0);
    if (cut && a->binary) {
        assert_int_equal(map->rows, a->map->rows);
        assert_int_equal(map->columns, a->map->columns);
        assert_memory_equal(map->z, a->map->z, map->rows * map->columns * sizeof *map->z);
    }
    haft_map_destroy(&map);
}

static void harm(const scratch *s, sample *a, size_t cuts, size_t changes) {
    char path[400];
    haft_error error = {0};
    write_file(scratch_path(s, "whole", path), a->bytes, a->size);
    check_ok(haft_map_read(&a->map, path, &a->options, NULL, &error), error);
    haft_random_key key = {7, HAFT_RANDOM_TEST};
    for (size_t k = 0; k < cuts + changes; k++) {
        uint64_t words[4];
        haft_random_words(key, k, a->size, 0, words);
        size_t at = words[0] % a->size;
        if (k < cuts) {
            /* heap memory of just that size, so that a sanitizer sees the reader go beyond */
            check_read(s, a, a->bytes, at, true);
            continue;
        }
        char before = a->bytes[at];
        a->bytes[at] = (char)words[1];
        check_read(s, a, a->bytes, a->size, false);
        a->bytes[at] = before;
    }
    haft_map_destroy(&a->map);
    free(a->bytes);
}

static void harmed_nanoscope(void **state) {
    (void)state;
    scratch s = scratch_create();
    for (int k = 0; k < 3; k++) {
        nanoscope_file f = new_nanoscope();
        f.stored = f.said = k == 1 ? 4 : 2;
        if (k == 2) {
            f.version = "0x03100000";
            f.names[0] = "\\Image data: Height";
            f.extra[0] = "\\Z scale: 131.072 nm (65536)";
        }
        sample a = {.name = "nanoscope", .binary = true};
        a.bytes = write_nanoscope(&f, &a.size);
        harm(&s, &a, 300, 300);
    }
    scratch_remove(&s);
}

static void every_cut_of_a_header(void **state) {
    (void)state;
    scratch s = scratch_create();
    nanoscope_file f = new_nanoscope();
    sample a = {.binary = true};
    a.bytes = write_nanoscope(&f, &a.size);
    for (size_t at = 0; at < 1200; at++) {
        char path[400];
        haft_map *map = NULL;
        haft_error error = {0};
        write_file(scratch_path(&s, "cut", path), a.bytes, at);
        assert_int_equal(haft_map_read(&map, path, NULL, NULL, &error), HAFT_ERROR_INPUT);
    }
    free(a.bytes);
    scratch_remove(&s);
}

static void harmed_simple_field(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400];
    haft_error error = {0};
    haft_map *map = NULL;
    check_ok(haft_map_create(&map, 9, 11, 1e-9, 2e-9, &error), error);
    check_ok(haft_map_write(map, scratch_path(&s, "a.gsf", path), &error), error);
    haft_map_destroy(&map);
    sample a = {.name = "gsf", .binary = true};
    a.bytes = read_whole_file(path, &a.size);
    harm(&s, &a, 400, 400);
    scratch_remove(&s);
}

static void harmed_text(void **state) {
    (void)state;
    static const char *const texts[] = {
        "# Channel: Z\n# Width: 4.00 um\n# Height: 3 um\n# Value units: nm\n1 2 5\n3.5 nan 7\n-1 6 "
        "2\n",
        "0 0 1\n0.5 0 2\n1 0 3\n0 2 4\n0.5 2 5\n1.0 2 6\n",
    };
    scratch s = scratch_create();
    for (size_t k = 0; k < 2; k++) {
        sample a = {.name = "text", .size = strlen(texts[k])};
        a.bytes = malloc(a.size);
        assert_non_null(a.bytes);
        memcpy(a.bytes, texts[k], a.size);
        a.options = (haft_map_options){.unit = 1e-9, .lateral_unit = 1e-6};
        harm(&s, &a, 200, 400);
    }
    scratch_remove(&s);
}

static void harmed_hdf5(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400];
    scratch_path(&s, "m.h5", path);
    double z[8][8];
    for (size_t i = 0; i < 64; i++) {
        z[i / 8][i % 8] = (double)i;
    }
    hsize_t shape[2] = {8, 8};
    hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    hid_t space = H5Screate_simple(2, shape, NULL);
    hid_t set =
        H5Dcreate2(file, "z", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, z);
    H5Dclose(set);
    H5Sclose(space);
    H5Fclose(file);
    sample a = {.name = "hdf5", .binary = true};
    a.options = (haft_map_options){.unit = 1e-9, .width = 1e-6, .height = 1e-6};
    a.bytes = read_whole_file(path, &a.size);
    harm(&s, &a, 100, 0);
    scratch_remove(&s);
}

static void refuse(const scratch *s, const char *text, size_t size, const haft_map_options *options,
                   const char *expected) {
    char path[400];
    haft_map *map = NULL;
    haft_error error = {0};
    write_file(scratch_path(s, "bad", path), text, size);
    assert_int_equal(haft_map_read(&map, path, options, NULL, &error), HAFT_ERROR_INPUT);
    if (strstr(error.message, expected) == NULL) {
        fail_msg("\"%s\" does not say \"%s\"", error.message, expected);
    }
}

static void foreign_and_incomplete_files(void **state) {
    (void)state;
    scratch s = scratch_create();
#define REFUSE(text, options, expected) refuse(&s, text, sizeof(text) - 1, options, expected)
    haft_map_options sized = {.width = 1e-6, .height = 1e-6}, unit = {.unit = 1e-9};
    haft_map_options both = {.width = 1e-6, .height = 1e-6, .unit = 1e-9};
    haft_map_options points = {.unit = 1e-9, .lateral_unit = 1e-9};
    REFUSE("", NULL, "is empty");
    REFUSE("This is nonsense.", NULL, "begins with \"This\"");
    REFUSE("\x89PNG\r\n\x1a\n\0\0\0", NULL, "is a PNG image");
    REFUSE("\1\2\3\0\0\0", NULL, "no height map that Haft knows");
    REFUSE("\\*Force file list\r\n", NULL, "force curves");
    REFUSE("1 2\n3 4\n", &unit, "give its size");
    REFUSE("1 2\n3 4\n", &sized, "unit of its heights");
    REFUSE("1 2\n3\n", &both, ":2: has 1 numbers where the lines before have 2");
    REFUSE("1 2\n3 x\n", &both, ":2: this is no number: \"x\"");
    REFUSE("1 2\n3 inf\n", &both, ":2: this is no number: \"inf\"");
    REFUSE("1 2\n", &both, "it needs 2 to");
    REFUSE("# Width: 3 kg\n1 2\n", &unit, ":1: the width is no length");
    REFUSE("# Value units: V\n1 2\n", &sized, ":1: the values are no heights");
    REFUSE("0 0 1\n1 0 2\n0 1 3\n", NULL, "give the unit of x and y");
    REFUSE("0 0 1\n1 0 2\n0 1 3\n0 0 4\n", &points, "two points at x = 0, y = 0");
    REFUSE("0 0 1\n1 0 2\n0 1 3\n1.3 0 4\n", &points, "not on an even grid");
    REFUSE("0 0 1\n1 1 2\n2 2 3\n3 3 4\n4 4 4\n", &points, "more than half of it empty");
    REFUSE("Gwyddion Simple Field 1.0\nXRes = 2\n\0", NULL, "must give XRes and YRes");
    REFUSE("Gwyddion Simple Field 1.0\nXRes = -2\n\0", NULL, "XRes is \"-2\"");
    REFUSE("Gwyddion Simple Field 1.0\nrubbish\n\0", NULL, "is no \"name = value\"");
    REFUSE("Gwyddion Simple Field 1.0\nXRes = 2\nYRes = 2\nZUnits = V\n\0", NULL, "no heights");
    char path[400];
    haft_map *map = NULL;
    haft_error error = {0};
    assert_int_equal(haft_map_read(&map, scratch_path(&s, "none", path), NULL, NULL, &error),
                     HAFT_ERROR_IO);
    assert_int_equal(haft_map_read(&map, s.folder, NULL, NULL, &error), HAFT_ERROR_IO);
    scratch_remove(&s);
}

static void channels_that_are_not_there(void **state) {
    (void)state;
    scratch s = scratch_create();
    nanoscope_file f = new_nanoscope();
    f.names[1] = "\\@2:Image Data: S [Phase] \"Phase\"";
    f.extra[1] = "\\@2:Z scale: V [Sens. Phase] (0.005 deg/LSB) 360 deg";
    size_t size = 0;
    char *bytes = write_nanoscope(&f, &size);
    haft_map_options options = {.channel = "Heigth"};
    refuse(&s, bytes, size, &options, "has no channel \"Heigth\"; it has: Height, Phase");
    options.channel = "Phase";
    refuse(&s, bytes, size, &options, "no z-scale in metres");
    free(bytes);
    scratch_remove(&s);
}

/* Real files cut at random points, where a folder of them is given. */
static void cut_real_maps(void **state) {
    (void)state;
    static const char *const names[] = {"di-2.di", "di-5.di", "di-6.di"};
    const char *folder = HAFT_MAP_DIR;
    if (folder[0] == '\0') {
        print_message("no folder of real maps is given (HAFT_MAP_DIR): left out\n");
        skip();
    }
    scratch s = scratch_create();
    for (size_t k = 0; k < 3; k++) {
        char path[600];
        snprintf(path, sizeof path, "%s/%s", folder, names[k]);
        sample a = {.name = names[k], .binary = true};
        a.bytes = read_whole_file(path, &a.size);
        harm(&s, &a, 12, 4);
    }
    scratch_remove(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(harmed_nanoscope),
        cmocka_unit_test(every_cut_of_a_header),
        cmocka_unit_test(harmed_simple_field),
        cmocka_unit_test(harmed_text),
        cmocka_unit_test(harmed_hdf5),
        cmocka_unit_test(foreign_and_incomplete_files),
        cmocka_unit_test(channels_that_are_not_there),
        cmocka_unit_test(cut_real_maps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
