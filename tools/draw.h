/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Drawing a finished run. */
#ifndef HAFT_TOOLS_DRAW_H
#define HAFT_TOOLS_DRAW_H

#include "terminal.h"

/* Draws the figures of CASE into CASE/out/plots, the path being that of the realization asked for,
 * or of the first that left evidence if that is -1. @return the program's exit code */
int draw_case(const haft_case *c, const char *case_folder, long asked, terminal *t);

/* Draws the table of a sweep, CASE/out/sweep.csv, into CASE/out/plots; `greatest` of the values of
 * its first key chooses the axis' unit. @return the exit code */
int draw_sweep(const haft_case *c, double greatest, const char *case_folder, terminal *t);

/* Draws one script's figure from the CSV files in `folder`, under a title. */
haft_status draw_script(const char *name, const char *folder, const char *title,
                        const char *definitions, haft_error *error);

#endif
