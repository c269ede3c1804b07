/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random valid cases, drawn over the schema: what one is resolved to reads back as the same case,
 * whose text is the same again; so do the variants of sweeps over it. Every key is given in some
 * case and left out in another where it may be, and every word of every choice is reached. */
#include "check.h"
#include "scratch.h"

#include "haft/io.h"
#include "io/case.h"

enum { CASES = 200, TEXT_MOST = 16384, VALUE_MOST = 200 };

typedef struct draft {
    char value[HAFT_KEYS_MAX][VALUE_MOST]; /* "" where a key is left out */
    uint64_t state;
} draft;

static scratch folder;

/* A random whole number below n. */
static size_t draw(draft *d, size_t n) {
    d->state = d->state * 6364136223846793005u + 1442695040888963407u;
    return (size_t)(d->state >> 33) % n;
}

static char *value_of(draft *d, const char *path) {
    int key = haft_case_find_key(path);
    assert_true(key >= 0);
    return d->value[key];
}

static void put(draft *d, const char *path, const char *text) {
    snprintf(value_of(d, path), VALUE_MOST, "%s", text);
}

static bool has(draft *d, const char *path, const char *text) {
    return strcmp(value_of(d, path), text) == 0;
}

static void drop(draft *d, const char *section) {
    for (size_t i = 0; i < haft_case_key_count; i++) {
        if (strncmp(haft_case_keys[i].path, section, strlen(section)) == 0) {
            d->value[i][0] = '\0';
        }
    }
}

/* A number near the example's, of many digits where it may be any. */
static void draw_real(draft *d, const haft_key *key, char *text) {
    static const char *const exact[] = {"surface.grid_step", "contact.distance", "beam.", "load."};
    char number[40];
    const char *example = key->example;
    for (size_t i = 0; i < sizeof exact / sizeof *exact; i++) {
        if (strncmp(key->path, exact[i], strlen(exact[i])) == 0) {
            snprintf(text, VALUE_MOST, "%s", example);
            return;
        }
    }
    double value = 0, factor = 0.9 + (double)draw(d, 1000003) / 1e7;
    char *unit = (char *)(uintptr_t)(example + (*example == '['));
    value = strtod(unit, &unit);
    value = value == 0 && key->low < 0 && draw(d, 2) ? -0.5 + factor / 3 : value * factor;
    snprintf(number, sizeof number, "%.*g", (int)(3 + draw(d, 15)), value);
    unit[strcspn(unit, ",]")] == '\0'
        ? (void)snprintf(text, VALUE_MOST, "%s%s", number, unit)
        : (void)snprintf(text, VALUE_MOST, "[%s%.*s, %s%.*s]", number, (int)strcspn(unit, ",]"),
                         unit, number, (int)strcspn(unit, ",]"), unit);
}

static void draw_value(draft *d, size_t i) {
    const haft_key *key = &haft_case_keys[i];
    char *text = d->value[i];
    size_t n = 0;
    switch (key->type) {
    case HAFT_KEY_TEXT:
        snprintf(text, VALUE_MOST, "%s",
                 draw(d, 2) ? "\"a \\\"b\\\" \\\\ #: {é} %d 'c'\"" : "\"\"");
        break;
    case HAFT_KEY_SEED:
        snprintf(text, VALUE_MOST, "%zu", draw(d, 1000000));
        break;
    case HAFT_KEY_CHOICE:
        while (key->choices[n] != NULL) {
            n++;
        }
        snprintf(text, VALUE_MOST, "%s", key->choices[draw(d, n)]);
        break;
    case HAFT_KEY_REAL:
        draw_real(d, key, text);
        break;
    case HAFT_KEY_EVIDENCE:
        snprintf(text, VALUE_MOST, "%s", (const char *[]){"all", "[]", "[3, 0]"}[draw(d, 3)]);
        break;
    default:
        snprintf(text, VALUE_MOST, "%s", key->example);
    }
}

