/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dispersion forces across the gap, as a case has them: what their law is, what they leave of the
 * van der Waals forces of contact, and the far field of the surface, which is made once with the
 * case, for all beams and threads.
 *
 * One far field stands for the surface, not one a patch: what pulls from afar are the many points
 * of middling height, which hardly differ from patch to patch. */
#include "case.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>

/* Heights that stand for a marginal; quantiles that stand for either of two faces, of which all
 * sums are taken; bins they are counted in. */
enum { QUANTILES = 32768, FACE_QUANTILES = 512, BINS = 1000 };

/* A far field that misses the greatest pressure by more is none. */
#define ERROR_MOST 1e-3

double haft_case_film(const haft_case *c) {
    haft_adsorption silica = haft_adsorption_silica();
    const haft_adsorption *film =
        c->contact.adsorbed == HAFT_ADSORBED_TABLE ? &c->contact.film : &silica;
    bool any = c->contact.has_capillary && c->contact.adsorbed != HAFT_ADSORBED_NONE;
    return any ? haft_adsorption_thickness(film, c->contact.capillary.humidity) : 0;
}

haft_status haft_case_dispersion(haft_dispersion *out, const haft_case *c, haft_error *error) {
    double given = c->contact.dispersion.hamaker, oxide = c->contact.dispersion.oxide_thickness;
    *out = (haft_dispersion){.substrate = given > 0 ? given : c->contact.vdw.hamaker_dry,
                             .oxide = c->contact.dispersion.oxide_hamaker,
                             .oxide_thickness = {oxide, oxide},
                             .retardation = c->contact.dispersion.retardation,
                             .cut_off = c->contact.dispersion.cut_off};
    if (haft_case_physics(c).capillary) {
        haft_capillary capillary = {0};
        HAFT_TRY(haft_capillary_from_spec(&capillary, &c->contact.capillary, error));
        double filled = capillary.range + 2 * haft_case_film(c);
        if (filled > HAFT_DISPERSION_LENGTH_MOST) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "menisci fill all gaps up to %.4g nm, and a cut-off is %g nm at "
                                  "most; leave contact.dispersion out at this humidity",
                                  filled * 1e9, HAFT_DISPERSION_LENGTH_MOST * 1e9);
        }
        out->cut_off = fmax(out->cut_off, filled);
    }
    return haft_dispersion_check(out, error);
}

haft_status haft_case_vdw(haft_vdw *out, const haft_case *c, haft_error *error) {
    haft_physics physics = haft_case_physics(c);
    haft_vdw_spec spec = {.hamaker = physics.humid ? c->contact.vdw.hamaker_humid
                                                   : c->contact.vdw.hamaker_dry,
                          .r0 = c->contact.vdw.r0};
    HAFT_TRY(haft_vdw_from_spec(out, &spec, error));
    if (!c->contact.has_dispersion || physics.capillary) {
        return HAFT_OK;
    }
    haft_dispersion law;
    HAFT_TRY(haft_case_dispersion(&law, c, error));
    return haft_vdw_leave_tail(out, &law, error);
}

/* ---- heights ---- */

