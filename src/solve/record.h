/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Growing a path: points, jumps, states, and the running ledger. Private to the room. */
#ifndef HAFT_SOLVE_RECORD_H
#define HAFT_SOLVE_RECORD_H

#include "branch.h"

/* Sums from the start of the path [J]. */
typedef struct haft_ledger {
    double work, dissipated;
    double turnover;     /* sum of |work| */
    double energy_start; /* strain + contact at rest */
    double worst;        /* greatest |work - dissipated - energy gained| so far */
    double greatest;     /* greatest |strain energy| + |contact energy| so far */
} haft_ledger;

/* Enters t->here, certified, as an accepted point. */
haft_status haft_record_point(haft_path *path, haft_tracker *t, haft_ledger *ledger, int phase,
                              int jump, haft_error *error);

haft_status haft_record_jump(haft_path *path, const haft_jump *jump, haft_error *error);

/* The outcome's own arrays: final state and sums. */
haft_status haft_record_finish(haft_path *path, haft_tracker *t, const haft_ledger *ledger,
                               haft_error *error);

#endif
