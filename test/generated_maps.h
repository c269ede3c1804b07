/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Maps of a known PSD as instruments would give them: tilted, noisy, quantised, band-limited,
 * dilated by a tip, with holes; and how often PSD and fit find what was put in inside their 95 %
 * intervals. */
#ifndef HAFT_TEST_GENERATED_MAPS_H
#define HAFT_TEST_GENERATED_MAPS_H

#include "check.h"

#include "haft/surface_map.h"

#include <gsl/gsl_cdf.h>

enum { MAP_SIDE = 256, MAP_PIXELS = MAP_SIDE * MAP_SIDE, MAP_RINGS_MOST = 200 };
static const double MAP_STEP = 10e-9;

/* What is done to a map. */
typedef enum map_harm {
    MAP_TILTED,
    MAP_NOISY,
    MAP_QUANTISED,
    MAP_BAND_LIMITED,
    MAP_DILATED,
    MAP_HOLES_PIXELS,
    MAP_HOLES_BLOBS,
    MAP_HOLES_LINES,
    MAP_HARMS
} map_harm;

static const char *const map_harm_names[MAP_HARMS] = {
    "tilted",  "noisy",         "quantised",    "band-limited",
    "dilated", "holes, pixels", "holes, blobs", "holes, lines"};

/* Hurst exponent 0.8, s over five decades. */
static haft_psd map_psd(double zeta_0, double zeta_max) {
    double s_0 = 6e-33 * pow(15e6 / zeta_0, 2);
    return (haft_psd){zeta_max, zeta_0, s_0, s_0 * pow(zeta_max / zeta_0, -3.6)};
}

typedef struct map_maker {
    haft_psd psd;
    haft_surface_plan *plan;
    haft_surface_work *work;
} map_maker;

static inline map_maker map_maker_open(haft_psd psd) {
    map_maker m = {.psd = psd};
    haft_error error = {0};
    haft_surface_spec spec = {.psd = psd,
                              .grid_step = MAP_STEP,
                              .rows = MAP_SIDE,
                              .columns = MAP_SIDE,
                              .tolerance = 1e-5,
                              .key = {24, HAFT_RANDOM_TEST}};
    check_ok(haft_surface_plan_create(&m.plan, &spec, &error), error);
    check_ok(haft_surface_work_create(&m.work, m.plan, &error), error);
    return m;
}

static inline void map_maker_close(map_maker *m) {
    haft_surface_work_destroy(&m->work);
    haft_surface_plan_destroy(&m->plan);
}

static inline haft_map *map_draw(const map_maker *m, uint64_t stream) {
    haft_error error = {0};
    haft_map *map = NULL;
    check_ok(haft_map_create(&map, MAP_SIDE, MAP_SIDE, MAP_STEP, MAP_STEP, &error), error);
    check_ok(haft_surface_prepare(m->work, 0, stream, 0, &error), error);
    check_ok(haft_surface_rows(m->work, 0, MAP_SIDE, map->z, &error), error);
    return map;
}

static inline double map_uniform(uint64_t stream, uint64_t draw) {
    uint64_t words[4];
    haft_random_words((haft_random_key){25, HAFT_RANDOM_TEST}, stream, 0, draw, words);
    return haft_random_uniform(words[0]);
}

/* Makes about this share of the pixels missing: single pixels, discs of 5 pixels' radius, or
 * lines. */
static inline void map_pierce(haft_map *map, map_harm kind, double share, uint64_t stream) {
    size_t missing = 0, wanted = (size_t)(share * MAP_PIXELS);
    for (uint64_t draw = 0; missing < wanted; draw++) {
        long at = (long)(map_uniform(stream, draw) * MAP_PIXELS), i = at / MAP_SIDE,
             j = at % MAP_SIDE;
        long reach = kind == MAP_HOLES_BLOBS ? 5 : 0;
        long along = kind == MAP_HOLES_LINES ? MAP_SIDE : reach;
        for (long a = -reach; a <= reach; a++) {
            for (long b = -along; b <= along; b++) {
                bool inside = i + a >= 0 && i + a < MAP_SIDE && j + b >= 0 && j + b < MAP_SIDE;
                if (inside && (along > reach || a * a + b * b <= reach * reach + 1)) {
                    double *z = map->z + (i + a) * MAP_SIDE + j + b;
                    missing += !isnan(*z);
                    *z = NAN;
                }
            }
        }
    }
}

