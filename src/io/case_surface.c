/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The surface of a case: a self-affine PSD from its parameters or its roughness, maps of one or
 * both faces, or a PSD by points in a CSV file. The files are read together with the case, so that
 * a case includes its surface. Their contents are part of its digests. */
#include "case.h"

#include <math.h>
#include <string.h>

/* Complains of a key at its position. */
#define WRONG(reader, key, ...)                                                                    \
    haft_case_complain(reader, (reader)->mark[haft_case_find_key(key)], key, __VA_ARGS__)

bool haft_case_has_part(const haft_case *c, const haft_key *key) {
    bool maps = c->surface.maps.count > 0, table = c->surface.psd_file.count > 0;
    switch (key->where) {
    case HAFT_PART_SELF_AFFINE:
        return !maps && !table;
    case HAFT_PART_MAPS:
        return maps;
    case HAFT_PART_FACES:
        return c->surface.opposite_maps.count > 0;
    case HAFT_PART_FILM:
        return c->contact.has_capillary && c->contact.adsorbed != HAFT_ADSORBED_NONE;
    case HAFT_PART_MARGINAL:
        return c->surface.marginal != HAFT_MARGINAL_GAUSSIAN;
    case HAFT_PART_ROUGHNESS:
        return false;
    default:
        return true;
    }
}

haft_psd_moments haft_case_moments(const haft_case *c) {
    return c->surface.table != NULL ? haft_psd_table_get_moments(c->surface.table)
                                    : haft_psd_get_moments(&c->surface.psd);
}

double haft_case_correlation_length(const haft_case *c) {
    return c->surface.table != NULL ? haft_psd_table_get_correlation_length(c->surface.table)
                                    : haft_psd_get_correlation_length(&c->surface.psd);
}

/* ---- a PSD by points ---- */

static haft_status read_psd(haft_psd_table **out, haft_case_files *files, haft_error *error) {
    static const char *const names[] = {"zeta [rad/um]", "s [nm^4]"};
    static const double factors[] = {1e6, 1e-36};
    double *points = NULL;
    size_t n = 0;
    haft_status status = haft_case_read_points(&points, &n, files, names, factors, error);
    HAFT_THEN(status, haft_psd_table_create(out, n, error));
    for (size_t i = 0; status == HAFT_OK && i < n; i++) {
        (*out)->zeta[i] = points[2 * i];
        (*out)->s[i] = points[2 * i + 1];
    }
    haft_memory_free(points);
    if (status == HAFT_OK) {
        status = haft_psd_table_check(*out, error);
        if (status != HAFT_OK) {
            haft_error_prefix(error, "%s: ", files->path[0]);
        }
    }
    return status;
}

/* ---- maps ---- */

static haft_status read_maps(haft_map_set *set, haft_case_files *files, const haft_case *c,
                             haft_error *error) {
    haft_map_options options = {.channel = c->surface.channel,
                                .width = c->surface.map_size[0],
                                .height = c->surface.map_size[1],
                                .unit = c->surface.map_unit,
                                .lateral_unit = c->surface.map_lateral_unit};
    haft_clean_spec clean = {.level = c->surface.level,
                             .outlier_limit = c->surface.outliers,
                             .missing = c->surface.missing};
    for (size_t k = 0; k < files->count; k++) {
        haft_status status =
            haft_map_read(&set->map[k], files->path[k], &options, files->digest[k], error);
        if (status == HAFT_OK) {
            set->count = k + 1;
            status = haft_map_clean(set->map[k], &clean, NULL, error);
            if (status != HAFT_OK) {
                haft_error_prefix(error, "%s: ", files->path[k]);
            }
        }
        if (status != HAFT_OK) {
            return status;
        }
    }
    return HAFT_OK;
}

/* PSD of one face, cut at the largest wavenumber that the tip resolves. */
static haft_status estimate(haft_psd_table **out, const haft_map_set *set, const haft_case *c,
                            haft_error *error) {
    const haft_map *maps[HAFT_FILES_MAX];
    for (size_t k = 0; k < set->count; k++) {
        maps[k] = set->map[k];
    }
    haft_status status = haft_psd_estimate(out, set->count, maps, c->surface.window, error);
    if (status == HAFT_OK && c->surface.tip_radius > 0) {
        status = haft_psd_table_cut(*out, haft_psd_tip_limit(*out, c->surface.tip_radius), error);
    }
    return status;
}

