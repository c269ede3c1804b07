/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The self-affine form fitted to a PSD by points, in the logarithm. With x = log(zeta/zeta_0) above
 * the roll-off and 0 below, log s = a - b x: for a given roll-off the best a and b are those of a
 * weighted line, so that only the roll-off is searched for. The sum of squares over it is smooth
 * but for kinks at the points, and may have several dips: a grid of a twentieth of the spacing
 * comes first, golden section after. */
#include "haft/surface_map.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_sf_psi.h>
#include <math.h>

enum { GRID = 400, SHRINKINGS = 80, POINTS_LEAST = 6 };
static const double CONFIDENCE = 0.95;

/* A point's logarithm without its bias, and its weight. */
static void take_point(const haft_psd_table *table, size_t i, double *value, double *weight) {
    double n = table->count == NULL || table->count[i] <= 0 ? 0 : table->count[i];
    *value = log(table->s[i]);
    *weight = 1;
    if (n > 0) {
        *value -= gsl_sf_psi(n) - log(n);
        *weight = 1 / gsl_sf_psi_1(n);
    }
}

typedef struct line {
    double a, b, square; /* and the weighted sum of squares left */
} line;

static line best_line(const haft_psd_table *table, double log_zeta_0) {
    double w = 0, wx = 0, wy = 0, wxx = 0, wxy = 0;
    for (size_t i = 0; i < table->n; i++) {
        double y, weight, x = fmax(0, log(table->zeta[i]) - log_zeta_0);
        take_point(table, i, &y, &weight);
        w += weight;
        wx += weight * x;
        wy += weight * y;
        wxx += weight * x * x;
        wxy += weight * x * y;
    }
    double spread = wxx - wx * wx / w;
    line l = {.b = -(wxy - wx * wy / w) / spread};
    l.a = (wy + l.b * wx) / w;
    for (size_t i = 0; i < table->n; i++) {
        double y, weight, x = fmax(0, log(table->zeta[i]) - log_zeta_0);
        take_point(table, i, &y, &weight);
        double rest = y - l.a + l.b * x;
        l.square += weight * rest * rest;
    }
    return l;
}

static double find_roll_off(const haft_psd_table *table) {
    /* at least two points on either side */
    double low = log(table->zeta[1]), high = log(table->zeta[table->n - 3]);
    double best = low, least = INFINITY, step = (high - low) / GRID;
    for (int i = 0; i <= GRID; i++) {
        double at = low + step * i, square = best_line(table, at).square;
        if (square < least) {
            least = square;
            best = at;
        }
    }
    double a = fmax(low, best - step), b = fmin(high, best + step), golden = 0.5 * (sqrt(5) - 1);
    for (int i = 0; i < SHRINKINGS; i++) {
        double c = b - golden * (b - a), d = a + golden * (b - a);
        if (best_line(table, c).square < best_line(table, d).square) {
            b = d;
        } else {
            a = c;
        }
    }
    return 0.5 * (a + b);
}

/* Variances of a, log zeta_0 and b from the normal equations, unit weights' variance 1. */
static void variances(const haft_psd_table *table, double log_zeta_0, double b, double out[3]) {
    double m[3][3] = {{0}};
    for (size_t i = 0; i < table->n; i++) {
        double y, weight, x = fmax(0, log(table->zeta[i]) - log_zeta_0);
        take_point(table, i, &y, &weight);
        double slope[3] = {1, x > 0 ? b : 0, -x};
        for (int j = 0; j < 3; j++) {
            for (int k = 0; k < 3; k++) {
                m[j][k] += weight * slope[j] * slope[k];
            }
        }
    }
    for (int j = 0; j < 3; j++) {
        int k = (j + 1) % 3, l = (j + 2) % 3;
        double minor = m[k][k] * m[l][l] - m[k][l] * m[l][k];
        double determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                             m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
        out[j] = minor / determinant;
    }
}

haft_status haft_psd_fit_self_affine(haft_psd_fit *out, const haft_psd_table *table,
                                     haft_error *error) {
    haft_status status = haft_psd_table_check(table, error);
    if (status != HAFT_OK) {
        return status;
    }
    if (table->n < POINTS_LEAST) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "a PSD of %zu points is too short for a fit of three parameters; it "
                              "needs %d",
                              table->n, POINTS_LEAST);
    }
    double log_zeta_0 = find_roll_off(table);
    line l = best_line(table, log_zeta_0);
    double freedom = (double)table->n - 3, zeta_max = table->zeta[table->n - 1];
    if (!(l.b > 0) || !isfinite(l.square)) {
        return haft_error_set(error, HAFT_ERROR_NUMERIC,
                              "the PSD does not fall off: its best slope is %.3g, so the "
                              "self-affine form does not fit; use it as a table",
                              -l.b);
    }
    double variance[3];
    variances(table, log_zeta_0, l.b, variance);
    *out = (haft_psd_fit){.hurst = 0.5 * l.b - 1, .misfit = l.square / freedom};
    out->psd = (haft_psd){.zeta_max = zeta_max, .zeta_0 = exp(log_zeta_0), .s_0 = exp(l.a)};
    out->psd.s_1 = out->psd.s_0 * exp(-l.b * (log(zeta_max) - log_zeta_0));
    double factor = gsl_cdf_tdist_Pinv(0.5 * (1 + CONFIDENCE), freedom);
    factor *= sqrt(fmax(1, out->misfit));
    double half[3] = {factor * sqrt(variance[0]), factor * sqrt(variance[1]),
                      factor * sqrt(variance[2])};
    out->low[0] = out->psd.s_0 * exp(-half[0]);
    out->high[0] = out->psd.s_0 * exp(half[0]);
    out->low[1] = out->psd.zeta_0 * exp(-half[1]);
    out->high[1] = out->psd.zeta_0 * exp(half[1]);
    out->low[2] = out->hurst - 0.5 * half[2];
    out->high[2] = out->hurst + 0.5 * half[2];
    return haft_psd_check(&out->psd, error);
}
