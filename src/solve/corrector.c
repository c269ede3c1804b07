/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The corrector: KINSOL's full Newton on u and P together,
 *
 *     grad Pi(u, P) = 0,    tau(u, P) - value = 0,
 *
 * with a linear solver module of our own. SUNDIALS' KLU module analyses the pattern in each KINSol
 * call, pivots off the diagonal, and cannot handle a border. Ours adds kappa c c' (c the
 * parameter's row) to H. That changes nothing where the constraint holds, but keeps the matrix
 * positive definite through a simple fold. The border is eliminated with two solves. KINSOL's
 * matrix stands for the tracker's Hessian, so that nothing is copied. */
#include "corrector.h"
#include "vectors.h"

#include <kinsol/kinsol.h>
#include <math.h>
#include <string.h>
#include <sundials/sundials_config.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>

enum { NEWTON_LIMIT = 12 };

/* Give up at the second residual that is not below all before it: at the knots of a table Newton
 * can cycle. */
enum { RISES = 2 };

/* Residuals are relative to the largest force, but at least to this, in units of energy_unit / gap:
 * an unloaded beam far above its substrate has no forces. */
#define LEAST_FORCE 1e-3

/* Rounding of a parameter's value, as a share of the terms of its sum. */
#define VALUE_ROUNDING 0x1p-51

struct haft_corrector {
    haft_tracker *tracker;
    size_t n; /* unknowns, of which the tracker's move; the load comes after them */
    haft_parameter parameter;
    double value;
    double kappa;
    bool evaluated; /* gradient, Hessian and energy at hand are those of the first residual */
    bool finite;
    double least; /* residual so far; rises: how often one was not less */
    int rises;
    haft_energy energy;  /* at the last residual: KINSOL ends on it */
    haft_factor *factor; /* of the Hessian and the border's stiffness */
    SUNContext context;
    N_Vector y, y_scale, f_scale;
    SUNMatrix matrix;
    SUNLinearSolver solver;
    void *kinsol;
};

static int residual(N_Vector y, N_Vector f, void *user) {
    haft_corrector *c = user;
    haft_tracker *t = c->tracker;
    const double *u = N_VGetArrayPointer(y);
    double *out = N_VGetArrayPointer(f);
    double load = u[c->n];
    if (!c->evaluated) {
        c->finite = isfinite(load) && haft_tracker_evaluate(t, u, load, &c->energy, NULL);
    }
    c->evaluated = false;
    if (!c->finite) {
        return 1;
    }
    memcpy(out, t->gradient, t->n * sizeof *out);
    memset(out + t->n, 0, (c->n - t->n) * sizeof *out);
    out[c->n] =
        (c->parameter.site == NULL ? load : haft_tracker_row(t, c->parameter.site, u)) - c->value;
    return 0;
}

/* The residual was just evaluated at the same y, so the tracker holds its Hessian. */
static int jacobian(N_Vector y, N_Vector f, SUNMatrix matrix, void *user, N_Vector a, N_Vector b) {
    (void)y, (void)matrix, (void)a, (void)b;
    haft_corrector *c = user;
    double now = N_VMaxNorm(f);
    c->rises += now >= c->least;
    c->least = fmin(c->least, now);
    return c->rises < RISES ? 0 : 1;
}

static SUNMatrix_ID matrix_kind(SUNMatrix matrix) {
    (void)matrix;
    return SUNMATRIX_CUSTOM;
}

static int matrix_zero(SUNMatrix matrix) {
    (void)matrix;
    return 0;
}

static SUNLinearSolver_Type solver_type(SUNLinearSolver solver) {
    (void)solver;
    return SUNLINEARSOLVER_DIRECT;
}

static int solver_initialize(SUNLinearSolver solver) {
    (void)solver;
    return 0;
}

/* Factors H + kappa c c'. The few entries of the border are added to the Hessian and then restored
 * to the last bit. */
