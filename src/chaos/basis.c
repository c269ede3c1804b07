/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Germs, their orthonormal polynomials and Gauss rules, multi-indices and projection.
 *
 * The nodes of a rule are the zeros of psi_n. psi_0 .. psi_n is a Sturm sequence: its changes of
 * sign count the zeros above a point. Bisection isolates each zero and Newton's iteration finds
 * it. A weight is 1 / sum of psi_k^2 over k < n. Accurate to rounding up to the limit of 128
 * points. */
#include "chaos/basis.h"

#include <math.h>
#include <string.h>

static double off_diagonal(haft_chaos_germ germ, double k) {
    switch (germ) {
    case HAFT_CHAOS_GERM_LEGENDRE:
        return 0.5 * k / sqrt(4 * k * k - 1);
    case HAFT_CHAOS_GERM_HERMITE:
        return sqrt(k);
    case HAFT_CHAOS_GERM_JACOBI:
        break;
    }
    return 0.5 * sqrt(k * (k + 2) / ((2 * k + 1) * (2 * k + 3)));
}

void haft_chaos_recurrence(haft_chaos_germ germ, chaos_recurrence *out) {
    out->a = germ == HAFT_CHAOS_GERM_HERMITE ? 0 : 0.5;
    out->b[0] = 0;
    for (size_t k = 1; k <= HAFT_CHAOS_POINTS_LIMIT; k++) {
        out->b[k] = off_diagonal(germ, (double)k);
    }
}

void haft_chaos_recur(const chaos_recurrence *r, size_t order, double x, double *psi) {
    double before = 0;
    psi[0] = 1;
    for (size_t k = 0; k < order; k++) {
        psi[k + 1] = ((x - r->a) * psi[k] - r->b[k] * before) / r->b[k + 1];
        before = psi[k];
    }
}

void haft_chaos_polynomials(haft_chaos_germ germ, size_t order, double x, double *psi) {
    chaos_recurrence r;
    haft_chaos_recurrence(germ, &r);
    haft_chaos_recur(&r, order, x, psi);
}

static size_t count_zeros_below(const chaos_recurrence *r, size_t n, double x) {
    double psi[HAFT_CHAOS_POINTS_LIMIT + 1];
    size_t below = n;
    haft_chaos_recur(r, n, x, psi);
    for (size_t k = 0; k < n; k++) {
        below -= (psi[k + 1] < 0) != (psi[k] < 0);
    }
    return below;
}

/* Narrows low .. high until it contains only zero i of psi_n. */
static void part_zero(const chaos_recurrence *r, size_t n, size_t i, double *low, double *high) {
    size_t below_low = 0, below_high = n;
    while (below_low != i || below_high != i + 1) {
        double mid = *low + 0.47 * (*high - *low); /* not at the middle, which is a zero itself */
        size_t below = count_zeros_below(r, n, mid);
        if (below <= i) {
            *low = mid;
            below_low = below;
        } else {
            *high = mid;
            below_high = below;
        }
    }
}

typedef struct polynomial {
    const chaos_recurrence *r;
    size_t n;
} polynomial;

/* psi_n, and its derivative by the differentiated recurrence. */
static double evaluate(const void *data, double x, double *slope) {
    const polynomial *p = data;
    const chaos_recurrence *r = p->r;
    double psi[HAFT_CHAOS_POINTS_LIMIT + 1], slope_before = 0;
    haft_chaos_recur(r, p->n, x, psi);
    *slope = 0;
    for (size_t k = 0; k < p->n; k++) {
        double next = (psi[k] + (x - r->a) * *slope - r->b[k] * slope_before) / r->b[k + 1];
        slope_before = *slope;
        *slope = next;
    }
    return psi[p->n];
}

/* The zero of psi_n between low and high, where it changes sign. */
static double find_zero(const chaos_recurrence *r, size_t n, double low, double high) {
    polynomial p = {r, n};
    return haft_root_find(evaluate, &p, low, high, evaluate(&p, high, &(double){0}) > 0);
}

haft_status haft_chaos_gauss(haft_chaos_germ germ, size_t n, double *x, double *weight,
                             haft_error *error) {
    if (n == 0 || n > HAFT_CHAOS_POINTS_LIMIT) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                              "a Gauss rule of %zu points; from 1 to %d can be had", n,
                              HAFT_CHAOS_POINTS_LIMIT);
    }
    chaos_recurrence r;
    haft_chaos_recurrence(germ, &r);
    bool line = germ == HAFT_CHAOS_GERM_HERMITE;
    double end = line ? 2 * sqrt((double)n) + 1 : 1, psi[HAFT_CHAOS_POINTS_LIMIT + 1];
    for (size_t i = 0; i < n; i++) {
        double low = line ? -end : 0, high = end;
        part_zero(&r, n, i, &low, &high);
        x[i] = find_zero(&r, n, low, high);
    }
    for (size_t i = 0; i < n; i++) {
        double sum = 0;
        haft_chaos_recur(&r, n - 1, x[i], psi);
        for (size_t k = 0; k < n; k++) {
            sum += psi[k] * psi[k];
        }
        weight[i] = 1 / sum;
    }
    return HAFT_OK;
}

void haft_chaos_germ_cdf(haft_chaos_germ germ, double x, double *xi, double *tail) {
    switch (germ) {
    case HAFT_CHAOS_GERM_LEGENDRE:
        *xi = x;
        *tail = 1 - x;
        break;
    case HAFT_CHAOS_GERM_HERMITE:
        *xi = 0.5 * erfc(-x * M_SQRT1_2);
        *tail = 0.5 * erfc(x * M_SQRT1_2);
        break;
    case HAFT_CHAOS_GERM_JACOBI:
        *xi = x * x * (3 - 2 * x);
        *tail = (1 - x) * (1 - x) * (1 + 2 * x);
        break;
    }
}

