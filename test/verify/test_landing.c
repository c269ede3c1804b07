/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every jump of three random beams lands where CVODE says it does. */
#include "landing_oracle.h"

static void every_jump_lands_where_cvode_does(void **state) {
    (void)state;
    size_t jumps = 0;
    double worst = 0;
    for (uint64_t seed = 1; seed <= 3; seed++) {
        jumps += check_landings(seed, &worst);
    }
    print_message("  %zu jumps, gaps within %.1e m of CVODE's\n", jumps, worst);
    assert_true(jumps > 30);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_jump_lands_where_cvode_does)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
