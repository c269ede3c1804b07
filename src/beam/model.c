/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Assembly: the sparsity pattern, fixed for the life of a model, with the place of every element's
 * and site's entry looked up once, so that assembling a Hessian is additions alone. */
#include "sites.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ENTRIES = HAFT_SPAN * HAFT_SPAN };

static int compare_ints(const void *a, const void *b) {
    int x = *(const int *)a, y = *(const int *)b;
    return (x > y) - (x < y);
}

/* Adds the pairs of one group of unknowns to lists by column; `next` counts each list. */
static void add_pairs(const int dof[HAFT_SPAN], int *start, int *list, int *next) {
    for (int j = 0; j < HAFT_SPAN; j++) {
        for (int i = 0; i < HAFT_SPAN && dof[j] >= 0; i++) {
            if (dof[i] < 0) {
                continue;
            }
            if (list != NULL) {
                list[start[dof[j]] + next[dof[j]]] = dof[i];
            }
            next[dof[j]]++;
        }
    }
}

static void add_all_pairs(const haft_model *model, int *start, int *list, int *next) {
    for (size_t e = 0; e < model->elements; e++) {
        add_pairs(model->element[e].dof, start, list, next);
    }
    for (size_t r = model->inert; r < model->sites; r++) {
        add_pairs(model->site[r].dof, start, list, next);
    }
    for (size_t i = 0; i < model->dofs; i++) {
        int diagonal[HAFT_SPAN] = {(int)i, -1, -1, -1};
        add_pairs(diagonal, start, list, next);
    }
}

/* Sorts each column and drops repeats. */
static void compress(haft_model *model, const int *start, int *list, const int *length) {
    int at = 0;
    for (size_t j = 0; j < model->dofs; j++) {
        int *rows = list + start[j];
        qsort(rows, (size_t)length[j], sizeof *rows, compare_ints);
        model->column[j] = at;
        for (int k = 0; k < length[j]; k++) {
            if (k == 0 || rows[k] != rows[k - 1]) {
                model->row[at++] = rows[k];
            }
        }
    }
    model->column[model->dofs] = at;
    model->nonzeros = (size_t)at;
}

static haft_status make_pattern(haft_model *model, haft_error *error) {
    size_t n = model->dofs;
    size_t bound = (model->elements + model->sites) * ENTRIES + n;
    int *start = haft_memory_alloc(n + 1, sizeof *start, error);
    int *length = haft_memory_alloc(n + 1, sizeof *length, error);
    int *list = haft_memory_alloc(bound, sizeof *list, error);
    model->column = haft_memory_alloc(n + 1, sizeof *model->column, error);
    model->row = haft_memory_alloc(bound, sizeof *model->row, error);
    haft_status status = HAFT_ERROR_MEMORY;
    if (start && length && list && model->column && model->row) {
        add_all_pairs(model, start, NULL, length);
        for (size_t j = 0; j < n; j++) {
            start[j + 1] = start[j] + length[j];
        }
        memset(length, 0, (n + 1) * sizeof *length);
        add_all_pairs(model, start, list, length);
        compress(model, start, list, length);
        status = HAFT_OK;
    }
    haft_memory_free(start);
    haft_memory_free(length);
    haft_memory_free(list);
    return status;
}

