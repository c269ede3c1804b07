/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which of a beam's meshes the solver works on. A site whose law is zero to the last digit bears no
 * force, and a beam without forces is one cubic. So a mesh without such sites has the same
 * equilibria, limit points and energies as the whole mesh, at the cost of the sites that remain.
 * The solver works on the shortest mesh that includes all sites in reach and a few to spare. It
 * changes to a shorter mesh as sites open, and to a longer one before a site that is left out comes
 * into reach. Only the drag in a landing differs: the free span has that of one cubic.
 *
 * Behind the front of the contact, steps and landings hardly move anything. While that part is
 * frozen, the mesh in use is the moving part alone. */
#include "active_mesh.h"
#include "corrector.h"

#include <math.h>
#include <string.h>

/* Sites to spare on a mesh that is changed to, so that it is not left at once. */
enum { SPARE_SITES = 4 };

/* Solves for the first n unknowns from now on. @return false if the solvers cannot. */
static bool lead(haft_tracker *t, size_t n) {
    t->n = n;
    return haft_factor_use_leading(t->factor, n) && haft_corrector_use_leading(t->corrector, n);
}

void haft_active_mesh_enter(haft_tracker *t, size_t at) {
    const haft_active_mesh *mesh = &t->mesh[at];
    t->at = at;
    t->model = mesh->model;
    t->factor = mesh->factor;
    t->corrector = mesh->corrector;
    t->mass = mesh->mass;
    t->frozen = (haft_frozen){0};
    lead(t, haft_model_get(mesh->model)->dofs);
}

static haft_energy subtract(haft_energy a, haft_energy b) {
    return (haft_energy){a.strain - b.strain, a.contact - b.contact, a.rounding - b.rounding};
}

/* Copies the frozen part to the other state, and clears its motion. */
static void keep_still(haft_tracker *t, const haft_state *state, haft_state *other) {
    const haft_model_data *m = haft_model_get(t->mesh[t->at].model);
    double *still[] = {t->solution,        t->null,           t->mode,          t->start.u1,
                       t->start.u2,        t->end.u1,         t->end.u2,        t->rebased.u1,
                       t->rebased.u2,      t->work.stage[0],  t->work.stage[1], t->work.stage[2],
                       t->work.scratch[0], t->work.scratch[1]};
    for (size_t i = 0; i < sizeof still / sizeof *still; i++) {
        memset(still[i] + t->n, 0, (m->dofs - t->n) * sizeof(double));
    }
    size_t first = haft_mesh_of(t)->sites, sites = m->sites - first;
    memset(t->motion + first, 0, sites * sizeof(double));
    memcpy(other->u + t->n, state->u + t->n, (m->dofs - t->n) * sizeof(double));
    memcpy(other->gap + first, state->gap + first, sites * sizeof(double));
}

bool haft_active_mesh_freeze(haft_tracker *t, const haft_state *state, haft_state *other,
                             size_t sites, double most) {
    const haft_model *m = t->mesh[t->at].model;
    size_t moving = haft_model_set_front(t->front, m, sites);
    if (t->problem.options.whole_mesh || (double)moving > most * (double)haft_model_get(m)->dofs ||
        !lead(t, moving)) {
        haft_active_mesh_enter(t, t->at);
        return false;
    }
    t->model = t->front;
    keep_still(t, state, other);
    haft_energy part;
    t->frozen = (haft_frozen){0};
    haft_tracker_evaluate(t, state->u, state->load, &part, NULL);
    t->frozen = (haft_frozen){.energy = subtract(state->energy, part),
                              .force = {t->gradient[moving], t->gradient[moving + 1]}};
    return true;
}

bool haft_active_mesh_unfreeze(haft_tracker *t, haft_state *state) {
    haft_active_mesh_enter(t, t->at);
    return haft_tracker_visit(t, state);
}

double haft_active_mesh_unbalance(const haft_tracker *t) {
    if (!haft_active_mesh_is_frozen(t)) {
        return 0;
    }
    const double *now = t->gradient + t->n, *then = t->frozen.force;
    return fmax(fabs(now[0] - then[0]), fabs(now[1] - then[1]));
}

