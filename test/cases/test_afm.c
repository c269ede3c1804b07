/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From a map to laws: the shipped map is the one that the generator makes, with the statistics that
 * its case tells; cases with maps resolve, are refused and digested as they should be; and the
 * map's own windows against generated twins, by Kolmogorov and Smirnov. HAFT_WRITE_MAP=FILE writes
 * the map anew. */
#include "map_files.h"
#include "program.h"

#include "haft/study.h"

#include <gsl/gsl_sort.h>

static const char *const MAP = HAFT_SOURCE_DIR "/cases/afm-demo/surface.gsf";

enum { SIDE = 256 };
static const double STEP = 10e-9;
static const haft_psd PSD = {250e6, 19.4e6, 6.46e-33, 1.4e-38};
static const double SKEWNESS = 0.4, KURTOSIS = 3.4;

/* Surfaces of known PSD and marginal. */
typedef struct maker {
    size_t side; /* pixels */
    haft_marginal *marginal;
    haft_surface_plan *plan;
    haft_surface_work *work;
} maker;

static maker open_maker(size_t side) {
    maker m = {.side = side};
    haft_error error = {0};
    check_ok(haft_marginal_johnson(&m.marginal, SKEWNESS, KURTOSIS, &error), error);
    haft_surface_spec spec = {.psd = PSD,
                              .marginal = m.marginal,
                              .grid_step = STEP,
                              .rows = side,
                              .columns = side,
                              .key = {2017, HAFT_RANDOM_TEST}};
    check_ok(haft_surface_plan_create(&m.plan, &spec, &error), error);
    check_ok(haft_surface_work_create(&m.work, m.plan, &error), error);
    return m;
}

static void close_maker(maker *m) {
    haft_surface_work_destroy(&m->work);
    haft_surface_plan_destroy(&m->plan);
    haft_marginal_destroy(&m->marginal);
}

/* One of them, on a tilted sample. */
static haft_map *make_map(const maker *m, uint64_t stream) {
    haft_error error = {0};
    haft_map *map = NULL;
    check_ok(haft_map_create(&map, m->side, m->side, STEP, STEP, &error), error);
    check_ok(haft_surface_prepare(m->work, 0, stream, 0, &error), error);
    check_ok(haft_surface_rows(m->work, 0, m->side, map->z, &error), error);
    for (size_t i = 0; i < m->side * m->side; i++) {
        map->z[i] += 0.002 * STEP * (double)(i % m->side) - 0.001 * STEP * (double)(i / m->side);
    }
    snprintf(map->channel, sizeof map->channel, "Height");
    return map;
}

static void the_shipped_map_is_the_generators(void **state) {
    (void)state;
    haft_error error = {0};
    maker m = open_maker(SIDE);
    haft_map *made = make_map(&m, 0), *read = NULL;
    if (getenv("HAFT_WRITE_MAP") != NULL) {
        check_ok(haft_map_write(made, getenv("HAFT_WRITE_MAP"), &error), error);
    }
    check_ok(haft_map_read(&read, MAP, NULL, NULL, &error), error);
    assert_int_equal(read->rows, SIDE);
    check_relative(read->step_row, STEP, 1e-14);
    for (size_t i = 0; i < SIDE * SIDE; i++) {
        check_near(read->z[i], made->z[i], 1e-7 * fabs(made->z[i]) + 1e-20);
    }
    /* its statistics: of one small map, so near those of the process, within their scatter */
    haft_map_statistics s;
    check_ok(haft_map_level(read, HAFT_LEVEL_PLANE, &error), error);
    check_ok(haft_map_get_statistics(&s, read, &error), error);
    check_near(s.rms * 1e9, 3.5, 0.35);
    check_near(s.skewness, SKEWNESS, 0.25);
    check_near(s.kurtosis, KURTOSIS, 0.6);
    haft_map_destroy(&made);
    haft_map_destroy(&read);
    close_maker(&m);
}

/* The fit of that map finds what it was made with, not the rings beyond its cut-off; and a case
 * that uses the fit holds the rms of both. */
