/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the programs say of the time left, by a clock that the test sets. */
#include "check.h"

static double clock_says;

static double read_clock(void) {
    return clock_says;
}

#define haft_clock_seconds read_clock
#include "../../tools/terminal.c"
#undef haft_clock_seconds

/* Says that `done` of 10 are done at a time; what it printed is to be freed. */
static char *say(terminal *t, double time, size_t done) {
    char *text = NULL;
    size_t size = 0;
    FILE *kept = stderr;
    clock_says = time;
    stderr = open_memstream(&text, &size);
    assert_non_null(stderr);
    haft_progress p = terminal_progress(t);
    p.advance(p.user, "beams", done, 10);
    fclose(stderr);
    stderr = kept;
    return text;
}

static void a_clock_that_steps_gives_no_negative_time(void **state) {
    (void)state;
    terminal t = {.program = "test"};
    static const struct {
        double time;
        size_t done;
        const char *says;
    } steps[] = {{1000, 0, ""},
                 {1010, 1, "beams       1 of 10,  10 %, 1:30 min left\n"},
                 {20, 2, "beams       2 of 10,  20 %, 0:00 min left\n"}, /* set back */
                 {1040, 4, "beams       4 of 10,  40 %, 1:00 min left\n"}};
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        char *text = say(&t, steps[i].time, steps[i].done);
        assert_string_equal(text, steps[i].says);
        free(text);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_clock_that_steps_gives_no_negative_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
