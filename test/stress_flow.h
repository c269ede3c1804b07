/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gradient flow M u' = -grad Pi of a random beam by IDA (variable-order BDF at tight tolerance, M
 * on the left as it stands), over the test's own forces, until Newton in long double finishes it
 * from within a hundredth of a law's range. */
#ifndef HAFT_TEST_STRESS_FLOW_H
#define HAFT_TEST_STRESS_FLOW_H

#include "stress_states.h"

#include <ida/ida.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_band.h>
#include <sunmatrix/sunmatrix_band.h>

enum { STRESS_FLOW_STEPS = 5000 }; /* between two looks */

typedef struct stress_flow {
    stress_oracle *oracle;
    const haft_model *model; /* of its M alone */
    double load;
} stress_flow;

/* out = grad Pi + M u', in units of the model's energy */
static inline int stress_flow_residual(double time, N_Vector u, N_Vector speed, N_Vector out,
                                       void *user) {
    (void)time;
    stress_flow *f = user;
    const haft_model_data *m = haft_model_get(f->model);
    double *r = N_VGetArrayPointer(out);
    const double *v = N_VGetArrayPointer(speed);
    stress_evaluate(f->oracle, N_VGetArrayPointer(u), f->load);
    for (size_t i = 0; i < m->dofs; i++) {
        r[i] = (double)(f->oracle->gradient[i] / m->energy_unit);
        if (!isfinite(r[i])) {
            return 1;
        }
    }
    for (size_t j = 0; j < m->dofs; j++) {
        for (int k = m->column[j]; k < m->column[j + 1]; k++) {
            r[m->row[k]] += m->mass[k] * v[j];
        }
    }
    return 0;
}

static inline int stress_flow_jacobian(double time, double cj, N_Vector u, N_Vector speed,
                                       N_Vector r, SUNMatrix out, void *user, N_Vector a,
                                       N_Vector b, N_Vector c) {
    (void)time, (void)speed, (void)r, (void)a, (void)b, (void)c;
    stress_flow *f = user;
    const haft_model_data *m = haft_model_get(f->model);
    stress_evaluate(f->oracle, N_VGetArrayPointer(u), f->load);
    for (size_t j = 0; j < m->dofs; j++) {
        for (size_t k = 0; k < STRESS_BAND && j + k < m->dofs; k++) {
            double h = (double)(f->oracle->hessian[j][k] / m->energy_unit);
            SM_COLUMN_ELEMENT_B(SUNBandMatrix_Column(out, (sunindextype)j), j + k, j) = h;
            SM_COLUMN_ELEMENT_B(SUNBandMatrix_Column(out, (sunindextype)(j + k)), j, j + k) = h;
        }
    }
    for (size_t j = 0; j < m->dofs; j++) {
        double *column = SUNBandMatrix_Column(out, (sunindextype)j);
        for (int k = m->column[j]; k < m->column[j + 1]; k++) {
            column[m->row[k] - (int)j] += cj * m->mass[k];
        }
    }
    return 0;
}

static inline void stress_flow_silent(int code, const char *module, const char *function,
                                      char *message, void *data) {
    (void)code, (void)module, (void)function, (void)message, (void)data;
}

/* M u' = -grad Pi, solved for u'. */
static inline void stress_flow_speed(stress_flow *f, N_Vector u, N_Vector speed, SUNMatrix matrix,
                                     SUNLinearSolver solver, N_Vector work) {
    const haft_model_data *m = haft_model_get(f->model);
    N_VConst(0, speed);
    stress_flow_residual(0, u, speed, work, f);
    N_VScale(-1, work, work);
    SUNMatZero(matrix);
    for (size_t j = 0; j < m->dofs; j++) {
        double *column = SUNBandMatrix_Column(matrix, (sunindextype)j);
        for (int k = m->column[j]; k < m->column[j + 1]; k++) {
            column[m->row[k] - (int)j] = m->mass[k];
        }
    }
    SUNLinSolSetup(solver, matrix);
    SUNLinSolSolve(solver, matrix, speed, work, 0);
}

/* The least range of a beam's laws, in gaps. */
static inline double stress_least_range(const stress_beam *b) {
    double range = INFINITY;
    for (size_t k = 0; k < b->laws; k++) {
        range = fmin(range, b->law[k].range);
    }
    return range / b->spec.gap;
}

