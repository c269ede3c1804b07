/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The whole chain in dry air, where van der Waals forces hold thin beams by a handful of asperities
 * a patch: certificates, ledger and independence of the step, for both surfaces and both laws. */
#include "scratch.h"

#include "haft/study.h"

static const char *const surfaces[] = {
    "{zeta_max: 289 rad/um, zeta_0: 19.4 rad/um, s_0: 6.46e3 nm^4, s_1: 6.46e-3 nm^4,",
    "{zeta_max: 283 rad/um, zeta_0: 40 rad/um, s_0: 0.5e3 nm^4, s_1: 50e-3 nm^4,"};

static haft_case *read_case(int surface, const char *asperities, const char *law) {
    char text[4000], path[400];
    haft_case *c = NULL;
    haft_error error = {0};
    scratch s = scratch_create();
    int size = snprintf(text, sizeof text,
                        "name: dry\nseed: 5\nsurface: %s grid_step: 10 nm}\n"
                        "contact: {asperities: %s, young_modulus: 163 GPa, poisson_ratio: 0.22,\n"
                        "  vdw: {}, distance: {from: 4 nm, to: 24 nm, step: 0.05 nm}}\n"
                        "law: {%s, sampler: patches}\n"
                        "beam: {length: 210 um, width: 6 um, thickness: 0.3 um, gap: 0.5 um,\n"
                        "  young_modulus: 163 GPa, l_meso: 3 um, mesh: exact}\n"
                        "load: {position: 30 um, crack_length: 110 um}\nstudy: {realizations: 1}\n",
                        surfaces[surface], asperities, law);
    write_file(scratch_path(&s, "case.yaml", path), text, (size_t)size);
    check_ok(haft_case_read(&c, path, &error), error);
    scratch_remove(&s);
    return c;
}

static haft_path *follow(const haft_model *model, const haft_site_laws *laws, const haft_case *c,
                         double gap_step) {
    haft_path_options options = c->path;
    haft_path *path = NULL;
    haft_error error = {0};
    options.gap_step = gap_step;
    check_ok(haft_solve_path(&path, model, laws->law, &c->programme, &options, &error), error);
    assert_int_equal(path->outcome, HAFT_OUTCOME_STUCK);
    check_less(path->ledger_error, 1e-10);
    for (size_t i = 0; i < path->points; i++) {
        assert_true(path->point[i].lambda_min > 0 && path->point[i].least_pivot > 0);
    }
    for (size_t j = 0; j < path->jumps; j++) {
        assert_true(path->jump[j].dissipated > 0);
    }
    return path;
}

/* Forces and limit come back from the resolved case and from laws.h5. */
static void check_files(const haft_case *c, const haft_laws *laws) {
    char path[400];
    haft_error error = {0};
    haft_case *again = NULL;
    haft_laws *back = NULL;
    scratch s = scratch_create();
    check_ok(haft_case_write(c, scratch_path(&s, "case.yaml", path), &error), error);
    check_ok(haft_case_read(&again, path, &error), error);
    assert_memory_equal(&again->contact.vdw, &c->contact.vdw, sizeof c->contact.vdw);
    assert_true(again->contact.has_vdw && !again->contact.has_capillary);
    assert_true(haft_case_limit(again) == haft_case_limit(c));
    check_ok(haft_laws_write(laws, c, scratch_path(&s, "laws.h5", path), &error), error);
    check_ok(haft_laws_read(&back, NULL, path, &error), error);
    assert_true(back->f_limit == laws->f_limit && laws->f_limit == haft_case_limit(c));
    haft_laws_destroy(&back);
    haft_case_destroy(&again);
    scratch_remove(&s);
}

