/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Short messages between the processes of a run: the only file that uses MPI. Without MPI there
 * is one process, rank 0. Only the thread that joined may call these functions
 * (MPI_THREAD_FUNNELED). Private to this room. */
#ifndef HAFT_STUDY_RANKS_H
#define HAFT_STUDY_RANKS_H

#include "haft/study.h"

typedef enum haft_ranks_tag {
    HAFT_RANKS_START, /* from rank 0: 1, the laws are ready; 0, there is nothing to do */
    HAFT_RANKS_ASK,   /* to rank 0: what next? */
    HAFT_RANKS_GIVE,  /* from rank 0: this realization */
    HAFT_RANKS_END,   /* 0 to hand: none */
    HAFT_RANKS_DONE,  /* to rank 0: a realization is done and saved */
    HAFT_RANKS_FAIL,  /* to rank 0: a realization, or all, failed */
    HAFT_RANKS_GONE,  /* to rank 0: all is saved, nothing more will come */
} haft_ranks_tag;

/* Whether a message has arrived. Does not wait. */
bool haft_ranks_probe(int *from, haft_ranks_tag *tag);

/* Receives a message of that size that has arrived. */
void haft_ranks_receive(int from, haft_ranks_tag tag, void *data, size_t size);

void haft_ranks_send(int to, haft_ranks_tag tag, const void *data, size_t size);

/* Sleeps for about a millisecond, so that waiting for a message leaves the processor to others. */
void haft_ranks_rest(void);

#endif
