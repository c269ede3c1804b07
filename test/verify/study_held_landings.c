/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every jump of ten slender beams in contact over 400 sites lands where IDA says it does. */
#include "held_oracle.h"

static void what_is_held_changes_no_landing(void **state) {
    (void)state;
    double worst = 0;
    size_t jumps = 0;
    for (uint64_t seed = 1; seed <= 10; seed++) {
        jumps += check_held_landings(1200e-6, seed, &worst);
    }
    print_message("  %zu jumps, gaps within %.1e m of IDA's\n", jumps, worst);
    assert_true(jumps > 150);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(what_is_held_changes_no_landing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
