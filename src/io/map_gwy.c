/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gwyddion's own files (.gwy): "GWYP", then one object GwyContainer. An object is its name, a 0,
 * the length of what follows in four bytes, and its items; an item is its name, a 0, one letter for
 * its type, and its value. Numbers are little-endian. Channel N is the object GwyDataField named
 * "/N/data", its name is the text "/N/data/title", and "/N/mask" masks pixels of it. The only
 * objects inside a channel are its two units, so the reader goes no deeper than that. */
#include "map_file.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { CHANNELS_MOST = 1024, LIST_CAPACITY = 1200, TITLE_CAPACITY = 160, NUMBER_MOST = 100000000 };

/* The bytes of the file still to be read. */
typedef struct cursor {
    const unsigned char *at, *end;
} cursor;

/* An item of an object: for types 'o' and 's' with its name or text, for arrays with the count. */
typedef struct item {
    const char *name;
    char type;
    const char *text;
    size_t count;
    cursor value;
} item;

typedef struct channel {
    size_t number;
    const char *title;     /* NULL: none */
    const char *direction; /* of the scan, from the metadata; NULL: none */
    bool masked;
    cursor field; /* items of its GwyDataField */
} channel;

/* A channel's GwyDataField. */
typedef struct field {
    size_t columns, rows, count;
    double width, height;
    const char *lateral, *unit;
    const unsigned char *z; /* NULL: missing */
} field;

/* ---- objects and items ---- */

static uint64_t read_word(const unsigned char *bytes, size_t n) {
    uint64_t word = 0;
    for (size_t k = 0; k < n; k++) {
        word |= (uint64_t)bytes[k] << (8 * k);
    }
    return word;
}

static double read_double(const unsigned char *bytes) {
    uint64_t word = read_word(bytes, 8);
    double value;
    memcpy(&value, &word, sizeof value);
    return value;
}

/* Takes a text that ends in a 0; NULL if the 0 is missing. */
static const char *take_text(cursor *c) {
    const unsigned char *from = c->at, *end = memchr(from, '\0', (size_t)(c->end - from));
    if (end == NULL) {
        return NULL;
    }
    c->at = end + 1;
    return (const char *)from;
}

static bool take_bytes(cursor *c, uint64_t n, cursor *part) {
    if ((uint64_t)(c->end - c->at) < n) {
        return false;
    }
    *part = (cursor){c->at, c->at + n};
    c->at += n;
    return true;
}

static bool take_count(cursor *c, size_t *count) {
    cursor bytes;
    if (!take_bytes(c, 4, &bytes)) {
        return false;
    }
    *count = (size_t)read_word(bytes.at, 4);
    return true;
}

static bool take_object(cursor *c, const char **name, cursor *items) {
    size_t size = 0;
    *name = take_text(c);
    return *name != NULL && take_count(c, &size) && take_bytes(c, size, items);
}

/* Skips an array of texts ('S') or objects ('O'). */
static bool pass_array(cursor *c, char type, size_t count) {
    for (size_t k = 0; k < count; k++) {
        const char *name = NULL;
        cursor items;
        if (type == 'S' ? take_text(c) == NULL : !take_object(c, &name, &items)) {
            return false;
        }
    }
    return true;
}

/* Takes the next item; false if the rest of the object has no complete one. */
static bool take_item(cursor *c, item *i) {
    static const char types[] = "bciqdCIQD";
    static const size_t sizes[] = {1, 1, 4, 8, 8, 1, 4, 8, 8};
    cursor letter;
    *i = (item){.name = take_text(c), .count = 1};
    if (i->name == NULL || !take_bytes(c, 1, &letter)) {
        return false;
    }
    i->type = (char)*letter.at;
    if (i->type == 's') {
        i->text = take_text(c);
        return i->text != NULL;
    }
    if (i->type == 'o') {
        return take_object(c, &i->text, &i->value);
    }
    if (i->type >= 'A' && i->type <= 'Z' && !take_count(c, &i->count)) {
        return false;
    }
    if (i->type == 'S' || i->type == 'O') {
        return pass_array(c, i->type, i->count);
    }
    const char *known = i->type != '\0' ? strchr(types, i->type) : NULL;
    return known != NULL && take_bytes(c, (uint64_t)i->count * sizes[known - types], &i->value);
}

/* ---- channels ---- */

static haft_status damaged(const haft_map_file *file, const char *what, haft_error *error) {
    return haft_error_set(error, HAFT_ERROR_INPUT,
                          "%s: is a Gwyddion file that is cut short or damaged: %s; save it anew",
                          file->path, what);
}