/* Makes of what was drawn a case that hangs together. */
static void settle_surface(draft *d) {
    size_t kind = draw(d, 5); /* parameters, a table, maps, maps of both faces, roughness */
    bool rough = kind == 4;
    kind = rough ? 0 : kind;
    put(d, "surface.maps", kind < 2 ? "" : "\"m a\\x07p \\\\ \\\"1\\\".gsf\"");
    put(d, "surface.opposite_maps", kind < 3 ? "" : "[b.gsf, b.gsf]");
    put(d, "surface.psd", kind == 1 ? "\"psd # 'x'.csv\"" : "");
    put(d, "surface.channel", kind < 2 || draw(d, 2) ? "" : "Height");
    put(d, "surface.outliers", draw(d, 2) ? "" : "40.5");
    put(d, "surface.tip_radius", draw(d, 2) ? "" : "0.31 nm");
    static const char *const roughness[] = {"surface.rms", "surface.correlation_length",
                                            "surface.hurst"};
    for (size_t k = 0; k < 3; k++) {
        put(d, roughness[k], rough ? haft_case_keys[haft_case_find_key(roughness[k])].example : "");
    }
    if (kind > 0 || rough) {
        put(d, "surface.zeta_0", "");
        put(d, "surface.s_0", "");
        put(d, "surface.s_1", "");
        put(d, "surface.zeta_max", draw(d, 2) && !rough ? "" : "250 rad/um");
    } else {
        for (size_t i = 0; i < haft_case_key_count; i++) {
            const haft_key *key = &haft_case_keys[i];
            if (strncmp(key->path, "surface.", 8) == 0 &&
                (key->where == HAFT_PART_SELF_AFFINE || strstr(key->path, "zeta") != NULL)) {
                put(d, key->path, key->example);
            }
        }
    }
    if (kind < 2) {
        put(d, "surface.source", "");
        put(d, "surface.marginal",
            has(d, "surface.marginal", "heights") ? "johnson" : value_of(d, "surface.marginal"));
        put(d, "surface.kurtosis", "3.4");
        put(d, "surface.skewness", draw(d, 3) == 0 ? "0" : "0.25");
    } else if (has(d, "surface.marginal", "johnson")) {
        put(d, "surface.kurtosis", "3.9");
        put(d, "surface.skewness", draw(d, 3) == 0 ? "0" : "-0.25");
    }
}

static void settle(draft *d) {
    settle_surface(d);
    put(d, "name", "a.b_c-1");
    put(d, "study.realizations", "40");
    put(d, "contact.vdw.r0", "");
    if (has(d, "surface.source", "maps") && value_of(d, "law.sampler")[0] == '\0') {
        put(d, "law.sampler", "patches");
    } else if (has(d, "surface.source", "maps") && has(d, "law.sampler", "explicit")) {
        put(d, "law.sampler", "gpce");
    }
    if (has(d, "law.kind", "table") && !has(d, "law.sampler", "bootstrap")) {
        put(d, "law.sampler", has(d, "surface.source", "maps") ? "patches" : "");
    }
    put(d, draw(d, 2) ? "law.f_limit" : "law.f_limit_share", "");
    if (value_of(d, "law.f_limit")[0] == '\0' && value_of(d, "law.f_limit_share")[0] == '\0') {
        put(d, "law.f_limit_share", "20 %");
    }
    if (draw(d, 2)) {
        drop(d, draw(d, 2) ? "contact.dispersion.oxide" : "contact.dispersion.");
    }
    const char *forces = value_of(d, "contact.forces");
    size_t sections = draw(d, 4); /* neither, capillary, vdw, both */
    sections = strcmp(forces, "auto") == 0        ? 3
               : strcmp(forces, "capillary") == 0 ? sections | 1
               : strcmp(forces, "vdw") == 0       ? sections | 2
                                                  : sections;
    put(d, "contact.capillary.adsorbed_table",
        has(d, "contact.capillary.adsorbed", "table") ? "film.csv" : "");
    if ((sections & 1) == 0) {
        drop(d, "contact.capillary.");
    }
    if (value_of(d, "contact.dispersion.oxide.hamaker")[0] != '\0' && (sections & 2) == 0) {
        put(d, "contact.dispersion.hamaker", "1.865e-19 J"); /* or else it is missing */
    } else if ((sections & 2) == 0) {
        drop(d, "contact.dispersion.");
    }
    if ((sections & 2) == 0) {
        drop(d, "contact.vdw.");
    } else {
        put(d, "contact.vdw.r0", "0.209 nm");
    }
}

