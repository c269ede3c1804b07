/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Laws with a far field: their near part, and what it adds. Private to this room. */
#ifndef HAFT_LAW_FAR_H
#define HAFT_LAW_FAR_H

#include "haft/law.h"

/* A law's near part alone. */
static inline haft_law haft_law_near(const haft_law *law) {
    haft_law near = *law;
    near.far = NULL;
    return near;
}

/* Adds a far field at n gaps to what the near parts have there, of whose `zeros` first ones are
 * known to be nil. @return how many are, with it */
size_t haft_law_add_far(const haft_far_field *far, size_t n, const double *d,
                        const haft_law_values *out, size_t zeros);

#endif
