/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The underlying PSD of a translation process, by iteration (Shields, Deodatis and Bocchini 2011).
 * The correlation of q(g) is a power series in that of g, whose coefficients are the squared
 * Hermite coefficients of q (Grigoriu 1984). So one round is PSD of g -> correlation of g ->
 * correlation of q(g) -> PSD of q(g). Then each ring of g's PSD is multiplied by the ratio of
 * wanted to actual ring sum.
 *
 * The computation uses a periodic lattice, fine enough for twice the band and large compared with
 * the longest waves, and cosine transforms of a quarter of the plane. There every step is exact,
 * except that the series is truncated. The iteration adjusts the correction, a smooth factor given
 * by points; the underlying PSD is the wanted one times this factor, with all its corners. Limits:
 * q adds some power beyond the band, which is lost to the band. And where q adds more than the
 * wanted PSD inside the band, no underlying PSD can remove it. Both errors are reported. */
#include "surface/marginal.h"
#include "surface/radial.h"

#include <fftw3.h>
#include <math.h>
#include <string.h>

enum { NODES = 72, ROUNDS = 30, SIDE_LEAST = 256, SIDE_MOST = 2048 };
static const double LENGTHS = 12;  /* number of longest waves in the lattice's period */
static const double STRONGEST = 4; /* largest correction of a ring in a round */
static const double ENOUGH = 1e-3; /* relative error at which the iteration ends */
static const double JUDGED = 0.95; /* share of zeta_max up to which the error is judged */

surface_radial haft_surface_radial(const haft_psd *psd, const haft_psd_table *table) {
    surface_radial radial = {.psd = *psd, .table = table};
    if (table != NULL) {
        size_t last = table->n - 1;
        radial.psd = (haft_psd){.zeta_max = table->zeta[last],
                                .zeta_0 = table->zeta[0],
                                .s_0 = table->s[0],
                                .s_1 = table->s[last]};
    }
    return radial;
}

double haft_surface_radial_value(const surface_radial *radial, double zeta) {
    return radial->table != NULL ? haft_psd_table_value(radial->table, zeta)
                                 : haft_psd_value(&radial->psd, zeta);
}

double haft_surface_radial_variance(const surface_radial *radial) {
    return radial->table != NULL ? haft_psd_table_get_moments(radial->table).m0
                                 : haft_psd_get_moments(&radial->psd).m0;
}

/* A quarter of the plane of the lattice: (half + 1)^2 modes or lags. */
typedef struct lattice {
    size_t half, modes;
    double cell;    /* spacing of wave numbers [rad/m] */
    double *field;  /* transformed in place */
    double *wanted; /* the wanted PSD at each mode, of variance 1 */
    int *ring;      /* ring of each mode, -1 beyond the band */
    double *weight; /* how often each mode occurs in the whole plane */
    fftw_plan plan;
} lattice;

/* Sums over rings of the lattice. */
typedef struct ring_sums {
    double is[NODES], wanted[NODES];
} ring_sums;

static void destroy_lattice(lattice *l) {
    if (l->plan != NULL) {
        fftw_destroy_plan(l->plan);
    }
    haft_memory_free(l->field);
    haft_memory_free(l->ring);
}

