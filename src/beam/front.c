/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The front part of a beam. Its unknowns are numbered from the clamp on, two a node, element e
 * between nodes e and e + 1 of which the clamp is the first: what stands behind a held node touches
 * none of the unknowns before it. */
#include "sites.h"

haft_model haft_model_front(const haft_model *model, size_t sites, size_t *moving) {
    haft_model front = *model;
    *moving = model->dofs;
    size_t active = sites > model->inert ? sites - model->inert : 1;
    size_t stretches = (active + HAFT_STRETCH - 1) / HAFT_STRETCH;
    const haft_layout *layout = model->layout;
    while (stretches < model->stretches && /* a site asked for is not held with its element */
           layout->dof[layout->stretch[stretches].first] <=
               layout->dof[model->inert + active - 1]) {
        stretches++;
    }
    if (model->nodes == 0 || stretches >= model->stretches) {
        return front;
    }
    size_t first = layout->stretch[stretches].first; /* of the sites that are held */
    size_t node = (size_t)layout->dof[first] / 2;
    *moving = 2 * node;
    front.dofs = *moving + 2;
    front.elements = node + 1;
    front.sites = first;
    front.stretches = stretches;
    front.nonzeros = (size_t)model->column[front.dofs];
    return front;
}
