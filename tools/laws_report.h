/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef HAFT_TOOLS_LAWS_REPORT_H
#define HAFT_TOOLS_LAWS_REPORT_H

#include "haft/study.h"

/* Prints what a set of laws is like, beside the case's references, and its model's errors. */
void print_laws(const haft_laws *laws, const haft_case *c);

/* Studies the model in its order and in its vectors, and prints what comes of it. */
haft_status print_study(const haft_laws *laws, const haft_case *c, haft_error *error);

#endif