static haft_status combine_faces(haft_case *c, haft_error *error) {
    haft_psd_table *other = NULL, *both = NULL;
    haft_status status = read_maps(&c->surface.opposite, &c->surface.opposite_maps, c, error);
    HAFT_THEN(status, estimate(&other, &c->surface.opposite, c, error));
    HAFT_THEN(status,
              haft_psd_combine(&both, c->surface.table, other, c->surface.coherence, error));
    if (status == HAFT_OK) {
        haft_psd_table_destroy(&c->surface.table);
        c->surface.table = both;
    }
    haft_psd_table_destroy(&other);
    return status;
}

static haft_status load_maps(haft_case *c, haft_error *error) {
    haft_status status = read_maps(&c->surface.map, &c->surface.maps, c, error);
    HAFT_THEN(status, estimate(&c->surface.table, &c->surface.map, c, error));
    if (status == HAFT_OK && c->surface.opposite_maps.count > 0) {
        status = combine_faces(c, error);
    }
    return status;
}

/* Variance of the heights of all maps of a face, each about its mean. */
static double face_variance(const haft_map_set *set) {
    double sum = 0, count = 0;
    for (size_t k = 0; k < set->count; k++) {
        const haft_map *map = set->map[k];
        double mean = 0, n = 0;
        for (size_t i = 0; i < map->rows * map->columns; i++) {
            mean += isnan(map->z[i]) ? 0 : map->z[i];
            n += !isnan(map->z[i]);
        }
        mean /= n;
        for (size_t i = 0; i < map->rows * map->columns; i++) {
            sum += isnan(map->z[i]) ? 0 : (map->z[i] - mean) * (map->z[i] - mean);
        }
        count += n;
    }
    return count > 0 ? sum / count : 0;
}

/* The rms of the combined heights, sigma^2 = s1 + s2 + 2 coherence sqrt(s1 s2), where s1 and s2 are
 * the variances of the faces. This assumes PSDs that are proportional to each other. */
static double measured_rms(const haft_case *c) {
    double first = face_variance(&c->surface.map), second = face_variance(&c->surface.opposite);
    return sqrt(fmax(0, first + second + 2 * c->surface.coherence * sqrt(first * second)));
}

/* Fits the self-affine form to the whole table, and cuts it only afterwards at the case's zeta_max.
 * So a resolved case, whose zeta_max is the limit found by the fit, gets the same form. */
static haft_status settle_fit(haft_case *c, haft_error *error) {
    double cut = c->surface.psd.zeta_max;
    HAFT_TRY(haft_psd_fit_self_affine(&c->surface.fit, c->surface.table, error));
    haft_psd *psd = &c->surface.psd;
    c->surface.fitted = true;
    c->surface.map_rms = measured_rms(c);
    haft_psd_table_destroy(&c->surface.table);
    *psd = c->surface.fit.psd;
    if (cut > 0 && cut < psd->zeta_max) {
        psd->s_1 = haft_psd_value(psd, cut);
        psd->zeta_max = cut;
    }
    return haft_psd_check(psd, error);
}

/* Sets the PSD from the table: its end points after the cut, or its fit. */
static haft_status settle_psd(haft_case *c, haft_error *error) {
    double cut = c->surface.psd.zeta_max;
    haft_psd_table *t = c->surface.table;
    if (c->surface.maps.count > 0 && c->surface.use == HAFT_PSD_FIT) {
        return settle_fit(c, error);
    }
    haft_status status = cut > 0 ? haft_psd_table_cut(t, cut, error) : HAFT_OK;
    if (status == HAFT_OK) {
        c->surface.psd = (haft_psd){.zeta_max = t->zeta[t->n - 1],
                                    .zeta_0 = t->zeta[0],
                                    .s_0 = t->s[0],
                                    .s_1 = t->s[t->n - 1]};
    }
    return status;
}

/* ---- the marginal ---- */

/* Collects the heights of all maps of the first face. */
static haft_status gather_heights(double **z, size_t *n, const haft_case *c, haft_error *error) {
    const haft_map_set *set = &c->surface.map;
    *n = 0;
    for (size_t k = 0; k < set->count; k++) {
        *n += set->map[k]->rows * set->map[k]->columns;
    }
    *z = haft_memory_alloc(*n, sizeof **z, error);
    size_t at = 0;
    for (size_t k = 0; *z != NULL && k < set->count; k++) {
        size_t pixels = set->map[k]->rows * set->map[k]->columns;
        memcpy(*z + at, set->map[k]->z, pixels * sizeof **z);
        at += pixels;
    }
    return *z == NULL ? HAFT_ERROR_MEMORY : HAFT_OK;
}

