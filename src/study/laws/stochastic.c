/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stochastic model of a case at other orders, and samples and grids of its components. */
#include "stochastic.h"

#include <math.h>

haft_status haft_stochastic_create_of_order(haft_chaos **out, size_t m,
                                            const haft_law_vector *vector, const haft_case *c,
                                            haft_chaos_germ germ, size_t order, haft_error *error) {
    haft_case own = *c;
    own.law.chaos.spec.germ = germ;
    own.law.chaos.spec.order = order;
    if (own.law.chaos.spec.points <= order) {
        own.law.chaos.spec.points = 0;
    }
    return haft_stochastic_create(out, m, vector, &own, error);
}

haft_chaos_kernels haft_stochastic_kernels(const haft_chaos *chaos) {
    haft_chaos_parts p;
    haft_chaos_get_parts(chaos, &p);
    return (haft_chaos_kernels){p.m, p.centre, p.components, p.bandwidth, p.kernel};
}

void haft_stochastic_grid(const haft_chaos_kernels *kernels, size_t column, double reach, size_t n,
                          double *x) {
    double low = INFINITY, high = -INFINITY;
    for (size_t k = 0; k < kernels->m; k++) {
        low = fmin(low, kernels->centre[k * kernels->stride + column]);
        high = fmax(high, kernels->centre[k * kernels->stride + column]);
    }
    low = fmax(low - 4 * kernels->bandwidth, -reach);
    high = fmin(high + 4 * kernels->bandwidth, reach);
    for (size_t i = 0; i < n; i++) {
        x[i] = low + (high - low) * (double)i / (double)(n - 1);
    }
}

haft_status haft_stochastic_draw_components(const haft_chaos *drawn, const haft_chaos *seen,
                                            uint64_t seed, size_t n, double *eta,
                                            haft_error *error) {
    haft_chaos_parts p;
    haft_chaos_get_parts(seen, &p);
    haft_law_vector *vector = haft_memory_alloc(n, sizeof *vector, error);
    haft_status status = vector == NULL ? HAFT_ERROR_MEMORY : HAFT_OK;
    HAFT_THEN(status, haft_chaos_sample(drawn, NULL, HAFT_CHAOS_SAMPLER_GPCE, seed, 0, 0, n, vector,
                                        error));
    for (size_t k = 0; k < n && status == HAFT_OK; k++) {
        double q[HAFT_CHAOS_DIMENSION], one[HAFT_CHAOS_DIMENSION];
        haft_chaos_q_from_vector(seen, &vector[k], q);
        haft_chaos_eta_from_q(seen, q, one);
        for (size_t j = 0; j < p.components; j++) {
            eta[j * n + k] = one[j];
        }
    }
    haft_memory_free(vector);
    return status;
}
