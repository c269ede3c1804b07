/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Realizations over threads. Each is solved by one thread alone and entered into the results in
 * their order, so neither the numbers nor the file depend on the number of threads. */
#include "haft/study.h"

#include <math.h>
#include <time.h>

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

haft_status haft_study_realize(haft_path **out, haft_summary *summary, const haft_case *c,
                               const haft_model *model, const haft_site_laws *laws,
                               bool keep_states, haft_error *error) {
    haft_path_options options = c->path;
    options.keep_states = keep_states;
    double start = now();
    haft_status status = haft_solve_path(out, model, laws->law, &c->programme, &options, error);
    if (status != HAFT_OK) {
        return status;
    }
    const haft_path *path = *out;
    haft_path_point end = {0}, turn = {0};
    if (path->points > 0) {
        end = path->point[path->points - 1];
        turn = path->point[path->turn];
    }
    bool solved = path->outcome == HAFT_OUTCOME_STUCK || path->outcome == HAFT_OUTCOME_FREE;
    bool stuck = path->outcome == HAFT_OUTCOME_STUCK;
    *summary = (haft_summary){
        .crack_length = solved ? end.crack_length : NAN,
        .loaded_crack_length = path->points > 0 ? turn.crack_length : NAN,
        .gamma = stuck ? haft_beam_effective_energy(&c->beam, end.crack_length) : 0,
        .work = end.work,
        .dissipated = end.dissipated,
        .ledger_error = path->ledger_error,
        .seconds = now() - start,
        .outcome = (int)path->outcome,
        .jumps = (int)path->jumps,
        .steps = (int)path->points,
        .unfit = (int)laws->unfit,
    };
    return HAFT_OK;
}

static bool wants_evidence(const haft_case *c, size_t realization) {
    for (size_t i = 0; i < c->evidence.count && !c->evidence.all; i++) {
        if (c->evidence.realization[i] == realization) {
            return true;
        }
    }
    return c->evidence.all;
}

/* What the loop over realizations shares. */
typedef struct campaign {
    const haft_case *c;
    const haft_laws *laws;
    const haft_model *model;
    haft_results *results;
    haft_summary *summary;
    const haft_progress *progress;
    size_t done;
    haft_status status; /* of the first failure */
    bool halt;
} campaign;

/* One realization, up to its entry into the results. */
typedef struct outcome {
    haft_site_laws *laws;
    haft_path *path;
    haft_summary summary;
    haft_error error;
    haft_status status;
} outcome;

static outcome solve_one(const campaign *job, size_t k) {
    outcome o = {.status = HAFT_OK};
    o.status = haft_study_site_laws(&o.laws, job->c, job->laws, k, &o.error);
    if (o.status == HAFT_OK) {
        o.status = haft_study_realize(&o.path, &o.summary, job->c, job->model, o.laws,
                                      wants_evidence(job->c, k), &o.error);
    }
    return o;
}

static void enter_one(campaign *job, size_t k, outcome *o, haft_error *error) {
    if (job->status == HAFT_OK && o->status == HAFT_OK) {
        o->status = haft_results_add(job->results, k, o->path, job->model, o->laws->law,
                                     o->laws->vector, &o->summary, &o->error);
    }
    if (o->status != HAFT_OK && job->status == HAFT_OK) {
        job->status = haft_error_set(error, o->status, "realization %zu: %s", k, o->error.message);
    }
    if (job->status == HAFT_OK) {
        job->summary[k] = o->summary;
        job->done++;
        const haft_progress *p = job->progress;
        if (p != NULL && p->advance != NULL) {
            p->advance(p->user, "beams", job->done, job->c->realizations);
        }
        if (p != NULL && p->stop != NULL && job->done < job->c->realizations && p->stop(p->user)) {
            job->status = haft_error_set(error, HAFT_ERROR_INTERRUPTED,
                                         "stopped after %zu of %zu realizations; these are kept",
                                         job->done, job->c->realizations);
        }
    }
}

static void run_all(campaign *job, haft_error *error) {
    long n = (long)job->c->realizations;
#pragma omp parallel for ordered schedule(dynamic, 1)
    for (long k = 0; k < n; k++) {
        bool halt;
#pragma omp atomic read
        halt = job->halt;
        outcome o = {.status = HAFT_ERROR_INTERRUPTED};
        if (!halt) {
            o = solve_one(job, (size_t)k);
        }
#pragma omp ordered
        {
            if (!halt && !job->halt) {
                enter_one(job, (size_t)k, &o, error);
            }
            if (job->status != HAFT_OK) {
#pragma omp atomic write
                job->halt = true;
            }
        }
        haft_path_destroy(&o.path);
        haft_site_laws_destroy(&o.laws);
    }
}

haft_status haft_study_run(haft_summary *summary, const haft_case *c, const haft_laws *laws,
                           const char *laws_digest, const char *path, bool overwrite,
                           const haft_progress *progress, haft_error *error) {
    haft_model *model = NULL;
    campaign job = {.c = c, .laws = laws, .summary = summary, .progress = progress};
    for (size_t k = 0; k < c->realizations; k++) {
        summary[k] = (haft_summary){
            .crack_length = NAN, .loaded_crack_length = NAN, .gamma = NAN, .outcome = -1};
    }
    haft_status status = haft_model_create_beam(&model, &c->beam, &c->mesh, error);
    if (status == HAFT_OK) {
        status = haft_results_create(&job.results, path, c, laws_digest, overwrite, error);
    }
    if (status == HAFT_OK) {
        job.model = model;
        run_all(&job, error);
        status = job.status;
        bool keep = status == HAFT_OK || (status == HAFT_ERROR_INTERRUPTED && job.done > 0);
        if (keep) {
            haft_error own = {0};
            haft_status finished = haft_results_finish(&job.results, &own);
            if (finished != HAFT_OK) {
                status = haft_error_set(error, finished, "%s", own.message);
            }
        }
        haft_results_abandon(&job.results);
    }
    haft_model_destroy(&model);
    return status;
}