static void the_fit_of_the_shipped_map(void **state) {
    (void)state;
    haft_error error = {0};
    haft_case *c = NULL;
    scratch s = scratch_create();
    char path[400], maps[400];
    char *text = read_whole_file(HAFT_SOURCE_DIR "/cases/afm-demo/case.yaml", NULL);
    snprintf(maps, sizeof maps, "maps: ['%s']\n  use: fit", MAP);
    char *with = replaced(text, "maps: [surface.gsf]", maps);
    write_file(scratch_path(&s, "case.yaml", path), with, strlen(with));
    check_ok(haft_case_read(&c, path, &error), error);
    assert_true(c->surface.fitted && c->surface.table == NULL);
    const haft_psd_fit *fit = &c->surface.fit;
    const double truth[3] = {PSD.s_0, PSD.zeta_0,
                             0.5 * log(PSD.s_0 / PSD.s_1) / log(PSD.zeta_max / PSD.zeta_0) - 1};
    for (int k = 0; k < 3; k++) {
        assert_true(fit->determined[k]);
        assert_true(fit->low[k] <= truth[k] && truth[k] <= fit->high[k]);
    }
    check_relative(fit->cut_off, PSD.zeta_max, 0.02);
    check_less(0.01, fit->p_value);
    check_near(c->surface.map_rms * 1e9, 3.53, 0.01);
    assert_true(fit->rms[1] <= c->surface.map_rms && c->surface.map_rms <= fit->rms[2]);
    check_relative(sqrt(haft_case_moments(c).m0), fit->rms[0], 1e-12);
    haft_case_destroy(&c);
    ran r = run_expect(0, HAFT, ARGS("check", s.folder));
    check_says(r.out, "the maps have 3.53 nm");
    check_silent_about(r.out, "warning");
    ran_free(&r);
    free(with);
    free(text);
    scratch_remove(&s);
}

/* ---- cases ---- */

/* A small case whose surface section is the one given. */
static haft_status read_case_with(haft_case **c, const scratch *s, const char *surface,
                                  haft_error *error) {
    char path[400], *text = read_whole_file(HAFT_SOURCE_DIR "/cases/delrio-rh85/case.yaml", NULL);
    char *from = strstr(text, "surface:\n"), *to = strstr(text, "contact:\n");
    assert_true(from != NULL && to != NULL);
    char *whole = malloc(strlen(text) + strlen(surface) + 1);
    assert_non_null(whole);
    sprintf(whole, "%.*s%s\n%s", (int)(from - text), text, surface, to);
    char *patched = replaced(whole, "sampler: explicit", "sampler: patches");
    write_file(scratch_path(s, "case.yaml", path), patched, strlen(patched));
    free(patched);
    free(whole);
    free(text);
    return haft_case_read(c, path, error);
}

static void refuse(const scratch *s, const char *surface, const char *expected) {
    haft_case *c = NULL;
    haft_error error = {0};
    assert_int_equal(read_case_with(&c, s, surface, &error), HAFT_ERROR_INPUT);
    if (strstr(error.message, expected) == NULL) {
        fail_msg("\"%s\" does not say \"%s\"", error.message, expected);
    }
}

static void copy_map(const scratch *s, const char *name, const haft_map *map) {
    char path[400];
    haft_error error = {0};
    check_ok(haft_map_write(map, scratch_path(s, name, path), &error), error);
}

