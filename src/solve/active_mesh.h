/* SPDX-License-Identifier: GPL-3.0-or-later */
/* On which of the beam's meshes a state is solved, and what of it is frozen. Private to the room.
 */
#ifndef HAFT_SOLVE_ACTIVE_MESH_H
#define HAFT_SOLVE_ACTIVE_MESH_H

#include "tracker.h"

/* Creates the solvers of each mesh of the beam, and puts the whole mesh in use. */
haft_status haft_active_meshes_create(haft_tracker *t, haft_error *error);
void haft_active_meshes_destroy(haft_tracker *t);

/* Whether the laws of all sites that the mesh in use leaves out are zero. */
bool haft_active_mesh_is_clear(const haft_tracker *t, const double *u);

/* Puts mesh `at` in use, with no part frozen. */
void haft_active_mesh_enter(haft_tracker *t, size_t at);

/* Freezes the part behind the first `sites` sites, or a few more, as it is in `state`, until a mesh
 * is entered. The tracker's model is then the moving part, and t->n its number of unknowns;
 * energies remain those of the whole. The frozen part is copied to `other`. @return false, and
 * nothing is frozen, where more than the share `most` of the unknowns would still move. */
bool haft_active_mesh_freeze(haft_tracker *t, const haft_state *state, haft_state *other,
                             size_t sites, double most);

/* Unfreezes, and evaluates a state. @return false if it is not finite. */
bool haft_active_mesh_unfreeze(haft_tracker *t, haft_state *state);

/* The residual at the frozen node: the change of the forces on it since it was frozen, in the state
 * last evaluated. */
double haft_active_mesh_unbalance(const haft_tracker *t);

static inline bool haft_active_mesh_is_frozen(const haft_tracker *t) {
    return t->model == t->front;
}

/* Moves a state to a longer mesh that includes all sites it would touch at u = `ahead`; or to the
 * shortest one that includes all it may touch soon, coming from u = `before` (NULL: at rest). The
 * state is evaluated there, with the gaps of all sites. @return false if there is no such mesh. */
bool haft_active_mesh_widen(haft_tracker *t, haft_state *state, const double *ahead);
bool haft_active_mesh_narrow(haft_tracker *t, haft_state *state, const double *before);

#endif