static void check_chain(int surface, const char *asperities, const char *law) {
    haft_case *c = read_case(surface, asperities, law);
    haft_physics physics = haft_case_physics(c);
    assert_true(physics.vdw && !physics.capillary && !physics.humid);
    haft_error error = {0};
    haft_laws *laws = NULL;
    haft_site_laws *sites = NULL;
    haft_model *model = NULL;
    check_ok(haft_study_build_laws(&laws, c, NULL, &error), error);
    for (size_t k = 0; k < laws->m; k++) { /* each patch pulls, and less than a megapascal */
        double pull = 0;
        for (size_t i = 0; i < laws->n; i++) {
            pull = fmax(pull, -laws->force[k * laws->n + i]);
        }
        assert_true(pull > 0 && pull < 1e6);
    }
    check_files(c, laws);
    check_ok(haft_study_site_laws(&sites, c, laws, 0, &error), error);
    check_ok(haft_model_create_beam(&model, &c->beam, &c->mesh, &error), error);
    haft_path *path = follow(model, sites, c, 0.25), *fine = follow(model, sites, c, 0.1);
    assert_true(path->jumps > 0);
    assert_int_equal(path->jumps, fine->jumps);
    for (size_t j = 0; j < path->jumps; j++) {
        assert_int_equal(path->jump[j].site, fine->jump[j].site);
        check_relative(path->jump[j].load, fine->jump[j].load, 1e-8);
    }
    for (size_t i = 0; i < haft_model_get(model)->dofs; i++) {
        check_near(path->final_state[i], fine->final_state[i], 1e-7);
    }
    print_message("  surface %d, %s, %s: %zu unfit, %zu jumps, crack %.1f um\n", surface,
                  asperities, law, sites->unfit, path->jumps,
                  path->point[path->points - 1].crack_length * 1e6);
    haft_path_destroy(&path);
    haft_path_destroy(&fine);
    haft_model_destroy(&model);
    haft_site_laws_destroy(&sites);
    haft_laws_destroy(&laws);
    haft_case_destroy(&c);
}

static void the_chain_holds_in_dry_air(void **state) {
    (void)state;
    for (int surface = 0; surface < 2; surface++) {
        check_chain(surface, "summits", "kind: table, f_limit: 1 MPa");
        check_chain(surface, "islands", "kind: morse, f_limit_share: 20 %");
    }
}

/* By the humidity: what acts, and that nothing else is computed. */
static void forces_follow_the_humidity(void **state) {
    (void)state;
    haft_case *c = read_case(0, "summits", "kind: table, f_limit: 1 MPa");
    c->contact.has_capillary = true;
    c->contact.capillary =
        (haft_capillary_spec){.temperature = 300, .surface_energy = 0.072, .molar_volume = 18e-6};
    c->contact.forces = HAFT_FORCES_AUTO;
    static const double humidity[] = {0, 0.3, 0.5499, 0.55, 0.95};
    for (int k = 0; k < 5; k++) {
        haft_contact_spec spec;
        haft_error error = {0};
        c->contact.capillary.humidity = humidity[k];
        check_ok(haft_study_contact_spec(&spec, c, &error), error);
        assert_true(spec.has_capillary == (k > 0) && spec.has_vdw == (k < 3));
        assert_true((spec.capillary_range > 0) == (k > 0) && (spec.vdw.range > 0) == (k < 3));
        if (k < 3) { /* dry or humid column of Tab. 1 */
            check_relative(spec.vdw.energy, k == 0 ? 167.1e-3 : 87.4e-3, 0.006);
        }
    }
    /* One of the two by itself: the other is not computed, and water lies between all the same. */
    static const haft_forces alone[] = {HAFT_FORCES_CAPILLARY, HAFT_FORCES_VDW};
    for (int k = 0; k < 2; k++) {
        haft_contact_spec spec;
        haft_error error = {0};
        c->contact.forces = alone[k];
        c->contact.capillary.humidity = 0.3;
        check_ok(haft_study_contact_spec(&spec, c, &error), error);
        assert_true(spec.has_capillary == (k == 0) && spec.has_vdw == (k == 1));
        if (k == 1) {
            check_relative(spec.vdw.energy, 87.4e-3, 0.006);
        }
    }
    haft_case_destroy(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_chain_holds_in_dry_air),
                                       cmocka_unit_test(forces_follow_the_humidity)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
