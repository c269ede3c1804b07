/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The kernel K(r) = h int_0^zeta_max sqrt(s(k)) J0(k r) k dk (h: lattice step), whose sum of
 * squares over the lattice is the variance m0, times a taper w(r).
 *
 * The plateau's part is a closed form; the power law's is computed by Gauss-Legendre quadrature in
 * panels of at most 80 radians. K is tabulated with spacing 0.2/zeta_max and read by 12-point
 * Lagrange interpolation, with a relative error of about 1e-13.
 *
 * The taper is 1 up to 0.6 of the reach R. Beyond, it is 1 minus the normalised integral of the
 * bump exp(beta (sqrt(1 - x^2) - 1)), stretched over [0.6 R, R] (Barnett, Magland and af Klinteberg
 * 2019). With beta = 24 the bump's spectrum is exp(-24) = 4e-11 beyond beta / half-width. So the
 * sharp end of the PSD, where its root is 1e-3 to 1e-2 of the plateau's, is smeared over smear = 5
 * beta / R; what is beyond is below round-off, and blocks join to 1e-13 of the rms. */
#include "surface/kernel.h"

#include <gsl/gsl_integration.h>
#include <math.h>
#include <string.h>

enum { NODES = 40, CHUNK = 256, STENCIL = 12, BUMP_NODES = 8 };

static const double BETA = 24;
static const double FLAT_SHARE = 0.6;
static const double PANEL_PHASE = 80;
static const double TABLE_PHASE = 0.2;
static const double LONGEST_PHASE = 4000; /* zeta_max times the longest reach allowed */

/* Nodes k and weights w sqrt(s) k dk of the power law's panels, accurate for radii up to
 * `radius`. */
static size_t power_law_nodes(const haft_psd *psd, const gsl_integration_glfixed_table *rule,
                              double radius, double *node, double *weight) {
    double span = psd->zeta_max - psd->zeta_0;
    size_t by_phase = (size_t)ceil(span * radius / PANEL_PHASE);
    /* The power law is smooth over any panel narrower than zeta_0 / 2. */
    size_t by_width = (size_t)ceil(2 * span / psd->zeta_0);
    size_t panels = by_phase > by_width ? by_phase : by_width;
    size_t n = 0;
    for (size_t i = 0; i < panels; i++) {
        double a = psd->zeta_0 + span * (double)i / (double)panels;
        double b = psd->zeta_0 + span * (double)(i + 1) / (double)panels;
        for (size_t q = 0; q < NODES; q++, n++) {
            gsl_integration_glfixed_point(a, b, q, node + n, weight + n, rule);
            weight[n] *= sqrt(haft_psd_value(psd, node[n])) * node[n];
        }
    }
    return n;
}

/* Number of panels between points k and k + 1. */
static size_t table_panels(const haft_psd_table *table, size_t k, double radius) {
    double span = table->zeta[k + 1] - table->zeta[k];
    return 1 + (size_t)(span * radius / PANEL_PHASE) + (size_t)(span / table->zeta[k]);
}

/* The same for a table, which is a power law between points. The panels are short enough for the
 * oscillation and for the power. */
static size_t table_nodes(const haft_psd_table *table, const gsl_integration_glfixed_table *rule,
                          double radius, double *node, double *weight) {
    size_t n = 0;
    for (size_t k = 0; k + 1 < table->n; k++) {
        size_t panels = table_panels(table, k, radius);
        double span = table->zeta[k + 1] - table->zeta[k];
        for (size_t i = 0; i < panels; i++) {
            double a = table->zeta[k] + span * (double)i / (double)panels;
            double b = table->zeta[k] + span * (double)(i + 1) / (double)panels;
            for (size_t q = 0; q < NODES; q++, n++) {
                gsl_integration_glfixed_point(a, b, q, node + n, weight + n, rule);
                weight[n] *= sqrt(haft_psd_table_value(table, node[n])) * node[n];
            }
        }
    }
    return n;
}

static double plateau_share(const haft_psd *psd, double r) {
    double x = psd->zeta_0 * r;
    double shape = x < 1e-8 ? 0.5 : j1(x) / x;
    return sqrt(psd->s_0) * psd->zeta_0 * psd->zeta_0 * shape;
}

