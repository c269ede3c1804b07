/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Quantities in the options of haft-laws inspect. */
#ifndef HAFT_TOOLS_INSPECT_WORDS_H
#define HAFT_TOOLS_INSPECT_WORDS_H

#include "haft/base.h"

/* A positive length; a text of NULL leaves it as it is. */
haft_status words_read_length(double *value, const haft_units *units, const char *option,
                              const char *text, const char *example, haft_error *error);

/* "10 um x 5 um", "10x5 um" or with a multiplication sign into width and height. */
haft_status words_read_size(double size[2], const haft_units *units, const char *text,
                            haft_error *error);

/* "nm" or "2 nm" */
haft_status words_read_unit(double *unit, const haft_units *units, const char *option,
                            const char *text, haft_error *error);

#endif
