/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HDF5 maps as NetCDF packs them, with marks of missing pixels, in datasets with dimensions of
 * length 1, of numbers that are none, and held open by another program. */
#include "hostile_hdf.h"

#include "haft/io.h"

enum { ROWS = 6, COLUMNS = 8, PIXELS = ROWS * COLUMNS };
static const haft_map_options SAID = {.unit = 1e-9, .width = 8e-6, .height = 6e-6};

/* Numbers of all pixels; small, whole and not symmetric. */
static double number(size_t k) {
    return (double)((7 * k * k + 3 * k) % 101) - 40;
}

/* A dataset of those numbers, but for what `change` says of the pixels 5 and 17. */
static void put_set(hid_t file, const char *name, hid_t type, int rank, const hsize_t *dims,
                    const double *change, hid_t creation) {
    double z[PIXELS];
    for (size_t k = 0; k < PIXELS; k++) {
        z[k] = change != NULL && (k == 5 || k == 17) ? *change : number(k);
    }
    hid_t space = H5Screate_simple(rank, dims, NULL);
    hid_t set = H5Dcreate2(file, name, type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    assert_true(set >= 0);
    assert_true(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, z) >= 0);
    H5Dclose(set);
    H5Sclose(space);
}

static const hsize_t SHAPE[] = {ROWS, COLUMNS};

static haft_map *accept(const char *path, const char *channel) {
    haft_map_options options = SAID;
    haft_map *map = NULL;
    haft_error error = {0};
    options.channel = channel;
    check_ok(haft_map_read(&map, path, &options, NULL, &error), error);
    assert_int_equal(map->rows, ROWS);
    assert_int_equal(map->columns, COLUMNS);
    return map;
}

static void refuse(const char *path, const char *channel, const char *says) {
    haft_map_options options = SAID;
    haft_map *map = NULL;
    haft_error error = {0};
    options.channel = channel;
    if (haft_map_read(&map, path, &options, NULL, &error) != HAFT_ERROR_INPUT || map != NULL ||
        strstr(error.message, says) == NULL) {
        fail_msg("\"%s\" was to be said: %s", says, error.message);
    }
}

/* Heights scale * number + offset, and pixels 5 and 17 missing if they should be. */
static void check_heights(haft_map **map, double scale, double offset, bool missing) {
    for (size_t k = 0; k < PIXELS; k++) {
        if (missing && (k == 5 || k == 17)) {
            assert_true(isnan((*map)->z[k]));
        } else {
            check_near((*map)->z[k], scale * number(k) + offset, 1e-13 * fabs(scale));
        }
    }
    haft_map_destroy(map);
}

/* ---- packing and marks ---- */

static void packed_numbers(void **state) {
    (void)state;
    static const double fill = -32768, scale = 0.5, offset = 100;
    scratch s = scratch_create();
    char path[400];
    hid_t file = hdf_create(scratch_path(&s, "m.h5", path));
    put_set(file, "z", H5T_STD_I16LE, 2, SHAPE, &fill, H5P_DEFAULT);
    hdf_attach(file, "z", "scale_factor", H5T_NATIVE_DOUBLE, 0, &scale);
    hdf_attach(file, "z", "add_offset", H5T_NATIVE_DOUBLE, 1, &offset);
    assert_true(H5Fclose(file) >= 0);
    refuse(path, NULL, "the value -32768 stands there 2 times, far from all others (-40 to 60)");
    file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
    hdf_attach(file, "z", "_FillValue", H5T_NATIVE_DOUBLE, 1, &fill);
    assert_true(H5Fclose(file) >= 0);
    haft_map *map = accept(path, NULL);
    assert_non_null(strstr(map->note, "0.5 times the number stored plus 100"));
    assert_non_null(strstr(map->note, "2 pixels are missing"));
    check_heights(&map, 0.5e-9, 100e-9, true);
    scratch_remove(&s);
}

