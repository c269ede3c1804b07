/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The figures of a run: all are drawn where gnuplot is, and what is missing is told. */
#include "program.h"

#include "haft/study.h"

#include <math.h>

static bool have_gnuplot(void) {
    return system("gnuplot --version > /dev/null 2>&1") == 0;
}

/* Each is a PNG picture with its end in place and something in it. */
static void check_pictures(const case_folder *c, bool many, bool one) {
    static const char *const names[] = {"surface", "psd",    "laws",     "shapes",
                                        "energy",  "cracks", "overview", "convergence"};
    assert_int_equal(exists(c, "out/plots/convergence.png"), many);
    assert_int_equal(exists(c, "out/plots/correlation.png"), !one);
    for (size_t i = 0; i < sizeof names / sizeof *names - !many; i++) {
        char name[100], path[400];
        size_t size = 0;
        snprintf(name, sizeof name, "out/plots/%s.png", names[i]);
        char *picture = read_whole_file(path_in(c, name, path), &size);
        assert_true(size > 4000);
        assert_memory_equal(picture, "\x89PNG\r\n\x1a\n", 8);
        assert_memory_equal(picture + size - 8, "IEND", 4);
        free(picture);
    }
}

static char *read_plot(const case_folder *c, const char *name) {
    char path[400], place[64];
    snprintf(place, sizeof place, "out/plots/%s", name);
    return read_whole_file(path_in(c, place, path), NULL);
}

/* The PSD asked for is the case's, and the piece's differs from it by the errors told: the mean of
 * the squares over some tens of rings is 1. */
static void check_psd(const case_folder *c) {
    haft_error failure = {0};
    haft_case *own = NULL;
    char path[400], *curve = read_plot(c, "psd.csv"), *rings = read_plot(c, "rings.csv");
    check_ok(haft_case_read(&own, path_in(c, "case.yaml", path), &failure), failure);
    const haft_psd *psd = &own->surface.psd;
    double square = 0, zeta = 0, asked = 0, measured, error;
    int n = 0, length = 0;
    for (char *at = strchr(curve, '\n') + 1; *at != '\0'; at += length, n++) {
        assert_int_equal(sscanf(at, "%lf,%lf\n%n", &zeta, &asked, &length), 2);
        assert_float_equal(asked, haft_psd_value(psd, zeta * 1e6) * 1e36, 1e-9 * asked);
    }
    assert_true(n == 200);
    assert_float_equal(zeta, psd->zeta_max * 1e-6, 1e-9 * zeta);
    n = 0;
    for (char *at = strchr(rings, '\n') + 1; *at != '\0'; at += length, n++) {
        assert_int_equal(
            sscanf(at, "%lf,%lf,%lf,%lf\n%n", &zeta, &measured, &error, &asked, &length), 4);
        assert_float_equal(asked, haft_psd_value(psd, zeta * 1e6) * 1e36, 1e-9 * asked);
        square += pow((measured / asked - 1) / error, 2);
    }
    assert_true(n > 20);
    print_message("%d rings, mean square of the deviations in errors %.2f\n", n, square / n);
    assert_true(square / n > 0.4 && square / n < 1.8);
    haft_case_destroy(&own);
    free(curve);
    free(rings);
}

static void a_run_is_drawn(void **state) {
    (void)state;
    if (!have_gnuplot()) {
        skip();
    }
    /* a title that would run or break a plot script if it were evaluated */
    case_folder c = case_create(
        (edit[]){{"title: DelRio cantilevers, RH 85 %, explicit force laws",
                  "title: \"It's 50 % \\\"{x_1}\\\" `touch hacked` $(touch hacked) @a ^b &c\""},
                 {NULL, NULL}});
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    ran r = run_expect(0, HAFT, ARGS("plot", c.path));
    check_says(r.out, "figures in ");
    check_says(r.out, "out/plots");
    assert_string_equal(r.err, "");
    ran_free(&r);
    check_pictures(&c, false, false);
    check_psd(&c);
    assert_false(exists(&c, "out/plots/hacked"));
    case_remove(&c);
}

/* Beams that let go, dry contact, tables: whatever a run brings forth can be drawn. */
static void odd_runs_are_drawn_too(void **state) {
    (void)state;
    if (!have_gnuplot()) {
        skip();
    }
    static const edit variants[][3] = {
        {{"realizations: 2", "realizations: 1"}, {"kind: morse", "kind: table"}},
        {{"grid_step: 10 nm", "grid_step: 2.5 nm"}},
        {{"realizations: 2", "realizations: 3"}, {"thickness: 1 um", "thickness: 10 um"}},
    };
    for (size_t i = 0; i < sizeof variants / sizeof *variants; i++) {
        case_folder c = case_create(variants[i]);
        must_run(HAFT, ARGS("run", "--quiet", c.path));
        ran r = run_expect(0, HAFT, ARGS("plot", c.path));
        assert_string_equal(r.err, "");
        ran_free(&r);
        check_pictures(&c, i == 2, i == 0);
        check_psd(&c);
        case_remove(&c);
    }
}