static void cases_resolve_and_are_digested(void **state) {
    (void)state;
    scratch s = scratch_create();
    haft_error error = {0};
    maker m = open_maker(SIDE);
    haft_map *map = make_map(&m, 0), *other = make_map(&m, 1);
    copy_map(&s, "a.gsf", map);
    copy_map(&s, "b.gsf", map);
    copy_map(&s, "c.gsf", other);
    static const char *const surfaces[] = {
        "surface: {maps: a.gsf, grid_step: 10 nm, tip_radius: 5 nm, marginal: heights}",
        "surface: {maps: [b.gsf], grid_step: 10 nm, tip_radius: 5 nm, marginal: "
        "heights}", /* the
                       same
                       contents
                     */
        "surface: {maps: c.gsf, grid_step: 10 nm, tip_radius: 5 nm, marginal: heights}",
        "surface: {maps: a.gsf, opposite_maps: c.gsf, coherence: -0.5, level: "
        "quadratic, "
        "grid_step: 10 nm}",
        "surface: {maps: a.gsf, grid_step: 10 nm, use: fit, marginal: johnson}",
        "surface: {maps: [a.gsf, c.gsf], grid_step: 10 nm, source: maps}"};
    char digest[6][HAFT_DIGEST_CAPACITY];
    for (size_t k = 0; k < 6; k++) {
        haft_case *c = NULL, *again = NULL;
        char path[400], *text = NULL, second[HAFT_DIGEST_CAPACITY];
        check_ok(read_case_with(&c, &s, surfaces[k], &error), error);
        check_ok(haft_case_laws_digest(c, digest[k], &error), error);
        /* the resolved case, from anywhere, is the same case */
        check_ok(haft_case_write(c, scratch_path(&s, "resolved.yaml", path), &error), error);
        check_ok(haft_case_read(&again, path, &error), error);
        check_ok(haft_case_laws_digest(again, second, &error), error);
        assert_string_equal(digest[k], second);
        check_relative(haft_case_moments(again).m0, haft_case_moments(c).m0, 1e-15);
        assert_true((again->surface.table == NULL) == (k == 4));
        assert_memory_equal(&again->surface.psd, &c->surface.psd, sizeof c->surface.psd);
        check_ok(haft_case_emit(&text, again, &error), error);
        assert_non_null(strstr(text, "a.gsf") != NULL ? strstr(text, "a.gsf")
                                                      : strstr(text, ".gsf"));
        haft_memory_free(text);
        haft_case_destroy(&c);
        haft_case_destroy(&again);
    }
    assert_string_equal(digest[0], digest[1]);
    assert_string_not_equal(digest[0], digest[2]);
    refuse(&s, "surface: {maps: none.gsf, grid_step: 10 nm}", "there is no file");
    refuse(&s, "surface: {maps: a.gsf, s_0: 1 nm^4, grid_step: 10 nm}", "beside surface.maps");
    refuse(&s, "surface: {maps: a.gsf, psd: a.gsf, grid_step: 10 nm}", "leave one out");
    refuse(&s, "surface: {psd: a.gsf, grid_step: 10 nm}", "holds a NUL character");
    refuse(&s, "surface: {maps: a.gsf, grid_step: 20 nm}", "too coarse");
    refuse(&s,
           "surface: {maps: a.gsf, channel: Phase, marginal: johnson, skewness: 2, kurtosis: 3, "
           "grid_step: 10 nm}",
           "no distribution has a skewness");
    refuse(&s, "surface: {grid_step: 10 nm}", "surface.zeta_max: is missing");
    refuse(
        &s,
        "surface: {zeta_max: 289 rad/um, zeta_0: 19.4 rad/um, s_0: 6.46e3 nm^4, s_1: 6.46e-3 nm^4, "
        "grid_step: 5 nm, marginal: heights}",
        "needs surface.maps");
    haft_map_destroy(&map);
    haft_map_destroy(&other);
    close_maker(&m);
    scratch_remove(&s);
}

/* `haft-laws inspect` writes the table that a case takes. */
static void a_psd_by_points(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400];
    haft_error error = {0};
    haft_case *c = NULL;
    const char *text = "zeta [rad/um],s [nm^4],relative error\n19.4,6.46e3,0.1\n289,6.46e-3,0.1\n";
    write_file(scratch_path(&s, "psd.csv", path), text, strlen(text));
    check_ok(read_case_with(&c, &s, "surface: {psd: psd.csv, grid_step: 5 nm}", &error), error);
    haft_psd delrio = {289e6, 19.4e6, 6.46e-33, 6.46e-39};
    check_relative(haft_case_moments(c).m0, haft_psd_get_moments(&delrio).m0, 1e-12);
    haft_case_destroy(&c);
    text = "zeta [rad/um],s [nm^4]\n19.4,6.46e3\n289,nan\n";
    write_file(scratch_path(&s, "psd.csv", path), text, strlen(text));
    refuse(&s, "surface: {psd: psd.csv, grid_step: 5 nm}", "psd.csv:3: has no finite number");
    scratch_remove(&s);
}

