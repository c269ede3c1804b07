/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who gets which realization, and when a run is done. Private to this room. */
#ifndef HAFT_STUDY_SCHEDULER_H
#define HAFT_STUDY_SCHEDULER_H

#include "study/statistics/moments.h"

#include <omp.h>

/* Hands realizations out in their order and takes their summaries back in any. Its functions may be
 * called by any number of threads. */
typedef struct haft_scheduler {
    const haft_case *c;
    haft_shard shard; /* what is not in it is neither handed out nor taken in */
    const haft_progress *progress;
    haft_summary *summary; /* realizations; the caller's */
    bool *done;            /* realizations */
    size_t next;           /* none below it is to be handed out any more */
    size_t count;          /* done below `end` */
    size_t end;            /* realizations of the run; fewer once the stop rule holds */
    size_t total;          /* of them in the shard */
    haft_moments moments;  /* of the prefix in which all are done, for the stop rule */
    size_t prefix;
    bool interrupted;
    haft_status status; /* of the failure of the lowest realization `failed`, or of all */
    bool aborted;
    size_t failed;
    haft_error *error;
    omp_lock_t lock;
} haft_scheduler;

haft_status haft_scheduler_open(haft_scheduler *scheduler, haft_summary *summary,
                                const haft_case *c, haft_shard shard, const haft_progress *progress,
                                haft_error *error) HAFT_MUST_CHECK;
void haft_scheduler_close(haft_scheduler *scheduler);

/* Enters a realization that an earlier run has done, before the work begins. */
void haft_scheduler_restore(haft_scheduler *scheduler, size_t realization,
                            const haft_summary *summary);

/* Tells how many are done before the work begins. */
void haft_scheduler_begin(haft_scheduler *scheduler);

/* The next realization to do; false if there is none, or the run shall end early. */
bool haft_scheduler_next(haft_scheduler *scheduler, size_t *realization);

/* One is done, or cannot be done; the second ends the run. */
void haft_scheduler_enter(haft_scheduler *scheduler, size_t realization,
                          const haft_summary *summary);
void haft_scheduler_fail(haft_scheduler *scheduler, size_t realization, haft_status status,
                         const char *message);

/* Something else went wrong: ends the run. */
void haft_scheduler_abort(haft_scheduler *scheduler, haft_status status, const char *message);

/* What came of it, once all hands are still: HAFT_OK if all are done.
 * @param[in] command the command that goes on with what is left */
haft_status haft_scheduler_outcome(haft_scheduler *scheduler, const char *command);

#endif