static int solver_setup(SUNLinearSolver solver, SUNMatrix matrix) {
    (void)matrix;
    haft_corrector *c = solver->content;
    haft_tracker *t = c->tracker;
    bool bordered = c->parameter.site != NULL;
    size_t site = c->parameter.index;
    double factor = c->kappa / (haft_mesh_of(t)->gap * haft_mesh_of(t)->gap),
           kept[HAFT_SPAN * HAFT_SPAN];
    if (bordered) {
        haft_model_add_stiffness(t->model, site, factor, t->hessian, kept);
    }
    haft_tracker_count_factorization(t);
    bool made = haft_factor_update(c->factor, t->hessian);
    if (bordered) {
        haft_model_restore_stiffness(t->model, site, kept, t->hessian);
    }
    return made ? 0 : 1;
}

static int solver_solve(SUNLinearSolver solver, SUNMatrix matrix, N_Vector x, N_Vector b,
                        sunrealtype tolerance) {
    (void)matrix, (void)tolerance;
    haft_corrector *c = solver->content;
    haft_tracker *t = c->tracker;
    const double *rhs = N_VGetArrayPointer(b);
    double *out = N_VGetArrayPointer(x);
    double *y = t->work.pair, s = rhs[c->n];
    t->cost.solves++;
    memcpy(y, rhs, t->n * sizeof *y);
    memset(out + t->n, 0, (c->n - t->n) * sizeof *out);
    if (c->parameter.site == NULL) {
        haft_tracker_add_row(t, &haft_mesh_of(t)->load, s, y);
        haft_factor_solve(c->factor, y, 1);
        memcpy(out, y, t->n * sizeof *out);
        out[c->n] = s;
        return 0;
    }
    double *z = t->work.pair + t->n;
    memset(z, 0, t->n * sizeof *z);
    haft_tracker_add_row(t, c->parameter.site, c->kappa * s, y);
    haft_tracker_add_row(t, &haft_mesh_of(t)->load, 1, z);
    haft_factor_solve(c->factor, t->work.pair, 2);
    double d_load =
        (s - haft_tracker_row(t, c->parameter.site, y)) / haft_tracker_row(t, c->parameter.site, z);
    if (!isfinite(d_load)) {
        return 1;
    }
    for (size_t i = 0; i < t->n; i++) {
        out[i] = y[i] + d_load * z[i];
    }
    out[c->n] = d_load;
    return 0;
}

static int solver_free(SUNLinearSolver solver) {
    solver->content = NULL;
    SUNLinSolFreeEmpty(solver);
    return 0;
}

#if SUNDIALS_VERSION_MAJOR >= 7
static void stay_silent(int line, const char *function, const char *file, const char *message,
                        SUNErrCode code, void *data, SUNContext context) {
    (void)line, (void)function, (void)file, (void)message, (void)code, (void)data, (void)context;
}
#else
static void stay_silent(int code, const char *module, const char *function, char *message,
                        void *data) {
    (void)code, (void)module, (void)function, (void)message, (void)data;
}
#endif

static bool make_context(haft_corrector *c) {
#if SUNDIALS_VERSION_MAJOR >= 7
    if (SUNContext_Create(SUN_COMM_NULL, &c->context) != 0) {
        return false;
    }
    SUNContext_ClearErrHandlers(c->context);
    return SUNContext_PushErrHandler(c->context, stay_silent, NULL) == 0;
#else
    return SUNContext_Create(NULL, &c->context) == 0;
#endif
}

static bool make_vectors(haft_corrector *c) {
    c->y = haft_vector_create(c->n + 1, c->context);
    c->y_scale = haft_vector_create(c->n + 1, c->context);
    c->f_scale = haft_vector_create(c->n + 1, c->context);
    c->matrix = SUNMatNewEmpty(c->context);
    c->solver = SUNLinSolNewEmpty(c->context);
    c->kinsol = KINCreate(c->context);
    if (!c->y || !c->y_scale || !c->f_scale || !c->matrix || !c->solver || !c->kinsol) {
        return false;
    }
    N_VConst(1.0, c->y_scale);
    c->matrix->ops->getid = matrix_kind;
    c->matrix->ops->zero = matrix_zero;
    c->solver->content = c;
    c->solver->ops->gettype = solver_type;
    c->solver->ops->initialize = solver_initialize;
    c->solver->ops->setup = solver_setup;
    c->solver->ops->solve = solver_solve;
    c->solver->ops->free = solver_free;
    return true;
}

