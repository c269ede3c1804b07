/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of a marginal (private to the room). */
#ifndef HAFT_SURFACE_MARGINAL_H
#define HAFT_SURFACE_MARGINAL_H

#include "haft/surface.h"

enum { MARGINAL_KNOTS = 4097, MARGINAL_TERMS = 32 };
#define MARGINAL_REACH 8.5

struct haft_marginal {
    haft_marginal_facts facts;
    /* At g = -MARGINAL_REACH + i h: q and h q'. */
    struct {
        double value, slope;
    } knot[MARGINAL_KNOTS];
    /* Squared Hermite coefficients: E[q(g) q(g')] = sum of energy[n] rho^n over n >= 1. Their sum
     * is 1. */
    double energy[MARGINAL_TERMS];
};

/* scale_out * q(scale_in * z) in place. */
void haft_marginal_apply(const haft_marginal *marginal, double scale_in, double scale_out, size_t n,
                         double *z);

/* Whether q is the identity: then the Gaussian surface needs no transformation. */
bool haft_marginal_is_normal(const haft_marginal *marginal);

/* E[q(g) q(g')] for normals of correlation rho. */
double haft_marginal_correlation(const haft_marginal *marginal, double rho);

#endif