static haft_status create_solvers(haft_tracker *t, haft_active_mesh *mesh, haft_error *error) {
    const haft_model_data *m = haft_model_get(mesh->model);
    haft_factor_kind kind = t->problem.options.linear_solver == HAFT_LINEAR_SOLVER_KLU
                                ? HAFT_FACTOR_KLU
                                : HAFT_FACTOR_BAND;
    haft_status status =
        haft_factor_create(&mesh->factor, kind, m->dofs, m->column, m->row, m->stiffness, error);
    HAFT_THEN(status,
              haft_diagonals_create(&mesh->mass, m->dofs, m->column, m->row, m->mass, error));
    return status == HAFT_OK ? haft_corrector_create(&mesh->corrector, t, mesh->model, error)
                             : status;
}

haft_status haft_active_meshes_create(haft_tracker *t, haft_error *error) {
    for (const haft_model *m = t->problem.whole; m != NULL; m = haft_model_shorter(m)) {
        t->meshes += t->meshes == 0 || !t->problem.options.whole_mesh;
    }
    t->mesh = haft_memory_alloc(t->meshes, sizeof *t->mesh, error);
    if (t->mesh == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    const haft_model *m = t->problem.whole;
    for (size_t i = 0; i < t->meshes; i++, m = haft_model_shorter(m)) {
        t->mesh[i].model = m;
        HAFT_TRY(create_solvers(t, &t->mesh[i], error));
    }
    haft_active_mesh_enter(t, 0);
    return HAFT_OK;
}

void haft_active_meshes_destroy(haft_tracker *t) {
    for (size_t i = 0; i < t->meshes && t->mesh != NULL; i++) {
        haft_corrector_destroy(&t->mesh[i].corrector);
        haft_factor_destroy(&t->mesh[i].factor);
        haft_diagonals_destroy(&t->mesh[i].mass);
    }
    haft_memory_free(t->mesh);
}

static void carry(haft_tracker *t, const haft_model *from, double *u) {
    haft_model_carry(from, t->model, u, t->work.scratch[0]);
    memcpy(u, t->work.scratch[0], t->n * sizeof *u);
}

static void change(haft_tracker *t, size_t at, haft_state *state) {
    const haft_model *from = t->mesh[t->at].model;
    haft_active_mesh_enter(t, at);
    carry(t, from, t->mode);
    carry(t, from, state->u);
    haft_model_gaps(t->model, state->u, state->gap);
    haft_tracker_evaluate(t, state->u, state->load, &state->energy, NULL);
}

bool haft_active_mesh_is_clear(const haft_tracker *t, const double *u) {
    return haft_model_clear_sites(t->model, u, t->problem.lost) == haft_mesh_of(t)->inert;
}

bool haft_active_mesh_widen(haft_tracker *t, haft_state *state, const double *ahead) {
    if (t->at == 0) {
        return false;
    }
    size_t clear = haft_model_clear_sites(t->model, ahead, t->problem.lost), at = t->at - 1;
    while (at > 0 && haft_model_get(t->mesh[at].model)->inert > clear) {
        at--;
    }
    change(t, at, state);
    return true;
}

/* Whether a mesh that leaves out the first `inert` sites has sites to spare, even after another
 * move like the last one. */
static bool is_enough(const haft_tracker *t, size_t inert, const double *u, const double *before) {
    for (size_t r = inert + SPARE_SITES; r-- > haft_model_get(t->problem.whole)->inert;) {
        const haft_site *site = &haft_mesh_of(t)->site[r];
        double w = haft_model_displacement(site, u);
        double coming = before == NULL ? 0 : w - haft_model_displacement(site, before);
        if (haft_mesh_of(t)->gap - w - fmax(0, 2 * coming) <= t->problem.lost[r]) {
            return false;
        }
    }
    return true;
}

bool haft_active_mesh_narrow(haft_tracker *t, haft_state *state, const double *before) {
    size_t at = t->at;
    while (at + 1 < t->meshes &&
           is_enough(t, haft_model_get(t->mesh[at + 1].model)->inert, state->u, before)) {
        at++;
    }
    if (at == t->at) {
        return false;
    }
    change(t, at, state);
    return true;
}
