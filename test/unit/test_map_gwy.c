/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gwyddion's own files written item by item: channels, units, titles and masks are found, and what
 * is damaged or no height map is refused with what is wrong. */
#include "gwy_files.h"

#include "haft/io.h"

enum { ROWS = 3, COLUMNS = 4 };

static const double heights[ROWS * COLUMNS] = {1, -2, 3.5, 4, 5, 6, 7, 8.25, 9, 10, 11, 12};

static gwy_field height_field(void) {
    return (gwy_field){.columns = COLUMNS,
                       .rows = ROWS,
                       .width = 8e-6,
                       .height = 3e-6,
                       .lateral = "m",
                       .unit = "m",
                       .z = heights};
}

/* All that a file may hold beside what is looked for. */
static void put_others(gwy_part *p) {
    static const double three[] = {1, 2, 3};
    gwy_part graph = {NULL, 0}, curve = {NULL, 0}, meta = {NULL, 0}, brick = {NULL, 0};
    gwy_put_text(p, "/filename", "somewhere");
    gwy_put_name(p, "/0/data/visible", 'b');
    gwy_put(p, "\1", 1);
    gwy_put_name(p, "/0/base/range-type", 'i');
    gwy_put_word(p, 2, 4);
    gwy_put_name(p, "large", 'q');
    gwy_put_word(p, 2, 8);
    gwy_put_name(p, "letters", 'C');
    gwy_put_word(p, 3, 4);
    gwy_put(p, "abc", 3);
    gwy_put_doubles(p, "numbers", three, 3);
    gwy_put_name(p, "words", 'S');
    gwy_put_word(p, 2, 4);
    gwy_put(p, "one\0two", 8);
    gwy_put_text(&curve, "description", "curve");
    gwy_put_name(&graph, "curves", 'O');
    gwy_put_word(&graph, 1, 4);
    gwy_put_object(&graph, NULL, "GwyGraphCurveModel", curve);
    gwy_put_object(p, "/0/graph/graph/1", "GwyGraphModel", graph);
    gwy_put_text(&meta, "Direction", "Forward");
    gwy_put_object(p, "/0/meta", "GwyContainer", meta);
    gwy_put_int(&brick, "xres", 7);
    gwy_put_object(p, "/brick/0", "GwyBrick", brick);
}

static haft_status read_part(haft_map **map, const scratch *s, const gwy_part *f,
                             const haft_map_options *options, haft_error *error) {
    char path[400];
    write_file(scratch_path(s, "map.gwy", path), f->bytes, f->size);
    *error = (haft_error){0};
    return haft_map_read(map, path, options, NULL, error);
}

/* Reads it and expects the heights times a factor. */
static void check_reads(const scratch *s, const gwy_part *f, const haft_map_options *options,
                        const char *channel, double factor) {
    haft_map *map = NULL;
    haft_error error = {0};
    check_ok(read_part(&map, s, f, options, &error), error);
    assert_int_equal(map->rows, ROWS);
    assert_int_equal(map->columns, COLUMNS);
    check_relative(map->step_column, 2e-6, 1e-14);
    check_relative(map->step_row, 1e-6, 1e-14);
    assert_string_equal(map->channel, channel);
    for (size_t i = 0; i < ROWS * COLUMNS; i++) {
        check_near(map->z[i], heights[i] * factor, 0);
    }
    haft_map_destroy(&map);
}

static void check_refuses(const scratch *s, const gwy_part *f, const haft_map_options *options,
                          const char *says) {
    haft_map *map = NULL;
    haft_error error = {0};
    if (read_part(&map, s, f, options, &error) != HAFT_ERROR_INPUT ||
        strstr(error.message, says) == NULL) {
        fail_msg("not \"%s\" but \"%s\"", says, error.message);
    }
    assert_null(map);
}

/* One file of the items that are then freed. */
#define WITH_FILE(items, ...)                                                                      \
    do {                                                                                           \
        gwy_part file = gwy_make_file(items);                                                      \
        __VA_ARGS__;                                                                               \
        free(file.bytes);                                                                          \
    } while (0)