/* Takes skewness and kurtosis from the maps' heights unless the case gives them. */
static void take_shape(haft_case *c, const double *z, size_t n) {
    double count = 0, mean = 0, m2 = 0, m3 = 0, m4 = 0;
    for (size_t i = 0; i < n; i++) {
        mean += isnan(z[i]) ? 0 : z[i];
        count += !isnan(z[i]);
    }
    mean /= count;
    for (size_t i = 0; i < n; i++) {
        double d = isnan(z[i]) ? 0 : z[i] - mean;
        m2 += d * d / count;
        m3 += d * d * d / count;
        m4 += d * d * d * d / count;
    }
    c->surface.skewness = isnan(c->surface.skewness) ? m3 / pow(m2, 1.5) : c->surface.skewness;
    c->surface.kurtosis = isnan(c->surface.kurtosis) ? m4 / (m2 * m2) : c->surface.kurtosis;
}

static haft_status load_marginal(haft_case *c, haft_error *error) {
    double *z = NULL;
    size_t n = 0;
    haft_status status = HAFT_OK;
    if (c->surface.map.count > 0) {
        status = gather_heights(&z, &n, c, error);
    }
    if (status == HAFT_OK && c->surface.marginal == HAFT_MARGINAL_HEIGHTS) {
        status = haft_marginal_from_heights(&c->surface.distribution, n, z, error);
    } else if (status == HAFT_OK) {
        if (n > 0) {
            take_shape(c, z, n);
        }
        status = haft_marginal_johnson(&c->surface.distribution, c->surface.skewness,
                                       c->surface.kurtosis, error);
    }
    haft_memory_free(z);
    return status;
}

/* ---- the whole surface ---- */

/* A PSD without files: zeta_max with one of these triples. */
static const char *const parameter_keys[] = {"surface.zeta_max", "surface.zeta_0", "surface.s_0",
                                             "surface.s_1"};
static const char *const roughness_keys[] = {"surface.zeta_max", "surface.rms",
                                             "surface.correlation_length", "surface.hurst"};
enum { PSD_KEYS = 4 };

/* The first key other than zeta_max that was written, valid or not; NULL if none was. */
static const char *first_written(const haft_case_reader *reader, const char *const *keys) {
    for (size_t k = 1; k < PSD_KEYS; k++) {
        haft_key_state state = reader->state[haft_case_find_key(keys[k])];
        if (state == HAFT_GOOD || state == HAFT_BAD) {
            return keys[k];
        }
    }
    return NULL;
}

/* Requires all keys of a form. @return false after a complaint, now or before */
static bool require(haft_case_reader *reader, const char *const *keys) {
    bool good = true;
    for (size_t k = 0; k < PSD_KEYS; k++) {
        int index = haft_case_find_key(keys[k]);
        if (reader->state[index] == HAFT_DEFAULTED) {
            WRONG(reader, keys[k], "is missing; add \"%s: %s\"", haft_case_leaf(keys[k]),
                  haft_case_keys[index].example);
            reader->state[index] = HAFT_BAD;
        }
        good = good && reader->state[index] != HAFT_BAD;
    }
    return good;
}

/* Rejects all keys of a form except zeta_max, since `beside` already defines the PSD. */
static bool forbid(haft_case_reader *reader, const char *const *keys, const char *beside) {
    bool good = true;
    for (size_t k = 1; k < PSD_KEYS; k++) {
        if (haft_case_is_given(reader, keys[k])) {
            WRONG(reader, keys[k], "is given beside %s, which has it; leave one out", beside);
            good = false;
        } else if (reader->state[haft_case_find_key(keys[k])] == HAFT_BAD) {
            good = false;
        }
    }
    return good;
}

/* Computes the parameters from rms, correlation length and Hurst exponent. If that fails, marks the
 * parameters as invalid, so that no further complaints about them follow. */
static bool resolve_roughness(haft_case_reader *reader) {
    haft_case *c = reader->c;
    haft_error error = {0};
    bool good = require(reader, roughness_keys);
    if (good) {
        c->surface.roughness.zeta_max = c->surface.psd.zeta_max;
        if (haft_psd_from_roughness(&c->surface.psd, &c->surface.roughness, &error) != HAFT_OK) {
            WRONG(reader, "surface.correlation_length", "%s", error.message);
            good = false;
        }
    }
    for (size_t k = 0; k < PSD_KEYS && !good; k++) {
        reader->state[haft_case_find_key(parameter_keys[k])] = HAFT_BAD;
    }
    return good;
}

