/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cases that are wrong: each is told with its place, its key and what would be right; and no text
 * whatever makes the reader crash or hang. */
#include "scratch.h"

#include <sys/stat.h>

#include "haft/io.h"

static const char MODEL[] = HAFT_SOURCE_DIR "/cases/delrio-rh85/case.yaml";

/* An edit of the model case, and what the message must hold; `at` is the text whose place in the
 * edited case must be named ("" for none), and `key` follows the place. */
typedef struct mistake {
    const char *from, *to, *at, *key, *says[3];
} mistake;

static const mistake mistakes[] = {
    /* keys */
    {"thickness: 2.62 um",
     "thicknes: 2.62 um",
     "thicknes:",
     "beam.thicknes: ",
     {"did you mean thickness?", "beam.thickness: is missing", "\"thickness: 2.62 um\""}},
    {"  thickness: 2.62 um\n",
     "",
     "beam:",
     "beam.thickness: ",
     {"is missing", "add \"thickness: 2.62 um\""}},
    {"  gap: 1.9 um",
     "  gap: 1.9 um\n  position: 1 um",
     "position: 1",
     "beam.position: ",
     {"did you mean load.position?"}},
    {"  gap: 1.9 um",
     "  gap: 1.9 um\n  colour_of_the_chip: red",
     "colour",
     "beam.colour_of_the",
     {"here are known: length, width, thickness"}},
    {"  gap: 1.9 um",
     "  gap: 1.9 um\n  gap: 2 um",
     "gap: 2",
     "beam.gap: ",
     {"is given twice, first at line"}},
    {"load:\n", "beam:\n  gap: 1 um\nload:\n", "beam:\n  gap", "beam: ", {"is given twice"}},
    {"study:\n  realizations: 20\n",
     "",
     "# Stiction",
     "study: ",
     {"is missing", "study: {realizations: 20}"}},
    {"seed: 85\n", "", "# Stiction", "seed: ", {"is missing", "seed: 1"}},
    {"study:\n  realizations: 20\n",
     "study: 20\n",
     "20\n\noutput",
     "study: ",
     {"is no mapping", "realizations: 20"}},
    {"mesh: active", "mesh: uniform", "beam:", "beam.element_length: ", {"mesh: exact"}},
    {"  gap: 1.9 um", "  gap: 1.9 um\n  [1]: 3", "[1]: 3", "beam: ", {"no plain word"}},
    {"  gap: 1.9 um", "  gap: 1.9 um\n  mesh.l: 3", "mesh.l: 3", "beam: ", {"no plain word"}},
    /* units and numbers */
    {"thickness: 2.62 um",
     "thickness: 2.62 kg",
     "2.62 kg",
     "beam.thickness: ",
     {"wrong dimension", "converts to m", "2.62 um"}},
    {"thickness: 2.62 um", "thickness: 2.62", "2.62\n", "beam.thickness: ", {"no unit", "2.62 um"}},
    {"thickness: 2.62 um", "thickness: nan um", "nan um", "beam.thickness: ", {"not a finite"}},
    {"thickness: 2.62 um", "thickness: -inf um", "-inf um", "beam.thickness: ", {"not a finite"}},
    {"thickness: 2.62 um", "thickness: 1e400 um", "1e400", "beam.thickness: ", {"not a finite"}},
    {"thickness: 2.62 um",
     "thickness: -2.62 um",
     "-2.62 um",
     "beam.thickness: ",
     {"out of range", "above 0 m"}},
    {"thickness: 2.62 um", "thickness: 0 um", "0 um", "beam.thickness: ", {"above 0 m"}},
    {"thickness: 2.62 um",
     "thickness: thin",
     "thin\n",
     "beam.thickness: ",
     {"does not begin with a number"}},
    {"thickness: 2.62 um", "thickness: 2.62 umm", "2.62 umm", "beam.thickness: ", {"unknown"}},
    {"thickness: 2.62 um", "thickness:", "", "beam.thickness: ", {"has no value"}},
    {"thickness: 2.62 um", "thickness: [2.62 um]", "[2.62", "beam.thickness: ", {"is a list"}},
    {"thickness: 2.62 um", "thickness: {a: 1}", "{a: 1}", "beam.thickness: ", {"is a mapping"}},
    {"thickness: 2.62 um", "thickness: \"2.62 um\\0\"", "\"2.62", "beam.thickness: ", {"NUL"}},
    {"poisson_ratio: 0.22 ",
     "poisson_ratio: 0.5 ",
     "0.5 ",
     "contact.poisson_ratio: ",
     {"below 0.5"}},
    {"f_limit: 5 MPa", "f_limit: 0 MPa", "0 MPa", "law.f_limit: ", {"above 0 Pa"}},
    {"crack_threshold: 1 %", "crack_threshold: 1 ", "1 ", "load.crack_threshold: ", {"below 1"}},
    {"realizations: 20", "realizations: 0", "0\n\noutput", "study.realizations: ", {"1 to"}},
    {"realizations: 20", "realizations: 2.5", "2.5", "study.realizations: ", {"whole number"}},
    {"realizations: 20",
     "realizations: 200\n  stop: {crack_length_mean: 0.5}",
     "0.5}",
     "study.stop.crack_length_mean: ",
     {"no unit"}},
    {"realizations: 20",
     "realizations: 200\n  stop: {crack_length_mean: 0 um}",
     "0 um}",
     "study.stop.crack_length_mean: ",
     {"above 0 m"}},
    {"realizations: 20",
     "realizations: 200\n  stop: {crack_length_mean: 1 N}",
     "1 N}",
     "study.stop.crack_length_mean: ",
     {"wrong dimension"}},
    {"realizations: 20",
     "realizations: 30\n  stop: {crack_length_mean: 1 um}",
     "1 um}",
     "study.stop.crack_length_mean: ",
     {"realizations: 31 at least"}},
    {"realizations: 20",
     "realizations: 200\n  stop: {confidence: 100 %}",
     "100 %}",
     "study.stop.confidence: ",
     {"below 1"}},
    {"realizations: 20",
     "realizations: 200\n  stop: {confidenc: 90 %}",
     "confidenc",
     "study.stop.confidenc: ",
     {"did you mean confidence?"}},
    {"realizations: 20",
     "realizations: 200\n  stop: 1 um",
     "1 um\n\noutput",
     "study.stop: ",
     {"is no mapping"}},
    {"seed: 85", "seed: -85", "-85", "seed: ", {"whole number"}},
    {"seed: 85",
     "seed: 18446744073709551616",
     "18446744073709551616",
     "seed: ",
     {"too large", "18446744073709551615"}},
    {"name: delrio-rh85", "name: del/rio", "del/rio", "name: ", {"letters, digits"}},
    {"title: DelRio", "title: \"a\\nb\" # DelRio", "\"a\\nb\"", "title: ", {"on one line"}},
    /* choices and lists */
    {"asperities: islands",
     "asperities: island",
     "island ",
     "contact.asperities: ",
     {"did you mean islands?", "summits or islands or fitted_islands"}},
    {"kind: morse", "kind: lennard-jones", "lennard", "law.kind: ", {"give morse or table"}},
    {"[0 deg, 0 deg]",
     "[0 deg]",
     "[0 deg]",
     "contact.capillary.contact_angles: ",
     {"has 1 entries; give 2"}},
    {"[0 deg, 0 deg]",
     "[0 deg, 90 deg]",
     "90 deg",
     "contact.capillary.contact_angles: ",
     {"out of range"}},
    {"[0 deg, 0 deg]", "0 deg", "0 deg\n", "contact.capillary.contact_angles: ", {"is no list"}},
    {"evidence: [0]",
     "evidence: [0, 20]",
     "20]",
     "output.evidence: ",
     {"no realization 20", "give 19 at most"}},
    {"evidence: [0]", "evidence: [3, 3]", "3]", "output.evidence: ", {"twice"}},
    {"evidence: [0]", "evidence: some", "some", "output.evidence: ", {"or all"}},
    /* several keys at once */
    {"humidity: 85 %",
     "humidity: 0 %",
     "0 %",
     "contact.capillary.humidity: ",
     {"leave contact.capillary out"}},
    {"humidity: 85 %",
     "humidity: 100 %",
     "100 %",
     "contact.capillary.humidity: ",
     {"leave contact.capillary out"}},
    {"humidity: 85 %", "humidity: 85", "85\n", "contact.capillary.humidity: ", {"write \"85 %\""}},
    {"  capillary:\n    humidity: 85 %",
     "  vdw: {}\n  capillary:\n    humidity: 0 %",
     "0 %",
     "contact.capillary.humidity: ",
     {"no water condenses in dry air", "forces: auto"}},
    {"humidity: 85 %", "humidity: -1 %", "-1 %", "contact.capillary.humidity: ", {"out of range"}},
    {"  capillary:\n",
     "  forces: auto\n  capillary:\n",
     "auto",
     "contact.forces: ",
     {"no section contact.vdw", "vdw: {}"}},
    {"  capillary:\n",
     "  forces: both\n  capillary:\n",
     "both",
     "contact.forces: ",
     {"given or auto or capillary or vdw"}},
    {"  capillary:\n",
     "  vdw: {hamaker_dry: -18.65e-20 J}\n  capillary:\n",
     "-18.65e-20 J",
     "contact.vdw.hamaker_dry: ",
     {"above 0 J"}},
    {"  capillary:\n",
     "  vdw: {hamaker_humd: 9.75e-20 J}\n  capillary:\n",
     "hamaker_humd",
     "contact.vdw.hamaker_humd: ",
     {"did you mean hamaker_humid?"}},
    {"  capillary:\n",
     "  vdw: {r0: 0.209}\n  capillary:\n",
     "0.209",
     "contact.vdw.r0: ",
     {"0.209 nm"}},
    {"  capillary:\n",
     "  forces: vdw\n  capillary:\n",
     "vdw",
     "contact.forces: ",
     {"no section contact.vdw", "vdw: {}"}},
    {"  capillary:\n    humidity: 85 %",
     "  forces: capillary\n  vdw: {}\n  capillary:\n    humidity: 0 %",
     "0 %",
     "contact.capillary.humidity: ",
     {"no water condenses in dry air"}},
    /* a softer body's lambda, 35000, is beyond what the spheres' table holds */
    {"young_modulus: 163 GPa\n  poisson_ratio: 0.22         # the paper gives none\n",
     "young_modulus: 100 Pa\n  poisson_ratio: 0.22\n  vdw: {r0: 0.209 nm}\n",
     "0.209 nm",
     "contact.vdw.r0: ",
     {"Maugis parameter", "the table holds 0.0001 to 100"}},
    {"  capillary:\n",
     "  vdw: {r0: 0.209 m}\n  capillary:\n",
     "0.209 m",
     "contact.vdw.r0: ",
     {"Maugis parameter"}},
    {"f_limit: 5 MPa",
     "f_limit: 5 MPa\n  f_limit_share: 20 %",
     "20 %",
     "law.f_limit_share: ",
     {"only one"}},
    {"  f_limit: 5 MPa\n", "", "law:", "law.f_limit: ", {"is missing", "f_limit_share: 20 %"}},
    {"f_limit: 5 MPa", "f_limit_share: 0 %", "0 %", "law.f_limit_share: ", {"above 0"}},
    {"grid_step: 5 nm",
     "grid_step: 20 nm",
     "20 nm",
     "surface.grid_step: ",
     {"20 nm is too coarse", "10.87", "pi/zeta_max"}},
    {"zeta_0: 19.4 rad/um",
     "zeta_0: 290 rad/um",
     "290 rad",
     "surface.zeta_0: ",
     {"not below zeta_max"}},
    {"s_1: 6.46e-3 nm^4", "s_1: 6.46e4 nm^4", "6.46e4", "surface.s_1: ", {"6460 nm^4 at most"}},
    {"l_meso: 3 um",
     "l_meso: 7 um",
     "7 um",
     "beam.l_meso: ",
     {"does not divide beam.length, 600 um", "nearest is 7.5 um"}},
    {"l_meso: 3 um", "l_meso: 601 um", "601 um", "beam.l_meso: ", {"nearest is 600 um"}},
    {"mesh: active",
     "mesh: uniform\n  element_length: 14 um",
     "14 um",
     "beam.element_length: ",
     {"nearest is 13.953488372"}},
    {"width: 30 um",
     "width: 30.003 um",
     "30.003 um",
     "beam.width: ",
     {"no multiple of 10 nm", "2 surface.grid_step", "nearest is 30 um"}},
    {"grid_step: 5 nm", "grid_step: 3.5 nm", "3 um", "beam.l_meso: ", {"no multiple of 10.5 nm"}},
    {"position: 60 um",
     "position: 601 um",
     "601 um",
     "load.position: ",
     {"off the beam", "600 um"}},
    {"crack_length: 120 um",
     "crack_length: 50 um",
     "50 um",
     "load.crack_length: ",
     {"more than 60 um"}},
    {"crack_length: 120 um",
     "crack_length: 600 um",
     "600 um ",
     "load.crack_length: ",
     {"less than 600 um"}},
    {"to: 28 nm", "to: 2 nm", "2 nm", "contact.distance.to: ", {"more than 6 nm"}},
    {"to: 28 nm", "to: 2 um", "2 um", "contact.distance.to: ", {"less than beam.gap"}},
    {"step: 0.1 nm",
     "step: 0.13 nm",
     "0.13 nm",
     "contact.distance.step: ",
     {"does not divide", "22 nm", "nearest is 0.1301775"}},
    {"step: 0.1 nm",
     "step: 2.5 nm",
     "2.5 nm",
     "contact.distance.step: ",
     {"fewer than 16", "1.466666666"}},
    {"step: 0.1 nm", "step: 1e-8 nm", "1e-8 nm", "contact.distance.step: ", {"at least"}},
    /* YAML itself */
    {"  gap: 1.9 um", "  gap: &g 1.9 um", "&g", "", {"anchor"}},
    {"  gap: 1.9 um", "  gap: *g", "*g", "", {"alias"}},
    {"  gap: 1.9 um", "  gap: !!str 1.9 um", "!!str", "", {"tag"}},
    {"study:", "---\nstudy:", "---", "", {"second document"}},
    {"study:", "\tstudy:", "\tstudy", "", {"no valid YAML"}},
    {"[0 deg, 0 deg]", "[0 deg, 0 deg", "", "", {"no valid YAML"}},
    {"[0 deg, 0 deg]", "[[[[[[[[[0 deg]]]]]]]]]", "", "", {"nested too deeply"}},
    {"title: DelRio", "title: Del\xffRio", "\xff", "", {"byte 0xff is not UTF-8"}},
    {"title: DelRio", "title: Del\xc0\x80Rio", "\xc0", "", {"not UTF-8"}},
};

