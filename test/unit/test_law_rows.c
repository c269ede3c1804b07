/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a beam asks of many laws: their values at once, how far they reach. */
#include "check.h"
#include "haft/law.h"

static double uniform(uint64_t k, uint64_t j, double low, double high) {
    uint64_t words[4];
    haft_random_words((haft_random_key){11, HAFT_RANDOM_TEST}, k, j, 0, words);
    return low + (high - low) * haft_random_uniform(words[0]);
}

/* Asked for less, the same bits of it. */
static void check_parts(const haft_law_rows *rows, size_t first, size_t n, const double *d,
                        const haft_law_values *all) {
    enum { ROOM = 64 };
    double part[3][ROOM];
    size_t bytes = n * sizeof(double);
    assert_true(n <= ROOM);
    const haft_law_values force = {.force = part[0]}, three = {part[0], part[1], NULL, part[2]};
    assert_true(haft_law_rows_evaluate(rows, first, n, d, &force) < n);
    assert_memory_equal(part[0], all->force, bytes);
    assert_true(haft_law_rows_evaluate(rows, first, n, d, &three) < n);
    assert_memory_equal(part[0], all->force, bytes);
    assert_memory_equal(part[1], all->slope, bytes);
    assert_memory_equal(part[2], all->potential, bytes);
}

/* Laws that are all out of reach say so and are 0; one within reach, in whatever lane, is felt. */
static void a_free_span_is_told(void **state) {
    (void)state;
    enum { LAWS = 2 * HAFT_SIMD_WIDTH, ROOM = LAWS };
    haft_error error = {0};
    haft_law law[LAWS];
    haft_law_rows *rows = NULL;
    double d[ROOM] = {0}, out[4][ROOM];
    const haft_law_vector v = {.e = 4e-3, .f_max = 1e6, .d_max = 10e-9, .d_limit = 8e-9};
    for (size_t i = 0; i < LAWS; i++) {
        assert_int_equal(haft_law_morse(&law[i], &v, 5e6), HAFT_LAW_SOUND);
    }
    check_ok(haft_law_rows_create(&rows, LAWS, law, &error), error);
    const haft_law_values asked[3] = {
        {.force = out[0]}, {out[0], out[1], NULL, out[3]}, {out[0], out[1], out[2], out[3]}};
    for (size_t a = 0; a < 3; a++) {
        for (size_t near = 0; near <= LAWS; near++) {
            for (size_t i = 0; i < ROOM; i++) {
                d[i] = i == near ? 11e-9 : 1e-5;
                out[0][i] = out[1][i] = out[2][i] = out[3][i] = 7;
            }
            assert_int_equal(haft_law_rows_evaluate(rows, 0, LAWS, d, &asked[a]),
                             near / HAFT_SIMD_WIDTH * HAFT_SIMD_WIDTH);
            for (size_t i = 0; i < LAWS; i++) {
                assert_true((out[0][i] != 0) == (i == near));
                assert_true(asked[a].slope == NULL || (out[1][i] != 0) == (i == near));
                assert_true(asked[a].curvature == NULL || (out[2][i] != 0) == (i == near));
                assert_true(asked[a].potential == NULL || (out[3][i] != 0) == (i == near));
            }
        }
    }
    haft_law_rows_destroy(&rows);
}