static haft_status open_file(cursor *items, const haft_map_file *file, haft_error *error) {
    const unsigned char *bytes = (const unsigned char *)file->bytes;
    const char *name = NULL;
    cursor c = {bytes + 4, bytes + file->size};
    if (!take_object(&c, &name, items)) {
        return damaged(file, "its container is longer than the file", error);
    }
    if (strcmp(name, "GwyContainer") != 0) {
        return damaged(file, "it holds no GwyContainer", error);
    }
    if (c.at != c.end) {
        return damaged(file, "the file is longer than its container", error);
    }
    return HAFT_OK;
}

/* Finds N in a name "/N/...", and returns what follows; NULL for other names. */
static const char *split_name(const char *name, size_t *number) {
    *number = 0;
    if (*name != '/' || name[1] < '0' || name[1] > '9') {
        return NULL;
    }
    const char *at = name + 1;
    while (*at >= '0' && *at <= '9' && *number < NUMBER_MOST) {
        *number = 10 * *number + (size_t)(*at++ - '0');
    }
    return *at == '/' ? at + 1 : NULL;
}

static channel *find_number(channel *channels, size_t n, size_t number) {
    for (size_t k = 0; k < n; k++) {
        if (channels[k].number == number) {
            return &channels[k];
        }
    }
    return NULL;
}

/* The text of the metadata whose key ends in "direction"; NULL if there is none. Damaged metadata
 * are ignored, since they are no part of the map. */
static const char *find_direction(cursor meta) {
    static const char word[] = "direction";
    item i;
    for (cursor c = meta; c.at < c.end && take_item(&c, &i);) {
        size_t n = strlen(i.name), m = sizeof word - 1;
        if (i.type == 's' && n >= m && strcasecmp(i.name + n - m, word) == 0 && *i.text != '\0') {
            return i.text;
        }
    }
    return NULL;
}

/* Stores what an item says about a channel, other than heights. */
static void describe(channel *c, const char *what, const item *i) {
    if (strcmp(what, "data/title") == 0 && i->type == 's') {
        c->title = i->text;
    } else if (strcmp(what, "mask") == 0 && i->type == 'o') {
        c->masked = true;
    } else if (strcmp(what, "meta") == 0 && i->type == 'o') {
        c->direction = find_direction(i->value);
    }
}

/* Finds all channels in the first pass; the second reads the items about them, which may come
 * before or after them. */
static haft_status find_channels(channel *channels, size_t *n, cursor items,
                                 const haft_map_file *file, haft_error *error) {
    for (int pass = 0; pass < 2; pass++) {
        for (cursor c = items; c.at < c.end;) {
            item i;
            size_t number = 0;
            if (!take_item(&c, &i)) {
                return damaged(file, "an item reaches beyond its object", error);
            }
            const char *rest = split_name(i.name, &number);
            if (rest == NULL) {
                continue;
            }
            channel *old = find_number(channels, *n, number);
            if (pass == 0 && strcmp(rest, "data") == 0 && i.type == 'o' &&
                strcmp(i.text, "GwyDataField") == 0) {
                if (old != NULL || *n == CHANNELS_MOST) {
                    return damaged(file,
                                   old != NULL ? "two channels have one number"
                                               : "it has more than 1024 channels",
                                   error);
                }
                channels[(*n)++] = (channel){.number = number, .field = i.value};
            } else if (pass == 1 && old != NULL) {
                describe(old, rest, &i);
            }
        }
    }
    return HAFT_OK;
}

/* The text of a GwySIUnit; NULL for another object. */
static const char *read_unit(const item *i) {
    const char *unit = "";
    if (i->type != 'o' || strcmp(i->text, "GwySIUnit") != 0) {
        return NULL;
    }
    for (cursor c = i->value; c.at < c.end;) {
        item part;
        if (!take_item(&c, &part)) {
            return NULL;
        }
        if (strcmp(part.name, "unitstr") == 0 && part.type == 's') {
            unit = part.text;
        }
    }
    return unit;
}

