/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Displacements, forces and stiffness of many sites at once. Sites of the same element share its
 * four unknowns: their displacements are computed together, and their forces are summed before
 * they are scattered once. On a mesh with a node at each site, a site is one unknown and one
 * entry. */
#include "sites.h"

#include <math.h>
#include <string.h>

enum { ENTRIES = HAFT_SPAN * HAFT_SPAN };

/* Number of sites whose entries fit into the first-level cache besides everything else. */
enum { NEAR_SITES = 32 };

/* The gap [m] that pads the last group of sites: all laws are zero there. */
#define OUT_OF_REACH 1e100

static bool same_unknowns(const haft_site *a, const haft_site *b) {
    return memcmp(a->dof, b->dof, sizeof a->dof) == 0;
}

/* Whether site r continues the run that ends before it. */
static bool continues(const haft_model *model, const haft_run *run, size_t r) {
    const haft_site *site = &model->data.site[r];
    return run->shared ? same_unknowns(&model->data.site[run->first], site) : site->terms == 1;
}

/* @return the number of stretches */
static size_t find_runs(haft_layout *layout, const haft_model *model) {
    size_t stretches = 0;
    for (size_t r = model->data.inert; r < model->data.sites; r++) {
        if ((r - model->data.inert) % HAFT_STRETCH == 0) {
            layout->stretch[stretches++] = (haft_stretch){r, 0, layout->runs, 0};
        }
        haft_stretch *s = &layout->stretch[stretches - 1];
        if (s->runs == 0 || !continues(model, &layout->run[layout->runs - 1], r)) {
            const haft_site *site = &model->data.site[r];
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

/* Whether n sites from b on have the same shapes as those from a on. */
static bool same_shapes(const haft_site *a, const haft_site *b, size_t n) {
    for (size_t i = 0; i < n; i++) {
        if (memcmp(a[i].shape, b[i].shape, sizeof a->shape) != 0) {
            return false;
        }
    }
    return true;
}

/* Makes runs across whole elements use the entries of the first element with the same shapes. */
static void find_alike(haft_layout *layout, const haft_model *model) {
    size_t n = 0;
    while (n < layout->runs && !layout->run[n].whole) {
        n++;
    }
    size_t first = n < layout->runs ? layout->run[n].first : 0, end = first + NEAR_SITES;
    for (; n < layout->runs; n++) {
        haft_run *run = &layout->run[n];
        for (size_t r = first; run->whole && r < end && r < run->first; r++) {
            if (same_shapes(&model->data.site[r], &model->data.site[run->first], run->sites)) {
                run->alike = r;
                break;
            }
        }
    }
}

/* Inert sites that share their unknowns, after the other sites' runs. */
static void find_idle_runs(haft_layout *layout, const haft_model *model) {
    haft_run *run = layout->run + layout->runs;
    for (size_t r = 0; r < model->data.inert; r++) {
        if (r == 0 || !continues(model, &run[layout->idle - 1], r)) {
            run[layout->idle++] = (haft_run){r, 0, r, true, false};
        }
        run[layout->idle - 1].sites++;
    }
}

static void fill(haft_layout *layout, const haft_model *model) {
    for (size_t r = 0; r < model->data.sites; r++) {
        const double *shape = model->data.site[r].shape;
        double *term = layout->term + r * HAFT_SPAN, *share = layout->share + r * ENTRIES;
        layout->area[r] = model->data.site[r].area;
        for (int k = 0; k < model->data.site[r].terms; k++) {
            layout->top[r] = fmax(layout->top[r], fabs(shape[k]));
        }
        layout->dof[r] = model->data.site[r].dof[0];
        layout->slot[r] = r < model->data.inert ? -1 : model->site_slot[r * ENTRIES];
        for (size_t i = 0; i < HAFT_SPAN; i++) {
            layout->shape[i * layout->stride + r] = shape[i];
            term[i] = shape[i];
            for (size_t j = 0; j < HAFT_SPAN; j++) {
                share[j * HAFT_SPAN + i] = shape[i] * shape[j];
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
    size_t sites = model->data.sites;
    layout->stride = haft_simd_padded(sites);
    layout->stretch = haft_memory_alloc(sites / HAFT_STRETCH + 1, sizeof *layout->stretch, error);
    layout->run = haft_memory_alloc(sites, sizeof *layout->run, error);
    layout->shape = haft_memory_alloc(HAFT_SPAN * layout->stride, sizeof(double), error);
    layout->area = haft_memory_alloc(layout->stride, sizeof(double), error);
    layout->top = haft_memory_alloc(layout->stride, sizeof(double), error);
    layout->term = haft_memory_alloc(HAFT_SPAN * sites, sizeof(double), error);
    layout->share = haft_memory_alloc(ENTRIES * sites, sizeof(double), error);
    layout->dof = haft_memory_alloc(sites, sizeof *layout->dof, error);
    layout->slot = haft_memory_alloc(sites, sizeof *layout->slot, error);
    layout->element_run =
        haft_memory_alloc(model->data.elements, sizeof *layout->element_run, error);
    if (!layout->element_run || !layout->stretch || !layout->run || !layout->shape ||
        !layout->area || !layout->top || !layout->term || !layout->share || !layout->dof ||
        !layout->slot) {
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
    haft_memory_free((*layout)->term);
    haft_memory_free((*layout)->share);
    haft_memory_free((*layout)->dof);
    haft_memory_free((*layout)->slot);
    haft_memory_free((*layout)->element_run);
    haft_memory_free(*layout);
    *layout = NULL;
}

/* The unknowns shared by the sites of a run. */
static inline void read_unknowns(const haft_model *model, const haft_run *run, const double *u,
                                 double v[HAFT_SPAN]) {
    const haft_site *site = &model->data.site[run->first];
    for (int k = 0; k < HAFT_SPAN; k++) {
        v[k] = k < site->terms ? u[site->dof[k]] : 0;
    }
}

/* Displacements w of a run's sites, or the gaps `gap` - w. The last group may write past the
 * run; the next run overwrites that. */
HAFT_INLINE void displace_shared(const haft_layout *layout, const haft_run *run,
                                 const double v[HAFT_SPAN], const double *gap,
                                 double *restrict out) {
    for (size_t i = 0; i < run->sites; i += HAFT_SIMD_WIDTH) {
        const double *shape = layout->shape + run->alike + i;
        for (size_t k = 0; k < HAFT_SIMD_WIDTH; k++) {
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
    size_t sites = haft_stretch_sites(model, s), end = s->first + sites;
    const haft_run *run = &layout->run[s->first_run];
    for (size_t n = 0; n < s->runs && run->first < end; n++, run++) {
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
            for (size_t i = 0; i < run->sites && run->first + i < end; i++) {
                double w = shape[i] * u[dof[i]];
                to[i] = gap != NULL ? *gap - w : w;
            }
        }
    }
    for (size_t k = 0; k < HAFT_SIMD_WIDTH; k++) {
        out[sites + k] = gap != NULL ? OUT_OF_REACH : 0;
    }
}

HAFT_CLONES static void find_displacements(const haft_model *model, const haft_stretch *s,
                                           const double *v, double *w) {
    displace(model, s, v, NULL, w);
}

HAFT_CLONES static void find_gaps(const haft_model *model, const haft_stretch *s, const double *u,
                                  double *d) {
    double gap = model->data.gap;
    displace(model, s, u, &gap, d);
}

void haft_stretch_displacements(const haft_model *model, const haft_stretch *s, const double *v,
                                double *w) {
    find_displacements(model, s, v, w);
}

void haft_stretch_gaps(const haft_model *model, const haft_stretch *s, const double *u, double *d) {
    find_gaps(model, s, u, d);
}

/* The number of leading sites of a run whose gap is larger than their reach. */
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
            clear += model->data.gap - w[i] > reach[part.first + i];
        }
        if (clear < sites) {
            size_t r = 0;
            while (model->data.gap - w[r] > reach[part.first + r]) {
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
    return model->data.inert;
}

static void scatter_nodes(const haft_layout *layout, size_t first, size_t sites,
                          const double *force, const double *stiffness, double *gradient,
                          double *hessian) {
    const double *shape = layout->shape + first;
    const int *dof = layout->dof + first, *slot = layout->slot + first;
    for (size_t i = 0; i < sites && gradient != NULL; i++) {
        gradient[dof[i]] += force[i] * shape[i];
    }
    for (size_t i = 0; i < sites && hessian != NULL; i++) {
        hessian[slot[i]] += stiffness[i] * (shape[i] * shape[i]);
    }
}

/* A run on an element that lacks unknowns: at the clamp, or in a structure that is no beam. */
static void scatter_part(const haft_model *model, const haft_run *run, const double *force,
                         const double *stiffness, double *gradient, double *hessian) {
    const haft_site *site = &model->data.site[run->first];
    const int *slot = model->site_slot + run->first * ENTRIES;
    for (size_t r = 0; r < run->sites; r++) {
        const double *shape = site[r].shape;
        for (int i = 0; i < site->terms; i++) {
            if (gradient != NULL) {
                gradient[site->dof[i]] += force[r] * shape[i];
            }
            for (int j = 0; j < site->terms && hessian != NULL; j++) {
                hessian[slot[i * HAFT_SPAN + j]] += stiffness[r] * (shape[i] * shape[j]);
            }
        }
    }
}

/* Adds the forces of a run of sites on its four unknowns. */
HAFT_INLINE void scatter_forces(const double *term, size_t sites, const double *force, double *to) {
    double sum[HAFT_SPAN] = {0};
    for (size_t i = 0; i < sites; i++, term += HAFT_SPAN) {
#pragma omp simd
        for (size_t k = 0; k < HAFT_SPAN; k++) {
            sum[k] += force[i] * term[k];
        }
    }
    for (size_t k = 0; k < HAFT_SPAN; k++) {
        to[k] += sum[k];
    }
}

/* Adds the stiffness of a run of sites, column by column, each from its first row on. */
HAFT_INLINE void scatter_stiffness(const double *share, size_t sites, const double *stiffness,
                                   const int *slot, double *hessian) {
    double sum[ENTRIES] = {0};
    for (size_t i = 0; i < sites; i++, share += ENTRIES) {
#pragma omp simd
        for (size_t k = 0; k < ENTRIES; k++) {
            sum[k] += stiffness[i] * share[k];
        }
    }
    for (size_t j = 0; j < HAFT_SPAN; j++) {
        double *column = hessian + slot[j];
        for (size_t i = 0; i < HAFT_SPAN; i++) {
            column[i] += sum[j * HAFT_SPAN + i];
        }
    }
}

HAFT_CLONES static void assemble(const haft_model *model, const haft_stretch *s, size_t zeros,
                                 const double *force, const double *stiffness, double *gradient,
                                 double *hessian) {
    const haft_layout *layout = model->layout;
    size_t start = s->first + zeros, end = s->first + haft_stretch_sites(model, s);
    const haft_run *run = &layout->run[s->first_run];
    for (size_t n = 0; n < s->runs && run->first < end; n++, run++) {
        size_t first = run->first, past = first + run->sites;
        if (past <= start) {
            continue;
        }
        const double *f = force + (first - s->first), *k = stiffness + (first - s->first);
        if (run->whole) {
            const double *term = layout->term + run->alike * HAFT_SPAN;
            if (gradient != NULL) {
                scatter_forces(term, run->sites, f, gradient + layout->dof[first]);
            }
            if (hessian != NULL) {
                scatter_stiffness(layout->share + run->alike * ENTRIES, run->sites, k,
                                  model->site_slot + first * ENTRIES, hessian);
            }
        } else if (run->shared) {
            scatter_part(model, run, f, k, gradient, hessian);
        } else {
            size_t skipped = first < start ? start - first : 0;
            past = past < end ? past : end;
            scatter_nodes(layout, first + skipped, past - first - skipped, f + skipped, k + skipped,
                          gradient, hessian);
        }
    }
}

void haft_stretch_assemble(const haft_model *model, const haft_stretch *s, size_t zeros,
                           const double *force, const double *stiffness, double *gradient,
                           double *hessian) {
    assemble(model, s, zeros, force, stiffness, gradient, hessian);
}

void haft_model_displacements(const haft_model *model, const double *v, double *w) {
    for (size_t n = 0; n < model->stretches; n++) {
        const haft_stretch *s = &model->layout->stretch[n];
        double own[HAFT_STRETCH_ROOM];
        haft_stretch_displacements(model, s, v, own);
        memcpy(w + s->first, own, haft_stretch_sites(model, s) * sizeof *w);
    }
}

void haft_model_add_forces(const haft_model *model, const double *force, double *y) {
    for (size_t n = 0; n < model->stretches; n++) {
        const haft_stretch *s = &model->layout->stretch[n];
        haft_stretch_assemble(model, s, 0, force + s->first, force + s->first, y, NULL);
    }
}
