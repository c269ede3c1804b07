/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Short messages between the processes of a run: the one place that knows MPI. Without it there is
 * one process, rank 0. All of it from the thread that began (MPI_THREAD_FUNNELED). Private to this
 * room. */
#ifndef HAFT_STUDY_RANKS_H
#define HAFT_STUDY_RANKS_H

#include "haft/study.h"

typedef enum haft_ranks_tag {
    HAFT_RANKS_START, /* 0 to hand: 1, the laws are there; 0, there is nothing to do */
    HAFT_RANKS_ASK,   /* hand to 0: what next? */
    HAFT_RANKS_GIVE,  /* 0 to hand: this realization */
    HAFT_RANKS_END,   /* 0 to hand: none */
    HAFT_RANKS_DONE,  /* hand to 0: a realization is done and kept */
    HAFT_RANKS_FAIL,  /* hand to 0: a realization, or all, cannot be done */
    HAFT_RANKS_GONE,  /* hand to 0: all is kept, nothing more will come */
} haft_ranks_tag;

/* Is a message there? Does not wait. */
bool haft_ranks_probe(int *from, haft_ranks_tag *tag);

/* Takes a message of that size, which is there. */
void haft_ranks_receive(int from, haft_ranks_tag tag, void *data, size_t size);

void haft_ranks_send(int to, haft_ranks_tag tag, const void *data, size_t size);

/* Sleeps for about a millisecond: whoever waits for a message leaves the processor to others. */
void haft_ranks_rest(void);

#endif
