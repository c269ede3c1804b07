/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The expansion at HAFT_SIMD_WIDTH germs at a time: nested sums in the order in which the terms
 * are stored, where each partial sum over the last variable is multiplied once by the polynomial
 * of the variable before. Coordinate i of the map depends on only i + 1 variables, so two of
 * three coordinates cost almost nothing. A single germ gives the same bits. */
#include <string.h>

#include "chaos/model.h"

enum { ROWS = HAFT_CHAOS_ORDER_LIMIT + 1 };

typedef double together[HAFT_SIMD_WIDTH];
typedef together table[ROWS]; /* polynomials of one variable */

HAFT_INLINE const double *sum_1(const double *c, const table *psi, size_t order, together out) {
    together sum = {0};
    for (size_t a = 0; a <= order; a++) {
        for (size_t l = 0; l < HAFT_SIMD_WIDTH; l++) {
            sum[l] += c[a] * psi[0][a][l];
        }
    }
    memcpy(out, sum, sizeof sum);
    return c + order + 1;
}

/* Adds one variable before those of `inner`. */
#define NEST(name, inner)                                                                          \
    HAFT_INLINE const double *name(const double *c, const table *psi, size_t order,                \
                                   together out) {                                                 \
        together sum = {0}, part;                                                                  \
        for (size_t a = 0; a <= order; a++) {                                                      \
            c = inner(c, psi + 1, order - a, part);                                                \
            for (size_t l = 0; l < HAFT_SIMD_WIDTH; l++) {                                         \
                sum[l] += part[l] * psi[0][a][l];                                                  \
            }                                                                                      \
        }                                                                                          \
        memcpy(out, sum, sizeof sum);                                                              \
        return c;                                                                                  \
    }

NEST(sum_2, sum_1)
NEST(sum_3, sum_2)
NEST(sum_4, sum_3)

HAFT_INLINE void fill(const chaos_recurrence *r, size_t order, const together x, table psi) {
    for (size_t l = 0; l < HAFT_SIMD_WIDTH; l++) {
        psi[0][l] = 1;
    }
    for (size_t k = 0; k < order; k++) {
        double before = r->b[k], after = r->b[k + 1];
        for (size_t l = 0; l < HAFT_SIMD_WIDTH; l++) {
            double low = k > 0 ? psi[k - 1][l] : 0;
            psi[k + 1][l] = ((x[l] - r->a) * psi[k][l] - before * low) / after;
        }
    }
}

HAFT_CLONES static void expand_germs(const haft_chaos *chaos, const together *x, together *out) {
    table psi[HAFT_CHAOS_DIMENSION];
    size_t order = chaos->parts.order;
    for (size_t i = 0; i < chaos->parts.components; i++) {
        fill(&chaos->recurrence, order, x[i], psi[i]);
    }
    const table *all = (const table *)psi;
    switch (chaos->parts.components) {
    case 4:
        sum_4(chaos->compact[3], all, order, out[3]);
        /* fall through */
    case 3:
        sum_3(chaos->compact[2], all, order, out[2]);
        /* fall through */
    case 2:
        sum_2(chaos->compact[1], all, order, out[1]);
        /* fall through */
    default:
        sum_1(chaos->compact[0], all, order, out[0]);
    }
}

void haft_chaos_expand_together(const haft_chaos *chaos,
                                double x[HAFT_CHAOS_DIMENSION][HAFT_SIMD_WIDTH],
                                double out[HAFT_CHAOS_DIMENSION][HAFT_SIMD_WIDTH]) {
    expand_germs(chaos, (const together *)x, out);
}

void haft_chaos_expand(const haft_chaos *chaos, const double *x, double *eta) {
    together germ[HAFT_CHAOS_DIMENSION] = {{0}}, out[HAFT_CHAOS_DIMENSION];
    for (size_t i = 0; i < chaos->parts.components; i++) {
        for (size_t l = 0; l < HAFT_SIMD_WIDTH; l++) {
            germ[i][l] = x[i];
        }
    }
    haft_chaos_expand_together(chaos, germ, out);
    for (size_t i = 0; i < chaos->parts.components; i++) {
        eta[chaos->parts.component_order[i]] = out[i][0];
    }
}
