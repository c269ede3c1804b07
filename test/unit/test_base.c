/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The base room: errors, memory, units, random streams, digests. */
#include "check.h"

#include <locale.h>

#include <gsl/gsl_cdf.h>

static void errors_keep_their_message(void **state) {
    (void)state;
    haft_error error = {0};
    assert_int_equal(haft_error_set(&error, HAFT_ERROR_INPUT, "bad %d", 3), HAFT_ERROR_INPUT);
    haft_error_prefix(&error, "file:%d: ", 7);
    assert_string_equal(error.message, "file:7: bad 3");
    assert_int_equal(haft_error_set(NULL, HAFT_ERROR_IO, "x"), HAFT_ERROR_IO);
    char *text = malloc(3 * HAFT_ERROR_CAPACITY);
    memset(text, 'a', 3 * HAFT_ERROR_CAPACITY);
    text[3 * HAFT_ERROR_CAPACITY - 1] = '\0';
    haft_error_set(&error, HAFT_ERROR_IO, "%s", text);
    assert_int_equal(strlen(error.message), HAFT_ERROR_CAPACITY - 1);
    assert_string_equal(error.message + HAFT_ERROR_CAPACITY - 4, "...");
    free(text);
}

static void memory_is_zeroed_aligned_and_checked(void **state) {
    (void)state;
    haft_error error = {0};
    unsigned char *memory = haft_memory_alloc(1000, 3, &error);
    assert_non_null(memory);
    assert_int_equal((uintptr_t)memory % 64, 0);
    for (int i = 0; i < 3000; i++) {
        assert_int_equal(memory[i], 0);
    }
    haft_memory_free(memory);
    haft_memory_free(NULL);
    assert_null(haft_memory_alloc(SIZE_MAX / 2, 3, &error));
    assert_int_equal(error.status, HAFT_ERROR_MEMORY);
}

static void check_message(const char *message, const char *says) {
    if (strstr(message, says) == NULL) {
        fail_msg("\"%s\" is not in: %s", says, message);
    }
}

/* Whatever the locale says, a point is a decimal one and a comma none. */
static void numbers_are_decimal(void **state) {
    (void)state;
    static const char *const good[] = {"1.5", " +1.5e0\t", "15e-1", "0.15E+1", "1.5000"};
    static const char *const bad[] = {"",     "1,5",   "0x1.8p0", "nan",   "inf",  "1.5 2",
                                      "1.5n", "1e999", "1e-999",  "+-1.5", "1.5e", ". 5"};
    for (size_t k = 0; k < 2; k++) {
        for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
            double value = 0;
            assert_true(haft_number_read(good[i], &value));
            assert_true(value == 1.5);
        }
        for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
            double value = -1;
            assert_false(haft_number_read(bad[i], &value));
            assert_true(value == -1);
        }
        if (setlocale(LC_ALL, "de_DE.UTF-8") == NULL && setlocale(LC_ALL, "fr_FR.UTF-8") == NULL) {
            break; /* not installed */
        }
    }
    setlocale(LC_ALL, "C");
}