/* Reads the items of a channel. Negative integers become large ones, which no map has. */
static bool read_field(field *f, cursor items) {
    *f = (field){.lateral = "", .unit = ""};
    for (cursor c = items; c.at < c.end;) {
        item i;
        if (!take_item(&c, &i)) {
            return false;
        }
        if (strcmp(i.name, "xres") == 0 && i.type == 'i') {
            f->columns = (size_t)read_word(i.value.at, 4);
        } else if (strcmp(i.name, "yres") == 0 && i.type == 'i') {
            f->rows = (size_t)read_word(i.value.at, 4);
        } else if (strcmp(i.name, "xreal") == 0 && i.type == 'd') {
            f->width = read_double(i.value.at);
        } else if (strcmp(i.name, "yreal") == 0 && i.type == 'd') {
            f->height = read_double(i.value.at);
        } else if (strcmp(i.name, "si_unit_xy") == 0) {
            f->lateral = read_unit(&i);
        } else if (strcmp(i.name, "si_unit_z") == 0) {
            f->unit = read_unit(&i);
        } else if (strcmp(i.name, "data") == 0 && i.type == 'D') {
            f->z = i.value.at;
            f->count = i.count;
        }
    }
    return f->lateral != NULL && f->unit != NULL;
}

/* ---- which channel ---- */

static const char *bare_title(const channel *c) {
    return c->title != NULL && c->title[0] != '\0' ? c->title : "untitled";
}

/* The title followed by the direction, "Height [Trace]", unless the title has it already. */
static const char *full_title(char title[TITLE_CAPACITY], const channel *c) {
    const char *bare = bare_title(c);
    bool told = c->direction == NULL || strcasestr(bare, c->direction) != NULL;
    snprintf(title, TITLE_CAPACITY, told ? "%.100s" : "%.100s [%.40s]", bare, c->direction);
    return title;
}

/* Lists all channels for a message: numbers, titles, units. */
static const char *list_channels(char list[LIST_CAPACITY], const channel *channels, size_t n) {
    list[0] = '\0';
    for (size_t k = 0; k < n; k++) {
        char title[TITLE_CAPACITY], quoted[48], unit[48];
        field f;
        size_t used = strlen(list);
        if (used > LIST_CAPACITY - 160) {
            snprintf(list + used, LIST_CAPACITY - used, ", ...");
            break;
        }
        full_title(title, &channels[k]);
        const char *known = read_field(&f, channels[k].field) ? f.unit : "damaged";
        snprintf(list + used, LIST_CAPACITY - used, "%s%zu \"%s\" (%s)", k > 0 ? ", " : "",
                 channels[k].number, haft_map_quote(quoted, title, strlen(title)),
                 known[0] != '\0' ? haft_map_quote(unit, known, strlen(known)) : "no unit");
    }
    return list;
}

/* Chooses the channel named by its title, with or without the direction, or by its number. */
static haft_status choose_named(const channel **chosen, const channel *channels, size_t n,
                                const haft_map_file *file, haft_error *error) {
    const char *name = file->options.channel;
    char number[24], list[LIST_CAPACITY], quoted[48], title[TITLE_CAPACITY];
    size_t titled = 0;
    const channel *numbered = NULL;
    for (size_t k = 0; k < n; k++) {
        snprintf(number, sizeof number, "%zu", channels[k].number);
        numbered = strcmp(number, name) == 0 ? &channels[k] : numbered;
        if (strcmp(bare_title(&channels[k]), name) == 0 ||
            strcmp(full_title(title, &channels[k]), name) == 0) {
            *chosen = &channels[k];
            titled++;
        }
    }
    if (titled == 0 && numbered != NULL) {
        *chosen = numbered;
        return HAFT_OK;
    }
    if (titled == 1) {
        return HAFT_OK;
    }
    return haft_error_set(error, HAFT_ERROR_INPUT,
                          titled == 0 ? "%s: has no channel \"%s\"; it has: %s"
                                      : "%s: has several channels \"%s\"; give the number of one: "
                                        "%s",
                          file->path, haft_map_quote(quoted, name, strlen(name)),
                          list_channels(list, channels, n));
}

/* Chooses the only channel of heights: its unit is a length, or it has none and the options give
 * it. */
