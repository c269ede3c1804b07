/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nanoscope files: a text header, and the raw integers of the channels at offsets that it gives.
 * Lines are stored from the bottom of the image in both scan directions of the frame ("Frame
 * direction"), and points from its left, in retraces too.
 *
 * The number of pixels is "Samps/line" times "Number of lines" of the channel's list. If the data
 * do not have this number, it is "Valid data len X" and "Y", or "Samps/line" and "Lines" of the
 * scan list. In some files only those are right: a test file of pySPM says 512 lines but has the 32
 * that "Valid data len Y" says, and Gwyddion's reader reports lists with wrong sizes of their own.
 *
 * The size: if "Scan size" has two different numbers, they are the map's sides. Two equal numbers,
 * or one, are a side of the scan's frame. The other side follows from the "Aspect ratio", width to
 * height:
 *  - the channel's own, if it is a ratio such as 2:1. Users of such scans of 10 um report 10 x 5 um
 *    (pySPM's issue 22); Gwyddion multiplies by the lines, which gives the same for square pixels;
 *  - else the scan list's, which gives the frame's height. The map has the share of it that the
 *    channel's lines have in the "Lines" of the scan list. A cut image of 358 of 512 lines of
 *    300 nm is 210 nm high in the instrument's own program (pySPM's issue 38), although its list
 *    has an "Aspect Ratio: 0.516184" that nobody can explain.
 * So a whole frame with 1:1 is square for any number of lines, and its pixels are oblong. Gwyddion
 * (nanoscope.c of 2022) and SurfaceTopography 1.19 (DI.py) read it in this way, while pySPM
 * (Bruker.py) assumes square pixels. Bruker's public documents on the format (User Guide of
 * NanoScope 8.10) explain scales but not this. If no list gives "Lines", the pixels are assumed to
 * be square here too. Since readers differ, a map for which the two assumptions disagree gets a
 * remark, and a size in the options has priority. */
#include "map_nanoscope.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MOST = HAFT_MAP_SIDE_MOST };

/* The place and size of a channel's integers. */
typedef struct place {
    size_t rows, columns, offset;
    size_t stored, said; /* bytes per pixel, in the file and according to its header */
    const char *source;  /* source of rows and columns, if not the usual one */
} place;

/* ---- pixels ---- */

/* An optional count of the header; 0 if it is missing. */
static size_t count_or_none(const haft_nanoscope *h, const haft_nanoscope_list *l,
                            const char *key) {
    size_t value = 0;
    return haft_nanoscope_get_count(&value, h, l, key, NULL) == HAFT_OK ? value : 0;
}

static size_t scan_count(const haft_nanoscope *h, const char *key) {
    char text[HAFT_NANOSCOPE_VALUE];
    for (size_t k = 0; k < h->lists; k++) {
        if (!h->list[k].image && haft_nanoscope_find(&h->list[k], key, text) > 0) {
            return count_or_none(h, &h->list[k], key);
        }
    }
    return 0;
}

/* Whether this many pixels fill the data; if so, sets the bytes per pixel. */
static bool fills(place *p, size_t columns, size_t rows, size_t bytes, const char *source) {
    if (rows < 2 || columns < 2 || rows > MOST || columns > MOST) {
        return false;
    }
    for (size_t stored = 2; stored <= 4; stored += 2) {
        if (bytes == stored * rows * columns) {
            p->rows = rows;
            p->columns = columns;
            p->stored = stored;
            p->source = source;
            return true;
        }
    }
    return false;
}

static haft_status find_data(place *p, const haft_nanoscope *h, const haft_nanoscope_list *l,
                             haft_error *error) {
    size_t columns = 0, rows = 0, bytes = 0;
    struct {
        const char *key;
        size_t *value;
    } wanted[] = {{"Samps/line", &columns},
                  {"Number of lines", &rows},
                  {"Data offset", &p->offset},
                  {"Data length", &bytes}};
    for (size_t k = 0; k < sizeof wanted / sizeof *wanted; k++) {
        haft_status status = haft_nanoscope_get_count(wanted[k].value, h, l, wanted[k].key, error);
        if (status != HAFT_OK) {
            return status;
        }
    }
    char text[HAFT_NANOSCOPE_VALUE];
    p->said = 2;
    if (haft_nanoscope_find(l, "Bytes/pixel", text) > 0) {
        HAFT_TRY(haft_nanoscope_get_count(&p->said, h, l, "Bytes/pixel", error));
    }
    bool known = fills(p, columns, rows, bytes, NULL) ||
                 fills(p, count_or_none(h, l, "Valid data len X"),
                       count_or_none(h, l, "Valid data len Y"), bytes, "Valid data len") ||
                 fills(p, scan_count(h, "Samps/line"), scan_count(h, "Lines"), bytes,
                       "Lines of the scan list");
    if (!known || (p->said != 2 && p->said != 4)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s:%zu: %zu bytes of data for %zu x %zu pixels of %zu bytes; only 2 "
                              "and 4 bytes a pixel are known, and 2 to %d pixels a side",
                              h->file->path, l->line, bytes, rows, columns, p->said, MOST);
    }
    return HAFT_OK;
}

