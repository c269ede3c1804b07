/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The front part of a beam. Its unknowns are numbered from the clamp on, two a node, element e
 * between nodes e and e + 1 of which the clamp is the first: what stands behind a held node touches
 * none of the unknowns before it. */
#include "sites.h"

/* A front grows and shrinks by so many sites, for each change of it costs an evaluation. */
enum { BLOCK = 32 };

size_t haft_model_set_front(haft_model *front, const haft_model *model, size_t sites) {
    *front = *model;
    const int *dof = model->layout->dof;
    size_t inert = model->data.inert, asked = sites > inert ? sites - inert : 1;
    size_t first = inert + (asked + BLOCK - 1) / BLOCK * BLOCK; /* the first that is frozen */
    while (first < model->data.sites && dof[first] <= dof[inert + asked - 1]) {
        first += BLOCK; /* a site asked for is not frozen with its element */
    }
    if (model->data.nodes == 0 || first >= model->data.sites) {
        return model->data.dofs;
    }
    while (dof[first - 1] == dof[first]) { /* those before it on its element do not move either */
        first--;
    }
    size_t node = (size_t)dof[first] / 2, moving = 2 * node;
    front->data.dofs = moving + 2;
    front->data.elements = node + 1;
    front->data.sites = first;
    front->stretches = (first - inert + HAFT_STRETCH - 1) / HAFT_STRETCH;
    front->data.nonzeros = (size_t)model->data.column[front->data.dofs];
    return moving;
}

haft_status haft_model_create_front(haft_model **out, haft_error *error) {
    *out = haft_memory_alloc(1, sizeof **out, error);
    return *out == NULL ? HAFT_ERROR_MEMORY : HAFT_OK;
}

void haft_model_destroy_front(haft_model **front) {
    if (front != NULL) {
        haft_memory_free(*front);
        *front = NULL;
    }
}
