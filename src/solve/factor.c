/* SPDX-License-Identifier: GPL-3.0-or-later */
/* KLU as a symmetric solver that tells the inertia.
 *
 * With block form, scaling and partial pivoting off, and rows and columns in the same AMD order,
 * KLU computes P A P' = L U with U = D L': the signs of U's diagonal are the inertia. For a
 * positive definite matrix elimination without pivoting is stable (Wilkinson); elsewhere the factor
 * is used only for its signs or in a bordered system made positive definite. */
#include "factor.h"

#include <klu.h>
#include <math.h>

struct haft_factor {
    klu_common common;
    klu_symbolic *symbolic;
    klu_numeric *numeric;
    int n;
    size_t solves;
    int *column, *row; /* own copies: KLU's interface is not const */
};

static bool order_is_symmetric(const haft_factor *factor) {
    for (int k = 0; k < factor->n; k++) {
        if (factor->numeric->Pnum[k] != factor->symbolic->Q[k]) {
            return false;
        }
    }
    return true;
}

static haft_status analyse(haft_factor *factor, const double *values, haft_error *error) {
    klu_defaults(&factor->common);
    factor->common.btf = 0;
    factor->common.scale = 0;
    factor->common.tol = 0;
    factor->common.ordering = 0;
    factor->common.halt_if_singular = 1;
    factor->symbolic = klu_analyze(factor->n, factor->column, factor->row, &factor->common);
    if (factor->symbolic == NULL) {
        return haft_error_set(error, HAFT_ERROR_LIBRARY,
                              "KLU cannot analyse the stiffness pattern");
    }
    union {
        const double *in;
        double *out;
    } entries = {values};
    factor->numeric =
        klu_factor(factor->column, factor->row, entries.out, factor->symbolic, &factor->common);
    if (factor->numeric == NULL || !order_is_symmetric(factor)) {
        return haft_error_set(error, HAFT_ERROR_NUMERIC,
                              "the stiffness matrix is singular: is the structure held?");
    }
    return HAFT_OK;
}

haft_status haft_factor_create(haft_factor **out, size_t n, const int *column, const int *row,
                               const double *values, haft_error *error) {
    *out = NULL;
    haft_factor *factor = haft_memory_alloc(1, sizeof *factor, error);
    if (factor == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    size_t nonzeros = (size_t)column[n];
    factor->n = (int)n;
    factor->column = haft_memory_alloc(n + 1, sizeof(int), error);
    factor->row = haft_memory_alloc(nonzeros, sizeof(int), error);
    haft_status status = HAFT_ERROR_MEMORY;
    if (factor->column != NULL && factor->row != NULL) {
        for (size_t i = 0; i <= n; i++) {
            factor->column[i] = column[i];
        }
        for (size_t i = 0; i < nonzeros; i++) {
            factor->row[i] = row[i];
        }
        status = analyse(factor, values, error);
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
    klu_free_numeric(&f->numeric, &f->common);
    klu_free_symbolic(&f->symbolic, &f->common);
    haft_memory_free(f->column);
    haft_memory_free(f->row);
    haft_memory_free(f);
    *factor = NULL;
}

bool haft_factor_update(haft_factor *factor, const double *values) {
    union {
        const double *in;
        double *out;
    } entries = {values};
    return klu_refactor(factor->column, factor->row, entries.out, factor->symbolic, factor->numeric,
                        &factor->common) == 1 &&
           factor->common.status == KLU_OK;
}

void haft_factor_solve(haft_factor *factor, double *b, int columns) {
    factor->solves++;
    klu_solve(factor->symbolic, factor->numeric, factor->n, columns, b, &factor->common);
}

size_t haft_factor_solves(const haft_factor *factor) {
    return factor->solves;
}

haft_inertia haft_factor_inertia(const haft_factor *factor) {
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
