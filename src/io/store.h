/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files that are written whole or not at all. Private to this room. */
#ifndef HAFT_IO_STORE_H
#define HAFT_IO_STORE_H

#include "haft/base.h"

/* A file to be stored as `path`: nothing is visible there before it is committed. */
typedef struct haft_store {
    int descriptor;
    bool overwrite, named; /* named: the temporary file has its name */
    char *path, *temporary;
} haft_store;

/* Makes the name of this process's temporary file or folder of `path`; `number` distinguishes
 * several. haft_io_drop_stale() recognises it. It has at most 64 characters more than the path. */
void haft_store_name(char *name, size_t capacity, const char *path, int number);

/* Whether such a name, `prefix` and numbers, is of a process that no longer runs. */
bool haft_store_is_stale(const char *name, const char *prefix);

/* Makes the temporary file in the folder of `path`, so that a folder that is not writable is
 * reported at once. Returns HAFT_ERROR_EXISTS if `path` exists and is not to be overwritten. */
haft_status haft_store_open(haft_store *store, const char *path, bool overwrite,
                            haft_error *error) HAFT_MUST_CHECK;

/* Appends bytes. */
haft_status haft_store_write(haft_store *store, const void *data, size_t size,
                             haft_error *error) HAFT_MUST_CHECK;

/* Flushes to the disk and renames; closes the store in any case. */
haft_status haft_store_commit(haft_store *store, haft_error *error) HAFT_MUST_CHECK;

/* Discards the temporary file; a closed store is allowed. */
void haft_store_abandon(haft_store *store);

/* Writes a whole file in one call, over an old one: open, write, commit; a failure changes nothing.
 */
haft_status haft_store_put(const char *path, const void *data, size_t size,
                           haft_error *error) HAFT_MUST_CHECK;

#endif
