/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The text header of a Nanoscope file: lists ("\*Ciao image list", each followed by lines "\Key:
 * value" until the next), ended by "\*File list end". Its first line is "\*File list", "\*EC File
 * list" (electrochemistry) or another "... list"; force volumes begin with "\*Force file list" and
 * may have maps besides their curves ("\*Ciao force image list").
 *
 * Lines end in CR LF. If they do not, a transfer as text has changed the header, and the data too:
 * each byte pair 13 10 of the data has lost a byte, and all later bytes are shifted. */
#include "map_nanoscope.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static haft_status refuse(const haft_nanoscope *h, const char *what, haft_error *error) {
    return haft_error_set(error, HAFT_ERROR_INPUT, "%s: %s", h->file->path, what);
}

/* ---- lines and lists ---- */

static const char *line_end(const char *at, const char *end) {
    while (at < end && *at != '\n' && *at != '\r') {
        at++;
    }
    return at;
}

/* The beginning of the next line; counts lines by their LF. */
static const char *next_line(const char *at, const char *end, size_t *line) {
    while (at < end && (*at == '\n' || *at == '\r')) {
        *line += *at == '\n';
        at++;
    }
    return at;
}

static bool ends_with(const char *title, size_t n, const char *words) {
    size_t length = strlen(words);
    return n >= length && strncasecmp(title + n - length, words, length) == 0;
}

/* Splits the header into lists; false if its end is missing. */
static bool find_lists(haft_nanoscope *h) {
    const char *at = h->file->bytes, *end = at + h->file->size;
    size_t line = 1;
    while (at < end) {
        const char *stop = line_end(at, end);
        size_t n = (size_t)(stop - at);
        if (n >= 2 && at[1] == '*' && (at[0] == '\\' || at == h->file->bytes)) {
            if (h->lists > 0) {
                h->list[h->lists - 1].end = at;
            }
            if (n >= 15 && strncasecmp(at, "\\*File list end", 15) == 0) {
                h->bytes = (size_t)(stop - h->file->bytes);
                return h->lists > 0;
            }
            if (h->lists == HAFT_NANOSCOPE_LISTS) {
                return false;
            }
            bool image = ends_with(at, n, "image list") && !ends_with(at, n, "force image list");
            h->list[h->lists++] =
                (haft_nanoscope_list){.start = stop, .end = stop, .line = line, .image = image};
        } else if (n > 0 && (*at != '\\' && (unsigned char)*at < 32)) {
            return false; /* binary data: the header has no end */
        }
        at = next_line(stop, end, &line);
    }
    return false;
}

/* Whether a line "\Key: value" has this key; then `*from` is its value. */
static bool is_key(const char *at, size_t n, const char *key, const char **from) {
    size_t length = strlen(key), prefix = 0;
    if (n == 0 || *at != '\\') {
        return false;
    }
    at++;
    n--;
    if (strncmp(key, "@*:", 3) == 0) {
        if (n < 3 || at[0] != '@' || at[1] < '0' || at[1] > '9' || at[2] != ':') {
            return false;
        }
        prefix = 3;
    }
    *from = at + length + 1;
    return n > length && strncasecmp(at + prefix, key + prefix, length - prefix) == 0 &&
           at[length] == ':';
}

size_t haft_nanoscope_find(const haft_nanoscope_list *l, const char *key,
                           char value[HAFT_NANOSCOPE_VALUE]) {
    size_t line = l->line;
    for (const char *at = next_line(l->start, l->end, &line); at < l->end;) {
        const char *stop = line_end(at, l->end), *from = NULL;
        if (is_key(at, (size_t)(stop - at), key, &from)) {
            while (from < stop && *from == ' ') {
                from++;
            }
            while (stop > from && stop[-1] == ' ') {
                stop--;
            }
            snprintf(value, HAFT_NANOSCOPE_VALUE, "%.*s", (int)(stop - from), from);
            return line;
        }
        at = next_line(stop, l->end, &line);
    }
    return 0;
}

size_t haft_nanoscope_find_scan(const haft_nanoscope *h, const char *key,
                                char value[HAFT_NANOSCOPE_VALUE]) {
    for (size_t k = 0; k < h->lists; k++) {
        size_t line = h->list[k].image ? 0 : haft_nanoscope_find(&h->list[k], key, value);
        if (line > 0) {
            return line;
        }
    }
    return 0;
}

haft_status haft_nanoscope_get_count(size_t *value, const haft_nanoscope *h,
                                     const haft_nanoscope_list *l, const char *key,
                                     haft_error *error) {
    char text[HAFT_NANOSCOPE_VALUE], quoted[48];
    double number = 0;
    size_t line = haft_nanoscope_find(l, key, text);
    if (line == 0) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s:%zu: this list has no \"%s\"; the header is damaged",
                              h->file->path, l->line, key);
    }
    if (!haft_number_read(text, &number) || number != floor(number) ||
        !(number >= 0 && number < 1e12)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s:%zu: \"%s\" is \"%s\"; it must be a whole number", h->file->path,
                              line, key, haft_map_quote(quoted, text, 40));
    }
    *value = (size_t)number;
    return HAFT_OK;
}

