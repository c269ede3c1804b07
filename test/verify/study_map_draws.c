/* SPDX-License-Identifier: GPL-3.0-or-later */
/* 200 maps of each kind of generated_maps.h: PSD and fit are inside their 95 % intervals as often
 * as they say. */
#include "generated_maps.h"

enum { DRAWS = 200 };

static void known_psds_are_recovered(void **state) {
    (void)state;
    map_coverage c[MAP_HARMS];
    for (int harm = 0; harm < MAP_HARMS; harm++) {
        c[harm] = map_cover((map_harm)harm, DRAWS);
    }
    for (int harm = 0; harm < MAP_HARMS; harm++) {
        map_check_coverage(&c[harm], (map_harm)harm);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(known_psds_are_recovered)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