/* Fills table[first..n) with the kernel without taper. */
static haft_status fill_table(const surface_kernel *kernel, const surface_radial *radial,
                              size_t first, size_t n, haft_error *error) {
    const haft_psd *psd = &radial->psd;
    double span = psd->zeta_max - psd->zeta_0;
    double panels = span * (double)n * kernel->spacing / PANEL_PHASE + 2 * span / psd->zeta_0 + 2;
    for (size_t k = 0; radial->table != NULL && k + 1 < radial->table->n; k++) {
        panels += (double)table_panels(radial->table, k, (double)n * kernel->spacing);
    }
    size_t capacity = (size_t)panels * NODES;
    double *node = haft_memory_alloc(capacity, sizeof *node, error);
    double *weight = haft_memory_alloc(capacity, sizeof *weight, error);
    gsl_integration_glfixed_table *rule = gsl_integration_glfixed_table_alloc(NODES);
    haft_status status =
        node != NULL && weight != NULL && rule != NULL ? HAFT_OK : HAFT_ERROR_MEMORY;
    for (size_t start = first; start < n && status == HAFT_OK; start += CHUNK) {
        size_t end = start + CHUNK < n ? start + CHUNK : n;
        double radius = (double)end * kernel->spacing;
        size_t nodes = radial->table != NULL
                           ? table_nodes(radial->table, rule, radius, node, weight)
                           : power_law_nodes(psd, rule, radius, node, weight);
        for (size_t i = start; i < end; i++) {
            double r = (double)i * kernel->spacing;
            double sum = plateau_share(psd, r);
            for (size_t q = 0; q < nodes; q++) {
                sum += weight[q] * j0(node[q] * r);
            }
            kernel->table[i] = kernel->lattice_step * sum;
        }
    }
    if (rule == NULL) {
        haft_error_set(error, HAFT_ERROR_MEMORY, "out of memory for a quadrature rule");
    } else {
        gsl_integration_glfixed_table_free(rule);
    }
    haft_memory_free(node);
    haft_memory_free(weight);
    return status;
}

