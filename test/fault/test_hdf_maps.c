/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Height maps in HDF5 that overrun a reader, lead out of their file, ask for plugins or for more
 * memory than there is, nest without end, or crash the library: each is refused with a message. */
#include "hostile_hdf.h"

#include <signal.h>
#include <sys/stat.h>

#include "haft/io.h"

static const hdf_layout PLAIN = {.chunk = 0};
static const haft_map_options SAID = {.unit = 1e-9, .width = 1e-6, .height = 1e-6};

static void refuse(const char *path, const char *channel, const char *says) {
    haft_map_options options = SAID;
    haft_map *map = NULL;
    haft_error error = {0};
    options.channel = channel;
    haft_status status = haft_map_read(&map, path, &options, NULL, &error);
    if (status != HAFT_ERROR_INPUT || map != NULL) {
        fail_msg("status %d where \"%s\" was to be said: %s", status, says, error.message);
    }
    if (strstr(error.message, says) == NULL || strncmp(error.message, path, strlen(path)) != 0) {
        fail_msg("\"%s\" or the path is not in: %s", says, error.message);
    }
}

static void accept(const char *path, const char *channel, double unit) {
    haft_map_options options = SAID;
    haft_map *map = NULL;
    haft_error error = {0};
    options.channel = channel;
    check_ok(haft_map_read(&map, path, &options, NULL, &error), error);
    assert_int_equal(map->rows * map->columns, HDF_SIDE * HDF_SIDE);
    for (size_t k = 0; k < HDF_SIDE * HDF_SIDE; k++) {
        check_relative(map->z[k], unit * (double)(k % 7), 1e-15);
    }
    haft_map_destroy(&map);
}

/* ---- attributes ---- */

/* A map with one attribute, which is of text if `length` tells of how many bytes. */
static void write_attribute(const char *path, const char *name, hid_t type, hsize_t points,
                            const void *value) {
    hid_t file = hdf_create(path);
    hdf_matrix(file, "z", HDF_SIDE, HDF_SIDE, &PLAIN);
    hdf_attach(file, "z", name, type, points, value);
    assert_true(H5Fclose(file) >= 0);
}

static void units_are_one_short_text(void **state) {
    (void)state;
    static const char says[] = "an attribute `unit` that is not one text";
    static const char many[1000][60] = {"nm"}, text[60000] = "nm", weight[60] = "kg";
    static const char *variable[] = {"um", "um", "um", "um"};
    scratch s = scratch_create();
    char path[400];
    scratch_path(&s, "m.h5", path);
    hid_t fixed = hdf_text_type(60), any = hdf_text_type(0), large = hdf_text_type(60000);
    double number = 1e-9;
    write_attribute(path, "unit", fixed, 0, many);
    accept(path, NULL, 1e-9);
    write_attribute(path, "unit", fixed, 1, many);
    accept(path, NULL, 1e-9);
    write_attribute(path, "unit", any, 0, variable);
    accept(path, NULL, 1e-6);
    write_attribute(path, "unit", any, 1, variable);
    accept(path, NULL, 1e-6);
    write_attribute(path, "unit", large, 0, text);
    accept(path, NULL, 1e-9);
    for (hsize_t points = 2; points <= 1000; points *= 5) {
        write_attribute(path, "unit", fixed, points, many); /* 60 kB into a buffer of 64 */
        refuse(path, NULL, says);
    }
    write_attribute(path, "unit", any, 2, variable);
    refuse(path, NULL, says);
    write_attribute(path, "unit", any, 4, variable);
    refuse(path, NULL, says);
    write_attribute(path, "unit", H5T_NATIVE_DOUBLE, 0, &number);
    refuse(path, NULL, says);
    write_attribute(path, "unit", fixed, 0, weight);
    refuse(path, NULL, says);
    H5Tclose(fixed);
    H5Tclose(any);
    H5Tclose(large);
    scratch_remove(&s);
}

