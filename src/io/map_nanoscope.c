/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nanoscope files: a text header of lists ("\*Ciao image list", each followed by lines "\Key:
 * value" until the next), ended by "\*File list end", and the channels' raw integers at offsets it
 * gives.
 *
 * A channel's height is raw / 2^bits times the hard value at the end of its "@2:Z scale" times the
 * sensitivity that the brackets name; the "(V/LSB)" before is the instrument's, and differs from
 * hard / 2^bits where an image was stored with a range of its own. From version 9.2 on some files
 * keep 32-bit integers and still say "Bytes/pixel: 2": there (V/LSB) decides between the two
 * powers. Old headers give "Z scale: 200 nm" for the whole 16-bit range, and the oldest, without a
 * version, "Z magnify image" in nanometres for 655.36 steps.
 *
 * A scan size of one number, or of two equal ones, is the square frame's: then the pixels are
 * square unless the aspect ratio says otherwise. Lines are stored from the bottom. */
#include "map_file.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CHANNELS_MOST = 64, LISTS_MOST = 128 };

/* Lines of one list, from behind its title to the next title. */
typedef struct list {
    const char *start, *end;
    bool image;
} list;

typedef struct header {
    const haft_map_file *file;
    list list[LISTS_MOST];
    size_t lists;
} header;

static const char *line_end(const char *at, const char *end) {
    while (at < end && *at != '\n' && *at != '\r') {
        at++;
    }
    return at;
}

/* Splits the header into lists; false if its end is missing. */
static bool find_lists(header *h) {
    const char *at = h->file->bytes, *end = at + h->file->size;
    while (at < end) {
        const char *stop = line_end(at, end);
        size_t n = (size_t)(stop - at);
        if (n >= 2 && at[0] == '\\' && at[1] == '*') {
            if (h->lists > 0) {
                h->list[h->lists - 1].end = at;
            }
            if (n >= 15 && strncasecmp(at, "\\*File list end", 15) == 0) {
                return h->lists > 0;
            }
            if (h->lists == LISTS_MOST) {
                return false;
            }
            bool image = n >= 12 && strncasecmp(stop - 10, "image list", 10) == 0;
            h->list[h->lists++] = (list){.start = stop, .end = stop, .image = image};
        } else if (n > 0 && (*at != '\\' && (unsigned char)*at < 32)) {
            return false; /* binary data: the header has no end */
        }
        at = stop;
        while (at < end && (*at == '\n' || *at == '\r')) {
            at++;
        }
    }
    return false;
}

/* The value of a key in a list, as text; false if it has none. Case does not matter. */
static bool find(const list *l, const char *key, char value[128]) {
    size_t length = strlen(key);
    for (const char *at = l->start; at < l->end;) {
        const char *stop = line_end(at, l->end);
        size_t n = (size_t)(stop - at);
        if (n > length + 1 && at[0] == '\\' && strncasecmp(at + 1, key, length) == 0 &&
            at[length + 1] == ':') {
            const char *from = at + length + 2;
            while (from < stop && *from == ' ') {
                from++;
            }
            snprintf(value, 128, "%.*s", (int)(stop - from), from);
            return true;
        }
        at = stop < l->end ? stop + 1 : stop;
    }
    return false;
}

/* In any list that is no image: sensitivities are where the instrument keeps them. */
static bool find_anywhere(const header *h, const char *key, char value[128]) {
    for (size_t k = 0; k < h->lists; k++) {
        if (!h->list[k].image && find(&h->list[k], key, value)) {
            return true;
        }
    }
    return false;
}

static bool find_number(const list *l, const char *key, double *value) {
    char text[128], *rest = NULL;
    if (!find(l, key, text)) {
        return false;
    }
    *value = strtod(text, &rest);
    return rest != text && isfinite(*value);
}

/* What a channel is called: the bracket's and the quotes' name of "S [ZSensor] "Height Sensor"", or
 * the old "Image data: Height". */
static void channel_names(const list *l, char inner[64], char outer[64]) {
    char text[128];
    inner[0] = outer[0] = '\0';
    if (find(l, "@2:Image Data", text) || find(l, "@3:Image Data", text)) {
        const char *bracket = strchr(text, '['), *quote = strchr(text, '"');
        if (bracket != NULL) {
            snprintf(inner, 64, "%.*s", (int)strcspn(bracket + 1, "]"), bracket + 1);
        }
        if (quote != NULL) {
            snprintf(outer, 64, "%.*s", (int)strcspn(quote + 1, "\""), quote + 1);
        }
    } else if (find(l, "Image data", text)) {
        snprintf(inner, 64, "%.63s", text);
        snprintf(outer, 64, "%.63s", text);
    }
}

/* ---- scales ---- */

/* The number and the unit at the end of "V [Sens. Zsens] (0.0050 V/LSB) 329.9 V". */
static bool hard_value(const char *text, double *value, char unit[24]) {
    const char *from = strrchr(text, ')');
    from = from != NULL ? from + 1 : strchr(text, ']') != NULL ? strchr(text, ']') + 1 : text;
    while (*from != '\0' && !isdigit((unsigned char)*from) && strchr("+-.", *from) == NULL) {
        from++; /* "V " where neither bracket is there */
    }
    char *rest = NULL;
    *value = strtod(from, &rest);
    unit[0] = '\0';
    sscanf(rest, "%23s", unit);
    return rest != from && isfinite(*value) && *value != 0;
}

/* Metres a unit of hard value, from "V 33.15 nm/V"; false if it is no length over that. */
static bool sensitivity(const header *h, const char *name, double *factor) {
    char key[96], text[128], unit[24] = "";
    snprintf(key, sizeof key, "@%.80s", name);
    double value = 0;
    if (!find_anywhere(h, key, text) || !hard_value(text, &value, unit)) {
        return false;
    }
    char *slash = strchr(unit, '/');
    if (slash == NULL) {
        return false;
    }
    bool milli = strcmp(slash + 1, "mV") == 0;
    if (!milli && strcmp(slash + 1, "V") != 0) {
        return false;
    }
    *slash = '\0';
    *factor = 0;
    bool known = haft_map_length(value, unit, factor);
    *factor *= milli ? 1e3 : 1;
    return known;
}

/* How much a step of the integer is of the hard scale, given bytes stored and said. */
static double step_share(const char *scale_text, double hard, size_t stored, double said) {
    double by_said = said == 4 ? 0x1p-32 : said == 1 ? 0x1p-8 : 0x1p-16;
    double by_stored = stored == 4 ? 0x1p-32 : stored == 1 ? 0x1p-8 : 0x1p-16;
    const char *bracket = strchr(scale_text, '(');
    if (by_said == by_stored || bracket == NULL) {
        return by_said;
    }
    double step = fabs(strtod(bracket + 1, NULL));
    double off_said = fabs(log(step / fabs(hard * by_said)));
    double off_stored = fabs(log(step / fabs(hard * by_stored)));
    return off_stored < off_said ? by_stored : by_said;
}

/* Metres a step of a channel's integers; 0 if it holds no heights. */
static double channel_scale(const header *h, const list *l, size_t stored, double said) {
    char text[128], unit[24], version[128];
    double hard = 0, factor = 0;
    if (find(l, "@2:Z scale", text) || find(l, "@3:Z scale", text)) {
        if (!hard_value(text, &hard, unit)) {
            return 0;
        }
        double share = step_share(text, hard, stored, said);
        const char *bracket = strchr(text, '[');
        if (bracket == NULL) {
            return haft_map_length(hard, unit, &factor) ? share * factor : 0;
        }
        char name[96];
        snprintf(name, sizeof name, "%.*s", (int)strcspn(bracket + 1, "]"), bracket + 1);
        hard *= strcmp(unit, "mV") == 0 ? 1e-3 : 1;
        return sensitivity(h, name, &factor) ? share * hard * factor : 0;
    }
    if (find_anywhere(h, "Version", version) && find(l, "Z scale", text)) {
        char *rest = NULL;
        hard = strtod(text, &rest);
        unit[0] = '\0';
        sscanf(rest, "%23s", unit);
        return rest != text && haft_map_length(hard, unit, &factor) ? 0x1p-16 * factor : 0;
    }
    if (find(l, "Z magnify image", text)) {
        return strtod(text, NULL) * 1e-9 / 655.36;
    }
    return 0;
}

/* ---- the chosen channel ---- */

static haft_status refuse(const header *h, const char *what, haft_error *error) {
    return haft_error_set(error, HAFT_ERROR_INPUT, "%s: %s", h->file->path, what);
}

/* The sides of the frame [m]. */
static haft_status read_sides(const header *h, const list *l, size_t rows, size_t columns,
                              double *width, double *height, haft_error *error) {
    char text[128], unit[24] = "";
    if (!find(l, "Scan size", text) && !find_anywhere(h, "Scan size", text)) {
        return refuse(h, "the channel has no scan size; the header is damaged", error);
    }
    double first = 0, second = 0;
    int read = sscanf(text, "%lf %lf %23s", &first, &second, unit);
    if (read < 3) {
        read = sscanf(text, "%lf %23s", &first, unit);
        second = first;
    }
    if (read < 2 || !haft_map_length(first, unit, width) ||
        !haft_map_length(second, unit, height) || !(*width > 0 && *height > 0)) {
        char quoted[48];
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: the scan size \"%s\" is no length; the header is damaged",
                              h->file->path, haft_map_quote(quoted, text, 40));
    }
    double across = 1, along = 1;
    if (*width == *height) {
        bool given = find(l, "Aspect ratio", text) || find_anywhere(h, "Aspect ratio", text);
        if (given && sscanf(text, "%lf:%lf", &along, &across) == 2 && along > 0 && across > 0 &&
            along != across) {
            *height = *width * across / along;
        } else {
            *height = *width * (double)rows / (double)columns;
        }
    }
    return HAFT_OK;
}

