/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Work in a child process, so that a crash, an endless loop or a corrupted heap does not harm the
 * caller. Private to this room. */
#ifndef HAFT_IO_CHILD_H
#define HAFT_IO_CHILD_H

#include "haft/base.h"

/* The input of a child. */
typedef struct haft_child_input {
    const char *path, *remedy; /* for messages: the file, and what to do about a damaged one */
    size_t bytes;              /* size of the input; the limits on memory and time grow with it */
    const void *context;       /* passed to the work */
} haft_child_input;

/* Makes `*size` bytes from the context, allocated by haft_memory_alloc(). It runs in a copy of the
 * process with one thread: it may only use memory and files, and must not start threads. */
typedef haft_status haft_child_work(const void *context, void **bytes, size_t *size,
                                    haft_error *error);

/* Runs `work` in a child process and returns the bytes that it made.
 * [in] work, input as above
 * [out] bytes, size freed with haft_memory_free(); NULL and 0 after a failure
 * [out] error the child's own message, or how the child died Returns the child's own status;
 * HAFT_ERROR_INPUT if it died or reached a limit; HAFT_ERROR_INTERRUPTED if a signal from the user
 * ended it; HAFT_ERROR_IO if no child can be started. The child ends with its parent. */
haft_status haft_child_run(void **bytes, size_t *size, haft_child_work *work,
                           const haft_child_input *input, haft_error *error) HAFT_MUST_CHECK;

/* To be called by the work: raises its limits by this much memory and the time to fill it. */
void haft_child_allow(size_t bytes);

#endif
