/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the parts of the Nanoscope reader share. Private to this room. */
#ifndef HAFT_IO_MAP_NANOSCOPE_H
#define HAFT_IO_MAP_NANOSCOPE_H

#include "map_file.h"

enum { HAFT_NANOSCOPE_LISTS = 128, HAFT_NANOSCOPE_VALUE = 128 };

/* One list of the header, from behind its title to the next title. */
typedef struct haft_nanoscope_list {
    const char *start, *end;
    size_t line; /* of its title, from 1 */
    bool image;  /* describes a map, no curves */
} haft_nanoscope_list;

typedef struct haft_nanoscope {
    const haft_map_file *file;
    haft_nanoscope_list list[HAFT_NANOSCOPE_LISTS];
    size_t lists;
    size_t bytes; /* of the header */
} haft_nanoscope;

/* ---- the header: map_nanoscope_header.c ---- */

/* Splits the header into lists, and checks its line ends and that the data of every map lie within
 * the file, behind the header, and apart. */
haft_status haft_nanoscope_open(haft_nanoscope *h, const haft_map_file *file, haft_error *error);

/* Whether the file is one of force curves, which may hold maps beside them. */
bool haft_nanoscope_is_force(const haft_nanoscope *h);

/* The value of a key in a list; returns its line, 0 if the list has none. The case of letters does
 * not matter. "@*:Z scale" finds the key in any group, "@2:Z scale" as well as "@3:Z scale". */
size_t haft_nanoscope_find(const haft_nanoscope_list *l, const char *key,
                           char value[HAFT_NANOSCOPE_VALUE]);

/* The same in the first list that is no map and has the key: what holds for the whole scan. */
size_t haft_nanoscope_find_scan(const haft_nanoscope *h, const char *key,
                                char value[HAFT_NANOSCOPE_VALUE]);

/* A whole number; an error with its line if it is missing or none. */
haft_status haft_nanoscope_get_count(size_t *value, const haft_nanoscope *h,
                                     const haft_nanoscope_list *l, const char *key,
                                     haft_error *error);

/* ---- heights: map_nanoscope_scale.c ---- */

/* Metres a step of a map's integers, which take `stored` bytes in the file where the header says
 * `said`. HAFT_ERROR_INPUT with the line if they are no heights; `error` may be NULL. */
haft_status haft_nanoscope_get_scale(double *scale, const haft_nanoscope *h,
                                     const haft_nanoscope_list *l, size_t stored, size_t said,
                                     haft_error *error);

/* ---- channels: map_nanoscope_channel.c ---- */

typedef struct haft_nanoscope_channel {
    const haft_nanoscope_list *list;
    char label[HAFT_CHANNEL_CAPACITY]; /* name and direction */
    char remark[256];                  /* what else could have been meant; may be empty */
} haft_nanoscope_channel;

/* The channel that the options name, or the first with heights. */
haft_status haft_nanoscope_choose(haft_nanoscope_channel *chosen, const haft_nanoscope *h,
                                  haft_error *error);

#endif
