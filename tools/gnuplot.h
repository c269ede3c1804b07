/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs gnuplot. */
#ifndef HAFT_TOOLS_GNUPLOT_H
#define HAFT_TOOLS_GNUPLOT_H

#include "terminal.h"

/* Passes a text to the scripts as data, in an environment variable, quoted so that it is safe to
 * show. */
haft_status give_text(const char *variable, const char *text, haft_error *error);

/* Draws the figure of one script from the CSV files in `folder`, with a title. */
haft_status draw_script(const char *name, const char *folder, const char *title,
                        const char *definitions, haft_error *error);

#endif
