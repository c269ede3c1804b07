/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Maximum likelihood of the self-affine form over rings. The mean of N exponential numbers is Gamma
 * distributed with shape N, so the deviance of a model m is 2 N (s/m - 1 - log(s/m)) per ring. For
 * a given roll-off, Fisher scoring finds plateau, slope and floor (the floor stays at or above
 * zero). As a function of the roll-off the deviance has kinks and may have several minima, so the
 * roll-off is searched on a grid and then by golden section. Each grid is swept twice, starting
 * without a floor and with a floor near the smallest s, since scoring finds only the nearest
 * minimum. */
#include "psd_likelihood.h"

#include <math.h>

enum { STEPS = 30, SHRINKINGS = 60, HALVINGS = 20 };

double haft_psd_form_power(const haft_psd_form *form, double log_zeta) {
    return exp(form->a - form->b * fmax(0, log_zeta - form->log_zeta_0));
}

double haft_psd_form_value(const haft_psd_form *form, double log_zeta) {
    return haft_psd_form_power(form, log_zeta) + form->floor;
}

double haft_psd_ring_deviance(double s, double count, double model) {
    double d = s / model - 1;
    return 2 * count * (d - log1p(d));
}

static double deviance_of(const haft_psd_form *form, const haft_psd_rings *rings) {
    double sum = 0;
    for (size_t i = 0; i < rings->n; i++) {
        sum += haft_psd_ring_deviance(rings->s[i], rings->count[i],
                                      haft_psd_form_value(form, rings->log_zeta[i]));
    }
    return sum;
}

/* Fisher information of a, b and floor/scale, and the score. */
static void inform(double m[3][3], double score[3], const haft_psd_form *form,
                   const haft_psd_rings *rings) {
    for (int j = 0; j < 3; j++) {
        score[j] = m[j][0] = m[j][1] = m[j][2] = 0;
    }
    for (size_t i = 0; i < rings->n; i++) {
        double power = haft_psd_form_power(form, rings->log_zeta[i]), whole = power + form->floor;
        double x = fmax(0, rings->log_zeta[i] - form->log_zeta_0);
        double slope[3] = {power / whole, -x * power / whole, rings->scale / whole};
        double rest = rings->count[i] * (rings->s[i] / whole - 1);
        for (int j = 0; j < 3; j++) {
            score[j] += rest * slope[j];
            for (int k = 0; k < 3; k++) {
                m[j][k] += rings->count[i] * slope[j] * slope[k];
            }
        }
    }
}

/* Inverse of the leading n x n block, n = 2 or 3, by Cholesky factorization; false if it is
 * singular. */
static bool invert(double out[3][3], double m[3][3], int n) {
    double l[3][3] = {{0}}, inverse[3][3] = {{0}};
    for (int j = 0; j < n; j++) {
        for (int k = 0; k <= j; k++) {
            double rest = m[j][k];
            for (int i = 0; i < k; i++) {
                rest -= l[j][i] * l[k][i];
            }
            if (j == k && !(rest > 1e-13 * m[j][j])) {
                return false;
            }
            l[j][k] = j == k ? sqrt(rest) : rest / l[k][k];
        }
    }
    for (int c = 0; c < n; c++) { /* columns of l^-1 */
        for (int j = c; j < n; j++) {
            double rest = j == c ? 1 : 0;
            for (int i = c; i < j; i++) {
                rest -= l[j][i] * inverse[i][c];
            }
            inverse[j][c] = rest / l[j][j];
        }
    }
    for (int j = 0; j < 3; j++) {
        for (int k = 0; k < 3; k++) {
            out[j][k] = 0;
            for (int i = 0; i < n; i++) {
                out[j][k] += inverse[i][j] * inverse[i][k];
            }
        }
    }
    return true;
}

void haft_psd_form_covariance(const haft_psd_form *form, const haft_psd_rings *rings,
                              double covariance[3][3]) {
    double m[3][3], score[3];
    inform(m, score, form, rings);
    if (!invert(covariance, m, 3) && !invert(covariance, m, 2)) {
        covariance[0][0] = covariance[1][1] = covariance[2][2] = INFINITY;
    }
    for (int j = 0; j < 3; j++) {
        covariance[2][j] *= rings->scale;
        covariance[j][2] *= rings->scale;
    }
}

