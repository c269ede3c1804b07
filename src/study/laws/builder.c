/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From surfaces to laws, block by block of surface: a block alone has the same bits as among
 * others, so that any realization can be had alone, and of a beam the blocks that come into range.
 */
#include "builder.h"

#include <math.h>

/* Length of a seamless block: long against the kernel's halo, short against memory. */
#define BLOCK_LENGTH 12e-6

haft_status haft_study_contact_spec(haft_contact_spec *out, const haft_case *c, haft_error *error) {
    double e = c->contact.young_modulus, nu = c->contact.poisson_ratio;
    haft_physics physics = haft_case_physics(c);
    *out = (haft_contact_spec){.asperities = c->contact.asperities,
                               .modulus = haft_contact_modulus(e, nu, e, nu),
                               .has_capillary = physics.capillary,
                               .has_vdw = physics.vdw,
                               .path = c->contact.vdw.path};
    haft_status status = HAFT_OK;
    if (physics.capillary) {
        haft_capillary capillary = {0};
        status = haft_capillary_from_spec(&capillary, &c->contact.capillary, error);
        out->pressure = capillary.pressure;
        out->capillary_range = capillary.range + 2 * haft_case_film(c);
    }
    if (physics.vdw && status == HAFT_OK) {
        status = haft_case_vdw(&out->vdw, c, error);
    }
    return status;
}

size_t haft_study_block_patches(const haft_case *c) {
    if (c->law.sampler != HAFT_SAMPLER_EXPLICIT) {
        return 1;
    }
    double patches = floor(BLOCK_LENGTH / c->mesh.l_meso * (1 + 1e-9));
    return patches < 1 ? 1 : (size_t)patches;
}

static size_t rows_of(const haft_case *c) {
    return (size_t)llround(c->mesh.l_meso / c->surface.grid_step);
}

static size_t columns_of(const haft_case *c) {
    return (size_t)llround(c->beam.width / c->surface.grid_step);
}

size_t haft_study_law_count(const haft_case *c) {
    return haft_sampler_is_stochastic(c->law.sampler)
               ? c->law.chaos.vectors
               : c->realizations * (haft_study_sites(c) - haft_study_first_site(c));
}

haft_status haft_study_surface_plan(haft_surface_plan **out, const haft_case *c, size_t patches,
                                    haft_error *error) {
    bool whole = c->law.sampler == HAFT_SAMPLER_EXPLICIT;
    haft_surface_spec spec = {
        .psd = c->surface.psd,
        .table = c->surface.table,
        .marginal = c->surface.distribution,
        .grid_step = c->surface.grid_step,
        .rows = patches * rows_of(c),
        .columns = columns_of(c),
        .tolerance = c->surface.kernel_tolerance,
        .key = {c->seed, whole ? HAFT_RANDOM_BEAM_SURFACE : HAFT_RANDOM_PATCH_SURFACE},
    };
    return haft_surface_plan_create(out, &spec, error);
}

haft_status haft_study_tiling(haft_tiling **out, const haft_case *c, haft_error *error) {
    *out = NULL;
    if (c->surface.source != HAFT_SOURCE_MAPS) {
        return HAFT_OK;
    }
    const haft_map *maps[HAFT_FILES_MAX], *opposite[HAFT_FILES_MAX];
    for (size_t k = 0; k < HAFT_FILES_MAX; k++) {
        maps[k] = c->surface.map.map[k];
        opposite[k] = c->surface.opposite.map[k];
    }
    haft_tiling_spec spec = {.n = c->surface.map.count,
                             .maps = maps,
                             .opposite_n = c->surface.opposite.count,
                             .opposite = opposite,
                             .grid_step = c->surface.grid_step,
                             .rows = rows_of(c),
                             .columns = columns_of(c),
                             .seed = c->seed};
    return haft_tiling_create(out, &spec, error);
}

/* One thread's scratch. */
struct haft_builder_hand {
    haft_surface_work *surface;
    haft_contact_work *contact;
    double *z;
    size_t builders, distances; /* of any */
    haft_contact_spec *spec;    /* builders */
    haft_curve *curve;          /* builders */
    double *areas;              /* builders x 3 x distances: what curves tell beside their force */
};