/* The lower envelope of a paraboloid's places: what a blunt tip sees. */
static inline void map_dilate(haft_map *map, double radius) {
    enum { REACH = 5 };
    haft_error error = {0};
    haft_map *sharp = NULL;
    check_ok(haft_map_copy(&sharp, map, &error), error);
    for (long i = 0; i < MAP_SIDE; i++) {
        for (long j = 0; j < MAP_SIDE; j++) {
            double most = -INFINITY;
            for (long a = -REACH; a <= REACH; a++) {
                for (long b = -REACH; b <= REACH; b++) {
                    long k = i + a, l = j + b;
                    if (k >= 0 && k < MAP_SIDE && l >= 0 && l < MAP_SIDE) {
                        double d = MAP_STEP * MAP_STEP * (double)(a * a + b * b) / (2 * radius);
                        most = fmax(most, sharp->z[k * MAP_SIDE + l] - d);
                    }
                }
            }
            map->z[i * MAP_SIDE + j] = most;
        }
    }
    haft_map_destroy(&sharp);
}

static const double MAP_NOISE = 0.5e-9, MAP_QUANTUM = 2e-9, MAP_TIP = 40e-9;

static inline void map_harm_it(haft_map *map, map_harm harm, uint64_t stream) {
    double noise[4];
    if (harm == MAP_DILATED) {
        map_dilate(map, MAP_TIP);
    }
    for (size_t k = 0; k < MAP_PIXELS; k++) { /* every sample is tilted */
        map->z[k] += MAP_STEP * (0.003 * (double)(k % MAP_SIDE) - 0.002 * (double)(k / MAP_SIDE));
        if (harm == MAP_NOISY) {
            haft_random_normals((haft_random_key){26, HAFT_RANDOM_TEST}, stream, k, 0, 1, noise);
            map->z[k] += MAP_NOISE * noise[0];
        } else if (harm == MAP_QUANTISED) {
            map->z[k] = MAP_QUANTUM * round(map->z[k] / MAP_QUANTUM);
        } else if (harm == MAP_BAND_LIMITED) {
            map->z[k] = (double)(float)(map->z[k] * 1e9) * 1e-9;
        }
    }
    if (harm >= MAP_HOLES_PIXELS) {
        map_pierce(map, harm, 0.06, stream);
    }
}

/* How often what was put in was found. */
typedef struct map_coverage {
    size_t draws, fits;   /* maps, and those that gave a fit */
    size_t inside[4];     /* s_0, zeta_0, H and rms, of the fits */
    size_t rings, within; /* rings of all maps, and those whose interval holds the truth */
    double limit;         /* mean upper end of the fit */
} map_coverage;

/* What the map's white noise adds to s. */
static inline double map_white(map_harm harm) {
    double variance = harm == MAP_NOISY       ? MAP_NOISE * MAP_NOISE
                      : harm == MAP_QUANTISED ? MAP_QUANTUM * MAP_QUANTUM / 12
                                              : 0;
    return variance * pow(MAP_STEP / (2 * M_PI), 2);
}