/* A strip too narrow for a spectrum has none, and no less a surface. */
static void a_narrow_strip_has_no_rings(void **state) {
    (void)state;
    haft_error error = {0};
    haft_case *own = NULL;
    char path[400];
    case_folder c = case_create((edit[]){{"width: 3 um", "width: 150 nm"}, {NULL, NULL}});
    check_ok(haft_case_read(&own, path_in(&c, "case.yaml", path), &error), error);
    check_ok(haft_study_write_surface(own, c.path, &error), error);
    char *rings = read_whole_file(path_in(&c, "rings.csv", path), NULL);
    check_says(rings, "\nnan,nan,nan,nan\n");
    assert_true(exists(&c, "surface.csv") && exists(&c, "psd.csv"));
    free(rings);
    haft_case_destroy(&own);
    case_remove(&c);
}

/* Without gnuplot on the path, which takes longer than all else: the data are written. */
static ran plot_undrawn(const case_folder *c, const char *options) {
    char command[800];
    snprintf(command, sizeof command, "PATH=/nowhere exec '%s' plot %s '%s'", HAFT, options,
             c->path);
    return run_expect(4, "/bin/sh", ARGS("-c", command));
}

static void what_is_missing_is_told(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    ran r = run_expect(4, HAFT, ARGS("plot", c.path));
    check_says(r.err, ".h5: cannot be opened: No such file");
    check_says(r.err, "haft");
    ran_free(&r);
    assert_false(exists(&c, "out"));
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    r = run_expect(3, HAFT, ARGS("plot", "--realization", "2", c.path));
    check_says(r.err, "there is no realization 2; the case has 0 to 1");
    ran_free(&r);
    /* no gnuplot on the path: the data are there all the same, and said to be */
    r = plot_undrawn(&c, "");
    check_says(r.err, "gnuplot cannot be run");
    check_says(r.err, "as CSV");
    ran_free(&r);
    assert_true(exists(&c, "out/plots/energy.csv"));
    case_remove(&c);
}

/* A realization without evidence is followed again: its shapes are those it would have left. */
static void any_realization_is_drawn(void **state) {
    (void)state;
    static const edit none[] = {{"evidence: [0]", "evidence: []"}, {0}},
                      both[] = {{"evidence: [0]", "evidence: all"}, {0}};
    char *shapes[2], path[400];
    for (int i = 0; i < 2; i++) {
        case_folder c = case_create(i == 0 ? none : both);
        must_run(HAFT, ARGS("run", "--quiet", c.path));
        ran r = plot_undrawn(&c, "--realization 1");
        ran_free(&r);
        shapes[i] = read_whole_file(path_in(&c, "out/plots/shapes.csv", path), NULL);
        case_remove(&c);
    }
    assert_string_equal(shapes[0], shapes[1]);
    free(shapes[0]);
    free(shapes[1]);
}

/* Two runs of the same beams but for their load: the second is held against the first. */
static void a_run_is_held_against_another(void **state) {
    (void)state;
    static const edit first[] = {
        {"realizations: 2", "realizations: 12"}, {"width: 3 um", "width: 1.5 um"}, {0}};
    static const edit other[] = {{"realizations: 2", "realizations: 12"},
                                 {"width: 3 um", "width: 1.5 um"},
                                 {"thickness: 1 um", "thickness: 1.1 um"},
                                 {0}};
    case_folder a = case_create(first), b = case_create(other);
    ran r = run_expect(4, HAFT, ARGS("info", "--against", a.path, b.path));
    check_says(r.err, "results.h5");
    ran_free(&r);
    must_run(HAFT, ARGS("run", "--quiet", a.path));
    must_run(HAFT, ARGS("run", "--quiet", b.path));
    r = run_expect(0, HAFT, ARGS("info", "--against", a.path, b.path));
    check_says(r.out, "beams that stuck");
    check_says(r.out, "Wasserstein-1 distance");
    ran_free(&r);
    r = run_expect(0, HAFT, ARGS("info", "--json", "--against", a.path, b.path));
    check_says(r.out, "\"reference_stuck\": 12,\n  \"stuck\": 12,");
    double shift = strtod(strstr(r.out, "mean_shift_m\": ") + 15, NULL);
    assert_true(shift > 0 && shift < 20e-6); /* a stiffer beam sticks less far in */
    ran_free(&r);
    r = run_expect(0, HAFT, ARGS("info", "--json", "--against", a.path, a.path));
    check_says(r.out, "\"mean_shift_m\": 0,");
    check_says(r.out, "\"wasserstein_m\": 0,");
    ran_free(&r);
    if (have_gnuplot()) {
        r = run_expect(0, HAFT, ARGS("plot", "--against", a.path, b.path));
        assert_string_equal(r.err, "");
        assert_true(exists(&b, "out/plots/against.png"));
        assert_true(exists(&b, "out/plots/against.svg"));
        ran_free(&r);
    }
    r = run_expect(2, HAFT, ARGS("run", "--against", a.path, b.path));
    check_says(r.err, "--against belongs to info and plot, not to run");
    ran_free(&r);
    case_write(&b, (edit[]){{"realizations: 2", "realizations: 1"}, {0}});
    must_run(HAFT, ARGS("run", "--quiet", "--force", b.path));
    r = run_expect(3, HAFT, ARGS("info", "--against", a.path, b.path));
    check_says(r.err,
               "needs two beams that stuck on either side; there are 1, and 12 of the refer");
    ran_free(&r);
    r = run_expect(4, HAFT, ARGS("info", "--against", "/nowhere", b.path));
    check_says(r.err, "/nowhere");
    ran_free(&r);
    case_remove(&a);
    case_remove(&b);
}

