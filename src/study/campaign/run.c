/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A run, from its start or from where an earlier one ended: scans the parts, computes what is
 * left, and makes results and laws from all parts at the end, in order of realization. */
#include "pool.h"
#include "shards.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct run {
    const haft_case *c;
    const haft_run_files *files;
    haft_run_mode mode;
    haft_shard shard;
    const haft_progress *progress;
    char laws_digest[HAFT_DIGEST_CAPACITY];
    haft_parts *parts;
    haft_laws *laws;
    haft_model *model;
    haft_scheduler scheduler;
    bool started; /* the other ranks were told */
    haft_error *error;
} run;

static void tell(const run *r, const char *text) {
    if (r->progress != NULL && r->progress->note != NULL) {
        r->progress->note(r->progress->user, text);
    }
}

static void note_on(void *user, const char *text) {
    tell(user, text);
}

/* ---- the start ---- */

static haft_status check_results(const run *r) {
    struct stat found;
    bool there = lstat(r->files->results, &found) == 0;
    if (there && S_ISDIR(found.st_mode)) {
        return haft_error_set(r->error, HAFT_ERROR_IO, "%s is a directory; move it away",
                              r->files->results);
    }
    if (there && r->mode == HAFT_RUN_NEW) {
        return haft_error_set(r->error, HAFT_ERROR_EXISTS,
                              "%s is there already; add --force to replace it", r->files->results);
    }
    return HAFT_OK;
}

/* A new run refuses to begin over the parts of another. */
static haft_status refuse_parts(run *r) {
    haft_error own = {0};
    haft_status status = haft_parts_scan(r->parts, r->c, r->laws_digest, note_on, r, &own);
    if (status == HAFT_ERROR_INPUT) {
        return haft_error_set(r->error, HAFT_ERROR_EXISTS, "an unfinished run is there already: %s",
                              own.message);
    }
    if (status != HAFT_OK) {
        return haft_error_set(r->error, status, "%s", own.message);
    }
    return haft_parts_files(r->parts) == 0
               ? HAFT_OK
               : haft_error_set(r->error, HAFT_ERROR_EXISTS,
                                "%s: an unfinished run is there already, with %zu of %zu "
                                "realizations; go on with it by `haft resume`, or start anew with "
                                "--force",
                                r->files->parts, haft_parts_found(r->parts), r->c->realizations);
}

static haft_status find_parts(run *r) {
    char text[HAFT_TEXT_CAPACITY];
    haft_status status = haft_parts_scan(r->parts, r->c, r->laws_digest, note_on, r, r->error);
    if (status == HAFT_OK && haft_parts_files(r->parts) > 0) {
        snprintf(text, sizeof text, "%zu of %zu realizations are there from the unfinished run",
                 haft_parts_found(r->parts), r->scheduler.total);
        tell(r, text);
    }
    if (status == HAFT_OK && haft_parts_repeated(r->parts) > 0) {
        snprintf(
            text, sizeof text,
            "%zu realizations are there more than once, to the same bits: one of each is taken",
            haft_parts_repeated(r->parts));
        tell(r, text);
    }
    return status;
}

static haft_status restore(run *r) {
    for (size_t k = 0; k < r->c->realizations; k++) {
        if (haft_parts_has(r->parts, k)) {
            haft_path *path = NULL;
            haft_summary summary;
            haft_status status = haft_parts_read(&path, &summary, NULL, r->parts, k,
                                                 haft_model_get(r->model)->dofs, r->error);
            haft_path_destroy(&path);
            if (status != HAFT_OK) {
                return status;
            }
            haft_scheduler_restore(&r->scheduler, k, &summary);
        }
    }
    return HAFT_OK;
}

/* ---- a run that is complete ---- */

