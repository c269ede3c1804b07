/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Patches of map windows: every window is found again in its map, mirrored or not; numbers decide.
 */
#include "check.h"

#include "haft/surface_map.h"

enum { R = 24, C = 30, ROWS = 40, COLUMNS = 50 };

/* A map whose heights name their pixels: even i and j steps are told apart. */
static haft_map *named_map(double base, double step) {
    haft_map *map = NULL;
    haft_error error = {0};
    check_ok(haft_map_create(&map, R, C, step, step, &error), error);
    for (size_t i = 0; i < R * C; i++) {
        map->z[i] = base + (double)(i * i % 7919);
    }
    return map;
}

/* Whether the window at (i0, j0) of the patch is a window of the map in any of its four images. */
static bool is_window(const double *z, size_t i0, size_t i1, size_t j0, size_t j1,
                      const haft_map *map) {
    for (size_t top = 0; top + (i1 - i0) <= R; top++) {
        for (size_t left = 0; left + (j1 - j0) <= C; left++) {
            for (int image = 0; image < 4; image++) {
                bool same = true;
                for (size_t i = i0; i < i1 && same; i++) {
                    for (size_t j = j0; j < j1 && same; j++) {
                        size_t p = top + (image & 1 ? i1 - 1 - i : i - i0);
                        size_t q = left + (image & 2 ? j1 - 1 - j : j - j0);
                        same = fabs(z[i * COLUMNS + j] - map->z[p * C + q]) < 1e-6;
                    }
                }
                if (same) {
                    return true;
                }
            }
        }
    }
    return false;
}

static void windows_are_of_the_maps(void **state) {
    (void)state;
    haft_error error = {0};
    haft_map *a = named_map(0, 1e-9), *b = named_map(1e5, 1e-9);
    const haft_map *const maps[] = {a, b};
    haft_tiling_spec spec = {
        .n = 2, .maps = maps, .grid_step = 1e-9, .rows = ROWS, .columns = COLUMNS, .seed = 4};
    haft_tiling *tiling = NULL;
    check_ok(haft_tiling_create(&tiling, &spec, &error), error);
    size_t count[2], used[2] = {0, 0};
    haft_tiling_count(tiling, count);
    assert_int_equal(count[0], 4); /* 12 rows at most */
    assert_int_equal(count[1], 4); /* 15 columns at most */
    static double z[ROWS * COLUMNS], again[ROWS * COLUMNS], other[ROWS * COLUMNS];
    haft_tiling_fill(tiling, 0, 3, z);
    for (size_t i = 0; i < 4; i++) {
        for (size_t j = 0; j < 4; j++) {
            size_t k = z[10 * i * COLUMNS + COLUMNS * j / 4] > 5e4;
            used[k]++;
            assert_true(is_window(z, 10 * i, 10 * (i + 1), COLUMNS * j / 4, COLUMNS * (j + 1) / 4,
                                  maps[k]));
        }
    }
    assert_true(used[0] > 0 && used[1] > 0);
    haft_tiling_fill(tiling, 0, 3, again);
    assert_memory_equal(z, again, sizeof z);
    haft_tiling_fill(tiling, 0, 4, other);
    assert_memory_not_equal(z, other, sizeof z);
    haft_tiling_destroy(&tiling);

    /* two faces are the sum of each; a face of the height 1 everywhere adds 1 */
    haft_map *flat = named_map(0, 1e-9);
    for (size_t i = 0; i < R * C; i++) {
        flat->z[i] = 1;
    }
    const haft_map *const plain[] = {flat};
    spec.opposite = plain;
    spec.opposite_n = 1;
    check_ok(haft_tiling_create(&tiling, &spec, &error), error);
    haft_tiling_fill(tiling, 0, 3, again);
    for (size_t i = 0; i < ROWS * COLUMNS; i++) {
        check_near(again[i], z[i] + 1, 1e-6);
    }
    haft_tiling_destroy(&tiling);
    flat->z[7] = NAN;
    assert_int_equal(haft_tiling_create(&tiling, &spec, &error), HAFT_ERROR_INPUT);
    assert_non_null(strstr(error.message, "missing pixels"));
    spec.n = 0;
    assert_int_equal(haft_tiling_create(&tiling, &spec, &error), HAFT_ERROR_INPUT);
    haft_map_destroy(&a);
    haft_map_destroy(&b);
    haft_map_destroy(&flat);
}

/* Pixels that are not square, on a finer grid: a smooth wave keeps its heights and its slopes. */
static void maps_are_brought_to_the_grid(void **state) {
    (void)state;
    haft_error error = {0};
    haft_map *map = NULL;
    double dy = 8e-9, dx = 4e-9, step = 2e-9;
    check_ok(haft_map_create(&map, 60, 120, dy, dx, &error), error);
    for (size_t i = 0; i < 60; i++) {
        for (size_t j = 0; j < 120; j++) {
            map->z[i * 120 + j] =
                cos(2 * M_PI * ((double)i * dy / 160e-9 + (double)j * dx / 120e-9));
        }
    }
    const haft_map *const maps[] = {map};
    haft_tiling_spec spec = {
        .n = 1, .maps = maps, .grid_step = step, .rows = 100, .columns = 100, .seed = 1};
    haft_tiling *tiling = NULL;
    static double z[100 * 100];
    check_ok(haft_tiling_create(&tiling, &spec, &error), error);
    size_t count[2];
    haft_tiling_count(tiling, count);
    assert_int_equal(count[0] * count[1], 1);
    double worst = 0;
    haft_tiling_fill(tiling, 0, 0, z);
    /* inside one window the wave obeys its own equation: z(+) + z(-) = 2 cos(k h) z along either
     * way */
    for (size_t i = 20; i < 80; i++) {
        for (size_t j = 20; j < 80; j++) {
            double x = z[i * 100 + j + 5] + z[i * 100 + j - 5] -
                       2 * cos(2 * M_PI * 5 * step / 120e-9) * z[i * 100 + j];
            double y = z[(i + 5) * 100 + j] + z[(i - 5) * 100 + j] -
                       2 * cos(2 * M_PI * 5 * step / 160e-9) * z[i * 100 + j];
            worst = fmax(worst, fmax(fabs(x), fabs(y)));
        }
    }
    check_less(worst, 2e-3);
    haft_tiling_destroy(&tiling);
    haft_map_destroy(&map);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(windows_are_of_the_maps),
        cmocka_unit_test(maps_are_brought_to_the_grid),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