static void sizes_are_two_numbers(void **state) {
    (void)state;
    static const char says[] = "an attribute `size` that is not two lengths";
    static const double lengths[] = {1e-6, 2e-6, 3e-6, -1, NAN};
    static const char text[16] = "1e-6";
    scratch s = scratch_create();
    char path[400];
    scratch_path(&s, "m.h5", path);
    write_attribute(path, "size", H5T_NATIVE_DOUBLE, 2, lengths);
    accept(path, NULL, 1e-9);
    for (hsize_t points = 0; points <= 3; points++) {
        if (points != 2) {
            write_attribute(path, "size", H5T_NATIVE_DOUBLE, points, lengths);
            refuse(path, NULL, says);
        }
    }
    write_attribute(path, "size", H5T_NATIVE_DOUBLE, 2, lengths + 2);
    refuse(path, NULL, says);
    write_attribute(path, "size", H5T_NATIVE_DOUBLE, 2, lengths + 3);
    refuse(path, NULL, says);
    hid_t fixed = hdf_text_type(8);
    write_attribute(path, "size", fixed, 2, text);
    refuse(path, NULL, says);
    H5Tclose(fixed);
    scratch_remove(&s);
}

/* ---- out of the file ---- */

static void no_data_are_read_out_of_other_files(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400], other[400], fifo[400];
    double secret[HDF_SIDE * HDF_SIDE] = {42};
    scratch_path(&s, "m.h5", path);
    write_file(scratch_path(&s, "secret", other), secret, sizeof secret);
    assert_int_equal(mkfifo(scratch_path(&s, "fifo", fifo), 0600), 0);
    const char *const places[] = {other, fifo}; /* nobody writes into the second: it would hang */
    for (int k = 0; k < 2; k++) {
        hid_t file = hdf_create(path);
        hdf_matrix(file, "z", HDF_SIDE, HDF_SIDE, &(hdf_layout){.external = places[k]});
        assert_true(H5Fclose(file) >= 0);
        refuse(path, NULL, "\"z\" lies in external storage");
        refuse(path, "z", "\"z\" lies in external storage");
    }
    hid_t file = hdf_create(other);
    hdf_matrix(file, "z", HDF_SIDE, HDF_SIDE, &PLAIN);
    assert_true(H5Fclose(file) >= 0);
    file = hdf_create(path);
    hdf_matrix(file, "v", HDF_SIDE, HDF_SIDE, &(hdf_layout){.virtual_of = other});
    assert_true(H5Fclose(file) >= 0);
    refuse(path, NULL, "\"v\" is a virtual dataset");
    refuse(path, "/v", "is a virtual dataset");
    scratch_remove(&s);
}

static void no_links_are_followed_but_hard_ones(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400], other[400];
    scratch_path(&s, "m.h5", path);
    hid_t file = hdf_create(scratch_path(&s, "other.h5", other));
    hdf_matrix(file, "z", HDF_SIDE, HDF_SIDE, &PLAIN);
    assert_true(H5Fclose(file) >= 0);
    file = hdf_create(path);
    assert_true(H5Lcreate_external(other, "/", file, "out", H5P_DEFAULT, H5P_DEFAULT) >= 0);
    assert_true(H5Lcreate_soft("/out/z", file, "soft", H5P_DEFAULT, H5P_DEFAULT) >= 0);
    assert_true(H5Fclose(file) >= 0);
    refuse(path, NULL, "no two-dimensional dataset");
    refuse(path, "out/z", "is behind an external link");
    refuse(path, "/out", "is behind an external link");
    refuse(path, "soft", "is behind a soft link");
    file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
    hid_t group = H5Gcreate2(file, "in", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    hdf_matrix(group, "z", HDF_SIDE, HDF_SIDE, &PLAIN);
    assert_true(H5Lcreate_hard(group, "z", file, "same", H5P_DEFAULT, H5P_DEFAULT) >= 0);
    assert_true(H5Lcreate_hard(file, "/", group, "up", H5P_DEFAULT, H5P_DEFAULT) >= 0);
    H5Gclose(group);
    assert_true(H5Fclose(file) >= 0);
    accept(path, "in/z", 1e-9);
    accept(path, "/in/up/in/z", 1e-9);
    refuse(path, "in/nothing", "has no dataset \"in/nothing\"; it has: in/z");
    refuse(path, "in", "has no dataset \"in\"; it has: in/z");
    scratch_remove(&s);
}

