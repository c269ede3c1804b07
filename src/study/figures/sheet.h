/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A table of doubles with named columns, to be written as CSV. Private to this room. */
#ifndef HAFT_STUDY_SHEET_H
#define HAFT_STUDY_SHEET_H

#include "haft/study.h"

typedef struct haft_sheet {
    size_t rows, columns;
    double *value; /* [rows][columns] */
    haft_csv_column *column;
} haft_sheet;

/* Allocates a table of zeros with unnamed columns. haft_sheet_write() or haft_sheet_drop() frees
 * it. */
haft_status haft_sheet_make(haft_sheet *t, size_t rows, size_t columns,
                            haft_error *error) HAFT_MUST_CHECK;

/* Names all columns. */
void haft_sheet_name(haft_sheet *t, const char *const *name);

/* Writes DIRECTORY/NAME, and frees the table even if that fails. */
haft_status haft_sheet_write(haft_sheet *t, const char *directory, const char *name,
                             haft_error *error) HAFT_MUST_CHECK;

void haft_sheet_drop(haft_sheet *t);

#endif