static bool set_up_kinsol(haft_corrector *c) {
    bool ok = KINInit(c->kinsol, residual, c->y) == KIN_SUCCESS;
#if SUNDIALS_VERSION_MAJOR < 7
    ok = ok && KINSetErrHandlerFn(c->kinsol, stay_silent, NULL) == KIN_SUCCESS;
#endif
    return ok && KINSetUserData(c->kinsol, c) == KIN_SUCCESS &&
           KINSetLinearSolver(c->kinsol, c->solver, c->matrix) == KIN_SUCCESS &&
           KINSetJacFn(c->kinsol, jacobian) == KIN_SUCCESS &&
           KINSetMaxSetupCalls(c->kinsol, 1) == KIN_SUCCESS &&
           KINSetNumMaxIters(c->kinsol, NEWTON_LIMIT) == KIN_SUCCESS &&
           KINSetScaledStepTol(c->kinsol, 1e-16) == KIN_SUCCESS &&
           KINSetMaxNewtonStep(c->kinsol, 1e12) == KIN_SUCCESS;
}

haft_status haft_corrector_create(haft_corrector **out, haft_tracker *t, const haft_model *model,
                                  haft_error *error) {
    const haft_model_data *m = haft_model_get(model);
    *out = NULL;
    haft_corrector *c = haft_memory_alloc(1, sizeof *c, error);
    if (c == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    c->tracker = t;
    c->n = m->dofs;
    haft_factor_kind kind = t->problem.options.linear_solver == HAFT_LINEAR_SOLVER_BAND
                                ? HAFT_FACTOR_BAND
                                : HAFT_FACTOR_KLU;
    haft_status status =
        haft_factor_create(&c->factor, kind, c->n, m->column, m->row, m->stiffness, error);
    if (status != HAFT_OK) {
        haft_corrector_destroy(&c);
        return status;
    }
    if (!make_context(c) || !make_vectors(c) || !set_up_kinsol(c)) {
        haft_corrector_destroy(&c);
        return haft_error_set(error, HAFT_ERROR_LIBRARY, "KINSOL cannot be set up");
    }
    *out = c;
    return HAFT_OK;
}

void haft_corrector_destroy(haft_corrector **corrector) {
    if (corrector == NULL || *corrector == NULL) {
        return;
    }
    haft_corrector *c = *corrector;
    if (c->kinsol != NULL) {
        KINFree(&c->kinsol);
    }
    if (c->solver != NULL) {
        if (c->solver->ops->free == NULL) {
            SUNLinSolFreeEmpty(c->solver);
        } else {
            SUNLinSolFree(c->solver);
        }
    }
    if (c->matrix != NULL) {
        SUNMatDestroy(c->matrix);
    }
    N_VDestroy(c->y);
    N_VDestroy(c->y_scale);
    N_VDestroy(c->f_scale);
    if (c->context != NULL) {
        SUNContext_Free(&c->context);
    }
    haft_factor_destroy(&c->factor);
    haft_memory_free(c);
    *corrector = NULL;
}

bool haft_corrector_use_leading(haft_corrector *corrector, size_t n) {
    return haft_factor_use_leading(corrector->factor, n);
}

/* Forces due to rounding of u, by the current Hessian: no residual can be smaller. Two sums a
 * column, to shorten the chain of additions. */
static double rounding_floor(const haft_tracker *t, const double *u) {
    double largest = 0;
    const double *h = t->hessian;
    const int *column = haft_mesh_of(t)->column, *row = haft_mesh_of(t)->row;
    for (size_t j = 0; j < t->n; j++) { /* H is symmetric: a column is a row */
        double even = 0, odd = 0;
        int k = column[j], end = column[j + 1];
        for (; k + 1 < end; k += 2) {
            even += fabs(h[k] * u[row[k]]);
            odd += fabs(h[k + 1] * u[row[k + 1]]);
        }
        double sum = even + odd + (k < end ? fabs(h[k] * u[row[k]]) : 0);
        largest = sum > largest ? sum : largest;
    }
    return 4 * 0x1p-52 * largest;
}

/* The scale of the parameter's residual. Where the gap is very large against the range of the law,
 * the tolerance times that range would be below the rounding of the parameter's value, which no
 * iteration can undercut; then the scale is larger. */
static double parameter_length(const haft_tracker *t, haft_parameter parameter, double value,
                               const double *u) {
    const haft_site *site = parameter.site;
    if (site == NULL) {
        return fmax(fabs(value), 1);
    }
    double size = fabs(value);
    for (int k = 0; k < site->terms; k++) {
        size += fabs(site->shape[k] * u[site->dof[k]]) / haft_mesh_of(t)->gap;
    }
    double least = VALUE_ROUNDING * size / t->problem.options.residual_tolerance;
    return fmax(t->problem.lengths.range[parameter.index] / haft_mesh_of(t)->gap, least);
}

/* A stiffness at the parameter that exceeds any softening of its law. */
static double border_stiffness(const haft_tracker *t, haft_parameter parameter) {
    if (parameter.site == NULL) {
        return 0;
    }
    const haft_law *law = &t->problem.laws[parameter.index];
    double slope =
        4 * law->f_max / t->problem.lengths.range[parameter.index] + t->problem.far_slope;
    double gap = haft_mesh_of(t)->gap;
    return 1 + slope * parameter.site->area * gap * gap / haft_mesh_of(t)->energy_unit;
}

/* Runs KINSOL from c->y down to a residual of `tolerance`. */
static bool run_kinsol(haft_corrector *c, double tolerance) {
    if (KINSetFuncNormTol(c->kinsol, tolerance) != KIN_SUCCESS) {
        return false;
    }
    c->least = INFINITY;
    c->rises = 0;
    int flag = KINSol(c->kinsol, c->y, KIN_NONE, c->y_scale, c->f_scale);
    long iterations = 0;
    KINGetNumNonlinSolvIters(c->kinsol, &iterations);
    c->tracker->cost.newton_iterations += (size_t)iterations;
    return flag == KIN_SUCCESS || flag == KIN_INITIAL_GUESS_OK;
}

bool haft_corrector_solve(haft_tracker *t, haft_parameter parameter, double value,
                          haft_state *state) {
    haft_corrector *c = t->corrector;
    c->parameter = parameter;
    c->value = value;
    c->kappa = border_stiffness(t, parameter);
    double *y = N_VGetArrayPointer(c->y);
    memcpy(y, state->u, c->n * sizeof *y);
    y[c->n] = state->load;
    double force = 0;
    c->finite = haft_tracker_evaluate(t, y, state->load, &c->energy, &force);
    if (!c->finite) {
        return false;
    }
    c->evaluated = true;
    memcpy(t->gap_predicted, t->gap, haft_mesh_of(t)->sites * sizeof(double));
    force = fmax(fmax(force, fabs(state->load)), LEAST_FORCE);
    double *scale = N_VGetArrayPointer(c->f_scale);
    for (size_t i = 0; i < c->n; i++) {
        scale[i] = 1 / force;
    }
    scale[c->n] = 1 / parameter_length(t, parameter, value, y);
    double tolerance = fmax(t->problem.options.residual_tolerance, rounding_floor(t, y) / force);
    bool solved = run_kinsol(c, tolerance);
    if (!solved && c->finite) { /* the floor at the start, as at rest, can be far too low */
        double floor_here = rounding_floor(t, y) / force;
        c->evaluated = false;
        solved = floor_here > tolerance && run_kinsol(c, floor_here);
        tolerance = floor_here;
    }
    t->residual = tolerance * force;
    if (!solved) {
        return false;
    }
    memcpy(state->u, y, t->n * sizeof *y);
    state->load = y[c->n];
    state->energy = c->energy;
    memcpy(state->gap, t->gap, haft_mesh_of(t)->sites * sizeof(double));
    state->crack = NAN;
    return true;
}
