/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Distributions of heights as transformations of a normal number. They are tabulated with monotone
 * cubic pieces (slopes by harmonic means, Fritsch and Butland 1984), and linear beyond 8.5 standard
 * deviations, where no number falls. Nested bisection finds Johnson's two shape parameters: for a
 * given spread the skewness grows with the shift, and for a given skewness the kurtosis is monotone
 * in the spread. The moments of the bounded family are sums over a uniform grid of normal numbers,
 * which converge exponentially. */
#include "surface/marginal.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { HEIGHTS_LEAST = 100, HALVINGS = 80, SUM_POINTS = 1801 };
static const double SUM_REACH = 9;
static const double LEAST_SPREAD =
    0.05; /* of the bounded family; below it the heights are nearly two points */
static const double SKEWNESS_MOST = 20, KURTOSIS_MOST = 2000;
static const double TAIL = 0.01;

/* ---- the table ---- */

static double knot_place(size_t i) {
    return -MARGINAL_REACH + 2 * MARGINAL_REACH * (double)i / (MARGINAL_KNOTS - 1);
}

static double normal_density(double g) {
    return exp(-0.5 * g * g) / sqrt(2 * M_PI);
}

/* Scales to mean 0 and variance 1, by the trapezoidal rule; false if there is no variance. */
static bool standardise(haft_marginal *m) {
    double h = 2 * MARGINAL_REACH / (MARGINAL_KNOTS - 1), weight = 0, mean = 0, square = 0;
    for (size_t i = 0; i < MARGINAL_KNOTS; i++) {
        double w = h * normal_density(knot_place(i));
        weight += w;
        mean += w * m->knot[i].value;
    }
    mean /= weight;
    double third = 0, fourth = 0;
    for (size_t i = 0; i < MARGINAL_KNOTS; i++) {
        double w = h * normal_density(knot_place(i)) / weight, d = m->knot[i].value - mean;
        square += w * d * d;
        third += w * d * d * d;
        fourth += w * d * d * d * d;
    }
    double deviation = sqrt(square);
    for (size_t i = 0; i < MARGINAL_KNOTS; i++) {
        m->knot[i].value = (m->knot[i].value - mean) / deviation;
    }
    m->facts.skewness = third / (square * deviation);
    m->facts.kurtosis = fourth / (square * square);
    return square > 0 && isfinite(fourth);
}

static void fill_slopes(haft_marginal *m) {
    for (size_t i = 0; i < MARGINAL_KNOTS; i++) {
        double below = i > 0 ? m->knot[i].value - m->knot[i - 1].value : 0;
        double above = i + 1 < MARGINAL_KNOTS ? m->knot[i + 1].value - m->knot[i].value : 0;
        below = i > 0 ? below : above;
        above = i + 1 < MARGINAL_KNOTS ? above : below;
        m->knot[i].slope = below * above > 0 ? 2 * below * above / (below + above) : 0;
    }
}

/* Squares of the coefficients of normalised Hermite polynomials. They are scaled to sum to 1 in
 * spite of the truncation, so that a correlation of 1 stays 1. */
static void fill_energy(haft_marginal *m) {
    double h = 2 * MARGINAL_REACH / (MARGINAL_KNOTS - 1), coefficient[MARGINAL_TERMS] = {0},
           sum = 0;
    for (size_t i = 0; i < MARGINAL_KNOTS; i++) {
        double g = knot_place(i), w = h * normal_density(g) * m->knot[i].value;
        double before = 0, here = 1;
        for (int n = 0; n < MARGINAL_TERMS; n++) {
            coefficient[n] += w * here;
            double next = (g * here - sqrt(n) * before) / sqrt(n + 1);
            before = here;
            here = next;
        }
    }
    for (int n = 1; n < MARGINAL_TERMS; n++) {
        m->energy[n] = coefficient[n] * coefficient[n];
        sum += m->energy[n];
    }
    for (int n = 1; n < MARGINAL_TERMS; n++) {
        m->energy[n] /= sum;
    }
}

