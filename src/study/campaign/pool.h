/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The thread pool of a run: the threads of one process. Private to this room. */
#ifndef HAFT_STUDY_POOL_H
#define HAFT_STUDY_POOL_H

#include "remote.h"
#include "study/laws/builder.h"

/* Data shared by all threads of a process. */
typedef struct haft_pool {
    const haft_case *c;
    const haft_laws *laws; /* that laws are drawn from, or of the beams with laws; may be NULL */
    const haft_model *model;
    haft_builder *builder;    /* builds the laws of the other beams; NULL if there are none */
    haft_builder_hand **hand; /* one per thread, made with its first beam */
    int rank;                 /* of this process; only the thread that joined may ask MPI */
    const char *folder;       /* of the parts */
    haft_shard shard;
    const char *laws_digest;
    haft_scheduler *scheduler; /* on rank 0; NULL on the others, which reach it by messages */
    haft_remote remote;        /* on the others */
    haft_part *part;           /* opened with the first realization that is done */
    omp_lock_t lock;           /* of the part */
} haft_pool;

/* Prepares to build the laws of realizations without laws that are not `done` (NULL: of any).
 * @param[out] lacking may be NULL: their number */
haft_status haft_pool_equip(haft_pool *pool, const bool *done, size_t *lacking,
                            haft_error *error) HAFT_MUST_CHECK;

/* Computes all realizations that the scheduler hands out, and on rank 0 serves the other ranks
 * meanwhile. The scheduler knows the outcome. @return failures of this process itself: memory,
 * or closing its part */
haft_status haft_pool_work(haft_pool *pool, haft_error *error) HAFT_MUST_CHECK;

/* Frees what haft_pool_equip() made; may be called without it. */
void haft_pool_disband(haft_pool *pool);

#endif
