/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The file of a height map in memory, and what its readers share. Private to this room. */
#ifndef HAFT_IO_MAP_FILE_H
#define HAFT_IO_MAP_FILE_H

#include "haft/io.h"

typedef struct haft_map_file {
    const char *path;
    const char *bytes; /* a 0 follows them */
    size_t size;
    haft_map_options options; /* channel never NULL */
} haft_map_file;

/* Each reads one kind of file, recognised by its beginning. */
haft_status haft_map_read_nanoscope(haft_map **out, const haft_map_file *file, haft_error *error);
haft_status haft_map_read_gsf(haft_map **out, const haft_map_file *file, haft_error *error);
haft_status haft_map_read_text(haft_map **out, const haft_map_file *file, haft_error *error);
haft_status haft_map_read_hdf(haft_map **out, const haft_map_file *file, haft_error *error);
haft_status haft_map_read_gwy(haft_map **out, const haft_map_file *file, haft_error *error);
haft_status haft_map_read_npy(haft_map **out, const haft_map_file *file, haft_error *error);

/* Whether Haft knows the format only by name and cannot read it. The other two functions report
 * this, or an unknown format, and make no map. */
bool haft_map_is_known(const haft_map_file *file);
haft_status haft_map_refuse_known(haft_map **out, const haft_map_file *file, haft_error *error);
haft_status haft_map_refuse_unknown(haft_map **out, const haft_map_file *file, haft_error *error);

/* Converts `number unit` to metres; also knows the spellings of instruments ("~m", a Latin-1 micro
 * sign). False if it is not a length. */
bool haft_map_length(double number, const char *unit, double *value);

/* Copies the first `n` bytes of a line for a message: at most 40, control characters as '?'. */
const char *haft_map_quote(char quoted[48], const char *text, size_t n);

/* Makes a map for a matrix. Width, height and unit are positive if the file gives them, else 0, and
 * then the options must give them; complains of what is missing in both. The reader then stores the
 * heights in `unit`s, and haft_map_end() scales them, or destroys the map if one is infinite. */
haft_status haft_map_begin(haft_map **out, const haft_map_file *file, size_t rows, size_t columns,
                           double width, double height, double *unit, haft_error *error);
haft_status haft_map_end(haft_map **out, const haft_map_file *file, double unit, haft_error *error);

/* Rejects a map whose smallest or largest height looks like a fill value for missing pixels;
 * haft_map_end() calls it. The heights are in `unit`s [m]; 0 if they are not scaled yet. */
haft_status haft_map_check_marks(const haft_map *map, const haft_map_file *file, double unit,
                                 haft_error *error);

/* Adds an assumption of the reader to map->note. */
void haft_map_remark(haft_map *map, const char *format, ...) HAFT_PRINTF(2, 3);

/* haft_map_begin() and haft_map_end() for heights in an array. */
haft_status haft_map_from_matrix(haft_map **out, const haft_map_file *file, size_t rows,
                                 size_t columns, double width, double height, double unit,
                                 const double *z, haft_error *error);

/* Copies a channel's name for the user, like "Height Sensor"; cuts a long one. */
void haft_map_name(char *destination, const char *text, size_t n);

#endif
