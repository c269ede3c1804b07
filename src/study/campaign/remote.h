/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Access to the scheduler from other processes: rank 0 has it, and the threads of other ranks
 * reach it by messages. Private to this room. */
#ifndef HAFT_STUDY_REMOTE_H
#define HAFT_STUDY_REMOTE_H

#include "ranks.h"
#include "scheduler.h"

/* The message and the answer of one thread of another rank. */
typedef struct haft_remote_slot haft_remote_slot;

/* The threads of a rank other than 0; one of them communicates for all. */
typedef struct haft_remote {
    size_t slots;
    haft_remote_slot *slot; /* one a thread */
    omp_lock_t lock;
} haft_remote;

haft_status haft_remote_open(haft_remote *remote, size_t threads,
                             haft_error *error) HAFT_MUST_CHECK;
void haft_remote_close(haft_remote *remote);

/* Like the scheduler's functions: the next realization for thread `slot`, and the result of the
 * last. */
bool haft_remote_next(haft_remote *remote, size_t slot, size_t *realization);
void haft_remote_enter(haft_remote *remote, size_t slot, size_t realization,
                       const haft_summary *summary);
void haft_remote_fail(haft_remote *remote, size_t slot, size_t realization, haft_status status,
                      const char *message);

/* Communicates for the threads until all have left; `left` counts them by atomic increments. */
void haft_remote_speak(haft_remote *remote, const size_t *left, size_t threads);

/* On rank 0: answers the others until all have left. */
void haft_remote_serve(haft_scheduler *scheduler);

/* On rank 0: lets the others begin, or leave. On another rank: waits for that. */
void haft_remote_start(bool go);
bool haft_remote_await_start(void);

/* On another rank, at the end: reports a failure other than of a realization (HAFT_OK: none). */
void haft_remote_leave(haft_status status, const char *message);

#endif
