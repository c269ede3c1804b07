/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A beam that feels its laws at rest begins its path with a jump: what the tests of the solver
 * share about it. */
#ifndef HAFT_TEST_FROM_REST_H
#define HAFT_TEST_FROM_REST_H

#include "haft/solve.h"

/* How many jumps a path begins with before any load acts: 0 or 1. */
static inline size_t jumps_from_rest(const haft_path *path) {
    return path->jumps > 0 && path->jump[0].departure == HAFT_DEPARTURE_REST;
}

#endif
