/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef HAFT_TOOLS_RUN_H
#define HAFT_TOOLS_RUN_H

#include "terminal.h"

/* Runs the case whose files go into FOLDER/out, on all ranks; rank 0 writes and knows the outcome.
 * A run may be complete, all being saved, and a failure told all the same: some beams could not be
 * followed to the end. *summary [realizations] is to be freed with haft_memory_free().
 * @param[in] shard {0}: the whole run */
haft_status run_one(haft_summary **summary, bool *complete, const haft_case *c, const char *folder,
                    haft_run_mode mode, haft_shard shard, terminal *t, haft_error *error);

/* The same, said to people; of a shard there is no summary. @return the exit code. */
int run_case(const haft_case *c, const char *folder, haft_run_mode mode, haft_shard shard,
             bool json, terminal *t);

#endif
