/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shards do not communicate, so missing realizations are noticed only when they are merged. */
#include "shards.h"

#include <stdio.h>

enum { NAMED = 12 }; /* most shards that a message lists */

bool haft_shard_has(haft_shard shard, size_t realization) {
    return shard.count == 0 || realization % shard.count == shard.index - 1;
}

void haft_shards_command(char command[HAFT_COMMAND_CAPACITY], haft_shard shard,
                         const haft_run_files *files) {
    if (shard.count == 0) {
        snprintf(command, HAFT_COMMAND_CAPACITY, "haft resume");
    } else {
        snprintf(command, HAFT_COMMAND_CAPACITY, "haft run %.300s --shard=%zu/%zu", files->folder,
                 shard.index, shard.count);
    }
}

/* The number of missing realizations of a shard. */
static size_t count_lacking(const haft_scheduler *scheduler, haft_shard shard) {
    size_t lacking = 0;
    for (size_t k = 0; k < scheduler->end; k++) {
        lacking += haft_shard_has(shard, k) && !scheduler->done[k];
    }
    return lacking;
}

/* "2", "2, 5 and 7", "1, 2, 3 and 17 more"; @return the number of incomplete shards */
static size_t list_lacking(char *text, size_t capacity, const haft_scheduler *scheduler,
                           size_t count) {
    size_t lacking = 0, total = 0, length = 0;
    for (size_t i = 1; i <= count; i++) {
        total += count_lacking(scheduler, (haft_shard){i, count}) > 0;
    }
    for (size_t i = 1; i <= count && lacking < total && length < capacity; i++) {
        if (count_lacking(scheduler, (haft_shard){i, count}) == 0) {
            continue;
        }
        bool rest = lacking + 1 == NAMED && total > NAMED;
        const char *before = lacking == 0 ? "" : lacking + 1 == total || rest ? " and " : ", ";
        length += (size_t)snprintf(text + length, capacity - length, rest ? "%s%zu more" : "%s%zu",
                                   before, rest ? total - lacking : i);
        lacking = rest ? total : lacking + 1;
    }
    return total;
}

haft_status haft_shards_check(const haft_scheduler *scheduler, const haft_parts *parts,
                              const haft_run_files *files, haft_error *error) {
    size_t count = haft_parts_split(parts);
    char list[200] = "", who[260];
    if (scheduler->count == scheduler->end) {
        return HAFT_OK;
    }
    if (count == 0) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "%s: %zu of %zu realizations are there; do the others by `haft resume "
            "%s`",
            files->parts, scheduler->count, scheduler->end, files->folder);
    }
    size_t lacking = list_lacking(list, sizeof list, scheduler, count);
    snprintf(who, sizeof who, lacking == 1 ? "shard %s lacks the" : "shards %s lack the", list);
    return haft_error_set(error, HAFT_ERROR_INPUT,
                          "%s: %zu of %zu realizations are there; %s others: do %s by `haft run %s "
                          "--shard=%s/%zu`, or all that lacks by `haft resume %s`",
                          files->parts, scheduler->count, scheduler->end, who,
                          lacking == 1 ? "it" : "each of them", files->folder,
                          lacking == 1 ? list : "I", count, files->folder);
}

haft_status haft_shards_go_on(const haft_progress *p, haft_error *error) {
    bool stop = p != NULL && p->stop != NULL && p->stop(p->user);
    return stop ? haft_error_set(error, HAFT_ERROR_INTERRUPTED,
                                 "stopped while the results were being made; the parts are all "
                                 "there: give `haft merge` again")
                : HAFT_OK;
}
