/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Landings that hold what lies behind their front: slender beams in contact over hundreds of sites.
 * The oracle holds nothing: IDA, variable-order BDF at tight tolerance with M and H in bands. */
#ifndef HAFT_TEST_HELD_ORACLE_H
#define HAFT_TEST_HELD_ORACLE_H

#include "evaluate.h"
#include "landings.h"
#include "random_beam.h"

#include <ida/ida.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_band.h>
#include <sunmatrix/sunmatrix_band.h>

enum { HALF_BAND = 3 };

typedef struct oracle {
    const haft_model *model;
    const haft_law_rows *rows;
    double load;
    double *hessian;
} oracle;

/* out = grad Pi(u) + M u' */
static inline int residual(double time, N_Vector u, N_Vector speed, N_Vector out, void *user) {
    (void)time;
    const oracle *o = user;
    const haft_model_data *m = haft_model_get(o->model);
    const double *v = N_VGetArrayPointer(speed);
    double *r = N_VGetArrayPointer(out);
    haft_model_evaluate(o->model, o->rows, N_VGetArrayPointer(u), o->load, r, NULL, NULL, NULL,
                        NULL);
    for (size_t j = 0; j < m->dofs; j++) {
        for (int k = m->column[j]; k < m->column[j + 1]; k++) {
            r[m->row[k]] += m->mass[k] * v[j];
        }
    }
    return 0;
}

static inline int jacobian(double time, double cj, N_Vector u, N_Vector speed, N_Vector r,
                           SUNMatrix out, void *user, N_Vector a, N_Vector b, N_Vector c) {
    (void)time, (void)speed, (void)r, (void)a, (void)b, (void)c;
    const oracle *o = user;
    const haft_model_data *m = haft_model_get(o->model);
    haft_model_evaluate(o->model, o->rows, N_VGetArrayPointer(u), o->load, NULL, o->hessian, NULL,
                        NULL, NULL);
    for (size_t j = 0; j < m->dofs; j++) {
        double *column = SUNBandMatrix_Column(out, (sunindextype)j);
        for (int k = m->column[j]; k < m->column[j + 1]; k++) {
            column[m->row[k] - (int)j] = o->hessian[k] + cj * m->mass[k];
        }
    }
    return 0;
}

/* M u' = -grad Pi, solved for u'. */
static inline void find_speed(oracle *o, N_Vector u, N_Vector speed, SUNMatrix matrix,
                              SUNLinearSolver solver, N_Vector work) {
    const haft_model_data *m = haft_model_get(o->model);
    N_VConst(0, speed);
    residual(0, u, speed, work, o);
    N_VScale(-1, work, work);
    SUNMatZero(matrix);
    for (size_t j = 0; j < m->dofs; j++) {
        double *column = SUNBandMatrix_Column(matrix, (sunindextype)j);
        for (int k = m->column[j]; k < m->column[j + 1]; k++) {
            column[m->row[k] - (int)j] = m->mass[k];
        }
    }
    assert_int_equal(SUNLinSolSetup(solver, matrix), 0);
    assert_int_equal(SUNLinSolSolve(solver, matrix, speed, work, 0), 0);
}

/* Integrates from `u` until the gaps' speed has died away; the end replaces `u`. */
static inline void let_flow(void *ida_oracle, double load, double *u) {
    oracle *o = ida_oracle;
    o->load = load;
    SUNContext context;
    assert_int_equal(SUNContext_Create(NULL, &context), 0);
    sunindextype n = (sunindextype)haft_model_get(o->model)->dofs;
    N_Vector y = N_VMake_Serial(n, u, context), speed = N_VClone(y), work = N_VClone(y);
    SUNMatrix matrix = SUNBandMatrix(n, HALF_BAND, HALF_BAND, context);
    SUNLinearSolver solver = SUNLinSol_Band(y, matrix, context);
    find_speed(o, y, speed, matrix, solver, work);
    void *ida = IDACreate(context);
    assert_int_equal(IDAInit(ida, residual, 0, y, speed), IDA_SUCCESS);
    assert_int_equal(IDASStolerances(ida, 1e-9, 1e-9), IDA_SUCCESS);
    assert_int_equal(IDASetUserData(ida, o), IDA_SUCCESS);
    assert_int_equal(IDASetLinearSolver(ida, solver, matrix), IDA_SUCCESS);
    assert_int_equal(IDASetJacFn(ida, jacobian), IDA_SUCCESS);
    assert_int_equal(IDASetMaxNumSteps(ida, 1000000), IDA_SUCCESS);
    double time = 0;
    for (double end = 1; end < 1e5; end *= 4) {
        assert_true(IDASolve(ida, end, &time, y, speed, IDA_NORMAL) >= 0);
    }
    IDAFree(&ida);
    SUNLinSolFree(solver);
    SUNMatDestroy(matrix);
    N_VDestroy(y);
    N_VDestroy(speed);
    N_VDestroy(work);
    SUNContext_Free(&context);
}

/* Follows a random beam 1 um thick and compares each of its landings, in the course of which a good
 * part of it must have been held; @return how many there were. */
static inline size_t check_held_landings(double length, uint64_t seed, double *worst) {
    haft_beam_spec beam = {length, 30e-6, 1e-6, 1.9e-6, 163e9};
    haft_mesh_spec mesh = {HAFT_MESH_EXACT, 0, 3e-6, 30e-6, 0};
    haft_programme programme = {60e-6, 0.01, INFINITY};
    haft_path_options options = {.keep_states = true};
    haft_error error = {0};
    haft_model *model = NULL;
    haft_law_rows *rows = NULL;
    haft_path *path = NULL;
    check_ok(haft_model_create_beam(&model, &beam, &mesh, &error), error);
    haft_law *law = haft_memory_alloc(haft_model_get(model)->sites, sizeof *law, &error);
    random_beam_laws(model, seed, law);
    check_ok(haft_law_rows_create(&rows, haft_model_get(model)->sites, law, &error), error);
    check_ok(haft_solve_path(&path, model, law, &programme, &options, &error), error);
    assert_int_equal(path->outcome, HAFT_OUTCOME_STUCK);
    oracle o = {model, rows, 0,
                haft_memory_alloc(haft_model_get(model)->nonzeros, sizeof(double), NULL)};
    size_t jumps = check_landings_of(model, path, let_flow, &o, worst);
    double moved = (double)path->cost.unknowns / (double)path->cost.factorizations;
    check_less(moved, 0.85 * (double)haft_model_get(model)->dofs);
    haft_path_destroy(&path);
    haft_law_rows_destroy(&rows);
    haft_memory_free(o.hessian);
    haft_memory_free(law);
    haft_model_destroy(&model);
    return jumps;
}

#endif