static void channels(void **state) {
    (void)state;
    scratch s = scratch_create();
    gwy_part items = {NULL, 0};
    gwy_field height = height_field(), phase = height_field(), nano = height_field();
    phase.unit = "deg";
    nano.unit = "nm";
    nano.lateral = "um";
    nano.width = 8;
    nano.height = 3;
    gwy_put_text(&items, "/0/data/title", "Phase");
    gwy_put_field(&items, "/0/data", &phase);
    put_others(&items);
    gwy_put_field(&items, "/12/data", &height);
    gwy_put_text(&items, "/12/data/title", "Height [Trace]");
    gwy_part copy = {NULL, 0};
    gwy_put(&copy, items.bytes, items.size);
    WITH_FILE(copy, {
        check_reads(&s, &file, NULL, "Height [Trace]", 1);
        haft_map_options named = {.channel = "12"};
        check_reads(&s, &file, &named, "Height [Trace]", 1);
        named.channel = "0";
        check_refuses(&s, &file, &named, "channel \"Phase [Forward]\" are in \"deg\", no heights");
        named.channel = "Zed";
        check_refuses(
            &s, &file, &named,
            "no channel \"Zed\"; it has: 0 \"Phase [Forward]\" (deg), 12 \"Height [Trace]\" (m)");
    });
    gwy_put_field(&items, "/3/data", &nano);
    gwy_put_text(&items, "/3/data/title", "12");
    WITH_FILE(items, {
        check_refuses(&s, &file, NULL, "several channels with heights");
        haft_map_options named = {.channel = "Height [Trace]"};
        check_reads(&s, &file, &named, "Height [Trace]", 1);
        named.channel = "12"; /* a title goes before a number */
        check_reads(&s, &file, &named, "12", 1e-9);
        named.channel = "3";
        check_reads(&s, &file, &named, "12", 1e-9);
    });
    scratch_remove(&s);
}

static void units(void **state) {
    (void)state;
    scratch s = scratch_create();
    haft_map_options sized = {.width = 8e-6, .height = 3e-6, .unit = 1e-9};
    gwy_field f = height_field();
    f.unit = "";
    f.lateral = NULL;
    gwy_part items = {NULL, 0};
    gwy_put_field(&items, "/0/data", &f);
    WITH_FILE(items, {
        check_refuses(&s, &file, NULL, "give the unit, as nm; it has: 0 \"untitled\" (no unit)");
        check_reads(&s, &file, &sized, "untitled", 1e-9);
        haft_map_options named = {.channel = "0", .width = 1e-6, .height = 1e-6};
        check_refuses(&s, &file, &named, "unit of its heights");
    });
    f = height_field();
    f.lateral = "1/m";
    items = (gwy_part){NULL, 0};
    gwy_put_field(&items, "/0/data", &f);
    WITH_FILE(items, check_refuses(&s, &file, &sized, "in \"1/m\", no lengths"));
    f = height_field();
    f.width = -1;
    items = (gwy_part){NULL, 0};
    gwy_put_field(&items, "/0/data", &f);
    WITH_FILE(items, check_refuses(&s, &file, &sized, "sides must be positive"));
    scratch_remove(&s);
}

/* Two channels of one title are told apart by the direction that their metadata give. */
static void directions(void **state) {
    (void)state;
    scratch s = scratch_create();
    static const char *const words[] = {"Trace", "Retrace"};
    gwy_part items = {NULL, 0};
    gwy_field f = height_field();
    for (int k = 0; k < 2; k++) {
        gwy_part meta = {NULL, 0};
        char key[40];
        gwy_put_text(&meta, "Operator", "me");
        gwy_put_text(&meta, "Scan Direction", words[k]);
        snprintf(key, sizeof key, "/%d/meta", k);
        gwy_put_object(&items, key, "GwyContainer", meta);
        snprintf(key, sizeof key, "/%d/data", k);
        f.unit = k == 0 ? "m" : "nm";
        gwy_put_field(&items, key, &f);
        snprintf(key, sizeof key, "/%d/data/title", k);
        gwy_put_text(&items, key, "Height");
    }
    WITH_FILE(items, {
        haft_map_options named = {.channel = "Height"};
        check_refuses(&s, &file, &named,
                      "several channels \"Height\"; give the number of one: 0 \"Height [Trace]\" "
                      "(m), 1 \"Height [Retrace]\" (nm)");
        named.channel = "Height [Retrace]";
        check_reads(&s, &file, &named, "Height [Retrace]", 1e-9);
        named.channel = "0";
        check_reads(&s, &file, &named, "Height [Trace]", 1);
    });
    scratch_remove(&s);
}

