/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From a map to a stuck probability in one command, whatever format the map has: each is written
 * here, `haft init` makes a case of it, `haft run` a number. Further formats are a line of the
 * table. What init is told wrongly, and what it must not touch; the surface section at the end of
 * inspect's output, pasted into a case. */
#include "program.h"
#include "same_map.h"

#include "haft/io.h"

/* Heights like polished silicon's, the same for all formats. */
static double *make_heights(void) {
    haft_error error = {0};
    haft_surface_plan *plan = NULL;
    haft_surface_work *work = NULL;
    haft_roughness rough = {3e-9, 150e-9, 0.8, 70e6};
    haft_surface_spec spec = {
        .grid_step = STEP, .rows = SIDE, .columns = SIDE, .key = {5, HAFT_RANDOM_TEST}};
    check_ok(haft_psd_from_roughness(&spec.psd, &rough, &error), error);
    double *z = calloc((size_t)SIDE * SIDE, sizeof *z);
    assert_non_null(z);
    check_ok(haft_surface_plan_create(&plan, &spec, &error), error);
    check_ok(haft_surface_work_create(&work, plan, &error), error);
    check_ok(haft_surface_prepare(work, 0, 0, 0, &error), error);
    check_ok(haft_surface_rows(work, 0, SIDE, z, &error), error);
    haft_surface_work_destroy(&work);
    haft_surface_plan_destroy(&plan);
    return z;
}

/* ---- the formats ---- */

typedef struct format {
    const char *file;
    void (*write)(const char *path, const double *z);
    const char *options[2]; /* that the file needs, NULL for none */
} format;

static const format formats[] = {
    {"map.spm", write_nanoscope_map, {NULL}},
    {"map.gsf", write_gsf, {NULL}},
    {"map.h5", write_hdf, {NULL}},
    {"gwyddion.txt", write_gwyddion_text, {NULL}},
    {"bare.txt", write_bare_text, {"--unit=nm", "--size=2.56 um x 2.56 um"}},
    {"map.csv", write_csv, {"--unit=nm", "--size=2.56 um x 2.56 um"}},
    {"points.xyz", write_points, {"--unit=nm", "--lateral-unit=um"}},
    {"map.npy", write_npy, {"--unit=m", "--size=2.56 um x 2.56 um"}},
    {"map.gwy", write_gwyddion, {NULL}},
    {"packed.nc", write_packed, {"--size=2.56 um x 2.56 um"}},
    {"utf16.txt", write_utf16, {"--unit=nm", "--size=2.56 um x 2.56 um"}},
};
enum { FORMATS = sizeof formats / sizeof *formats };

/* ---- a stuck probability of each ---- */

static scratch folder;

/* A beam that its own adhesion nearly frees, small enough for seconds. */
#define SMALL                                                                                      \
    "--beam=60 um x 1 um x 1 um", "--gap=0.5 um", "--humidity=70 %", "--beams=4", "--quiet"

static void each_format_gives_a_probability(void **state) {
    (void)state;
    double *z = make_heights(), share[FORMATS], rms[FORMATS];
    for (size_t k = 0; k < FORMATS; k++) {
        const format *f = &formats[k];
        char path[400], map[450], place[400], name[20];
        snprintf(name, sizeof name, "case-%zu", k);
        scratch_path(&folder, name, place);
        f->write(scratch_path(&folder, f->file, path), z);
        snprintf(map, sizeof map, "--map=%s", path);
        must_run(HAFT, ARGS("init", place, map, SMALL, f->options[0], f->options[1]));
        assert_int_equal(unlink(path), 0); /* the case has its own copy */
        haft_case *c = NULL;
        haft_error error = {0};
        snprintf(path, sizeof path, "%.300s/case.yaml", place);
        check_ok(haft_case_read(&c, path, &error), error);
        rms[k] = sqrt(haft_case_moments(c).m0);
        haft_case_destroy(&c);
        ran r = run_expect(0, HAFT, ARGS("run", "--json", "--quiet", "--threads", "2", place));
        share[k] = json_number(r.out, "stuck_share");
        double followed = json_number(r.out, "stuck") + json_number(r.out, "free");
        ran_free(&r);
        print_message("%-14s %.3f nm rms, stuck with probability %.2f\n", f->file, rms[k] * 1e9,
                      share[k]);
        assert_true(followed == 4 && share[k] >= 0 && share[k] <= 1);
        check_relative(rms[k], rms[0], 1e-3); /* 16 bits against floating point */
        assert_true(share[k] == share[0]);
    }
    free(z);
}

static void three_numbers_do_without_a_map(void **state) {
    (void)state;
    char place[400], path[400];
    haft_case *c = NULL;
    haft_error error = {0};
    scratch_path(&folder, "numbers", place);
    must_run(HAFT, ARGS("init", place, "--rms=3 nm", "--correlation-length=60 nm", "--hurst=0.8",
                        "--zeta-max=70 rad/um", SMALL));
    snprintf(path, sizeof path, "%.300s/case.yaml", place);
    check_ok(haft_case_read(&c, path, &error), error);
    check_relative(sqrt(haft_case_moments(c).m0), 3e-9, 1e-10);
    check_relative(haft_case_correlation_length(c), 60e-9, 1e-9);
    haft_case_destroy(&c);
    ran r = run_expect(0, HAFT, ARGS("run", "--json", "--quiet", "--threads", "2", place));
    assert_true(isfinite(json_number(r.out, "stuck_share")));
    ran_free(&r);
}

/* ---- what it refuses ---- */

