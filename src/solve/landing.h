/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a jump ends: gradient flow at constant load. Private to the room. */
#ifndef HAFT_SOLVE_LANDING_H
#define HAFT_SOLVE_LANDING_H

#include "tracker.h"

/* Follows M u' = -grad Pi at the load of `here` from here + a little of `away` until it rests in a
 * stable, certified equilibrium, which goes into `here`. With `away` NULL it starts from `here`
 * itself, which is no equilibrium; no steps are made if Newton's step from there is small. The gaps
 * of `here` are in t->gap_before.
 * @return HAFT_OUTCOME_STUCK when landed, else why not. */
haft_outcome haft_landing_follow(haft_tracker *t, const double *away, int *steps);

#endif
