/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Each of the first 2000 allocations of each command fails, once of Haft's own (all there are,
 * where there are fewer), and once of all, those of the libraries beneath it too. */
#include "failing.h"

enum { FIRST = 2000, LATER = 200 };

static void try_all(const char *name, failing_mode mode) {
    failing f;
    failing_create(&f, name, mode);
    failing_begin(&f);
    size_t faults = 0;
    for (unsigned long n = 1; n <= FIRST && failing_try(&f, n, &faults); n++) {
    }
    for (unsigned long i = 0; mode == FAILING_ANY && f.all > FIRST && i < LATER; i++) {
        failing_try(&f, FIRST + 1 + i * (f.all - FIRST) / LATER, &faults);
    }
    failing_end(&f);
    assert_int_equal(faults, 0);
}

#define STUDY(command, number)                                                                     \
    static void own_allocations_of_##command(void **state) {                                       \
        (void)state;                                                                               \
        try_all(failing_names[number], FAILING_OWN);                                               \
    }                                                                                              \
    static void all_allocations_of_##command(void **state) {                                       \
        (void)state;                                                                               \
        try_all(failing_names[number], FAILING_ANY);                                               \
    }

STUDY(check, 0)
STUDY(inspect, 1)
STUDY(run, 2)
STUDY(resume, 3)
STUDY(report, 4)

int main(int count, char **words) {
    if (count > 1) { /* of these tests alone: a name, or a part of one and a star */
        cmocka_set_test_filter(words[1]);
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(own_allocations_of_check),   cmocka_unit_test(own_allocations_of_inspect),
        cmocka_unit_test(own_allocations_of_run),     cmocka_unit_test(own_allocations_of_resume),
        cmocka_unit_test(own_allocations_of_report),  cmocka_unit_test(all_allocations_of_check),
        cmocka_unit_test(all_allocations_of_inspect), cmocka_unit_test(all_allocations_of_run),
        cmocka_unit_test(all_allocations_of_resume),  cmocka_unit_test(all_allocations_of_report),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
