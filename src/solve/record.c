/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The record of a path. Its arrays grow by doubling. */
#include "record.h"

#include <math.h>
#include <string.h>

/* Least work that the ledger error is relative to, as a share of the energies, whose rounding would
 * show otherwise. */
#define NEGLIGIBLE_WORK 1e-6

/* Doubles an array so that it holds at least `need` items. */
static haft_status grow(void **array, size_t held, size_t *capacity, size_t need, size_t size,
                        haft_error *error) {
    if (need <= *capacity && *array != NULL) {
        return HAFT_OK;
    }
    size_t next = need < 32 ? 64 : 2 * need;
    void *bigger = haft_memory_alloc(next, size, error);
    if (bigger == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    if (held > 0) {
        memcpy(bigger, *array, held * size);
    }
    haft_memory_free(*array);
    *array = bigger;
    *capacity = next;
    return HAFT_OK;
}

static haft_status grow_points(haft_path *path, const haft_tracker *t, haft_error *error) {
    size_t capacity = path->point_capacity;
    void *array = path->point;
    haft_status status =
        grow(&array, path->points, &capacity, path->points + 1, sizeof *path->point, error);
    path->point = array;
    if (status == HAFT_OK && t->problem.options.keep_states) {
        size_t states = path->state == NULL ? 0 : path->point_capacity;
        array = path->state;
        status = grow(&array, path->points, &states, path->points + 1,
                      haft_model_get(t->problem.whole)->dofs * sizeof(double), error);
        path->state = array;
    }
    if (status == HAFT_OK) {
        path->point_capacity = capacity;
    }
    return status;
}

/* Interpolates `here` to the whole mesh. */
static void copy_state(const haft_tracker *t, double *u) {
    if (t->at == 0) {
        memcpy(u, t->here.u, haft_model_get(t->problem.whole)->dofs * sizeof *u);
    } else {
        haft_model_carry(t->mesh[t->at].model, t->problem.whole, t->here.u, u);
    }
}

haft_status haft_record_point(haft_path *path, haft_tracker *t, haft_ledger *ledger, int phase,
                              int jump, haft_error *error) {
    HAFT_TRY(grow_points(path, t, error));
    double lambda = haft_branch_least_eigenvalue(t);
    double gained = t->here.energy.strain + t->here.energy.contact - ledger->energy_start;
    double missing = fabs(ledger->work - ledger->dissipated - gained);
    ledger->worst = fmax(ledger->worst, missing);
    ledger->greatest =
        fmax(ledger->greatest, fabs(t->here.energy.strain) + fabs(t->here.energy.contact));
    t->ledger_left = fmax(0, t->problem.options.ledger_tolerance * ledger->turnover - missing);
    path->point[path->points] = (haft_path_point){
        .load = t->here.load * t->problem.load_unit,
        .deflection = haft_model_displacement(&haft_mesh_of(t)->load, t->here.u),
        .crack_length = haft_tracker_crack(t, &t->here),
        .internal_energy = t->here.energy.strain,
        .contact_energy = t->here.energy.contact,
        .work = ledger->work,
        .dissipated = ledger->dissipated,
        .lambda_min = lambda,
        .least_pivot = haft_factor_inertia(t->factor).least_pivot,
        .phase = phase,
        .jump = jump,
    };
    if (t->problem.options.keep_states) {
        copy_state(t, path->state + path->points * haft_model_get(t->problem.whole)->dofs);
    }
    path->points++;
    return HAFT_OK;
}

haft_status haft_record_jump(haft_path *path, const haft_jump *jump, haft_error *error) {
    void *array = path->jump;
    haft_status status =
        grow(&array, path->jumps, &path->jump_capacity, path->jumps + 1, sizeof *path->jump, error);
    path->jump = array;
    if (status == HAFT_OK) {
        path->jump[path->jumps++] = *jump;
    }
    return status;
}

/* |w_tip / w_end| under a force at the free end, at `here`, whose Hessian is factored anew. */
static double end_influence(haft_tracker *t, double crack) {
    const haft_model_data *m = haft_mesh_of(t);
    size_t end = 2 * (m->nodes - 2); /* the last node's deflection */
    double *w = t->work.scratch[0];
    if (!haft_tracker_evaluate(t, t->here.u, t->here.load, NULL, NULL) ||
        !haft_factor_update(t->factor, t->hessian)) {
        return NAN;
    }
    memset(w, 0, t->n * sizeof *w);
    w[end] = 1;
    haft_tracker_solve(t, w);
    double deflection, rotation;
    haft_model_shape(t->model, w, crack, &deflection, &rotation);
    return fabs(deflection / (m->scale[end] * w[end]));
}

haft_status haft_record_finish(haft_path *path, haft_tracker *t, const haft_ledger *ledger,
                               haft_error *error) {
    path->final_state =
        haft_memory_alloc(haft_model_get(t->problem.whole)->dofs, sizeof(double), error);
    if (path->final_state == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    copy_state(t, path->final_state);
    double scale = fmax(ledger->turnover, NEGLIGIBLE_WORK * ledger->greatest);
    path->ledger_error = scale > 0 ? ledger->worst / scale : 0;
    path->cost = t->cost;
    bool stuck =
        path->outcome == HAFT_OUTCOME_STUCK && haft_mesh_of(t)->nodes > 1 && path->points > 0;
    bool solved =
        stuck || path->outcome == HAFT_OUTCOME_FREE || path->outcome == HAFT_OUTCOME_STUCK;
    path->end_influence = solved ? 0 : NAN;
    if (stuck) {
        path->end_influence = end_influence(t, path->point[path->points - 1].crack_length);
    }
    return HAFT_OK;
}

void haft_path_destroy(haft_path **path) {
    if (path == NULL || *path == NULL) {
        return;
    }
    haft_memory_free((*path)->point);
    haft_memory_free((*path)->jump);
    haft_memory_free((*path)->state);
    haft_memory_free((*path)->final_state);
    haft_memory_free(*path);
    *path = NULL;
}

const char *haft_outcome_name(haft_outcome outcome) {
    static const char *const name[HAFT_OUTCOMES] = {
        "stuck",           "free",       "step stalled",     "flow stalled",
        "step limit",      "not finite", "active zone left", "not converged",
        "branch lost",     "singular",   "ledger open",      "limit point not located",
        "crack unreached",
    };
    return (unsigned)outcome < HAFT_OUTCOMES ? name[outcome] : "unknown";
}

const char *haft_outcome_advice(haft_outcome outcome) {
    static const char *const advice[HAFT_OUTCOMES] = {
        "",
        "",
        "ask for a slightly different load limit or crack length",
        "look for a law that is nearly flat, and for a beam that is nearly without stiffness",
        "look for a law with very many points or very noisy ones, or allow more steps",
        "look for a law or a number of the beam that is beyond all bounds",
        "use the exact mesh",
        "look for a very steep wall, or a gap of more than 1e8 ranges of a law",
        "look for a law with a kink that is much narrower than its range",
        "look for elements of very different lengths, and for a beam that nothing holds",
        "look for a law that is very steep beside the others, or allow the ledger more",
        "look for a law with a kink that is much narrower than its range",
        "ask for a longer crack, limit the load, or put the load farther from the clamp",
    };
    return (unsigned)outcome < HAFT_OUTCOMES ? advice[outcome] : "";
}
