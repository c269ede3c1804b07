/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How a text stands in a file. Private to this room. */
#ifndef HAFT_IO_TEXT_H
#define HAFT_IO_TEXT_H

#include "haft/io.h"

/* Whether bytes begin with a byte order mark, of UTF-8 or UTF-16. */
bool haft_text_is_marked(const char *bytes, size_t size);

/* Brings a file's bytes, a 0 behind them, to one form: no byte order mark, UTF-8 instead of UTF-16
 * with one, and a line end of LF or CR LF where a CR alone ended a line. Bytes without a mark are
 * kept whatever they are. On failure the bytes stay the caller's. */
haft_status haft_text_decode(char **bytes, size_t *size, const char *path, haft_error *error);

#endif
