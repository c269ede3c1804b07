/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reading a case, its resolved text and the digest of what its laws depend on. */
#include "scratch.h"

#include "haft/io.h"

static const char MODEL[] = HAFT_SOURCE_DIR "/cases/delrio-rh85/case.yaml";

static haft_case *read_case(const char *path) {
    haft_error error = {0};
    haft_case *c = NULL;
    check_ok(haft_case_read(&c, path, &error), error);
    return c;
}

static haft_case *read_text(const scratch *s, const char *text) {
    char path[400];
    write_file(scratch_path(s, "case.yaml", path), text, strlen(text));
    return read_case(path);
}

static void model_case_is_read_in_si_units(void **state) {
    (void)state;
    haft_case *c = read_case(MODEL);
    assert_string_equal(c->name, "delrio-rh85");
    assert_string_equal(c->title, "DelRio cantilevers, RH 85 %, explicit force laws");
    assert_int_equal(c->seed, 85);
    check_relative(c->surface.psd.zeta_max, 289e6, 1e-14);
    check_relative(c->surface.psd.zeta_0, 19.4e6, 1e-14);
    check_relative(c->surface.psd.s_0, 6.46e-33, 1e-14);
    check_relative(c->surface.psd.s_1, 6.46e-39, 1e-14);
    check_relative(c->surface.grid_step, 5e-9, 1e-14);
    check_near(c->surface.kernel_tolerance, 1e-5, 0);
    assert_int_equal(c->contact.asperities, HAFT_ASPERITY_ISLANDS);
    check_relative(c->contact.young_modulus, 163e9, 1e-14);
    check_near(c->contact.poisson_ratio, 0.22, 0);
    assert_true(c->contact.has_capillary);
    check_relative(c->contact.capillary.humidity, 0.85, 1e-14);
    check_near(c->contact.capillary.temperature, 300, 0);
    check_relative(c->contact.capillary.surface_energy, 0.072, 1e-14);
    check_relative(c->contact.capillary.molar_volume, 18e-6, 1e-14);
    check_near(c->contact.capillary.contact_angle_1, 0, 0);
    check_near(c->contact.capillary.contact_angle_2, 0, 0);
    check_relative(c->contact.distance_from, 6e-9, 1e-14);
    check_relative(c->contact.distance_to, 28e-9, 1e-14);
    check_relative(c->contact.distance_step, 0.1e-9, 1e-14);
    assert_int_equal(c->law.kind, HAFT_LAW_MORSE);
    check_relative(c->law.f_limit, 5e6, 1e-14);
    assert_int_equal(c->law.unfit, HAFT_UNFIT_TABLE);
    assert_int_equal(c->law.sampler, HAFT_SAMPLER_EXPLICIT);
    check_relative(c->beam.length, 600e-6, 1e-14);
    check_relative(c->beam.width, 30e-6, 1e-14);
    check_relative(c->beam.thickness, 2.62e-6, 1e-14);
    check_relative(c->beam.gap, 1.9e-6, 1e-14);
    check_relative(c->beam.young_modulus, 163e9, 1e-14);
    assert_int_equal(c->mesh.kind, HAFT_MESH_ACTIVE);
    check_relative(c->mesh.l_meso, 3e-6, 1e-14);
    check_relative(c->mesh.active_from, 60e-6, 1e-14);
    check_relative(c->mesh.load_position, 60e-6, 1e-14);
    check_relative(c->programme.crack_length, 120e-6, 1e-14);
    check_relative(c->programme.crack_threshold, 0.01, 1e-14);
    assert_true(isinf(c->programme.load_limit));
    check_near(c->path.gap_step, 0.5, 0);
    check_near(c->path.ledger_tolerance, 1e-10, 0);
    check_near(c->path.residual_tolerance, 1e-11, 0);
    check_near(c->path.flow_step, 0.1, 0);
    assert_int_equal(c->path.step_limit, 200000);
    assert_int_equal(c->realizations, 20);
    assert_false(c->evidence.all);
    assert_int_equal(c->evidence.count, 1);
    assert_int_equal(c->evidence.realization[0], 0);
    check_relative(c->reference.paper_crack_length, 219e-6, 1e-14);
    check_relative(c->reference.measured_crack_length, 200e-6, 1e-14);
    haft_case_destroy(&c);
    assert_null(c);
    haft_case_destroy(&c);
}

