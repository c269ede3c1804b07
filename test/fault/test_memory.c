/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Allocations that fail, some in each command: of Haft's own and of the libraries beneath it. All
 * of them are tried by study_allocations.c. */
#include "failing.h"

enum { OWN_TRIES = 5, ANY_TRIES = 2 };

static size_t try_some(const char *name, failing_mode mode, unsigned long tries) {
    failing f;
    failing_create(&f, name, mode);
    failing_begin(&f);
    size_t faults = 0;
    unsigned long count = mode == FAILING_OWN ? f.own : f.all;
    for (unsigned long i = 0; i < tries; i++) { /* the first, and evenly from there on */
        failing_try(&f, 1 + i * count / tries, &faults);
    }
    failing_end(&f);
    return faults;
}

static void own_allocations_may_fail(void **state) {
    (void)state;
    size_t faults = 0;
    for (int i = 0; i < FAILING_COMMANDS; i++) {
        faults += try_some(failing_names[i], FAILING_OWN, OWN_TRIES);
    }
    assert_int_equal(faults, 0);
}

static void allocations_of_libraries_may_fail(void **state) {
    (void)state;
    size_t faults = 0;
    for (int i = 0; i < FAILING_COMMANDS; i++) {
        faults += try_some(failing_names[i], FAILING_ANY, ANY_TRIES);
    }
    assert_int_equal(faults, 0);
}

static void memory_may_end(void **state) {
    (void)state;
    size_t faults = 0;
    for (int i = 0; i < FAILING_COMMANDS; i++) {
        faults += try_some(failing_names[i], FAILING_REST, ANY_TRIES);
    }
    assert_int_equal(faults, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(own_allocations_may_fail),
        cmocka_unit_test(allocations_of_libraries_may_fail),
        cmocka_unit_test(memory_may_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