/* The place of `at`, looked for from the edit on, else from the start. */
static void place_of(const char *text, size_t edit, const char *at, char place[64]) {
    const char *found = strstr(text + edit, at);
    found = found != NULL ? found : strstr(text, at);
    assert_non_null(found);
    int line = 1, column = 1;
    for (const char *c = text; c < found; c++) {
        column = *c == '\n' ? 1 : column + 1;
        line += *c == '\n';
    }
    snprintf(place, 64, ":%d:%d: ", line, column);
}

static void every_mistake_is_told_with_its_place(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400];
    scratch_path(&s, "case.yaml", path);
    char *model = read_whole_file(MODEL, NULL);
    for (size_t i = 0; i < sizeof mistakes / sizeof *mistakes; i++) {
        const mistake *m = &mistakes[i];
        char *text = replaced(model, m->from, m->to);
        write_file(path, text, strlen(text));
        haft_error error = {0};
        haft_case *c = NULL;
        if (haft_case_read(&c, path, &error) != HAFT_ERROR_INPUT || c != NULL) {
            fail_msg("\"%s\" was taken", m->to);
        }
        char place[64] = "", expected[600];
        if (m->at[0] != '\0') {
            place_of(text, (size_t)(strstr(model, m->from) - model), m->at, place);
        }
        snprintf(expected, sizeof expected, "%s%s%s", place[0] != '\0' ? path : "", place, m->key);
        if (strstr(error.message, expected) == NULL) {
            fail_msg("\"%s\": \"%s\" is not in: %s", m->to, expected, error.message);
        }
        for (int j = 0; j < 3 && m->says[j] != NULL; j++) {
            if (strstr(error.message, m->says[j]) == NULL) {
                fail_msg("\"%s\": \"%s\" is not in: %s", m->to, m->says[j], error.message);
            }
        }
        free(text);
    }
    free(model);
    scratch_remove(&s);
}

