/* SPDX-License-Identifier: GPL-3.0-or-later */
/* haft init: reads its options, and prints what was assumed of the new case. */
#include "init.h"

#include <math.h>
#include <string.h>

enum { BEAMS_STANDARD = 50, SIDES = 3, SIDE_CAPACITY = 100 };

/* Defaults of the options. */
static const char BEAM_STANDARD[] = "300 um x 20 um x 2 um", GAP_STANDARD[] = "2 um",
                  HUMIDITY_STANDARD[] = "50 %";

/* Shortest wave without --zeta-max: a tenth of the correlation length. */
static const double WAVES_A_LENGTH = 10;

enum {
    KEY_MAP = 512,
    KEY_OPPOSITE_MAP,
    KEY_CHANNEL,
    KEY_LEVEL,
    KEY_WINDOW,
    KEY_MISSING,
    KEY_OUTLIERS,
    KEY_SIZE,
    KEY_UNIT,
    KEY_LATERAL_UNIT,
    KEY_TIP_RADIUS,
    KEY_RMS,
    KEY_CORRELATION_LENGTH,
    KEY_HURST,
    KEY_ZETA_MAX,
    KEY_BEAM,
    KEY_GAP,
    KEY_HUMIDITY,
};

static const struct argp_option options[] = {
    {0, 0, 0, 0, "Of init, the surface:", 1},
    {"map", KEY_MAP, "FILE", 0, "a height map; again for more of the same face", 1},
    {"opposite-map", KEY_OPPOSITE_MAP, "FILE", 0, "one of the other face, if it is rough too", 1},
    {"channel", KEY_CHANNEL, "NAME", 0, "of the maps' files (default: the first of heights)", 1},
    {"size", KEY_SIZE, "WxH", 0, "of bare matrices, as \"10 um x 10 um\"", 1},
    {"unit", KEY_UNIT, "UNIT", 0, "of heights, where the file says none", 1},
    {"lateral-unit", KEY_LATERAL_UNIT, "UNIT", 0, "of columns x and y", 1},
    {"level", KEY_LEVEL, "HOW", 0, "mean, plane (default), quadratic or lines", 1},
    {"missing", KEY_MISSING, "HOW", 0, "exclude (default) or fill missing pixels", 1},
    {"outliers", KEY_OUTLIERS, "N", 0, "mask what is N deviations off the median", 1},
    {"window", KEY_WINDOW, "WHICH", 0, "none, hann (default), welch, blackman, tukey", 1},
    {"tip-radius", KEY_TIP_RADIUS, "LENGTH", 0, "cut where such a tip cannot be trusted", 1},
    {"rms", KEY_RMS, "LENGTH", 0, "instead of a map, with the next two", 1},
    {"correlation-length", KEY_CORRELATION_LENGTH, "LENGTH", 0,
     "where the autocorrelation falls to 1/e", 1},
    {"hurst", KEY_HURST, "H", 0, "the Hurst exponent, above 0 and at most 1", 1},
    {"zeta-max", KEY_ZETA_MAX, "NUMBER", 0,
     "of the shortest wave (default: 2 pi over a tenth of the correlation length)", 1},
    {0, 0, 0, 0, "Of init, the beam:", 2},
    {"beam", KEY_BEAM, "LxWxT", 0,
     "length, width and thickness (default \"300 um x 20 um x 2 um\")", 2},
    {"gap", KEY_GAP, "LENGTH", 0, "under it (default 2 um)", 2},
    {"humidity", KEY_HUMIDITY, "SHARE", 0, "of the air (default \"50 %\")", 2},
    {0, 0, 0, 0, "Of all commands:", -1},
    {0}};

static error_t parse(int key, char *value, struct argp_state *state) {
    init_words *w = state->input;
    if (key < KEY_MAP || key > KEY_HUMIDITY) {
        return ARGP_ERR_UNKNOWN;
    }
    w->any = true;
    if (key <= KEY_OPPOSITE_MAP) {
        size_t *n = key == KEY_MAP ? &w->maps : &w->opposite_maps;
        if (*n == HAFT_FILES_MAX) {
            terminal_misuse(state, "%d maps of a face at most; \"%s\" is too much", HAFT_FILES_MAX,
                            value);
        }
        (key == KEY_MAP ? w->map : w->opposite_map)[(*n)++] = value;
        return 0;
    }
    const char **const words[] = {&w->read.channel,
                                  &w->read.level,
                                  &w->read.window,
                                  &w->read.missing,
                                  &w->read.outliers,
                                  &w->read.size,
                                  &w->read.unit,
                                  &w->read.lateral_unit,
                                  &w->read.tip_radius,
                                  &w->rms,
                                  &w->correlation_length,
                                  &w->hurst,
                                  &w->zeta_max,
                                  &w->beam,
                                  &w->gap,
                                  &w->humidity};
    *words[key - KEY_CHANNEL] = value;
    return 0;
}

