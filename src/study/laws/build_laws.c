/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds the laws of all realizations, or of a model's patches, of one case or of several with
 * the same surfaces. Blocks of surface are independent and are shared out among threads; each
 * thread writes the rows of its own patches, so the result does not depend on the number of
 * threads. Everything stays in memory until all is done. */
#include "builder.h"

#include <omp.h>

/* Data shared by the whole build. */
typedef struct build {
    size_t cases;
    haft_builder **builder; /* one per case; the first has the surfaces */
    haft_laws **laws;
    size_t sets, blocks; /* blocks a set */
    int hands;
    haft_builder_hand **hand;
    const haft_progress *progress;
    size_t done;
} build;

static haft_status do_task(const build *b, haft_builder_hand *hand, size_t task,
                           haft_error *error) {
    size_t set = task / b->blocks, block = b->builder[0]->first_block + task % b->blocks;
    return haft_builder_block((const haft_builder *const *)b->builder, hand, set, block, b->laws,
                              set * b->laws[0]->sites, error);
}

static bool stopped(const haft_progress *progress) {
    return progress != NULL && progress->stop != NULL && progress->stop(progress->user);
}

/* Computes the blocks in parallel. The failure with the lowest task number is reported. */
static haft_status do_all_blocks(build *b, haft_error *error) {
    long tasks = (long)(b->sets * b->blocks), failed_task = tasks;
    haft_status result = HAFT_OK;
    bool halt = false;
#pragma omp parallel for schedule(dynamic) num_threads(b->hands)
    for (long task = 0; task < tasks; task++) {
        bool skip;
#pragma omp atomic read
        skip = halt;
        if (skip) {
            continue;
        }
        haft_error own = {0};
        haft_status status = do_task(b, b->hand[omp_get_thread_num()], (size_t)task, &own);
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
    size_t tasks = b->sets * b->blocks;
    int threads = omp_get_max_threads();
    b->hands = (size_t)threads < tasks ? threads : (int)tasks;
    b->hand = haft_memory_alloc((size_t)b->hands, sizeof(haft_builder_hand *), error);
    if (b->hand == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    haft_status status = HAFT_OK;
    for (int i = 0; i < b->hands && status == HAFT_OK; i++) {
        status = haft_builder_hand_create(&b->hand[i], (const haft_builder *const *)b->builder,
                                          b->cases, error);
    }
    HAFT_THEN(status, do_all_blocks(b, error));
    for (int i = 0; i < b->hands; i++) {
        haft_builder_hand_destroy(&b->hand[i]);
    }
    haft_memory_free(b->hand);
    return status;
}

/* Drops curves that the case does not keep. */
static haft_status drop_curves(haft_laws **laws, const haft_case *c, haft_error *error) {
    size_t sets = (*laws)->m / (*laws)->sites;
    haft_laws *all = *laws;
    haft_laws **set = haft_memory_alloc(sets, sizeof(haft_laws *), error);
    haft_status status = set == NULL ? HAFT_ERROR_MEMORY : HAFT_OK;
    for (size_t k = 0; k < sets && status == HAFT_OK; k++) {
        status = haft_study_take_laws(&set[k], c, all, k, k, error);
    }
    haft_laws_destroy(laws);
    HAFT_THEN(status, haft_laws_join(laws, set, sets, error));
    for (size_t k = 0; set != NULL && k < sets; k++) {
        haft_laws_destroy(&set[k]);
    }
    haft_memory_free(set);
    return status;
}

/* Makes builders and room for all cases. All have the blocks of the first. */
static haft_status prepare(build *b, const haft_case *const *c, haft_error *error) {
    b->builder = haft_memory_alloc(b->cases, sizeof *b->builder, error);
    haft_status status = b->builder == NULL ? HAFT_ERROR_MEMORY : HAFT_OK;
    for (size_t i = 0; i < b->cases && status == HAFT_OK; i++) {
        status = haft_builder_create(&b->builder[i], c[i], i > 0 ? b->builder[0] : NULL, error);
        HAFT_THEN(status, haft_builder_room(&b->laws[i], b->builder[i], b->sets, error));
    }
    if (status == HAFT_OK) {
        b->blocks = b->builder[0]->end_block - b->builder[0]->first_block;
    }
    return status;
}

/* Computes the curves of all cases from the surfaces; after a failure all are NULL. */
static haft_status read_off(haft_laws **out, const haft_case *const *c, size_t cases, size_t sets,
                            const haft_progress *progress, haft_error *error) {
    build b = {.cases = cases, .laws = out, .sets = sets, .progress = progress};
    haft_status status = prepare(&b, c, error);
    HAFT_THEN(status, run_build(&b, error));
    for (size_t i = 0; i < cases; i++) {
        if (b.builder != NULL) {
            haft_builder_destroy(&b.builder[i]);
        }
        if (status != HAFT_OK) {
            haft_laws_destroy(&out[i]);
        }
    }
    haft_memory_free(b.builder);
    return status;
}

/* Keeps the curves that the case asks for, and builds its model if it has one; after a failure
 * NULL. */
static haft_status finish(haft_laws **laws, const haft_case *c, haft_error *error) {
    haft_status status = HAFT_OK;
    bool stochastic = haft_sampler_is_stochastic(c->law.sampler);
    if (c->curves != HAFT_CURVES_ALL) {
        status = drop_curves(laws, c, error);
    }
    if (status == HAFT_OK && stochastic && !haft_study_draws_patches(c)) {
        status = haft_study_build_chaos(*laws, c, error);
    }
    if (status != HAFT_OK) {
        haft_laws_destroy(laws);
    }
    return status;
}

haft_status haft_study_build_laws(haft_laws **out, const haft_case *c,
                                  const haft_progress *progress, haft_error *error) {
    *out = NULL;
    size_t sets = haft_sampler_is_stochastic(c->law.sampler) ? 1 : c->realizations;
    haft_status status = read_off(out, &c, 1, sets, progress, error);
    return status == HAFT_OK ? finish(out, c, error) : status;
}

haft_status haft_study_build_laws_together(haft_laws **out, const haft_case *const *c, size_t n,
                                           const haft_progress *progress, haft_error *error) {
    for (size_t i = 0; i < n; i++) {
        out[i] = NULL;
    }
    haft_status status = read_off(out, c, n, 1, progress, error);
    for (size_t i = 0; i < n && status == HAFT_OK; i++) {
        haft_error own = {0};
        (void)!finish(&out[i], c[i], &own);
    }
    return status;
}
