/* SPDX-License-Identifier: GPL-3.0-or-later */
/* haft init: makes a case folder from height maps, or from three roughness numbers of a surface,
 * with defaults that run in a minute or two. */
#ifndef HAFT_TOOLS_INIT_H
#define HAFT_TOOLS_INIT_H

#include "inspect.h"

#include <argp.h>

/* Options as written, NULL where not given. */
typedef struct init_words {
    size_t maps, opposite_maps;
    const char *map[HAFT_FILES_MAX], *opposite_map[HAFT_FILES_MAX];
    inspect_words read; /* how the maps are read and cleaned */
    const char *rms, *correlation_length, *hurst, *zeta_max;
    const char *beam, *gap, *humidity;
    bool any; /* one of init's own options was given */
} init_words;

/* init's own options. Their argp input is an init_words. */
extern const struct argp init_options;

/* All that the case is made from. */
typedef struct init_plan {
    const init_words *words;
    const char *folder;
    inspect_wishes wishes;
    haft_roughness roughness;                       /* rms is 0 if maps are given */
    double length, width, thickness, gap, humidity; /* [m]; a share */
    size_t beams;
    double zeta_max, rms, correlation_length;      /* of the surface */
    double skewness, kurtosis;                     /* of the first map; NAN without one */
    double grid_step, kernel_tolerance, l_meso;    /* chosen */
    double from, to, step, position, crack_length; /* chosen by trial patches */
    double adhesion, expected;                     /* [J/m^2]; crack length from it [m] */
    size_t vectors;
} init_plan;

/* ---- parts ---- */

/* Reads the options, and sets defaults for the rest. */
haft_status init_understand(init_plan *p, const init_words *words, const char *folder, size_t beams,
                            haft_error *error);

/* Checks that the folder can take a case: HAFT_ERROR_EXISTS if it has one already. */
haft_status init_find_room(const char *folder, haft_error *error);

/* Chooses roughness, grid, patches, distances and load from the surface itself. */
haft_status init_choose(init_plan *p, haft_error *error);

/* Writes the text of the case, with the paths of the original maps if `absolute`, else of their
 * copies. */
haft_status init_write_case(FILE *stream, const init_plan *p, bool absolute, haft_error *error);

/* Writes the case to a temporary file and reads it back. */
haft_status init_try(haft_case **c, const init_plan *p, haft_error *error);

/* Makes the folder with the case and copies of its maps, all or nothing. */
haft_status init_save(const init_plan *p, haft_error *error);

/* Makes a new case in the folder: all steps above. */
int init_case(const init_words *words, const char *folder, size_t beams, terminal *t);

#endif
