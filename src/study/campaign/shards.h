/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Messages about the shards of a run. Private to this room. */
#ifndef HAFT_STUDY_SHARDS_H
#define HAFT_STUDY_SHARDS_H

#include "scheduler.h"

enum { HAFT_COMMAND_CAPACITY = 400 };

/* The command that continues a stopped run. */
void haft_shards_command(char command[HAFT_COMMAND_CAPACITY], haft_shard shard,
                         const haft_run_files *files);

/* Refuses to merge if realizations are missing: the message names their shards and the command
 * for them. */
haft_status haft_shards_check(const haft_scheduler *scheduler, const haft_parts *parts,
                              const haft_run_files *files, haft_error *error) HAFT_MUST_CHECK;

/* Asks whether to stop; a merge, which follows no beams, calls it before each realization. */
haft_status haft_shards_go_on(const haft_progress *progress, haft_error *error) HAFT_MUST_CHECK;

#endif
