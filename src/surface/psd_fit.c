/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The self-affine fit of a table: the rings used, a cut-off, a floor, confidence intervals, and the
 * quality of the fit. */
#include "psd_likelihood.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_sf_psi.h>
#include <math.h>

enum { POINTS_LEAST = 6, PARAMETERS = 4, COARSE = 40, INSIDE = 40, BISECTIONS = 30 };
static const double CONFIDENCE = 0.95;
static const double LIKELY = 1e-3;         /* a form less likely than this does not fit */
static const double RING_COST = 6;         /* deviance charged for each ring left out */
static const double DROP = 0.5;            /* largest share of the form beyond a cut-off */
static const double WIDE = 10, WIDE_H = 1; /* wider intervals do not determine a parameter */
static const double OFF = 0.25; /* relative tolerance of a moment, besides three standard errors */

/* ---- rings ---- */

static haft_status take_rings(haft_psd_rings *rings, const haft_psd_table *table,
                              haft_error *error) {
    bool counted = table->count != NULL && table->count[0] > 0;
    double from = counted ? 2 * table->zeta[0] : 0;
    double *data = haft_memory_alloc(table->n, 3 * sizeof *data, error);
    if (data == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    *rings = (haft_psd_rings){.log_zeta = data, .s = data + table->n, .count = data + 2 * table->n};
    for (size_t i = 0; i < table->n; i++) {
        if (table->zeta[i] < from) {
            continue;
        }
        rings->log_zeta[rings->n] = log(table->zeta[i]);
        rings->s[rings->n] = table->s[i];
        rings->count[rings->n] = table->count != NULL && table->count[i] > 0 ? table->count[i] : 1;
        rings->scale = rings->n == 0 ? table->s[i] : fmin(rings->scale, table->s[i]);
        rings->n++;
    }
    if (rings->n < POINTS_LEAST) {
        haft_memory_free(data);
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "a PSD of %zu points, %zu of them from %.4g rad/um on, where its map "
                              "tells it, is too short for a fit of three parameters; it needs %d",
                              table->n, rings->n, from * 1e-6, POINTS_LEAST);
    }
    return HAFT_OK;
}

/* Deviance per degree of freedom; each ring's is divided by its mean, 2 N (log N - psi(N)). */
static double misfit_of(const haft_psd_form *form, const haft_psd_rings *rings) {
    double sum = 0;
    for (size_t i = 0; i < rings->n; i++) {
        double n = rings->count[i], model = haft_psd_form_value(form, rings->log_zeta[i]);
        sum += haft_psd_ring_deviance(rings->s[i], n, model) / (2 * n * (log(n) - gsl_sf_psi(n)));
    }
    return sum / (double)(rings->n - PARAMETERS);
}

static double likelihood_of(double misfit, size_t n) {
    double freedom = (double)(n - PARAMETERS);
    return gsl_cdf_chisq_Q(misfit * freedom, freedom);
}

/* Logarithm of the wave number between ring i and the next. */
static double upper_edge(const haft_psd_rings *rings, size_t i) {
    return 0.5 * (rings->log_zeta[i] + rings->log_zeta[i + 1]);
}

/* Area of ring i in the plane of wave vectors, over pi [rad^2/m^2]. */
static double area_of(const haft_psd_rings *rings, size_t i, size_t n) {
    double last = rings->log_zeta[i];
    double low = i > 0 ? upper_edge(rings, i - 1) : last;
    double high = i + 1 < n ? upper_edge(rings, i) : last;
    return exp(2 * high) - exp(2 * low);
}

/* ---- the cut-off ---- */

/* Whether all rings from `first` on are below DROP times the form. */
static bool drops(const haft_psd_form *form, const haft_psd_rings *rings, size_t first,
                  size_t all) {
    bool under = true;
    for (size_t i = first; i < all; i++) {
        under &= rings->s[i] < DROP * haft_psd_form_value(form, rings->log_zeta[i]);
    }
    return under;
}