static inline double read_table(const haft_marginal *m, double g) {
    double x = (g + MARGINAL_REACH) * ((MARGINAL_KNOTS - 1) / (2 * MARGINAL_REACH));
    x = x > 0 ? x : 0;
    x = x < MARGINAL_KNOTS - 2 ? x : MARGINAL_KNOTS - 2;
    size_t i = (size_t)(int)x;
    double t = (g + MARGINAL_REACH) * ((MARGINAL_KNOTS - 1) / (2 * MARGINAL_REACH)) - (double)i;
    double a = m->knot[i].value, b = m->knot[i + 1].value;
    double p = m->knot[i].slope, q = m->knot[i + 1].slope, d = b - a;
    if (t < 0 || t > 1) { /* beyond the table */
        return t < 0 ? a + t * p : b + (t - 1) * q;
    }
    return a + t * (p + t * (3 * d - 2 * p - q + t * (p + q - 2 * d)));
}

double haft_marginal_value(const haft_marginal *marginal, double g) {
    return read_table(marginal, g);
}

void haft_marginal_apply(const haft_marginal *marginal, double scale_in, double scale_out, size_t n,
                         double *z) {
    for (size_t i = 0; i < n; i++) {
        z[i] = scale_out * read_table(marginal, scale_in * z[i]);
    }
}

double haft_marginal_correlation(const haft_marginal *marginal, double rho) {
    double sum = 0;
    for (int n = MARGINAL_TERMS - 1; n > 0; n--) {
        sum = (sum + marginal->energy[n]) * rho;
    }
    return sum;
}

bool haft_marginal_is_normal(const haft_marginal *marginal) {
    return marginal->energy[1] > 1 - 1e-12;
}

haft_marginal_facts haft_marginal_get_facts(const haft_marginal *marginal) {
    return marginal->facts;
}

void haft_marginal_destroy(haft_marginal **marginal) {
    if (marginal != NULL) {
        haft_memory_free(*marginal);
        *marginal = NULL;
    }
}

/* ---- Johnson ---- */

typedef struct shape {
    double skewness, kurtosis;
} shape;

/* The shape of sinh((g + shift) / spread), with w = exp(1 / spread^2) and omega = shift / spread >=
 * 0. */
static shape unbounded_shape(double w, double omega) {
    double variance = 0.5 * (w - 1) * (w * cosh(2 * omega) + 1);
    double third =
        0.25 * sqrt(w) * (w - 1) * (w - 1) * (w * (w + 2) * sinh(3 * omega) + 3 * sinh(omega));
    double fourth = 0.125 * (w - 1) * (w - 1) *
                    (w * w * (w * w * w * w + 2 * w * w * w + 3 * w * w - 3) * cosh(4 * omega) +
                     4 * w * w * (w + 2) * cosh(2 * omega) + 3 * (2 * w + 1));
    return (shape){third / pow(variance, 1.5), fourth / (variance * variance)};
}

/* The shape of 1 / (1 + exp(-(g - shift) / spread)). */
static shape bounded_shape(double spread, double shift) {
    double value[SUM_POINTS], weight = 0, mean = 0, second = 0, third = 0, fourth = 0;
    /* the heights times exp(shift / spread), so that they do not underflow */
    for (int i = 0; i < SUM_POINTS; i++) {
        double g = -SUM_REACH + 2 * SUM_REACH * i / (SUM_POINTS - 1), w = exp(-0.5 * g * g);
        value[i] = 1 / (exp(-shift / spread) + exp(-g / spread));
        weight += w;
        mean += w * value[i];
    }
    mean /= weight;
    for (int i = 0; i < SUM_POINTS; i++) {
        double g = -SUM_REACH + 2 * SUM_REACH * i / (SUM_POINTS - 1),
               w = exp(-0.5 * g * g) / weight;
        double d = value[i] - mean;
        second += w * d * d;
        third += w * d * d * d;
        fourth += w * d * d * d * d;
    }
    return (shape){third / pow(second, 1.5), fourth / (second * second)};
}

/* The omega that gives this skewness for a given spread. */
static double find_omega(double w, double skewness) {
    double low = 0, high = 60;
    for (int i = 0; i < HALVINGS; i++) {
        double middle = 0.5 * (low + high);
        *(unbounded_shape(w, middle).skewness < skewness ? &low : &high) = middle;
    }
    return skewness == 0 ? 0 : 0.5 * (low + high);
}

static double find_shift(double spread, double skewness) {
    double low = 0, high = 40 * spread + 10;
    for (int i = 0; i < HALVINGS / 2; i++) {
        double middle = 0.5 * (low + high);
        *(bounded_shape(spread, middle).skewness < skewness ? &low : &high) = middle;
    }
    return skewness == 0 ? 0 : 0.5 * (low + high);
}