static haft_status choose_only(const channel **chosen, const channel *channels, size_t n,
                               const haft_map_file *file, haft_error *error) {
    char list[LIST_CAPACITY];
    size_t found = 0, unitless = 0;
    for (size_t k = 0; k < n; k++) {
        field f;
        double length = 0;
        bool sound = read_field(&f, channels[k].field);
        /* a damaged channel could be the one, so it counts */
        if (!sound || haft_map_length(1, f.unit, &length) ||
            (f.unit[0] == '\0' && file->options.unit > 0)) {
            *chosen = &channels[k];
            found++;
        }
        unitless += sound && f.unit[0] == '\0';
    }
    if (found == 1) {
        return HAFT_OK;
    }
    if (n == 0) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: is a Gwyddion file without channels; volumes, graphs and points "
                              "are no height maps",
                              file->path);
    }
    return haft_error_set(error, HAFT_ERROR_INPUT,
                          found > 0 ? "%s: has several channels with heights; name one as the "
                                      "channel, by its title or number: %s"
                          : unitless > 0
                              ? "%s: has no channel with heights; if one without a unit is of "
                                "heights, give the unit, as nm; it has: %s"
                              : "%s: has no channel with heights; it has: %s",
                          file->path, list_channels(list, channels, n));
}

/* ---- the map ---- */

/* Sides and units of a channel in metres, 0 if it gives none. */
static haft_status check_field(field *f, double *unit, const haft_map_file *file, const char *title,
                               haft_error *error) {
    char quoted[48], wrong[48];
    haft_map_quote(quoted, title, strlen(title));
    if (f->rows < 2 || f->columns < 2 || f->rows > HAFT_MAP_SIDE_MOST ||
        f->columns > HAFT_MAP_SIDE_MOST) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: channel \"%s\" has %zu rows and %zu columns; a map needs 2 to "
                              "%d pixels a side",
                              file->path, quoted, f->rows, f->columns, HAFT_MAP_SIDE_MOST);
    }
    if (f->z == NULL || f->count != f->rows * f->columns) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: channel \"%s\" has %zu heights where %zu x %zu pixels need %zu; "
                              "it is damaged",
                              file->path, quoted, f->z != NULL ? f->count : 0, f->rows, f->columns,
                              f->rows * f->columns);
    }
    *unit = 0;
    if (f->unit[0] != '\0' && !haft_map_length(1, f->unit, unit)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: the values of channel \"%s\" are in \"%s\", no heights",
                              file->path, quoted, haft_map_quote(wrong, f->unit, strlen(f->unit)));
    }
    if (f->lateral[0] == '\0') {
        f->width = f->height = 0; /* pure numbers */
        return HAFT_OK;
    }
    double length = 0;
    if (!haft_map_length(1, f->lateral, &length)) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT, "%s: the sides of channel \"%s\" are in \"%s\", no lengths",
            file->path, quoted, haft_map_quote(wrong, f->lateral, strlen(f->lateral)));
    }
    f->width *= length;
    f->height *= length;
    if (!(f->width > 0 && f->height > 0 && isfinite(f->width) && isfinite(f->height))) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: channel \"%s\" is %g m x %g m large; sides must be positive",
                              file->path, quoted, f->width, f->height);
    }
    return HAFT_OK;
}

static haft_status read_channel(haft_map **out, const channel *c, const haft_map_file *file,
                                haft_error *error) {
    field f;
    double unit = 0;
    char title[TITLE_CAPACITY];
    full_title(title, c);
    if (!read_field(&f, c->field)) {
        return damaged(file, "an item of the channel reaches beyond it", error);
    }
    haft_status status = check_field(&f, &unit, file, title, error);
    HAFT_THEN(status,
              haft_map_begin(out, file, f.rows, f.columns, f.width, f.height, &unit, error));
    for (size_t i = 0; status == HAFT_OK && i < f.count; i++) {
        (*out)->z[i] = read_double(f.z + 8 * i);
    }
    HAFT_THEN(status, haft_map_end(out, file, unit, error));
    if (status == HAFT_OK) {
        haft_map_name((*out)->channel, title, strlen(title));
        snprintf((*out)->format, sizeof(*out)->format, "Gwyddion");
        if (c->masked) {
            haft_map_remark(*out, "the channel has a mask, which is not applied");
        }
    }
    return status;
}

haft_status haft_map_read_gwy(haft_map **out, const haft_map_file *file, haft_error *error) {
    cursor items = {NULL, NULL};
    size_t n = 0;
    const channel *chosen = NULL;
    HAFT_TRY(open_file(&items, file, error));
    channel *channels = haft_memory_alloc(CHANNELS_MOST, sizeof *channels, error);
    if (channels == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    haft_status status = find_channels(channels, &n, items, file, error);
    HAFT_THEN(status, file->options.channel[0] != '\0'
                          ? choose_named(&chosen, channels, n, file, error)
                          : choose_only(&chosen, channels, n, file, error));
    HAFT_THEN(status, read_channel(out, chosen, file, error));
    haft_memory_free(channels);
    return status;
}
