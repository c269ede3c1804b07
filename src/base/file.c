/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reading of files, regular ones only: opening a FIFO would wait for a writer, and a device may
 * have no end or may act when it is read. */
#include "haft/base.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

haft_status haft_path_join(char *path, size_t capacity, const char *folder, const char *name,
                           haft_error *error) {
    int length = snprintf(path, capacity, "%s/%s", folder, name);
    return length >= 0 && (size_t)length < capacity
               ? HAFT_OK
               : haft_error_set(error, HAFT_ERROR_IO, "the path of %s in %s is too long", name,
                                folder);
}

haft_status haft_file_open(int *out, size_t *size, const char *path, haft_error *error) {
    struct stat facts;
    *out = -1;
    int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (descriptor < 0 || fstat(descriptor, &facts) != 0) {
        haft_status status =
            haft_error_set(error, HAFT_ERROR_IO, "%s: cannot be opened: %s", path, strerror(errno));
        if (descriptor >= 0) {
            close(descriptor);
        }
        return status;
    }
    if (!S_ISREG(facts.st_mode)) {
        close(descriptor);
        return haft_error_set(error, HAFT_ERROR_IO, "%s: is %s; give a regular file", path,
                              S_ISDIR(facts.st_mode)    ? "a directory"
                              : S_ISFIFO(facts.st_mode) ? "a pipe"
                                                        : "a device or a socket");
    }
    *out = descriptor;
    if (size != NULL) {
        *size = (size_t)facts.st_size;
    }
    return HAFT_OK;
}

/* Reads `size` bytes, resuming after interruptions, and checks that there are no more. */
static haft_status read_all(char *bytes, size_t size, int descriptor, const char *path,
                            haft_error *error) {
    size_t done = 0;
    while (done <= size) { /* the buffer has room for one more byte */
        ssize_t n = read(descriptor, bytes + done, size + 1 - done);
        if (n < 0 && errno == EINTR) {
            continue;
        }
        if (n < 0) {
            return haft_error_set(error, HAFT_ERROR_IO, "%s: cannot be read: %s", path,
                                  strerror(errno));
        }
        if (n == 0) {
            break;
        }
        done += (size_t)n;
    }
    bytes[size] = '\0';
    return done == size
               ? HAFT_OK
               : haft_error_set(error, HAFT_ERROR_IO, "%s: cannot be read: it was %s meanwhile",
                                path, done < size ? "cut short" : "added to");
}

haft_status haft_file_read(char **out, size_t *size, const char *path, size_t most,
                           haft_error *error) {
    int descriptor = -1;
    *out = NULL;
    *size = 0;
    haft_status status = haft_file_open(&descriptor, size, path, error);
    if (status != HAFT_OK) {
        return status;
    }
    if (*size > most) {
        bool mega = most >= (size_t)1 << 20;
        status = haft_error_set(error, HAFT_ERROR_INPUT, "%s: is larger than %zu %s, the most here",
                                path, most >> (mega ? 20 : 10), mega ? "MiB" : "KiB");
    } else {
        *out = haft_memory_alloc(*size + 1, 1, error);
        status = *out == NULL ? HAFT_ERROR_MEMORY : read_all(*out, *size, descriptor, path, error);
    }
    close(descriptor);
    if (status != HAFT_OK) {
        haft_memory_free(*out);
        *out = NULL;
    }
    return status;
}