/* ---- too much ---- */

static void nests_and_crowds_are_bounded(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400], name[32];
    scratch_path(&s, "m.h5", path);
    hid_t file = hdf_create(path), at = H5Gopen2(file, "/", H5P_DEFAULT);
    hdf_matrix(file, "z", HDF_SIDE, HDF_SIDE, &PLAIN);
    for (int k = 0; k < 3000; k++) {
        hid_t next = H5Gcreate2(at, "g", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
        assert_true(next >= 0);
        H5Gclose(at);
        at = next;
    }
    H5Gclose(at);
    assert_true(H5Fclose(file) >= 0);
    refuse(path, NULL, "groups nested too deep");
    accept(path, "z", 1e-9);
    file = hdf_create(path);
    hdf_matrix(file, "z", HDF_SIDE, HDF_SIDE, &PLAIN);
    for (int k = 0; k < 12000; k++) {
        snprintf(name, sizeof name, "l%d", k);
        assert_true(H5Lcreate_hard(file, "z", file, name, H5P_DEFAULT, H5P_DEFAULT) >= 0);
    }
    assert_true(H5Fclose(file) >= 0);
    refuse(path, NULL, "too many objects");
    accept(path, "z", 1e-9);
    /* two links to every group: 2^60 ways down */
    file = hdf_create(path);
    at = H5Gopen2(file, "/", H5P_DEFAULT);
    for (int k = 0; k < 60; k++) {
        hid_t next = H5Gcreate2(at, "a", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
        assert_true(H5Lcreate_hard(at, "a", at, "b", H5P_DEFAULT, H5P_DEFAULT) >= 0);
        H5Gclose(at);
        at = next;
    }
    H5Gclose(at);
    assert_true(H5Fclose(file) >= 0);
    refuse(path, NULL, "too many objects");
    scratch_remove(&s);
}

static void sizes_that_the_file_cannot_hold(void **state) {
    (void)state;
    static const hdf_layout chunks = {.chunk = 1024, .unwritten = true};
    static const hdf_layout giant = {.chunk = 20000, .unwritten = true};
    static const hdf_layout nothing = {.unwritten = true};
    scratch s = scratch_create();
    char path[400];
    scratch_path(&s, "m.h5", path);
    struct {
        hsize_t side;
        const hdf_layout *layout;
        const char *says;
    } sizes[] = {
        {32768, &chunks, "of a size that the file cannot hold"},
        {30000000, &chunks, "of a size that the file cannot hold"}, /* 10^15 points */
        {30000000, &nothing, "of a size that the file cannot hold"},
        {32768, &nothing, "of a size that the file cannot hold"},
        {HDF_SIDE, &giant, "chunks larger than 256 MiB"},
    };
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        hid_t file = hdf_create(path);
        hdf_matrix(file, "z", sizes[k].side, sizes[k].side, sizes[k].layout);
        assert_true(H5Fclose(file) >= 0);
        refuse(path, NULL, sizes[k].says);
    }
    hid_t file = hdf_create(path);
    hdf_matrix(file, "z", HDF_SIDE, HDF_SIDE, &(hdf_layout){.chunk = 8, .deflate = true});
    assert_true(H5Fclose(file) >= 0);
    accept(path, NULL, 1e-9);
    scratch_remove(&s);
}

/* ---- filters ---- */

static size_t pass_on(unsigned flags, size_t count, const unsigned *value, size_t bytes,
                      size_t *capacity, void **buffer) {
    (void)flags;
    (void)count;
    (void)value;
    (void)capacity;
    (void)buffer;
    return bytes;
}

