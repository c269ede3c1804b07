/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Confidence intervals. Quantiles are found by bisection on GSL's distribution functions,
 * because GSL's own inverses call its error handler, which ends the program, if they do not
 * converge. Brackets grow in small steps from a guess, because far in a tail the functions
 * underflow, which GSL also treats as an error. */
#include "haft/study_report.h"

#include <gsl/gsl_cdf.h>
#include <math.h>

enum { HALVINGS = 200 };

static const haft_interval UNKNOWN = {NAN, NAN};

/* A distribution function or its complement: rising or falling in x. */
typedef double tail(double x, double parameter);

/* x with function(x) = p, which lies between low and high. */
static double bisect(tail *function, double parameter, double p, double low, double high) {
    bool rising = function(high, parameter) > function(low, parameter);
    for (int i = 0; i < HALVINGS; i++) {
        double middle = low + 0.5 * (high - low);
        if (middle <= low || middle >= high) {
            break;
        }
        if ((function(middle, parameter) < p) == rising) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low + 0.5 * (high - low);
}

/* t with P(T > t) = upper < 1/2. */
static double student(double upper, double freedom) {
    double high = 2;
    while (gsl_cdf_tdist_Q(high, freedom) > upper && high < 1e300) {
        high *= 2;
    }
    return bisect(gsl_cdf_tdist_Q, freedom, upper, 0, high);
}

/* x with P(X <= x) = p in the lower tail or P(X > x) = p in the upper, p < 1/2. */
static double chi_square(bool lower, double p, double freedom) {
    tail *function = lower ? gsl_cdf_chisq_P : gsl_cdf_chisq_Q;
    double factor = 1 + 0.5 * sqrt(2 / freedom), far = freedom, near = freedom;
    while (function(far, freedom) > p && far > 1e-300) {
        far *= lower ? 1 / factor : factor;
    }
    while (function(near, freedom) < p && near > 1e-300) { /* the mean is no median */
        near *= lower ? factor : 1 / factor;
    }
    return bisect(function, freedom, p, fmin(near, far), fmax(near, far));
}

haft_interval haft_study_mean_interval(double mean, double deviation, size_t n, double confidence) {
    if (n < 2 || !isfinite(deviation)) {
        return UNKNOWN;
    }
    double half = student(0.5 * (1 - confidence), (double)(n - 1)) * deviation / sqrt((double)n);
    return (haft_interval){mean - half, mean + half};
}

haft_interval haft_study_deviation_interval(double deviation, size_t n, double confidence) {
    if (n < 2 || !isfinite(deviation)) {
        return UNKNOWN;
    }
    double freedom = (double)(n - 1), p = 0.5 * (1 - confidence);
    return (haft_interval){deviation * sqrt(freedom / chi_square(false, p, freedom)),
                           deviation * sqrt(freedom / chi_square(true, p, freedom))};
}

haft_interval haft_study_difference_interval(const double mean[2], const double deviation[2],
                                             const size_t n[2], double confidence) {
    double variance[2], sum = 0, squares = 0;
    for (int i = 0; i < 2; i++) {
        if (n[i] < 2 || !isfinite(deviation[i])) {
            return UNKNOWN;
        }
        variance[i] = deviation[i] * deviation[i] / (double)n[i];
        sum += variance[i];
    }
    double difference = mean[1] - mean[0];
    if (sum == 0) {
        return (haft_interval){difference, difference};
    }
    for (int i = 0; i < 2; i++) {
        squares += variance[i] / sum * (variance[i] / sum) / (double)(n[i] - 1);
    }
    double half = student(0.5 * (1 - confidence), 1 / squares) * sqrt(sum);
    return (haft_interval){difference - half, difference + half};
}

/* ---- shares and ranks ---- */

/* P(at most k of n) as a function of the share. */
typedef struct binomial {
    unsigned k, n;
} binomial;

/* The share at which P(at most k of n) is p; falling in the share. */
static double share_with(binomial b, double p) {
    double low = 0, high = 1;
    for (int i = 0; i < HALVINGS; i++) {
        double middle = low + 0.5 * (high - low);
        if (middle <= low || middle >= high) {
            break;
        }
        if (gsl_cdf_binomial_P(b.k, middle, b.n) > p) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low + 0.5 * (high - low);
}

haft_interval haft_study_share_interval(size_t k, size_t n, double confidence) {
    if (n == 0 || k > n) {
        return UNKNOWN;
    }
    double p = 0.5 * (1 - confidence);
    unsigned all = (unsigned)n, some = (unsigned)k;
    return (haft_interval){k == 0 ? 0 : share_with((binomial){some - 1, all}, 1 - p),
                           k == n ? 1 : share_with((binomial){some, all}, p)};
}

void haft_study_quantile_ranks(size_t n, double share, double confidence, size_t *low,
                               size_t *high) {
    double p = 0.5 * (1 - confidence);
    unsigned all = (unsigned)n;
    /* the most ranks below with P(B <= rank - 1) <= p */
    size_t a = 0, b = n;
    while (a < b) {
        size_t middle = b - (b - a) / 2;
        if (gsl_cdf_binomial_P((unsigned)middle - 1, share, all) <= p) {
            a = middle;
        } else {
            b = middle - 1;
        }
    }
    *low = a;
    /* the least rank with P(B > rank - 1) <= p */
    a = 1;
    b = n + 1;
    while (a < b) {
        size_t middle = a + (b - a) / 2;
        if (gsl_cdf_binomial_Q((unsigned)middle - 1, share, all) <= p) {
            b = middle;
        } else {
            a = middle + 1;
        }
    }
    *high = a;
}