static int find_slot(const haft_model *model, int i, int j) {
    int low = model->column[j], high = model->column[j + 1] - 1;
    while (low < high) {
        int middle = (low + high) / 2;
        if (model->row[middle] < i) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

static void find_slots(const haft_model *model, const int dof[HAFT_SPAN], int *slot) {
    for (int i = 0; i < HAFT_SPAN; i++) {
        for (int j = 0; j < HAFT_SPAN; j++) {
            bool held = dof[i] < 0 || dof[j] < 0;
            slot[i * HAFT_SPAN + j] = held ? -1 : find_slot(model, dof[i], dof[j]);
        }
    }
}

static void assemble_constants(haft_model *model) {
    for (size_t e = 0; e < model->elements; e++) {
        const haft_element *el = &model->element[e];
        const int *slot = model->element_slot + e * ENTRIES;
        const double *d = el->stiffness;
        for (int i = 0, upper = 0; i < HAFT_SPAN; i++) {
            for (int j = i; j < HAFT_SPAN; j++, upper++) {
                double k = el->mode[0][i] * (d[0] * el->mode[0][j] + d[1] * el->mode[1][j]) +
                           el->mode[1][i] * (d[1] * el->mode[0][j] + d[2] * el->mode[1][j]);
                int ij = slot[i * HAFT_SPAN + j], ji = slot[j * HAFT_SPAN + i];
                if (ij < 0) {
                    continue;
                }
                model->stiffness[ij] += k;
                model->mass[ij] += el->mass[upper];
                if (i != j) {
                    model->stiffness[ji] += k;
                    model->mass[ji] += el->mass[upper];
                }
            }
        }
    }
}

/* Puts the terms that count in front: an unknown that is held, or has no part, costs nothing. */
static void compact_site(haft_site *site) {
    int terms = 0;
    for (int k = 0; k < HAFT_SPAN; k++) {
        if (site->dof[k] >= 0 && site->shape[k] != 0) {
            site->dof[terms] = site->dof[k];
            site->shape[terms++] = site->shape[k];
        }
    }
    site->terms = terms;
    for (int k = terms; k < HAFT_SPAN; k++) {
        site->dof[k] = -1;
        site->shape[k] = 0;
    }
}

static haft_status copy_parts(haft_model *model, const haft_model_parts *parts, haft_error *error) {
    model->dofs = parts->dofs;
    model->energy_unit = parts->energy_unit;
    model->gap = parts->gap;
    model->elements = parts->elements;
    model->sites = parts->sites;
    model->inert = parts->inert;
    model->load = parts->load;
    compact_site(&model->load);
    model->scale = haft_memory_alloc(parts->dofs, sizeof *model->scale, error);
    model->element = haft_memory_alloc(parts->elements, sizeof *model->element, error);
    model->site = haft_memory_alloc(parts->sites, sizeof *model->site, error);
    if (!model->scale || !model->element || !model->site) {
        return HAFT_ERROR_MEMORY;
    }
    for (size_t i = 0; i < parts->dofs; i++) {
        model->scale[i] = parts->scale == NULL ? 1.0 : parts->scale[i];
    }
    if (parts->elements > 0) {
        memcpy(model->element, parts->element, parts->elements * sizeof *model->element);
    }
    if (parts->sites > 0) {
        memcpy(model->site, parts->site, parts->sites * sizeof *model->site);
    }
    for (size_t r = 0; r < parts->sites; r++) {
        compact_site(&model->site[r]);
    }
    return HAFT_OK;
}

static haft_status fill_model(haft_model *model, haft_error *error) {
    haft_status status = make_pattern(model, error);
    if (status != HAFT_OK) {
        return status;
    }
    model->stiffness = haft_memory_alloc(model->nonzeros, sizeof(double), error);
    model->mass = haft_memory_alloc(model->nonzeros, sizeof(double), error);
    model->element_slot = haft_memory_alloc(model->elements * ENTRIES, sizeof(int), error);
    model->site_slot = haft_memory_alloc(model->sites * ENTRIES, sizeof(int), error);
    if (!model->stiffness || !model->mass || !model->element_slot || !model->site_slot) {
        return HAFT_ERROR_MEMORY;
    }
    for (size_t e = 0; e < model->elements; e++) {
        find_slots(model, model->element[e].dof, model->element_slot + e * ENTRIES);
    }
    for (size_t r = model->inert; r < model->sites; r++) {
        find_slots(model, model->site[r].dof, model->site_slot + r * ENTRIES);
    }
    assemble_constants(model);
    return haft_layout_create(&model->layout, &model->stretches, model, error);
}

static bool dofs_in_range(const int dof[HAFT_SPAN], size_t dofs) {
    for (int k = 0; k < HAFT_SPAN; k++) {
        if (dof[k] >= (int)dofs) {
            return false;
        }
    }
    return true;
}

static haft_status check_parts(const haft_model_parts *parts, haft_error *error) {
    bool sound = parts->dofs > 0 && parts->dofs < 1u << 28 && parts->energy_unit > 0 &&
                 parts->inert <= parts->sites && dofs_in_range(parts->load.dof, parts->dofs);
    for (size_t e = 0; sound && e < parts->elements; e++) {
        sound = dofs_in_range(parts->element[e].dof, parts->dofs);
    }
    for (size_t r = 0; sound && r < parts->sites; r++) {
        sound = dofs_in_range(parts->site[r].dof, parts->dofs);
    }
    return sound ? HAFT_OK
                 : haft_error_set(error, HAFT_ERROR_ARGUMENT,
                                  "a model needs unknowns, a positive energy unit, and parts that "
                                  "touch no unknown beyond %zu",
                                  parts->dofs);
}

haft_status haft_model_create(haft_model **out, const haft_model_parts *parts, haft_error *error) {
    *out = NULL;
    haft_status status = check_parts(parts, error);
    if (status != HAFT_OK) {
        return status;
    }
    haft_model *model = haft_memory_alloc(1, sizeof *model, error);
    if (model == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    status = copy_parts(model, parts, error);
    if (status == HAFT_OK) {
        status = fill_model(model, error);
    }
    if (status != HAFT_OK) {
        haft_model_destroy(&model);
        return status;
    }
    *out = model;
    return HAFT_OK;
}

void haft_model_destroy(haft_model **model) {
    if (model == NULL || *model == NULL) {
        return;
    }
    haft_model *m = *model;
    haft_memory_free(m->scale);
    haft_memory_free(m->element);
    haft_memory_free(m->site);
    haft_memory_free(m->node_x);
    haft_memory_free(m->column);
    haft_memory_free(m->row);
    haft_memory_free(m->stiffness);
    haft_memory_free(m->mass);
    haft_memory_free(m->element_slot);
    haft_memory_free(m->site_slot);
    haft_layout_destroy(&m->layout);
    haft_model_destroy(&m->shorter);
    haft_memory_free(m);
    *model = NULL;
}
