/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Spatial correlation along seamless surfaces. Realizations are independent, sites are not, so
 * the error is estimated by leaving out one realization at a time (jackknife). Each realization
 * contributes four sums to a lag, from which all estimates follow for any mean, in one pass. */
#include "haft/study.h"

#include <math.h>

/* Of the pairs of one realization at one lag: their number, sum of products, sum of both. */
typedef struct sums {
    double pairs, product, both;
} sums;

static void add(sums *to, const sums *from, double sign) {
    to->pairs += sign * from->pairs;
    to->product += sign * from->product;
    to->both += sign * from->both;
}

/* Mean of (x - mean) (y - mean) over the pairs. */
static double covariance(const sums *s, double mean) {
    return (s->product - mean * s->both + mean * mean * s->pairs) / s->pairs;
}

/* At lag 0 every number is paired with itself: that gives mean and variance. */
static double ratio(const sums *lag, const sums *self) {
    double mean = 0.5 * self->both / self->pairs;
    return covariance(lag, mean) / covariance(self, mean);
}

static sums sum_pairs(size_t sites, const double *x, size_t stride, size_t lag, double centre) {
    sums s = {0};
    for (size_t r = 0; r + lag < sites; r++) {
        double a = x[r * stride] - centre, b = x[(r + lag) * stride] - centre;
        if (isfinite(a) && isfinite(b)) {
            s.pairs++;
            s.product += a * b;
            s.both += a + b;
        }
    }
    return s;
}

/* A number near the mean, to avoid cancellation. */
static double find_centre(size_t n, const double *x, size_t stride) {
    double sum = 0;
    size_t count = 0;
    for (size_t k = 0; k < n; k++) {
        if (isfinite(x[k * stride])) {
            sum += x[k * stride];
            count++;
        }
    }
    return count > 0 ? sum / (double)count : 0;
}

static double jackknife(size_t realizations, size_t lags, const sums *each, const sums *all,
                        size_t lag) {
    double mean = 0, squares = 0, n = 0;
    for (size_t j = 0; j < realizations; j++) {
        sums l = all[lag], self = all[0];
        add(&l, &each[j * (lags + 1) + lag], -1);
        add(&self, &each[j * (lags + 1)], -1);
        double value = ratio(&l, &self), delta = value - mean;
        n++;
        mean += delta / n;
        squares += delta * (value - mean);
    }
    return realizations > 1 ? sqrt(squares * (n - 1) / n) : NAN;
}

haft_status haft_study_correlation(size_t realizations, size_t sites, const double *x,
                                   size_t stride, size_t lags, haft_correlation *out,
                                   haft_error *error) {
    sums *each = haft_memory_alloc((realizations + 1) * (lags + 1), sizeof *each, error);
    if (each == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    sums *all = each + realizations * (lags + 1);
    double centre = find_centre(realizations * sites, x, stride);
    for (size_t j = 0; j < realizations; j++) {
        for (size_t l = 0; l <= lags; l++) {
            sums s = sum_pairs(sites, x + j * sites * stride, stride, l, centre);
            each[j * (lags + 1) + l] = s;
            add(&all[l], &s, 1);
        }
    }
    for (size_t l = 0; l <= lags; l++) {
        out[l] = (haft_correlation){.value = ratio(&all[l], &all[0]),
                                    .error = jackknife(realizations, lags, each, all, l),
                                    .pairs = (size_t)all[l].pairs};
    }
    haft_memory_free(each);
    return HAFT_OK;
}

haft_status haft_study_correlate_laws(const haft_laws *laws, size_t lags,
                                      haft_correlation *const out[4], haft_error *error) {
    const double *number[4] = {&laws->vector->e, &laws->vector->f_max, &laws->vector->d_max,
                               &laws->vector->d_limit};
    size_t stride = sizeof *laws->vector / sizeof(double);
    haft_status status = HAFT_OK;
    for (int i = 0; i < 4 && status == HAFT_OK; i++) {
        status = haft_study_correlation(laws->m / laws->sites, laws->sites, number[i], stride, lags,
                                        out[i], error);
    }
    return status;
}