/* exp(1/spread^2) of the lognormal distribution with this skewness. */
static double lognormal_w(double skewness) {
    double low = 1, high = 2 + skewness * skewness;
    for (int i = 0; i < HALVINGS; i++) {
        double middle = 0.5 * (low + high);
        *((middle + 2) * sqrt(middle - 1) < skewness ? &low : &high) = middle;
    }
    return 0.5 * (low + high);
}

static void fill_unbounded(haft_marginal *m, double least_w, shape wanted, double sign) {
    double low = least_w, high = 2 * least_w;
    while (unbounded_shape(high, find_omega(high, wanted.skewness)).kurtosis < wanted.kurtosis) {
        high *= 2;
    }
    for (int i = 0; i < HALVINGS; i++) {
        double middle = 0.5 * (low + high);
        double kurtosis = unbounded_shape(middle, find_omega(middle, wanted.skewness)).kurtosis;
        *(kurtosis < wanted.kurtosis ? &low : &high) = middle;
    }
    double w = 0.5 * (low + high), omega = find_omega(w, wanted.skewness),
           spread = 1 / sqrt(log(w));
    m->facts.name = "Johnson SU";
    for (size_t i = 0; i < MARGINAL_KNOTS; i++) {
        m->knot[i].value = sign * sinh(sign * knot_place(i) / spread + omega);
    }
}

/* False if the kurtosis at the smallest spread exceeds the wanted one. */
static bool fill_bounded(haft_marginal *m, double most_spread, shape wanted, double sign) {
    double low = log(LEAST_SPREAD), high = log(most_spread);
    if (bounded_shape(LEAST_SPREAD, find_shift(LEAST_SPREAD, wanted.skewness)).kurtosis >
        wanted.kurtosis) {
        return false;
    }
    for (int i = 0; i < HALVINGS / 2; i++) {
        double middle = 0.5 * (low + high), spread = exp(middle);
        double kurtosis = bounded_shape(spread, find_shift(spread, wanted.skewness)).kurtosis;
        *(kurtosis < wanted.kurtosis ? &low : &high) = middle;
    }
    double spread = exp(0.5 * (low + high)), shift = find_shift(spread, wanted.skewness);
    m->facts.name = "Johnson SB";
    for (size_t i = 0; i < MARGINAL_KNOTS; i++) {
        double g = sign * knot_place(i);
        m->knot[i].value = sign / (exp(-shift / spread) + exp(-g / spread));
    }
    return true;
}

static bool fill_johnson(haft_marginal *m, double skewness, double kurtosis) {
    shape wanted = {fabs(skewness), kurtosis};
    double sign = skewness < 0 ? -1 : 1, w = wanted.skewness > 0 ? lognormal_w(wanted.skewness) : 1;
    double lognormal = w * w * w * w + 2 * w * w * w + 3 * w * w - 3;
    double tolerance = 1e-6 * kurtosis;
    if (wanted.skewness < 1e-9 && fabs(kurtosis - 3) <= 1e-9) {
        m->facts.name = "normal";
        for (size_t i = 0; i < MARGINAL_KNOTS; i++) {
            m->knot[i].value = knot_place(i);
        }
    } else if (wanted.skewness > 0 && fabs(kurtosis - lognormal) <= tolerance) {
        m->facts.name = "lognormal";
        for (size_t i = 0; i < MARGINAL_KNOTS; i++) {
            m->knot[i].value = sign * exp(sign * knot_place(i) * sqrt(log(w)));
        }
    } else if (kurtosis > lognormal) {
        fill_unbounded(m, w > 1 ? w : 1 + 1e-12, wanted, sign);
    } else {
        return fill_bounded(m, w > 1 ? 1 / sqrt(log(w)) : 1e3, wanted, sign);
    }
    return true;
}

/* The smallest kurtosis of the bounded family for a skewness, rounded up to four digits. */
static double least_kurtosis(double skewness) {
    double s = fabs(skewness),
           k = bounded_shape(LEAST_SPREAD, find_shift(LEAST_SPREAD, s)).kurtosis;
    double unit = pow(10, floor(log10(k)) - 3);
    return ceil(k / unit) * unit;
}

