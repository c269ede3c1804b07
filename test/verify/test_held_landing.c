/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every jump of a slender beam in long contact lands where IDA says it does. */
#include "held_oracle.h"

static void what_is_held_changes_no_landing(void **state) {
    (void)state;
    double worst = 0;
    size_t jumps = check_held_landings(750e-6, 1, &worst);
    print_message("  %zu jumps, gaps within %.1e m of IDA's\n", jumps, worst);
    assert_true(jumps > 10);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(what_is_held_changes_no_landing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