const struct argp init_options = {options, parse, NULL, NULL, NULL, NULL, NULL};

/* ---- understanding the options ---- */

static haft_status read_quantity(double *value, const haft_units *units, const char *option,
                                 const char *text, const char *unit, const char *example,
                                 haft_error *error) {
    haft_error own = {0};
    haft_status status = haft_units_parse(units, text, unit, value, &own);
    if (status == HAFT_ERROR_MEMORY) {
        return haft_error_set(error, status, "%s", own.message);
    }
    if (status != HAFT_OK || !(*value > 0)) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT, "--%s \"%.80s\" cannot be used%s%s; give it as \"%s\"", option,
            text, status != HAFT_OK ? ": " : ", it is not positive", own.message, example);
    }
    return HAFT_OK;
}

/* Reads "300 um x 20 um x 2 um". */
static haft_status read_beam(init_plan *p, const haft_units *units, const char *text,
                             haft_error *error) {
    double *const side[SIDES] = {&p->length, &p->width, &p->thickness};
    const char *at = text;
    for (int k = 0; k < SIDES; k++) {
        const char *cross = k + 1 < SIDES ? strchr(at, 'x') : at + strlen(at);
        char one[SIDE_CAPACITY] = "";
        if (cross == NULL || (size_t)(cross - at) >= sizeof one) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "--beam \"%.80s\" is no length, width and thickness; give it as "
                                  "\"%s\"",
                                  text, BEAM_STANDARD);
        }
        at += strspn(at, " ");
        memcpy(one, at, cross > at ? (size_t)(cross - at) : 0);
        for (size_t n = strlen(one); n > 0 && one[n - 1] == ' '; n--) {
            one[n - 1] = '\0';
        }
        HAFT_TRY(read_quantity(side[k], units, "beam", one, "m", BEAM_STANDARD, error));
        at = cross + 1;
    }
    if (p->thickness >= p->length || p->width >= p->length) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "--beam \"%.80s\" is no beam: give its length first, then its width "
                              "and its thickness, both less",
                              text);
    }
    return HAFT_OK;
}

static haft_status read_humidity(init_plan *p, const haft_units *units, const char *text,
                                 haft_error *error) {
    haft_error own = {0};
    haft_status status = haft_units_parse(units, text, "1", &p->humidity, &own);
    if (status == HAFT_ERROR_MEMORY) {
        return haft_error_set(error, status, "%s", own.message);
    }
    if (status != HAFT_OK || !(p->humidity >= 0 && p->humidity < 1)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "--humidity \"%.80s\" is no humidity of 0 %% or more and less than "
                              "100 %%; give it as \"%s\"",
                              text, HUMIDITY_STANDARD);
    }
    return HAFT_OK;
}

/* Reads rms, correlation length and Hurst exponent: all three or none. */
static haft_status read_roughness(init_plan *p, const haft_units *units, haft_error *error) {
    const init_words *w = p->words;
    bool all = w->rms != NULL && w->correlation_length != NULL && w->hurst != NULL;
    bool any = w->rms != NULL || w->correlation_length != NULL || w->hurst != NULL;
    if ((w->maps > 0) == any || (w->maps == 0 && w->opposite_maps > 0)) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            any ? "a surface is of a map or of three numbers; leave out --map, or "
                  "--rms, --correlation-length and --hurst"
                : "init needs a surface; give --map=FILE, or --rms=\"5 nm\" "
                  "--correlation-length=\"200 nm\" --hurst=0.8");
    }
    if (any && !all) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "--rms, --correlation-length and --hurst go together; give %s too",
                              w->rms == NULL                  ? "--rms=\"5 nm\""
                              : w->correlation_length == NULL ? "--correlation-length=\"200 nm\""
                                                              : "--hurst=0.8");
    }
    if (!any) {
        return HAFT_OK;
    }
    haft_roughness *r = &p->roughness;
    haft_status status = read_quantity(&r->rms, units, "rms", w->rms, "m", "5 nm", error);
    HAFT_THEN(status, read_quantity(&r->correlation_length, units, "correlation-length",
                                    w->correlation_length, "m", "200 nm", error));
    HAFT_THEN(status, read_quantity(&r->hurst, units, "hurst", w->hurst, "1", "0.8", error));
    r->zeta_max = 2 * M_PI * WAVES_A_LENGTH / r->correlation_length;
    if (status == HAFT_OK && w->zeta_max != NULL) {
        status = read_quantity(&r->zeta_max, units, "zeta-max", w->zeta_max, "rad/m", "289 rad/um",
                               error);
    }
    return status;
}

