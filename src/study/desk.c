/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The order of a run. Realizations go out in ascending order, so whichever thread or process does
 * them, all below the highest one given are done or in work: the lowest failure is the same for any
 * number of hands. The stop rule looks at prefixes alone, 0 to n-1 with n a multiple of a fixed
 * stride, so where it ends the run does not depend on who was quicker, nor on interruptions. A
 * shard has no such prefix of its own: it does all it is given, and the rule is for whoever joins
 * them. */
#include "desk.h"

#include <math.h>
#include <stdio.h>

haft_status haft_desk_open(haft_desk *desk, haft_summary *summary, const haft_case *c,
                           haft_shard shard, const haft_progress *progress, haft_error *error) {
    *desk = (haft_desk){.c = c,
                        .shard = shard,
                        .progress = progress,
                        .summary = summary,
                        .end = c->realizations,
                        .error = error};
    desk->done = haft_memory_alloc(c->realizations, sizeof *desk->done, error);
    if (desk->done == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    for (size_t k = 0; k < c->realizations; k++) {
        desk->total += haft_shard_has(shard, k);
        summary[k] = (haft_summary){
            .crack_length = NAN, .loaded_crack_length = NAN, .gamma = NAN, .outcome = -1};
    }
    omp_init_lock(&desk->lock);
    return HAFT_OK;
}

void haft_desk_close(haft_desk *desk) {
    if (desk->done != NULL) {
        omp_destroy_lock(&desk->lock);
    }
    haft_memory_free(desk->done);
    *desk = (haft_desk){0};
}

/* The run needs no more than the first n, all of which are done: what was done beyond them is
 * forgotten. */
static void end_at(haft_desk *desk, size_t n) {
    desk->end = desk->total = desk->count = n;
    for (size_t k = n; k < desk->c->realizations; k++) {
        desk->done[k] = false;
        desk->summary[k] = (haft_summary){
            .crack_length = NAN, .loaded_crack_length = NAN, .gamma = NAN, .outcome = -1};
    }
}

static void advance_prefix(haft_desk *desk) {
    double goal = desk->c->stop.crack_length_mean;
    while (desk->prefix < desk->end && desk->done[desk->prefix]) {
        haft_moments_add(&desk->moments, &desk->summary[desk->prefix]);
        size_t n = ++desk->prefix;
        if (goal > 0 && n >= HAFT_STOP_LEAST && n % HAFT_STOP_STRIDE == 0 &&
            haft_moments_half_width(&desk->moments, desk->c->stop.confidence) <= goal) {
            end_at(desk, n);
        }
    }
}

static void take_in(haft_desk *desk, size_t realization, const haft_summary *summary) {
    if (realization < desk->end && haft_shard_has(desk->shard, realization) &&
        !desk->done[realization]) {
        desk->summary[realization] = *summary;
        desk->done[realization] = true;
        desk->count++;
        advance_prefix(desk);
    }
}

static void tell(const haft_desk *desk) {
    const haft_progress *p = desk->progress;
    if (p != NULL && p->advance != NULL) {
        p->advance(p->user, "beams", desk->count, desk->total);
    }
}

void haft_desk_restore(haft_desk *desk, size_t realization, const haft_summary *summary) {
    take_in(desk, realization, summary);
}

void haft_desk_begin(haft_desk *desk) {
    if (desk->count < desk->total) {
        tell(desk);
    }
}

static bool asked_to_stop(const haft_desk *desk) {
    const haft_progress *p = desk->progress;
    return p != NULL && p->stop != NULL && p->stop(p->user);
}

bool haft_desk_next(haft_desk *desk, size_t *realization) {
    omp_set_lock(&desk->lock);
    while (desk->next < desk->end &&
           (desk->done[desk->next] || !haft_shard_has(desk->shard, desk->next))) {
        desk->next++;
    }
    bool more = desk->next < desk->end && desk->status == HAFT_OK && !desk->interrupted;
    if (more && asked_to_stop(desk)) {
        desk->interrupted = true;
        more = false;
    }
    if (more) {
        *realization = desk->next++;
    }
    omp_unset_lock(&desk->lock);
    return more;
}

void haft_desk_enter(haft_desk *desk, size_t realization, const haft_summary *summary) {
    omp_set_lock(&desk->lock);
    bool counts = realization < desk->end;
    take_in(desk, realization, summary);
    if (counts) {
        tell(desk);
    }
    omp_unset_lock(&desk->lock);
}

void haft_desk_fail(haft_desk *desk, size_t realization, haft_status status, const char *message) {
    omp_set_lock(&desk->lock);
    if (desk->status == HAFT_OK || (realization < desk->failed && !desk->aborted)) {
        desk->failed = realization;
        desk->status =
            haft_error_set(desk->error, status, "realization %zu: %s", realization, message);
    }
    omp_unset_lock(&desk->lock);
}

void haft_desk_abort(haft_desk *desk, haft_status status, const char *message) {
    omp_set_lock(&desk->lock);
    if (!desk->aborted) {
        desk->aborted = true;
        desk->status = haft_error_set(desk->error, status, "%s", message);
    }
    omp_unset_lock(&desk->lock);
}

haft_status haft_desk_outcome(haft_desk *desk, const char *way) {
    if (desk->status != HAFT_OK && desk->failed >= desk->end && !desk->aborted) {
        desk->status = HAFT_OK; /* beyond what the stop rule needs */
    }
    if (desk->status == HAFT_OK && desk->count < desk->total) {
        desk->status =
            desk->count == 0
                ? haft_error_set(desk->error, HAFT_ERROR_INTERRUPTED,
                                 "stopped before the first realization was done")
                : haft_error_set(desk->error, HAFT_ERROR_INTERRUPTED,
                                 "stopped after %zu of %zu realizations; these are kept, and "
                                 "`%s` goes on from there",
                                 desk->count, desk->total, way);
    }
    return desk->status;
}