/* One that the program knows stands for one that HDF5 would load a library for. */
static void foreign_filters_are_not_run(void **state) {
    (void)state;
    static const H5Z_class2_t foreign = {H5Z_CLASS_T_VERS, 300,  1,    1,
                                         "foreign",        NULL, NULL, pass_on};
    scratch s = scratch_create();
    char path[400];
    scratch_path(&s, "m.h5", path);
    assert_true(H5Zregister(&foreign) >= 0);
    hid_t file = hdf_create(path);
    hdf_matrix(file, "z", HDF_SIDE, HDF_SIDE, &(hdf_layout){.chunk = 8, .filter = 300});
    assert_true(H5Fclose(file) >= 0);
    unsigned before = 0, after = 1;
    assert_true(H5PLget_loading_state(&before) >= 0);
    refuse(path, NULL, "a filter that is no part of HDF5 itself");
    assert_true(H5PLget_loading_state(&after) >= 0);
    assert_int_equal(before, after);
    assert_true(H5Zunregister(300) >= 0);
    refuse(path, NULL, "a filter that is no part of HDF5 itself");
    scratch_remove(&s);
}

/* ---- damage ---- */

/* A chunked, packed map in a group, with both attributes in either form. */
static void write_rich(const char *path, int form) {
    hid_t file = hdf_create(path);
    hid_t group = H5Gcreate2(file, "scan", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    hid_t type = hdf_text_type(form % 2 == 0 ? 8 : 0);
    const char text[8] = "nm", *variable = "nm";
    double size[2] = {1e-6, 1e-6};
    hdf_matrix(group, "z", HDF_SIDE, HDF_SIDE,
               form < 2 ? &PLAIN : &(hdf_layout){.chunk = 8, .deflate = true});
    hdf_attach(group, "z", "unit", type, 0,
               form % 2 == 0 ? (const void *)text : (const void *)&variable);
    hdf_attach(group, "z", "size", H5T_NATIVE_DOUBLE, 2, size);
    H5Tclose(type);
    H5Gclose(group);
    assert_true(H5Fclose(file) >= 0);
}

/* HDF5 maps bear no checksum: a changed byte may change the map, but must not end the program. */
static void changed_bytes_do_no_harm(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400];
    scratch_path(&s, "m.h5", path);
    haft_random_key key = {23, HAFT_RANDOM_TEST};
    int refused = 0;
    for (uint64_t k = 0; k < 400; k++) {
        uint64_t w[4];
        size_t length = 0;
        haft_map *map = NULL;
        haft_error error = {0};
        haft_random_words(key, k, 0, 0, w);
        write_rich(path, (int)(k % 4));
        char *bytes = read_whole_file(path, &length);
        size_t at = k % 8 < 6 ? w[0] % (length < 2600 ? length : 2600) : w[0] % length;
        bytes[at] = (char)w[1];
        write_file(path, bytes, length);
        free(bytes);
        haft_status status = haft_map_read(&map, path, NULL, NULL, &error);
        assert_true(status == HAFT_OK || status == HAFT_ERROR_INPUT);
        assert_true((status == HAFT_OK) == (map != NULL));
        refused += status != HAFT_OK;
        haft_map_destroy(&map);
    }
    assert_in_range(refused, 10, 380);
    scratch_remove(&s);
}

int main(void) {
    alarm(250); /* a file that hangs the reader fails the test */
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(units_are_one_short_text),
        cmocka_unit_test(sizes_are_two_numbers),
        cmocka_unit_test(no_data_are_read_out_of_other_files),
        cmocka_unit_test(no_links_are_followed_but_hard_ones),
        cmocka_unit_test(nests_and_crowds_are_bounded),
        cmocka_unit_test(sizes_that_the_file_cannot_hold),
        cmocka_unit_test(foreign_filters_are_not_run),
        cmocka_unit_test(changed_bytes_do_no_harm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