/* ---- map against twins ---- */

static double ks_distance(double *a, size_t n, double *b, size_t m) {
    gsl_sort(a, 1, n);
    gsl_sort(b, 1, m);
    size_t i = 0, j = 0;
    double most = 0;
    while (i < n && j < m) {
        double x = fmin(a[i], b[j]);
        while (i < n && a[i] <= x) {
            i++;
        }
        while (j < m && b[j] <= x) {
            j++;
        }
        most = fmax(most, fabs((double)i / (double)n - (double)j / (double)m));
    }
    return most;
}

enum { MAPS = 16, MAP_SIDE = 512, PATCHES = 240 };

/* Laws of square patches. */
static haft_laws *build(const scratch *s, const char *surface) {
    const double side = 1.2e-6;
    haft_error error = {0};
    haft_case *c = NULL;
    haft_laws *laws = NULL;
    check_ok(read_case_with(&c, s, surface, &error), error);
    c->realizations = 1;
    c->mesh.kind = HAFT_MESH_EXACT;
    c->mesh.l_meso = c->beam.width = side;
    c->beam.length = PATCHES * side;
    c->contact.distance_from = 2e-9;
    check_ok(haft_study_build_laws(&laws, c, NULL, &error), error);
    assert_int_equal(laws->m, PATCHES);
    haft_case_destroy(&c);
    return laws;
}

/* Of e, f_max or the zero-force distance, of those patches that have it. */
static size_t gather(double value[PATCHES], const haft_laws *l, int which) {
    size_t n = 0;
    for (size_t i = 0; i < l->m; i++) {
        value[n] = which == 0   ? l->vector[i].e
                   : which == 1 ? l->vector[i].f_max
                                : l->zero_distance[i];
        n += !isnan(value[n]);
    }
    return n;
}

/* Maps of one process: laws of their windows, of patches generated from their PSD and heights, and
 * of Gaussian ones of the same PSD. A patch of 1.2 um is one window, without seams, and the maps
 * hold 16 such windows each that share no pixel, so that 240 patches are about as many independent
 * ones. Differences of 0.15 are told apart at 1 %: the twins' laws are nearer to the windows' than
 * that, the Gaussian ones' are far off. */
static void twins_have_the_maps_laws(void **state) {
    (void)state;
    scratch s = scratch_create();
    char names[800] = "", surface[1000];
    maker m = open_maker(MAP_SIDE);
    for (uint64_t k = 0; k < MAPS; k++) {
        char name[16];
        snprintf(name, sizeof name, "%02d.gsf", (int)k);
        haft_map *map = make_map(&m, k);
        copy_map(&s, name, map);
        haft_map_destroy(&map);
        snprintf(names + strlen(names), sizeof names - strlen(names), "%s%s", k > 0 ? ", " : "",
                 name);
    }
    close_maker(&m);
    static const char *const kinds[] = {"source: maps", "marginal: heights", "marginal: gaussian"};
    static const char *const numbers[] = {"e", "f_max", "zero-force distance"};
    haft_laws *laws[3];
    for (int k = 0; k < 3; k++) {
        snprintf(surface, sizeof surface,
                 "surface: {maps: [%s], grid_step: 5 nm, kernel_tolerance: 1e-3, %s}", names,
                 kinds[k]);
        laws[k] = build(&s, surface);
    }
    for (int k = 1; k < 3; k++) {
        for (int q = 0; q < 3; q++) {
            double windows[PATCHES], twins[PATCHES];
            size_t n = gather(windows, laws[0], q), l = gather(twins, laws[k], q);
            assert_true(n > PATCHES / 2 && l > PATCHES / 2);
            double d = ks_distance(windows, n, twins, l);
            double critical = 1.63 * sqrt(1.0 / (double)n + 1.0 / (double)l); /* 1 % */
            print_message("%s, %s: KS distance %.3f, critical at 1 %% %.3f\n", kinds[k], numbers[q],
                          d, critical);
            if (k == 1) {
                check_less(d, critical);
            } else {
                check_less(2 * critical, d);
            }
        }
    }
    for (int k = 0; k < 3; k++) {
        haft_laws_destroy(&laws[k]);
    }
    scratch_remove(&s);
}