/* A gnuplot before the real one in the path: a shell script. */
static void write_gnuplot(const case_folder *c, const char *script) {
    char path[400];
    snprintf(path, sizeof path, "%s/gnuplot", c->top.folder);
    write_file(path, script, strlen(script));
    assert_int_equal(chmod(path, 0755), 0);
}

static ran run_with_gnuplot(const case_folder *c, const char *command) {
    char text[1600];
    snprintf(text, sizeof text, "cd '%s' && PATH='%s':\"$PATH\" exec %s", c->top.folder,
             c->top.folder, command);
    return run_expect(4, "/bin/sh", ARGS("-c", text));
}

/* A disk that is full for gnuplot alone: its writes fail and it says nothing. What was drawn before
 * stays, and nothing else is left. */
static void figures_that_are_cut_are_told(void **state) {
    (void)state;
    if (!have_gnuplot()) {
        skip();
    }
    static const char *const scripts[] = {
        "#!/bin/sh\nPATH=${PATH#*:}\ntrap '' XFSZ\nulimit -f 8\nexec gnuplot \"$@\"\n",
        "#!/bin/sh\nexit 0\n"};
    static const char map_text[] = "# Width: 2 um\n# Height: 2 um\n# Value units: nm\n"
                                   "1 2 5\n3 4 1\n1 5 2\n";
    char command[800], path[400];
    case_folder c = case_create(NULL);
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    must_run(HAFT, ARGS("plot", "--quiet", c.path));
    char *names = listing(&c);
    size_t size = 0;
    char *figure = read_whole_file(path_in(&c, "out/plots/surface.png", path), &size);
    snprintf(path, sizeof path, "%s/m.txt", c.top.folder);
    write_file(path, map_text, strlen(map_text));
    for (size_t i = 0; i < 2; i++) {
        write_gnuplot(&c, scripts[i]);
        snprintf(command, sizeof command, "'%s' plot '%s'", HAFT, c.path);
        ran r = run_with_gnuplot(&c, command);
        check_says(r.err, "is the disk full?");
        check_silent_about(r.out, "figures in");
        ran_free(&r);
        check_pictures(&c, false, false); /* the old ones */
        size_t now = 0;
        char *kept = read_whole_file(path_in(&c, "out/plots/surface.png", path), &now);
        assert_true(now == size && memcmp(kept, figure, size) == 0);
        free(kept);
        snprintf(path, sizeof path, "ls '%s/out/plots' | grep -c tmp > /dev/null", c.path);
        assert_true(system(path) != 0);
        snprintf(command, sizeof command, "'%s' inspect --output=seen m.txt", HAFT_LAWS);
        r = run_with_gnuplot(&c, command);
        check_says(r.err, "is the disk full?");
        check_says(r.out, "rms");
        check_silent_about(r.out, "figure and data in");
        ran_free(&r);
        snprintf(path, sizeof path, "%s/seen/map.png", c.top.folder);
        assert_true(access(path, F_OK) != 0);
    }
    char *after = listing(&c);
    assert_string_equal(names, after);
    free(after);
    free(names);
    free(figure);
    case_remove(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(figures_that_are_cut_are_told), cmocka_unit_test(a_run_is_drawn),
        cmocka_unit_test(odd_runs_are_drawn_too),        cmocka_unit_test(any_realization_is_drawn),
        cmocka_unit_test(a_run_is_held_against_another), cmocka_unit_test(what_is_missing_is_told),
        cmocka_unit_test(a_narrow_strip_has_no_rings),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
