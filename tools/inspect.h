/* SPDX-License-Identifier: GPL-3.0-or-later */
/* haft-laws inspect: prints and draws what a height map holds. */
#ifndef HAFT_TOOLS_INSPECT_H
#define HAFT_TOOLS_INSPECT_H

#include "terminal.h"

/* Options as written, NULL where not given. */
typedef struct inspect_words {
    const char *channel, *level, *window, *missing, *outliers, *size, *unit, *lateral_unit,
        *tip_radius;
} inspect_words;

/* The options, understood. */
typedef struct inspect_wishes {
    haft_map_options options;
    haft_clean_spec clean;
    haft_window window;
    double tip_radius; /* [m]; 0: none */
} inspect_wishes;

/* Reads the options. If one has a wrong value, the message names the option and what is
 * valid. */
haft_status inspect_read_words(inspect_wishes *w, const inspect_words *words, haft_error *error);

/* Reads the map, prints its properties, and draws it into `folder` (NULL: MAP's name with
 * ".inspect", in the working directory). */
haft_status inspect_map(const char *path, const inspect_words *words, const char *folder,
                        bool quiet, haft_error *error);

#endif
