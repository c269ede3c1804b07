/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Assembly. The sparsity pattern is fixed for the life of a model, and the place of every entry
 * of elements and sites is looked up once. Assembling a Hessian is then only additions. */
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
    for (size_t e = 0; e < model->data.elements; e++) {
        add_pairs(model->data.element[e].dof, start, list, next);
    }
    for (size_t r = model->data.inert; r < model->data.sites; r++) {
        add_pairs(model->data.site[r].dof, start, list, next);
    }
    for (size_t i = 0; i < model->data.dofs; i++) {
        int diagonal[HAFT_SPAN] = {(int)i, -1, -1, -1};
        add_pairs(diagonal, start, list, next);
    }
}

/* Sorts each column and drops repeats. */
static void compress(haft_model *model, const int *start, int *list, const int *length) {
    int at = 0;
    for (size_t j = 0; j < model->data.dofs; j++) {
        int *rows = list + start[j];
        qsort(rows, (size_t)length[j], sizeof *rows, compare_ints);
        model->data.column[j] = at;
        for (int k = 0; k < length[j]; k++) {
            if (k == 0 || rows[k] != rows[k - 1]) {
                model->data.row[at++] = rows[k];
            }
        }
    }
    model->data.column[model->data.dofs] = at;
    model->data.nonzeros = (size_t)at;
}

static haft_status make_pattern(haft_model *model, haft_error *error) {
    size_t n = model->data.dofs;
    size_t bound = (model->data.elements + model->data.sites) * ENTRIES + n;
    int *start = haft_memory_alloc(n + 1, sizeof *start, error);
    int *length = haft_memory_alloc(n + 1, sizeof *length, error);
    int *list = haft_memory_alloc(bound, sizeof *list, error);
    model->data.column = haft_memory_alloc(n + 1, sizeof *model->data.column, error);
    model->data.row = haft_memory_alloc(bound, sizeof *model->data.row, error);
    haft_status status = HAFT_ERROR_MEMORY;
    if (start && length && list && model->data.column && model->data.row) {
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
    int low = model->data.column[j], high = model->data.column[j + 1] - 1;
    while (low < high) {
        int middle = (low + high) / 2;
        if (model->data.row[middle] < i) {
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
    for (size_t e = 0; e < model->data.elements; e++) {
        const haft_element *el = &model->data.element[e];
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
                model->data.stiffness[ij] += k;
                model->data.mass[ij] += el->mass[upper];
                if (i != j) {
                    model->data.stiffness[ji] += k;
                    model->data.mass[ji] += el->mass[upper];
                }
            }
        }
    }
}

/* Moves the nonzero terms to the front, so that fixed unknowns and zero shapes cost nothing. */
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
    model->data.dofs = parts->dofs;
    model->data.energy_unit = parts->energy_unit;
    model->data.gap = parts->gap;
    model->data.elements = parts->elements;
    model->data.sites = parts->sites;
    model->data.inert = parts->inert;
    model->data.load = parts->load;
    compact_site(&model->data.load);
    model->data.scale = haft_memory_alloc(parts->dofs, sizeof *model->data.scale, error);
    model->data.element = haft_memory_alloc(parts->elements, sizeof *model->data.element, error);
    model->data.site = haft_memory_alloc(parts->sites, sizeof *model->data.site, error);
    if (!model->data.scale || !model->data.element || !model->data.site) {
        return HAFT_ERROR_MEMORY;
    }
    for (size_t i = 0; i < parts->dofs; i++) {
        model->data.scale[i] = parts->scale == NULL ? 1.0 : parts->scale[i];
    }
    if (parts->elements > 0) {
        memcpy(model->data.element, parts->element, parts->elements * sizeof *model->data.element);
    }
    if (parts->sites > 0) {
        memcpy(model->data.site, parts->site, parts->sites * sizeof *model->data.site);
    }
    for (size_t r = 0; r < parts->sites; r++) {
        compact_site(&model->data.site[r]);
    }
    return HAFT_OK;
}

static haft_status fill_model(haft_model *model, haft_error *error) {
    HAFT_TRY(make_pattern(model, error));
    model->data.stiffness = haft_memory_alloc(model->data.nonzeros, sizeof(double), error);
    model->data.mass = haft_memory_alloc(model->data.nonzeros, sizeof(double), error);
    model->element_slot = haft_memory_alloc(model->data.elements * ENTRIES, sizeof(int), error);
    model->site_slot = haft_memory_alloc(model->data.sites * ENTRIES, sizeof(int), error);
    if (!model->data.stiffness || !model->data.mass || !model->element_slot || !model->site_slot) {
        return HAFT_ERROR_MEMORY;
    }
    for (size_t e = 0; e < model->data.elements; e++) {
        find_slots(model, model->data.element[e].dof, model->element_slot + e * ENTRIES);
    }
    for (size_t r = model->data.inert; r < model->data.sites; r++) {
        find_slots(model, model->data.site[r].dof, model->site_slot + r * ENTRIES);
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
    HAFT_TRY(check_parts(parts, error));
    haft_model *model = haft_memory_alloc(1, sizeof *model, error);
    if (model == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    haft_status status = copy_parts(model, parts, error);
    HAFT_THEN(status, fill_model(model, error));
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
    haft_memory_free(m->data.scale);
    haft_memory_free(m->data.element);
    haft_memory_free(m->data.site);
    haft_memory_free(m->data.node_x);
    haft_memory_free(m->data.column);
    haft_memory_free(m->data.row);
    haft_memory_free(m->data.stiffness);
    haft_memory_free(m->data.mass);
    haft_memory_free(m->element_slot);
    haft_memory_free(m->site_slot);
    haft_layout_destroy(&m->layout);
    haft_model_destroy(&m->shorter);
    haft_memory_free(m);
    *model = NULL;
}

const haft_model *haft_model_shorter(const haft_model *model) {
    return model->shorter;
}

void haft_model_add_stiffness(const haft_model *model, size_t site, double factor, double *matrix,
                              double kept[ENTRIES]) {
    const haft_site *s = &model->data.site[site];
    const int *slot = model->site_slot + site * ENTRIES;
    for (int i = 0; i < s->terms; i++) {
        for (int j = 0; j < s->terms; j++) {
            double *entry = &matrix[slot[i * HAFT_SPAN + j]];
            kept[i * HAFT_SPAN + j] = *entry;
            *entry += factor * s->shape[i] * s->shape[j];
        }
    }
}

void haft_model_restore_stiffness(const haft_model *model, size_t site, const double kept[ENTRIES],
                                  double *matrix) {
    const haft_site *s = &model->data.site[site];
    const int *slot = model->site_slot + site * ENTRIES;
    for (int i = 0; i < s->terms; i++) {
        for (int j = 0; j < s->terms; j++) {
            matrix[slot[i * HAFT_SPAN + j]] = kept[i * HAFT_SPAN + j];
        }
    }
}
