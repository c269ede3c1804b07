/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is said of the shards of a run. Private to this room. */
#ifndef HAFT_STUDY_SHARDS_H
#define HAFT_STUDY_SHARDS_H

#include "scheduler.h"

enum { HAFT_COMMAND_CAPACITY = 400 };

/* The command that goes on with a run that was stopped. */
void haft_shards_command(char command[HAFT_COMMAND_CAPACITY], haft_shard shard,
                         const haft_run_files *files);

/* Refuses to go on where the parts lack realizations: says whose they are, and what does them. */
haft_status haft_shards_check(const haft_scheduler *scheduler, const haft_parts *parts,
                              const haft_run_files *files, haft_error *error) HAFT_MUST_CHECK;

/* A merge follows no beams, which ask whether to stop, so it asks here before each that it takes.
 */
haft_status haft_shards_go_on(const haft_progress *progress, haft_error *error) HAFT_MUST_CHECK;

#endif
