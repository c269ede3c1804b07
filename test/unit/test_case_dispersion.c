/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The keys of contact.dispersion, what is refused, and the far field that a case makes of them. */
#include "scratch.h"

#include "haft/io.h"

static const char MODEL[] = HAFT_SOURCE_DIR "/cases/delrio-rh85/case.yaml";
static scratch folder;

static int make_folder(void **state) {
    (void)state;
    folder = scratch_create();
    return 0;
}

static int remove_folder(void **state) {
    (void)state;
    scratch_remove(&folder);
    return 0;
}

/* The model with other lines in place of the section of menisci, whose line is 18. */
static haft_status read_dry(haft_case **c, const char *lines, haft_error *error) {
    char path[400], *model = read_whole_file(MODEL, NULL);
    char *start = strstr(model, "  capillary:"), *end = strstr(model, "  distance:");
    size_t room = strlen(model) + strlen(lines) + 2;
    char *text = calloc(room, 1);
    assert_non_null(text);
    snprintf(text, room, "%.*s%s\n%s", (int)(start - model), model, lines, end);
    write_file(scratch_path(&folder, "case.yaml", path), text, strlen(text));
    free(text);
    free(model);
    return haft_case_read(c, path, error);
}

static haft_case *must_read(const char *lines) {
    haft_case *c = NULL;
    haft_error error = {0};
    check_ok(read_dry(&c, lines, &error), error);
    return c;
}

static void keys_have_defaults(void **state) {
    (void)state;
    haft_case *c = must_read("  vdw: {}\n  dispersion: {}");
    haft_dispersion law;
    haft_error error = {0};
    assert_true(c->contact.has_dispersion);
    check_ok(haft_case_dispersion(&law, c, &error), error);
    check_relative(law.substrate, 18.65e-20, 1e-14);
    check_relative(law.cut_off, 1e-9, 1e-14);
    check_relative(law.retardation, 100e-9, 1e-14);
    assert_true(law.oxide_thickness[0] == 0 && law.film_thickness[1] == 0);
    check_relative(c->contact.far->out, 500e-9, 1e-14);
    check_less(c->contact.far->pressure_error, 1e-4);
    haft_case_destroy(&c);
    c = must_read("  vdw: {}");
    assert_true(!c->contact.has_dispersion && c->contact.far == NULL);
    haft_case_destroy(&c);
}

static double pull_at(const haft_case *c, double d) {
    double pressure;
    haft_far_field_evaluate(c->contact.far, 1, &d, &(haft_far_field_values){.pressure = &pressure});
    return pressure;
}

static void the_far_field_is_of_the_surface(void **state) {
    (void)state;
    haft_case *c = must_read("  dispersion: {hamaker: 2e-19 J, retardation: 0 nm, reach: 300 nm}");
    haft_dispersion law;
    haft_error error = {0};
    check_ok(haft_case_dispersion(&law, c, &error), error);
    double rms = sqrt(haft_case_moments(c).m0), most = pull_at(c, c->contact.far->first);
    for (double d = 4e-9; d < 250e-9; d *= 1.3) {
        check_near(pull_at(c, d), haft_dispersion_gaussian(&law, rms, d).pressure, 2e-5 * most);
    }
    haft_case_destroy(&c);
    c = must_read("  dispersion: {hamaker: 2e-19 J, cut_off: 0.5 nm, oxide: {thickness: 2 nm, "
                  "hamaker: 6.5e-20 J}}");
    check_ok(haft_case_dispersion(&law, c, &error), error);
    assert_true(law.oxide_thickness[0] == 2e-9 && law.oxide_thickness[1] == 2e-9);
    check_relative(law.cut_off, 0.5e-9, 1e-14);
    haft_case_destroy(&c);
}

/* Water fills what is nearer than the capillary range, and takes nothing off the contact's. */
static void menisci_move_the_cut_off(void **state) {
    (void)state;
    haft_case *c = must_read("  vdw: {}\n  dispersion: {}\n  capillary: {humidity: 50 %}");
    haft_dispersion law;
    haft_capillary water;
    haft_vdw vdw, plain;
    haft_error error = {0};
    check_ok(haft_case_dispersion(&law, c, &error), error);
    check_ok(haft_capillary_from_spec(&water, &c->contact.capillary, &error), error);
    check_relative(law.cut_off, water.range, 1e-14);
    check_less(1e-9, law.cut_off);
    haft_vdw_spec spec = {c->contact.vdw.hamaker_humid, c->contact.vdw.r0};
    check_ok(haft_vdw_from_spec(&plain, &spec, &error), error);
    check_ok(haft_case_vdw(&vdw, c, &error), error);
    assert_true(vdw.energy == plain.energy && vdw.stress == plain.stress);
    haft_case_destroy(&c);
}

static void dry_contact_leaves_the_tail(void **state) {
    (void)state;
    haft_case *c = must_read("  vdw: {}\n  dispersion: {}");
    haft_dispersion law;
    haft_vdw vdw, plain;
    haft_error error = {0};
    haft_vdw_spec spec = {c->contact.vdw.hamaker_dry, c->contact.vdw.r0};
    check_ok(haft_vdw_from_spec(&plain, &spec, &error), error);
    check_ok(haft_case_vdw(&vdw, c, &error), error);
    check_ok(haft_case_dispersion(&law, c, &error), error);
    check_relative(vdw.energy - haft_dispersion_at(&law, 1e-9).energy, plain.energy, 1e-14);
    assert_true(vdw.range == plain.range);
    check_relative(vdw.stress * vdw.range, vdw.energy, 1e-14);
    haft_case_destroy(&c);
}