static void draw_case(draft *d) {
    for (size_t i = 0; i < haft_case_key_count; i++) {
        d->value[i][0] = '\0';
        if (haft_case_keys[i].fallback == NULL || draw(d, 2)) {
            draw_value(d, i);
        }
    }
    if (draw(d, 2)) {
        put(d, "beam.mesh", draw(d, 2) ? "uniform" : "");
        put(d, "beam.element_length", "15 um");
    } else if (value_of(d, "beam.mesh")[0] == '\0') {
        put(d, "beam.mesh", "exact");
    } else if (has(d, "beam.mesh", "uniform")) {
        put(d, "beam.element_length", "15 um");
    }
    settle(d);
}

/* Sections in a random order would test the reader; here each is written whole by its keys. */
static void write_section(draft *d, char *text, const char *section, int depth) {
    for (size_t i = 0; i < haft_case_key_count; i++) {
        if (d->value[i][0] != '\0' && haft_case_is_member(haft_case_keys[i].path, section)) {
            sprintf(text + strlen(text), "%*s%s: %s\n", 2 * depth, "",
                    haft_case_leaf(haft_case_keys[i].path), d->value[i]);
        }
    }
    for (size_t i = 0; i < haft_case_section_count; i++) {
        const char *inner = haft_case_sections[i].path;
        bool used = false;
        for (size_t k = 0; k < haft_case_key_count; k++) {
            used = used || (d->value[k][0] != '\0' &&
                            strncmp(haft_case_keys[k].path, inner, strlen(inner)) == 0);
        }
        if (used && haft_case_is_member(inner, section)) {
            sprintf(text + strlen(text), "%*s%s:\n", 2 * depth, "", haft_case_leaf(inner));
            write_section(d, text, inner, depth + 1);
        }
    }
}

/* What is emitted reads back, and is emitted again as it was. */
static void check_round(const haft_case *c) {
    haft_error error = {0};
    char path[400], *first = NULL, *second = NULL;
    char laws[2][HAFT_DIGEST_CAPACITY];
    haft_case *again = NULL;
    check_ok(haft_case_emit(&first, c, &error), error);
    write_file(scratch_path(&folder, "again.yaml", path), first, strlen(first));
    if (haft_case_read(&again, path, &error) != HAFT_OK) {
        fail_msg("%s\n%s", error.message, first);
    }
    check_ok(haft_case_emit(&second, again, &error), error);
    assert_string_equal(first, second);
    check_ok(haft_case_laws_digest(c, laws[0], &error), error);
    check_ok(haft_case_laws_digest(again, laws[1], &error), error);
    assert_string_equal(laws[0], laws[1]);
    for (size_t i = 0; i < haft_case_key_count; i++) {
        double value = haft_case_number(c, &haft_case_keys[i]);
        double other = haft_case_number(again, &haft_case_keys[i]);
        char line[HAFT_KEY_CAPACITY + 4];
        snprintf(line, sizeof line, " %s: ", haft_case_leaf(haft_case_keys[i].path));
        bool given = strstr(first, line) != NULL; /* of a section that was not left out */
        if (given && !(value == other || (isnan(value) && isnan(other)))) {
            fail_msg("%s: %.17g became %.17g\n%s", haft_case_keys[i].path, value, other, first);
        }
    }
    haft_case_destroy(&again);
    haft_memory_free(first);
    haft_memory_free(second);
}

typedef struct tally {
    size_t with[HAFT_KEYS_MAX], without[HAFT_KEYS_MAX], choice[HAFT_KEYS_MAX][16];
} tally;

static void count(tally *t, draft *d, const haft_case *c) {
    for (size_t i = 0; i < haft_case_key_count; i++) {
        const haft_key *key = &haft_case_keys[i];
        t->with[i] += d->value[i][0] != '\0';
        t->without[i] += d->value[i][0] == '\0';
        if (key->type == HAFT_KEY_CHOICE && d->value[i][0] != '\0') {
            t->choice[i][(size_t)haft_case_number(c, key)]++;
        }
    }
}

