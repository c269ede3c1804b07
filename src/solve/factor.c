/* SPDX-License-Identifier: GPL-3.0-or-later */
/* KLU as a symmetric solver that tells the inertia.
 *
 * With block form, scaling and partial pivoting off, and rows and columns in their own order, which
 * along a beam fills nothing, KLU computes A = L U with U = D L': the signs of U's diagonal are the
 * inertia. For a positive definite matrix elimination without pivoting is stable (Wilkinson);
 * elsewhere the factor is used only for its signs or in a bordered system made positive definite.
 * The factors of a leading part of A are those columns of L and U: to KLU, a matrix of that size.
 */
#include "band.h"

#include <klu.h>
#include <math.h>
#include <string.h>

struct haft_factor {
    haft_band *band; /* NULL: KLU, which the other members are for */
    klu_common common;
    klu_symbolic *symbolic;
    klu_numeric *numeric;
    klu_symbolic leading; /* `symbolic` of the leading n */
    int blocks[2];        /* where its one block begins and ends */
    int n;
    int *column, *row; /* own copies: KLU's interface is not const */
};

static bool order_is_symmetric(const haft_factor *factor) {
    for (int k = 0; k < factor->n; k++) {
        if (factor->numeric->Pnum[k] != k || factor->symbolic->Q[k] != k) {
            return false;
        }
    }
    return true;
}

/* KLU's own order is known to it as given. */
enum { OWN_ORDER = 2 };

static void lead_sparse(haft_factor *factor, int n) {
    factor->leading = *factor->symbolic;
    factor->leading.n = factor->leading.maxblock = factor->blocks[1] = n;
    factor->leading.R = factor->blocks;
    factor->n = n;
}

static haft_status not_analysed(haft_error *error) {
    return haft_error_set(error, HAFT_ERROR_LIBRARY, "KLU cannot analyse the stiffness pattern");
}

static haft_status singular(haft_error *error) {
    return haft_error_set(error, HAFT_ERROR_NUMERIC,
                          "the stiffness matrix is singular: is the structure held?");
}

/* Why KLU gave nothing: it has no memory, or else what `other` tells. */
static haft_status refusal(const haft_factor *factor, haft_status (*other)(haft_error *),
                           haft_error *error) {
    return factor->common.status == KLU_OUT_OF_MEMORY
               ? haft_error_set(error, HAFT_ERROR_MEMORY,
                                "out of memory factoring the stiffness matrix")
               : other(error);
}

static haft_status analyse(haft_factor *factor, const double *values, haft_error *error) {
    klu_defaults(&factor->common);
    factor->common.btf = 0;
    factor->common.scale =
        -1; /* nor is the pattern, which is ours, checked at each refactorization */
    factor->common.tol = 0;
    factor->common.ordering = OWN_ORDER;
    factor->common.halt_if_singular = 1;
    factor->symbolic =
        klu_analyze_given(factor->n, factor->column, factor->row, NULL, NULL, &factor->common);
    if (factor->symbolic == NULL) {
        return refusal(factor, not_analysed, error);
    }
    union {
        const double *in;
        double *out;
    } entries = {values};
    factor->numeric =
        klu_factor(factor->column, factor->row, entries.out, factor->symbolic, &factor->common);
    if (factor->numeric == NULL || !order_is_symmetric(factor)) {
        return refusal(factor, singular, error);
    }
    lead_sparse(factor, factor->n);
    return HAFT_OK;
}

/* KLU's part of a factor. */
static haft_status create_sparse(haft_factor *factor, const int *column, const int *row,
                                 const double *values, haft_error *error) {
    size_t n = (size_t)factor->n, nonzeros = (size_t)column[n];
    factor->column = haft_memory_alloc(n + 1, sizeof(int), error);
    factor->row = haft_memory_alloc(nonzeros, sizeof(int), error);
    if (factor->column == NULL || factor->row == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    memcpy(factor->column, column, (n + 1) * sizeof(int));
    memcpy(factor->row, row, nonzeros * sizeof(int));
    return analyse(factor, values, error);
}

haft_status haft_factor_create(haft_factor **out, haft_factor_kind kind, size_t n,
                               const int *column, const int *row, const double *values,
                               haft_error *error) {
    *out = NULL;
    haft_factor *factor = haft_memory_alloc(1, sizeof *factor, error);
    if (factor == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    factor->n = (int)n;
    haft_status status = HAFT_OK;
    if (kind == HAFT_FACTOR_BAND) {
        status = haft_band_create(&factor->band, n, column, row, error);
    }
    if (status == HAFT_OK && factor->band == NULL) {
        status = create_sparse(factor, column, row, values, error);
    } else if (status == HAFT_OK && !haft_band_update(factor->band, values, NULL)) {
        status = singular(error);
    }
    if (status != HAFT_OK) {
        haft_factor_destroy(&factor);
    }
    *out = factor;
    return status;
}

void haft_factor_destroy(haft_factor **factor) {
    if (factor == NULL || *factor == NULL) {
        return;
    }
    haft_factor *f = *factor;
    haft_band_destroy(&f->band);
    klu_free_numeric(&f->numeric, &f->common);
    klu_free_symbolic(&f->symbolic, &f->common);
    haft_memory_free(f->column);
    haft_memory_free(f->row);
    haft_memory_free(f);
    *factor = NULL;
}

bool haft_factor_use_leading(haft_factor *factor, size_t n) {
    if (factor->band == NULL) {
        bool fits = n > 1 && n <= (size_t)factor->symbolic->n;
        if (fits) {
            lead_sparse(factor, (int)n);
        }
        return fits;
    }
    return haft_band_use_leading(factor->band, n);
}

bool haft_factor_update(haft_factor *factor, const double *values) {
    if (factor->band != NULL) {
        return haft_band_update(factor->band, values, NULL);
    }
    union {
        const double *in;
        double *out;
    } entries = {values};
    return klu_refactor(factor->column, factor->row, entries.out, &factor->leading, factor->numeric,
                        &factor->common) == 1 &&
           factor->common.status == KLU_OK;
}

bool haft_factor_update_solve(haft_factor *factor, const double *values, double *b) {
    if (factor->band != NULL) {
        return haft_band_update(factor->band, values, b);
    }
    if (!haft_factor_update(factor, values)) {
        return false;
    }
    haft_factor_solve(factor, b, 1);
    return true;
}

void haft_factor_solve(haft_factor *factor, double *b, int columns) {
    if (factor->band != NULL) {
        haft_band_solve(factor->band, b, columns);
    } else {
        klu_solve(&factor->leading, factor->numeric, factor->n, columns, b, &factor->common);
    }
}

haft_inertia haft_factor_inertia(const haft_factor *factor) {
    if (factor->band != NULL) {
        return haft_band_inertia(factor->band);
    }
    const double *pivot = factor->numeric->Udiag;
    haft_inertia inertia = {0, 0};
    double least = INFINITY, largest = 0;
    for (int i = 0; i < factor->n; i++) {
        inertia.negative += !(pivot[i] > 0);
        least = fmin(least, pivot[i]);
        largest = fmax(largest, fabs(pivot[i]));
    }
    inertia.least_pivot = least / largest;
    return inertia;
}
