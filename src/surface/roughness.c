/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The self-affine PSD by rms, correlation length and Hurst exponent. The autocorrelation is the
 * PSD's Hankel transform, C(r) = 2 pi int s J0(zeta r) zeta dzeta. Each interval of the PSD is a
 * power of zeta, so with t = zeta r the integrals are int t^-mu J0(t) dt. They are computed by
 * Gauss-Legendre quadrature over short panels up to t = FAR. Beyond, integration by parts gives an
 * asymptotic series whose terms fall by (mu / t)^2. Roots are found by bisection. */
#include "haft/surface.h"

#include <gsl/gsl_sf_bessel.h>
#include <math.h>

enum { NODES = 5, HALVINGS = 60, SERIES_MOST = 16 };

/* From this t on, the series is accurate to rounding for powers up to POWER_MOST. */
static const double FAR = 60, POWER_MOST = 5;

/* Range of the roll-off search, as zeta_0 over zeta_max. */
static const double BAND_WIDEST = 1e-5, BAND_NARROWEST = 0.999;

/* The autocorrelation at the correlation length, and a t below which J0 exceeds it. */
#define FALLEN exp(-1.0)
static const double STILL_HIGH = 1.75;

/* int (t/a)^power J0(t) dt from a to b by Gauss-Legendre quadrature, ten points per panel. */
static double panels(double a, double b, double scale, double power) {
    static const double node[NODES] = {0.1488743389816312, 0.4333953941292472, 0.6794095682990244,
                                       0.8650633666889845, 0.9739065285171717};
    static const double weight[NODES] = {0.2955242247147529, 0.2692667193099963, 0.2190863625159820,
                                         0.1494513491505806, 0.0666713443086881};
    double sum = 0, ratio = 1 + 2 / (4 + fabs(power));
    for (double from = a; from < b;) {
        double to = fmin(b, fmin(from * ratio, from + 1.5));
        double middle = 0.5 * (from + to), half = 0.5 * (to - from), panel = 0;
        for (int i = 0; i < NODES; i++) {
            double low = middle - half * node[i], high = middle + half * node[i];
            panel += weight[i] * (pow(low / scale, power) * gsl_sf_bessel_J0(low) +
                                  pow(high / scale, power) * gsl_sf_bessel_J0(high));
        }
        sum += half * panel;
        from = to;
    }
    return sum;
}

/* The antiderivative of (t/a)^power J0(t) that vanishes at infinity, for t >= FAR. */
static double series(double t, double scale, double power) {
    double j0 = gsl_sf_bessel_J0(t), j1 = gsl_sf_bessel_J1(t);
    double factor = pow(t / scale, power), sum = 0;
    for (int k = 0; k < SERIES_MOST; k++) {
        double next = 2 * k + 1 - power;
        sum += factor * (j1 - next * j0 / t);
        factor *= -(next / t) * (next / t);
    }
    return sum;
}

/* int s J0(zeta r) zeta dzeta from `low` to `high`, where s is s_low (zeta/low)^exponent. */
static double stretch(double low, double high, double s_low, double exponent, double r) {
    double a = low * r, b = high * r, power = exponent + 1;
    double turn = fabs(power) <= POWER_MOST ? fmin(b, fmax(a, FAR)) : b;
    double sum = panels(a, turn, a, power);
    if (b > turn) {
        sum += series(b, a, power) - series(turn, a, power);
    }
    return s_low * low * low * sum / a;
}

/* The same from 0 to `high`, where s is constant. */
static double plateau(double high, double s, double r) {
    return s * high / r * gsl_sf_bessel_J1(high * r);
}

static double exponent_between(double zeta_0, double zeta_1, double s_0, double s_1) {
    return log(s_1 / s_0) / log(zeta_1 / zeta_0);
}

double haft_psd_correlation(const haft_psd *psd, double r) {
    if (!(r > 0)) {
        return 1;
    }
    double exponent = exponent_between(psd->zeta_0, psd->zeta_max, psd->s_0, psd->s_1);
    double sum = plateau(psd->zeta_0, psd->s_0, r) +
                 stretch(psd->zeta_0, psd->zeta_max, psd->s_0, exponent, r);
    return 2 * M_PI * sum / haft_psd_get_moments(psd).m0;
}

