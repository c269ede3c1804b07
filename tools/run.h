/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef HAFT_TOOLS_RUN_H
#define HAFT_TOOLS_RUN_H

#include "terminal.h"

/* Runs the case on all ranks; its files go into FOLDER/out. Rank 0 writes them and knows the
 * outcome. If some beams could not be followed to the end, the run is complete, all is saved, and
 * an error is returned nevertheless. Free *summary [realizations] with haft_memory_free().
 * @param[in] shard {0}: the whole run */
haft_status run_one(haft_summary **summary, bool *complete, const haft_case *c, const char *folder,
                    haft_run_mode mode, haft_shard shard, terminal *t, haft_error *error);

/* Runs the case and prints its summary; a shard has none. @return the exit code */
int run_case(const haft_case *c, const char *folder, haft_run_mode mode, haft_shard shard,
             bool json, terminal *t);

#endif