static void units_convert_and_refuse(void **state) {
    (void)state;
    haft_error error = {0};
    haft_units *units = NULL;
    check_ok(haft_units_create(&units, &error), error);
    static const struct {
        const char *text, *unit;
        double value;
    } good[] = {
        {"600 um", "m", 600e-6},
        {"163 GPa", "Pa", 163e9},
        {"289 rad/um", "rad/m", 289e6},
        {"6.46e3 nm^4", "m^4", 6.46e-33},
        {"85 %", "1", 0.85},
        {"0.22", "1", 0.22},
        {"72 mN/m", "N/m", 0.072},
        {"  2.62um", "m", 2.62e-6},
        {"18 cm3/mol", "m3/mol", 18e-6},
        {"300 K", "K", 300},
        {"20 degC", "K", 293.15},
        {"20 \xc2\xb0"
         "C",
         "K", 293.15},
        {"1e3um", "m", 1e-3},
        {"+5. nm", "m", 5e-9},
        {".5E+1\tnm ", "m", 5e-9},
        {"2 \xc2\xb5m", "m", 2e-6},
        {"2 \xce\xbcm", "m", 2e-6},
        {"2\xc2\xa0um", "m", 2e-6},
        {"3 \xc3\x85", "m", 3e-10},
        {"2 nm\xc2\xb2", "m^2", 2e-18},
        {"22.5 mJ/m2", "J/m^2", 0.0225},
        {"22.5 mJ m-2", "N/m", 0.0225},
        {"22.5 mJ.m^-2", "N/m", 0.0225},
        {"22.5 mN\xc2\xb7m/m\xc2\xb2", "N/m", 0.0225},
        {"2 kg/(m s2)", "Pa", 2},
        {"289 1/um", "rad/m", 289e6},
        {"289 um-1", "rad/m", 289e6},
        {"180 degree", "rad", 3.14159265358979323846},
        {"10%", "1", 0.1},
        {"500 ppm", "1", 5e-4},
        {"0 nm", "m", 0},
        {"0e-999 nm", "m", 0},
    };
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        double value = 0;
        check_ok(haft_units_parse(units, good[i].text, good[i].unit, &value, &error), error);
        check_relative(value, good[i].value, 1e-14);
    }
    static const struct {
        const char *text, *unit, *says;
    } bad[] = {
        {"1 900 nm", "m",
         "a second number; write one decimal number and a unit that converts to m"},
        {"400 nm 2", "m", "a second number"},
        {"400 2 nm", "m", "a second number"},
        {"400 nm\xc2\xa0"
         "2",
         "m", "a second number"},
        {"400 nm\xc2\xb7"
         "2",
         "m", "a second number"},
        {"400 nm*2", "m", "a second number"},
        {"400 nm/2", "m", "a second number"},
        {"400 1/2 um", "m", "a second number"},
        {"400 nm since 1990", "m", "no part of a unit"},
        {"400 nm FROM 2 um", "m", "no part of a unit"},
        {"400 nm @ 1990", "m", "no part of a unit"},
        {"20 K @ 273.15", "K", "no part of a unit"},
        {"3 lg(re 1 nm)", "m", "no part of a unit"},
        {"400 nm^1.5", "m", "a second number"},
        {"400 nm^2^3", "m", "no part of a unit"},
        {"400 nm\xc2\xb2"
         "2",
         "m^2", "a second number"},
        {"400 (nm", "m", "cut short"},
        {"400 nm)", "m", "no part of a unit"},
        {"400 nm/", "m", "cut short"},
        {"400 nm, say", "m", "no part of a unit"},
        {"400 nm # gap", "m", "no part of a unit"},
        {"400 nm\n", "m", "no part of a unit"},
        {"400 \xef\xbc\x92 nm", "m", "no part of a unit"},
        {"\xef\xbc\x92 nm", "m", "does not begin with a number"},
        {"400 nm nm", "m", "wrong dimension"},
        {"0.5 1/um", "m", "wrong dimension"},
        {"0x10 um", "m", "hexadecimal"},
        {"0x1p4 um", "m", "hexadecimal"},
        {"inf nm", "m", "not a finite"},
        {"-Infinity nm", "m", "not a finite"},
        {"nan(1) nm", "m", "not a finite"},
        {"1e-999 nm", "m", "too small"},
        {"1,5 nm", "m", "comma"},
        {"1,900 nm", "m", "comma"},
        {"1.2.3 nm", "m", "a number that is none"},
        {"1e3e3", "1", "a number that is none"},
        {"1e3e3 nm", "m", "a number that is none"},
        {"1_000 nm", "m", "is unknown"},
        {"1'000 nm", "m", "no part of a unit"},
        {"- 5 nm", "m", "does not begin with a number"},
        {"--5 nm", "m", "does not begin with a number"},
        {"85 %%", "1", "no part of a unit"},
        {"85 % %", "1", "no part of a unit"},
        {"85 % nm", "m", "no part of a unit"},
        {"0.85 rad", "1", "wrong dimension"},
        {"85 %", "rad", "wrong dimension"},
        {"5 5", "1", "a second number; write one decimal number and at most a %"},
        {"2.62 kg", "m", "wrong dimension"},
        {"600", "m", "no unit"},
        {"nan um", "m", "not a finite"},
        {"wide", "m", "does not begin with a number"},
        {"1e999 m", "m", "not a finite"},
        {"3 furlongz", "m", "unknown"},
        {"", "m", "does not begin"},
        {"3 m", "1", "wrong dimension"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        double value = -1;
        assert_int_equal(haft_units_parse(units, bad[i].text, bad[i].unit, &value, &error),
                         HAFT_ERROR_INPUT);
        check_message(error.message, bad[i].says);
        assert_true(value == -1);
    }
    haft_units_destroy(&units);
    haft_units_destroy(&units);
    assert_null(units);
}

