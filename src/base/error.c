/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Errors are values: the caller owns one haft_error, and every failing function writes one message.
 * All messages are made here, so text quoted from files and users is made safe to print here. The
 * only line breaks in a message are those that haft_error_add() puts between its lines. */
#include "haft/base.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Ends a message that did not fit with "...", without an incomplete character before it. */
static void mark_cut(char message[HAFT_ERROR_CAPACITY]) {
    size_t end = strlen(message);
    end = end < HAFT_ERROR_CAPACITY - 4 ? end : HAFT_ERROR_CAPACITY - 4;
    while (end > 0 && ((unsigned char)message[end] & 0xc0) == 0x80) {
        end--;
    }
    memcpy(message + end, "...", 4);
}

/* Formats text and makes it safe to print. @return false if it had to be cut */
static bool write_safe(char *out, size_t capacity, const char *format, va_list arguments)
    HAFT_PRINTF(3, 0);
static bool write_safe(char *out, size_t capacity, const char *format, va_list arguments) {
    char raw[HAFT_ERROR_CAPACITY];
    int length = vsnprintf(raw, sizeof raw, format, arguments);
    size_t size = length < 0 ? 0 : strlen(raw);
    return haft_text_quote(out, capacity, raw, size) && (size_t)length == size;
}

haft_status haft_error_set(haft_error *error, haft_status status, const char *format, ...) {
    if (error != NULL) {
        va_list arguments;
        va_start(arguments, format);
        if (!write_safe(error->message, sizeof error->message, format, arguments)) {
            mark_cut(error->message);
        }
        va_end(arguments);
        error->status = status;
    }
    return status;
}

bool haft_error_add(haft_error *error, size_t spare, const char *format, ...) {
    size_t used = error == NULL ? HAFT_ERROR_CAPACITY : strlen(error->message);
    if (used + 2 + spare > HAFT_ERROR_CAPACITY) {
        return false;
    }
    va_list arguments;
    va_start(arguments, format);
    bool fits = write_safe(error->message + used + 1, HAFT_ERROR_CAPACITY - used - 1 - spare,
                           format, arguments);
    va_end(arguments);
    error->message[used] = fits ? '\n' : '\0';
    return fits;
}

void haft_error_prefix(haft_error *error, const char *format, ...) {
    if (error == NULL) {
        return;
    }
    char old[HAFT_ERROR_CAPACITY];
    memcpy(old, error->message, sizeof old);
    va_list arguments;
    va_start(arguments, format);
    bool fits = write_safe(error->message, sizeof error->message, format, arguments);
    va_end(arguments);
    size_t used = strlen(error->message), room = sizeof error->message - used;
    if (fits) {
        fits = snprintf(error->message + used, room, "%s", old) < (int)room;
    }
    if (!fits) {
        mark_cut(error->message);
    }
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
