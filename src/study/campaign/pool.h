/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The hands of a run: the threads of one process. Private to this room. */
#ifndef HAFT_STUDY_POOL_H
#define HAFT_STUDY_POOL_H

#include "remote.h"
#include "study/laws/builder.h"

/* What all hands of a process share. */
typedef struct haft_pool {
    const haft_case *c;
    const haft_laws *laws; /* drawn from, or of the beams whose laws are there; may be NULL */
    const haft_model *model;
    haft_builder *builder;    /* of the laws of the other beams; NULL if there are none */
    haft_builder_hand **hand; /* one a thread, made with its first beam */
    int rank;           /* of this process: MPI itself is asked by the thread that began alone */
    const char *folder; /* of the parts */
    haft_shard shard;
    const char *laws_digest;
    haft_scheduler *scheduler; /* on rank 0; NULL on the others, which reach it through a remote */
    haft_remote remote;        /* on the others */
    haft_part *part;           /* begun with the first realization done */
    omp_lock_t lock;           /* of the part */
} haft_pool;

/* Gets ready to build the laws of those realizations that have none: of those not `done` (NULL: of
 * any). @param[out] lacking may be NULL: how many they are */
haft_status haft_pool_equip(haft_pool *pool, const bool *done, size_t *lacking,
                            haft_error *error) HAFT_MUST_CHECK;

/* Does all that the scheduler hands out, and on rank 0 serves the other ranks meanwhile; how it
 * went is the scheduler's to tell.
 * @return of this process's own: memory, and whether its part is safely closed */
haft_status haft_pool_work(haft_pool *pool, haft_error *error) HAFT_MUST_CHECK;

/* Puts down what haft_pool_equip() took up; fit for a pool that never did. */
void haft_pool_disband(haft_pool *pool);

#endif