/* Each way to declare a mark, in each type; and none, which is refused. */
static void declared_and_undeclared_marks(void **state) {
    (void)state;
    static const char text[8] = "nan";
    const struct {
        hid_t type;
        double mark;
    } marks[] = {{H5T_IEEE_F32LE, -9999},
                 {H5T_IEEE_F64LE, -9999},
                 {H5T_IEEE_F32LE, 9.969209968386869e36},
                 {H5T_IEEE_F32LE, 3.4028234663852886e38},
                 {H5T_IEEE_F64LE, 1e38},
                 {H5T_IEEE_F32LE, 1e38},
                 {H5T_IEEE_F64LE, 123456789},
                 {H5T_STD_I32LE, -2147483648.0},
                 {H5T_STD_I16BE, -32768}};
    static const char *const ways[] = {"_FillValue", "missing_value", "valid_min", "valid_range",
                                       "own"};
    scratch s = scratch_create();
    char path[400];
    scratch_path(&s, "m.h5", path);
    for (size_t k = 0; k < sizeof marks / sizeof *marks; k++) {
        for (size_t w = 0; w < sizeof ways / sizeof *ways; w++) {
            hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
            double both[2] = {-77, marks[k].mark}, range[2] = {-100, 100};
            if (w == 4) {
                H5Pset_fill_value(creation, H5T_NATIVE_DOUBLE, &marks[k].mark);
            }
            hid_t file = hdf_create(path);
            put_set(file, "z", marks[k].type, 2, SHAPE, &marks[k].mark, creation);
            H5Pclose(creation);
            if (w < 2) {
                hdf_attach(file, "z", ways[w], H5T_NATIVE_DOUBLE, 1 + w, both + 1 - w);
            } else if (w == 2) {
                const char *way = marks[k].mark < 0 ? "valid_min" : "valid_max";
                hdf_attach(file, "z", way, H5T_NATIVE_DOUBLE, 0, range + (marks[k].mark > 0));
            } else if (w == 3) {
                hdf_attach(file, "z", ways[w], H5T_NATIVE_DOUBLE, 2, range);
            }
            assert_true(H5Fclose(file) >= 0);
            haft_map *map = accept(path, NULL);
            check_heights(&map, 1e-9, 0, true);
        }
        hid_t file = hdf_create(path);
        put_set(file, "z", marks[k].type, 2, SHAPE, &marks[k].mark, H5P_DEFAULT);
        assert_true(H5Fclose(file) >= 0);
        refuse(path, NULL, "stands there 2 times");
        refuse(path, NULL, "_FillValue");
    }
    static const double numbers[3] = {3, 1, NAN};
    const struct {
        const char *name;
        hid_t type;
        hsize_t points;
        const void *value;
    } wrong[] = {{"scale_factor", H5T_NATIVE_DOUBLE, 2, numbers},
                 {"scale_factor", H5T_NATIVE_DOUBLE, 0, numbers + 2},
                 {"add_offset", H5T_NATIVE_DOUBLE, 0, numbers + 2},
                 {"valid_range", H5T_NATIVE_DOUBLE, 2, numbers},
                 {"valid_range", H5T_NATIVE_DOUBLE, 3, numbers},
                 {"valid_min", H5T_NATIVE_DOUBLE, 0, numbers + 2}};
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        hid_t file = hdf_create(path), fixed = hdf_text_type(8);
        put_set(file, "z", H5T_IEEE_F32LE, 2, SHAPE, NULL, H5P_DEFAULT);
        hdf_attach(file, "z", wrong[k].name, wrong[k].type, wrong[k].points, wrong[k].value);
        assert_true(H5Fclose(file) >= 0);
        refuse(path, NULL, wrong[k].name);
        file = hdf_create(path);
        put_set(file, "z", H5T_IEEE_F32LE, 2, SHAPE, NULL, H5P_DEFAULT);
        hdf_attach(file, "z", wrong[k].name, fixed, 0, text);
        H5Tclose(fixed);
        assert_true(H5Fclose(file) >= 0);
        refuse(path, NULL, wrong[k].name);
    }
    scratch_remove(&s);
}

static void units_of_netcdf(void **state) {
    (void)state;
    static const struct {
        const char *name, *unit;
        double metres;
    } known[] = {{"units", "um", 1e-6}, {"units", "m", 1}, {"units", "nanometers", 1e-9}};
    scratch s = scratch_create();
    char path[400];
    scratch_path(&s, "m.h5", path);
    hid_t fixed = hdf_text_type(16);
    for (size_t k = 0; k < 3; k++) {
        char text[16] = "";
        snprintf(text, sizeof text, "%s", known[k].unit);
        hid_t file = hdf_create(path);
        put_set(file, "z", H5T_IEEE_F32LE, 2, SHAPE, NULL, H5P_DEFAULT);
        hdf_attach(file, "z", known[k].name, fixed, 0, text);
        assert_true(H5Fclose(file) >= 0);
        haft_map *map = accept(path, NULL);
        check_heights(&map, known[k].metres, 0, false);
    }
    hid_t file = hdf_create(path);
    put_set(file, "z", H5T_IEEE_F32LE, 2, SHAPE, NULL, H5P_DEFAULT);
    hdf_attach(file, "z", "units", fixed, 0, "volt\0\0\0\0\0\0\0\0\0\0\0");
    assert_true(H5Fclose(file) >= 0);
    refuse(path, NULL, "is not one text naming a length");
    H5Tclose(fixed);
    scratch_remove(&s);
}

/* ---- shapes and types ---- */

