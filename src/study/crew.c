/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Realizations over threads. Each is solved by one thread alone and appended to the process's part
 * before the desk hears that it is done: what counts as done is kept. */
#include "crew.h"

static haft_status keep(haft_crew *crew, size_t k, const haft_path *path,
                        const haft_summary *summary, haft_error *error) {
    haft_status status = HAFT_OK;
    omp_set_lock(&crew->lock);
    if (crew->part == NULL) {
        status = haft_part_create(&crew->part, crew->folder, crew->rank, crew->c, crew->laws_digest,
                                  error);
    }
    if (status == HAFT_OK) {
        status = haft_part_append(crew->part, k, path, crew->model->dofs, summary, error);
    }
    omp_unset_lock(&crew->lock);
    return status;
}

static void do_one(haft_crew *crew, size_t hand, size_t k) {
    haft_site_laws *laws = NULL;
    haft_path *path = NULL;
    haft_summary summary;
    haft_error error = {0};
    haft_status status = haft_study_site_laws(&laws, crew->c, crew->laws, k, &error);
    if (status == HAFT_OK) {
        status = haft_study_realize(&path, &summary, crew->c, crew->model, laws,
                                    haft_case_wants_evidence(crew->c, k), &error);
    }
    if (status == HAFT_OK) {
        status = keep(crew, k, path, &summary, &error);
    }
    if (crew->desk != NULL && status == HAFT_OK) {
        haft_desk_enter(crew->desk, k, &summary);
    } else if (crew->desk != NULL) {
        haft_desk_fail(crew->desk, k, status, error.message);
    } else if (status == HAFT_OK) {
        haft_relay_enter(&crew->relay, hand, k, &summary);
    } else {
        haft_relay_fail(&crew->relay, hand, k, status, error.message);
    }
    haft_path_destroy(&path);
    haft_site_laws_destroy(&laws);
}

static void work(haft_crew *crew, size_t hand) {
    size_t k = 0;
    while (crew->desk != NULL ? haft_desk_next(crew->desk, &k)
                              : haft_relay_next(&crew->relay, hand, &k)) {
        do_one(crew, hand, k);
    }
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
        work(crew, 0);
    }
    omp_destroy_lock(&crew->lock);
    if (crew->desk == NULL) {
        haft_relay_close(&crew->relay);
    }
    return haft_part_close(&crew->part, error);
}
