/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A case's PSD by rms, correlation length and Hurst exponent: it is the same case as by the
 * parameters that they give; what is missing, twice there or impossible is told at its place. */
#include "program.h"

#include "haft/io.h"

static scratch folder;

/* The case with this surface section, from line 6 of the file on. */
static haft_status read_with(haft_case **c, const char *surface, haft_error *error) {
    char path[400], *text = read_whole_file(HAFT_SOURCE_DIR "/cases/delrio-rh85/case.yaml", NULL);
    char *rest = strstr(text, "contact:\n");
    assert_non_null(rest);
    char *whole = calloc(1, strlen(rest) + strlen(surface) + 100);
    assert_non_null(whole);
    sprintf(whole, "name: rough\nseed: 1\nsurface:\n%s  grid_step: 5 nm\n%s", surface, rest);
    write_file(scratch_path(&folder, "case.yaml", path), whole, strlen(whole));
    free(whole);
    free(text);
    return haft_case_read(c, path, error);
}

static void refuse(const char *surface, const char *says) {
    haft_case *c = NULL;
    haft_error error = {0};
    assert_int_equal(read_with(&c, surface, &error), HAFT_ERROR_INPUT);
    if (strstr(error.message, says) == NULL) {
        fail_msg("\"%s\" does not say \"%s\"", error.message, says);
    }
    assert_null(strchr(error.message, '\n')); /* one message for one fault */
}

static void both_forms_are_one_case(void **state) {
    (void)state;
    haft_error error = {0};
    haft_case *a = NULL, *b = NULL, *again = NULL;
    char path[400], *text = NULL, surface[400], digest[3][HAFT_DIGEST_CAPACITY];
    check_ok(read_with(&b,
                       "  zeta_max: 289 rad/um\n  rms: 5 nm\n  correlation_length: 200 nm\n"
                       "  hurst: 0.8\n",
                       &error),
             error);
    check_relative(sqrt(haft_case_moments(b).m0), 5e-9, 1e-12);
    check_relative(haft_case_correlation_length(b), 200e-9, 1e-10);
    check_relative(haft_psd_get_hurst(&b->surface.psd), 0.8, 1e-12);
    const haft_psd *p = &b->surface.psd;
    snprintf(surface, sizeof surface,
             "  zeta_max: %.17g rad/m\n  zeta_0: %.17g rad/m\n  s_0: %.17g m^4\n  s_1: %.17g m^4\n",
             p->zeta_max, p->zeta_0, p->s_0, p->s_1);
    check_ok(read_with(&a, surface, &error), error);
    check_ok(haft_case_write(b, scratch_path(&folder, "resolved.yaml", path), &error), error);
    check_ok(haft_case_read(&again, path, &error), error);
    assert_memory_equal(&a->surface.psd, p, sizeof *p);
    assert_memory_equal(&again->surface.psd, p, sizeof *p);
    const haft_case *const cases[] = {a, b, again};
    for (int k = 0; k < 3; k++) {
        check_ok(haft_case_laws_digest(cases[k], digest[k], &error), error);
        assert_string_equal(digest[k], digest[0]);
    }
    check_ok(haft_case_emit(&text, b, &error), error);
    assert_null(strstr(text, "hurst"));
    haft_memory_free(text);
    haft_case_destroy(&a);
    haft_case_destroy(&b);
    haft_case_destroy(&again);
}

static void a_hurst_exponent_can_be_swept(void **state) {
    (void)state;
    haft_error error = {0};
    haft_case *c = NULL;
    char path[400];
    assert_int_equal(read_with(&c, "  zeta_max: 289 rad/um\n  rms: 5 nm\n", &error),
                     HAFT_ERROR_INPUT);
    char *text = read_whole_file(scratch_path(&folder, "case.yaml", path), NULL);
    char *swept = calloc(1, strlen(text) + 200);
    assert_non_null(swept);
    sprintf(swept,
            "%ssweep:\n  surface.correlation_length: [100 nm, 200 nm]\n"
            "  surface.hurst: [0.5, 1]\n",
            text);
    write_file(path, swept, strlen(swept));
    for (size_t k = 0; k < 2; k++) {
        check_ok(haft_case_read_variant(&c, path, k, &error), error);
        check_relative(haft_psd_get_hurst(&c->surface.psd), 0.5 + 0.5 * (double)k, 1e-12);
        check_relative(haft_case_correlation_length(c), 100e-9 * (double)(k + 1), 1e-10);
        haft_case_destroy(&c);
    }
    free(swept);
    free(text);
}

static void what_is_wrong_is_told_at_its_place(void **state) {
    (void)state;
    static const char all[] = "  zeta_max: 289 rad/um\n  rms: 5 nm\n  correlation_length: 200 nm\n";
    char surface[300];
    refuse("  rms: 5 nm\n  correlation_length: 200 nm\n  hurst: 0.8\n",
           "case.yaml:3:1: surface.zeta_max: is missing; add \"zeta_max: 289 rad/um\"");
    refuse(all, "case.yaml:3:1: surface.hurst: is missing; add \"hurst: 0.8\"");
    snprintf(surface, sizeof surface, "%s  hurst: 1.2\n", all);
    refuse(surface, "case.yaml:7:10: surface.hurst: \"1.2\" is out of range; give a value above 0 "
                    "and at most 1, such as 0.8");
    snprintf(surface, sizeof surface, "%s  hurst: 0\n", all);
    refuse(surface, "surface.hurst: \"0\" is out of range");
    snprintf(surface, sizeof surface, "%s  hurst: 0.8\n  zeta_0: 19 rad/um\n", all);
    refuse(surface, "case.yaml:5:8: surface.rms: is given beside surface.zeta_0");
    char path[400];
    static const char points[] = "zeta [rad/um],s [nm^4]\n19,6e3\n289,6e-3\n";
    write_file(scratch_path(&folder, "psd.csv", path), points, strlen(points));
    refuse("  rms: 5 nm\n  psd: psd.csv\n",
           "surface.rms: is given beside surface.psd, which has it; leave one out");
    static const char short_one[] = "  zeta_max: 289 rad/um\n  rms: 5 nm\n  hurst: 0.8\n"
                                    "  correlation_length: 5 nm\n";
    refuse(short_one, "case.yaml:7:23: surface.correlation_length: a correlation length of 5 nm is "
                      "shorter than waves up to zeta_max = 289 rad/um can have; give ");
    refuse("  zeta_max: 289 rad/um\n  rms: 5 nm\n  hurst: 1\n  correlation_length: 3 m\n",
           "um at most, or a smaller zeta_max");
    scratch_remove(&folder);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(both_forms_are_one_case),
        cmocka_unit_test(a_hurst_exponent_can_be_swept),
        cmocka_unit_test(what_is_wrong_is_told_at_its_place),
    };
    folder = scratch_create();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
