/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef HAFT_TOOLS_LAWS_REPORT_H
#define HAFT_TOOLS_LAWS_REPORT_H

#include "haft/study.h"

/* Prints the statistics of a set of laws, beside the case's references, and the errors of its
 * model. */
void print_laws(const haft_laws *laws, const haft_case *c);

/* Studies how the model depends on its order and its vectors, and prints the results. */
haft_status print_study(const haft_laws *laws, const haft_case *c, haft_error *error);

#endif
