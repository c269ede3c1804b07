/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The encoding of text files. Private to this room. */
#ifndef HAFT_IO_TEXT_H
#define HAFT_IO_TEXT_H

#include "haft/io.h"

/* Whether bytes begin with a byte order mark, of UTF-8 or UTF-16. */
bool haft_text_is_marked(const char *bytes, size_t size);

/* Converts a file's bytes, followed by a 0, to one form: no byte order mark, UTF-8 instead of
 * UTF-16 with such a mark, and lines that end in LF or CR LF instead of CR alone. Without a mark
 * the encoding is not changed. On failure the caller still owns the bytes. */
haft_status haft_text_decode(char **bytes, size_t *size, const char *path, haft_error *error);

#endif
