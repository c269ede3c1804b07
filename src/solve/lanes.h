/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers side by side in a processor's lanes, private to the room. */
#ifndef HAFT_SOLVE_LANES_H
#define HAFT_SOLVE_LANES_H

/* As many as the innermost loops go through together. */
enum { LANES = 8 };

#endif
