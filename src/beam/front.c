/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The front part of a beam. Its unknowns are numbered from the clamp on, two a node, element e
 * between nodes e and e + 1 of which the clamp is the first: what stands behind a held node touches
 * none of the unknowns before it. */
#include "sites.h"

/* A front grows and shrinks by so many sites, for each change of it costs an evaluation. */
enum { BLOCK = 32 };

haft_model haft_model_front(const haft_model *model, size_t sites, size_t *moving) {
    haft_model front = *model;
    *moving = model->dofs;
    const int *dof = model->layout->dof;
    size_t asked = sites > model->inert ? sites - model->inert : 1;
    size_t first = model->inert + (asked + BLOCK - 1) / BLOCK * BLOCK; /* that is held */
    while (first < model->sites && dof[first] <= dof[model->inert + asked - 1]) {
        first += BLOCK; /* a site asked for is not held with its element */
    }
    if (model->nodes == 0 || first >= model->sites) {
        return front;
    }
    while (dof[first - 1] == dof[first]) { /* those before it on its element do not move either */
        first--;
    }
    size_t node = (size_t)dof[first] / 2;
    *moving = 2 * node;
    front.dofs = *moving + 2;
    front.elements = node + 1;
    front.sites = first;
    front.stretches = (first - model->inert + HAFT_STRETCH - 1) / HAFT_STRETCH;
    front.nonzeros = (size_t)model->column[front.dofs];
    return front;
}
