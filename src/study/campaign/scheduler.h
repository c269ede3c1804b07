/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hands out realizations, and decides when a run is done. Private to this room. */
#ifndef HAFT_STUDY_SCHEDULER_H
#define HAFT_STUDY_SCHEDULER_H

#include "study/statistics/moments.h"

#include <omp.h>

/* Hands out realizations in their order, and takes their summaries back in any order.
 * Thread-safe. */
typedef struct haft_scheduler {
    const haft_case *c;
    haft_shard shard; /* other realizations are neither handed out nor accepted */
    const haft_progress *progress;
    haft_summary *summary; /* realizations; the caller's */
    bool *done;            /* realizations */
    size_t next;           /* the next one to hand out */
    size_t count;          /* done below `end` */
    size_t end;            /* realizations of the run; fewer when the stop rule holds */
    size_t total;          /* of them in the shard */
    haft_moments moments;  /* of the prefix in which all are done, for the stop rule */
    size_t prefix;
    bool interrupted;
    haft_status status; /* the failure of the lowest realization `failed`, or of the run */
    bool aborted;
    size_t failed;
    haft_error *error;
    omp_lock_t lock;
} haft_scheduler;

haft_status haft_scheduler_open(haft_scheduler *scheduler, haft_summary *summary,
                                const haft_case *c, haft_shard shard, const haft_progress *progress,
                                haft_error *error) HAFT_MUST_CHECK;
void haft_scheduler_close(haft_scheduler *scheduler);

/* Enters a realization of an earlier run, before the work begins. */
void haft_scheduler_restore(haft_scheduler *scheduler, size_t realization,
                            const haft_summary *summary);

/* Reports how many are done before the work begins. */
void haft_scheduler_begin(haft_scheduler *scheduler);

/* Gets the next realization; false if there is none, or if the run is to end early. */
bool haft_scheduler_next(haft_scheduler *scheduler, size_t *realization);

/* Enters a realization that is done, or that failed, which ends the run. */
void haft_scheduler_enter(haft_scheduler *scheduler, size_t realization,
                          const haft_summary *summary);
void haft_scheduler_fail(haft_scheduler *scheduler, size_t realization, haft_status status,
                         const char *message);

/* Ends the run because of another failure. */
void haft_scheduler_abort(haft_scheduler *scheduler, haft_status status, const char *message);

/* The outcome, when all threads have finished: HAFT_OK if all are done.
 * @param[in] command the command that continues the run */
haft_status haft_scheduler_outcome(haft_scheduler *scheduler, const char *command);

#endif
