/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The front part of a beam. Unknowns are numbered from the clamp, two per node, and element e
 * lies between nodes e and e + 1, the clamp being node 0. So elements behind a frozen node act
 * on none of the unknowns before it. */
#include "sites.h"

/* A front grows and shrinks by this many sites, because each change costs an evaluation. */
enum { BLOCK = 32 };

size_t haft_model_set_front(haft_model *front, const haft_model *model, size_t sites) {
    *front = *model;
    const int *dof = model->layout->dof;
    size_t inert = model->data.inert, asked = sites > inert ? sites - inert : 1;
    size_t first = inert + (asked + BLOCK - 1) / BLOCK * BLOCK; /* the first that is frozen */
    while (first < model->data.sites && dof[first] <= dof[inert + asked - 1]) {
        first += BLOCK; /* do not freeze the element of a site that must move */
    }
    if (model->data.nodes == 0 || first >= model->data.sites) {
        return model->data.dofs;
    }
    while (dof[first - 1] == dof[first]) { /* the sites before it on its element are frozen too */
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
