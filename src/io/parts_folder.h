/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A folder of parts and what it holds. Private to this room. */
#ifndef HAFT_IO_PARTS_FOLDER_H
#define HAFT_IO_PARTS_FOLDER_H

#include "parts.h"

#define HAFT_PARTS_LOCK "lock"

/* Where the payload of a realization is; size 0: nowhere. */
typedef struct haft_parts_entry {
    size_t file;
    uint64_t offset, size;
    char digest[HAFT_PART_DIGITS];
} haft_parts_entry;

struct haft_parts {
    char *folder;
    int lock;
    size_t files;
    char **file; /* names of the parts, malloc()ed */
    size_t realizations, found;
    haft_parts_entry *entry; /* realizations */
};

/* FOLDER/name; to be freed with haft_memory_free(). */
char *haft_parts_join(const haft_parts *parts, const char *name, haft_error *error) HAFT_MUST_CHECK;

/* Reads the names of the parts. */
haft_status haft_parts_list(haft_parts *parts, haft_error *error) HAFT_MUST_CHECK;

/* Forgets what was listed and found. */
void haft_parts_forget(haft_parts *parts);

#endif
