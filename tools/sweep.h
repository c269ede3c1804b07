/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs a sweep: its variants are cases of their own under CASE/out, run one after another. */
#ifndef HAFT_TOOLS_SWEEP_H
#define HAFT_TOOLS_SWEEP_H

#include "terminal.h"

/* Reads and checks every variant. A case without a sweep has one variant. */
haft_status check_sweep(const haft_case *c, const char *folder, haft_error *error);

/* Runs the variants, each as a case in CASE/out/LABEL, and writes CASE/out/sweep.csv. A variant
 * uses the laws of an earlier one if their inputs are the same. @return the exit code */
int run_sweep(const haft_case *c, const char *folder, haft_run_mode mode, bool json, terminal *t);

/* Prints the table of a finished sweep, or writes it again and draws it. */
int tell_sweep(const haft_case *c, const char *folder, bool json, terminal *t);
int plot_sweep(const haft_case *c, const char *folder, terminal *t);

#endif