void haft_builder_hand_destroy(haft_builder_hand **hand) {
    if (hand == NULL || *hand == NULL) {
        return;
    }
    haft_builder_hand *w = *hand;
    haft_surface_work_destroy(&w->surface);
    haft_contact_work_destroy(&w->contact);
    haft_memory_free(w->z);
    haft_memory_free(w->spec);
    haft_memory_free(w->curve);
    haft_memory_free(w->areas);
    haft_memory_free(w);
    *hand = NULL;
}

static haft_status fill_hand(haft_builder_hand *w, const haft_builder *const *builder, size_t n,
                             haft_error *error) {
    const haft_builder *b = builder[0];
    size_t rows = rows_of(b->c), columns = columns_of(b->c), distances = 0;
    for (size_t i = 0; i < n; i++) {
        distances = builder[i]->n > distances ? builder[i]->n : distances;
    }
    haft_status status = HAFT_OK;
    if (b->plan != NULL) {
        status = haft_surface_work_create(&w->surface, b->plan, error);
    }
    HAFT_THEN(status, haft_contact_work_create(&w->contact, rows, columns, error));
    if (status != HAFT_OK) {
        return status;
    }
    w->builders = n;
    w->distances = distances;
    w->z = haft_memory_alloc(rows * columns, sizeof(double), error);
    w->spec = haft_memory_alloc(n, sizeof *w->spec, error);
    w->curve = haft_memory_alloc(n, sizeof *w->curve, error);
    w->areas = haft_memory_alloc(n * distances, 3 * sizeof(double), error);
    return w->z && w->spec && w->curve && w->areas ? HAFT_OK : HAFT_ERROR_MEMORY;
}

haft_status haft_builder_hand_create(haft_builder_hand **out, const haft_builder *const *b,
                                     size_t n, haft_error *error) {
    *out = haft_memory_alloc(1, sizeof **out, error);
    haft_status status = *out == NULL ? HAFT_ERROR_MEMORY : fill_hand(*out, b, n, error);
    if (status != HAFT_OK) {
        haft_builder_hand_destroy(out);
    }
    return status;
}

void haft_builder_destroy(haft_builder **builder) {
    if (builder != NULL && *builder != NULL) {
        haft_surface_plan_destroy(&(*builder)->plan);
        haft_tiling_destroy(&(*builder)->tiling);
        haft_maugis_table_destroy(&(*builder)->maugis);
        haft_memory_free(*builder);
        *builder = NULL;
    }
}

/* Where the patches come from: windows of maps, or a plan for surfaces. */
static haft_status make_surfaces(haft_builder *b, haft_error *error) {
    haft_status status = haft_study_tiling(&b->tiling, b->c, error);
    if (status == HAFT_OK && b->tiling == NULL) {
        status = haft_study_surface_plan(&b->plan, b->c, b->block_patches, error);
    }
    return status;
}

