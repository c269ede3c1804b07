/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Conditional distributions of a Gaussian mixture. Given the earlier coordinates, a coordinate
 * is again distributed as a mixture, in which each centre is weighted by the kernels of those
 * coordinates. Weights are kept as logarithms until the greatest is known, so that far from all
 * data the nearest centre gets the whole weight. Centres with less than m^-1 e^-75 of the
 * greatest weight are dropped; together they hold less than e^-75 = 3e-33 of the probability. */
#include "chaos/mixture.h"
#include "chaos/model.h"

#include <math.h>
#include <string.h>

#include "chaos/normal.h"

#define NEGLIGIBLE 75.0

/* With fewer centres than this, bins save nothing. */
enum { FEW = 256 };

static void fill_bins(chaos_axis *axis, size_t m, double h) {
    double low = axis->centre[0], high = low;
    for (size_t k = 1; k < m; k++) {
        low = fmin(low, axis->centre[k]);
        high = fmax(high, axis->centre[k]);
    }
    axis->low = low;
    axis->width = fmax(0.25 * h, (high - low) / (CHAOS_BIN_LIMIT - 1));
    for (size_t k = 0; k < m; k++) {
        axis->bin[k] = (uint16_t)((axis->centre[k] - low) / axis->width);
    }
    axis->bins = (size_t)((high - low) / axis->width) + 1;
}

static void open_bins(const chaos_axis *axis, chaos_bins *bins) {
    memset(bins->weight, 0, axis->bins * sizeof(double));
    memset(bins->first, 0, axis->bins * sizeof(double));
    memset(bins->second, 0, axis->bins * sizeof(double));
}

static inline void put(const chaos_axis *axis, chaos_bins *bins, size_t b, double centre,
                       double weight) {
    double d = centre - (axis->low + (double)b * axis->width);
    bins->weight[b] += weight;
    bins->first[b] += weight * d;
    bins->second[b] += weight * d * d;
}

/* Represents a bin by two points, one standard deviation to either side of its mean; empty bins
 * are left out. */
static void close_bins(const chaos_axis *axis, const chaos_bins *bins, chaos_rough *rough) {
    size_t n = 0;
    for (size_t b = 0; b < axis->bins; b++) {
        if (bins->weight[b] > 0) {
            double mean = bins->first[b] / bins->weight[b];
            double deviation = sqrt(fmax(0, bins->second[b] / bins->weight[b] - mean * mean));
            double at = axis->low + (double)b * axis->width + mean;
            rough->weight[n] = rough->weight[n + 1] = 0.5 * bins->weight[b];
            rough->centre[n++] = at - deviation;
            rough->centre[n++] = at + deviation;
        }
    }
    rough->n = chaos_padded(n);
    for (size_t k = n; k < rough->n; k++) {
        rough->weight[k] = 0;
        rough->centre[k] = rough->centre[0];
    }
}

static void set_limits(chaos_line *line, size_t n) {
    line->low = line->high = line->centre[0];
    for (size_t k = 0; k < n; k++) {
        double c = line->centre[k];
        line->low = c < line->low ? c : line->low;
        line->high = c > line->high ? c : line->high;
        line->total += line->weight[k];
    }
}

static void make_first(chaos_mixture *mixture, size_t i, chaos_bins *bins) {
    const chaos_axis *axis = &mixture->axis[i];
    chaos_line *line = &mixture->first[i];
    *line = (chaos_line){.h = mixture->h,
                         .n = chaos_padded(mixture->m),
                         .centre = axis->centre,
                         .weight = mixture->equal};
    set_limits(line, mixture->m);
    if (mixture->m > FEW) {
        open_bins(axis, bins);
        for (size_t k = 0; k < mixture->m; k++) {
            put(axis, bins, axis->bin[k], axis->centre[k], 1);
        }
        close_bins(axis, bins, &mixture->rough[i]);
        line->rough = &mixture->rough[i];
    }
}

haft_status haft_chaos_mixture_init(chaos_mixture *out, size_t m, size_t directions,
                                    const double *centre, const size_t *order, double scale,
                                    double h, haft_error *error) {
    size_t padded = chaos_padded(m);
    chaos_bins bins;
    *out = (chaos_mixture){.m = m, .directions = directions, .h = h};
    out->memory = haft_memory_alloc(padded * (directions + 1), sizeof(double), error);
    out->rough = haft_memory_alloc(directions, sizeof *out->rough, error);
    if (out->memory == NULL || out->rough == NULL) {
        haft_chaos_mixture_clear(out);
        return HAFT_ERROR_MEMORY;
    }
    out->equal = out->memory + padded * directions;
    for (size_t k = 0; k < m; k++) {
        out->equal[k] = 1;
    }
    for (size_t i = 0; i < directions; i++) {
        chaos_axis *axis = &out->axis[i];
        axis->centre = out->memory + i * padded;
        axis->bin = haft_memory_alloc(padded, sizeof *axis->bin, error);
        if (axis->bin == NULL) {
            haft_chaos_mixture_clear(out);
            return HAFT_ERROR_MEMORY;
        }
        for (size_t k = 0; k < padded; k++) {
            axis->centre[k] = scale * centre[(k < m ? k : 0) * directions + order[i]];
        }
        fill_bins(axis, m, h);
        make_first(out, i, &bins);
    }
    return HAFT_OK;
}

