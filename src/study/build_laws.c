/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The laws of all realizations at once, or of a model's patches: blocks of surface are independent
 * of each other, so they are dealt out to threads; each writes its own patches' rows, and nothing
 * depends on who did which. All is in memory until all is done. */
#include "builder.h"

#include <omp.h>

/* What the whole build shares. */
typedef struct build {
    const haft_builder *builder;
    size_t sets, blocks; /* blocks a set */
    haft_laws *laws;
    int hands;
    haft_builder_hand **hand;
    const haft_progress *progress;
    size_t done;
} build;

static haft_status do_task(const build *b, haft_builder_hand *hand, size_t task,
                           haft_error *error) {
    size_t set = task / b->blocks, block = b->builder->first_block + task % b->blocks;
    return haft_builder_block(b->builder, hand, set, block, b->laws, set * b->laws->sites, error);
}

static bool stopped(const haft_progress *progress) {
    return progress != NULL && progress->stop != NULL && progress->stop(progress->user);
}

/* Deals out the blocks; the first failure by task number is the one told. */
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
        status = haft_builder_hand_create(&b->hand[i], b->builder, error);
    }
    if (status == HAFT_OK) {
        status = do_all_blocks(b, error);
    }
    for (int i = 0; i < b->hands; i++) {
        haft_builder_hand_destroy(&b->hand[i]);
    }
    haft_memory_free(b->hand);
    return status;
}

/* Drops the curves that are not to be kept. */
static haft_status drop_curves(haft_laws **laws, const haft_case *c, haft_error *error) {
    size_t sets = (*laws)->m / (*laws)->sites;
    haft_laws *all = *laws;
    haft_laws **set = haft_memory_alloc(sets, sizeof(haft_laws *), error);
    haft_status status = set == NULL ? HAFT_ERROR_MEMORY : HAFT_OK;
    for (size_t k = 0; k < sets && status == HAFT_OK; k++) {
        status = haft_study_take_laws(&set[k], c, all, k, k, error);
    }
    haft_laws_destroy(laws);
    if (status == HAFT_OK) {
        status = haft_laws_join(laws, set, sets, error);
    }
    for (size_t k = 0; set != NULL && k < sets; k++) {
        haft_laws_destroy(&set[k]);
    }
    haft_memory_free(set);
    return status;
}

haft_status haft_study_build_laws(haft_laws **out, const haft_case *c,
                                  const haft_progress *progress, haft_error *error) {
    *out = NULL;
    haft_builder *builder = NULL;
    bool stochastic = haft_sampler_is_stochastic(c->law.sampler);
    build b = {.sets = stochastic ? 1 : c->realizations, .progress = progress};
    haft_status status = haft_builder_create(&builder, c, error);
    if (status == HAFT_OK) {
        b.builder = builder;
        b.blocks = builder->end_block - builder->first_block;
        status = haft_builder_room(&b.laws, builder, b.sets, error);
    }
    if (status == HAFT_OK) {
        status = run_build(&b, error);
    }
    if (status == HAFT_OK && c->curves != HAFT_CURVES_ALL) {
        status = drop_curves(&b.laws, c, error);
    }
    if (status == HAFT_OK && stochastic && !haft_study_draws_patches(c)) {
        status = haft_study_build_chaos(b.laws, c, error);
    }
    haft_builder_destroy(&builder);
    if (status != HAFT_OK) {
        haft_laws_destroy(&b.laws);
    }
    *out = b.laws;
    return status;
}