/* Laid out or not, whatever stretch is asked for: the same bits. */
static void rows_give_the_same_bits(void **state) {
    (void)state;
    enum { LAWS = 37, POINTS = 40 };
    double x[POINTS], f[POINTS], d[LAWS], out[4][LAWS];
    haft_error error = {0};
    haft_law_table *table = NULL;
    for (int i = 0; i < POINTS; i++) {
        x[i] = 7e-9 + 1e-9 * i;
        f[i] = 1e6 * (i < 8 ? 7 - 2 * i : -9 * exp(-0.3 * (i - 8)));
    }
    f[POINTS - 1] = 0;
    check_ok(haft_law_table_create(&table, POINTS, x, f, &error), error);
    haft_law law[LAWS];
    for (uint64_t k = 0; k < LAWS; k++) {
        haft_law_vector v = {.e = 4e-3 * uniform(k, 0, 1, 3),
                             .f_max = 1e6 * uniform(k, 1, 0.5, 1),
                             .d_max = 1e-9 * uniform(k, 2, 9, 12),
                             .d_limit = 1e-9 * uniform(k, 3, 7, 8)};
        assert_int_equal(haft_law_morse(&law[k], &v, 5e6), HAFT_LAW_SOUND);
    }
    law[5] = law[20] = haft_law_from_table(table);
    haft_law_rows *rows = NULL;
    check_ok(haft_law_rows_create(&rows, LAWS, law, &error), error);
    const haft_law_values values = {out[0], out[1], out[2], out[3]};
    size_t parts_seen[3] = {0};
    for (size_t first = 0; first < LAWS; first += 3) {
        size_t n = LAWS - first;
        memset(d, 0, sizeof d);
        for (size_t i = 0; i < n; i++) { /* behind the wall, on both wings, and far out of reach */
            const haft_law *l = &law[first + i];
            double width = l->kind == HAFT_LAW_TABLE ? 1e-9 : l->d_max - l->wall_distance;
            double middle = l->kind == HAFT_LAW_TABLE ? x[20] : l->d_max;
            d[i] = middle + width * uniform(first, i, -2, first % 2 == 0 ? 4 : 400);
            parts_seen[d[i] < middle - width ? 0 : d[i] < middle ? 1 : 2]++;
        }
        haft_law_rows_evaluate(rows, first, n, d, &values);
        check_parts(rows, first, n, d, &values);
        for (size_t i = 0; i < n; i++) {
            haft_law_value v = haft_law_evaluate(&law[first + i], d[i]);
            const double expected[4] = {v.force, v.slope, v.curvature, v.potential};
            for (int k = 0; k < 4; k++) {
                assert_true(out[k][i] == expected[k]);
            }
        }
    }
    assert_true(parts_seen[0] > 0 && parts_seen[1] > 0 && parts_seen[2] > 0);
    for (size_t i = 0; i < LAWS; i++) { /* a table far beyond its range is nil as the others are */
        d[i] = i < 22 ? 1e-5 : 10e-9;
    }
    assert_int_equal(haft_law_rows_evaluate(rows, 0, LAWS, d, &values),
                     22 / HAFT_SIMD_WIDTH * HAFT_SIMD_WIDTH);
    const haft_law_values force = {.force = out[0]};
    assert_int_equal(haft_law_rows_evaluate(rows, 0, LAWS, d, &force),
                     22 / HAFT_SIMD_WIDTH * HAFT_SIMD_WIDTH);
    assert_int_equal(haft_law_rows_evaluate(rows, 0, 22, d, &values), 22);
    d[5] = NAN; /* a state that has come to nothing: told by what it gives, and no crash */
    haft_law_rows_evaluate(rows, 0, LAWS, d, &values);
    assert_true(isnan(out[0][5]) && isnan(out[3][5]));
    haft_law_rows_destroy(&rows);
    haft_law_table_destroy(&table);
}

/* Against a search from the far end, on rugged curves and every share. */
static void a_tables_reach_is_its_last_crossing(void **state) {
    (void)state;
    enum { N = 300 };
    for (uint64_t curve = 0; curve < 20; curve++) {
        double d[N], f[N], pull = 0;
        haft_random_normals((haft_random_key){11, HAFT_RANDOM_TEST}, 0, curve, 0, N, f);
        for (size_t i = 0; i < N; i++) {
            d[i] = (double)i;
            f[i] = i == 0 ? 9 : (f[i] - 0.8) * (1 - (double)i / (N - 1));
            pull = fmax(pull, -f[i]);
        }
        haft_law_table *table = NULL;
        haft_error error = {0};
        check_ok(haft_law_table_create(&table, N, d, f, &error), error);
        haft_law law = haft_law_from_table(table);
        for (double share = 0.005; share < 1; share += 0.0199) {
            size_t i = N - 1;
            while (f[i] > -share * pull) {
                i--;
            }
            double reach = haft_law_reach(&law, share);
            assert_true(reach >= d[i] && reach <= d[i + 1]);
            check_near(haft_law_evaluate(&law, reach).force, -share * pull, 1e-12 * pull);
        }
        haft_law_table_destroy(&table);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(rows_give_the_same_bits),
                                       cmocka_unit_test(a_free_span_is_told),
                                       cmocka_unit_test(a_tables_reach_is_its_last_crossing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
