/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads quantities from the options of haft-laws inspect. */
#ifndef HAFT_TOOLS_INSPECT_WORDS_H
#define HAFT_TOOLS_INSPECT_WORDS_H

#include "haft/base.h"

/* Reads a positive length. If the text is NULL, the value is left unchanged. */
haft_status words_read_length(double *value, const haft_units *units, const char *option,
                              const char *text, const char *example, haft_error *error);

/* Reads width and height from "10 um x 5 um" or "10x5 um", also with a multiplication sign. */
haft_status words_read_size(double size[2], const haft_units *units, const char *text,
                            haft_error *error);

/* Reads "nm" or "2 nm". */
haft_status words_read_unit(double *unit, const haft_units *units, const char *option,
                            const char *text, haft_error *error);

#endif