/* Keeps only the rings below a cut-off, if there is one. @return its wave number, or INFINITY */
static double find_cut_off(haft_psd_profile *profile, haft_psd_rings *rings) {
    size_t all = rings->n, kept = all, found = 0;
    double least = INFINITY, cut = INFINITY;
    if (likelihood_of(misfit_of(&profile->best, rings), all) >= LIKELY) {
        return INFINITY;
    }
    for (rings->n = all - 1; rings->n >= POINTS_LEAST && (found == 0 || found - rings->n < 4);
         rings->n--) {
        haft_psd_profile_make(profile, rings, COARSE);
        const haft_psd_form *form = &profile->best;
        bool fits = form->b > 0 && likelihood_of(misfit_of(form, rings), rings->n) >= LIKELY;
        size_t next =
            rings->n + 1 < all ? rings->n + 1 : all - 1; /* the cut-off may be inside a ring */
        if (!fits || !drops(form, rings, next, all)) {
            continue;
        }
        found = found == 0 ? rings->n : found;
        double cost = form->deviance + RING_COST * (double)(all - rings->n);
        if (cost < least) {
            double square = exp(2 * upper_edge(rings, rings->n - 1));
            for (size_t i = rings->n; i < all; i++) {
                double share = rings->s[i] / haft_psd_form_value(form, rings->log_zeta[i]);
                square += fmin(1, share) * area_of(rings, i, all);
            }
            least = cost;
            kept = rings->n;
            cut = 0.5 * log(square);
        }
    }
    rings->n = kept;
    return kept < all ? exp(cut) : INFINITY;
}

/* ---- intervals ---- */

static haft_psd psd_of(const haft_psd_form *form, double zeta_max) {
    double zeta_0 = exp(form->log_zeta_0), s_0 = exp(form->a);
    return (haft_psd){.zeta_max = zeta_max,
                      .zeta_0 = zeta_0,
                      .s_0 = s_0,
                      .s_1 = s_0 * pow(zeta_max / zeta_0, -form->b)};
}

/* log of the form's variance, and its derivative by b (the derivative by a is 1). */
static double log_variance(const haft_psd_form *form, double zeta_max, double *slope) {
    haft_psd_form steeper = *form;
    haft_psd psd = psd_of(form, zeta_max);
    double value = log(haft_psd_get_moments(&psd).m0);
    steeper.b += 1e-5;
    psd = psd_of(&steeper, zeta_max);
    *slope = (log(haft_psd_get_moments(&psd).m0) - value) / 1e-5;
    return value;
}

static void widen(double ends[2], double value, double half) {
    ends[0] = fmin(ends[0], value - half);
    ends[1] = fmax(ends[1], value + half);
}

/* Where the deviance crosses `most`, between a roll-off inside the interval and one outside. */
static double cross(const haft_psd_rings *rings, haft_psd_form inside, double outside,
                    double most) {
    double in = inside.log_zeta_0;
    for (int k = 0; k < BISECTIONS && fabs(outside - in) > 1e-6; k++) {
        haft_psd_form middle = haft_psd_form_at(rings, 0.5 * (in + outside), &inside);
        if (middle.deviance <= most) {
            in = middle.log_zeta_0;
            inside = middle;
        } else {
            outside = middle.log_zeta_0;
        }
    }
    return in;
}

/* The range of roll-offs with a deviance up to `most`, and whether its ends are those of the
 * grid. */
static void find_roll_offs(double ends[2], bool open[2], const haft_psd_profile *profile,
                           const haft_psd_rings *rings, double most) {
    double best = profile->best.log_zeta_0;
    size_t n = profile->n, low = 0, high = n;
    while (low < n && profile->at[low].deviance > most && profile->at[low].log_zeta_0 < best) {
        low++;
    }
    while (high > 0 && profile->at[high].deviance > most && profile->at[high].log_zeta_0 > best) {
        high--;
    }
    open[0] = low == 0;
    open[1] = high == n;
    haft_psd_form first = profile->at[low].log_zeta_0 < best ? profile->at[low] : profile->best;
    haft_psd_form last = profile->at[high].log_zeta_0 > best ? profile->at[high] : profile->best;
    ends[0] = open[0] ? profile->at[0].log_zeta_0
                      : cross(rings, first, profile->at[low - 1].log_zeta_0, most);
    ends[1] = open[1] ? profile->at[n].log_zeta_0
                      : cross(rings, last, profile->at[high + 1].log_zeta_0, most);
}