static int lines_of(const char *text) {
    int n = 1;
    for (; *text != '\0'; text++) {
        n += *text == '\n';
    }
    return n;
}

/* Three slips, three lines, in the order of the file; and not one more. */
static void all_mistakes_are_told_at_once(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400];
    scratch_path(&s, "case.yaml", path);
    char *model = read_whole_file(MODEL, NULL);
    char *one = replaced(model, "f_limit: 5 MPa", "f_limit: 5 m");
    char *two = replaced(one, "width: 30 um", "width: -30 um");
    char *three = replaced(two, "seed: 85", "seed: x");
    write_file(path, three, strlen(three));
    haft_error error = {0};
    haft_case *c = NULL;
    assert_int_equal(haft_case_read(&c, path, &error), HAFT_ERROR_INPUT);
    assert_int_equal(lines_of(error.message), 3);
    const char *seed = strstr(error.message, ": seed: "),
               *limit = strstr(error.message, "f_limit:");
    const char *width = strstr(error.message, "beam.width: ");
    assert_true(seed != NULL && limit != NULL && width != NULL && seed < limit && limit < width);
    free(one);
    free(two);
    free(three);
    free(model);

    char *many = calloc(1, 20000);
    for (int i = 0; i < 400; i++) {
        snprintf(many + strlen(many), 40, "wrong_key_%d: 1\n", i);
    }
    write_file(path, many, strlen(many));
    assert_int_equal(haft_case_read(&c, path, &error), HAFT_ERROR_INPUT);
    assert_true(strlen(error.message) < HAFT_ERROR_CAPACITY - 1);
    /* 400 unknown, name and seed missing, and 6 of the sections */
    int told = lines_of(error.message) - 1, more = 0;
    assert_int_equal(sscanf(strrchr(error.message, '\n'), "\nand %d more", &more), 1);
    assert_int_equal(told + more, 400 + 2 + 6);
    free(many);
    scratch_remove(&s);
}

