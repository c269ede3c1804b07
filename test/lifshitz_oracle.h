/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The exact dispersion force of two plane faces, by Lifshitz, from what is published of silicon and
 * silica. */
#ifndef HAFT_TEST_LIFSHITZ_ORACLE_H
#define HAFT_TEST_LIFSHITZ_ORACLE_H

#include <math.h>

#include <gsl/gsl_integration.h>

#include "haft/contact.h"

/* Permittivity at imaginary frequencies, 1 + rest + sum strength/(1 + (xi/frequency)^2). */
typedef struct material {
    const char *name;
    double rest;
    int n;
    double strength[8], frequency[8]; /* [rad/s] */
} material;

#define EV (1.602176634e-19 / 1.054571817e-34)

/* Silicon: Lambrecht, Pirozhenko, Duraffourg and Andreucci (2007), EPL 77, 44006, as Davids et al.
 * (2010), Phys. Rev. A 82, 062111 have it: 1.035 + (11.87 - 1.035)/(1 + (xi/omega_0)^2). */
static const material silicon = {"silicon", 0.035, 1, {10.835}, {6.6e15}};

/* Silica by oscillators of Hough and White (1980). The first are of Bergstroem (1997), Adv. Colloid
 * Interface Sci. 70, 125, quoted from memory: they give his Hamaker constant of 65.0 zJ. The second
 * are the first set of van Zwol and Palasantzas (2010), Phys. Rev. A 81, 062502, fitted from the
 * infrared to soft X-rays, as a published program quotes them. How far the two are apart is how
 * well the constants of silica are known. */
static const material silica = {
    "silica (1997)", 0, 4, {0.829, 0.095, 0.798, 1.098}, {0.867e14, 1.508e14, 2.026e14, 2.034e16},
};
static const material silica_2 = {
    "silica (2010)",
    0,
    8,
    {0.784, 0.203, 0.417, 0.393, 0.0501, 0.820, 0.217, 0.0550},
    {0.0411 * EV, 0.112 * EV, 0.112 * EV, 0.111 * EV, 14.5 * EV, 17.0 * EV, 8.14 * EV, 91.6 * EV},
};

static const material mirror = {"mirror", 1e13, 0, {0}, {0}};

static double permittivity(const material *m, double xi) {
    double sum = 1 + m->rest;
    for (int i = 0; i < m->n; i++) {
        double x = xi / m->frequency[i];
        sum += m->strength[i] / (1 + x * x);
    }
    return sum;
}

/* Two equal faces, bare or each under a layer. */
typedef struct wall {
    const material *substrate, *layer;
    double thickness;
} wall;

static const double light = 299792458.0, planck = 1.054571817e-34, boltzmann = 1.380649e-23;

/* Reflection off the face from vacuum, p and s the decay there and below; Parsegian (2006), L2.2
 * and L2.3, with the layer as a second plane. */
static double reflect(bool magnetic, double e, double s, double e_below, double s_below) {
    return magnetic ? (e_below * s - e * s_below) / (e_below * s + e * s_below)
                    : (s - s_below) / (s + s_below);
}

static double reflection(const wall *w, bool magnetic, double xi, double p) {
    double q = xi / light, es = permittivity(w->substrate, xi);
    double ss = sqrt(p * p + (es - 1) * q * q);
    if (w->thickness == 0) {
        return reflect(magnetic, 1, p, es, ss);
    }
    double el = permittivity(w->layer, xi), sl = sqrt(p * p + (el - 1) * q * q);
    double outer = reflect(magnetic, 1, p, el, sl), inner = reflect(magnetic, el, sl, es, ss);
    inner *= exp(-2 * sl * w->thickness);
    return (outer + inner) / (1 + outer * inner);
}

/* Adds the integral over p of one frequency: x = 2 p g from 2 xi g/c on. */
static void add_frequency(const wall *w, double gap, double xi, double weight,
                          const gsl_integration_glfixed_table *rule, haft_dispersion_value *sum) {
    static const double edge[] = {0, 0.1, 0.3, 1, 2, 4, 8, 16, 40};
    double start = 2 * xi * gap / light;
    for (size_t k = 0; k + 1 < sizeof edge / sizeof *edge; k++) {
        for (size_t i = 0; i < 10; i++) {
            double x, h;
            gsl_integration_glfixed_point(start + edge[k], start + edge[k + 1], i, &x, &h, rule);
            double p = x / (2 * gap);
            for (int magnetic = 0; magnetic < 2; magnetic++) {
                double r = reflection(w, magnetic, xi, p), part = r * r * exp(-x);
                sum->energy += weight * h / (2 * gap) * p * log1p(-part);
                sum->pressure += weight * h / (2 * gap) * 2 * p * p * part / (1 - part);
            }
        }
    }
}

/* Energy kT/(2 pi) sum' int p dp ln(1 - r^2 exp(-2 p g)) at a temperature, and its derivative by g,
 * over the Matsubara frequencies (Lifshitz 1956; Parsegian 2006, L1 and L2). */
static haft_dispersion_value lifshitz(const wall *w, double gap, double temperature) {
    gsl_integration_glfixed_table *rule = gsl_integration_glfixed_table_alloc(10);
    haft_dispersion_value sum = {0};
    double unit = boltzmann * temperature / (2 * M_PI);
    for (int n = 0;; n++) {
        double xi = 2 * M_PI * boltzmann * temperature / planck * n;
        if (2 * xi * gap / light > 30) {
            break;
        }
        add_frequency(w, gap, xi, n == 0 ? unit / 2 : unit, rule, &sum);
    }
    gsl_integration_glfixed_table_free(rule);
    return sum;
}

#endif
