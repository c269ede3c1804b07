/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Drawing a finished run. */
#ifndef HAFT_TOOLS_DRAW_H
#define HAFT_TOOLS_DRAW_H

#include "terminal.h"

/* Draws the figures of CASE into CASE/out/plots, the path being that of the realization asked for,
 * or of the first that left evidence if that is -1; and, where `reference` is not NULL, its crack
 * lengths against those of that case. @return the program's exit code */
int draw_case(const haft_case *c, const char *case_folder, long asked, const char *reference,
              terminal *t);

/* The beam that is shown where `asked` was asked for: it, or if that is -1 the first that left
 * evidence, or 0. */
haft_status choose_realization(const haft_case *c, long asked, size_t *chosen, haft_error *error);

/* The laws at `path`, if they are those of the case as it stands, and their digest. */
haft_status read_matching_laws(haft_laws **laws, char digest[HAFT_DIGEST_CAPACITY],
                               const haft_case *c, const char *path, haft_error *error);

/* Draws the table of a sweep, CASE/out/sweep.csv, into CASE/out/plots; `greatest` of the values of
 * its first key chooses the axis' unit, and where that key is a choice `words` holds each
 * variant's, else nothing. @return the exit code */
enum { DRAW_WORDS_CAPACITY = 2048 };
int draw_sweep(const haft_case *c, double greatest, const char *words, const char *case_folder,
               terminal *t);

/* Draws DIR/distributions.csv and DIR/compare.csv, of n cases whose labels hold no space, one a
 * line. */
haft_status draw_comparison(const char *labels, size_t n, double confidence, const char *directory,
                            haft_error *error);

#endif