/* ---- sides ---- */

/* Reads "2:1" as width over height; 0 if it is not a ratio. */
static double read_ratio(const char *text) {
    char first[32];
    const char *colon = strchr(text, ':');
    double a = 0, b = 0;
    size_t n = colon == NULL ? sizeof first : (size_t)(colon - text);
    if (n >= sizeof first) {
        return 0;
    }
    memcpy(first, text, n);
    first[n] = '\0';
    return haft_number_read(first, &a) && haft_number_read(colon + 1, &b) && a > 0 && b > 0 ? a / b
                                                                                            : 0;
}

/* Reads "10 10 ~m" or "2000 nm"; both mean two equal sides. */
static bool read_scan_size(const char *text, double *width, double *height) {
    char word[3][32];
    size_t n = 0;
    for (text += strspn(text, " \t"); *text != '\0'; text += strspn(text, " \t")) {
        size_t length = strcspn(text, " \t");
        if (n == 3 || length >= sizeof word[0]) {
            return false;
        }
        memcpy(word[n], text, length);
        word[n++][length] = '\0';
        text += length;
    }
    double first = 0, second = 0;
    return (n == 2 || n == 3) && haft_number_read(word[0], &first) &&
           haft_number_read(word[n - 2], &second) && haft_map_length(first, word[n - 1], width) &&
           haft_map_length(second, word[n - 1], height) && *width > 0 && *height > 0;
}

/* The height of a map whose scan size gives one side, from its own aspect ratio or the frame's; 0
 * if the header does not give the frame's lines. */
static double height_of_frame(const haft_nanoscope *h, const haft_nanoscope_list *l, const place *p,
                              double width) {
    char text[HAFT_NANOSCOPE_VALUE];
    double own = haft_nanoscope_find(l, "Aspect ratio", text) > 0 ? read_ratio(text) : 0;
    if (own > 0 && own != 1 && p->source == NULL) {
        return width / own;
    }
    double ratio = haft_nanoscope_find_scan(h, "Aspect ratio", text) > 0 ? read_ratio(text) : 0;
    size_t lines = scan_count(h, "Lines");
    double share = lines > p->rows ? (double)p->rows / (double)lines : 1;
    return lines == 0 ? 0 : width / (ratio > 0 ? ratio : 1) * share;
}

/* The sides of a map with two equal scan sizes, and what was assumed. */
static void assume_sides(double side[2], char remark[256], const haft_nanoscope *h,
                         const haft_nanoscope_list *l, const place *p) {
    const haft_map_options *o = &h->file->options;
    double square = side[0] * (double)p->rows / (double)p->columns;
    double frame = height_of_frame(h, l, p, side[0]), other = frame > 0 ? square : side[0];
    side[1] = frame > 0 ? frame : square;
    if (fabs(side[1] / other - 1) <= 0.01) {
        return;
    }
    if (o->width > 0 && o->height > 0) {
        side[0] = o->width;
        side[1] = o->height;
        snprintf(remark, 256, "its size is the one given, since the header leaves it open");
        return;
    }
    snprintf(remark, 256,
             "%s pixels are assumed, so a map of %.4g x %.4g um, since the header%s; if %s square, "
             "give its size as %.4g um x %.4g um",
             frame > 0 ? "oblong" : "square", side[0] * 1e6, side[1] * 1e6,
             frame > 0 ? "'s scan size and aspect ratio say so"
                       : " does not give the lines of the frame",
             frame > 0 ? "its pixels are" : "the frame is", side[0] * 1e6, other * 1e6);
}

/* The map's sides [m], and what was assumed about them. */
static haft_status read_sides(double side[2], char remark[256], const haft_nanoscope *h,
                              const haft_nanoscope_list *l, const place *p, haft_error *error) {
    char text[HAFT_NANOSCOPE_VALUE], quoted[48];
    size_t line = haft_nanoscope_find(l, "Scan size", text);
    line = line > 0 ? line : haft_nanoscope_find_scan(h, "Scan size", text);
    if (line == 0) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s:%zu: the channel has no \"Scan size\"; the header is damaged",
                              h->file->path, l->line);
    }
    if (!read_scan_size(text, &side[0], &side[1])) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s:%zu: \"Scan size\" is \"%s\", no length; the header is damaged",
                              h->file->path, line, haft_map_quote(quoted, text, 40));
    }
    remark[0] = '\0';
    if (side[0] == side[1]) {
        assume_sides(side, remark, h, l, p);
    }
    return HAFT_OK;
}

