/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The hands of a run: threads that take realizations from the desk. Private to this room. */
#ifndef HAFT_STUDY_CREW_H
#define HAFT_STUDY_CREW_H

#include "desk.h"

/* What all hands of a process share. */
typedef struct haft_crew {
    const haft_case *c;
    const haft_laws *laws;
    const haft_model *model;
    const char *folder; /* of the parts */
    const char *laws_digest;
    haft_desk *desk;
    haft_part *part; /* begun with the first realization done */
    omp_lock_t lock; /* of the part */
} haft_crew;

/* Does all that the desk hands out; how it went is the desk's to tell. */
void haft_crew_work(haft_crew *crew);

#endif
