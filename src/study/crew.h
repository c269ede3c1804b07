/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The hands of a run: the threads of one process. Private to this room. */
#ifndef HAFT_STUDY_CREW_H
#define HAFT_STUDY_CREW_H

#include "relay.h"

/* What all hands of a process share. */
typedef struct haft_crew {
    const haft_case *c;
    const haft_laws *laws;
    const haft_model *model;
    int rank;           /* of this process: MPI itself is asked by the thread that began alone */
    const char *folder; /* of the parts */
    const char *laws_digest;
    haft_desk *desk;  /* on rank 0; NULL on the others, which reach it through a relay */
    haft_relay relay; /* on the others */
    haft_part *part;  /* begun with the first realization done */
    omp_lock_t lock;  /* of the part */
} haft_crew;

/* Does all that the desk hands out, and on rank 0 serves the other ranks meanwhile; how it went is
 * the desk's to tell.
 * @return of this process's own: memory, and whether its part is safely closed */
haft_status haft_crew_work(haft_crew *crew, haft_error *error) HAFT_MUST_CHECK;

#endif
