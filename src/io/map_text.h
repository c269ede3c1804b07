/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the parts of the reader of text maps share. Private to this room. */
#ifndef HAFT_IO_MAP_TEXT_H
#define HAFT_IO_MAP_TEXT_H

#include "map_file.h"

/* A length that a header gives, and its line. */
typedef struct haft_map_said {
    double value; /* [m]; 0: not given */
    size_t line;
    bool bare; /* given without a unit: `value` is the number alone */
} haft_map_said;

/* The contents of header lines. Index 0 is along x, 1 along y. */
typedef struct haft_map_title {
    haft_map_said side[2], lateral[2], unit, bit; /* bit: the length of a height of 1 */
    size_t pixels[2], pixels_line[2];             /* 0: not given */
    char channel[HAFT_CHANNEL_CAPACITY];
    bool titled; /* a header line was there */
    bool loose;  /* header lines of this kind have no mark */
    bool points; /* the columns are named x, y, z */
} haft_map_title;

/* One line of numbers, without its line end. */
typedef struct haft_map_row {
    char *text;
    size_t number;
} haft_map_row;

/* How numbers are written in the rows of a file. */
typedef struct haft_map_notation {
    char separator; /* ' ' means any blanks; else '\t', ',' or ';', and cells may be empty */
    bool comma;     /* commas are decimal */
    bool open;      /* each row begins with a tab that separates nothing */
    bool closed;    /* each row ends with a separator that separates nothing */
} haft_map_notation;

/* A table of numbers, NAN where one is missing. */
typedef struct haft_map_table {
    double *value;
    size_t rows, columns;
} haft_map_table;

/* Reads one line if it is a header line; *known: whether it says something about a map. `first`:
 * whether no numbers came before it. */
haft_status haft_map_read_title(haft_map_title *title, const haft_map_file *file, size_t number,
                                const char *line, bool first, bool *is_title, bool *known,
                                haft_error *error);

/* Converts lengths given without a unit, and complains of options that contradict the header. */
haft_status haft_map_settle_title(haft_map_title *title, const haft_map_file *file,
                                  haft_error *error);

/* Determines separators and decimal marks from all rows; complains if they could be read in two
 * ways. Removes rows of tabs if tabs are only blanks. */
haft_status haft_map_find_notation(haft_map_notation *notation, haft_map_row *row, size_t *rows,
                                   const haft_map_file *file, haft_error *error);

/* Reads all rows. @return HAFT_ERROR_INPUT with line and column. */
haft_status haft_map_read_table(haft_map_table *table, const haft_map_notation *notation,
                                const haft_map_row *row, size_t rows, const haft_map_file *file,
                                bool titled, haft_error *error);

/* Whether the first two of three columns are the coordinates of a complete grid. */
haft_status haft_map_looks_like_points(bool *points, const haft_map_table *table,
                                       haft_error *error);

/* Makes a map from points x, y, z on an even grid, in any order. */
haft_status haft_map_from_points(haft_map **out, const haft_map_file *file,
                                 const haft_map_table *table, const haft_map_title *title,
                                 haft_error *error);

#endif
