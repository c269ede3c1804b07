/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gaussian kernels of one bandwidth around m centres, and their conditional distributions, one
 * coordinate at a time (private to the room). Coordinates are in the order of the Rosenblatt
 * map. */
#ifndef HAFT_CHAOS_MIXTURE_H
#define HAFT_CHAOS_MIXTURE_H

#include <stdint.h>

#include "haft/chaos.h"

enum { CHAOS_BIN_LIMIT = 256 };

/* One coordinate of the centres. Bins of a quarter of the bandwidth (wider if there would be too
 * many) replace the centres for a first guess. */
typedef struct chaos_axis {
    double *centre; /* [padded m] */
    uint16_t *bin;  /* [padded m] */
    size_t bins;
    double low, width; /* bin b begins at low + b width */
} chaos_axis;

/* The contents of each bin: weight, and first and second moment about the bin's beginning. */
typedef struct chaos_bins {
    double weight[CHAOS_BIN_LIMIT], first[CHAOS_BIN_LIMIT], second[CHAOS_BIN_LIMIT];
} chaos_bins;

/* Two points a bin, with its weight, mean and variance. */
typedef struct chaos_rough {
    size_t n; /* padded; 0: the centres are too few to be worth it */
    double centre[2 * CHAOS_BIN_LIMIT], weight[2 * CHAOS_BIN_LIMIT];
} chaos_rough;

/* A weighted sum of normals of bandwidth h on a line; borrows its arrays. */
typedef struct chaos_line {
    double h;
    size_t n; /* padded */
    const double *centre, *weight;
    double total;     /* of the weights */
    double low, high; /* of the centres that weigh */
    const chaos_rough *rough;
} chaos_line;

/* Arrays for one conditional distribution. */
struct haft_chaos_work {
    double *exponent, *centre, *weight; /* [padded m] */
    uint32_t *chosen;                   /* [padded m] */
    chaos_bins bins;
    chaos_rough rough;
};

typedef struct chaos_mixture {
    size_t m, directions;
    double h;
    double *memory;
    chaos_axis axis[HAFT_CHAOS_DIMENSION];
    double *equal;                          /* [padded m], weights before anything is known */
    chaos_line first[HAFT_CHAOS_DIMENSION]; /* marginal law of each coordinate */
    chaos_rough *rough;                     /* [directions], of the marginal laws */
} chaos_mixture;

/* Copies centres [m][directions]; coordinate i is column order[i], times scale. */
haft_status haft_chaos_mixture_init(chaos_mixture *out, size_t m, size_t directions,
                                    const double *centre, const size_t *order, double scale,
                                    double h, haft_error *error) HAFT_MUST_CHECK;
void haft_chaos_mixture_clear(chaos_mixture *mixture);

/* The distribution of coordinate i given x[0 .. i - 1]; it is kept in the arrays of `work` until
 * their next use. */
chaos_line haft_chaos_mixture_condition(const chaos_mixture *mixture, haft_chaos_work *work,
                                        size_t i, const double *x);

/* CDF at x and its complement, each to round-off of itself. */
void haft_chaos_line_cdf(const chaos_line *line, double x, double *p, double *q);

/* CDF at x, to round-off of 1, and density. */
double haft_chaos_line_value(const chaos_line *line, double x, double *density);

/* The point at which the CDF is p and its complement q; the smaller of the two is used. */
double haft_chaos_line_quantile(const chaos_line *line, double p, double q);

#endif