static haft_status count_marginal(haft_height_bins **out, const haft_marginal *marginal, double rms,
                                  haft_error *error) {
    double *z = haft_memory_alloc(QUANTILES, sizeof *z, error);
    if (z == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    for (size_t i = 0; i < QUANTILES; i++) {
        double g = gsl_cdf_ugaussian_Pinv(((double)i + 0.5) / QUANTILES);
        z[i] = rms * haft_marginal_value(marginal, g);
    }
    haft_status status = haft_height_bins_create(out, z, QUANTILES, BINS, error);
    haft_memory_free(z);
    return status;
}

/* All heights of a face's maps, with nothing for missing pixels. */
static haft_status gather(double **out, size_t *n, const haft_map_set *set, haft_error *error) {
    size_t all = 0, kept = 0;
    for (size_t k = 0; k < set->count; k++) {
        all += set->map[k]->rows * set->map[k]->columns;
    }
    double *z = *out = haft_memory_alloc(all, sizeof *z, error);
    if (z == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    for (size_t k = 0; k < set->count; k++) {
        const haft_map *map = set->map[k];
        for (size_t i = 0; i < map->rows * map->columns; i++) {
            if (isfinite(map->z[i])) {
                z[kept++] = map->z[i];
            }
        }
    }
    *n = kept;
    return HAFT_OK;
}

static int by_height(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* FACE_QUANTILES of n heights, in place of their first. */
static void take_quantiles(double *z, size_t n) {
    qsort(z, n, sizeof *z, by_height);
    for (size_t i = 0; i < FACE_QUANTILES && n > FACE_QUANTILES; i++) {
        z[i] = z[(2 * i + 1) * n / (2 * FACE_QUANTILES)];
    }
}

/* Windows of both faces meet at random places: all sums of their heights are as likely. */
static haft_status count_sums(haft_height_bins **out, double *a, size_t n, double *b, size_t m,
                              haft_error *error) {
    take_quantiles(a, n);
    take_quantiles(b, m);
    n = n < FACE_QUANTILES ? n : FACE_QUANTILES;
    m = m < FACE_QUANTILES ? m : FACE_QUANTILES;
    double *sum = haft_memory_alloc(n * m, sizeof *sum, error);
    if (sum == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    for (size_t i = 0; i < n * m; i++) {
        sum[i] = a[i / m] + b[i % m];
    }
    haft_status status = haft_height_bins_create(out, sum, n * m, BINS, error);
    haft_memory_free(sum);
    return status;
}

static haft_status count_maps(haft_height_bins **out, const haft_case *c, haft_error *error) {
    double *one = NULL, *other = NULL;
    size_t n = 0, m = 0;
    haft_status status = gather(&one, &n, &c->surface.map, error);
    if (status == HAFT_OK && c->surface.opposite.count > 0) {
        status = gather(&other, &m, &c->surface.opposite, error);
    }
    if (status == HAFT_OK) {
        status = other == NULL ? haft_height_bins_create(out, one, n, BINS, error)
                               : count_sums(out, one, n, other, m, error);
    }
    haft_memory_free(one);
    haft_memory_free(other);
    return status;
}

/* ---- the far field ---- */

/* A law over heights, those of bins or normal ones. */
typedef struct faces {
    haft_dispersion law;
    const haft_height_bins *bins; /* NULL: normal */
    double rms;
} faces;

static haft_dispersion_value average(const void *context, double distance) {
    const faces *f = context;
    return f->bins != NULL ? haft_dispersion_average(&f->law, f->bins, distance)
                           : haft_dispersion_gaussian(&f->law, f->rms, distance);
}

/* From half the least distance on: a beam is not pressed nearer than its laws are known, and where
 * it is, the tangent goes on. */
static haft_status make(haft_far_field *out, const haft_case *c, const faces *f,
                        haft_error *error) {
    HAFT_TRY(haft_far_field_make(out, HAFT_FAR_FIELD_TERMS, 0.5 * c->contact.distance_from,
                                 c->contact.dispersion.reach, average, f, error));
    if (!(out->pressure_error <= ERROR_MOST)) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "the heights have no smooth far field: the polynomial misses its "
            "pressure by %.2g of the greatest, and %g is bearable; give a smaller "
            "reach, or a larger contact.distance.from",
            out->pressure_error, ERROR_MOST);
    }
    return HAFT_OK;
}

haft_status haft_case_make_far_field(haft_case *c, haft_error *error) {
    haft_height_bins *bins = NULL;
    faces f = {.rms = sqrt(haft_case_moments(c).m0)};
    haft_status status = haft_case_dispersion(&f.law, c, error);
    if (status == HAFT_OK && c->surface.source == HAFT_SOURCE_MAPS) {
        status = count_maps(&bins, c, error);
    } else if (status == HAFT_OK && c->surface.distribution != NULL) {
        status = count_marginal(&bins, c->surface.distribution, f.rms, error);
    }
    f.bins = bins;
    haft_far_field *far = status == HAFT_OK ? haft_memory_alloc(1, sizeof *far, error) : NULL;
    if (status == HAFT_OK) {
        status = far == NULL ? HAFT_ERROR_MEMORY : make(far, c, &f, error);
    }
    haft_height_bins_destroy(&bins);
    if (status != HAFT_OK) {
        haft_memory_free(far);
        return status;
    }
    c->contact.far = far;
    return HAFT_OK;
}