static haft_status check_same_case(const run *r, const haft_results_view *view) {
    char *text = NULL;
    haft_status status = haft_case_emit(&text, r->c, r->error);
    if (status == HAFT_OK && strcmp(text, view->resolved_case) != 0) {
        status = haft_error_set(r->error, HAFT_ERROR_INPUT,
                                "%s is of another case.yaml than there is now; put that back, or "
                                "start anew with `haft run --force`",
                                r->files->results);
    }
    haft_memory_free(text);
    return status;
}

/* There are no parts: either all is done, or nothing was begun. */
static haft_status take_complete(run *r) {
    haft_results_view *view = NULL;
    if (access(r->files->results, F_OK) != 0) {
        return haft_error_set(r->error, HAFT_ERROR_INPUT,
                              "%s: there is no unfinished run to %s; start one with `haft run`",
                              r->files->parts, r->mode == HAFT_RUN_MERGE ? "merge" : "resume");
    }
    HAFT_TRY(haft_results_read(&view, r->files->results, r->error));
    haft_status status = check_same_case(r, view);
    for (size_t k = 0; status == HAFT_OK && k < view->realizations; k++) {
        if (view->summary[k].outcome >= 0) {
            haft_scheduler_restore(&r->scheduler, k, &view->summary[k]);
        }
    }
    haft_results_view_destroy(&view);
    if (status == HAFT_OK && r->scheduler.count < r->scheduler.end) {
        status = haft_error_set(r->error, HAFT_ERROR_INPUT,
                                "%s holds %zu of %zu realizations, and the parts to go on from are "
                                "gone; start anew with `haft run --force`",
                                r->files->results, r->scheduler.count, r->scheduler.end);
    }
    if (status == HAFT_OK) {
        tell(r, "the run is complete: nothing is left to do");
    }
    return status;
}

/* ---- the results ---- */

static haft_status add_one(const run *r, haft_results *results, size_t k) {
    haft_path *path = NULL;
    haft_laws *own = NULL;
    haft_site_laws *laws = NULL;
    haft_summary summary;
    haft_status status = haft_parts_read(&path, &summary, &own, r->parts, k,
                                         haft_model_get(r->model)->dofs, r->error);
    if (status == HAFT_OK && haft_case_wants_evidence(r->c, k)) {
        status = haft_study_site_laws(&laws, r->c, own != NULL ? own : r->laws, own != NULL ? 0 : k,
                                      r->error);
    }
    HAFT_THEN(status, haft_results_add(results, k, path, haft_model_get(r->model),
                                       laws == NULL ? NULL : laws->law,
                                       laws == NULL ? NULL : laws->vector, &summary, r->error));
    haft_site_laws_destroy(&laws);
    haft_laws_destroy(&own);
    haft_path_destroy(&path);
    return status;
}

static haft_status merge(run *r) {
    haft_results *results = NULL;
    haft_status status = haft_results_create(&results, r->files->results, r->c, r->laws_digest,
                                             r->mode != HAFT_RUN_NEW, r->error);
    for (size_t k = 0; status == HAFT_OK && k < r->scheduler.end; k++) {
        status = r->mode == HAFT_RUN_MERGE ? haft_shards_go_on(r->progress, r->error) : HAFT_OK;
        if (status == HAFT_OK && r->scheduler.done[k]) {
            status = add_one(r, results, k);
        }
    }
    HAFT_THEN(status, haft_results_finish(&results, r->error));
    haft_results_abandon(&results);
    return status;
}

/* If beams have laws of their own, writes those of the first n realizations, all done, from
 * their parts to laws.h5, unless it holds them already. */
