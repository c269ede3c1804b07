/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A folder of parts and its contents. Private to this room. */
#ifndef HAFT_IO_PARTS_FOLDER_H
#define HAFT_IO_PARTS_FOLDER_H

#include "parts.h"

/* The folder's lock, exclusive to a run or shared by shards, and beginning of the name of each
 * shard's own lock. */
#define HAFT_PARTS_LOCK "lock"

enum { HAFT_PART_NAME_CAPACITY = 64 };

/* Where the payload of a realization is; size 0: not found. */
typedef struct haft_parts_entry {
    size_t file;
    uint64_t offset, size;
    char digest[HAFT_PART_DIGITS];
} haft_parts_entry;

struct haft_parts {
    char *folder;
    size_t shard, shards; /* both 0: the whole run */
    int lock, shard_lock; /* -1: not locked */
    size_t files;
    char **file; /* names of the parts, malloc()ed */
    size_t realizations, found, repeated;
    haft_parts_entry *entry; /* realizations */
};

/* FOLDER/name; to be freed with haft_memory_free(). */
char *haft_parts_join(const haft_parts *parts, const char *name, haft_error *error) HAFT_MUST_CHECK;

/* The beginning of the names of a shard's parts: "part-2of3-"; "part-" for the whole run. */
void haft_parts_prefix(char prefix[HAFT_PART_NAME_CAPACITY], size_t shard, size_t shards);

/* Reads the names of the parts; for a shard only those of its own. */
haft_status haft_parts_list(haft_parts *parts, haft_error *error) HAFT_MUST_CHECK;

/* Removes the parts and locks in a folder of parts that no process uses, then the folder if it is
 * empty. Other files stay. */
void haft_parts_discard(const char *folder);

/* Frees the lists of parts and realizations. */
void haft_parts_forget(haft_parts *parts);

#endif
