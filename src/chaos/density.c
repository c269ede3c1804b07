/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Densities of Gaussian kernels by direct sums of m terms per point. In two dimensions the
 * kernels are products, so a grid needs only the exponentials along its two sides. Kernels
 * further away than REACH bandwidths count as 0, which changes a density by 1e-20 of a kernel's
 * peak. */
#include "haft/chaos.h"

#include <math.h>

#define REACH 9.6

/* The factor of centres and bandwidth. */
static double shrinking(const haft_chaos_kernels *k) {
    return k->kernel == HAFT_CHAOS_KERNEL_PRESERVING ? 1 / sqrt(1 + k->bandwidth * k->bandwidth)
                                                     : 1;
}

/* exp(-z^2/2) / (sqrt(2 pi) h) at z = (x - c) / h. */
static double kernel_at(double x, double centre, double h) {
    double z = (x - centre) / h;
    return fabs(z) > REACH ? 0 : exp(-0.5 * z * z) / (sqrt(2 * M_PI) * h);
}

void haft_chaos_density(const haft_chaos_kernels *kernels, size_t column, size_t n, const double *x,
                        double *density) {
    double factor = shrinking(kernels), h = factor * kernels->bandwidth;
    for (size_t i = 0; i < n; i++) {
        double sum = 0;
        for (size_t k = 0; k < kernels->m; k++) {
            sum += kernel_at(x[i], factor * kernels->centre[k * kernels->stride + column], h);
        }
        density[i] = sum / (double)kernels->m;
    }
}

haft_status haft_chaos_joint_density(const haft_chaos_kernels *kernels, size_t column_x,
                                     size_t column_y, size_t nx, const double *x, size_t ny,
                                     const double *y, double *density, haft_error *error) {
    double factor = shrinking(kernels), h = factor * kernels->bandwidth;
    double *across = haft_memory_alloc(ny, sizeof *across, error);
    if (across == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    for (size_t i = 0; i < nx * ny; i++) {
        density[i] = 0;
    }
    for (size_t k = 0; k < kernels->m; k++) {
        const double *centre = kernels->centre + k * kernels->stride;
        for (size_t j = 0; j < ny; j++) {
            across[j] = kernel_at(y[j], factor * centre[column_y], h) / (double)kernels->m;
        }
        for (size_t i = 0; i < nx; i++) {
            double along = kernel_at(x[i], factor * centre[column_x], h);
            for (size_t j = 0; along > 0 && j < ny; j++) {
                density[i * ny + j] += along * across[j];
            }
        }
    }
    haft_memory_free(across);
    return HAFT_OK;
}