static double raw_value(const unsigned char *at, size_t bytes) {
    if (bytes == 2) {
        return (int16_t)((unsigned)at[0] | (unsigned)at[1] << 8);
    }
    uint32_t word =
        (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
    return (int32_t)word;
}

/* Where the channel's integers are: *stored bytes each, and what the header says of them. */
static haft_status find_data(const header *h, const list *l, size_t *rows, size_t *columns,
                             size_t *offset, size_t *stored, double *said, haft_error *error) {
    double lines = 0, samples = 0, at = 0, length = 0;
    *said = 2;
    if (!find_number(l, "Number of lines", &lines) || !find_number(l, "Samps/line", &samples) ||
        !find_number(l, "Data offset", &at) || !find_number(l, "Data length", &length)) {
        return refuse(h,
                      "the channel lacks its number of lines, samples a line, data offset or data "
                      "length; the header is damaged",
                      error);
    }
    (void)find_number(l, "Bytes/pixel", said);
    if (!(lines >= 2 && lines <= 32768 && samples >= 2 && samples <= 32768 && at > 0 && at < 1e12 &&
          length > 0 && length < 1e12)) {
        return refuse(h, "the header's counts of pixels or bytes make no sense; it is damaged",
                      error);
    }
    *rows = (size_t)lines;
    *columns = (size_t)samples;
    *offset = (size_t)at;
    size_t pixels = *rows * *columns, bytes = (size_t)length;
    *stored = bytes / pixels;
    if ((*stored != 2 && *stored != 4) || (*said != 2 && *said != 4)) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "%s: %zu bytes of data for %zu x %zu pixels of %g bytes; only 2 and 4 "
            "bytes a pixel are known",
            h->file->path, bytes, *rows, *columns, *said);
    }
    if (*offset > h->file->size || h->file->size - *offset < *stored * pixels) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: is cut short: the channel's data end at byte %zu, the file at "
                              "%zu",
                              h->file->path, *offset + *stored * pixels, h->file->size);
    }
    return HAFT_OK;
}

