/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares finished runs. */
#ifndef HAFT_TOOLS_COMPARE_H
#define HAFT_TOOLS_COMPARE_H

#include "terminal.h"

/* Compares the runs in these case folders with the first of them. A folder with a sweep stands for
 * all its variants. Prints tables, and writes them and a figure into `directory`; if that is NULL,
 * into out/compare of the first folder. @return the exit code */
int compare_cases(size_t folders, char *const *folder, const char *directory, terminal *t);

#endif