static haft_status save_laws(run *r, size_t n) {
    size_t there = 0;
    while (there < n && haft_study_has_laws(r->c, r->laws, there)) {
        there++;
    }
    if (there == n || haft_sampler_is_stochastic(r->c->law.sampler)) {
        return HAFT_OK;
    }
    haft_laws_destroy(&r->laws);
    haft_laws **set = haft_memory_alloc(n, sizeof(haft_laws *), r->error);
    haft_status status = set == NULL ? HAFT_ERROR_MEMORY : HAFT_OK;
    for (size_t k = 0; status == HAFT_OK && k < n; k++) {
        haft_path *path = NULL;
        haft_summary summary;
        status = haft_parts_read(&path, &summary, &set[k], r->parts, k,
                                 haft_model_get(r->model)->dofs, r->error);
        haft_path_destroy(&path);
    }
    HAFT_THEN(status, haft_laws_join(&r->laws, set, n, r->error));
    for (size_t k = 0; set != NULL && k < n; k++) {
        haft_laws_destroy(&set[k]);
    }
    haft_memory_free(set);
    return status == HAFT_OK ? haft_laws_write(r->laws, r->c, r->files->laws, r->error) : status;
}

/* Makes the files from what is done. Removes the parts only if nothing is missing. */
static haft_status conclude(run *r, haft_status outcome) {
    haft_error said = *r->error;
    haft_status status = haft_parts_scan(r->parts, r->c, r->laws_digest, NULL, NULL, r->error);
    HAFT_THEN(status, save_laws(r, r->scheduler.prefix));
    HAFT_THEN(status, merge(r));
    if (status == HAFT_OK && r->files->beside != NULL) {
        status = r->files->beside(r->files->user, r->scheduler.summary, r->laws, r->error);
    }
    if (status == HAFT_OK && outcome == HAFT_OK) {
        status = haft_parts_retire(r->parts, r->error);
    }
    if (status == HAFT_OK) {
        *r->error = said;
        return outcome;
    }
    return status;
}

static void tell_shard(const run *r) {
    char text[HAFT_TEXT_CAPACITY];
    snprintf(
        text, sizeof text,
        "shard %zu/%zu is done: its %zu realizations are kept in %s; once all shards are, `haft "
        "merge %s` makes the results",
        r->shard.index, r->shard.count, r->scheduler.total, r->files->parts, r->files->folder);
    tell(r, text);
}

static void tell_stop(const run *r) {
    if (r->scheduler.end < r->c->realizations) {
        char text[HAFT_TEXT_CAPACITY];
        snprintf(text, sizeof text,
                 "study.stop: the mean crack length is known to +- %.3g um (%.6g %% confidence) "
                 "after %zu of %zu realizations",
                 1e6 * haft_moments_half_width(&r->scheduler.moments, r->c->stop.confidence),
                 100 * r->c->stop.confidence, r->scheduler.end, r->c->realizations);
        tell(r, text);
    }
}

/* ---- all of it ---- */

/* With fewer beams than threads, all threads first build the laws of all beams, block by block.
 * With a stop rule, which may need fewer beams, laws are built beam by beam. */
static haft_status build_together(run *r) {
    bool direct = !haft_sampler_is_stochastic(r->c->law.sampler);
    bool few = r->c->realizations < (size_t)omp_get_max_threads() && haft_study_ranks() == 1 &&
               !(r->c->stop.crack_length_mean > 0) && haft_parts_found(r->parts) == 0;
    size_t lacking = 0;
    for (size_t k = 0; k < r->c->realizations; k++) {
        lacking += !haft_study_has_laws(r->c, r->laws, k);
    }
    if (!direct || !few || lacking < r->c->realizations) {
        return HAFT_OK;
    }
    haft_laws_destroy(&r->laws);
    haft_status status = haft_study_build_laws(&r->laws, r->c, r->progress, r->error);
    return status == HAFT_OK ? haft_laws_write(r->laws, r->c, r->files->laws, r->error) : status;
}