static void check_refused(int code, const char *const *args, const char *says) {
    ran r = run_expect(code, HAFT, args);
    check_says(r.err, says);
    assert_null(strchr(strchr(r.err, '\n') + 1, '\n')); /* one line */
    ran_free(&r);
}

static void nothing_is_overwritten_or_left(void **state) {
    (void)state;
    double *z = make_heights();
    char path[400], map[450], place[400], file[400], other[400];
    write_gsf(scratch_path(&folder, "m.gsf", path), z);
    snprintf(map, sizeof map, "--map=%s", path);
    scratch_path(&folder, "kept", place);
    assert_int_equal(mkdir(place, 0777), 0);
    snprintf(file, sizeof file, "%.300s/case.yaml", place);
    snprintf(other, sizeof other, "%.300s/m.gsf", place);
    write_file(file, "mine\n", 5);
    check_refused(5, ARGS("init", place, map), "is there already and is not replaced");
    char *text = read_whole_file(file, NULL);
    assert_string_equal(text, "mine\n");
    free(text);
    assert_int_equal(unlink(file), 0);
    write_file(other, "another map", 11); /* of the same name */
    check_refused(5, ARGS("init", place, map, SMALL), "m.gsf is there already");
    assert_true(access(file, F_OK) != 0);
    /* a folder that could not be made whole is gone again */
    scratch_path(&folder, "gone", place);
    check_refused(3, ARGS("init", place, map, "--gap=10 nm"), "give --gap=");
    check_refused(3, ARGS("init", place, map, "--unit=nm", "--channel=none", "--beam=60 um"),
                  "is no length, width and thickness");
    check_refused(3, ARGS("init", place, map, "--beam=60 um x 0.1 um x 0.1 um"), "no grid carries");
    check_refused(3, ARGS("init", place, map, "--humidity=100 %"), "less than 100 %");
    check_refused(3, ARGS("init", place, map, "--rms=3 nm"), "leave out --map, or");
    check_refused(3, ARGS("init", place), "init needs a surface; give --map=FILE");
    check_refused(3, ARGS("init", place, "--rms=3 nm", "--hurst=0.8"), "--correlation-length=");
    check_refused(3,
                  ARGS("init", place, "--rms=3 nm", "--hurst=1.8", "--correlation-length=100 nm"),
                  "at most 1");
    check_refused(4, ARGS("init", place, "--map=/nowhere.gsf"), "/nowhere.gsf");
    assert_true(access(place, F_OK) != 0);
    check_refused(2, ARGS("check", place, map), "belong to init");
    free(z);
}

/* ---- inspect's block ---- */

/* The number that follows a word in a text. */
static double number_after(const char *text, const char *word) {
    const char *at = strstr(text, word);
    if (at == NULL) {
        fail_msg("no \"%s\" in:\n%s", word, text);
    }
    return strtod(at + strlen(word), NULL);
}

static void inspects_block_can_be_pasted(void **state) {
    (void)state;
    double *z = make_heights();
    char *rest = read_whole_file(HAFT_SOURCE_DIR "/cases/delrio-rh85/case.yaml", NULL);
    char place[400], before[400];
    assert_non_null(getcwd(before, sizeof before));
    scratch_path(&folder, "pasted", place);
    assert_int_equal(mkdir(place, 0777), 0);
    assert_int_equal(chdir(place), 0);
    char *paths = strdup(getenv("PATH") != NULL ? getenv("PATH") : "");
    assert_true(paths != NULL && setenv("PATH", "", 1) == 0); /* no figures: they take long */
    for (size_t k = 0; k < FORMATS; k++) {
        const format *f = &formats[k];
        haft_case *c = NULL;
        haft_error error = {0};
        f->write(f->file, z);
        const char *first = f->options[0] != NULL ? f->options[0] : "--level=plane";
        const char *second = f->options[1] != NULL ? f->options[1] : "--outliers=8";
        ran r = run_program(HAFT_LAWS, ARGS("inspect", "--tip-radius=5 nm", "--window=welch", first,
                                            second, f->file));
        const char *block = strstr(r.out, "\nsurface:\n"), *tail = strstr(rest, "contact:\n");
        assert_true(block != NULL && tail != NULL);
        char *text = calloc(1, strlen(block) + strlen(tail) + 100);
        assert_non_null(text);
        sprintf(text, "name: pasted\nseed: 1\n%s\n%s", block, tail);
        char *nearer = replaced(text, "from: 6 nm", "from: 1 nm");
        char *whole = replaced(nearer, "sampler: explicit", "sampler: patches");
        free(nearer);
        write_file("case.yaml", whole, strlen(whole));
        ran check = run_expect(0, HAFT, ARGS("check", place));
        check_says(check.out, "can be used");
        check_ok(haft_case_read(&c, "case.yaml", &error), error);
        const char *moments = strstr(r.out, "moments of the radial PSD");
        assert_non_null(moments);
        check_relative(haft_case_moments(c).m0 * 1e18, number_after(moments, "m0"), 2e-4);
        haft_case_destroy(&c);
        ran_free(&check);
        ran_free(&r);
        free(whole);
        free(text);
    }
    assert_true(chdir(before) == 0 && setenv("PATH", paths, 1) == 0);
    free(paths);
    free(rest);
    free(z);
}

static int remove_folder(void **state) {
    (void)state;
    return nftw(folder.folder, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_format_gives_a_probability),
        cmocka_unit_test(three_numbers_do_without_a_map),
        cmocka_unit_test(nothing_is_overwritten_or_left),
        cmocka_unit_test(inspects_block_can_be_pasted),
    };
    folder = scratch_create();
    return cmocka_run_group_tests(tests, NULL, remove_folder);
}