static void check_refused(const char *path, haft_status status, const char *says) {
    haft_error error = {0};
    haft_case *c = NULL;
    assert_int_equal(haft_case_read(&c, path, &error), status);
    assert_null(c);
    if (strstr(error.message, says) == NULL || strstr(error.message, path) == NULL) {
        fail_msg("\"%s\" or the path is not in: %s", says, error.message);
    }
}

static void files_that_are_no_case_are_refused(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400];
    scratch_path(&s, "case.yaml", path);
    check_refused(path, HAFT_ERROR_IO, "No such file");
    check_refused(s.folder, HAFT_ERROR_IO, "is a directory");
    assert_int_equal(mkfifo(path, 0600), 0);
    check_refused(path, HAFT_ERROR_IO, "is a pipe; give a regular file");
    assert_int_equal(unlink(path), 0);
    write_file(path, "", 0);
    check_refused(path, HAFT_ERROR_INPUT, "is empty");
    write_file(path, "# nothing\n", 10);
    check_refused(path, HAFT_ERROR_INPUT, "is empty");
    write_file(path, "- a\n", 4);
    check_refused(path, HAFT_ERROR_INPUT, "is no mapping");
    write_file(path, "name: a\0b\n", 10);
    check_refused(path, HAFT_ERROR_INPUT, "byte 0x00");
    char *large = malloc(300000);
    memset(large, '#', 300000);
    write_file(path, large, 300000);
    check_refused(path, HAFT_ERROR_INPUT, "larger than 256 KiB");
    memset(large, '[', 200000);
    write_file(path, large, 200000);
    check_refused(path, HAFT_ERROR_INPUT, "nested too deeply");
    free(large);
    if (geteuid() != 0) {
        write_file(path, "name: a\n", 8);
        assert_int_equal(chmod(path, 0), 0);
        check_refused(path, HAFT_ERROR_IO, "Permission denied");
    }
    scratch_remove(&s);
}

