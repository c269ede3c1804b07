/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Newton's method on the bordered system, by KINSOL. Private to the room. */
#ifndef HAFT_SOLVE_CORRECTOR_H
#define HAFT_SOLVE_CORRECTOR_H

#include "tracker.h"

haft_status haft_corrector_create(haft_corrector **out, haft_tracker *t, const haft_model *model,
                                  haft_error *error);
void haft_corrector_destroy(haft_corrector **corrector);

/* Solves for the first n unknowns alone from now on. @return false, and nothing changes, where the
 * linear solver cannot. */
bool haft_corrector_use_leading(haft_corrector *corrector, size_t n);

/* Solves grad Pi = 0 with the parameter at `value`, from the state given; leaves the Hessian at the
 * solution in t->hessian. @return false if it did not converge. */
bool haft_corrector_solve(haft_tracker *t, haft_parameter parameter, double value,
                          haft_state *state);

#endif