/* Reads the laws: a model must exist, beams' own laws need not. */
static haft_status read_laws(run *r) {
    char built[HAFT_DIGEST_CAPACITY];
    HAFT_TRY(haft_study_laws_digest(r->laws_digest, r->c, r->files->laws, r->error));
    if (!haft_sampler_is_stochastic(r->c->law.sampler)) {
        return haft_study_obtain_laws(&r->laws, built, r->c, r->files->laws, NULL, r->error);
    }
    if (access(r->files->laws, F_OK) != 0) {
        return haft_error_set(r->error, HAFT_ERROR_INPUT,
                              "%s is not there, the model that all shards draw from; build it by "
                              "`haft-laws build %s`",
                              r->files->laws, r->files->folder);
    }
    haft_status status = haft_laws_read(&r->laws, built, r->files->laws, r->error);
    if (status == HAFT_OK && strcmp(built, r->laws_digest) != 0) {
        status = haft_study_rank() > 0
                     ? haft_error_set(r->error, HAFT_ERROR_INPUT,
                                      "%s was built from other inputs than rank %d sees; do all "
                                      "ranks see the same files?",
                                      r->files->laws, haft_study_rank())
                     : haft_error_set(r->error, HAFT_ERROR_INPUT,
                                      "%s was built from other inputs than case.yaml has now; "
                                      "build it anew by `haft-laws build %s`",
                                      r->files->laws, r->files->folder);
    }
    return status;
}

/* Makes what threads share besides the laws: tables of drawn patches, and the model. */
static haft_status make_shared(run *r) {
    haft_status status = HAFT_OK;
    if (haft_study_draws_patches(r->c)) {
        status = haft_laws_tabulate(r->laws, r->error);
    }
    return status == HAFT_OK ? haft_model_create_beam(&r->model, &r->c->beam, &r->c->mesh, r->error)
                             : status;
}

static haft_status prepare(run *r) {
    haft_status status = HAFT_OK;
    if (r->shard.count > 0 || r->mode == HAFT_RUN_MERGE) {
        status = read_laws(r);
    } else {
        status = haft_study_obtain_laws(&r->laws, r->laws_digest, r->c, r->files->laws, r->progress,
                                        r->error);
        HAFT_THEN(status, build_together(r));
    }
    HAFT_THEN(status, make_shared(r));
    if (status == HAFT_OK) { /* the old parts stay until here */
        status = r->mode == HAFT_RUN_ANEW ? haft_parts_clear(r->parts, r->error) : restore(r);
    }
    if (status == HAFT_OK && r->mode == HAFT_RUN_MERGE) {
        status = haft_shards_check(&r->scheduler, r->parts, r->files, r->error);
    }
    return status;
}

/* Reports how many beams' laws must be built, if some exist. */
static void tell_lacking(const run *r, size_t lacking) {
    if (lacking > 0 && r->laws != NULL) {
        char text[HAFT_TEXT_CAPACITY];
        snprintf(text, sizeof text, "%zu beams have no laws yet: building them", lacking);
        tell(r, text);
    }
}

static haft_status work(run *r) {
    haft_pool pool = {.c = r->c,
                      .laws = r->laws,
                      .model = r->model,
                      .folder = r->files->parts,
                      .laws_digest = r->laws_digest,
                      .shard = r->shard,
                      .scheduler = &r->scheduler,
                      .rank = haft_study_rank()};
    haft_error own = {0};
    char command[HAFT_COMMAND_CAPACITY];
    size_t lacking = 0;
    haft_status status = haft_pool_equip(&pool, r->scheduler.done, &lacking, r->error);
    if (status == HAFT_OK) {
        tell_lacking(r, lacking);
        haft_scheduler_begin(&r->scheduler);
        haft_remote_start(true);
        r->started = true;
        status = haft_pool_work(&pool, &own);
        if (status != HAFT_OK) {
            haft_scheduler_abort(&r->scheduler, status, own.message);
        }
        haft_shards_command(command, r->shard, r->files);
        status = haft_scheduler_outcome(&r->scheduler, command);
    }
    haft_pool_disband(&pool);
    return status;
}

