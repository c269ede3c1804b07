/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NumPy arrays written byte by byte: every type, byte order and order of rows and columns gives the
 * heights that were written; what is no map is refused with what is wrong. */
#include "scratch.h"

#include "haft/io.h"

enum { ROWS = 5, COLUMNS = 4, CAPACITY = 4096 };

typedef struct npy_file {
    char bytes[CAPACITY];
    size_t size;
} npy_file;

/* Magic, version, header, padded as NumPy does. */
static npy_file begin(int major, const char *header) {
    npy_file f = {.size = 0};
    size_t prefix = major == 1 ? 10 : 12, n = strlen(header);
    size_t padded = (prefix + n + 1 + 63) / 64 * 64 - prefix;
    memcpy(f.bytes, "\x93NUMPY", 6);
    f.bytes[6] = (char)major;
    for (size_t k = 0; k < prefix - 8; k++) {
        f.bytes[8 + k] = (char)(padded >> (8 * k));
    }
    memset(f.bytes + prefix, ' ', padded);
    memcpy(f.bytes + prefix, header, n);
    f.bytes[prefix + padded - 1] = '\n';
    f.size = prefix + padded;
    return f;
}

static void put_word(npy_file *f, uint64_t word, size_t n, bool big_endian) {
    assert_true(f->size + n <= CAPACITY);
    for (size_t k = 0; k < n; k++) {
        f->bytes[f->size + (big_endian ? n - 1 - k : k)] = (char)(word >> (8 * k));
    }
    f->size += n;
}

/* A half: 5 bits of exponent, 10 of fraction; of small whole numbers and their quarters. */
static uint64_t half_of(double value) {
    int exponent = 0;
    double fraction = frexp(fabs(value), &exponent);
    uint64_t sign = value < 0 ? 0x8000 : 0;
    return value == 0
               ? 0
               : sign | (uint64_t)(exponent + 14) << 10 | (uint64_t)(ldexp(fraction, 11) - 1024);
}

static void put_number(npy_file *f, double value, char kind, size_t n, bool big_endian) {
    uint64_t word = 0;
    float single = (float)value;
    if (kind != 'f') {
        word = (uint64_t)(int64_t)value; /* two's complement */
    } else if (n == 8) {
        memcpy(&word, &value, 8);
    } else if (n == 4) {
        uint32_t half = 0;
        memcpy(&half, &single, 4);
        word = half;
    } else {
        word = half_of(value);
    }
    put_word(f, word, n, big_endian);
}

/* The height of a pixel, which the type can hold. */
static double height(size_t i, size_t j, char kind) {
    double whole = (double)(7 * i + 31 * j % 11 + i * j);
    return kind == 'u' ? whole : kind == 'i' ? whole - 20 : 0.25 * whole - 5;
}

static const haft_map_options sized = {.width = 8e-6, .height = 5e-6, .unit = 1e-9};

static haft_status read_array(haft_map **map, const scratch *s, const npy_file *f,
                              const haft_map_options *options, haft_error *error) {
    char path[400];
    write_file(scratch_path(s, "map.npy", path), f->bytes, f->size);
    return haft_map_read(map, path, options, NULL, error);
}

static void check_heights(const haft_map *map, char kind) {
    assert_int_equal(map->rows, ROWS);
    assert_int_equal(map->columns, COLUMNS);
    check_relative(map->step_column, 2e-6, 1e-15);
    check_relative(map->step_row, 1e-6, 1e-15);
    for (size_t i = 0; i < ROWS; i++) {
        for (size_t j = 0; j < COLUMNS; j++) {
            check_near(map->z[i * COLUMNS + j], height(i, j, kind) * 1e-9, 0);
        }
    }
}