/* One mutation: bytes flipped, lines dropped or doubled, text cut or spliced. */
static size_t mutate(const char *model, size_t size, uint64_t number, char *out) {
    static const char *const splices[] = {": ", "[",    "{",  "}",   "- ",  "\n  ",
                                          "%",  "\"",   "-1", "nan", "1e9", "&",
                                          "*",  "um^9", "\t", "|\n", "all", "'"};
    uint64_t w[8];
    haft_random_key key = {20, HAFT_RANDOM_TEST};
    haft_random_words(key, number, 0, 0, w);
    haft_random_words(key, number, 0, 1, w + 4);
    memcpy(out, model, size);
    for (uint64_t k = 0; k <= w[0] % 4; k++) {
        size_t at = (size_t)(w[1 + k] % size);
        size_t length = (size_t)(w[5] >> 8 * k) % 40;
        length = at + length > size ? size - at : length;
        const char *splice = splices[(w[6] >> 8 * k) % (sizeof splices / sizeof *splices)];
        size_t n = strlen(splice);
        switch ((w[7] >> 8 * k) % 4) {
        case 0:
            out[at] = (char)(w[6] >> 8 * k);
            break;
        case 1: /* drop */
            memmove(out + at, out + at + length, size - at - length);
            size -= length;
            break;
        case 2: /* double */
            memmove(out + at + length, out + at, size - at);
            size += length;
            break;
        default: /* splice */
            memmove(out + at + n, out + at, size - at);
            memcpy(out + at, splice, n);
            size += n;
            break;
        }
    }
    return size;
}

