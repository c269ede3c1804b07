/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers side by side in a processor's lanes, private to the room. */
#ifndef HAFT_SOLVE_LANES_H
#define HAFT_SOLVE_LANES_H

#include <stdint.h>

/* As many as are gone through together; and what comparing them gives: all bits or none. */
enum { LANES = 8 };
typedef double octet __attribute__((vector_size(64), aligned(8), may_alias));
typedef int64_t octet_bits __attribute__((vector_size(64), aligned(8), may_alias));

#endif
