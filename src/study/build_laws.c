/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From surfaces to laws: blocks of surface are independent of each other, so they are dealt out to
 * threads; each writes its own patches' rows, and nothing depends on who did which. */
#include "haft/study.h"

#include <math.h>
#include <omp.h>
#include <string.h>

/* Length of a seamless block: long against the kernel's halo, short against memory. */
#define BLOCK_LENGTH 12e-6

double haft_study_film(const haft_case *c) {
    haft_adsorption silica = haft_adsorption_silica();
    const haft_adsorption *film =
        c->contact.adsorbed == HAFT_ADSORBED_TABLE ? &c->contact.film : &silica;
    bool any = c->contact.has_capillary && c->contact.adsorbed != HAFT_ADSORBED_NONE;
    return any ? haft_adsorption_thickness(film, c->contact.capillary.humidity) : 0;
}

haft_status haft_study_contact_spec(haft_contact_spec *out, const haft_case *c, haft_error *error) {
    double e = c->contact.young_modulus, nu = c->contact.poisson_ratio;
    *out = (haft_contact_spec){.asperities = c->contact.asperities,
                               .modulus = haft_contact_modulus(e, nu, e, nu),
                               .has_capillary = c->contact.has_capillary};
    if (!c->contact.has_capillary) {
        return HAFT_OK;
    }
    haft_capillary capillary;
    haft_status status = haft_capillary_from_spec(&capillary, &c->contact.capillary, error);
    out->pressure = capillary.pressure;
    out->capillary_range = capillary.range + 2 * haft_study_film(c);
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

size_t haft_study_sites(const haft_case *c) {
    return (size_t)llround(c->beam.length / c->mesh.l_meso);
}

/* A set of patches for each realization, or one for the model. */
static size_t sets_of(const haft_case *c) {
    return haft_sampler_is_stochastic(c->law.sampler) ? 1 : c->realizations;
}

static size_t patches_of_set(const haft_case *c) {
    return haft_sampler_is_stochastic(c->law.sampler) ? c->law.chaos.vectors : haft_study_sites(c);
}

size_t haft_study_law_count(const haft_case *c) {
    return sets_of(c) * patches_of_set(c);
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

/* What the whole build shares, read only but for the rows of `laws`. */
typedef struct build {
    const haft_case *c;
    haft_contact_spec contact;
    haft_surface_plan *plan;
    haft_tiling *tiling; /* instead of the plan */
    haft_laws *laws;
    size_t block_patches, blocks; /* blocks a realization */
    const haft_progress *progress;
    size_t done;
} build;

/* One thread's scratch. */
typedef struct worker {
    haft_surface_work *surface;
    haft_contact_work *contact;
    double *z, *contact_area, *wet_area, *asperities;
} worker;

static void destroy_worker(worker *w) {
    haft_surface_work_destroy(&w->surface);
    haft_contact_work_destroy(&w->contact);
    haft_memory_free(w->z);
    haft_memory_free(w->contact_area);
    haft_memory_free(w->wet_area);
    haft_memory_free(w->asperities);
}

static haft_status create_worker(worker *w, const build *b, haft_error *error) {
    size_t rows = rows_of(b->c), columns = columns_of(b->c), n = b->laws->n;
    haft_status status = HAFT_OK;
    if (b->plan != NULL) {
        status = haft_surface_work_create(&w->surface, b->plan, error);
    }
    if (status == HAFT_OK) {
        status = haft_contact_work_create(&w->contact, rows, columns, error);
    }
    if (status != HAFT_OK) {
        return status;
    }
    w->z = haft_memory_alloc(rows * columns, sizeof(double), error);
    w->contact_area = haft_memory_alloc(n, sizeof(double), error);
    w->wet_area = haft_memory_alloc(n, sizeof(double), error);
    w->asperities = haft_memory_alloc(n, sizeof(double), error);
    bool all = w->z && w->contact_area && w->wet_area && w->asperities;
    return all ? HAFT_OK : HAFT_ERROR_MEMORY;
}

/* Curve, vector and zero-force facts of the patch in w->z, into row k. */
static haft_status enter_patch(const build *b, worker *w, size_t k, haft_error *error) {
    haft_laws *laws = b->laws;
    haft_curve curve = {.n = laws->n,
                        .distance = laws->distance,
                        .force = laws->force + k * laws->n,
                        .contact_area = w->contact_area,
                        .wet_area = w->wet_area,
                        .asperities = w->asperities};
    haft_status status =
        haft_contact_curve(w->contact, &b->contact, w->z, rows_of(b->c), columns_of(b->c),
                           b->c->surface.grid_step, &curve, error);
    if (status != HAFT_OK) {
        return status;
    }
    haft_law law;
    haft_law_fault fault = haft_law_characterise(laws->n, laws->distance, curve.force,
                                                 laws->f_limit, &laws->vector[k]);
    if (fault == HAFT_LAW_SOUND) {
        fault = haft_law_morse(&law, &laws->vector[k], laws->f_limit);
    } else {
        laws->vector[k] = (haft_law_vector){NAN, NAN, NAN, NAN};
    }
    laws->fault[k] = fault;
    haft_zero_force zero = haft_contact_zero_force(&curve);
    laws->zero_distance[k] = zero.found ? zero.distance : NAN;
    laws->contact_area[k] = zero.found ? zero.contact_area : NAN;
    laws->wet_area[k] = zero.found ? zero.wet_area : NAN;
    laws->asperities[k] = zero.found ? zero.asperities * b->c->mesh.l_meso * b->c->beam.width : NAN;
    return HAFT_OK;
}

static haft_status do_block(const build *b, worker *w, size_t task, haft_error *error) {
    const haft_case *c = b->c;
    size_t realization = task / b->blocks, block = task % b->blocks;
    size_t rows = rows_of(c), first = block * b->block_patches;
    bool whole = c->law.sampler == HAFT_SAMPLER_EXPLICIT;
    if (b->tiling != NULL) {
        haft_tiling_fill(b->tiling, realization, block, w->z);
        return enter_patch(b, w, realization * b->laws->sites + first, error);
    }
    haft_status status = haft_surface_prepare(w->surface, realization, whole ? 0 : block,
                                              whole ? (long)(first * rows) : 0, error);
    for (size_t p = 0; p < b->block_patches && first + p < b->laws->sites; p++) {
        if (status == HAFT_OK) {
            status = haft_surface_rows(w->surface, p * rows, rows, w->z, error);
        }
        if (status == HAFT_OK) {
            status = enter_patch(b, w, realization * b->laws->sites + first + p, error);
        }
    }
    return status;
}

static bool stopped(const haft_progress *progress) {
    return progress != NULL && progress->stop != NULL && progress->stop(progress->user);
}

/* Deals out the blocks; the first failure by task number is the one told. */
static haft_status do_all_blocks(build *b, worker *workers, int threads, haft_error *error) {
    long tasks = (long)(sets_of(b->c) * b->blocks), failed_task = tasks;
    haft_status result = HAFT_OK;
    bool halt = false;
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (long task = 0; task < tasks; task++) {
        bool skip;
#pragma omp atomic read
        skip = halt;
        if (skip) {
            continue;
        }
        haft_error own = {0};
        haft_status status = do_block(b, &workers[omp_get_thread_num()], (size_t)task, &own);
#pragma omp critical
        {
            bool early = false;
            if (status != HAFT_OK && task < failed_task) {
                failed_task = task;
                result = status;
                haft_error_set(error, status, "%s", own.message);
            }
            b->done++;
            if (b->progress != NULL && b->progress->advance != NULL) {
                b->progress->advance(b->progress->user, "laws", b->done, (size_t)tasks);
            }
            if (status == HAFT_OK && b->done < (size_t)tasks && stopped(b->progress)) {
                early = true;
            }
            if (early && result == HAFT_OK) {
                result = haft_error_set(error, HAFT_ERROR_INTERRUPTED,
                                        "stopped while the laws were being built; nothing kept");
            }
            if (result != HAFT_OK) {
#pragma omp atomic write
                halt = true;
            }
        }
    }
    return result;
}

static haft_status run_build(build *b, haft_error *error) {
    size_t tasks = sets_of(b->c) * b->blocks;
    int threads = omp_get_max_threads();
    threads = (size_t)threads < tasks ? threads : (int)tasks;
    worker *workers = haft_memory_alloc((size_t)threads, sizeof *workers, error);
    if (workers == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    haft_status status = HAFT_OK;
    for (int i = 0; i < threads && status == HAFT_OK; i++) {
        status = create_worker(&workers[i], b, error);
    }
    if (status == HAFT_OK) {
        status = do_all_blocks(b, workers, threads, error);
    }
    for (int i = 0; i < threads; i++) {
        destroy_worker(&workers[i]);
    }
    haft_memory_free(workers);
    return status;
}

haft_status haft_study_build_laws(haft_laws **out, const haft_case *c,
                                  const haft_progress *progress, haft_error *error) {
    *out = NULL;
    build b = {.c = c, .block_patches = haft_study_block_patches(c), .progress = progress};
    haft_status status = haft_study_contact_spec(&b.contact, c, error);
    if (status != HAFT_OK) {
        return status;
    }
    double span = c->contact.distance_to - c->contact.distance_from;
    size_t n = (size_t)llround(span / c->contact.distance_step) + 1;
    status = haft_laws_create(&b.laws, haft_study_law_count(c), n, error);
    if (status == HAFT_OK) {
        b.laws->sites = patches_of_set(c);
        b.laws->f_limit = c->law.f_limit;
        b.blocks = (b.laws->sites + b.block_patches - 1) / b.block_patches;
        for (size_t i = 0; i < n; i++) {
            b.laws->distance[i] = c->contact.distance_from + span * (double)i / (double)(n - 1);
        }
        status = haft_study_tiling(&b.tiling, c, error);
    }
    if (status == HAFT_OK && b.tiling == NULL) {
        status = haft_study_surface_plan(&b.plan, c, b.block_patches, error);
    }
    if (status == HAFT_OK) {
        status = run_build(&b, error);
    }
    if (status == HAFT_OK && haft_sampler_is_stochastic(c->law.sampler)) {
        status = haft_study_build_chaos(b.laws, c, error);
    }
    haft_surface_plan_destroy(&b.plan);
    haft_tiling_destroy(&b.tiling);
    if (status != HAFT_OK) {
        haft_laws_destroy(&b.laws);
    }
    *out = b.laws;
    return status;
}
