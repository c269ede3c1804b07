/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Landings against CVODE. The oracle integrates M u' = -grad Pi by variable-order BDF at tight
 * tolerance until nothing moves. */
#ifndef HAFT_TEST_LANDING_ORACLE_H
#define HAFT_TEST_LANDING_ORACLE_H

#include "evaluate.h"
#include "landings.h"
#include "random_beam.h"

#include <cvode/cvode.h>
#include <gsl/gsl_linalg.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

typedef struct oracle {
    const haft_model *model;
    const haft_law *law;
    double load;
    gsl_matrix *mass; /* factored */
    double *gradient, *hessian;
} oracle;

static inline int velocity(double time, N_Vector u, N_Vector out, void *user) {
    (void)time;
    oracle *o = user;
    size_t n = haft_model_get(o->model)->dofs;
    evaluate(o->model, o->law, N_VGetArrayPointer(u), o->load, o->gradient, NULL, NULL);
    gsl_vector_view v = gsl_vector_view_array(N_VGetArrayPointer(out), n);
    for (size_t i = 0; i < n; i++) {
        gsl_vector_set(&v.vector, i, -o->gradient[i]);
    }
    return gsl_linalg_cholesky_svx(o->mass, &v.vector);
}

static inline int jacobian(double time, N_Vector u, N_Vector f, SUNMatrix out, void *user,
                           N_Vector a, N_Vector b, N_Vector c) {
    (void)time, (void)f, (void)a, (void)b, (void)c;
    oracle *o = user;
    const haft_model_data *m = haft_model_get(o->model);
    evaluate(o->model, o->law, N_VGetArrayPointer(u), o->load, NULL, o->hessian, NULL);
    for (size_t j = 0; j < m->dofs; j++) {
        double *column = SUNDenseMatrix_Column(out, (sunindextype)j);
        memset(column, 0, m->dofs * sizeof *column);
        for (int k = m->column[j]; k < m->column[j + 1]; k++) {
            column[m->row[k]] = -o->hessian[k];
        }
        gsl_vector_view v = gsl_vector_view_array(column, m->dofs);
        gsl_linalg_cholesky_svx(o->mass, &v.vector);
    }
    return 0;
}

static inline oracle make_oracle(const haft_model *m, const haft_law *law) {
    const haft_model_data *data = haft_model_get(m);
    oracle o = {.model = m, .law = law, .mass = gsl_matrix_calloc(data->dofs, data->dofs)};
    o.gradient = haft_memory_alloc(data->dofs, sizeof(double), NULL);
    o.hessian = haft_memory_alloc(data->nonzeros, sizeof(double), NULL);
    for (size_t j = 0; j < data->dofs; j++) {
        for (int k = data->column[j]; k < data->column[j + 1]; k++) {
            gsl_matrix_set(o.mass, (size_t)data->row[k], j, data->mass[k]);
        }
    }
    assert_int_equal(gsl_linalg_cholesky_decomp1(o.mass), 0);
    return o;
}

static inline void free_oracle(oracle *o) {
    gsl_matrix_free(o->mass);
    haft_memory_free(o->gradient);
    haft_memory_free(o->hessian);
}

/* Integrates from `u` until the gaps' speed has died away; the end replaces `u`. */
static inline void let_flow(void *cvode_oracle, double load, double *u) {
    oracle *o = cvode_oracle;
    o->load = load;
    SUNContext context;
    assert_int_equal(SUNContext_Create(NULL, &context), 0);
    sunindextype n = (sunindextype)haft_model_get(o->model)->dofs;
    N_Vector y = N_VMake_Serial(n, u, context);
    SUNMatrix matrix = SUNDenseMatrix(n, n, context);
    SUNLinearSolver solver = SUNLinSol_Dense(y, matrix, context);
    void *cvode = CVodeCreate(CV_BDF, context);
    assert_int_equal(CVodeInit(cvode, velocity, 0, y), CV_SUCCESS);
    assert_int_equal(CVodeSStolerances(cvode, 1e-9, 1e-9), CV_SUCCESS);
    assert_int_equal(CVodeSetUserData(cvode, o), CV_SUCCESS);
    assert_int_equal(CVodeSetLinearSolver(cvode, solver, matrix), CV_SUCCESS);
    assert_int_equal(CVodeSetJacFn(cvode, jacobian), CV_SUCCESS);
    assert_int_equal(CVodeSetMaxNumSteps(cvode, 1000000), CV_SUCCESS);
    double time = 0;
    for (double end = 1; end < 1e5; end *= 4) {
        assert_true(CVode(cvode, end, y, &time, CV_NORMAL) >= 0);
    }
    CVodeFree(&cvode);
    SUNLinSolFree(solver);
    SUNMatDestroy(matrix);
    N_VDestroy(y);
    SUNContext_Free(&context);
}

/* Follows a random beam and compares each of its landings; @return how many there were. */
static inline size_t check_landings(uint64_t seed, double *worst) {
    haft_mesh_spec mesh = {HAFT_MESH_UNIFORM, 30e-6, 6e-6, 60e-6, 0};
    random_beam b = random_beam_create(seed, mesh);
    oracle o = make_oracle(b.model, b.law);
    haft_path *path = random_beam_cycle(&b, (haft_path_options){.keep_states = true});
    assert_int_equal(path->outcome, HAFT_OUTCOME_STUCK);
    size_t jumps = check_landings_of(b.model, path, let_flow, &o, worst);
    haft_path_destroy(&path);
    free_oracle(&o);
    random_beam_destroy(&b);
    return jumps;
}

#endif