/* Every byte but the pointer must be the same. */
static void check_same(haft_case *a, haft_case *b) {
    assert_int_equal(a->evidence.count, b->evidence.count);
    for (size_t i = 0; i < a->evidence.count; i++) {
        assert_int_equal(a->evidence.realization[i], b->evidence.realization[i]);
    }
    size_t *kept = b->evidence.realization;
    b->evidence.realization = a->evidence.realization;
    assert_memory_equal(a, b, sizeof *a);
    b->evidence.realization = kept;
}

static void check_round_trip(const scratch *s, haft_case *c) {
    haft_error error = {0};
    char *text = NULL, *again = NULL;
    check_ok(haft_case_emit(&text, c, &error), error);
    haft_case *back = read_text(s, text);
    check_same(c, back);
    check_ok(haft_case_emit(&again, back, &error), error);
    assert_string_equal(text, again);
    haft_memory_free(text);
    haft_memory_free(again);
    haft_case_destroy(&back);
}

static void resolved_case_reads_back_to_the_same_bits(void **state) {
    (void)state;
    scratch s = scratch_create();
    char *model = read_whole_file(MODEL, NULL);
    static const char *const edits[][2] = {
        {"name:", "name:"},
        {"evidence: [0] ", "evidence: all "},
        {"evidence: [0] ", "evidence: [19, 3, 0] "},
        {"evidence: [0] ", "evidence: [] "},
        {"title: DelRio", "title: \"a \\\"b\\\" \\\\ # B\xc3\xbc"
                          "chi: \" # "},
        {"title:", "# title:"},
        {"contact_angles: [0 deg, 0 deg]", "contact_angles: [1 rad, 33.3 degree]"},
        {"load:\n", "path: {gap_step: 0.1, step_limit: 9}\nload:\n"},
        {"crack_length: 120 um", "limit: 3 mN\n  crack_length: 120 um"},
        {"mesh: active", "mesh: exact"},
        {"mesh: active", "mesh: uniform\n  element_length: 15 um"},
        {"temperature: 300 K", "temperature: 20 degC"},
        {"seed: 85", "seed: 18446744073709551615"},
        {"reference:", "reference: {} #"},
    };
    for (size_t i = 0; i < sizeof edits / sizeof *edits; i++) {
        char *text = replaced(model, edits[i][0], edits[i][1]);
        if (strstr(text, "reference: {}") != NULL) {
            *strchr(strstr(text, "reference: {}"), '\n') = '\0'; /* the last section */
        }
        haft_case *c = read_text(&s, text);
        check_round_trip(&s, c);
        haft_case_destroy(&c);
        free(text);
    }
    free(model);
    scratch_remove(&s);
}

static void dry_and_exact_cases_need_less(void **state) {
    (void)state;
    scratch s = scratch_create();
    char *model = read_whole_file(MODEL, NULL);
    char *start = strstr(model, "  capillary:"), *end = strstr(model, "  distance:");
    memmove(start, end, strlen(end) + 1);
    char *text = replaced(model, "mesh: active", "mesh: exact");
    haft_case *c = read_text(&s, text);
    assert_false(c->contact.has_capillary);
    assert_int_equal(c->mesh.kind, HAFT_MESH_EXACT);
    check_near(c->mesh.element_length, 0, 0);
    check_round_trip(&s, c);
    haft_case_destroy(&c);
    free(text);
    free(model);
    scratch_remove(&s);
}

static void digest_of(const haft_case *c, char digest[HAFT_DIGEST_CAPACITY]) {
    haft_error error = {0};
    check_ok(haft_case_laws_digest(c, digest, &error), error);
}

