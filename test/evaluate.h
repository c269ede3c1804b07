/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A model's energy, gradient and Hessian over laws that have not been laid out. The gradient alone
 * is the same to the bit. */
#ifndef HAFT_TEST_EVALUATE_H
#define HAFT_TEST_EVALUATE_H

#include "check.h"
#include "haft/beam.h"

#include <stdlib.h>

/* A law that neither pulls nor pushes at any gap a test reaches. */
static inline haft_law nothing(void) {
    haft_law law;
    haft_law_vector v = {1e-3, 1e6, -1.0, -1.0 - 1e-9};
    assert_int_equal(haft_law_morse(&law, &v, 1e6), HAFT_LAW_SOUND);
    return law;
}

static inline void check_gradient_alone(const haft_model *model, const haft_law_rows *rows,
                                        const double *u, double load, const double *gradient) {
    double *alone = malloc(haft_model_get(model)->dofs * sizeof *alone);
    assert_non_null(alone);
    haft_model_gradient(model, rows, u, load, alone);
    assert_memory_equal(alone, gradient, haft_model_get(model)->dofs * sizeof *alone);
    free(alone);
}

static inline haft_energy evaluate(const haft_model *model, const haft_law *laws, const double *u,
                                   double load, double *gradient, double *hessian,
                                   double *force_scale) {
    haft_error error = {0};
    haft_law_rows *rows = NULL;
    check_ok(haft_law_rows_create(&rows, haft_model_get(model)->sites, laws, &error), error);
    haft_energy energy =
        haft_model_evaluate(model, rows, u, load, gradient, hessian, force_scale, NULL, NULL);
    if (gradient != NULL) {
        check_gradient_alone(model, rows, u, load, gradient);
    }
    haft_law_rows_destroy(&rows);
    return energy;
}

#endif
