/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares a run with another one, the reference. */
#ifndef HAFT_TOOLS_AGAINST_H
#define HAFT_TOOLS_AGAINST_H

#include "terminal.h"

/* Prints how the crack lengths of CASE differ from the reference's. @return the exit code */
int tell_against(const haft_case *c, const char *case_folder, const char *reference, bool json,
                 terminal *t);

/* Writes what a figure of the two runs needs into `folder`: reference_summary.csv and
 * reference_convergence.csv. The reference's title goes into `title`. */
haft_status write_against(char title[HAFT_TEXT_CAPACITY], const char *reference, const char *folder,
                          haft_error *error);

#endif
