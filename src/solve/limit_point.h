/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the load turns along a branch: a limit point, or fold. Private to the room. */
#ifndef HAFT_SOLVE_LIMIT_POINT_H
#define HAFT_SOLVE_LIMIT_POINT_H

#include "branch.h"

/* Given a step that ended in HAFT_STEP_FOLD, puts the fold into t->next and its null vector, scaled
 * by the parameter, into t->null; step->dtau, work and defect become those of the stretch up to the
 * fold. @return false if it could not be located. */
bool haft_limit_point_locate(haft_tracker *t, haft_step *step, int direction, double *defect);

#endif
