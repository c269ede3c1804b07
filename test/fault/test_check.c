/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What `run` refuses before its first beam, `check` refuses with the same message: it takes the
 * same steps. And it leaves nothing behind. */
#include "program.h"

#include <math.h>

/* The first line of what was printed, without the realization that a run names; to be freed. */
static char *first_line(const char *text) {
    static const char prefix[] = "haft: realization 0: ";
    size_t skipped = strncmp(text, prefix, sizeof prefix - 1) == 0 ? sizeof prefix - 1 : 6;
    return strndup(text + skipped, strcspn(text + skipped, "\n"));
}

static void both_refuse(const char *what, const edit *edits, const char *map, const char *says) {
    case_folder c = case_create(edits);
    char path[400];
    if (map != NULL) {
        write_file(path_in(&c, "map.txt", path), map, strlen(map));
    }
    ran check = run_program(HAFT, ARGS("check", c.path));
    if (access(path_in(&c, "out", path), F_OK) == 0) {
        fail_msg("%s: check leaves a folder out", what);
    }
    ran run = run_program(HAFT, ARGS("run", "--quiet", c.path));
    char *told[2] = {first_line(check.err), first_line(run.err)};
    if (check.code != run.code || check.code == 0 || strcmp(told[0], told[1]) != 0) {
        fail_msg("%s:\ncheck %d: %s\nrun   %d: %s", what, check.code, told[0], run.code, told[1]);
    }
    check_says(told[0], says);
    free(told[0]);
    free(told[1]);
    ran_free(&check);
    ran_free(&run);
    case_remove(&c);
}

/* 80 x 80 pixels of waves; of the k-th the height is missing. */
static char *make_map(size_t k) {
    enum { SIDE = 80 };
    char *text = calloc(SIDE * SIDE, 16);
    assert_non_null(text);
    size_t used = 0;
    for (size_t i = 0; i < (size_t)SIDE * SIDE; i++) {
        double x = (double)(i % SIDE), y = (double)(i / SIDE);
        double z = 3 * sin(0.4 * x + 0.1 * y) + 2 * sin(0.3 * y) + sin(0.9 * x - 0.7 * y);
        used += (size_t)sprintf(text + used, i == k ? "nan" : "%.4f", z);
        text[used++] = i % SIDE + 1 < SIDE ? ' ' : '\n';
    }
    return text;
}

#define PSD                                                                                        \
    "  zeta_max: 289 rad/um        # shortest wave\n"                                              \
    "  zeta_0: 19.4 rad/um         # roll-off\n"                                                   \
    "  s_0: 6.46e3 nm^4            # plateau\n"                                                    \
    "  s_1: 6.46e-3 nm^4           # at zeta_max\n"
#define MAPS "  maps: [map.txt]\n  map_size: [0.8 um, 0.8 um]\n  map_unit: 1 nm\n"

/* Windows of a map with a hole would be laid out with the hole in it. */
static void maps_with_holes_as_windows(void **state) {
    (void)state;
    char *map = make_map(1234);
    both_refuse("a map with a hole",
                (const edit[]){{PSD, MAPS "  source: maps\n"},
                               {"sampler: explicit", "sampler: patches"},
                               {NULL, NULL}},
                map, "missing");
    free(map);
}

/* A law by table needs the curve from contact to where it has ended. */
static void distances_that_end_too_soon(void **state) {
    (void)state;
    both_refuse(
        "distances that end before the pull does",
        (const edit[]){{"to: 28 nm", "to: 12 nm"}, {"kind: morse", "kind: table"}, {NULL, NULL}},
        NULL, "carry it on to a larger distance");
    both_refuse(
        "a Morse law of such a curve, which is not to become a table",
        (const edit[]){{"to: 28 nm", "to: 9 nm"}, {"unfit: table", "unfit: stop"}, {NULL, NULL}},
        NULL, "site 0");
}

static void a_kernel_that_no_grid_carries(void **state) {
    (void)state;
    both_refuse("a kernel tolerance out of reach",
                (const edit[]){{"kernel_tolerance: 1e-3", "kernel_tolerance: 1e-14"}, {NULL, NULL}},
                NULL, "tolerance");
}

/* Each variant of a sweep is tried. */
static void a_variant_that_cannot_run(void **state) {
    (void)state;
    case_folder c = case_create((const edit[]){
        {"\n  kernel_tolerance: 1e-3", ""},
        {"study:\n", "sweep:\n  surface.kernel_tolerance: [1e-3, 1e-14]\n\nstudy:\n"},
        {NULL, NULL}});
    ran r = run_program(HAFT, ARGS("check", c.path));
    assert_int_not_equal(r.code, 0);
    check_says(r.err, "variant 01");
    check_says(r.err, "tolerance");
    ran_free(&r);
    case_remove(&c);
}

static void what_runs_passes(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    char path[400];
    ran r = run_expect(0, HAFT, ARGS("check", c.path));
    check_says(r.out, "can be used");
    assert_true(access(path_in(&c, "out", path), F_OK) != 0);
    ran_free(&r);
    case_remove(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(maps_with_holes_as_windows),
        cmocka_unit_test(distances_that_end_too_soon),
        cmocka_unit_test(a_kernel_that_no_grid_carries),
        cmocka_unit_test(a_variant_that_cannot_run),
        cmocka_unit_test(what_runs_passes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