/* Known answers of Philox4x64-10, from Random123's own kat_vectors. */
static void philox_gives_the_published_answers(void **state) {
    (void)state;
    uint64_t words[4];
    haft_random_words((haft_random_key){0, 0}, 0, 0, 0, words);
    assert_true(words[0] == 0x16554d9eca36314cULL && words[1] == 0xdb20fe9d672d0fdcULL &&
                words[2] == 0xd7e772cee186176bULL && words[3] == 0x7e68b68aec7ba23bULL);
}

static void quantile_inverts_the_normal_law(void **state) {
    (void)state;
    for (double z = -8; z <= 8; z += 0.173) {
        double p = gsl_cdf_ugaussian_P(z < 0 ? z : -z);
        double back = haft_random_normal_quantile(p);
        check_relative(back, z < 0 ? z : -z, 2e-14);
    }
    check_near(haft_random_normal_quantile(0.5), 0, 0);
}

static void streams_can_be_cut_anywhere(void **state) {
    (void)state;
    haft_random_key key = {42, HAFT_RANDOM_TEST};
    double whole[100], part[37];
    haft_random_normals(key, 3, 5, 0, 100, whole);
    haft_random_normals(key, 3, 5, 23, 37, part);
    assert_memory_equal(part, whole + 23, sizeof part);
    double sum = 0, squares = 0;
    enum { N = 400000 };
    double *z = haft_memory_alloc(N, sizeof *z, NULL);
    haft_random_normals(key, 0, 0, 0, N, z);
    for (int i = 0; i < N; i++) {
        sum += z[i];
        squares += z[i] * z[i];
    }
    check_near(sum / sqrt(N), 0, 4);
    check_near((squares - N) / sqrt(2.0 * N), 0, 4);
    haft_memory_free(z);
}

static void digests_follow_content(void **state) {
    (void)state;
    char a[HAFT_DIGEST_CAPACITY], b[HAFT_DIGEST_CAPACITY];
    haft_digest_memory("beam", 4, a);
    haft_digest_memory("bean", 4, b);
    assert_int_equal(strlen(a), HAFT_DIGEST_CAPACITY - 1);
    assert_string_not_equal(a, b);
    haft_digest_memory("bean", 4, a);
    assert_string_equal(a, b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_keep_their_message),
        cmocka_unit_test(memory_is_zeroed_aligned_and_checked),
        cmocka_unit_test(units_convert_and_refuse),
        cmocka_unit_test(numbers_are_decimal),
        cmocka_unit_test(philox_gives_the_published_answers),
        cmocka_unit_test(quantile_inverts_the_normal_law),
        cmocka_unit_test(streams_can_be_cut_anywhere),
        cmocka_unit_test(digests_follow_content),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
