/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A height map's file in memory, and what its readers share. Private to this room. */
#ifndef HAFT_IO_MAP_FILE_H
#define HAFT_IO_MAP_FILE_H

#include "haft/io.h"

typedef struct haft_map_file {
    const char *path;
    const char *bytes; /* a 0 follows them */
    size_t size;
    haft_map_options options; /* channel never NULL */
} haft_map_file;

/* Each reads one kind of file, whose beginning has been recognised. */
haft_status haft_map_read_nanoscope(haft_map **out, const haft_map_file *file, haft_error *error);
haft_status haft_map_read_gsf(haft_map **out, const haft_map_file *file, haft_error *error);
haft_status haft_map_read_text(haft_map **out, const haft_map_file *file, haft_error *error);
haft_status haft_map_read_hdf(haft_map **out, const haft_map_file *file, haft_error *error);
haft_status haft_map_read_gwy(haft_map **out, const haft_map_file *file, haft_error *error);
haft_status haft_map_read_npy(haft_map **out, const haft_map_file *file, haft_error *error);

/* Whether the contents are of a format that is not read but known by name; and the messages that
 * say so, or that nothing is known of the file. They make no map. */
bool haft_map_is_known(const haft_map_file *file);
haft_status haft_map_refuse_known(haft_map **out, const haft_map_file *file, haft_error *error);
haft_status haft_map_refuse_unknown(haft_map **out, const haft_map_file *file, haft_error *error);

/* What `number unit` is in metres; instruments' spellings ("~m", a Latin-1 micro sign) are known.
 * False if it is no length. */
bool haft_map_length(double number, const char *unit, double *value);

/* The first `n` bytes of a line that are text, for messages: at most 40, control characters as '?'.
 */
const char *haft_map_quote(char quoted[48], const char *text, size_t n);

/* Makes a map for a matrix whose file says width, height or unit by a positive number and leaves
 * them to the options by 0; complains of what neither has. The reader then writes heights in
 * `unit`s into it, and haft_map_end() scales them, or destroys the map if one is infinite. */
haft_status haft_map_begin(haft_map **out, const haft_map_file *file, size_t rows, size_t columns,
                           double width, double height, double *unit, haft_error *error);
haft_status haft_map_end(haft_map **out, const haft_map_file *file, double unit, haft_error *error);

/* Refuses heights in `unit`s [m] of which the least or the greatest is a mark for missing pixels,
 * by all appearance: haft_map_end() calls it. With unit 0 they are numbers still to be scaled. */
haft_status haft_map_check_marks(const haft_map *map, const haft_map_file *file, double unit,
                                 haft_error *error);

/* Adds to map->note what the reader had to assume. */
void haft_map_remark(haft_map *map, const char *format, ...) HAFT_PRINTF(2, 3);

/* Both, of heights that are there. */
haft_status haft_map_from_matrix(haft_map **out, const haft_map_file *file, size_t rows,
                                 size_t columns, double width, double height, double unit,
                                 const double *z, haft_error *error);

/* Names for the user: "Height", "Height Sensor" ... of a list, cut where it gets long. */
void haft_map_name(char *destination, const char *text, size_t n);

#endif
