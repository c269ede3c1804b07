/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Realizations over threads. Each is solved by one thread alone and appended to the process's part
 * before the desk hears that it is done: what counts as done is kept. */
#include "crew.h"

static haft_status keep(haft_crew *crew, size_t k, const haft_path *path,
                        const haft_summary *summary, haft_error *error) {
    haft_status status = HAFT_OK;
    omp_set_lock(&crew->lock);
    if (crew->part == NULL) {
        status = haft_part_create(&crew->part, crew->folder, 0, crew->c, crew->laws_digest, error);
    }
    if (status == HAFT_OK) {
        status = haft_part_append(crew->part, k, path, crew->model->dofs, summary, error);
    }
    omp_unset_lock(&crew->lock);
    return status;
}

static void do_one(haft_crew *crew, size_t k) {
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
    if (status == HAFT_OK) {
        haft_desk_enter(crew->desk, k, &summary);
    } else {
        haft_desk_fail(crew->desk, k, status, error.message);
    }
    haft_path_destroy(&path);
    haft_site_laws_destroy(&laws);
}

void haft_crew_work(haft_crew *crew) {
    omp_init_lock(&crew->lock);
#pragma omp parallel
    {
        size_t k = 0;
        while (haft_desk_next(crew->desk, &k)) {
            do_one(crew, k);
        }
    }
    omp_destroy_lock(&crew->lock);
    haft_error error = {0};
    haft_status status = haft_part_close(&crew->part, &error);
    if (status != HAFT_OK && crew->desk->status == HAFT_OK) {
        crew->desk->status = haft_error_set(crew->desk->error, status, "%s", error.message);
    }
}