static haft_status go(run *r) {
    haft_status status = prepare(r);
    HAFT_THEN(status, work(r));
    if (!r->started) {
        return status;
    }
    if (r->shard.count > 0) {
        if (status == HAFT_OK) {
            tell_shard(r);
        }
    } else if (status == HAFT_OK || (status == HAFT_ERROR_INTERRUPTED && r->scheduler.count > 0)) {
        if (status == HAFT_OK) {
            tell_stop(r);
        }
        status = conclude(r, status);
    }
    if (status != HAFT_OK && status != HAFT_ERROR_INTERRUPTED && r->scheduler.count > 0) {
        haft_error said = *r->error;
        char command[HAFT_COMMAND_CAPACITY];
        haft_shards_command(command, r->shard, r->files);
        status = haft_error_set(
            r->error, status, "%s; the %zu realizations done are kept, and `%s` goes on from there",
            said.message, r->scheduler.count, command);
    }
    return status;
}

/* Locks the folder of parts, and checks whether its contents let this run begin. */
static haft_status begin(run *r) {
    haft_status status = haft_study_laws_digest(r->laws_digest, r->c, r->files->laws, r->error);
    HAFT_THEN(status, haft_parts_hold(&r->parts, r->files->parts, r->shard.index, r->shard.count,
                                      r->error));
    if (status == HAFT_OK && r->mode == HAFT_RUN_NEW && r->shard.count == 0) {
        status = refuse_parts(r);
    } else if (status == HAFT_OK && r->mode != HAFT_RUN_ANEW) {
        status = find_parts(r);
    }
    return status == HAFT_OK ? check_results(r) : status;
}

/* On ranks other than 0: computes their share of the realizations. */
static haft_status lend_a_hand(run *r) {
    if (!haft_remote_await_start()) {
        return HAFT_OK; /* rank 0 says why */
    }
    haft_status status = read_laws(r);
    HAFT_THEN(status, make_shared(r));
    if (status == HAFT_OK) {
        haft_pool pool = {.c = r->c,
                          .laws = r->laws,
                          .model = r->model,
                          .folder = r->files->parts,
                          .laws_digest = r->laws_digest,
                          .shard = r->shard,
                          .rank = haft_study_rank()};
        status = haft_pool_equip(&pool, NULL, NULL, r->error);
        HAFT_THEN(status, haft_pool_work(&pool, r->error));
        haft_pool_disband(&pool);
    }
    haft_remote_leave(status, r->error->message);
    return HAFT_OK;
}

static haft_status lead(run *r, haft_summary *summary) {
    haft_status status =
        haft_scheduler_open(&r->scheduler, summary, r->c, r->shard, r->progress, r->error);
    HAFT_THEN(status, begin(r));
    if (status == HAFT_OK) {
        if (r->shard.count == 0) { /* processes of other machines are not known here */
            haft_io_drop_stale(r->files->results);
            haft_io_drop_stale(r->files->laws);
            haft_io_drop_stale(r->files->parts);
        }
        bool joins = r->mode == HAFT_RUN_RESUME || r->mode == HAFT_RUN_MERGE;
        status = joins && haft_parts_files(r->parts) == 0 ? take_complete(r) : go(r);
    }
    if (!r->started) {
        haft_remote_start(false);
    }
    return status;
}

haft_status haft_study_run(haft_summary *summary, const haft_case *c, const haft_run_files *files,
                           haft_run_mode mode, haft_shard shard, const haft_progress *progress,
                           haft_error *error) {
    haft_error unheard = {0};
    run r = {.c = c,
             .files = files,
             .mode = mode,
             .shard = shard,
             .progress = progress,
             .error = error != NULL ? error : &unheard};
    bool leads = haft_study_rank() == 0;
    haft_status status = leads ? lead(&r, summary) : lend_a_hand(&r);
    if (!haft_study_ranks_agree(!leads || status == HAFT_OK) && !leads) {
        status = haft_error_set(r.error, HAFT_ERROR_INTERRUPTED, "rank 0 ended the run");
    }
    haft_scheduler_close(&r.scheduler);
    haft_model_destroy(&r.model);
    haft_laws_destroy(&r.laws);
    haft_parts_release(&r.parts);
    return status;
}
