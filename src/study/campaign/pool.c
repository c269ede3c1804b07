/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Realizations over threads. One thread computes a realization, first its laws and then its
 * path, and appends both to the part of its process before it tells the scheduler. So every
 * realization that counts as done is on disk, and a killed run loses only those in progress. */
#include "pool.h"

static haft_status keep(haft_pool *pool, size_t k, const haft_path *path,
                        const haft_summary *summary, const haft_laws *laws, haft_error *error) {
    haft_status status = HAFT_OK;
    omp_set_lock(&pool->lock);
    if (pool->part == NULL) {
        status = haft_part_create(&pool->part, pool->folder, pool->shard.index, pool->shard.count,
                                  pool->rank, pool->c, pool->laws_digest, error);
    }
    HAFT_THEN(status, haft_part_append(pool->part, k, path, haft_model_get(pool->model)->dofs,
                                       summary, laws, error));
    omp_unset_lock(&pool->lock);
    return status;
}

/* The realization's own laws, read or built now; NULL if laws are drawn. */
static haft_status own_laws(haft_laws **out, const haft_pool *pool, size_t hand, size_t k,
                            haft_error *error) {
    *out = NULL;
    if (haft_sampler_is_stochastic(pool->c->law.sampler)) {
        return HAFT_OK;
    }
    if (haft_study_has_laws(pool->c, pool->laws, k)) {
        return haft_study_take_laws(out, pool->c, pool->laws, k, k, error);
    }
    haft_status status = HAFT_OK;
    if (pool->hand[hand] == NULL) {
        status = haft_builder_hand_create(&pool->hand[hand],
                                          (const haft_builder *const[]){pool->builder}, 1, error);
    }
    return status == HAFT_OK ? haft_builder_realize(out, pool->builder, pool->hand[hand], k, error)
                             : status;
}

static haft_status do_one(haft_pool *pool, size_t hand, size_t k, haft_summary *summary,
                          haft_error *error) {
    haft_laws *own = NULL;
    haft_site_laws *laws = NULL;
    haft_path *path = NULL;
    haft_status status = own_laws(&own, pool, hand, k, error);
    HAFT_THEN(status, haft_study_site_laws(&laws, pool->c, own != NULL ? own : pool->laws,
                                           own != NULL ? 0 : k, error));
    HAFT_THEN(status, haft_study_realize(&path, summary, pool->c, pool->model, laws,
                                         haft_case_wants_evidence(pool->c, k), error));
    HAFT_THEN(status, keep(pool, k, path, summary, own, error));
    haft_path_destroy(&path);
    haft_site_laws_destroy(&laws);
    haft_laws_destroy(&own);
    return status;
}

static void work(haft_pool *pool, size_t hand) {
    size_t k = 0;
    while (pool->scheduler != NULL ? haft_scheduler_next(pool->scheduler, &k)
                                   : haft_remote_next(&pool->remote, hand, &k)) {
        haft_summary summary;
        haft_error error = {0};
        haft_status status = do_one(pool, hand, k, &summary, &error);
        if (pool->scheduler != NULL && status == HAFT_OK) {
            haft_scheduler_enter(pool->scheduler, k, &summary);
        } else if (pool->scheduler != NULL) {
            haft_scheduler_fail(pool->scheduler, k, status, error.message);
        } else if (status == HAFT_OK) {
            haft_remote_enter(&pool->remote, hand, k, &summary);
        } else {
            haft_remote_fail(&pool->remote, hand, k, status, error.message);
        }
    }
    if (pool->hand != NULL) {
        haft_builder_hand_destroy(&pool->hand[hand]);
    }
}

haft_status haft_pool_equip(haft_pool *pool, const bool *done, size_t *lacking, haft_error *error) {
    size_t count = 0;
    if (!haft_sampler_is_stochastic(pool->c->law.sampler)) {
        for (size_t k = 0; k < pool->c->realizations; k++) {
            count += haft_shard_has(pool->shard, k) && (done == NULL || !done[k]) &&
                     !haft_study_has_laws(pool->c, pool->laws, k);
        }
    }
    if (lacking != NULL) {
        *lacking = count;
    }
    if (count == 0) {
        return HAFT_OK;
    }
    pool->hand =
        haft_memory_alloc((size_t)omp_get_max_threads() + 1, sizeof(haft_builder_hand *), error);
    return pool->hand == NULL ? HAFT_ERROR_MEMORY
                              : haft_builder_create(&pool->builder, pool->c, NULL, error);
}

void haft_pool_disband(haft_pool *pool) {
    haft_memory_free(pool->hand);
    pool->hand = NULL;
    haft_builder_destroy(&pool->builder);
}

/* With several ranks, thread 0 of each communicates and the others work. */
static void work_together(haft_pool *pool) {
    size_t left = 0;
    int threads = omp_get_max_threads() + 1;
#pragma omp parallel num_threads(threads)
    {
        size_t hands = (size_t)omp_get_num_threads() - 1, own = (size_t)omp_get_thread_num();
        if (own > 0) {
            work(pool, own - 1);
#pragma omp atomic
            left++;
        } else if (pool->scheduler != NULL) {
            haft_remote_serve(pool->scheduler);
        } else {
            haft_remote_speak(&pool->remote, &left, hands);
        }
    }
}

haft_status haft_pool_work(haft_pool *pool, haft_error *error) {
    haft_status status = HAFT_OK;
    if (pool->scheduler == NULL) {
        status = haft_remote_open(&pool->remote, (size_t)omp_get_max_threads(), error);
        if (status != HAFT_OK) {
            return status;
        }
    }
    omp_init_lock(&pool->lock);
    if (haft_study_ranks() > 1) {
        work_together(pool);
    } else {
#pragma omp parallel
        work(pool, (size_t)omp_get_thread_num());
    }
    omp_destroy_lock(&pool->lock);
    if (pool->scheduler == NULL) {
        haft_remote_close(&pool->remote);
    }
    return haft_part_close(&pool->part, error);
}