static void dimensions_of_one(void **state) {
    (void)state;
    static const struct {
        int rank;
        hsize_t dims[4];
    } shapes[] = {{3, {1, ROWS, COLUMNS}},
                  {3, {ROWS, 1, COLUMNS}},
                  {3, {ROWS, COLUMNS, 1}},
                  {4, {1, 1, ROWS, COLUMNS}}};
    static const hsize_t line[] = {1, PIXELS}, cube[] = {2, 3, COLUMNS};
    scratch s = scratch_create();
    char path[400];
    scratch_path(&s, "m.h5", path);
    for (size_t k = 0; k < sizeof shapes / sizeof *shapes; k++) {
        hid_t file = hdf_create(path);
        put_set(file, "z", H5T_IEEE_F64LE, shapes[k].rank, shapes[k].dims, NULL, H5P_DEFAULT);
        put_set(file, "x", H5T_IEEE_F64LE, 2, line, NULL, H5P_DEFAULT);
        put_set(file, "cube", H5T_IEEE_F64LE, 3, cube, NULL, H5P_DEFAULT);
        assert_true(H5Fclose(file) >= 0);
        haft_map *map = accept(path, NULL);
        assert_string_equal(map->channel, "z");
        check_heights(&map, 1e-9, 0, false);
        map = accept(path, "/z");
        check_heights(&map, 1e-9, 0, false);
        refuse(path, "cube", "it has the shape 2 x 3 x 8; a map has two sides");
        refuse(path, "x", "it has the shape 1 x 48");
        refuse(path, "y", "has no dataset \"y\"; it has: z");
    }
    hid_t file = hdf_create(path);
    put_set(file, "cube", H5T_IEEE_F64LE, 3, cube, NULL, H5P_DEFAULT);
    assert_true(H5Fclose(file) >= 0);
    refuse(path, NULL, "\"cube\" has the shape 2 x 3 x 8");
    scratch_remove(&s);
}

static void types_that_are_no_numbers(void **state) {
    (void)state;
    hid_t complex = H5Tcreate(H5T_COMPOUND, 16), text = hdf_text_type(4);
    hid_t two = H5Tarray_create2(H5T_IEEE_F64LE, 1, (hsize_t[]){2});
    H5Tinsert(complex, "r", 0, H5T_IEEE_F64LE);
    H5Tinsert(complex, "i", 8, H5T_IEEE_F64LE);
    const struct {
        hid_t type;
        const char *says;
    } types[] = {{complex, "is of compound numbers, as complex ones are"},
                 {text, "holds texts, no numbers"},
                 {two, "is of a type that is no number"}};
    scratch s = scratch_create();
    char path[400];
    scratch_path(&s, "m.h5", path);
    for (size_t k = 0; k < 3; k++) {
        hid_t file = hdf_create(path), space = H5Screate_simple(2, SHAPE, NULL);
        hid_t set =
            H5Dcreate2(file, "z", types[k].type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
        assert_true(set >= 0);
        H5Dclose(set);
        H5Sclose(space);
        assert_true(H5Fclose(file) >= 0);
        refuse(path, NULL, types[k].says);
        refuse(path, "z", types[k].says);
    }
    H5Tclose(complex);
    H5Tclose(text);
    H5Tclose(two);
    scratch_remove(&s);
}

/* ---- open elsewhere ---- */

static void files_that_are_open_elsewhere(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400], copy[400];
    scratch_path(&s, "m.h5", path);
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
    hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, access);
    put_set(file, "z", H5T_IEEE_F64LE, 2, SHAPE, NULL, H5P_DEFAULT);
    H5Fflush(file, H5F_SCOPE_GLOBAL);
    refuse(path, NULL, "is open for writing in another program, or was not closed properly");
    refuse(path, NULL, "h5clear -s");
    size_t size = 0;
    char *bytes = read_whole_file(path, &size);
    write_file(scratch_path(&s, "copy.h5", copy), bytes, size);
    free(bytes);
    refuse(copy, NULL, "was not closed properly");
    assert_true(H5Fclose(file) >= 0);
    haft_map *map = accept(path, NULL);
    assert_string_equal(map->note, "");
    check_heights(&map, 1e-9, 0, false);

    /* the older format is read, and said to be held */
    file = hdf_create(path);
    put_set(file, "z", H5T_IEEE_F64LE, 2, SHAPE, NULL, H5P_DEFAULT);
    H5Fflush(file, H5F_SCOPE_GLOBAL);
    map = accept(path, NULL);
    assert_non_null(strstr(map->note, "open for writing in another program"));
    check_heights(&map, 1e-9, 0, false);
    assert_true(H5Fclose(file) >= 0);
    /* a file that is truly damaged is not said to be open */
    bytes = read_whole_file(path, &size);
    write_file(path, bytes, size / 2);
    free(bytes);
    refuse(path, NULL, "cut short or damaged");
    H5Pclose(access);
    scratch_remove(&s);
}

int main(void) {
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(packed_numbers),
        cmocka_unit_test(declared_and_undeclared_marks),
        cmocka_unit_test(units_of_netcdf),
        cmocka_unit_test(dimensions_of_one),
        cmocka_unit_test(types_that_are_no_numbers),
        cmocka_unit_test(files_that_are_open_elsewhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
