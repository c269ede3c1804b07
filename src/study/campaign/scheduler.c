/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The order of a run. Realizations are handed out in ascending order, so all below the highest
 * one handed out are done or in progress, and the lowest failure is the same for any number of
 * threads. The stop rule looks only at prefixes 0 to n-1, with n a multiple of a fixed stride,
 * so the end of the run depends neither on timing nor on interruptions. A shard has no such
 * prefix: it computes all of its realizations, and the rule is applied when shards are merged. */
#include "scheduler.h"

#include <math.h>
#include <stdio.h>

haft_status haft_scheduler_open(haft_scheduler *scheduler, haft_summary *summary,
                                const haft_case *c, haft_shard shard, const haft_progress *progress,
                                haft_error *error) {
    *scheduler = (haft_scheduler){.c = c,
                                  .shard = shard,
                                  .progress = progress,
                                  .summary = summary,
                                  .end = c->realizations,
                                  .error = error};
    scheduler->done = haft_memory_alloc(c->realizations, sizeof *scheduler->done, error);
    if (scheduler->done == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    for (size_t k = 0; k < c->realizations; k++) {
        scheduler->total += haft_shard_has(shard, k);
        summary[k] = (haft_summary){
            .crack_length = NAN, .loaded_crack_length = NAN, .gamma = NAN, .outcome = -1};
    }
    omp_init_lock(&scheduler->lock);
    return HAFT_OK;
}

void haft_scheduler_close(haft_scheduler *scheduler) {
    if (scheduler->done != NULL) {
        omp_destroy_lock(&scheduler->lock);
    }
    haft_memory_free(scheduler->done);
    *scheduler = (haft_scheduler){0};
}

/* The run needs only the first n realizations, which are all done. Drops those beyond. */
static void end_at(haft_scheduler *scheduler, size_t n) {
    scheduler->end = scheduler->total = scheduler->count = n;
    for (size_t k = n; k < scheduler->c->realizations; k++) {
        scheduler->done[k] = false;
        scheduler->summary[k] = (haft_summary){
            .crack_length = NAN, .loaded_crack_length = NAN, .gamma = NAN, .outcome = -1};
    }
}

static void advance_prefix(haft_scheduler *scheduler) {
    double goal = scheduler->c->stop.crack_length_mean;
    while (scheduler->prefix < scheduler->end && scheduler->done[scheduler->prefix]) {
        haft_moments_add(&scheduler->moments, &scheduler->summary[scheduler->prefix]);
        size_t n = ++scheduler->prefix;
        if (goal > 0 && n >= HAFT_STOP_LEAST && n % HAFT_STOP_STRIDE == 0 &&
            haft_moments_half_width(&scheduler->moments, scheduler->c->stop.confidence) <= goal) {
            end_at(scheduler, n);
        }
    }
}

static void take_in(haft_scheduler *scheduler, size_t realization, const haft_summary *summary) {
    if (realization < scheduler->end && haft_shard_has(scheduler->shard, realization) &&
        !scheduler->done[realization]) {
        scheduler->summary[realization] = *summary;
        scheduler->done[realization] = true;
        scheduler->count++;
        advance_prefix(scheduler);
    }
}

static void tell(const haft_scheduler *scheduler) {
    const haft_progress *p = scheduler->progress;
    if (p != NULL && p->advance != NULL) {
        p->advance(p->user, "beams", scheduler->count, scheduler->total);
    }
}

void haft_scheduler_restore(haft_scheduler *scheduler, size_t realization,
                            const haft_summary *summary) {
    take_in(scheduler, realization, summary);
}

void haft_scheduler_begin(haft_scheduler *scheduler) {
    if (scheduler->count < scheduler->total) {
        tell(scheduler);
    }
}

static bool asked_to_stop(const haft_scheduler *scheduler) {
    const haft_progress *p = scheduler->progress;
    return p != NULL && p->stop != NULL && p->stop(p->user);
}

bool haft_scheduler_next(haft_scheduler *scheduler, size_t *realization) {
    omp_set_lock(&scheduler->lock);
    while (
        scheduler->next < scheduler->end &&
        (scheduler->done[scheduler->next] || !haft_shard_has(scheduler->shard, scheduler->next))) {
        scheduler->next++;
    }
    bool more =
        scheduler->next < scheduler->end && scheduler->status == HAFT_OK && !scheduler->interrupted;
    if (more && asked_to_stop(scheduler)) {
        scheduler->interrupted = true;
        more = false;
    }
    if (more) {
        *realization = scheduler->next++;
    }
    omp_unset_lock(&scheduler->lock);
    return more;
}

void haft_scheduler_enter(haft_scheduler *scheduler, size_t realization,
                          const haft_summary *summary) {
    omp_set_lock(&scheduler->lock);
    bool counts = realization < scheduler->end;
    take_in(scheduler, realization, summary);
    if (counts) {
        tell(scheduler);
    }
    omp_unset_lock(&scheduler->lock);
}

void haft_scheduler_fail(haft_scheduler *scheduler, size_t realization, haft_status status,
                         const char *message) {
    omp_set_lock(&scheduler->lock);
    if (scheduler->status == HAFT_OK || (realization < scheduler->failed && !scheduler->aborted)) {
        scheduler->failed = realization;
        scheduler->status =
            haft_error_set(scheduler->error, status, "realization %zu: %s", realization, message);
    }
    omp_unset_lock(&scheduler->lock);
}

void haft_scheduler_abort(haft_scheduler *scheduler, haft_status status, const char *message) {
    omp_set_lock(&scheduler->lock);
    if (!scheduler->aborted) {
        scheduler->aborted = true;
        scheduler->status = haft_error_set(scheduler->error, status, "%s", message);
    }
    omp_unset_lock(&scheduler->lock);
}

haft_status haft_scheduler_outcome(haft_scheduler *scheduler, const char *command) {
    if (scheduler->status != HAFT_OK && scheduler->failed >= scheduler->end &&
        !scheduler->aborted) {
        scheduler->status = HAFT_OK; /* not needed by the stop rule */
    }
    if (scheduler->status == HAFT_OK && scheduler->count < scheduler->total) {
        scheduler->status =
            scheduler->count == 0
                ? haft_error_set(scheduler->error, HAFT_ERROR_INTERRUPTED,
                                 "stopped before the first realization was done")
                : haft_error_set(scheduler->error, HAFT_ERROR_INTERRUPTED,
                                 "stopped after %zu of %zu realizations; these are kept, and "
                                 "`%s` goes on from there",
                                 scheduler->count, scheduler->total, command);
    }
    return scheduler->status;
}