/* Without maps or a table, requires the keys of exactly one form; with them, rejects both forms. */
static bool check_parameters(haft_case_reader *reader, const char *files) {
    const char *parameter = first_written(reader, parameter_keys);
    const char *roughness = first_written(reader, roughness_keys);
    if (files != NULL) {
        bool zeta_max = reader->state[haft_case_find_key("surface.zeta_max")] != HAFT_BAD;
        bool parameters = forbid(reader, parameter_keys, files);
        return forbid(reader, roughness_keys, files) && parameters && zeta_max;
    }
    if (parameter != NULL && roughness != NULL) {
        WRONG(reader, roughness,
              "is given beside %s: a PSD has either rms, correlation_length and hurst, or zeta_0, "
              "s_0 and s_1; leave one three out",
              parameter);
        for (size_t k = 1; k < PSD_KEYS; k++) {
            reader->state[haft_case_find_key(parameter_keys[k])] = HAFT_BAD;
        }
        return false;
    }
    return roughness != NULL ? resolve_roughness(reader) : require(reader, parameter_keys);
}

/* Rejects values that need something that the case does not have. */
static bool check_choices(haft_case_reader *reader) {
    const haft_case *c = reader->c;
    bool maps = c->surface.maps.count > 0, good = true;
    if (!maps && c->surface.opposite_maps.count > 0) {
        WRONG(reader, "surface.opposite_maps", "needs surface.maps, the first face's");
        good = false;
    }
    if (!maps && c->surface.source == HAFT_SOURCE_MAPS) {
        WRONG(reader, "surface.source", "maps needs surface.maps");
        good = false;
    }
    if (!maps && c->surface.marginal == HAFT_MARGINAL_HEIGHTS) {
        WRONG(reader, "surface.marginal", "heights needs surface.maps, whose heights are meant");
        good = false;
    }
    bool shaped = isfinite(c->surface.skewness) && isfinite(c->surface.kurtosis);
    if (!maps && c->surface.marginal == HAFT_MARGINAL_JOHNSON && !shaped) {
        WRONG(reader, "surface.marginal",
              "johnson needs surface.skewness and surface.kurtosis, or surface.maps");
        good = false;
    }
    if (c->surface.source == HAFT_SOURCE_MAPS && c->law.sampler == HAFT_SAMPLER_EXPLICIT) {
        WRONG(reader, "surface.source",
              "maps gives independent patches, no seamless beam; set law.sampler: patches, or a "
              "stochastic one");
        good = false;
    }
    return good;
}

/* @return false after a complaint about the surface itself */
static bool load_surface(haft_case_reader *reader) {
    haft_case *c = reader->c;
    bool maps = haft_case_is_given(reader, "surface.maps");
    bool table = haft_case_is_given(reader, "surface.psd");
    if (maps && table) {
        WRONG(reader, "surface.psd", "is given beside surface.maps; leave one out");
        return false;
    }
    if (reader->section_mark[haft_case_find_section("surface")].line == 0 ||
        !haft_case_is_sound(reader, "surface.maps") || !haft_case_is_sound(reader, "surface.psd") ||
        !haft_case_is_sound(reader, "surface.opposite_maps")) {
        return false;
    }
    const char *key = maps ? "surface.maps" : table ? "surface.psd" : NULL;
    bool good = check_parameters(reader, key), chosen = check_choices(reader);
    if (!good || !chosen) {
        return good && key == NULL; /* parameters can be checked all the same */
    }
    haft_error error = {0};
    haft_status status = HAFT_OK;
    if (key != NULL) {
        status =
            maps ? load_maps(c, &error) : read_psd(&c->surface.table, &c->surface.psd_file, &error);
        status = status == HAFT_OK ? settle_psd(c, &error) : status;
    }
    if (status == HAFT_OK && c->surface.marginal != HAFT_MARGINAL_GAUSSIAN) {
        key = key == NULL ? "surface.marginal" : key;
        status = load_marginal(c, &error);
    }
    if (status != HAFT_OK) {
        WRONG(reader, key, "%.460s", error.message);
    }
    return status == HAFT_OK || !(maps || table);
}

void haft_case_load_surface(haft_case_reader *reader) {
    haft_key_state maps = reader->state[haft_case_find_key("surface.maps")];
    haft_key_state table = reader->state[haft_case_find_key("surface.psd")];
    bool files = maps == HAFT_GOOD || maps == HAFT_BAD || table == HAFT_GOOD || table == HAFT_BAD;
    if (!load_surface(reader) && files) { /* without a PSD its parameters cannot be checked */
        for (size_t k = 0; k < PSD_KEYS; k++) {
            reader->state[haft_case_find_key(parameter_keys[k])] = HAFT_BAD;
        }
    }
}
