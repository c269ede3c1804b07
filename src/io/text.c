/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads whole text files, so that no reader takes a part of a file for all of it: a line longer
 * than a buffer, or a read that fails midway, cannot go unnoticed. Byte order marks, UTF-16 and
 * line ends of CR alone are handled here for all readers. */
#include "text.h"

#include <string.h>

/* ---- encodings ---- */

typedef enum encoding { PLAIN, UTF_8, UTF_16_LITTLE, UTF_16_BIG } encoding;

static encoding find_encoding(const char *bytes, size_t size) {
    return size >= 3 && memcmp(bytes, "\xef\xbb\xbf", 3) == 0 ? UTF_8
           : size >= 2 && memcmp(bytes, "\xff\xfe", 2) == 0   ? UTF_16_LITTLE
           : size >= 2 && memcmp(bytes, "\xfe\xff", 2) == 0   ? UTF_16_BIG
                                                              : PLAIN;
}

bool haft_text_is_marked(const char *bytes, size_t size) {
    return find_encoding(bytes, size) != PLAIN;
}

static uint32_t unit_at(const char *bytes, size_t i, encoding e) {
    uint32_t first = (unsigned char)bytes[2 * i], second = (unsigned char)bytes[2 * i + 1];
    return e == UTF_16_BIG ? first << 8 | second : second << 8 | first;
}

/* Writes one character as UTF-8. @return its number of bytes */
static size_t put_character(char *out, uint32_t code) {
    if (code < 0x80) {
        out[0] = (char)code;
        return 1;
    }
    size_t n = code < 0x800 ? 2 : code < 0x10000 ? 3 : 4;
    static const unsigned char lead[] = {0, 0, 0xc0, 0xe0, 0xf0};
    for (size_t k = n; k-- > 1; code >>= 6) {
        out[k] = (char)(0x80 | (code & 0x3f));
    }
    out[0] = (char)(lead[n] | code);
    return n;
}

/* Converts UTF-16 after its mark to UTF-8. @return the line of the first error, 0 if there is none
 */
static size_t convert(char *out, size_t *size, const char *bytes, size_t units, encoding e) {
    size_t line = 1, used = 0;
    for (size_t i = 1; i < units; i++) {
        uint32_t code = unit_at(bytes, i, e);
        if (code >= 0xd800 && code < 0xdc00 && i + 1 < units) {
            uint32_t low = unit_at(bytes, ++i, e);
            code = low >= 0xdc00 && low < 0xe000 ? 0x10000 + ((code - 0xd800) << 10) + low - 0xdc00
                                                 : 0;
        }
        if (code == 0 || (code >= 0xd800 && code < 0xe000)) {
            return line;
        }
        line += code == '\n';
        used += put_character(out + used, code);
    }
    out[used] = '\0';
    *size = used;
    return 0;
}

haft_status haft_text_decode(char **bytes, size_t *size, const char *path, haft_error *error) {
    encoding e = find_encoding(*bytes, *size);
    if (e == UTF_8) {
        *size -= 3;
        memmove(*bytes, *bytes + 3, *size + 1);
    } else if (e != PLAIN) {
        size_t units = *size / 2, fault = 0;
        char *text = haft_memory_alloc(3 * units + 1, 1, error);
        if (text == NULL) {
            return HAFT_ERROR_MEMORY;
        }
        if (*size % 2 != 0 || (fault = convert(text, size, *bytes, units, e)) > 0) {
            haft_memory_free(text);
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "%s:%zu: is no valid UTF-16, which its first bytes say that it "
                                  "is; save it as UTF-8",
                                  path, fault > 0 ? fault : 1);
        }
        haft_memory_free(*bytes);
        *bytes = text;
    }
    for (char *at = *bytes; (at = memchr(at, '\r', (size_t)(*bytes + *size - at))) != NULL; at++) {
        *at = at[1] == '\n' ? '\r' : '\n';
    }
    return HAFT_OK;
}

/* ---- whole files ---- */

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
                          "%s:%zu: holds a NUL character; give a text file, such as UTF-8", path,
                          line);
}

haft_status haft_text_read(char **text, size_t *size, const char *path, size_t most,
                           haft_error *error) {
    haft_status status = haft_file_read(text, size, path, most, error);
    HAFT_THEN(status, haft_text_decode(text, size, path, error));
    HAFT_THEN(status, check_text(*text, *size, path, error));
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
