/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finished runs beside each other. */
#ifndef HAFT_TOOLS_COMPARE_H
#define HAFT_TOOLS_COMPARE_H

#include "terminal.h"

/* Compares the runs in these case folders with the first of them; one that holds a sweep stands for
 * all its variants. Prints tables, and leaves them and a figure in `directory`, or in out/compare
 * of the first folder where that is NULL. @return the exit code */
int compare_cases(size_t folders, char *const *folder, const char *directory, terminal *t);

#endif
