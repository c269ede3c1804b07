/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Telling a finished run on one page, and what its mean owes to each approximation. */
#ifndef HAFT_TOOLS_REPORT_H
#define HAFT_TOOLS_REPORT_H

#include "terminal.h"

/* Writes CASE/out/report.html, after drawing the figures in it; the beam shown is as draw_case()
 * chooses it. @return the exit code */
int report_case(const haft_case *c, const char *folder, long asked, terminal *t);

/* Measures the error budget of a case with so many beams a term, prints it and keeps it in
 * CASE/out/budget.csv. @return the exit code */
int budget_case(const haft_case *c, const char *folder, size_t beams, terminal *t);

#endif