haft_status init_understand(init_plan *p, const init_words *words, const char *folder, size_t beams,
                            haft_error *error) {
    haft_units *units = NULL;
    *p = (init_plan){.words = words,
                     .folder = folder,
                     .beams = beams > 0 ? beams : BEAMS_STANDARD,
                     .skewness = NAN,
                     .kurtosis = NAN};
    haft_status status = inspect_read_words(&p->wishes, &words->read, error);
    HAFT_THEN(status, haft_units_create(&units, error));
    HAFT_THEN(status, read_roughness(p, units, error));
    HAFT_THEN(status,
              read_beam(p, units, words->beam != NULL ? words->beam : BEAM_STANDARD, error));
    HAFT_THEN(status,
              read_quantity(&p->gap, units, "gap", words->gap != NULL ? words->gap : GAP_STANDARD,
                            "m", GAP_STANDARD, error));
    HAFT_THEN(status,
              read_humidity(p, units, words->humidity != NULL ? words->humidity : HUMIDITY_STANDARD,
                            error));
    haft_units_destroy(&units);
    return status;
}

/* ---- printing ---- */

static void tell(const init_plan *p, terminal *t) {
    const init_words *w = p->words;
    if (t->quiet) {
        return;
    }
    terminal_print(stdout, "%s/case.yaml: a case that can be used%s", p->folder,
                   w->maps > 0 ? ", with copies of its maps" : "");
    printf("  surface    rms %.4g nm, correlation length %.4g nm, waves up to %.4g rad/um%s\n",
           p->rms * 1e9, p->correlation_length * 1e9, p->zeta_max * 1e-6,
           p->roughness.rms > 0 && w->zeta_max == NULL ? " (assumed: --zeta-max)" : "");
    if (fabs(p->skewness) > 0.2 || fabs(p->kurtosis - 3) > 0.5) {
        printf("             heights taken as normal, though skewness is %.2g and kurtosis %.2g: "
               "\"marginal: heights\" takes the map's\n",
               p->skewness, p->kurtosis);
    }
    printf("  beam       %.6g um x %.6g um x %.4g um%s, gap %.4g um%s, humidity %.4g %%%s\n",
           p->length * 1e6, p->width * 1e6, p->thickness * 1e6,
           w->beam == NULL ? " (assumed: --beam)" : "", p->gap * 1e6,
           w->gap == NULL ? " (assumed: --gap)" : "", p->humidity * 100,
           w->humidity == NULL ? " (assumed: --humidity)" : "");
    printf("  material   polycrystalline silicon, 163 GPa, Poisson's ratio 0.22 (assumed)\n");
    printf("  adhesion   about %.3g mJ/m2, which holds a crack of about %.3g um\n",
           p->adhesion * 1e3, p->expected * 1e6);
    printf(
        "  study      %zu beams, laws of %zu patches of %.4g um x %.4g um on a grid of %.4g nm\n",
        p->beams, p->vectors, p->l_meso * 1e6, p->width * 1e6, p->grid_step * 1e9);
    static const char *const next[] = {"check", "run", "report"};
    printf("next:\n");
    for (size_t k = 0; k < sizeof next / sizeof *next; k++) {
        terminal_print(stdout, "  haft %s %s", next[k], p->folder);
    }
}

int init_case(const init_words *words, const char *folder, size_t beams, terminal *t) {
    init_plan p;
    haft_error error = {0};
    haft_status status = init_understand(&p, words, folder, beams, &error);
    HAFT_THEN(status, init_find_room(folder, &error));
    HAFT_THEN(status, init_choose(&p, &error));
    HAFT_THEN(status, init_save(&p, &error));
    if (status != HAFT_OK) {
        return terminal_fail(t, status, &error);
    }
    tell(&p, t);
    return EXIT_OK;
}
