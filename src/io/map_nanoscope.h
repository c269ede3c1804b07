/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the parts of the Nanoscope reader share. Private to this room. */
#ifndef HAFT_IO_MAP_NANOSCOPE_H
#define HAFT_IO_MAP_NANOSCOPE_H

#include "map_file.h"

enum { HAFT_NANOSCOPE_LISTS = 128, HAFT_NANOSCOPE_VALUE = 128 };

/* One list of the header, from the end of its title to the next title. */
typedef struct haft_nanoscope_list {
    const char *start, *end;
    size_t line; /* of its title, from 1 */
    bool image;  /* describes a map, not curves */
} haft_nanoscope_list;

typedef struct haft_nanoscope {
    const haft_map_file *file;
    haft_nanoscope_list list[HAFT_NANOSCOPE_LISTS];
    size_t lists;
    size_t bytes; /* of the header */
} haft_nanoscope;

/* ---- the header: map_nanoscope_header.c ---- */

/* Splits the header into lists. Checks its line ends, and that the data of all maps are inside the
 * file, after the header, and do not overlap. */
haft_status haft_nanoscope_open(haft_nanoscope *h, const haft_map_file *file, haft_error *error);

/* Whether the file is of force curves; it may have maps too. */
bool haft_nanoscope_is_force(const haft_nanoscope *h);

/* Finds the value of a key in a list; returns its line, 0 if the list does not have it. Ignores the
 * case of letters. "@*:Z scale" finds the key in any group, "@2:Z scale" as well as "@3:Z
 * scale". */
size_t haft_nanoscope_find(const haft_nanoscope_list *l, const char *key,
                           char value[HAFT_NANOSCOPE_VALUE]);

/* The same in the first list that is not a map's and has the key: values for the whole scan. */
size_t haft_nanoscope_find_scan(const haft_nanoscope *h, const char *key,
                                char value[HAFT_NANOSCOPE_VALUE]);

/* Reads an unsigned integer; an error with its line if it is missing or not a number. */
haft_status haft_nanoscope_get_count(size_t *value, const haft_nanoscope *h,
                                     const haft_nanoscope_list *l, const char *key,
                                     haft_error *error);

/* ---- heights: map_nanoscope_scale.c ---- */

/* Metres per step of a map's integers, which have `stored` bytes in the file and `said` bytes
 * according to the header. HAFT_ERROR_INPUT with the line if they are not heights; `error` may be
 * NULL. */
haft_status haft_nanoscope_get_scale(double *scale, const haft_nanoscope *h,
                                     const haft_nanoscope_list *l, size_t stored, size_t said,
                                     haft_error *error);

/* ---- channels: map_nanoscope_channel.c ---- */

typedef struct haft_nanoscope_channel {
    const haft_nanoscope_list *list;
    char label[HAFT_CHANNEL_CAPACITY]; /* name and direction */
    char remark[256];                  /* other possible choices; may be empty */
} haft_nanoscope_channel;

/* Chooses the channel that the options name, or the first with heights. */
haft_status haft_nanoscope_choose(haft_nanoscope_channel *chosen, const haft_nanoscope *h,
                                  haft_error *error);

#endif