static haft_status read_channel(haft_map **out, const header *h, const list *l, haft_error *error) {
    size_t rows = 0, columns = 0, offset = 0, stored = 0;
    double said = 0, width = 0, height = 0;
    haft_status status = find_data(h, l, &rows, &columns, &offset, &stored, &said, error);
    if (status == HAFT_OK) {
        status = read_sides(h, l, rows, columns, &width, &height, error);
    }
    if (status != HAFT_OK) {
        return status;
    }
    double scale = channel_scale(h, l, stored, said);
    if (!(fabs(scale) > 0 && isfinite(scale))) {
        return refuse(h, "the channel has no z-scale in metres; choose one with heights", error);
    }
    double unit = 1;
    status = haft_map_begin(out, h->file, rows, columns, width, height, &unit, error);
    for (size_t i = 0; status == HAFT_OK && i < rows; i++) {
        const unsigned char *line =
            (const unsigned char *)h->file->bytes + offset + (rows - 1 - i) * columns * stored;
        for (size_t j = 0; j < columns; j++) {
            (*out)->z[i * columns + j] = scale * raw_value(line + j * stored, stored);
        }
    }
    return status == HAFT_OK ? haft_map_end(out, h->file, unit, error) : status;
}

/* Whether a channel is the one asked for; if none is, the first that can be metres. */
static bool is_wanted(const header *h, const list *l, const char inner[64], const char outer[64]) {
    const char *wanted = h->file->options.channel;
    if (wanted[0] != '\0') {
        return strcasecmp(wanted, inner) == 0 || strcasecmp(wanted, outer) == 0;
    }
    bool height = strncasecmp(inner, "Height", 6) == 0 || strncasecmp(outer, "Height", 6) == 0 ||
                  strcasecmp(inner, "ZSensor") == 0;
    return height && channel_scale(h, l, 2, 2) != 0;
}

