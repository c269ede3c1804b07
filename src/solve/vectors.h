/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vectors of SUNDIALS' serial kind, private to the room, whose operations that KINSOL asks for are
 * made side by side in a processor's lanes. */
#ifndef HAFT_SOLVE_VECTORS_H
#define HAFT_SOLVE_VECTORS_H

#include "haft/base.h"

#include <nvector/nvector_serial.h>

/* n numbers; NULL if there is no memory. Vectors cloned from it have its operations. */
N_Vector haft_vector_create(size_t n, SUNContext context);

#endif
