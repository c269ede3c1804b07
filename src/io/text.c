/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text files read whole, so that no reader can take a part of one for all of it: neither a line
 * longer than some buffer nor a read that fails midway goes unnoticed. */
#include "haft/io.h"

#include <string.h>

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
    haft_status status = haft_file_read(text, size, path, most, error);
    if (status == HAFT_OK) {
        status = check_text(*text, *size, path, error);
    }
    if (status != HAFT_OK) {
        haft_memory_free(*text);
        *text = NULL;
    }
    return status;
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
