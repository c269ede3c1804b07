/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Errors are values: the caller owns one haft_error, every failing function writes one message. */
#include "haft/base.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static void mark_cut(haft_error *error, int length) {
    if (length >= HAFT_ERROR_CAPACITY) {
        memcpy(error->message + HAFT_ERROR_CAPACITY - 4, "...", 4);
    }
}

haft_status haft_error_set(haft_error *error, haft_status status, const char *format, ...) {
    if (error != NULL) {
        va_list arguments;
        va_start(arguments, format);
        int length = vsnprintf(error->message, sizeof error->message, format, arguments);
        va_end(arguments);
        mark_cut(error, length);
        error->status = status;
    }
    return status;
}

void haft_error_prefix(haft_error *error, const char *format, ...) {
    if (error == NULL) {
        return;
    }
    char old[HAFT_ERROR_CAPACITY];
    memcpy(old, error->message, sizeof old);
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(error->message, sizeof error->message, format, arguments);
    va_end(arguments);
    if (length >= 0 && length < HAFT_ERROR_CAPACITY) {
        size_t room = sizeof error->message - (size_t)length;
        length += snprintf(error->message + length, room, "%s", old);
    }
    mark_cut(error, length);
}

const char *haft_status_name(haft_status status) {
    switch (status) {
    case HAFT_OK:
        return "ok";
    case HAFT_ERROR_MEMORY:
        return "memory";
    case HAFT_ERROR_ARGUMENT:
        return "argument";
    case HAFT_ERROR_INPUT:
        return "input";
    case HAFT_ERROR_IO:
        return "io";
    case HAFT_ERROR_NUMERIC:
        return "numeric";
    case HAFT_ERROR_LIBRARY:
        return "library";
    case HAFT_ERROR_EXISTS:
        return "exists";
    case HAFT_ERROR_INTERRUPTED:
        return "interrupted";
    }
    return "unknown";
}
