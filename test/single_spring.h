/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One spring over one site, the smallest structure that can snap: what the tests of the solver
 * share. */
#ifndef HAFT_TEST_SINGLE_SPRING_H
#define HAFT_TEST_SINGLE_SPRING_H

#include "check.h"
#include "haft/beam.h"

/* Stiffness k [N/m] along its only displacement, which the load shares, over a site of `area` [m^2]
 * at `gap` [m]. */
static inline haft_model *single_spring(double k, double gap, double area) {
    haft_element element = {.dof = {0, -1, -1, -1}, .mode = {{1}}, .stiffness = {1}, .mass = {1}};
    haft_site site = {.area = area, .dof = {0, -1, -1, -1}, .shape = {gap}};
    haft_model_parts parts = {.dofs = 1,
                              .energy_unit = k * gap * gap,
                              .gap = gap,
                              .elements = 1,
                              .element = &element,
                              .sites = 1,
                              .site = &site,
                              .load = site};
    haft_model *model = NULL;
    haft_error error = {0};
    check_ok(haft_model_create(&model, &parts, &error), error);
    return model;
}

#endif