static haft_status refuse_pair(double skewness, double kurtosis, haft_error *error) {
    if (!(fabs(skewness) <= SKEWNESS_MOST)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "a skewness of %g with a kurtosis of %g: the skewness must be from "
                              "-%g to %g",
                              skewness, kurtosis, SKEWNESS_MOST, SKEWNESS_MOST);
    }
    if (kurtosis > KURTOSIS_MOST) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "a skewness of %g with a kurtosis of %g: the nearest kurtosis that "
                              "can be had is %g",
                              skewness, kurtosis, KURTOSIS_MOST);
    }
    double bound = skewness * skewness + 1;
    return haft_error_set(error, HAFT_ERROR_INPUT,
                          "%s a skewness of %g with a kurtosis of %g: two heights alone have "
                          "skewness^2 + 1 = %g, all others more; the nearest kurtosis that can be "
                          "had is %.4g",
                          kurtosis > bound ? "no smooth distribution has" : "no distribution has",
                          skewness, kurtosis, bound, least_kurtosis(skewness));
}

haft_status haft_marginal_johnson(haft_marginal **out, double skewness, double kurtosis,
                                  haft_error *error) {
    *out = NULL;
    if (!(fabs(skewness) <= SKEWNESS_MOST) || !(kurtosis <= KURTOSIS_MOST) ||
        !(kurtosis > skewness * skewness + 1)) {
        return refuse_pair(skewness, kurtosis, error);
    }
    haft_marginal *m = haft_memory_alloc(1, sizeof *m, error);
    if (m == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    if (!fill_johnson(m, skewness, kurtosis) || !standardise(m)) {
        haft_memory_free(m);
        return refuse_pair(skewness, kurtosis, error);
    }
    fill_slopes(m);
    fill_energy(m);
    *out = m;
    return HAFT_OK;
}

/* ---- heights ---- */

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The height of probability p; height i of n has probability (i + 1/2)/n. */
static double quantile(const double *sorted, size_t n, double p) {
    double x = fmin(fmax(p * (double)n - 0.5, 0), (double)(n - 1));
    size_t i = (size_t)x < n - 1 ? (size_t)x : n - 2;
    return sorted[i] + (x - (double)i) * (sorted[i + 1] - sorted[i]);
}

static void fill_from_sorted(haft_marginal *m, const double *sorted, size_t n) {
    double edge = gsl_cdf_ugaussian_Qinv(0.5 / (double)n), inner = gsl_cdf_ugaussian_Qinv(TAIL);
    double high = (sorted[n - 1] - quantile(sorted, n, 1 - TAIL)) / (edge - inner);
    double low = (quantile(sorted, n, TAIL) - sorted[0]) / (edge - inner);
    m->facts.name = "heights' own";
    for (size_t i = 0; i < MARGINAL_KNOTS; i++) {
        double g = knot_place(i);
        m->knot[i].value = g > edge    ? sorted[n - 1] + high * (g - edge)
                           : g < -edge ? sorted[0] + low * (g + edge)
                                       : quantile(sorted, n, gsl_cdf_ugaussian_P(g));
    }
}

haft_status haft_marginal_from_heights(haft_marginal **out, size_t n, const double *z,
                                       haft_error *error) {
    *out = NULL;
    double *sorted = haft_memory_alloc(n, sizeof *sorted, error);
    haft_marginal *m = haft_memory_alloc(1, sizeof *m, error);
    if (sorted == NULL || m == NULL) {
        haft_memory_free(sorted);
        haft_memory_free(m);
        return HAFT_ERROR_MEMORY;
    }
    size_t kept = 0;
    for (size_t i = 0; i < n; i++) {
        sorted[kept] = z[i];
        kept += !isnan(z[i]);
    }
    haft_status status = HAFT_OK;
    if (kept >= HEIGHTS_LEAST) {
        qsort(sorted, kept, sizeof *sorted, compare);
        fill_from_sorted(m, sorted, kept);
    }
    if (kept < HEIGHTS_LEAST || !standardise(m)) {
        status = haft_error_set(error, HAFT_ERROR_INPUT,
                                "%zu heights make no distribution; it takes %d that vary", kept,
                                HEIGHTS_LEAST);
        haft_memory_free(m);
    } else {
        fill_slopes(m);
        fill_energy(m);
        *out = m;
    }
    haft_memory_free(sorted);
    return status;
}
