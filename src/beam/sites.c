/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sites in vector code. Where several share an element, they share its four unknowns: their
 * displacements are computed together, and what they give is summed before it is scattered once. On
 * a mesh with a node at each, a site is one unknown and one entry. */
#include "sites.h"

#include <math.h>
#include <string.h>

enum { LANES = HAFT_LAW_LANES, ENTRIES = HAFT_SPAN * HAFT_SPAN };

static bool same_unknowns(const haft_site *a, const haft_site *b) {
    return memcmp(a->dof, b->dof, sizeof a->dof) == 0;
}

/* Whether site r goes on the run that ends before it. */
static bool continues(const haft_model *model, const haft_run *run, size_t r) {
    const haft_site *site = &model->site[r];
    return run->shared ? same_unknowns(&model->site[run->first], site) : site->terms == 1;
}

/* @return the number of stretches */
static size_t find_runs(haft_layout *layout, const haft_model *model) {
    size_t stretches = 0;
    for (size_t r = model->inert; r < model->sites; r++) {
        if ((r - model->inert) % HAFT_STRETCH == 0) {
            layout->stretch[stretches++] = (haft_stretch){r, 0, layout->runs, 0};
        }
        haft_stretch *s = &layout->stretch[stretches - 1];
        if (s->runs == 0 || !continues(model, &layout->run[layout->runs - 1], r)) {
            const haft_site *site = &model->site[r];
            bool whole = site->terms == HAFT_SPAN;
            for (int k = 1; k < HAFT_SPAN; k++) {
                whole = whole && site->dof[k] == site->dof[0] + k;
            }
            layout->run[layout->runs++] = (haft_run){r, 0, r, site->terms != 1, whole};
            s->runs++;
        }
        layout->run[layout->runs - 1].sites++;
        s->sites++;
    }
    return stretches;
}

/* Whether n sites from b on are shaped as those from a on. */
static bool same_shapes(const haft_site *a, const haft_site *b, size_t n) {
    for (size_t i = 0; i < n; i++) {
        if (memcmp(a[i].shape, b[i].shape, sizeof a->shape) != 0) {
            return false;
        }
    }
    return true;
}

/* Has runs across whole elements read the entries of the first element that they are alike. */
static void find_alike(haft_layout *layout, const haft_model *model) {
    size_t n = 0;
    while (n < layout->runs && !layout->run[n].whole) {
        n++;
    }
    size_t first = n < layout->runs ? layout->run[n].first : 0, end = first + HAFT_STRETCH;
    for (; n < layout->runs; n++) {
        haft_run *run = &layout->run[n];
        for (size_t r = first; run->whole && r < end && r < run->first; r++) {
            if (same_shapes(&model->site[r], &model->site[run->first], run->sites)) {
                run->alike = r;
                break;
            }
        }
    }
}

/* Inert sites that share their unknowns, after the other sites' runs. */
static void find_idle_runs(haft_layout *layout, const haft_model *model) {
    haft_run *run = layout->run + layout->runs;
    for (size_t r = 0; r < model->inert; r++) {
        if (r == 0 || !continues(model, &run[layout->idle - 1], r)) {
            run[layout->idle++] = (haft_run){r, 0, r, true, false};
        }
        run[layout->idle - 1].sites++;
    }
}

static void fill(haft_layout *layout, const haft_model *model) {
    for (size_t r = 0; r < model->sites; r++) {
        const double *shape = model->site[r].shape;
        double *share = layout->share + r * HAFT_SHARES;
        layout->area[r] = model->site[r].area;
        for (int k = 0; k < model->site[r].terms; k++) {
            layout->top[r] = fmax(layout->top[r], fabs(shape[k]));
        }
        layout->dof[r] = model->site[r].dof[0];
        layout->slot[r] = r < model->inert ? -1 : model->site_slot[r * ENTRIES];
        for (size_t i = 0; i < HAFT_SPAN; i++) {
            layout->shape[i * layout->stride + r] = shape[i];
            share[i] = shape[i];
            for (size_t j = 0; j < HAFT_SPAN; j++) {
                share[(1 + j) * HAFT_SPAN + i] = shape[i] * shape[j];
            }
        }
    }
}

