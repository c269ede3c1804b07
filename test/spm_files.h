/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nanoscope files of any header, written by the tests themselves. */
#ifndef HAFT_TEST_SPM_FILES_H
#define HAFT_TEST_SPM_FILES_H

#include "map_files.h"

enum { SPM_HEADER = 4096, SPM_CHANNELS = 3 };

/* A channel: its list's lines, each ended by "\n", and its pixels. */
typedef struct spm_channel {
    const char *title; /* NULL: "\*Ciao image list" */
    const char *lines;
    size_t rows, columns, bytes; /* 0 bytes: 2 */
    long factor;                 /* of map_raw(); 0: no such channel */
} spm_channel;

typedef struct spm_file {
    const char *first; /* NULL: "\*File list" */
    const char *scan;  /* lines of the scan list */
    spm_channel channel[SPM_CHANNELS];
} spm_file;

static inline char *spm_put(char *at, const char *lines) {
    for (; *lines != '\0'; lines++) {
        if (*lines == '\n') {
            *at++ = '\r';
        }
        *at++ = *lines;
    }
    return at;
}

/* Bytes of the file, to be freed with free(). Offsets and lengths are written in front of each
 * channel's lines. */
static inline char *spm_bytes(const spm_file *f, size_t *size) {
    size_t length[SPM_CHANNELS] = {0}, end = SPM_HEADER;
    for (int k = 0; k < SPM_CHANNELS; k++) {
        const spm_channel *c = &f->channel[k];
        length[k] = c->factor == 0 ? 0 : c->rows * c->columns * (c->bytes > 0 ? c->bytes : 2);
        end += length[k];
    }
    char *bytes = calloc(end, 1), *at = bytes, line[200];
    assert_non_null(bytes);
    at = spm_put(at, f->first != NULL ? f->first : "\\*File list\n");
    at = spm_put(at, "\\Version: 0x05310001\n\\Data length: 4096\n\\*Scanner list\n"
                     "\\@Sens. Zsens: V 10.00000 nm/V\n\\*Ciao scan list\n");
    at = spm_put(at, f->scan != NULL ? f->scan : "");
    size_t offset = SPM_HEADER;
    for (int k = 0; k < SPM_CHANNELS; k++) {
        const spm_channel *c = &f->channel[k];
        if (c->factor == 0) {
            continue;
        }
        at = spm_put(at, c->title != NULL ? c->title : "\\*Ciao image list\n");
        snprintf(line, sizeof line, "\\Data offset: %zu\n\\Data length: %zu\n", offset, length[k]);
        at = spm_put(at, line);
        at = spm_put(at, c->lines);
        size_t wide = c->bytes > 0 ? c->bytes : 2;
        for (size_t i = 0; i < c->rows; i++) {
            for (size_t j = 0; j < c->columns; j++) {
                unsigned long value = (unsigned long)(map_raw(i, j) * c->factor);
                char *out = bytes + offset + ((c->rows - 1 - i) * c->columns + j) * wide;
                for (size_t b = 0; b < wide; b++) {
                    out[b] = (char)(value >> (8 * b));
                }
            }
        }
        offset += length[k];
    }
    at = spm_put(at, "\\*File list end\n\x1a");
    assert_true(at < bytes + SPM_HEADER);
    *size = end;
    return bytes;
}

/* Replaces the first occurrence of a text in the header by one that is not longer; what follows it
 * in the header moves. */
static inline void spm_edit(char *bytes, const char *from, const char *to) {
    size_t n = strlen(from), m = strlen(to);
    char *at = strstr(bytes, from);
    assert_non_null(at);
    assert_true(m <= n);
    memcpy(at, to, m);
    memmove(at + m, at + n, (size_t)(bytes + SPM_HEADER - (at + n)));
    memset(bytes + SPM_HEADER - (n - m), 0, n - m);
}

#endif
