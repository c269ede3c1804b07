/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ten thousand random beams over hard laws: every state, the ledger and a sample of the landings
 * against an oracle of the test's own, and three meshes against each other.
 * Usage: hard-stress [BEAMS [SEED [FIRST [LANDINGS]]]]: how many, of which seed, from which on, and
 * how many landings are compared of every eighth beam of a family. With BEAMS 1, the beam FIRST is
 * described. */
#include "stress_report.h"

static void no_beam_goes_wrong(void **state) {
    assert_int_equal(stress_study_run(*state), 0);
}

int main(int argc, char **argv) {
    stress_options options = {.seed = 1, .beams = 10000, .landings = 3, .every = 8};
    options.beams = argc > 1 ? strtoull(argv[1], NULL, 10) : options.beams;
    options.seed = argc > 2 ? strtoull(argv[2], NULL, 10) : options.seed;
    options.first = argc > 3 ? strtoull(argv[3], NULL, 10) : options.first;
    options.landings = argc > 4 ? strtoull(argv[4], NULL, 10) : options.landings;
    options.every = options.beams == 1 ? 1 : options.every;
    options.told = options.beams == 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_prestate(no_beam_goes_wrong, &options),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
