/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Work in a child process, where a crash, an endless loop or a heap that is overwritten does no
 * harm to the caller. Private to this room. */
#ifndef HAFT_IO_CHILD_H
#define HAFT_IO_CHILD_H

#include "haft/base.h"

/* What a child works on. */
typedef struct haft_child_input {
    const char *path, *remedy; /* for messages: the file, and what to do about a damaged one */
    size_t bytes;              /* the limits on memory and time rise with them */
    const void *context;       /* for the work */
} haft_child_input;

/* Makes `*size` bytes from the context, allocated by haft_memory_alloc(). It runs in a copy of the
 * process with one thread: it may only use memory and files, and starts no threads. */
typedef haft_status haft_child_work(const void *context, void **bytes, size_t *size,
                                    haft_error *error);

/* Runs `work` in a child process and takes over the bytes that it made.
 *  [in]  work, input     as above
 *  [out] bytes, size     freed with haft_memory_free(); NULL and 0 after a failure
 *  [out] error           the child's own message, or how the child died
 * Returns the child's own status; HAFT_ERROR_INPUT if it died or ran into a limit;
 * HAFT_ERROR_INTERRUPTED if a signal of the user ended it; HAFT_ERROR_IO if no child can be made.
 * The child ends with its parent. */
haft_status haft_child_run(void **bytes, size_t *size, haft_child_work *work,
                           const haft_child_input *input, haft_error *error) HAFT_MUST_CHECK;

/* Within the work: allows as much memory more, and the time to fill it. */
void haft_child_allow(size_t bytes);

#endif