double haft_chaos_germ_quantile(haft_chaos_germ germ, double xi) {
    switch (germ) {
    case HAFT_CHAOS_GERM_LEGENDRE:
        return xi;
    case HAFT_CHAOS_GERM_HERMITE:
        return haft_random_normal_quantile(xi);
    case HAFT_CHAOS_GERM_JACOBI:
        break;
    }
    /* x^2 (3 - 2 x) = xi: x = sin(pi/6) - sin(pi/6 - 2t/3) with sin^2(t) = xi, as a product. */
    double least = fmin(xi, 1 - xi);
    double third = asin(sqrt(least)) / 3, x = 2 * cos(M_PI / 6 - third) * sin(third);
    return xi <= 0.5 ? x : 1 - x;
}

size_t haft_chaos_terms(size_t directions, size_t order) {
    size_t terms = 1;
    for (size_t i = 1; i <= directions; i++) {
        terms = terms * (order + i) / i;
    }
    return terms;
}

void haft_chaos_indices(size_t directions, size_t order, unsigned *index) {
    size_t terms = haft_chaos_terms(directions, order);
    memset(index, 0, directions * sizeof *index);
    for (size_t t = 1; t < terms; t++) {
        unsigned *now = index + t * directions, sum = 0;
        memcpy(now, now - directions, directions * sizeof *now);
        for (size_t i = 0; i < directions; i++) {
            sum += now[i];
        }
        size_t last = directions - 1;
        while (sum == order) { /* the order is exceeded: clear from the right until it is not */
            sum -= now[last];
            now[last--] = 0;
        }
        now[last]++;
    }
}

/* Contracts direction r (directions 0 .. r are still points, the others already degrees):
 * to[outer][degree][inner] = sum over k of rule[degree][k] from[outer][k][inner]. */
static void contract(size_t outer, size_t points, size_t inner, size_t order, const double *rule,
                     const double *restrict from, double *restrict to) {
    for (size_t o = 0; o < outer; o++) {
        for (size_t d = 0; d <= order; d++) {
            double *restrict row = to + (o * (order + 1) + d) * inner;
            memset(row, 0, inner * sizeof *row);
            for (size_t k = 0; k < points; k++) {
                const double *restrict at = from + (o * points + k) * inner;
                double factor = rule[d * points + k];
                for (size_t j = 0; j < inner; j++) {
                    row[j] += factor * at[j];
                }
            }
        }
    }
}

/* weight_k psi_d(x_k) as [order + 1][points]. */
static haft_status make_rule(haft_chaos_germ germ, size_t order, size_t points, double *rule,
                             haft_error *error) {
    double x[HAFT_CHAOS_POINTS_LIMIT], weight[HAFT_CHAOS_POINTS_LIMIT];
    double psi[HAFT_CHAOS_POINTS_LIMIT + 1];
    chaos_recurrence r;
    HAFT_TRY(haft_chaos_gauss(germ, points, x, weight, error));
    haft_chaos_recurrence(germ, &r);
    for (size_t k = 0; k < points; k++) {
        haft_chaos_recur(&r, order, x[k], psi);
        for (size_t d = 0; d <= order; d++) {
            rule[d * points + k] = weight[k] * psi[d];
        }
    }
    return HAFT_OK;
}

static void pick_terms(size_t directions, size_t order, const double *dense, double *coefficient,
                       size_t stride) {
    unsigned degree[HAFT_CHAOS_DIMENSION] = {0};
    size_t dense_size = 1, term = 0;
    for (size_t i = 0; i < directions; i++) {
        dense_size *= order + 1;
    }
    for (size_t k = 0; k < dense_size; k++) {
        size_t rest = k, sum = 0;
        for (size_t i = directions; i-- > 0; rest /= order + 1) {
            degree[i] = (unsigned)(rest % (order + 1));
            sum += degree[i];
        }
        if (sum <= order) {
            coefficient[stride * term++] = dense[k];
        }
    }
}

haft_status haft_chaos_project(haft_chaos_germ germ, size_t directions, size_t order, size_t points,
                               const double *value, double *coefficient, size_t stride,
                               haft_error *error) {
    size_t size = 1;
    if (directions < 1 || directions > HAFT_CHAOS_DIMENSION || order > HAFT_CHAOS_ORDER_LIMIT ||
        points <= order || points > HAFT_CHAOS_POINTS_LIMIT) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                              "cannot project in %zu directions to order %zu with %zu points",
                              directions, order, points);
    }
    for (size_t i = 0; i < directions; i++) {
        size *= points;
    }
    double *from = haft_memory_alloc(2 * size + (order + 1) * points, sizeof *from, error);
    if (from == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    double *memory = from, *to = from + size, *rule = to + size;
    haft_status status = make_rule(germ, order, points, rule, error);
    if (status == HAFT_OK) {
        memcpy(from, value, size * sizeof *from);
        size_t inner = 1;
        for (size_t outer = size / points;; outer /= points) {
            contract(outer, points, inner, order, rule, from, to);
            double *swap = from;
            from = to;
            to = swap;
            inner *= order + 1;
            if (outer == 1) {
                break;
            }
        }
        pick_terms(directions, order, from, coefficient, stride);
    }
    haft_memory_free(memory);
    return status;
}

size_t haft_chaos_grid_size(size_t points, size_t i) {
    size_t size = points;
    for (size_t j = 0; j < i; j++) {
        size *= points;
    }
    return size;
}