/* A mask marks pixels for the user, not gaps: it is told, and pixels that are no number are gaps.
 */
static void masks(void **state) {
    (void)state;
    scratch s = scratch_create();
    double holed[ROWS * COLUMNS], marks[ROWS * COLUMNS] = {0, 1};
    memcpy(holed, heights, sizeof holed);
    holed[5] = NAN;
    gwy_field f = height_field(), mask = height_field();
    f.z = holed;
    mask.z = marks;
    gwy_part items = {NULL, 0};
    gwy_put_field(&items, "/0/mask", &mask);
    gwy_put_field(&items, "/0/data", &f);
    WITH_FILE(items, {
        haft_map *map = NULL;
        haft_error error = {0};
        check_ok(read_part(&map, &s, &file, NULL, &error), error);
        assert_true(isnan(map->z[5]));
        check_near(map->z[1], -2, 0);
        assert_non_null(strstr(map->note, "mask, which is not applied"));
        haft_map_destroy(&map);
    });
    scratch_remove(&s);
}

static void refused(void **state) {
    (void)state;
    scratch s = scratch_create();
    gwy_field f = height_field();
    gwy_part items = {NULL, 0};
    put_others(&items);
    WITH_FILE(items, check_refuses(&s, &file, NULL, "without channels"));
    items = (gwy_part){NULL, 0};
    gwy_put_field(&items, "/0/data", &f);
    gwy_put_field(&items, "/0/data", &f);
    WITH_FILE(items, check_refuses(&s, &file, NULL, "two channels have one number"));
    for (int k = 0; k < 4; k++) {
        static const uint32_t sides[][2] = {{1, 12}, {5, 3}, {40000, 3}, {0xfffffffc, 3}};
        static const char *const says[] = {"2 to 32768", "12 heights where 3 x 5 pixels need 15",
                                           "2 to 32768", "2 to 32768"};
        gwy_part field = {NULL, 0};
        gwy_put_int(&field, "xres", sides[k][0]);
        gwy_put_int(&field, "yres", sides[k][1]);
        gwy_put_doubles(&field, "data", heights, 12);
        gwy_put_unit(&field, "si_unit_z", "m");
        items = (gwy_part){NULL, 0};
        gwy_put_object(&items, "/0/data", "GwyDataField", field);
        WITH_FILE(items, check_refuses(&s, &file, NULL, says[k]));
    }
    gwy_part empty = {NULL, 0};
    gwy_put(&empty, "GWYPNoContainer\0\0\0\0\0", 20);
    check_refuses(&s, &empty, NULL, "holds no GwyContainer");
    free(empty.bytes);
    scratch_remove(&s);
}

/* Every cut, and every byte changed to some others: refused, or heights of the right number. */
static void damaged(void **state) {
    (void)state;
    scratch s = scratch_create();
    gwy_field f = height_field();
    gwy_part items = {NULL, 0};
    put_others(&items);
    gwy_put_field(&items, "/0/data", &f);
    gwy_part file = gwy_make_file(items);
    haft_map *map = NULL;
    haft_error error = {0};
    for (size_t size = 1; size < file.size; size++) {
        gwy_part cut = {file.bytes, size};
        assert_int_equal(read_part(&map, &s, &cut, NULL, &error), HAFT_ERROR_INPUT);
        assert_null(map);
    }
    gwy_put(&file, "", 1);
    check_refuses(&s, &file, NULL, "longer than its container");
    file.size--;
    for (size_t k = 0; k < 4 * file.size; k++) {
        static const char changes[] = {1, 0x7f, (char)0x80, (char)0xff};
        char *byte = &file.bytes[k / 4], before = *byte;
        *byte = (char)(before ^ changes[k % 4]);
        haft_status status = read_part(&map, &s, &file, NULL, &error);
        assert_true(status == HAFT_ERROR_INPUT ||
                    (status == HAFT_OK && map->rows * map->columns == ROWS * COLUMNS));
        haft_map_destroy(&map);
        *byte = before;
    }
    free(file.bytes);
    scratch_remove(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(channels),   cmocka_unit_test(units),
                                       cmocka_unit_test(directions), cmocka_unit_test(masks),
                                       cmocka_unit_test(refused),    cmocka_unit_test(damaged)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