static void films_lengthen_the_range(void **state) {
    (void)state;
    haft_adsorption silica = haft_adsorption_silica();
    haft_error error = {0};
    check_ok(haft_adsorption_check(&silica, &error), error);
    check_near(haft_adsorption_thickness(&silica, 0.15), 1.5 * 0.282e-9, 1e-22);
    check_near(haft_adsorption_thickness(&silica, 0.45), 3.5 * 0.282e-9, 1e-22);
    check_near(haft_adsorption_thickness(&silica, 0.825), 5.5 * 0.282e-9, 1e-22);
    check_near(haft_adsorption_thickness(&silica, 0.999), 6.5 * 0.282e-9, 1e-22);
    const double rh[] = {0.2, 0.1}, t[] = {1e-9, 2e-9};
    haft_adsorption bad = {2, rh, t};
    assert_int_equal(haft_adsorption_check(&bad, &error), HAFT_ERROR_INPUT);

    scratch s = scratch_create();
    char path[400], *text = read_whole_file(HAFT_SOURCE_DIR "/cases/delrio-rh85/case.yaml", NULL);
    const char *film = "thickness [nm],humidity [%]\n0.5,40\n1.5,90\n";
    write_file(scratch_path(&s, "film.csv", path), film, strlen(film));
    static const char *const lines[] = {
        "humidity: 85 %", "humidity: 85 %\n    adsorbed: silica",
        "humidity: 85 %\n    adsorbed: table\n    adsorbed_table: film.csv"};
    const double thickness[] = {0, (4.5 + 2 * 10 / 15.) * 0.282e-9, 1.4e-9};
    double dry = 0;
    char digest[3][HAFT_DIGEST_CAPACITY];
    for (int k = 0; k < 3; k++) {
        char *with = replaced(text, lines[0], lines[k]);
        haft_case *c = NULL;
        haft_contact_spec contact;
        write_file(scratch_path(&s, "case.yaml", path), with, strlen(with));
        check_ok(haft_case_read(&c, path, &error), error);
        check_ok(haft_study_contact_spec(&contact, c, &error), error);
        check_ok(haft_case_laws_digest(c, digest[k], &error), error);
        dry = k == 0 ? contact.capillary_range : dry;
        check_near(contact.capillary_range, dry + 2 * thickness[k], 1e-15);
        haft_case_destroy(&c);
        free(with);
    }
    assert_string_not_equal(digest[0], digest[1]);
    assert_string_not_equal(digest[1], digest[2]);
    char *with = replaced(text, lines[0], "humidity: 85 %\n    adsorbed: table");
    haft_case *c = NULL;
    write_file(path, with, strlen(with));
    assert_int_equal(haft_case_read(&c, path, &error), HAFT_ERROR_INPUT);
    assert_non_null(strstr(error.message, "needs adsorbed_table"));
    free(with);
    free(text);
    scratch_remove(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_shipped_map_is_the_generators),
        cmocka_unit_test(the_fit_of_the_shipped_map),
        cmocka_unit_test(cases_resolve_and_are_digested),
        cmocka_unit_test(a_psd_by_points),
        cmocka_unit_test(films_lengthen_the_range),
        cmocka_unit_test(twins_have_the_maps_laws),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