static void check_tally(const tally *t) {
    for (size_t i = 0; i < haft_case_key_count; i++) {
        const haft_key *key = &haft_case_keys[i];
        if (t->with[i] == 0 || (key->fallback != NULL && t->without[i] == 0)) {
            fail_msg("%s: given %zu times, left out %zu times", key->path, t->with[i],
                     t->without[i]);
        }
        for (size_t k = 0; key->type == HAFT_KEY_CHOICE && key->choices[k] != NULL; k++) {
            if (t->choice[i][k] == 0) {
                fail_msg("%s: %s was never chosen", key->path, key->choices[k]);
            }
        }
    }
}

static void write_inputs(void) {
    static const char psd[] = "zeta [rad/um],s [nm^4]\n1,6460\n19.4,6460\n289,0.00646\n";
    static const char film[] = "humidity [%],thickness [nm]\n20,0.3\n50,0.6\n95,2\n";
    static const char *const names[] = {"m a\ap \\ \"1\".gsf", "b.gsf"};
    haft_error error = {0};
    haft_map *map = NULL;
    char path[400];
    write_file(scratch_path(&folder, "psd # 'x'.csv", path), psd, strlen(psd));
    write_file(scratch_path(&folder, "film.csv", path), film, strlen(film));
    check_ok(haft_map_create(&map, 48, 48, 10e-9, 10e-9, &error), error);
    for (size_t i = 0; i < 48 * 48; i++) {
        map->z[i] = 1e-9 * (sin(0.9 * (double)(i * i % 977)) + sin(0.31 * (double)(i % 48)));
    }
    snprintf(map->channel, sizeof map->channel, "Height");
    for (int k = 0; k < 2; k++) {
        check_ok(haft_map_write(map, scratch_path(&folder, names[k], path), &error), error);
    }
    haft_map_destroy(&map);
}

/* A sweep over some keys of a case: each variant is a case of its own, and reads back too. */
static void check_variants(draft *d, char *text) {
    static const char *const keys[] = {"seed", "contact.poisson_ratio", "law.unfit",
                                       "surface.kernel_tolerance", "output.curves"};
    static const char *const values[] = {"[1, 2]", "[0.2, 25 %]", "[table, stop]", "[1e-4, 1e-5]",
                                         "[all, needed]"};
    haft_error error = {0};
    char path[400], sweep[400] = "sweep:\n";
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
        bool taken = k == 0 || draw(d, 2);
        if (taken) {
            put(d, keys[k], "");
            sprintf(sweep + strlen(sweep), "  %s: %s\n", keys[k], values[k]);
        }
    }
    text[0] = '\0';
    write_section(d, text, "", 0);
    strcat(text, sweep);
    write_file(scratch_path(&folder, "sweep.yaml", path), text, strlen(text));
    for (size_t v = 0; v < 2; v++) {
        haft_case *c = NULL;
        check_ok(haft_case_read_variant(&c, path, v, &error), error);
        check_round(c);
        haft_case_destroy(&c);
    }
}

static void random_cases_read_back(void **state) {
    (void)state;
    tally *t = calloc(1, sizeof *t);
    draft *d = calloc(1, sizeof *d);
    char path[400], *text = calloc(1, TEXT_MOST);
    assert_true(t != NULL && d != NULL && text != NULL);
    folder = scratch_create();
    write_inputs();
    size_t valid = 0;
    haft_error error = {0};
    for (size_t i = 0; i < CASES; i++) {
        haft_case *c = NULL;
        d->state = i + 1;
        draw_case(d);
        text[0] = '\0';
        write_section(d, text, "", 0);
        write_file(scratch_path(&folder, "case.yaml", path), text, strlen(text));
        if (haft_case_read(&c, path, &error) != HAFT_OK) {
            continue; /* some random numbers do not hang together */
        }
        valid++;
        count(t, d, c);
        check_round(c);
        haft_case_destroy(&c);
        if (i % 4 == 0) {
            check_variants(d, text);
        }
    }
    print_message("%zu of %d random cases were valid\n", valid, CASES);
    assert_true(valid > CASES / 2);
    check_tally(t);
    scratch_remove(&folder);
    free(t);
    free(d);
    free(text);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(random_cases_read_back)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
