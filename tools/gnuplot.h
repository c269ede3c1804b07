/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Running gnuplot. */
#ifndef HAFT_TOOLS_GNUPLOT_H
#define HAFT_TOOLS_GNUPLOT_H

#include "terminal.h"

/* Puts a text, made safe to show, where the scripts find it as data: in an environment variable. */
haft_status give_text(const char *variable, const char *text, haft_error *error);

/* Draws one script's figure from the CSV files in `folder`, under a title. */
haft_status draw_script(const char *name, const char *folder, const char *title,
                        const char *definitions, haft_error *error);

#endif