haft_status haft_layout_create(haft_layout **out, size_t *stretches, const haft_model *model,
                               haft_error *error) {
    *out = NULL;
    haft_layout *layout = haft_memory_alloc(1, sizeof *layout, error);
    if (layout == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    size_t sites = model->sites;
    layout->stride = haft_law_lanes(sites);
    layout->stretch = haft_memory_alloc(sites / HAFT_STRETCH + 1, sizeof *layout->stretch, error);
    layout->run = haft_memory_alloc(sites, sizeof *layout->run, error);
    layout->shape = haft_memory_alloc(HAFT_SPAN * layout->stride, sizeof(double), error);
    layout->area = haft_memory_alloc(layout->stride, sizeof(double), error);
    layout->top = haft_memory_alloc(layout->stride, sizeof(double), error);
    layout->share = haft_memory_alloc(HAFT_SHARES * sites, sizeof(double), error);
    layout->dof = haft_memory_alloc(sites, sizeof *layout->dof, error);
    layout->slot = haft_memory_alloc(sites, sizeof *layout->slot, error);
    layout->element_run = haft_memory_alloc(model->elements, sizeof *layout->element_run, error);
    if (!layout->element_run || !layout->stretch || !layout->run || !layout->shape ||
        !layout->area || !layout->top || !layout->share || !layout->dof || !layout->slot) {
        haft_layout_destroy(&layout);
        return HAFT_ERROR_MEMORY;
    }
    *stretches = find_runs(layout, model);
    find_alike(layout, model);
    find_idle_runs(layout, model);
    layout->element_runs = haft_strain_find_runs(model, layout->element_run);
    fill(layout, model);
    *out = layout;
    return HAFT_OK;
}

void haft_layout_destroy(haft_layout **layout) {
    if (layout == NULL || *layout == NULL) {
        return;
    }
    haft_memory_free((*layout)->stretch);
    haft_memory_free((*layout)->run);
    haft_memory_free((*layout)->shape);
    haft_memory_free((*layout)->area);
    haft_memory_free((*layout)->top);
    haft_memory_free((*layout)->share);
    haft_memory_free((*layout)->dof);
    haft_memory_free((*layout)->slot);
    haft_memory_free((*layout)->element_run);
    haft_memory_free(*layout);
    *layout = NULL;
}

/* The unknowns that a run's sites share. */
static inline void read_unknowns(const haft_model *model, const haft_run *run, const double *u,
                                 double v[HAFT_SPAN]) {
    const haft_site *site = &model->site[run->first];
    for (int k = 0; k < HAFT_SPAN; k++) {
        v[k] = k < site->terms ? u[site->dof[k]] : 0;
    }
}

/* w of a run's sites, or their gaps that it leaves of `gap`, in whole lanes: what runs over its end
 * is the next run's to write. */
HAFT_INLINE void displace_shared(const haft_layout *layout, const haft_run *run,
                                 const double v[HAFT_SPAN], const double *gap,
                                 double *restrict out) {
    for (size_t i = 0; i < run->sites; i += LANES) {
        const double *shape = layout->shape + run->alike + i;
        for (size_t k = 0; k < LANES; k++) {
            double w = ((v[0] * shape[k] + v[1] * shape[layout->stride + k]) +
                        v[2] * shape[2 * layout->stride + k]) +
                       v[3] * shape[3 * layout->stride + k];
            out[i + k] = gap != NULL ? *gap - w : w;
        }
    }
}

HAFT_INLINE void displace(const haft_model *model, const haft_stretch *s, const double *u,
                          const double *gap, double *out) {
    const haft_layout *layout = model->layout;
    for (size_t n = 0; n < s->runs; n++) {
        const haft_run *run = &layout->run[s->first_run + n];
        double *to = out + (run->first - s->first);
        const int *dof = layout->dof + run->first;
        if (run->whole) {
            displace_shared(layout, run, u + dof[0], gap, to);
        } else if (run->shared) {
            double v[HAFT_SPAN];
            read_unknowns(model, run, u, v);
            displace_shared(layout, run, v, gap, to);
        } else {
            const double *shape = layout->shape + run->first;
            for (size_t i = 0; i < run->sites; i++) {
                double w = shape[i] * u[dof[i]];
                to[i] = gap != NULL ? *gap - w : w;
            }
        }
    }
    for (size_t k = 0; k < LANES; k++) {
        out[s->sites + k] = gap != NULL ? *gap : 0;
    }
}

HAFT_CLONES void haft_stretch_displacements(const haft_model *model, const haft_stretch *s,
                                            const double *v, double *w) {
    displace(model, s, v, NULL, w);
}

HAFT_CLONES void haft_stretch_gaps(const haft_model *model, const haft_stretch *s, const double *u,
                                   double *d) {
    double gap = model->gap;
    displace(model, s, u, &gap, d);
}

/* How many of a run's sites, from the first on, stay farther than `reach` from the substrate. */
HAFT_CLONES static size_t count_clear(const haft_model *model, const haft_run *run, const double *u,
                                      const double *reach) {
    double v[HAFT_SPAN], w[HAFT_STRETCH_ROOM];
    read_unknowns(model, run, u, v);
    for (size_t first = 0; first < run->sites; first += HAFT_STRETCH) {
        size_t left = run->sites - first, sites = left < HAFT_STRETCH ? left : HAFT_STRETCH;
        haft_run part = {run->first + first, sites, run->alike + first, true, false};
        displace_shared(model->layout, &part, v, NULL, w);
        size_t clear = 0;
        for (size_t i = 0; i < sites; i++) {
            clear += model->gap - w[i] > reach[part.first + i];
        }
        if (clear < sites) {
            size_t r = 0;
            while (model->gap - w[r] > reach[part.first + r]) {
                r++;
            }
            return first + r;
        }
    }
    return run->sites;
}

size_t haft_model_clear_sites(const haft_model *model, const double *u, const double *reach) {
    const haft_layout *layout = model->layout;
    for (size_t n = 0; n < layout->idle; n++) {
        const haft_run *run = &layout->run[layout->runs + n];
        size_t clear = count_clear(model, run, u, reach);
        if (clear < run->sites) {
            return run->first + clear;
        }
    }
    return model->inert;
}

static void scatter_nodes(const haft_layout *layout, const haft_run *run, const double *force,
                          const double *stiffness, double *gradient, double *hessian) {
    const double *shape = layout->shape + run->first;
    const int *dof = layout->dof + run->first, *slot = layout->slot + run->first;
    for (size_t i = 0; i < run->sites && gradient != NULL; i++) {
        gradient[dof[i]] += force[i] * shape[i];
    }
    for (size_t i = 0; i < run->sites && hessian != NULL; i++) {
        hessian[slot[i]] += stiffness[i] * (shape[i] * shape[i]);
    }
}

/* to[4] += q, by halves: neighbouring elements share two unknowns, and a processor reads back at
 * once what it has just written only if that was written in one piece. */
HAFT_INLINE void add_quad(double *to, const quad *q) {
    *(pair *)to += __builtin_shufflevector(*q, *q, 0, 1);
    *(pair *)(to + 2) += __builtin_shufflevector(*q, *q, 2, 3);
}

/* Forces that a run of sites gives its four unknowns. */
HAFT_INLINE void sum_forces(const double *share, size_t sites, const double *force, quad *sum) {
    quad s0 = {0};
    const quad *part = (const quad *)share;
    for (size_t i = 0; i < sites; i++, part += HAFT_COLUMNS) {
        s0 += force[i] * part[0];
    }
    *sum = s0;
}

/* Forces and columns of stiffness that a run of sites gives its four unknowns. */
HAFT_INLINE void sum_shares(const double *share, size_t sites, const double *force,
                            const double *stiffness, quad sum[HAFT_COLUMNS]) {
    quad s0 = {0}, s1 = {0}, s2 = {0}, s3 = {0}, s4 = {0};
    const quad *part = (const quad *)share;
    for (size_t i = 0; i < sites; i++, part += HAFT_COLUMNS) {
        s0 += force[i] * part[0];
        s1 += stiffness[i] * part[1];
        s2 += stiffness[i] * part[2];
        s3 += stiffness[i] * part[3];
        s4 += stiffness[i] * part[4];
    }
    sum[0] = s0, sum[1] = s1, sum[2] = s2, sum[3] = s3, sum[4] = s4;
}

HAFT_INLINE void scatter_whole(const haft_layout *layout, const int *slot, size_t r,
                               const quad sum[HAFT_COLUMNS], double *gradient, double *hessian) {
    if (gradient != NULL) {
        add_quad(gradient + layout->dof[r], &sum[0]);
    }
    for (int j = 0; j < HAFT_SPAN && hessian != NULL; j++) {
        add_quad(hessian + slot[j], &sum[1 + j]); /* from row 0 of column j on */
    }
}

static void scatter_part(const haft_site *site, const int *slot, const quad sum[HAFT_COLUMNS],
                         double *gradient, double *hessian) {
    for (int i = 0; i < site->terms; i++) {
        if (gradient != NULL) {
            gradient[site->dof[i]] += sum[0][i];
        }
        for (int j = 0; j < site->terms && hessian != NULL; j++) {
            hessian[slot[i * HAFT_SPAN + j]] += sum[1 + j][i];
        }
    }
}

HAFT_INLINE bool any(const double *v, size_t n) {
    for (size_t i = 0; i < n; i++) {
        if (v[i] != 0) {
            return true;
        }
    }
    return false;
}

HAFT_CLONES void haft_stretch_assemble(const haft_model *model, const haft_stretch *s,
                                       const double *force, const double *stiffness,
                                       double *gradient, double *hessian) {
    const haft_layout *layout = model->layout;
    for (size_t n = 0; n < s->runs; n++) {
        const haft_run *run = &layout->run[s->first_run + n];
        const double *f = force + (run->first - s->first), *k = stiffness + (run->first - s->first);
        if (!run->shared) {
            scatter_nodes(layout, run, f, k, gradient, hessian);
        } else if (any(f, run->sites) || (hessian != NULL && any(k, run->sites))) {
            quad sum[HAFT_COLUMNS];
            const int *slot = model->site_slot + run->first * ENTRIES;
            const double *share = layout->share + run->alike * HAFT_SHARES;
            if (hessian == NULL) {
                sum_forces(share, run->sites, f, sum);
            } else {
                sum_shares(share, run->sites, f, k, sum);
            }
            if (run->whole) {
                scatter_whole(layout, slot, run->first, sum, gradient, hessian);
            } else {
                scatter_part(&model->site[run->first], slot, sum, gradient, hessian);
            }
        }
    }
}

void haft_model_displacements(const haft_model *model, const double *v, double *w) {
    for (size_t n = 0; n < model->stretches; n++) {
        const haft_stretch *s = &model->layout->stretch[n];
        haft_stretch_displacements(model, s, v, w + s->first);
    }
}

void haft_model_add_forces(const haft_model *model, const double *force, double *y) {
    for (size_t n = 0; n < model->stretches; n++) {
        const haft_stretch *s = &model->layout->stretch[n];
        haft_stretch_assemble(model, s, force + s->first, force + s->first, y, NULL);
    }
}