static void set_intervals(haft_psd_fit *fit, const haft_psd_profile *profile,
                          const haft_psd_rings *rings) {
    double freedom = (double)(rings->n - PARAMETERS);
    double t = gsl_cdf_tdist_Pinv(0.5 * (1 + CONFIDENCE), freedom);
    double most = profile->best.deviance + t * t * fmax(1, fit->misfit);
    double roll_off[2], a[2] = {INFINITY, -INFINITY}, b[2] = {INFINITY, -INFINITY},
                        variance[2] = {INFINITY, -INFINITY};
    bool open[2];
    find_roll_offs(roll_off, open, profile, rings, most);
    haft_psd_form form = profile->best;
    for (int k = 0; k <= INSIDE + 1; k++) { /* the best form first */
        double share = (double)(k - 1) / INSIDE, covariance[3][3], slope;
        form = k == 0 ? form
                      : haft_psd_form_at(rings, roll_off[0] + share * (roll_off[1] - roll_off[0]),
                                         &form);
        double rest = sqrt(fmax(0, most - form.deviance));
        haft_psd_form_covariance(&form, rings, covariance);
        double value = log_variance(&form, fit->psd.zeta_max, &slope);
        widen(a, form.a, rest * sqrt(covariance[0][0]));
        widen(b, form.b, rest * sqrt(covariance[1][1]));
        widen(variance, value,
              rest * sqrt(fmax(0, covariance[0][0] +
                                      slope * (2 * covariance[0][1] + slope * covariance[1][1]))));
    }
    fit->low[0] = exp(a[0]);
    fit->high[0] = open[0] ? INFINITY : exp(a[1]);
    fit->low[1] = open[0] ? 0 : exp(roll_off[0]);
    fit->high[1] = open[1] ? INFINITY : exp(roll_off[1]);
    fit->low[2] = 0.5 * b[0] - 1;
    fit->high[2] = open[1] ? INFINITY : 0.5 * b[1] - 1;
    fit->rms[1] = exp(0.5 * variance[0]);
    fit->rms[2] = open[0] ? INFINITY : exp(0.5 * variance[1]);
    for (int k = 0; k < 2; k++) {
        fit->determined[k] = fit->low[k] > 0 && fit->high[k] < WIDE * fit->low[k];
    }
    fit->determined[2] = fit->high[2] - fit->low[2] < WIDE_H;
}

/* ---- quality of the fit ---- */

/* The mean of s/form - 1 over an eighth of a decade that exceeds twice its error most. */
static void find_deviation(haft_psd_fit *fit, const haft_psd_form *form,
                           const haft_psd_rings *rings) {
    double most = 0, reach = log(10) / 8;
    for (size_t i = 0; i < rings->n; i++) {
        double sum = 0, count = 0;
        size_t k = i;
        for (; k < rings->n && rings->log_zeta[k] <= rings->log_zeta[i] + reach; k++) {
            double rest = rings->s[k] / haft_psd_form_value(form, rings->log_zeta[k]) - 1;
            sum += rings->count[k] * rest;
            count += rings->count[k];
        }
        double beyond = fabs(sum / count) - 2 / sqrt(count);
        if (beyond > most) {
            most = beyond;
            fit->deviation = sum / count;
            fit->deviation_at = exp(0.5 * (rings->log_zeta[i] + rings->log_zeta[k - 1]));
        }
    }
}

/* Compares the form's variances of heights and slopes over the rings used with the table's. */
static haft_status check_moments(const haft_psd_form *form, const haft_psd_rings *rings,
                                 haft_error *error) {
    for (int power = 0; power <= 2; power += 2) {
        double fitted = 0, measured = 0, error_square = 0;
        for (size_t i = 0; i < rings->n; i++) {
            double area = area_of(rings, i, rings->n) * exp(power * rings->log_zeta[i]);
            double part = haft_psd_form_value(form, rings->log_zeta[i]) * area;
            fitted += part;
            measured += rings->s[i] * area;
            error_square += part * part / rings->count[i];
        }
        if (fabs(fitted - measured) > OFF * measured + 3 * sqrt(error_square)) {
            return haft_error_set(
                error, HAFT_ERROR_NUMERIC,
                "the best self-affine form has %.3g times the rms %s of the map between %.4g and "
                "%.4g rad/um; it does not fit, so use the PSD as a table",
                sqrt(fitted / measured), power == 0 ? "height" : "slope",
                exp(rings->log_zeta[0]) * 1e-6, exp(rings->log_zeta[rings->n - 1]) * 1e-6);
        }
    }
    return HAFT_OK;
}