haft_status haft_builder_create(haft_builder **out, const haft_case *c,
                                const haft_builder *surfaces, haft_error *error) {
    *out = NULL;
    haft_builder *b = haft_memory_alloc(1, sizeof *b, error);
    if (b == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    bool stochastic = haft_sampler_is_stochastic(c->law.sampler);
    double span = c->contact.distance_to - c->contact.distance_from;
    *b = (haft_builder){.c = c,
                        .n = (size_t)llround(span / c->contact.distance_step) + 1,
                        .first_site = haft_study_first_site(c),
                        .end_site = stochastic ? c->law.chaos.vectors : haft_study_sites(c),
                        .block_patches = haft_study_block_patches(c)};
    b->first_block = b->first_site / b->block_patches;
    b->end_block = (b->end_site + b->block_patches - 1) / b->block_patches;
    haft_status status = haft_study_contact_spec(&b->contact, c, error);
    if (status == HAFT_OK && surfaces == NULL) {
        status = make_surfaces(b, error);
    }
    if (status == HAFT_OK && b->contact.has_vdw) {
        status = haft_maugis_table_create(&b->maugis, error);
        b->contact.maugis = b->maugis;
    }
    if (status != HAFT_OK) {
        haft_builder_destroy(&b);
    }
    *out = b;
    return status;
}

haft_status haft_builder_room(haft_laws **out, const haft_builder *b, size_t sets,
                              haft_error *error) {
    const haft_case *c = b->c;
    size_t sites = b->end_site - b->first_site, m = 0;
    if (__builtin_mul_overflow(sets, sites, &m)) {
        return haft_error_set(error, HAFT_ERROR_MEMORY, "%zu beams of %zu laws overflow", sets,
                              sites);
    }
    haft_status status = haft_laws_create(out, m, b->n, error);
    if (status == HAFT_OK) {
        haft_laws *laws = *out;
        double span = c->contact.distance_to - c->contact.distance_from;
        laws->sites = sites;
        laws->first_site = b->first_site;
        laws->f_limit = haft_case_limit(c);
        for (size_t i = 0; i < b->n; i++) {
            laws->distance[i] = c->contact.distance_from + span * (double)i / (double)(b->n - 1);
        }
    }
    return status;
}

/* Vector and zero-force facts of a curve, into row k. */
static void enter_curve(const haft_case *c, const haft_curve *curve, haft_laws *laws, size_t k) {
    haft_law_fault fault = haft_law_characterise(laws->n, laws->distance, curve->force,
                                                 laws->f_limit, &laws->vector[k]);
    if (fault == HAFT_LAW_SOUND) {
        fault = haft_law_vector_fault(&laws->vector[k], laws->f_limit);
    } else {
        laws->vector[k] = (haft_law_vector){NAN, NAN, NAN, NAN};
    }
    laws->fault[k] = fault;
    haft_zero_force zero = haft_contact_zero_force(curve);
    laws->zero_distance[k] = zero.found ? zero.distance : NAN;
    laws->contact_area[k] = zero.found ? zero.contact_area : NAN;
    laws->wet_area[k] = zero.found ? zero.wet_area : NAN;
    laws->asperities[k] = zero.found ? zero.asperities * c->mesh.l_meso * c->beam.width : NAN;
}

/* Laws of the patch in w->z by all the hand's builders, into row k. */
static haft_status enter_patch(const haft_builder *const *b, haft_builder_hand *w,
                               haft_laws *const *laws, size_t k, haft_error *error) {
    const haft_case *c = b[0]->c;
    for (size_t i = 0; i < w->builders; i++) {
        double *areas = w->areas + 3 * i * w->distances;
        w->spec[i] = b[i]->contact;
        w->curve[i] = (haft_curve){.n = laws[i]->n,
                                   .distance = laws[i]->distance,
                                   .force = laws[i]->force + k * laws[i]->n,
                                   .contact_area = areas,
                                   .wet_area = areas + w->distances,
                                   .asperities = areas + 2 * w->distances};
    }
    haft_status status = haft_contact_curves(w->contact, w->builders, w->spec, w->z, rows_of(c),
                                             columns_of(c), c->surface.grid_step, w->curve, error);
    for (size_t i = 0; i < w->builders && status == HAFT_OK; i++) {
        enter_curve(b[i]->c, &w->curve[i], laws[i], k);
    }
    return status;
}

haft_status haft_builder_block(const haft_builder *const *all, haft_builder_hand *w,
                               size_t realization, size_t block, haft_laws *const *laws, size_t row,
                               haft_error *error) {
    const haft_builder *b = all[0];
    size_t rows = rows_of(b->c), start = block * b->block_patches;
    size_t first = start < b->first_site ? b->first_site : start;
    size_t end = start + b->block_patches < b->end_site ? start + b->block_patches : b->end_site;
    bool whole = b->c->law.sampler == HAFT_SAMPLER_EXPLICIT;
    if (b->tiling != NULL) {
        haft_tiling_fill(b->tiling, realization, block, w->z);
        return enter_patch(all, w, laws, row + first - b->first_site, error);
    }
    haft_status status = haft_surface_prepare(w->surface, realization, whole ? 0 : block,
                                              whole ? (long)(start * rows) : 0, error);
    for (size_t r = first; r < end && status == HAFT_OK; r++) {
        status = haft_surface_rows(w->surface, (r - start) * rows, rows, w->z, error);
        HAFT_THEN(status, enter_patch(all, w, laws, row + r - b->first_site, error));
    }
    return status;
}

haft_status haft_builder_realize(haft_laws **out, const haft_builder *b, haft_builder_hand *w,
                                 size_t realization, haft_error *error) {
    haft_laws *all = NULL;
    *out = NULL;
    haft_status status = haft_builder_room(&all, b, 1, error);
    for (size_t k = b->first_block; k < b->end_block && status == HAFT_OK; k++) {
        status = haft_builder_block(&b, w, realization, k, &all, 0, error);
    }
    HAFT_THEN(status, haft_study_take_laws(out, b->c, all, 0, realization, error));
    haft_laws_destroy(&all);
    return status;
}
