/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Work in a child process: what it makes, what it complains of, and every way in which it can die.
 */
#include "check.h"
#include "io/child.h"

#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

enum { MANY = 3000000 };

static haft_status make_numbers(const void *context, void **bytes, size_t *size,
                                haft_error *error) {
    uint64_t *number = haft_memory_alloc(MANY, sizeof *number, error);
    assert_non_null(number);
    for (uint64_t i = 0; i < MANY; i++) {
        number[i] = i * *(const uint64_t *)context;
    }
    *bytes = number;
    *size = MANY * sizeof *number;
    return HAFT_OK;
}

static haft_status make_nothing(const void *context, void **bytes, size_t *size,
                                haft_error *error) {
    (void)context;
    (void)bytes;
    (void)error;
    *size = 0;
    return HAFT_OK;
}

static haft_status complain(const void *context, void **bytes, size_t *size, haft_error *error) {
    (void)bytes;
    *size = 7;
    return haft_error_set(error, HAFT_ERROR_NUMERIC, "no luck with %d", *(const int *)context);
}

static haft_status end_by_signal(const void *context, void **bytes, size_t *size,
                                 haft_error *error) {
    (void)bytes;
    (void)size;
    (void)error;
    raise(*(const int *)context);
    return HAFT_OK;
}

static haft_status leave(const void *context, void **bytes, size_t *size, haft_error *error) {
    (void)context;
    (void)bytes;
    (void)size;
    (void)error;
    _exit(0);
}

static haft_status claim_more(const void *context, void **bytes, size_t *size, haft_error *error) {
    (void)context;
    *bytes = haft_memory_alloc(16, 1, error);
    *size = (size_t)1 << 62; /* as an overwritten heap may make it say */
    return HAFT_OK;
}

/* The limits that the child runs under. */
static haft_status tell_limits(const void *context, void **bytes, size_t *size, haft_error *error) {
    (void)context;
    struct rlimit *limit = haft_memory_alloc(3, sizeof *limit, error);
    assert_int_equal(getrlimit(RLIMIT_AS, limit), 0);
    assert_int_equal(getrlimit(RLIMIT_CPU, limit + 1), 0);
    assert_int_equal(getrlimit(RLIMIT_CORE, limit + 2), 0);
    *bytes = limit;
    *size = 3 * sizeof *limit;
    return HAFT_OK;
}

static haft_status run(haft_child_work *work, const void *context, void **bytes, size_t *size,
                       haft_error *error) {
    haft_child_input input = {.path = "a.h5", .remedy = "export it", .context = context};
    *bytes = error; /* must be set whatever comes of it */
    *size = 1;
    return haft_child_run(bytes, size, work, &input, error);
}

static void bytes_come_back_whole(void **state) {
    (void)state;
    haft_error error = {0};
    void *bytes = NULL;
    size_t size = 0;
    uint64_t factor = 0x9e3779b97f4a7c15ULL;
    check_ok(run(make_numbers, &factor, &bytes, &size, &error), error);
    assert_int_equal(size, MANY * sizeof factor);
    for (uint64_t i = 0; i < MANY; i++) {
        assert_true(((const uint64_t *)bytes)[i] == i * factor);
    }
    haft_memory_free(bytes);
    check_ok(run(make_nothing, NULL, &bytes, &size, &error), error);
    assert_int_equal(size, 0);
    haft_memory_free(bytes);
}

static void failures_are_the_childs_own(void **state) {
    (void)state;
    haft_error error = {0};
    void *bytes = NULL;
    size_t size = 0;
    int number = 5;
    assert_int_equal(run(complain, &number, &bytes, &size, &error), HAFT_ERROR_NUMERIC);
    assert_string_equal(error.message, "no luck with 5");
    assert_int_equal(error.status, HAFT_ERROR_NUMERIC);
    assert_null(bytes);
    assert_int_equal(size, 0);
}

static void keep_quiet(int number) {
    (void)number;
}

static void deaths_are_told(void **state) {
    (void)state;
    static const struct {
        int signal;
        haft_status status;
        const char *says;
    } deaths[] = {
        {SIGSEGV, HAFT_ERROR_INPUT, "a.h5: is damaged: the process that read it crashed (signal"},
        {SIGABRT, HAFT_ERROR_INPUT, "crashed (signal 6); export it"},
        {SIGBUS, HAFT_ERROR_INPUT, "crashed"},
        {SIGFPE, HAFT_ERROR_INPUT, "crashed"},
        {SIGKILL, HAFT_ERROR_INPUT, "the system killed"},
        {SIGXCPU, HAFT_ERROR_INPUT, "reading it does not end"},
        {SIGINT, HAFT_ERROR_INTERRUPTED, "a.h5: reading it was interrupted"},
        {SIGTERM, HAFT_ERROR_INTERRUPTED, "interrupted"},
    };
    haft_error error = {0};
    void *bytes = NULL;
    size_t size = 0;
    signal(SIGTERM, keep_quiet); /* a parent that polls for it; its child must end by it */
    for (size_t i = 0; i < sizeof deaths / sizeof *deaths; i++) {
        assert_int_equal(run(end_by_signal, &deaths[i].signal, &bytes, &size, &error),
                         deaths[i].status);
        if (strstr(error.message, deaths[i].says) == NULL) {
            fail_msg("\"%s\" is not in: %s", deaths[i].says, error.message);
        }
        assert_null(bytes);
        assert_int_equal(size, 0);
    }
    signal(SIGTERM, SIG_DFL);
    assert_int_equal(run(leave, NULL, &bytes, &size, &error), HAFT_ERROR_INPUT);
    assert_int_equal(run(claim_more, NULL, &bytes, &size, &error), HAFT_ERROR_INPUT);
    assert_null(bytes);
}

static void children_are_limited(void **state) {
    (void)state;
    haft_error error = {0};
    void *bytes = NULL;
    size_t size = 0;
    check_ok(run(tell_limits, NULL, &bytes, &size, &error), error);
    const struct rlimit *limit = bytes;
    assert_true(limit[0].rlim_cur != RLIM_INFINITY);
    assert_in_range(limit[1].rlim_cur, 20, 30);
    assert_int_equal(limit[2].rlim_cur, 0);
    haft_memory_free(bytes);
}

/* A host that wants to hear nothing of its children gets what they made all the same. */
static void ignored_children_do_as_well(void **state) {
    (void)state;
    haft_error error = {0};
    void *bytes = NULL;
    size_t size = 0;
    uint64_t factor = 3;
    signal(SIGCHLD, SIG_IGN);
    check_ok(run(make_numbers, &factor, &bytes, &size, &error), error);
    haft_memory_free(bytes);
    assert_int_equal(run(leave, NULL, &bytes, &size, &error), HAFT_ERROR_INPUT);
    signal(SIGCHLD, SIG_DFL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bytes_come_back_whole),
        cmocka_unit_test(failures_are_the_childs_own),
        cmocka_unit_test(deaths_are_told),
        cmocka_unit_test(children_are_limited),
        cmocka_unit_test(ignored_children_do_as_well),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