double haft_psd_table_correlation(const haft_psd_table *table, double r) {
    if (!(r > 0)) {
        return 1;
    }
    double sum = plateau(table->zeta[0], table->s[0], r);
    for (size_t i = 0; i + 1 < table->n; i++) {
        double exponent =
            exponent_between(table->zeta[i], table->zeta[i + 1], table->s[i], table->s[i + 1]);
        sum += stretch(table->zeta[i], table->zeta[i + 1], table->s[i], exponent, r);
    }
    return 2 * M_PI * sum / haft_psd_table_get_moments(table).m0;
}

static double correlation(const haft_psd *psd, const haft_psd_table *table, double r) {
    return table != NULL ? haft_psd_table_correlation(table, r) : haft_psd_correlation(psd, r);
}

/* The smallest r at which the autocorrelation is 1/e. */
static double find_length(const haft_psd *psd, const haft_psd_table *table, double zeta_max) {
    double low = STILL_HIGH / zeta_max, high = low;
    while (correlation(psd, table, high) > FALLEN) {
        low = high;
        high *= 1.1;
    }
    for (int i = 0; i < HALVINGS && high > low; i++) {
        double middle = 0.5 * (low + high);
        *(correlation(psd, table, middle) > FALLEN ? &low : &high) = middle;
    }
    return 0.5 * (low + high);
}

double haft_psd_get_correlation_length(const haft_psd *psd) {
    return find_length(psd, NULL, psd->zeta_max);
}

double haft_psd_table_get_correlation_length(const haft_psd_table *table) {
    return find_length(NULL, table, table->zeta[table->n - 1]);
}

double haft_psd_get_hurst(const haft_psd *psd) {
    return -0.5 * exponent_between(psd->zeta_0, psd->zeta_max, psd->s_0, psd->s_1) - 1;
}

/* The PSD with this roll-off and a plateau of 1. */
static haft_psd with_roll_off(const haft_roughness *r, double zeta_0) {
    return (haft_psd){.zeta_max = r->zeta_max,
                      .zeta_0 = zeta_0,
                      .s_0 = 1,
                      .s_1 = pow(r->zeta_max / zeta_0, -2 * (1 + r->hurst))};
}

static haft_status check_roughness(const haft_roughness *r, haft_error *error) {
    if (!(r->rms > 0 && isfinite(r->rms)) || !(r->zeta_max > 0 && isfinite(r->zeta_max))) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "rms = %g m and zeta_max = %g rad/m: both must be positive and finite", r->rms,
            r->zeta_max);
    }
    if (!(r->hurst > 0 && r->hurst <= 1)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "a Hurst exponent of %g: it must be above 0 and at most 1", r->hurst);
    }
    haft_psd narrow = with_roll_off(r, BAND_NARROWEST * r->zeta_max);
    haft_psd wide = with_roll_off(r, BAND_WIDEST * r->zeta_max);
    double least = haft_psd_get_correlation_length(&narrow);
    double most = haft_psd_get_correlation_length(&wide);
    if (!(r->correlation_length >= least)) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "a correlation length of %.6g nm is shorter than waves up to zeta_max "
            "= %.6g rad/um can have; give %.6g nm at least, or a larger zeta_max",
            r->correlation_length * 1e9, r->zeta_max * 1e-6, ceil(least * 1e13) * 1e-4);
    }
    if (!(r->correlation_length <= most)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "a correlation length of %.6g um is longer than a roll-off of a "
                              "hundred-thousandth of zeta_max = %.6g rad/um gives; give %.6g um at "
                              "most, or a smaller zeta_max",
                              r->correlation_length * 1e6, r->zeta_max * 1e-6,
                              floor(most * 1e8) * 1e-2);
    }
    return HAFT_OK;
}

haft_status haft_psd_from_roughness(haft_psd *out, const haft_roughness *r, haft_error *error) {
    HAFT_TRY(check_roughness(r, error));
    double low = log(BAND_WIDEST), high = log(BAND_NARROWEST); /* the low side has longer waves */
    for (int i = 0; i < HALVINGS; i++) {
        double middle = 0.5 * (low + high);
        haft_psd psd = with_roll_off(r, exp(middle) * r->zeta_max);
        *(haft_psd_correlation(&psd, r->correlation_length) > FALLEN ? &low : &high) = middle;
    }
    *out = with_roll_off(r, exp(0.5 * (low + high)) * r->zeta_max);
    double scale = r->rms * r->rms / haft_psd_get_moments(out).m0;
    out->s_0 *= scale;
    out->s_1 *= scale;
    return haft_psd_check(out, error);
}
