/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A case with a sweep: each variant reads as the case that holds its values, and each mistake is
 * told at its place. */
#include "scratch.h"

#include "haft/io.h"

static const char MODEL[] = HAFT_SOURCE_DIR "/cases/delrio-rh85/case.yaml";

/* The model case with one stretch of its text replaced and more text at its end. */
static char *edit(const char *from, const char *to, const char *more) {
    size_t size = 0;
    char *text = read_whole_file(MODEL, &size);
    char *edited = replaced(text, from, to);
    char *out = calloc(1, strlen(edited) + strlen(more) + 1);
    strcat(strcpy(out, edited), more);
    free(edited);
    free(text);
    return out;
}

static haft_status read_edited(const scratch *s, char *text, size_t variant, haft_case **c,
                               haft_error *error) {
    char path[400];
    write_file(scratch_path(s, "case.yaml", path), text, strlen(text));
    free(text);
    return haft_case_read_variant(c, path, variant, error);
}

static void a_variant_is_the_case_with_its_values(void **state) {
    (void)state;
    scratch s = scratch_create();
    static const char *const l_meso[] = {"6 um", "3 um", "2 um"}, *const mesh[] = {"exact", "exact",
                                                                                   "active"};
    for (size_t i = 0; i < 3; i++) {
        haft_error error = {0};
        haft_case *swept = NULL, *plain = NULL;
        char *text = edit("  l_meso: 3 um\n  mesh: active  ", "  # ",
                          "sweep:\n  beam.l_meso: [6 um, 3 um, 2 um]\n"
                          "  beam.mesh: [exact, exact, active]\n");
        check_ok(read_edited(&s, text, i, &swept, &error), error);
        char keys[100];
        snprintf(keys, sizeof keys, "  l_meso: %s\n  mesh: %s\n  # ", l_meso[i], mesh[i]);
        text = edit("  l_meso: 3 um\n  mesh: active  ", keys, "");
        check_ok(read_edited(&s, text, 0, &plain, &error), error);
        assert_int_equal(swept->sweep.variants, 3);
        assert_int_equal(swept->sweep.variant, i);
        assert_int_equal(swept->sweep.keys, 2);
        assert_int_equal(plain->sweep.variants, 1);
        assert_int_equal(plain->sweep.keys, 0);
        assert_string_equal(swept->sweep.key[0], "beam.l_meso");
        assert_string_equal(swept->sweep.unit[0], "m");
        check_near(swept->sweep.value[0], swept->mesh.l_meso, 0);
        check_near(swept->sweep.value[1], (double)swept->mesh.kind, 0);
        char *a = NULL, *b = NULL;
        check_ok(haft_case_emit(&a, swept, &error), error);
        check_ok(haft_case_emit(&b, plain, &error), error);
        assert_string_equal(a, b);
        haft_memory_free(a);
        haft_memory_free(b);
        haft_case_destroy(&swept);
        haft_case_destroy(&plain);
    }
    scratch_remove(&s);
}

static void a_label_is_fit_for_a_folder(void **state) {
    (void)state;
    scratch s = scratch_create();
    haft_error error = {0};
    haft_case *c = NULL;
    char *text =
        edit("    humidity: 85 %\n", "",
             "sweep: {contact.capillary.humidity: [85 %, 9e-1], path.gap_step: [0.1, 0.2], "
             "load.limit: [1 N, 2 N]}\n");
    check_ok(read_edited(&s, text, 1, &c, &error), error);
    assert_string_equal(c->sweep.label, "01_humidity-9e-1_gap_step-0.2_limit-2N");
    check_relative(c->contact.capillary.humidity, 0.9, 1e-14);
    haft_case_destroy(&c);
    scratch_remove(&s);
}

/* Numbers of others beside ours make no other variant. */
static void references_do_not_label(void **state) {
    (void)state;
    scratch s = scratch_create();
    haft_error error = {0};
    haft_case *c = NULL;
    char *text =
        edit("  paper_crack_length: 219 um\n", "",
             "sweep: {reference.paper_crack_length: [219 um, 300 um], load.limit: [1 N, 2 N]}\n");
    check_ok(read_edited(&s, text, 1, &c, &error), error);
    assert_string_equal(c->sweep.label, "01_limit-2N");
    check_relative(c->reference.paper_crack_length, 300e-6, 1e-14);
    haft_case_destroy(&c);
    scratch_remove(&s);
}

static void mistakes_are_told_at_their_place(void **state) {
    (void)state;
    static const struct {
        const char *sweep, *says[3];
        size_t variant;
    } mistakes[] = {
        {"sweep: {beam.l_mesoo: [3 um]}\n", {"59:9: sweep: ", "did you mean beam.l_meso?"}, 0},
        {"sweep: {length: [3 um]}\n", {"sweep: ", "did you mean beam.length?"}, 0},
        {"sweep: {colour: [red]}\n", {"the whole path", "beam.l_meso: [3 um, 6 um]"}, 0},
        {"sweep: {name: [a, b]}\n", {"cannot vary \"name\""}, 0},
        {"sweep: {beam.l_meso: [3 um]}\n", {"beam.l_meso: is given twice, first at line 38"}, 0},
        {"sweep: {beam.width: 3 um}\n", {"is given twice"}, 0},
        {"sweep: {load.limit: 3 N}\n", {"load.limit: is no list", "load.limit: [...]"}, 0},
        {"sweep: {load.limit: []}\n", {"has 0 values; give 1 to 1000"}, 0},
        {"sweep: {load.limit: [[1 N]]}\n", {"holds more than a value"}, 0},
        {"sweep: {load.limit: [1 N, 2 m]}\n", {"59:27: load.limit: ", "wrong dimension"}, 1},
        {"sweep: {load.limit: [1 N, 2 N], path.gap_step: [0.1]}\n",
         {"path.gap_step: has 1 values where load.limit has 2"},
         0},
        {"sweep:\n", {"sweep: varies nothing"}, 0},
        {"sweep: {}\n", {"sweep: varies nothing"}, 0},
        {"sweep: {load.limit: [1 N]}\nsweep: {path.gap_step: [0.1]}\n",
         {"sweep: is given twice, first at line 59"},
         0},
        {"sweep: {load.limit: [1 N]}\n", {"there is no variant 1 of 1"}, 1},
    };
    scratch s = scratch_create();
    for (size_t i = 0; i < sizeof mistakes / sizeof *mistakes; i++) {
        haft_error error = {0};
        haft_case *c = NULL;
        char *text = edit("name:", "name:", mistakes[i].sweep);
        if (read_edited(&s, text, mistakes[i].variant, &c, &error) == HAFT_OK) {
            fail_msg("%s was read", mistakes[i].sweep);
        }
        assert_null(c);
        for (int k = 0; k < 3 && mistakes[i].says[k] != NULL; k++) {
            if (strstr(error.message, mistakes[i].says[k]) == NULL) {
                fail_msg("%s gives \"%s\", without \"%s\"", mistakes[i].sweep, error.message,
                         mistakes[i].says[k]);
            }
        }
    }
    scratch_remove(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_variant_is_the_case_with_its_values),
        cmocka_unit_test(a_label_is_fit_for_a_folder),
        cmocka_unit_test(references_do_not_label),
        cmocka_unit_test(mistakes_are_told_at_their_place),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