static haft_status create_lattice(lattice *l, const surface_radial *wanted, haft_error *error) {
    double step = M_PI / (2 * wanted->psd.zeta_max);
    double length = LENGTHS * 2 * M_PI / wanted->psd.zeta_0;
    size_t side = SIDE_LEAST;
    while (side < SIDE_MOST && (double)side * step < length) {
        side *= 2;
    }
    l->half = side / 2;
    l->modes = (l->half + 1) * (l->half + 1);
    l->cell = 2 * M_PI / ((double)side * step);
    l->field = haft_memory_alloc(l->modes, 3 * sizeof *l->field, error);
    l->ring = haft_memory_alloc(l->modes, sizeof *l->ring, error);
    if (l->field == NULL || l->ring == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    l->wanted = l->field + l->modes;
    l->weight = l->wanted + l->modes;
    int n = (int)l->half + 1;
    l->plan = fftw_plan_r2r_2d(n, n, l->field, l->field, FFTW_REDFT00, FFTW_REDFT00, FFTW_ESTIMATE);
    return l->plan != NULL ? HAFT_OK
                           : haft_error_set(error, HAFT_ERROR_LIBRARY,
                                            "FFTW makes no cosine transform of %d x %d", n, n);
}

/* Sets up the points of the factor, from the longest wave to zeta_max, with the value 1, and
 * assigns each mode to the nearest point. */
static void lay_out(lattice *l, const surface_radial *wanted, haft_psd_table *factor) {
    double low = fmin(l->cell, wanted->psd.zeta_0), high = wanted->psd.zeta_max, sum = 0;
    double per_ratio = (NODES - 1) / log(high / low);
    for (size_t k = 0; k < NODES; k++) {
        factor->zeta[k] = k + 1 < NODES ? low * exp((double)k / per_ratio) : high;
        factor->s[k] = 1;
    }
    for (size_t i = 0; i <= l->half; i++) {
        for (size_t j = 0; j <= l->half; j++) {
            size_t at = i * (l->half + 1) + j;
            double zeta = l->cell * hypot((double)i, (double)j);
            bool inside = zeta <= high;
            double place = zeta > low ? log(zeta / low) * per_ratio : 0;
            l->ring[at] = inside ? (int)fmin(round(place), NODES - 1) : -1;
            l->weight[at] =
                (i == 0 || i == l->half ? 1 : 2) * (double)(j == 0 || j == l->half ? 1 : 2);
            l->wanted[at] = inside ? haft_surface_radial_value(wanted, zeta) : 0;
            sum += l->weight[at] * l->wanted[at];
        }
    }
    for (size_t at = 0; at < l->modes; at++) {
        l->wanted[at] /= sum;
    }
}

/* Writes the PSD of q(g), of variance 1, to l->field. */
static void go_round(lattice *l, const haft_psd_table *factor, const haft_marginal *marginal) {
    double sum = 0;
    for (size_t i = 0; i <= l->half; i++) {
        for (size_t j = 0; j <= l->half; j++) {
            size_t at = i * (l->half + 1) + j;
            double zeta = l->cell * hypot((double)i, (double)j);
            l->field[at] =
                l->ring[at] >= 0 ? l->wanted[at] * haft_psd_table_value(factor, zeta) : 0;
            sum += l->weight[at] * l->field[at];
        }
    }
    for (size_t at = 0; at < l->modes; at++) {
        l->field[at] /= sum;
    }
    fftw_execute(l->plan);
    for (size_t at = 0; at < l->modes; at++) {
        l->field[at] = haft_marginal_correlation(marginal, fmin(1, l->field[at]));
    }
    fftw_execute(l->plan);
    double scale = 1 / (4 * (double)l->half * (double)l->half);
    for (size_t at = 0; at < l->modes; at++) {
        l->field[at] *= scale;
    }
}

/* Ring sums, and the largest relative error of the PSD's shape inside the band; *beyond: share of
 * the variance outside. */
static double judge(const lattice *l, const haft_psd_table *factor, ring_sums *sums,
                    double *beyond) {
    *sums = (ring_sums){.is = {0}};
    double inside = 0, worst = 0;
    for (size_t at = 0; at < l->modes; at++) {
        int k = l->ring[at];
        if (k >= 0) {
            sums->is[k] += l->weight[at] * l->field[at];
            sums->wanted[k] += l->weight[at] * l->wanted[at];
            inside += l->weight[at] * l->field[at];
        }
    }
    *beyond = 1 - inside;
    for (int k = 0; k < NODES; k++) {
        if (sums->wanted[k] > 0) {
            sums->is[k] /= inside;
            double error = fabs(sums->is[k] / sums->wanted[k] - 1);
            worst = factor->zeta[k] < JUDGED * factor->zeta[NODES - 1] ? fmax(worst, error) : worst;
        }
    }
    return worst;
}

/* Multiplies each point by the ratio of wanted to actual ring sum; a ring without modes uses the
 * ratio of the next ring above. */
static void correct(haft_psd_table *factor, const ring_sums *sums) {
    double ratio = 1;
    for (size_t k = NODES; k-- > 0;) {
        if (sums->wanted[k] > 0) {
            double is = fmax(sums->is[k], sums->wanted[k] / STRONGEST);
            ratio = fmax(1 / STRONGEST, sums->wanted[k] / is);
        }
        factor->s[k] *= ratio;
    }
}

/* The wanted PSD times the factor, scaled to the wanted variance. Its points are those of the
 * factor and the corners of the wanted PSD; between them both are power laws. */
static haft_status multiply(haft_psd_table **out, const haft_psd_table *factor,
                            const surface_radial *wanted, haft_error *error) {
    size_t corners = wanted->table != NULL ? wanted->table->n : 1, a = 0, b = 0, n = 0;
    const double *corner = wanted->table != NULL ? wanted->table->zeta : &wanted->psd.zeta_0;
    haft_psd_table *table = NULL;
    HAFT_TRY(haft_psd_table_create(&table, factor->n + corners, error));
    while (a < factor->n || b < corners) {
        double x = a < factor->n ? factor->zeta[a] : INFINITY;
        double y = b < corners ? corner[b] : INFINITY;
        double zeta = fmin(x, y);
        a += x <= y;
        b += y <= x;
        table->zeta[n] = zeta;
        table->s[n++] =
            haft_surface_radial_value(wanted, zeta) * haft_psd_table_value(factor, zeta);
    }
    table->n = n;
    double scale = haft_surface_radial_variance(wanted) / haft_psd_table_get_moments(table).m0;
    for (size_t k = 0; k < n; k++) {
        table->s[k] *= scale;
    }
    *out = table;
    return HAFT_OK;
}

haft_status haft_surface_translate(haft_psd_table **out, const surface_radial *wanted,
                                   const haft_marginal *marginal, haft_surface_facts *facts,
                                   haft_error *error) {
    lattice l = {.plan = NULL};
    double best[NODES], least = INFINITY;
    haft_psd_table *factor = NULL;
    *out = NULL;
    haft_status status = create_lattice(&l, wanted, error);
    HAFT_THEN(status, haft_psd_table_create(&factor, NODES, error));
    if (status == HAFT_OK) {
        lay_out(&l, wanted, factor);
        for (int round = 0; round < ROUNDS && least > ENOUGH; round++) {
            ring_sums sums;
            double beyond;
            go_round(&l, factor, marginal);
            double worst = judge(&l, factor, &sums, &beyond);
            if (worst < least) {
                least = worst;
                memcpy(best, factor->s, sizeof best);
                facts->beyond = fmax(0, beyond);
            }
            correct(factor, &sums);
        }
        memcpy(factor->s, best, sizeof best);
        facts->psd_error = least;
        facts->deviation = sqrt(haft_surface_radial_variance(wanted) / (1 - facts->beyond));
        status = multiply(out, factor, wanted, error);
    }
    destroy_lattice(&l);
    haft_psd_table_destroy(&factor);
    return status;
}