/* ---- damage ---- */

static haft_status check_line_ends(const haft_nanoscope *h, haft_error *error) {
    size_t pairs = 0, feeds = 0, returns = 0;
    for (size_t i = 0; i < h->bytes; i++) {
        char c = h->file->bytes[i], next = h->file->bytes[i + 1];
        if (c == '\r' && next == '\n') {
            pairs++;
            i++;
        } else {
            feeds += c == '\n';
            returns += c == '\r';
        }
    }
    /* A note of the user may have single CRs or LFs. */
    if (pairs > feeds && pairs > returns) {
        return HAFT_OK;
    }
    return haft_error_set(error, HAFT_ERROR_INPUT,
                          "%s: was changed by a transfer as text: the lines of its header end in "
                          "%s, not in CR LF, so its data have lost or gained bytes; copy it anew "
                          "from the instrument, in binary mode",
                          h->file->path,
                          pairs > 0 && returns > 0 ? "CR CR LF"
                          : feeds >= returns       ? "LF"
                                                   : "CR");
}

typedef struct extent {
    size_t line, offset, length;
} extent;

static haft_status get_extent(extent *e, const haft_nanoscope *h, const haft_nanoscope_list *l,
                              haft_error *error) {
    e->line = l->line;
    haft_status status = haft_nanoscope_get_count(&e->offset, h, l, "Data offset", error);
    return status != HAFT_OK ? status
                             : haft_nanoscope_get_count(&e->length, h, l, "Data length", error);
}

/* If the places of data do not fit the file and each other, the data of some channel would be read
 * from a wrong place. */
static haft_status check_extents(const haft_nanoscope *h, haft_error *error) {
    extent seen[HAFT_NANOSCOPE_LISTS];
    size_t n = 0, size = h->file->size;
    for (size_t k = 0; k < h->lists; k++) {
        extent e;
        if (!h->list[k].image) {
            continue;
        }
        HAFT_TRY(get_extent(&e, h, &h->list[k], error));
        if (e.offset > size || e.length > size - e.offset) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "%s:%zu: the data of this channel end at byte %zu, the file at "
                                  "%zu; it is cut short or damaged",
                                  h->file->path, e.line, e.offset + e.length, size);
        }
        if (e.length > 0 && e.offset < h->bytes) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "%s:%zu: the data of this channel begin at byte %zu, within the "
                                  "header of %zu bytes; the file is damaged",
                                  h->file->path, e.line, e.offset, h->bytes);
        }
        for (size_t i = 0; i < n; i++) {
            if (e.offset < seen[i].offset + seen[i].length &&
                seen[i].offset < e.offset + e.length) {
                return haft_error_set(error, HAFT_ERROR_INPUT,
                                      "%s:%zu: the data of this channel overlap with those of the "
                                      "channel in line %zu; the header is damaged",
                                      h->file->path, e.line, seen[i].line);
            }
        }
        seen[n++] = e;
    }
    return HAFT_OK;
}

/* A map without its title line would be read as a part of the list before it. */
static haft_status check_titles(const haft_nanoscope *h, haft_error *error) {
    char value[HAFT_NANOSCOPE_VALUE];
    for (size_t k = 0; k < h->lists; k++) {
        const haft_nanoscope_list *l = &h->list[k];
        const char *title_end = l->start, *title = title_end;
        while (title > h->file->bytes && title[-1] != '\n' && title[-1] != '\r') {
            title--;
        }
        size_t n = (size_t)(title_end - title);
        bool curves = ends_with(title, n, "force image list") || ends_with(title, n, "plot list") ||
                      strncasecmp(title, "\\*EC", 4) == 0;
        if (!l->image && !curves &&
            (haft_nanoscope_find(l, "@*:Image Data", value) > 0 ||
             haft_nanoscope_find(l, "Image data", value) > 0)) {
            return refuse(h, "a line of its header that begins an image is lost; it is damaged",
                          error);
        }
    }
    return HAFT_OK;
}

bool haft_nanoscope_is_force(const haft_nanoscope *h) {
    return strncasecmp(h->file->bytes, "\\*Force", 7) == 0;
}

haft_status haft_nanoscope_open(haft_nanoscope *h, const haft_map_file *file, haft_error *error) {
    *h = (haft_nanoscope){.file = file};
    if (file->bytes[0] == '?') {
        return refuse(h,
                      "is a Nanoscope file exported as text; give the binary file that it was made "
                      "from, or export the heights as a matrix",
                      error);
    }
    if (!find_lists(h)) {
        return refuse(
            h,
            haft_nanoscope_is_force(h)
                ? "holds Nanoscope force curves, no height map"
                : "is a Nanoscope file whose header has no end (\"\\*File list end\"); it is "
                  "cut short or damaged",
            error);
    }
    haft_status status = check_line_ends(h, error);
    HAFT_THEN(status, check_titles(h, error));
    return status == HAFT_OK ? check_extents(h, error) : status;
}
