/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Maps of a known PSD as instruments would give them: a short version of study_map_draws.c.
 * And holes: the PSD of a map with them is that of the map without, to 5 % in every ring. */
#include "generated_maps.h"

enum { DRAWS = 20, PIERCED = 8 };

static void known_psds_are_recovered(void **state) {
    (void)state;
    static const map_harm kinds[] = {MAP_NOISY, MAP_BAND_LIMITED, MAP_DILATED};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        map_coverage c = map_cover(kinds[k], DRAWS);
        map_check_coverage(&c, kinds[k]);
    }
}

/* Every second point of a surface whose waves are shorter than a pixel of the map, so that its PSD
 * reaches the corners of the plane of wave vectors, as that of a measured map does. */
static haft_map *draw_sampled(haft_surface_work *work, uint64_t stream) {
    static double z[4 * MAP_PIXELS];
    haft_error error = {0};
    haft_map *map = NULL;
    check_ok(haft_map_create(&map, MAP_SIDE, MAP_SIDE, MAP_STEP, MAP_STEP, &error), error);
    check_ok(haft_surface_prepare(work, 0, stream, 0, &error), error);
    check_ok(haft_surface_rows(work, 0, 2 * MAP_SIDE, z, &error), error);
    for (size_t k = 0; k < MAP_PIXELS; k++) {
        map->z[k] = z[2 * (k / MAP_SIDE) * 2 * MAP_SIDE + 2 * (k % MAP_SIDE)];
    }
    return map;
}

static haft_psd_table *estimate(haft_map *map) {
    haft_error error = {0};
    haft_psd_table *table = NULL;
    const haft_map *const maps[] = {map};
    check_ok(haft_map_level(map, HAFT_LEVEL_PLANE, &error), error);
    check_ok(haft_psd_estimate(&table, 1, maps, HAFT_WINDOW_HANN, &error), error);
    haft_map_destroy(&map);
    return table;
}

/* The mean over draws of the PSD with holes over that without, in every ring: within 5 %, and three
 * times what chance leaves of it. */
static void holes_do_not_change_the_psd(void **state) {
    (void)state;
    haft_error error = {0};
    haft_surface_plan *plan = NULL;
    haft_surface_work *work = NULL;
    haft_surface_spec spec = {.psd = map_psd(15e6, 2 * M_PI / MAP_STEP * (1 - 1e-9)),
                              .grid_step = MAP_STEP / 2,
                              .rows = 2 * MAP_SIDE,
                              .columns = 2 * MAP_SIDE,
                              .tolerance = 1e-5,
                              .key = {24, HAFT_RANDOM_TEST}};
    check_ok(haft_surface_plan_create(&plan, &spec, &error), error);
    check_ok(haft_surface_work_create(&work, plan, &error), error);
    double sum[MAP_HARMS][MAP_RINGS_MOST] = {0}, square[MAP_HARMS][MAP_RINGS_MOST] = {0}, at = 0;
    size_t rings = 0;
    for (uint64_t k = 0; k < PIERCED; k++) {
        haft_map *map = draw_sampled(work, k), *pierced[MAP_HARMS] = {NULL};
        for (map_harm harm = MAP_HOLES_PIXELS; harm < MAP_HARMS; harm++) {
            check_ok(haft_map_copy(&pierced[harm], map, &error), error);
            map_pierce(pierced[harm], harm, 0.06, k);
        }
        haft_psd_table *whole = estimate(map);
        rings = whole->n;
        at = whole->zeta[rings - 1];
        for (map_harm harm = MAP_HOLES_PIXELS; harm < MAP_HARMS; harm++) {
            haft_psd_table *with = estimate(pierced[harm]);
            for (size_t i = 0; i < rings; i++) {
                double ratio = with->s[i] / whole->s[i] - 1;
                sum[harm][i] += ratio / PIERCED;
                square[harm][i] += ratio * ratio / PIERCED;
                check_less(with->count[i], whole->count[i]);
            }
            haft_psd_table_destroy(&with);
        }
        haft_psd_table_destroy(&whole);
    }
    for (map_harm harm = MAP_HOLES_PIXELS; harm < MAP_HARMS; harm++) {
        double worst = 0;
        for (size_t i = 0; i < rings; i++) {
            double mean = sum[harm][i];
            double chance = sqrt(fmax(0, square[harm][i] - mean * mean) / (PIERCED - 1));
            worst = fmax(worst, fabs(mean));
            check_less(fabs(mean), 0.05 + 3 * chance);
            check_less(chance, 0.05);
        }
        print_message("%s: with holes over without, worst ring off by %.1f %%, last %.1f %% at "
                      "%.0f rad/um\n",
                      map_harm_names[harm], 100 * worst, 100 * sum[harm][rings - 1], at * 1e-6);
    }
    haft_surface_work_destroy(&work);
    haft_surface_plan_destroy(&plan);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(known_psds_are_recovered),
                                       cmocka_unit_test(holes_do_not_change_the_psd)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
