/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reports a finished run on one page, and measures how much each approximation contributes to its
 * mean. */
#ifndef HAFT_TOOLS_REPORT_H
#define HAFT_TOOLS_REPORT_H

#include "terminal.h"

/* Draws the figures of CASE and writes CASE/out/report.html with them. draw_case() describes which
 * beam is shown. @return the exit code */
int report_case(const haft_case *c, const char *folder, long asked, terminal *t);

/* Measures the error budget of a case with `beams` beams for each term, prints it and saves it in
 * CASE/out/budget.csv. @return the exit code */
int budget_case(const haft_case *c, const char *folder, size_t beams, terminal *t);

#endif