/* One step of Fisher scoring, halved until the deviance does not rise; false if none helps. */
static bool step(haft_psd_form *form, const haft_psd_rings *rings, double *gain) {
    double m[3][3], score[3], inverse[3][3], d[3];
    inform(m, score, form, rings);
    bool held = form->floor <= 0 && score[2] <= 0;
    if ((held || !invert(inverse, m, 3)) && !invert(inverse, m, 2)) {
        return false;
    }
    double promised = 0;
    for (int j = 0; j < 3; j++) {
        d[j] = inverse[j][0] * score[0] + inverse[j][1] * score[1] + inverse[j][2] * score[2];
        promised += d[j] * score[j];
    }
    double share = 1;
    if (promised < 1e-12 * (1e-6 + form->deviance)) {
        return false;
    }
    for (int k = 0; k < HALVINGS; k++, share *= 0.5) {
        haft_psd_form next = *form;
        next.a += share * d[0];
        next.b += share * d[1];
        next.floor = fmax(0, form->floor + share * d[2] * rings->scale);
        next.deviance = deviance_of(&next, rings);
        if (next.deviance <= form->deviance) {
            *gain = form->deviance - next.deviance;
            *form = next;
            return true;
        }
    }
    return false;
}

haft_psd_form haft_psd_form_at(const haft_psd_rings *rings, double log_zeta_0,
                               const haft_psd_form *near) {
    haft_psd_form form = *near;
    form.log_zeta_0 = log_zeta_0;
    form.deviance = deviance_of(&form, rings);
    for (int k = 0; k < STEPS; k++) {
        double gain = 0;
        if (!step(&form, rings, &gain) || gain < 1e-7 * (1e-6 + form.deviance)) {
            break;
        }
    }
    return form;
}

/* Initial form: a line fitted to the logarithm of s - floor, over rings clearly above the floor. */
static haft_psd_form begin_at(const haft_psd_rings *rings, double log_zeta_0, double floor) {
    double w = 0, wx = 0, wy = 0, wxx = 0, wxy = 0;
    for (size_t i = 0; i < rings->n; i++) {
        double above = rings->s[i] - floor;
        double x = fmax(0, rings->log_zeta[i] - log_zeta_0), weight = rings->count[i];
        if (above > 0.3 * rings->s[i]) {
            w += weight;
            wx += weight * x;
            wy += weight * log(above);
            wxx += weight * x * x;
            wxy += weight * x * log(above);
        }
    }
    double spread = wxx * w - wx * wx;
    haft_psd_form form = {.log_zeta_0 = log_zeta_0, .floor = floor};
    form.b = spread > 1e-12 * wxx * w ? -(wxy * w - wx * wy) / spread : 0;
    form.a = w > 0 ? (wy + form.b * wx) / w : log(rings->s[0]);
    return form;
}

static void refine(haft_psd_profile *profile, const haft_psd_rings *rings, size_t best) {
    double golden = 0.5 * (sqrt(5) - 1);
    double a = profile->at[best > 0 ? best - 1 : 0].log_zeta_0;
    double b = profile->at[best < profile->n ? best + 1 : best].log_zeta_0;
    haft_psd_form near = profile->at[best];
    for (int i = 0; i < SHRINKINGS && b - a > 1e-9; i++) {
        double c = b - golden * (b - a), d = a + golden * (b - a);
        haft_psd_form left = haft_psd_form_at(rings, c, &near);
        haft_psd_form right = haft_psd_form_at(rings, d, &near);
        near = left.deviance < right.deviance ? left : right;
        if (left.deviance < right.deviance) {
            b = d;
        } else {
            a = c;
        }
        if (near.deviance < profile->best.deviance) {
            profile->best = near;
        }
    }
}

void haft_psd_profile_make(haft_psd_profile *profile, const haft_psd_rings *rings, size_t n) {
    double low = rings->log_zeta[0], high = rings->log_zeta[rings->n - 3];
    size_t best = 0;
    profile->n = n;
    for (int sweep = 0; sweep < 2; sweep++) {
        double floor = sweep == 0 ? 0 : 0.7 * rings->scale;
        haft_psd_form near = begin_at(rings, low, floor);
        for (size_t j = 0; j <= n; j++) {
            near = haft_psd_form_at(rings, low + (high - low) * (double)j / (double)n, &near);
            if (sweep == 0 || near.deviance < profile->at[j].deviance) {
                profile->at[j] = near;
            }
        }
    }
    for (size_t j = 1; j <= n; j++) {
        best = profile->at[j].deviance < profile->at[best].deviance ? j : best;
    }
    profile->best = profile->at[best];
    refine(profile, rings, best);
}
