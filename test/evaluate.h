/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A model's energy, gradient and Hessian over laws that have not been laid out. */
#ifndef HAFT_TEST_EVALUATE_H
#define HAFT_TEST_EVALUATE_H

#include "check.h"
#include "haft/beam.h"

static inline haft_energy evaluate(const haft_model *model, const haft_law *laws, const double *u,
                                   double load, double *gradient, double *hessian,
                                   double *force_scale) {
    haft_error error = {0};
    haft_law_rows *rows = NULL;
    check_ok(haft_law_rows_create(&rows, model->sites, laws, &error), error);
    haft_energy energy =
        haft_model_evaluate(model, rows, u, load, gradient, hessian, force_scale, NULL, NULL);
    haft_law_rows_destroy(&rows);
    return energy;
}

#endif