/* A thousand mutations are read or refused with a message; what is read can be written out and
 * read back. */
static void no_mutation_breaks_the_reader(void **state) {
    (void)state;
    enum { MUTATIONS = 1000 };
    scratch s = scratch_create();
    char path[400], again[400];
    scratch_path(&s, "case.yaml", path);
    scratch_path(&s, "again.yaml", again);
    size_t size = 0;
    char *model = read_whole_file(MODEL, &size);
    char *text = malloc(size + 400);
    int taken = 0;
    for (uint64_t i = 0; i < MUTATIONS; i++) {
        size_t n = mutate(model, size, i, text);
        write_file(path, text, n);
        haft_error error = {0};
        haft_case *c = NULL, *back = NULL;
        haft_status status = haft_case_read(&c, path, &error);
        if (status != HAFT_OK) {
            assert_null(c);
            assert_int_equal(error.status, status);
            assert_int_equal(status, HAFT_ERROR_INPUT);
            assert_true(strncmp(error.message, path, strlen(path)) == 0);
            continue;
        }
        taken++;
        char *out = NULL, *second = NULL;
        check_ok(haft_case_emit(&out, c, &error), error);
        write_file(again, out, strlen(out));
        check_ok(haft_case_read(&back, again, &error), error);
        check_ok(haft_case_emit(&second, back, &error), error);
        assert_string_equal(out, second);
        haft_memory_free(out);
        haft_memory_free(second);
        haft_case_destroy(&c);
        haft_case_destroy(&back);
    }
    assert_true(taken > MUTATIONS / 50 && taken < MUTATIONS);
    free(text);
    free(model);
    scratch_remove(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_mistake_is_told_with_its_place),
        cmocka_unit_test(all_mistakes_are_told_at_once),
        cmocka_unit_test(files_that_are_no_case_are_refused),
        cmocka_unit_test(no_mutation_breaks_the_reader),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
