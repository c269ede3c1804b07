/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dispersion forces averaged over heights: those of a surface, counted in bins, and normal ones. */
#include <math.h>

#include "contact/dispersion.h"

/* Heights spread evenly over a width about a mean. */
typedef struct bin {
    double mean, width, share;
} bin;

struct haft_height_bins {
    size_t n;
    bin *bin;
};

/* While counting, a bin holds sums: of x into mean, of x^2 into width, x from its middle. */
typedef struct counting {
    double low, step;
    size_t n;
} counting;

static double middle_of(const counting *c, size_t i) {
    return c->low + ((double)i + 0.5) * c->step;
}

static void count(const counting *c, const double *z, size_t n, bin *bins) {
    for (size_t j = 0; j < n; j++) {
        double at = c->step > 0 ? (z[j] - c->low) / c->step : 0;
        size_t i = at < (double)c->n ? (size_t)at : c->n - 1;
        double x = z[j] - middle_of(c, i);
        bins[i].share += 1;
        bins[i].mean += x;
        bins[i].width += x * x;
    }
}

/* Makes of the sums what haft_height_bins holds. @return how many bins are not empty */
static size_t settle(const counting *c, size_t n, bin *bins) {
    size_t kept = 0;
    for (size_t i = 0; i < c->n; i++) {
        bin b = bins[i];
        if (b.share > 0) {
            double mean = b.mean / b.share;
            double variance = fmax(b.width / b.share - mean * mean, 0);
            /* rounding would leave equal heights a width */
            double width = variance > 1e-20 * c->step * c->step ? sqrt(12 * variance) : 0;
            bins[kept++] = (bin){middle_of(c, i) + mean, width, b.share / (double)n};
        }
    }
    return kept;
}

static haft_status bounds_of(const double *z, size_t n, double *low, double *high,
                             haft_error *error) {
    *low = *high = z[0];
    for (size_t j = 0; j < n; j++) {
        if (!isfinite(z[j])) {
            return haft_error_set(error, HAFT_ERROR_INPUT, "height %zu of %zu is %g", j + 1, n,
                                  z[j]);
        }
        *low = fmin(*low, z[j]);
        *high = fmax(*high, z[j]);
    }
    return HAFT_OK;
}

haft_status haft_height_bins_create(haft_height_bins **out, const double *z, size_t n, size_t bins,
                                    haft_error *error) {
    *out = NULL;
    if (n == 0 || bins == 0) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                              "%zu heights in %zu bins; there must be one of each at least", n,
                              bins);
    }
    double low, high;
    HAFT_TRY(bounds_of(z, n, &low, &high, error));
    counting c = {low, (high - low) / (double)bins, bins};
    haft_height_bins *made = haft_memory_alloc(1, sizeof *made, error);
    if (made == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    made->bin = haft_memory_alloc(bins, sizeof *made->bin, error);
    if (made->bin == NULL) {
        haft_memory_free(made);
        return HAFT_ERROR_MEMORY;
    }
    count(&c, z, n, made->bin);
    made->n = settle(&c, n, made->bin);
    *out = made;
    return HAFT_OK;
}

void haft_height_bins_destroy(haft_height_bins **bins) {
    if (bins == NULL || *bins == NULL) {
        return;
    }
    haft_memory_free((*bins)->bin);
    haft_memory_free(*bins);
    *bins = NULL;
}

static void add(haft_dispersion_value *sum, double weight, haft_dispersion_value value) {
    sum->energy += weight * value.energy;
    sum->pressure += weight * value.pressure;
    sum->slope += weight * value.slope;
}

/* What a point at the cut-off or nearer has: the energy there, and no force. */
static haft_dispersion_value inside(haft_dispersion_value at_cut_off) {
    return (haft_dispersion_value){.energy = at_cut_off.energy};
}

/* Adds gaps spread evenly over a width, of which the cut-off may part some. */
static void add_spread(haft_dispersion_value *sum, const haft_dispersion_terms *terms, double cut,
                       haft_dispersion_value at_cut, double gap, double width, double share) {
    double low = gap - width / 2, high = gap + width / 2;
    if (!(high > cut)) {
        add(sum, share, inside(at_cut));
    } else if (low > cut || !(width > 0)) {
        add(sum, share, haft_dispersion_mean(terms, low, high));
    } else {
        double free = (high - cut) / width;
        add(sum, share * free, haft_dispersion_mean(terms, cut, high));
        add(sum, share * (1 - free), inside(at_cut));
        sum->slope += share / width * at_cut.pressure; /* of points that leave the cut-off */
    }
}

haft_dispersion_value haft_dispersion_average(const haft_dispersion *law,
                                              const haft_height_bins *bins, double distance) {
    haft_dispersion_terms terms = haft_dispersion_terms_of(law);
    haft_dispersion_value at_cut = haft_dispersion_sum(&terms, law->cut_off), sum = {0};
    for (size_t i = 0; i < bins->n; i++) {
        bin b = bins->bin[i];
        add_spread(&sum, &terms, law->cut_off, at_cut, distance - b.mean, b.width, b.share);
    }
    return sum;
}

enum { HALF_NODES = 5 };

/* Gauss's quadrature of 10 nodes over an interval, on it the law times the density of gaps. */
static void add_panel(haft_dispersion_value *sum, const haft_dispersion_terms *terms, double low,
                      double high, double distance, double rms) {
    static const double node[HALF_NODES] = {0.97390652851717172, 0.86506336668898451,
                                            0.67940956829902441, 0.43339539412924719,
                                            0.14887433898163121};
    static const double weight[HALF_NODES] = {0.066671344308688138, 0.14945134915058059,
                                              0.21908636251598204, 0.26926671930999636,
                                              0.29552422471475287};
    double middle = (low + high) / 2, half = (high - low) / 2;
    for (int i = 0; i < 2 * HALF_NODES; i++) {
        double gap = middle + (i % 2 == 0 ? half : -half) * node[i / 2];
        double x = (gap - distance) / rms;
        double density = exp(-x * x / 2) / (rms * sqrt(2 * M_PI));
        add(sum, half * weight[i / 2] * density, haft_dispersion_sum(terms, gap));
    }
}

haft_dispersion_value haft_dispersion_gaussian(const haft_dispersion *law, double rms,
                                               double distance) {
    haft_dispersion_terms terms = haft_dispersion_terms_of(law);
    double cut = law->cut_off;
    haft_dispersion_value at_cut = haft_dispersion_sum(&terms, cut), sum = {0};
    if (!(rms > 1e-10 * fabs(distance))) { /* lost in the rounding of gaps */
        add_spread(&sum, &terms, cut, at_cut, distance, 0, 1);
        return sum;
    }
    const double tail = 12 * rms; /* beyond are 1e-32 of the points */
    double x = (distance - cut) / rms, high = distance + tail;
    add(&sum, 0.5 * erfc(x / sqrt(2)), inside(at_cut));
    sum.slope += exp(-x * x / 2) / (rms * sqrt(2 * M_PI)) * at_cut.pressure;
    /* The law changes over the gap itself, the density over the rms; neither by much in a panel. */
    for (double low = fmax(cut, distance - tail); low < high;) {
        double next = fmin(low + fmin(low, rms), high);
        add_panel(&sum, &terms, low, next, distance, rms);
        low = next;
    }
    return sum;
}
