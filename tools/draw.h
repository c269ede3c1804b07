/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws a finished run. */
#ifndef HAFT_TOOLS_DRAW_H
#define HAFT_TOOLS_DRAW_H

#include "terminal.h"

/* Draws the figures of CASE into CASE/out/plots. The path drawn is that of realization `asked`; if
 * that is -1, of the first with evidence. If `reference` is not NULL, also draws the crack lengths
 * against those of that case. @return the program's exit code */
int draw_case(const haft_case *c, const char *case_folder, long asked, const char *reference,
              terminal *t);

/* Chooses the beam to show: `asked`, or if that is -1 the first with evidence, or else beam 0. */
haft_status choose_realization(const haft_case *c, long asked, size_t *chosen, haft_error *error);

/* Reads the laws at `path` and their digest, if they are those of the present case. */
haft_status read_matching_laws(haft_laws **laws, char digest[HAFT_DIGEST_CAPACITY],
                               const haft_case *c, const char *path, haft_error *error);

/* Draws the table of a sweep, CASE/out/sweep.csv, into CASE/out/plots. `greatest` is the greatest
 * value of the first key and chooses the unit of the axis. If that key is a choice, `words` holds
 * each variant's word, else it is empty. @return the exit code */
enum { DRAW_WORDS_CAPACITY = 2048 };
int draw_sweep(const haft_case *c, double greatest, const char *words, const char *case_folder,
               terminal *t);

/* Draws DIR/distributions.csv and DIR/compare.csv of n cases. `labels` has one label a line,
 * without spaces. */
haft_status draw_comparison(const char *labels, size_t n, double confidence, const char *directory,
                            haft_error *error);

#endif