/* Lengthens the table to n entries. */
static haft_status extend_table(surface_kernel *kernel, const surface_radial *radial, size_t n,
                                haft_error *error) {
    double *longer = haft_memory_alloc(n, sizeof *longer, error);
    if (longer == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    size_t first = kernel->n;
    if (first > 0) {
        memcpy(longer, kernel->table, first * sizeof *longer);
    }
    haft_memory_free(kernel->table);
    kernel->table = longer;
    kernel->n = n;
    return fill_table(kernel, radial, first, n, error);
}

static double bump_integral(double a, double b, const gsl_integration_glfixed_table *rule) {
    double sum = 0;
    for (size_t q = 0; q < BUMP_NODES; q++) {
        double x = 0, weight = 0;
        gsl_integration_glfixed_point(a, b, q, &x, &weight, rule);
        sum += weight * exp(BETA * (sqrt(fmax(0, 1 - x * x)) - 1));
    }
    return sum;
}

/* Taper at the table's points for a given reach: taper[0..n). */
static void fill_taper(const surface_kernel *kernel, double reach,
                       const gsl_integration_glfixed_table *rule, double *taper) {
    double middle = 0.5 * (1 + FLAT_SHARE) * reach, half = 0.5 * (1 - FLAT_SHARE) * reach;
    double last = -1, sum = 0;
    for (size_t i = 0; i < kernel->n; i++) {
        double x = fmin(1, fmax(-1, ((double)i * kernel->spacing - middle) / half));
        if (x > last) {
            sum += bump_integral(last, x, rule);
            last = x;
        }
        taper[i] = sum;
    }
    for (size_t i = 0; i < kernel->n; i++) {
        taper[i] = (double)i * kernel->spacing >= reach ? 0 : 1 - taper[i] / sum;
    }
}

/* Share of the kernel's energy that a taper removes, by Boole's rule on the table; the total is int
 * K^2 = h^2 m0, by Parseval. */
static double taper_loss(const surface_kernel *kernel, const surface_radial *radial,
                         const double *taper) {
    static const double weight[4] = {14, 32, 12, 32};
    double sum = 0;
    for (size_t i = 1; i < kernel->n; i++) {
        double value = kernel->table[i] * taper[i];
        sum += weight[i % 4] * value * value * (double)i;
    }
    double energy = 2 * M_PI * sum * kernel->spacing * kernel->spacing * 2 / 45;
    double h = kernel->lattice_step;
    return 1 - energy / (h * h * haft_surface_radial_variance(radial));
}

/* The smallest halo in lattice steps whose loss is within the tolerance, if that of `most` is. */
static size_t shortest_halo(const surface_kernel *kernel, const surface_radial *radial, size_t most,
                            double tolerance, const gsl_integration_glfixed_table *rule,
                            double *taper) {
    size_t least = 0;
    while (most - least > 1) {
        size_t middle = least + (most - least) / 2;
        fill_taper(kernel, (double)middle * kernel->lattice_step, rule, taper);
        if (taper_loss(kernel, radial, taper) <= tolerance) {
            most = middle;
        } else {
            least = middle;
        }
    }
    return most;
}

static haft_status fit_reach(surface_kernel *kernel, const surface_radial *radial, double tolerance,
                             const gsl_integration_glfixed_table *rule, haft_error *error) {
    double h = kernel->lattice_step;
    for (double phase = LONGEST_PHASE / 16; phase <= LONGEST_PHASE; phase *= 2) {
        size_t halo = (size_t)ceil(phase / (radial->psd.zeta_max * h));
        double reach = (double)halo * h;
        size_t n = (size_t)ceil(reach / kernel->spacing) + STENCIL;
        haft_status status = extend_table(kernel, radial, n, error);
        double *taper = haft_memory_alloc(n, sizeof *taper, error);
        if (status != HAFT_OK || taper == NULL) {
            haft_memory_free(taper);
            return HAFT_ERROR_MEMORY;
        }
        fill_taper(kernel, reach, rule, taper);
        kernel->loss = taper_loss(kernel, radial, taper);
        bool found = kernel->loss <= tolerance;
        if (found) {
            kernel->halo = shortest_halo(kernel, radial, halo, tolerance, rule, taper);
            kernel->reach = (double)kernel->halo * h;
            kernel->smear = 2 * BETA / ((1 - FLAT_SHARE) * kernel->reach);
            fill_taper(kernel, kernel->reach, rule, taper);
            kernel->loss = taper_loss(kernel, radial, taper);
            for (size_t i = 0; i < n; i++) {
                kernel->table[i] *= taper[i];
            }
        }
        haft_memory_free(taper);
        if (found) {
            return HAFT_OK;
        }
    }
    return haft_error_set(error, HAFT_ERROR_INPUT,
                          "tolerance = %g asks for a kernel longer than %g um; the least this PSD "
                          "allows is %.3g",
                          tolerance, 1e6 * LONGEST_PHASE / radial->psd.zeta_max,
                          1.01 * kernel->loss);
}

haft_status haft_surface_kernel_create(surface_kernel *kernel, const surface_radial *radial,
                                       double lattice_step, double tolerance, haft_error *error) {
    *kernel = (surface_kernel){.lattice_step = lattice_step,
                               .spacing = TABLE_PHASE / radial->psd.zeta_max};
    gsl_integration_glfixed_table *rule = gsl_integration_glfixed_table_alloc(BUMP_NODES);
    if (rule == NULL) {
        return haft_error_set(error, HAFT_ERROR_MEMORY, "out of memory for a quadrature rule");
    }
    haft_status status = fit_reach(kernel, radial, tolerance, rule, error);
    gsl_integration_glfixed_table_free(rule);
    if (status != HAFT_OK) {
        haft_surface_kernel_destroy(kernel);
    }
    return status;
}

void haft_surface_kernel_destroy(surface_kernel *kernel) {
    haft_memory_free(kernel->table);
    kernel->table = NULL;
    kernel->n = 0;
}

double haft_surface_kernel_value(const surface_kernel *kernel, double r) {
    if (r >= kernel->reach) {
        return 0;
    }
    /* 1 / prod_{j != i} (i - j) for the nodes 0..11. */
    static const double scale[STENCIL] = {-1.0 / 39916800, 1.0 / 3628800,  -1.0 / 725760,
                                          1.0 / 241920,    -1.0 / 120960,  1.0 / 86400,
                                          -1.0 / 86400,    1.0 / 120960,   -1.0 / 241920,
                                          1.0 / 725760,    -1.0 / 3628800, 1.0 / 39916800};
    double at = r / kernel->spacing;
    long first = (long)at - (STENCIL / 2 - 1);
    double x = at - (double)first; /* from 5 to 6 */
    double below[STENCIL], above[STENCIL];
    below[0] = above[STENCIL - 1] = 1;
    for (int i = 1; i < STENCIL; i++) {
        below[i] = below[i - 1] * (x - (i - 1));
        above[STENCIL - 1 - i] = above[STENCIL - i] * (x - (STENCIL - i));
    }
    double sum = 0;
    for (int i = 0; i < STENCIL; i++) {
        long index = first + i < 0 ? -(first + i) : first + i; /* the kernel is even */
        sum += scale[i] * below[i] * above[i] * kernel->table[index];
    }
    return sum;
}