static void every_type(void **state) {
    (void)state;
    static const struct {
        char kind;
        size_t bytes;
    } types[] = {{'f', 2}, {'f', 4}, {'f', 8}, {'i', 1}, {'i', 2}, {'i', 4},
                 {'i', 8}, {'u', 1}, {'u', 2}, {'u', 4}, {'u', 8}};
    static const char *const shapes[] = {"(5, 4)", "(1, 5, 4)", "(5, 4, 1)", "(5L, 4L)"};
    scratch s = scratch_create();
    for (size_t k = 0; k < 24 * sizeof types / sizeof *types; k++) {
        char kind = types[k / 24].kind, header[200], type[8];
        size_t n = types[k / 24].bytes;
        bool big_endian = k % 2 == 1, by_columns = k / 2 % 2 == 1;
        int major = (int)(k / 4 % 3) + 1;
        snprintf(type, sizeof type, "%c%c%zu", n == 1 ? '|' : big_endian ? '>' : '<', kind, n);
        snprintf(header, sizeof header, "{'descr': '%s', 'fortran_order': %s, 'shape': %s, }", type,
                 by_columns ? "True" : "False", shapes[k % 4]);
        npy_file f = begin(major, header);
        for (size_t place = 0; place < ROWS * COLUMNS; place++) {
            size_t i = by_columns ? place % ROWS : place / COLUMNS;
            size_t j = by_columns ? place / ROWS : place % COLUMNS;
            put_number(&f, height(i, j, kind), kind, n, big_endian);
        }
        haft_map *map = NULL;
        haft_error error = {0};
        check_ok(read_array(&map, &s, &f, &sized, &error), error);
        check_heights(map, kind);
        assert_non_null(strstr(map->format, type));
        haft_map_destroy(&map);
        /* every cut is told */
        for (size_t size = 1; size < f.size; size += 29) {
            npy_file cut = f;
            cut.size = size;
            assert_int_equal(read_array(&map, &s, &cut, &sized, &error), HAFT_ERROR_INPUT);
            assert_null(map);
        }
    }
    scratch_remove(&s);
}

/* The numbers at the ends of what a type can hold, and those that are none. */
static void extremes(void **state) {
    (void)state;
    static const struct {
        const char *type;
        size_t bytes;
        uint64_t word;
        double value;
    } cases[] = {
        {"<i8", 8, 0x8000000000000000u, -9223372036854775808.0},
        {"<i8", 8, 0xffffffffffffffffu, -1},
        {"<u8", 8, 0xffffffffffffffffu, 18446744073709551615.0},
        {"<i2", 2, 0x8000, -32768},
        {"|u1", 1, 255, 255},
        {"|i1", 1, 128, -128},
        {"<f2", 2, 1, 0x1p-24},
        {"<f2", 2, 0x83ff, -1023 * 0x1p-24},
        {"<f2", 2, 0x7bff, 65504},
        {"<f2", 2, 0x3555, 0.333251953125},
        {"<f2", 2, 0x7e00, NAN},
        {"<f4", 4, 0x7fc00000, NAN},
        {"<f4", 4, 0x00000001, 0x1p-149},
        {"<f8", 8, 0x7ff8000000000000u, NAN},
    };
    scratch s = scratch_create();
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char header[200];
        snprintf(header, sizeof header, "{'shape': (2,2), \"descr\": '%s', 'fortran_order':False}",
                 cases[k].type);
        npy_file f = begin(1, header);
        for (int i = 0; i < 4; i++) {
            put_word(&f, cases[k].word, cases[k].bytes, false);
        }
        haft_map *map = NULL;
        haft_error error = {0};
        haft_map_options small = {.width = 1, .height = 1, .unit = 1e-18};
        check_ok(read_array(&map, &s, &f, &small, &error), error);
        double z = cases[k].value * 1e-18;
        for (int i = 0; i < 4; i++) {
            assert_true(isnan(z) ? isnan(map->z[i]) : map->z[i] == z);
        }
        haft_map_destroy(&map);
    }
    scratch_remove(&s);
}