/* Whether Newton leads from u to a stable equilibrium, no step going `most` lengths or more; then
 * it is in `rest`. */
static inline bool stress_flow_rests(stress_flow *f, const double *u, double *rest,
                                     long double most) {
    enum { SWEEPS = 12 };
    stress_oracle *o = f->oracle;
    long double least = fmaxl(1e-7L, 1e-14L / stress_least_range(o->beam)); /* u is rounded */
    memcpy(rest, u, o->dofs * sizeof *rest);
    for (int i = 0; i < SWEEPS; i++) {
        stress_evaluate(o, rest, f->load);
        if (stress_factorize(o, 0) > 0) {
            return false;
        }
        stress_newton(o);
        long double move = stress_step_size(o, rest);
        if (!(move < most)) {
            return false;
        }
        for (size_t k = 0; k < o->dofs; k++) {
            rest[k] += (double)o->step[k];
        }
        if (move < least) {
            return true;
        }
    }
    return false;
}

/* What IDA works with. */
typedef struct stress_ida {
    SUNContext context;
    N_Vector y, speed, work;
    SUNMatrix matrix;
    SUNLinearSolver solver;
    void *ida;
} stress_ida;

static inline bool stress_ida_start(stress_ida *s, stress_flow *f, double *u) {
    enum { HALF_BAND = STRESS_BAND - 1 };
    sunindextype n = (sunindextype)f->oracle->dofs;
    SUNContext_Create(NULL, &s->context);
    s->y = N_VMake_Serial(n, u, s->context);
    s->speed = N_VClone(s->y);
    s->work = N_VClone(s->y);
    s->matrix = SUNBandMatrix(n, HALF_BAND, HALF_BAND, s->context);
    s->solver = SUNLinSol_Band(s->y, s->matrix, s->context);
    s->ida = IDACreate(s->context);
    stress_flow_speed(f, s->y, s->speed, s->matrix, s->solver, s->work);
    double range = stress_least_range(f->oracle->beam);
    double tolerance = fmax(1e-13, fmin(1e-9, 1e-4 * range));
    return IDAInit(s->ida, stress_flow_residual, 0, s->y, s->speed) == IDA_SUCCESS &&
           IDASetErrHandlerFn(s->ida, stress_flow_silent, NULL) == IDA_SUCCESS &&
           IDASStolerances(s->ida, tolerance, tolerance) == IDA_SUCCESS &&
           IDASetUserData(s->ida, f) == IDA_SUCCESS &&
           IDASetLinearSolver(s->ida, s->solver, s->matrix) == IDA_SUCCESS &&
           IDASetJacFn(s->ida, stress_flow_jacobian) == IDA_SUCCESS &&
           IDASetMaxNumSteps(s->ida, STRESS_FLOW_STEPS) == IDA_SUCCESS;
}

static inline void stress_ida_end(stress_ida *s) {
    IDAFree(&s->ida);
    SUNLinSolFree(s->solver);
    SUNMatDestroy(s->matrix);
    N_VDestroy(s->y);
    N_VDestroy(s->speed);
    N_VDestroy(s->work);
    SUNContext_Free(&s->context);
}

/* Lets u, which is overwritten, flow at a load [N], and takes where it rests to another load nearby
 * by Newton, into `rest`. @return false if IDA or Newton gives up. */
static inline bool stress_flow_run(stress_oracle *o, const haft_model *m, double load, double to,
                                   double *u, double *rest) {
    stress_flow flow = {o, m, load};
    stress_ida s = {0};
    bool going = stress_ida_start(&s, &flow, u), rests = false;
    double time = 0;
    for (double end = 1e-3; going && !rests && end < 1e9; end *= 3) {
        going = IDASolve(s.ida, end, &time, s.y, s.speed, IDA_NORMAL) >= 0;
        rests = going && stress_flow_rests(&flow, u, rest, 0.01L);
    }
    stress_ida_end(&s);
    memcpy(u, rest, o->dofs * sizeof *u);
    flow.load = to;
    return rests && stress_flow_rests(&flow, u, rest, 1);
}

#endif