static haft_status choose(haft_map **out, const header *h, haft_error *error) {
    char names[512] = "";
    size_t used = 0, images = 0;
    for (size_t k = 0; k < h->lists; k++) {
        char inner[64], outer[64];
        channel_names(&h->list[k], inner, outer);
        if (!h->list[k].image && inner[0] == '\0') {
            continue;
        }
        if (!h->list[k].image) {
            return refuse(h, "a line of its header that begins an image is lost; it is damaged",
                          error);
        }
        images++;
        const char *name = outer[0] != '\0' ? outer : inner;
        if (is_wanted(h, &h->list[k], inner, outer)) {
            haft_status status = read_channel(out, h, &h->list[k], error);
            if (status == HAFT_OK) {
                haft_map_name((*out)->channel, name, strlen(name));
                snprintf((*out)->format, sizeof(*out)->format, "Nanoscope");
            }
            return status;
        }
        char quoted[48];
        int wrote = snprintf(names + used, sizeof names - used, "%s%s", used > 0 ? ", " : "",
                             haft_map_quote(quoted, name, 40));
        used = wrote < 0 || used + (size_t)wrote >= sizeof names ? used : used + (size_t)wrote;
    }
    char quoted[48];
    return images == 0 ? refuse(h, "its header lists no image", error)
                       : haft_error_set(error, HAFT_ERROR_INPUT,
                                        "%s: has no channel %s%s%s; it has: %s", h->file->path,
                                        h->file->options.channel[0] != '\0' ? "\"" : "of heights",
                                        haft_map_quote(quoted, h->file->options.channel, 40),
                                        h->file->options.channel[0] != '\0' ? "\"" : "", names);
}

haft_status haft_map_read_nanoscope(haft_map **out, const haft_map_file *file, haft_error *error) {
    header *h = haft_memory_alloc(1, sizeof *h, error);
    if (h == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    h->file = file;
    haft_status status = find_lists(h)
                             ? choose(out, h, error)
                             : refuse(h,
                                      "is a Nanoscope file whose header has no end "
                                      "(\"\\*File list end\"); it is cut short or damaged",
                                      error);
    haft_memory_free(h);
    return status;
}