static void refused(void **state) {
    (void)state;
    static const struct {
        const char *header;
        size_t bytes;
        const char *says;
    } cases[] = {
        {"{'descr': '<f8', 'fortran_order': False, 'shape': (5, 4), }", 159, "cut short"},
        {"{'descr': '<f8', 'fortran_order': False, 'shape': (5, 4), }", 161, "is damaged"},
        {"{'descr': '|b1', 'fortran_order': False, 'shape': (5, 4), }", 20, "true or false"},
        {"{'descr': '<c16', 'fortran_order': False, 'shape': (5, 4), }", 320, "complex"},
        {"{'descr': '|O', 'fortran_order': False, 'shape': (5, 4), }", 160, "Python objects"},
        {"{'descr': '<f16', 'fortran_order': False, 'shape': (5, 4), }", 320, "type '<f16'"},
        {"{'descr': '<U8', 'fortran_order': False, 'shape': (5, 4), }", 640, "texts"},
        {"{'descr': '<M8[ns]', 'fortran_order': False, 'shape': (5, 4), }", 160, "'<M8[ns]'"},
        {"{'descr': 'f8', 'fortran_order': False, 'shape': (5, 4), }", 160, "type 'f8'"},
        {"{'descr': [('z', '<f8')], 'fortran_order': False, 'shape': (5, 4), }", 160, "records"},
        {"{'descr': '<f8', 'fortran_order': False, 'shape': (20,), }", 160, "1 dimension: 20"},
        {"{'descr': '<f8', 'fortran_order': False, 'shape': (), }", 8, "0 dimensions"},
        {"{'descr': '<f8', 'fortran_order': False, 'shape': (2, 5, 4), }", 320, "2 x 5 x 4"},
        {"{'descr': '<f8', 'fortran_order': False, 'shape': (1, 4), }", 32, "2 to 32768"},
        {"{'descr': '<f8', 'fortran_order': False, 'shape': (5, 0), }", 0, "2 to 32768"},
        {"{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999999999999999, 4), }", 0,
         "2 to 32768"},
        {"{'descr': '<f8', 'fortran_order': False, 'shape': (-5, 4), }", 160, "no tuple"},
        {"{'descr': '<f8', 'fortran_order': 0, 'shape': (5, 4), }", 160, "neither True nor False"},
        {"{'descr': '<f8', 'shape': (5, 4), }", 160, "each once"},
        {"{'descr': '<f8', 'descr': '<f8', 'fortran_order': False, 'shape': (5, 4), }", 160,
         "each once"},
        {"{'descr': '<f8', 'fortran_order': False, 'shape': (5, 4), } 1", 160, "follows"},
        {"['descr']", 160, "no Python dictionary"},
    };
    scratch s = scratch_create();
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        npy_file f = begin(1, cases[k].header);
        f.size += cases[k].bytes;
        haft_map *map = NULL;
        haft_error error = {0};
        if (read_array(&map, &s, &f, &sized, &error) != HAFT_ERROR_INPUT ||
            strstr(error.message, cases[k].says) == NULL) {
            fail_msg("%s: not \"%s\" but \"%s\"", cases[k].header, cases[k].says, error.message);
        }
        assert_null(map);
    }
    scratch_remove(&s);
}

static void size_and_unit(void **state) {
    (void)state;
    scratch s = scratch_create();
    haft_map *map = NULL;
    haft_error error = {0};
    npy_file f = begin(1, "{'descr': '|u1', 'fortran_order': False, 'shape': (5, 4), }");
    f.size += 20;
    assert_int_equal(read_array(&map, &s, &f, NULL, &error), HAFT_ERROR_INPUT);
    assert_non_null(strstr(error.message, "give its size"));
    haft_map_options half = {.width = 1e-6, .height = 1e-6};
    assert_int_equal(read_array(&map, &s, &f, &half, &error), HAFT_ERROR_INPUT);
    assert_non_null(strstr(error.message, "unit of its heights"));
    f.bytes[6] = 4;
    assert_int_equal(read_array(&map, &s, &f, &sized, &error), HAFT_ERROR_INPUT);
    assert_non_null(strstr(error.message, "version 4.0"));
    npy_file points = begin(1, "{'descr': '|u1', 'fortran_order': False, 'shape': (6, 3), }");
    points.size += 18;
    assert_int_equal(read_array(&map, &s, &points, NULL, &error), HAFT_ERROR_INPUT);
    assert_non_null(strstr(error.message, "points x, y, z"));
    check_ok(read_array(&map, &s, &points, &sized, &error), error);
    haft_map_destroy(&map);
    npy_file infinite = begin(1, "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 2), }");
    for (int i = 0; i < 4; i++) {
        put_number(&infinite, i == 2 ? (double)INFINITY : 0, 'f', 8, false);
    }
    assert_int_equal(read_array(&map, &s, &infinite, &sized, &error), HAFT_ERROR_INPUT);
    assert_non_null(strstr(error.message, "row 2, column 1 is not finite"));
    scratch_remove(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_type), cmocka_unit_test(extremes),
                                       cmocka_unit_test(refused), cmocka_unit_test(size_and_unit)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