static void the_digest_follows(void **state) {
    (void)state;
    static const char *const lines[] = {
        "  vdw: {}",
        "  vdw: {}\n  dispersion: {}",
        "  vdw: {}\n  dispersion: {cut_off: 2 nm}",
        "  vdw: {}\n  dispersion: {hamaker: 2e-19 J}",
        "  vdw: {}\n  dispersion: {retardation: 90 nm}",
        "  vdw: {}\n  dispersion: {reach: 400 nm}",
        "  vdw: {}\n  dispersion: {oxide: {thickness: 1 nm, hamaker: 6e-20 J}}"};
    enum { N = sizeof lines / sizeof *lines };
    char digest[N][HAFT_DIGEST_CAPACITY];
    haft_error error = {0};
    for (size_t i = 0; i < N; i++) {
        haft_case *c = must_read(lines[i]);
        check_ok(haft_case_laws_digest(c, digest[i], &error), error);
        for (size_t k = 0; k < i; k++) {
            assert_string_not_equal(digest[i], digest[k]);
        }
        char path[400], *text = NULL;
        haft_case *again = NULL;
        check_ok(haft_case_emit(&text, c, &error), error);
        assert_true((strstr(text, "dispersion:") != NULL) == (i > 0));
        write_file(scratch_path(&folder, "again.yaml", path), text, strlen(text));
        check_ok(haft_case_read(&again, path, &error), error);
        if (i > 0) {
            assert_memory_equal(again->contact.far, c->contact.far, sizeof *c->contact.far);
        }
        haft_memory_free(text);
        haft_case_destroy(&again);
        haft_case_destroy(&c);
    }
}

static void bad_keys_are_told_with_their_line(void **state) {
    (void)state;
    static const struct {
        const char *lines, *told;
    } bad[] = {
        {"  dispersion: {}", ":18:3: contact.dispersion.hamaker: is missing"},
        {"  vdw: {}\n  dispersion: {cut_off: 0.16 nm}",
         ":19:25: contact.dispersion.cut_off: 0.16 nm is no distance of faces"},
        {"  vdw: {}\n  dispersion: {cut_off: 0.166 nm}",
         ":19:25: contact.dispersion.cut_off: dispersion beyond 0.166 nm has"},
        {"  vdw: {}\n  dispersion: {cut_off: 0.2 um}",
         ":19:25: contact.dispersion.cut_off: 200 nm"},
        {"  vdw: {}\n  dispersion: {cut_off: -1 nm}", ":19:25: contact.dispersion.cut_off: "},
        {"  vdw: {}\n  dispersion: {oxide: {thickness: 1 um, hamaker: 6e-20 J}}",
         ":19:35: contact.dispersion.oxide.thickness: 1 um is thicker than a native oxide"},
        {"  vdw: {}\n  dispersion: {oxide: {thickness: 1 nm}}",
         ":19:16: contact.dispersion.oxide.hamaker: is missing"},
        {"  vdw: {}\n  dispersion: {reach: 2 um}", ":19:23: contact.dispersion.reach: 2 um is not"},
        {"  vdw: {}\n  dispersion: {reach: 20 nm}",
         ":19:23: contact.dispersion.reach: 20 nm is not"},
        {"  vdw: {}\n  dispersion: {retardation: -1 nm}",
         ":19:29: contact.dispersion.retardation: "},
        {"  vdw: {}\n  dispersion: {hamaker: 0 J}", ":19:25: contact.dispersion.hamaker: "},
        {"  vdw: {}\n  dispersion: {cutoff: 1 nm}", "did you mean cut_off?"},
        {"  vdw: {}\n  dispersion: 1 nm", "contact.dispersion: is no mapping"},
        {"  vdw: {}\n  dispersion: {}\n  capillary: {humidity: 99.5 %}",
         "contact.dispersion.hamaker: menisci fill all gaps up to"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        haft_case *c = NULL;
        haft_error error = {0};
        assert_int_equal(read_dry(&c, bad[i].lines, &error), HAFT_ERROR_INPUT);
        assert_null(c);
        if (strstr(error.message, bad[i].told) == NULL) {
            fail_msg("\"%s\" was told as\n%s", bad[i].told, error.message);
        }
    }
}

/* A marginal that is normal, by quantiles and bins, has the far field of normal heights. */
static void marginals_are_counted(void **state) {
    (void)state;
    char path[400], *model = read_whole_file(MODEL, NULL);
    haft_case *c[2] = {NULL, NULL};
    haft_error error = {0};
    char *dry = replaced(model, "contact:\n", "contact:\n  dispersion: {hamaker: 2e-19 J}\n");
    char *shaped = replaced(dry, "grid_step:",
                            "marginal: johnson\n  skewness: 0\n  kurtosis: 3\n"
                            "  grid_step:");
    const char *const texts[] = {dry, shaped};
    for (int i = 0; i < 2; i++) {
        write_file(scratch_path(&folder, "case.yaml", path), texts[i], strlen(texts[i]));
        check_ok(haft_case_read(&c[i], path, &error), error);
    }
    assert_non_null(c[1]->surface.distribution);
    double most = pull_at(c[0], 3e-9);
    for (double d = 4e-9; d < 400e-9; d *= 1.2) {
        check_near(pull_at(c[1], d), pull_at(c[0], d), 3e-3 * pull_at(c[0], d) + 1e-4 * most);
    }
    haft_case_destroy(&c[0]);
    haft_case_destroy(&c[1]);
    free(shaped);
    free(dry);
    free(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keys_have_defaults),
        cmocka_unit_test(the_far_field_is_of_the_surface),
        cmocka_unit_test(menisci_move_the_cut_off),
        cmocka_unit_test(dry_contact_leaves_the_tail),
        cmocka_unit_test(the_digest_follows),
        cmocka_unit_test(bad_keys_are_told_with_their_line),
        cmocka_unit_test(marginals_are_counted),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
