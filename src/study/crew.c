/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Realizations over threads. Each is done by one thread alone, its own laws before its path, and
 * both are appended to the process's part before the desk hears that it is done: what counts as
 * done is kept, and a run that is killed loses what is in work. */
#include "crew.h"

static haft_status keep(haft_crew *crew, size_t k, const haft_path *path,
                        const haft_summary *summary, const haft_laws *laws, haft_error *error) {
    haft_status status = HAFT_OK;
    omp_set_lock(&crew->lock);
    if (crew->part == NULL) {
        status = haft_part_create(&crew->part, crew->folder, crew->shard, crew->rank, crew->c,
                                  crew->laws_digest, error);
    }
    if (status == HAFT_OK) {
        status = haft_part_append(crew->part, k, path, crew->model->dofs, summary, laws, error);
    }
    omp_unset_lock(&crew->lock);
    return status;
}

/* The realization's own laws: those that are there, or built now. NULL where laws are drawn. */
static haft_status own_laws(haft_laws **out, const haft_crew *crew, size_t hand, size_t k,
                            haft_error *error) {
    *out = NULL;
    if (haft_sampler_is_stochastic(crew->c->law.sampler)) {
        return HAFT_OK;
    }
    if (haft_study_has_laws(crew->c, crew->laws, k)) {
        return haft_study_take_laws(out, crew->c, crew->laws, k, k, error);
    }
    haft_status status = HAFT_OK;
    if (crew->hand[hand] == NULL) {
        status = haft_builder_hand_create(&crew->hand[hand],
                                          (const haft_builder *const[]){crew->builder}, 1, error);
    }
    return status == HAFT_OK ? haft_builder_realize(out, crew->builder, crew->hand[hand], k, error)
                             : status;
}

static haft_status do_one(haft_crew *crew, size_t hand, size_t k, haft_summary *summary,
                          haft_error *error) {
    haft_laws *own = NULL;
    haft_site_laws *laws = NULL;
    haft_path *path = NULL;
    haft_status status = own_laws(&own, crew, hand, k, error);
    if (status == HAFT_OK) {
        status = haft_study_site_laws(&laws, crew->c, own != NULL ? own : crew->laws,
                                      own != NULL ? 0 : k, error);
    }
    if (status == HAFT_OK) {
        status = haft_study_realize(&path, summary, crew->c, crew->model, laws,
                                    haft_case_wants_evidence(crew->c, k), error);
    }
    if (status == HAFT_OK) {
        status = keep(crew, k, path, summary, own, error);
    }
    haft_path_destroy(&path);
    haft_site_laws_destroy(&laws);
    haft_laws_destroy(&own);
    return status;
}

static void work(haft_crew *crew, size_t hand) {
    size_t k = 0;
    while (crew->desk != NULL ? haft_desk_next(crew->desk, &k)
                              : haft_relay_next(&crew->relay, hand, &k)) {
        haft_summary summary;
        haft_error error = {0};
        haft_status status = do_one(crew, hand, k, &summary, &error);
        if (crew->desk != NULL && status == HAFT_OK) {
            haft_desk_enter(crew->desk, k, &summary);
        } else if (crew->desk != NULL) {
            haft_desk_fail(crew->desk, k, status, error.message);
        } else if (status == HAFT_OK) {
            haft_relay_enter(&crew->relay, hand, k, &summary);
        } else {
            haft_relay_fail(&crew->relay, hand, k, status, error.message);
        }
    }
    if (crew->hand != NULL) {
        haft_builder_hand_destroy(&crew->hand[hand]);
    }
}

haft_status haft_crew_equip(haft_crew *crew, const bool *done, size_t *lacking, haft_error *error) {
    size_t count = 0;
    if (!haft_sampler_is_stochastic(crew->c->law.sampler)) {
        for (size_t k = 0; k < crew->c->realizations; k++) {
            count += haft_shard_has(crew->shard, k) && (done == NULL || !done[k]) &&
                     !haft_study_has_laws(crew->c, crew->laws, k);
        }
    }
    if (lacking != NULL) {
        *lacking = count;
    }
    if (count == 0) {
        return HAFT_OK;
    }
    crew->hand =
        haft_memory_alloc((size_t)omp_get_max_threads() + 1, sizeof(haft_builder_hand *), error);
    return crew->hand == NULL ? HAFT_ERROR_MEMORY
                              : haft_builder_create(&crew->builder, crew->c, NULL, error);
}

void haft_crew_disband(haft_crew *crew) {
    haft_memory_free(crew->hand);
    crew->hand = NULL;
    haft_builder_destroy(&crew->builder);
}

/* Where there are several ranks, thread 0 of each speaks with the others and the rest work. */
static void work_together(haft_crew *crew) {
    size_t left = 0;
    int threads = omp_get_max_threads() + 1;
#pragma omp parallel num_threads(threads)
    {
        size_t hands = (size_t)omp_get_num_threads() - 1, own = (size_t)omp_get_thread_num();
        if (own > 0) {
            work(crew, own - 1);
#pragma omp atomic
            left++;
        } else if (crew->desk != NULL) {
            haft_relay_serve(crew->desk);
        } else {
            haft_relay_speak(&crew->relay, &left, hands);
        }
    }
}

haft_status haft_crew_work(haft_crew *crew, haft_error *error) {
    haft_status status = HAFT_OK;
    if (crew->desk == NULL) {
        status = haft_relay_open(&crew->relay, (size_t)omp_get_max_threads(), error);
        if (status != HAFT_OK) {
            return status;
        }
    }
    omp_init_lock(&crew->lock);
    if (haft_study_ranks() > 1) {
        work_together(crew);
    } else {
#pragma omp parallel
        work(crew, (size_t)omp_get_thread_num());
    }
    omp_destroy_lock(&crew->lock);
    if (crew->desk == NULL) {
        haft_relay_close(&crew->relay);
    }
    return haft_part_close(&crew->part, error);
}