static void check_digest_moves(const haft_case *c, const char *before, bool moves,
                               const char *what) {
    char after[HAFT_DIGEST_CAPACITY];
    digest_of(c, after);
    if ((strcmp(before, after) != 0) != moves) {
        fail_msg("the digest of the laws' inputs %s with %s", moves ? "stays" : "changes", what);
    }
}

/* clang-format off */
#define REALS_THAT_MATTER(X) \
    X(surface.psd.zeta_max) X(surface.psd.zeta_0) X(surface.psd.s_0) X(surface.psd.s_1) \
    X(surface.grid_step) X(surface.kernel_tolerance) X(contact.young_modulus) \
    X(contact.poisson_ratio) X(contact.capillary.humidity) X(contact.capillary.temperature) \
    X(contact.capillary.surface_energy) X(contact.capillary.molar_volume) \
    X(contact.capillary.contact_angle_1) X(contact.capillary.contact_angle_2) \
    X(contact.distance_from) X(contact.distance_to) X(contact.distance_step) X(law.f_limit) \
    X(beam.width) X(mesh.l_meso)
#define REALS_THAT_DO_NOT(X) \
    X(beam.length) X(beam.thickness) X(beam.gap) X(beam.young_modulus) X(mesh.element_length) \
    X(mesh.load_position) X(programme.crack_length) X(programme.crack_threshold) \
    X(programme.load_limit) X(path.gap_step) X(path.ledger_tolerance) \
    X(path.residual_tolerance) X(path.flow_step) X(reference.paper_crack_length) \
    X(reference.measured_crack_length) X(reference.zero_distance[0]) \
    X(reference.contact_area[0]) X(reference.wet_area[1]) X(reference.asperities[1])
/* clang-format on */

static void digest_follows_the_laws_inputs_alone(void **state) {
    (void)state;
    haft_case *c = read_case(MODEL);
    char before[HAFT_DIGEST_CAPACITY];
    digest_of(c, before);
    /* One unit in the last place is a change. */
#define MATTERS(field)                                                                             \
    {                                                                                              \
        double kept = c->field;                                                                    \
        c->field = nextafter(kept, 1e300);                                                         \
        check_digest_moves(c, before, true, #field);                                               \
        c->field = kept;                                                                           \
    }
#define DOES_NOT(field)                                                                            \
    {                                                                                              \
        double kept = c->field;                                                                    \
        c->field = 0.5 * kept + 1e-3;                                                              \
        check_digest_moves(c, before, false, #field);                                              \
        c->field = kept;                                                                           \
    }
    REALS_THAT_MATTER(MATTERS)
    REALS_THAT_DO_NOT(DOES_NOT)
    haft_case kept = *c;
    c->seed++;
    check_digest_moves(c, before, true, "seed");
    *c = kept;
    c->contact.asperities = HAFT_ASPERITY_SUMMITS;
    check_digest_moves(c, before, true, "asperities");
    *c = kept;
    c->contact.has_capillary = false;
    check_digest_moves(c, before, true, "capillary");
    *c = kept;
    c->law.sampler = HAFT_SAMPLER_PATCHES;
    check_digest_moves(c, before, true, "sampler");
    *c = kept;
    c->law.kind = HAFT_LAW_TABLE;
    c->law.unfit = HAFT_UNFIT_STOP;
    c->mesh.kind = HAFT_MESH_EXACT;
    c->path.step_limit++;
    c->evidence.all = true;
    c->curves = HAFT_CURVES_NEEDED;
    c->realizations++;
    memcpy(c->name, "other", 6);
    memcpy(c->title, "other", 6);
    check_digest_moves(c, before, false,
                       "kind, unfit, mesh, step_limit, evidence, curves, realizations, "
                       "name, title");
    *c = kept;
    check_digest_moves(c, before, false, "nothing");
    haft_case_destroy(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(model_case_is_read_in_si_units),
        cmocka_unit_test(resolved_case_reads_back_to_the_same_bits),
        cmocka_unit_test(dry_and_exact_cases_need_less),
        cmocka_unit_test(digest_follows_the_laws_inputs_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