static inline void map_count(map_coverage *c, const haft_psd_table *table, const haft_psd_fit *fit,
                             const haft_psd *psd, map_harm harm) {
    const double truth[4] = {psd->s_0, psd->zeta_0, 0.8, 0};
    haft_psd as_far = *psd;
    as_far.zeta_max = fit->psd.zeta_max;
    as_far.s_1 = haft_psd_value(psd, fmin(as_far.zeta_max, psd->zeta_max));
    as_far.s_1 = as_far.s_1 > 0 ? as_far.s_1 : psd->s_1;
    double rms = sqrt(haft_psd_get_moments(&as_far).m0);
    for (int k = 0; k < 3; k++) {
        c->inside[k] += fit->low[k] <= truth[k] && truth[k] <= fit->high[k];
    }
    c->inside[3] += fit->rms[1] <= rms && rms <= fit->rms[2];
    c->limit += fit->psd.zeta_max;
    for (size_t i = 0; i < table->n; i++) {
        double zeta = table->zeta[i], shape = table->count[i];
        if (zeta >= fit->from && zeta <= fmin(fit->to, 0.97 * psd->zeta_max)) {
            double ratio = table->s[i] / (haft_psd_value(psd, zeta) + map_white(harm));
            double p = gsl_cdf_gamma_P(shape * ratio, shape, 1);
            c->rings++;
            c->within += p > 0.025 && p < 0.975;
        }
    }
}

/* Draws maps of one kind, fits each. */
static inline map_coverage map_cover(map_harm harm, size_t draws) {
    double nyquist = M_PI / MAP_STEP * (1 - 1e-9);
    map_maker m = map_maker_open(map_psd(harm == MAP_DILATED ? 15e6 : 20e6,
                                         harm == MAP_BAND_LIMITED ? 0.55 * nyquist : nyquist));
    map_coverage c = {.draws = draws};
    for (size_t k = 0; k < draws; k++) {
        haft_error error = {0};
        haft_psd_table *table = NULL;
        haft_psd_fit fit;
        haft_map *map = map_draw(&m, k);
        map_harm_it(map, harm, k);
        const haft_map *const maps[] = {map};
        check_ok(haft_map_level(map, HAFT_LEVEL_PLANE, &error), error);
        check_ok(haft_psd_estimate(&table, 1, maps, HAFT_WINDOW_HANN, &error), error);
        if (harm == MAP_DILATED) {
            check_ok(haft_psd_table_cut(table, haft_psd_tip_limit(table, MAP_TIP), &error), error);
        }
        haft_status status = haft_psd_fit_self_affine(&fit, table, &error);
        if (status == HAFT_OK) {
            c.fits++;
            map_count(&c, table, &fit, &m.psd, harm);
        } else {
            print_message("%s, map %zu: %s\n", map_harm_names[harm], k, error.message);
        }
        haft_psd_table_destroy(&table);
        haft_map_destroy(&map);
    }
    c.limit /= (double)c.fits;
    map_maker_close(&m);
    return c;
}

/* Fails where fewer are inside than a true 95 % would leave in 1 of 10000 trials. */
static inline void map_check_coverage(const map_coverage *c, map_harm harm) {
    static const char *const names[] = {"s_0", "zeta_0", "H", "rms"};
    size_t least = c->draws;
    while (least > 0 && gsl_cdf_binomial_P((unsigned)least - 1, 0.95, (unsigned)c->draws) > 1e-4) {
        least--;
    }
    print_message("%-14s %zu of %zu fits, up to %.0f rad/um; inside: s_0 %zu, zeta_0 %zu, H %zu, "
                  "rms %zu (least %zu); rings %.1f %% of %zu\n",
                  map_harm_names[harm], c->fits, c->draws, c->limit * 1e-6, c->inside[0],
                  c->inside[1], c->inside[2], c->inside[3], least,
                  100.0 * (double)c->within / (double)c->rings, c->rings);
    assert_int_equal(c->fits, c->draws);
    for (int k = 0; k < 4; k++) {
        if (c->inside[k] < least) {
            fail_msg("%s: %s inside its 95 %% interval in %zu of %zu draws", map_harm_names[harm],
                     names[k], c->inside[k], c->draws);
        }
    }
    /* neighbouring rings depend on each other, so a tenth as many count */
    double error = sqrt(0.95 * 0.05 / (0.1 * (double)c->rings));
    check_less(0.95 - 4 * error, (double)c->within / (double)c->rings);
}

#endif