static haft_status check_slope(const haft_psd_form *form, const haft_psd_rings *rings,
                               haft_error *error) {
    if (!(form->b > 0) || !isfinite(form->deviance)) {
        return haft_error_set(error, HAFT_ERROR_NUMERIC,
                              "the PSD does not fall off: its best slope is %.3g, so the "
                              "self-affine form does not fit; use it as a table",
                              -form->b);
    }
    if (!(form->b > 2)) {
        return haft_error_set(
            error, HAFT_ERROR_NUMERIC,
            "the PSD falls off as zeta^-%.3g, slower than that of any self-affine "
            "surface, zeta^-2 to zeta^-4 (Hurst exponent 0 to 1); use it as a "
            "table",
            form->b);
    }
    if (!(haft_psd_form_power(form, rings->log_zeta[2]) > form->floor)) {
        return haft_error_set(error, HAFT_ERROR_NUMERIC,
                              "a floor of %.3g nm^4, as noise makes it, hides the PSD from %.4g "
                              "rad/um on; nothing is left to fit",
                              form->floor * 1e36, exp(rings->log_zeta[2]) * 1e-6);
    }
    return HAFT_OK;
}

/* The wave number at which the floor equals the form, if the floor is significant and the wave
 * number is within the rings; else INFINITY. */
static double find_noise_limit(const haft_psd_form *form, const haft_psd_rings *rings) {
    double covariance[3][3];
    haft_psd_form_covariance(form, rings, covariance);
    if (!(form->floor > 3 * sqrt(covariance[2][2]))) {
        return INFINITY;
    }
    double limit = form->log_zeta_0 + (form->a - log(form->floor)) / form->b;
    return limit < rings->log_zeta[rings->n - 1] ? exp(limit) : INFINITY;
}

static haft_status fit_rings(haft_psd_fit *out, haft_psd_profile *profile, haft_psd_rings *rings,
                             double zeta_max, haft_error *error) {
    haft_psd_profile_make(profile, rings, COARSE);
    double cut_off = find_cut_off(profile, rings);
    haft_psd_profile_make(profile, rings, HAFT_PSD_GRID);
    const haft_psd_form *form = &profile->best;
    haft_status status = check_slope(form, rings, error);
    HAFT_THEN(status, check_moments(form, rings, error));
    if (status != HAFT_OK) {
        return status;
    }
    *out = (haft_psd_fit){.hurst = 0.5 * form->b - 1,
                          .rings = rings->n,
                          .from = exp(rings->log_zeta[0]),
                          .to = exp(rings->log_zeta[rings->n - 1]),
                          .cut_off = cut_off,
                          .floor = form->floor,
                          .noise_limit = find_noise_limit(form, rings),
                          .misfit = misfit_of(form, rings)};
    out->psd = psd_of(form, fmin(zeta_max, fmin(out->cut_off, out->noise_limit)));
    out->p_value = likelihood_of(out->misfit, rings->n);
    out->rms[0] = sqrt(haft_psd_get_moments(&out->psd).m0);
    set_intervals(out, profile, rings);
    find_deviation(out, form, rings);
    return haft_psd_check(&out->psd, error);
}

haft_status haft_psd_fit_self_affine(haft_psd_fit *out, const haft_psd_table *table,
                                     haft_error *error) {
    haft_psd_rings rings = {.n = 0};
    haft_status status = haft_psd_table_check(table, error);
    HAFT_THEN(status, take_rings(&rings, table, error));
    if (status != HAFT_OK) {
        return status;
    }
    haft_psd_profile *profile = haft_memory_alloc(1, sizeof *profile, error);
    status = profile == NULL ? HAFT_ERROR_MEMORY
                             : fit_rings(out, profile, &rings, table->zeta[table->n - 1], error);
    haft_memory_free(profile);
    haft_memory_free(rings.log_zeta);
    return status;
}