/* ---- heights ---- */

static double raw_value(const unsigned char *at, size_t bytes) {
    if (bytes == 2) {
        return (int16_t)((unsigned)at[0] | (unsigned)at[1] << 8);
    }
    uint32_t word =
        (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
    return (int32_t)word;
}

/* Remarks on lines and points that the header does not count as valid, as in a stopped scan. */
static void remark_invalid(haft_map *map, const haft_nanoscope *h, const haft_nanoscope_list *l) {
    char text[HAFT_NANOSCOPE_VALUE];
    size_t columns = count_or_none(h, l, "Valid data len X");
    size_t rows = count_or_none(h, l, "Valid data len Y");
    if ((columns > 0 && columns < map->columns) || (rows > 0 && rows < map->rows)) {
        haft_map_remark(map,
                        "its header counts %zu x %zu pixels as valid, and all are read as heights",
                        columns, rows);
    }
    if (haft_nanoscope_find(l, "Invalid Data Flag", text) > 0 && strcasecmp(text, "None") != 0) {
        haft_map_remark(map, "its header marks invalid data (\"%.30s\"), which are read as heights",
                        text);
    }
}

static void add_remarks(haft_map *map, const haft_nanoscope *h, const haft_nanoscope_channel *c,
                        const place *p, const char *sides) {
    if (sides[0] != '\0') {
        haft_map_remark(map, "%s", sides);
    }
    if (p->source != NULL) {
        haft_map_remark(map,
                        "%zu x %zu pixels are read by \"%s\", since its own counts do not fit "
                        "its data",
                        p->columns, p->rows, p->source);
    }
    remark_invalid(map, h, c->list);
    if (c->remark[0] != '\0') {
        haft_map_remark(map, "%s", c->remark);
    }
}

static haft_status read_channel(haft_map **out, const haft_nanoscope *h,
                                const haft_nanoscope_channel *c, haft_error *error) {
    place p = {.rows = 0};
    double side[2], scale = 0, unit = 1;
    char sides[256];
    haft_status status = find_data(&p, h, c->list, error);
    HAFT_THEN(status, read_sides(side, sides, h, c->list, &p, error));
    HAFT_THEN(status, haft_nanoscope_get_scale(&scale, h, c->list, p.stored, p.said, error));
    HAFT_THEN(status,
              haft_map_begin(out, h->file, p.rows, p.columns, side[0], side[1], &unit, error));
    for (size_t i = 0; status == HAFT_OK && i < p.rows; i++) {
        const unsigned char *line = (const unsigned char *)h->file->bytes + p.offset +
                                    (p.rows - 1 - i) * p.columns * p.stored;
        for (size_t j = 0; j < p.columns; j++) {
            (*out)->z[i * p.columns + j] = scale * raw_value(line + j * p.stored, p.stored);
        }
    }
    HAFT_THEN(status, haft_map_end(out, h->file, unit, error));
    if (status == HAFT_OK) {
        memcpy((*out)->channel, c->label, sizeof c->label);
        snprintf((*out)->format, sizeof(*out)->format, "Nanoscope");
        add_remarks(*out, h, c, &p, sides);
    }
    return status;
}

/* Rejects profiles of different lengths, which are not a map ("Start context" ends in VAR: deep
 * trenches). */
static haft_status check_mode(const haft_nanoscope *h, haft_error *error) {
    char text[HAFT_NANOSCOPE_VALUE];
    size_t n = haft_nanoscope_find_scan(h, "Start context", text) > 0 ? strlen(text) : 0;
    return n >= 3 && strcasecmp(text + n - 3, "VAR") == 0
               ? haft_error_set(error, HAFT_ERROR_INPUT,
                                "%s: holds profiles of different lengths, no map", h->file->path)
               : HAFT_OK;
}

haft_status haft_map_read_nanoscope(haft_map **out, const haft_map_file *file, haft_error *error) {
    haft_nanoscope_channel chosen;
    haft_nanoscope *h = haft_memory_alloc(1, sizeof *h, error);
    if (h == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    haft_status status = haft_nanoscope_open(h, file, error);
    HAFT_THEN(status, check_mode(h, error));
    HAFT_THEN(status, haft_nanoscope_choose(&chosen, h, error));
    HAFT_THEN(status, read_channel(out, h, &chosen, error));
    haft_memory_free(h);
    return status;
}