void haft_chaos_mixture_clear(chaos_mixture *mixture) {
    for (size_t i = 0; i < HAFT_CHAOS_DIMENSION; i++) {
        haft_memory_free(mixture->axis[i].bin);
    }
    haft_memory_free(mixture->rough);
    haft_memory_free(mixture->memory);
    *mixture = (chaos_mixture){0};
}

/* Logarithms of the weights, up to a constant, and the greatest. */
static double weigh(const chaos_mixture *mixture, size_t i, const double *x, double *exponent) {
    double factor = -0.5 / (mixture->h * mixture->h);
    for (size_t j = 0; j < i; j++) {
        const double *restrict c = mixture->axis[j].centre;
        double at = x[j];
        for (size_t k = 0; k < mixture->m; k++) {
            double d = c[k] - at;
            exponent[k] = (j == 0 ? 0 : exponent[k]) + d * d * factor;
        }
    }
    double greatest = exponent[0];
    for (size_t k = 1; k < mixture->m; k++) {
        greatest = exponent[k] > greatest ? exponent[k] : greatest;
    }
    return greatest;
}

static size_t choose(const chaos_mixture *mixture, size_t i, double greatest,
                     haft_chaos_work *work) {
    const double *restrict c = mixture->axis[i].centre;
    double least = greatest - NEGLIGIBLE - log((double)mixture->m);
    size_t n = 0;
    for (size_t k = 0; k < mixture->m; k++) {
        work->chosen[n] = (uint32_t)k;
        work->centre[n] = c[k];
        work->weight[n] = work->exponent[k] - greatest;
        n += work->exponent[k] >= least;
    }
    return n;
}

chaos_line haft_chaos_mixture_condition(const chaos_mixture *mixture, haft_chaos_work *work,
                                        size_t i, const double *x) {
    if (i == 0) {
        return mixture->first[0];
    }
    double greatest = weigh(mixture, i, x, work->exponent);
    size_t n = choose(mixture, i, greatest, work), padded = chaos_padded(n);
    for (size_t k = n; k < padded; k++) {
        work->centre[k] = work->centre[0];
        work->weight[k] = 0;
    }
    haft_chaos_exponentials(padded, work->weight, work->weight);
    for (size_t k = n; k < padded; k++) {
        work->weight[k] = 0;
    }
    chaos_line line = {
        .h = mixture->h, .n = padded, .centre = work->centre, .weight = work->weight};
    set_limits(&line, n);
    if (n > FEW) {
        const chaos_axis *axis = &mixture->axis[i];
        open_bins(axis, &work->bins);
        for (size_t k = 0; k < n; k++) {
            put(axis, &work->bins, axis->bin[work->chosen[k]], work->centre[k], work->weight[k]);
        }
        close_bins(axis, &work->bins, &work->rough);
        line.rough = &work->rough;
    }
    return line;
}

haft_status haft_chaos_work_create(haft_chaos_work **out, const haft_chaos *chaos,
                                   haft_error *error) {
    const haft_chaos_parts parts = chaos->parts;
    size_t padded = chaos_padded(parts.m);
    *out = NULL;
    haft_chaos_work *work = haft_memory_alloc(1, sizeof *work, error);
    if (work == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    work->exponent = haft_memory_alloc(3 * padded, sizeof(double), error);
    work->chosen = haft_memory_alloc(padded, sizeof *work->chosen, error);
    if (work->exponent == NULL || work->chosen == NULL) {
        haft_chaos_work_destroy(&work);
        return HAFT_ERROR_MEMORY;
    }
    work->centre = work->exponent + padded;
    work->weight = work->centre + padded;
    *out = work;
    return HAFT_OK;
}

void haft_chaos_work_destroy(haft_chaos_work **work) {
    if (work != NULL && *work != NULL) {
        haft_memory_free((*work)->exponent);
        haft_memory_free((*work)->chosen);
        haft_memory_free(*work);
        *work = NULL;
    }
}
