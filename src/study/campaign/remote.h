/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The scheduler of a run over several processes: rank 0 keeps it, the threads of the others reach
 * it by messages. Private to this room. */
#ifndef HAFT_STUDY_REMOTE_H
#define HAFT_STUDY_REMOTE_H

#include "ranks.h"
#include "scheduler.h"

/* What one thread of another rank has to tell and waits for. */
typedef struct haft_remote_slot haft_remote_slot;

/* The threads of a rank other than 0, and the one among them that speaks for all. */
typedef struct haft_remote {
    size_t slots;
    haft_remote_slot *slot; /* one a thread */
    omp_lock_t lock;
} haft_remote;

haft_status haft_remote_open(haft_remote *remote, size_t threads,
                             haft_error *error) HAFT_MUST_CHECK;
void haft_remote_close(haft_remote *remote);

/* As the scheduler's: the next realization for thread `slot`, and what became of the last. */
bool haft_remote_next(haft_remote *remote, size_t slot, size_t *realization);
void haft_remote_enter(haft_remote *remote, size_t slot, size_t realization,
                       const haft_summary *summary);
void haft_remote_fail(haft_remote *remote, size_t slot, size_t realization, haft_status status,
                      const char *message);

/* Speaks for the threads until `left` of them, counted by atomic increments, have left. */
void haft_remote_speak(haft_remote *remote, const size_t *left, size_t threads);

/* On rank 0: answers the others until all are gone. */
void haft_remote_serve(haft_scheduler *scheduler);

/* On rank 0: lets the others begin, or go. On another rank: waits for that. */
void haft_remote_start(bool go);
bool haft_remote_await_start(void);

/* On another rank, last of all: what failed besides realizations (HAFT_OK: nothing). */
void haft_remote_leave(haft_status status, const char *message);

#endif
