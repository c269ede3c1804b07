/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text files read whole, so that no reader can take a part of one for all of it: neither a line
 * longer than some buffer nor a read that fails midway goes unnoticed. */
#include "haft/io.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static haft_status check_kind(int descriptor, const char *path, size_t most, size_t *size,
                              haft_error *error) {
    struct stat facts;
    if (fstat(descriptor, &facts) != 0) {
        return haft_error_set(error, HAFT_ERROR_IO, "%s: cannot be read: %s", path,
                              strerror(errno));
    }
    if (!S_ISREG(facts.st_mode)) {
        return haft_error_set(error, HAFT_ERROR_IO, "%s: is no regular file", path);
    }
    if ((size_t)facts.st_size > most) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "%s: is longer than %zu MiB", path,
                              most >> 20);
    }
    *size = (size_t)facts.st_size;
    return HAFT_OK;
}

/* A byte more than the file is said to have is asked for: a file that grows meanwhile is told. */
static haft_status read_bytes(char *bytes, size_t size, int descriptor, const char *path,
                              haft_error *error) {
    size_t held = 0;
    while (held < size + 1) {
        ssize_t n = read(descriptor, bytes + held, size + 1 - held);
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
        held += (size_t)n;
    }
    if (held != size) {
        return haft_error_set(error, HAFT_ERROR_IO,
                              "%s: has %zu bytes but %s could be read; was it changed meanwhile?",
                              path, size, held < size ? "fewer" : "more");
    }
    bytes[size] = '\0';
    return HAFT_OK;
}

static haft_status check_text(const char *bytes, size_t size, const char *path, haft_error *error) {
    size_t line = 1;
    const char *zero = memchr(bytes, '\0', size);
    if (zero == NULL) {
        return HAFT_OK;
    }
    for (const char *at = bytes; at < zero; at++) {
        line += *at == '\n';
    }
    return haft_error_set(error, HAFT_ERROR_INPUT,
                          "%s:%zu: holds a NUL character; give a text file (UTF-8, not UTF-16)",
                          path, line);
}

haft_status haft_text_read(char **text, size_t *size, const char *path, size_t most,
                           haft_error *error) {
    *text = NULL;
    *size = 0;
    int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0) {
        return haft_error_set(error, HAFT_ERROR_IO, "%s: cannot be read: %s", path,
                              strerror(errno));
    }
    char *bytes = NULL;
    haft_status status = check_kind(descriptor, path, most, size, error);
    if (status == HAFT_OK) {
        bytes = haft_memory_alloc(*size + 1, 1, error);
        status =
            bytes == NULL ? HAFT_ERROR_MEMORY : read_bytes(bytes, *size, descriptor, path, error);
    }
    close(descriptor);
    if (status == HAFT_OK) {
        status = check_text(bytes, *size, path, error);
    }
    if (status != HAFT_OK) {
        haft_memory_free(bytes);
        return status;
    }
    *text = bytes;
    return HAFT_OK;
}

char *haft_text_line(char **rest) {
    char *line = *rest;
    if (line == NULL || *line == '\0') {
        return NULL;
    }
    size_t n = strcspn(line, "\n");
    *rest = line[n] == '\0' ? line + n : line + n + 1;
    line[n] = '\0';
    if (n > 0 && line[n - 1] == '\r') {
        line[n - 1] = '\0';
    }
    return line;
}
