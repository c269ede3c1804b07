/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The choice of a channel of a Nanoscope file. A channel has a name in brackets and one in quotes
 * ("S [ZSensor] "Height Sensor"", in old headers "Image data: Height"), and a direction: of the
 * line (trace or retrace) and of the pass (main or interleave). Several may have the same name.
 *
 * The user asks for a channel by its name. After the name may follow, in any order, with or without
 * parentheses: trace, retrace, main, interleave, or a number that counts the channels of that name.
 * If several channels fit, trace is preferred to retrace and main to interleave. */
#include "map_nanoscope.h"

#include <stdio.h>
#include <string.h>

enum { NAME = 64 };

typedef struct entry {
    const haft_nanoscope_list *list;
    char inner[NAME], outer[NAME];
    bool trace, retrace, interleave;
    size_t number, same; /* its number among the channels of its name, and their count */
} entry;

typedef struct table {
    const haft_nanoscope *header;
    size_t n;
    entry entry[HAFT_NANOSCOPE_LISTS];
} table;

static const char *name_of(const entry *e) {
    return e->outer[0] != '\0' ? e->outer : e->inner;
}

static bool has_name(const entry *e, const char *name, size_t n) {
    return (strlen(e->inner) == n && strncasecmp(e->inner, name, n) == 0) ||
           (strlen(e->outer) == n && strncasecmp(e->outer, name, n) == 0);
}

static void read_names(entry *e) {
    char text[HAFT_NANOSCOPE_VALUE];
    if (haft_nanoscope_find(e->list, "@*:Image Data", text) > 0) {
        const char *bracket = strchr(text, '['), *quote = strchr(text, '"');
        if (bracket != NULL) {
            snprintf(e->inner, NAME, "%.*s", (int)strcspn(bracket + 1, "]"), bracket + 1);
        }
        if (quote != NULL) {
            snprintf(e->outer, NAME, "%.*s", (int)strcspn(quote + 1, "\""), quote + 1);
        }
    } else if (haft_nanoscope_find(e->list, "Image data", text) > 0) {
        snprintf(e->outer, NAME, "%.63s", text);
    }
    bool line = haft_nanoscope_find(e->list, "Line direction", text) > 0;
    e->trace = line && strcasecmp(text, "Trace") == 0;
    e->retrace = line && strcasecmp(text, "Retrace") == 0;
    e->interleave =
        haft_nanoscope_find(e->list, "Scan line", text) > 0 && strcasecmp(text, "Interleave") == 0;
}

static void fill(table *t, const haft_nanoscope *h) {
    t->header = h;
    for (size_t k = 0; k < h->lists; k++) {
        if (h->list[k].image) {
            t->entry[t->n].list = &h->list[k];
            read_names(&t->entry[t->n++]);
        }
    }
    for (size_t i = 0; i < t->n; i++) {
        entry *e = &t->entry[i];
        for (size_t j = 0; j < t->n; j++) {
            bool same = strcasecmp(name_of(e), name_of(&t->entry[j])) == 0;
            e->same += same;
            e->number += same && j <= i;
        }
    }
}

static bool is_like(const entry *a, const entry *b) {
    return strcasecmp(name_of(a), name_of(b)) == 0 && a->trace == b->trace &&
           a->retrace == b->retrace && a->interleave == b->interleave;
}

/* The text by which the user can ask for a channel: "Height (retrace)", or with its number if
 * others are just like it. */
static void label(const table *t, const entry *e, char text[HAFT_CHANNEL_CAPACITY]) {
    size_t like = 0;
    for (size_t i = 0; i < t->n; i++) {
        like += is_like(&t->entry[i], e);
    }
    char clean[HAFT_CHANNEL_CAPACITY];
    haft_map_name(clean, name_of(e), strlen(name_of(e)));
    bool direction = (e->same > 1 && e->trace) || e->retrace;
    if (like > 1) {
        snprintf(text, HAFT_CHANNEL_CAPACITY, "%.40s %zu", clean, e->number);
    } else if (direction || e->interleave) {
        snprintf(text, HAFT_CHANNEL_CAPACITY, "%.40s (%s%s%s)", clean,
                 !direction   ? ""
                 : e->retrace ? "retrace"
                              : "trace",
                 direction && e->interleave ? ", " : "", e->interleave ? "interleave" : "");
    } else {
        memcpy(text, clean, sizeof clean);
    }
}

/* Lists all channels but one: "Height (trace), Height (retrace)"; cuts a long list. */
static void list_labels(const table *t, const entry *but, char *text, size_t capacity) {
    size_t used = 0;
    text[0] = '\0';
    for (size_t i = 0; i < t->n; i++) {
        char one[HAFT_CHANNEL_CAPACITY];
        if (&t->entry[i] == but) {
            continue;
        }
        label(t, &t->entry[i], one);
        if (used + strlen(one) + 6 > capacity) {
            snprintf(text + used, capacity - used, " ...");
            return;
        }
        used += (size_t)snprintf(text + used, capacity - used, "%s%s", used > 0 ? ", " : "", one);
    }
}

/* ---- the request ---- */

typedef struct wish {
    const char *name;
    size_t length;
    bool trace, retrace, main, interleave;
    size_t number;
} wish;

/* Takes one of the words after a name; false if it is unknown. */
static bool take_word(wish *w, const char *word, size_t n) {
    struct {
        const char *name;
        bool *flag;
    } words[] = {{"trace", &w->trace},
                 {"retrace", &w->retrace},
                 {"main", &w->main},
                 {"interleave", &w->interleave}};
    for (size_t k = 0; k < sizeof words / sizeof *words; k++) {
        if (strlen(words[k].name) == n && strncasecmp(words[k].name, word, n) == 0) {
            *words[k].flag = true;
            return true;
        }
    }
    size_t number = 0;
    for (size_t i = 0; i < n; i++) {
        if (word[i] < '0' || word[i] > '9' || n > 3) {
            return false;
        }
        number = 10 * number + (size_t)(word[i] - '0');
    }
    w->number = number;
    return number > 0;
}

/* Takes the words after the name; false if one is unknown. */
static bool read_words(wish *w, const char *text) {
    static const char between[] = " \t(),;[]";
    bool any = false;
    for (text += strspn(text, between); *text != '\0'; text += strspn(text, between)) {
        size_t n = strcspn(text, between);
        if (!take_word(w, text, n)) {
            return false;
        }
        any = true;
        text += n;
    }
    return any;
}

/* Splits a request into the longest name of a channel at its beginning, and words. */
static bool read_wish(wish *w, const table *t, const char *text) {
    for (size_t n = strlen(text); n > 0; n--) {
        bool whole = text[n] == '\0', known = false;
        if (!whole && strchr(" \t(,", text[n]) == NULL && text[n - 1] != ' ') {
            continue;
        }
        for (size_t i = 0; !known && i < t->n; i++) {
            known = has_name(&t->entry[i], text, n);
        }
        *w = (wish){.name = text, .length = n};
        if (known && (whole || read_words(w, text + n))) {
            return true;
        }
    }
    return false;
}

static bool fits(const wish *w, const entry *e) {
    return has_name(e, w->name, w->length) && (!w->trace || e->trace) &&
           (!w->retrace || e->retrace) && (!w->main || !e->interleave) &&
           (!w->interleave || e->interleave);
}

static int rank(const entry *e) {
    return (e->retrace ? 2 : 0) + (e->interleave ? 1 : 0);
}

/* The best channel that fits; NULL if there is none. `equals` counts the equally good ones. */
static const entry *pick(const wish *w, const table *t, size_t *equals) {
    const entry *best = NULL;
    size_t count = 0;
    *equals = 0;
    for (size_t i = 0; i < t->n; i++) {
        const entry *e = &t->entry[i];
        if (!fits(w, e) || (w->number > 0 && ++count != w->number)) {
            continue;
        }
        if (best == NULL || rank(e) < rank(best)) {
            best = e;
            *equals = 0;
        }
        *equals += rank(e) == rank(best);
    }
    return best;
}

/* ---- the choice ---- */

static bool is_height(const table *t, const entry *e) {
    bool named = strncasecmp(e->inner, "Height", 6) == 0 ||
                 strncasecmp(e->outer, "Height", 6) == 0 || strcasecmp(e->inner, "ZSensor") == 0;
    double scale = 0;
    return named && haft_nanoscope_get_scale(&scale, t->header, e->list, 2, 2, NULL) == HAFT_OK;
}

/* The first channel whose values can be metres, or the trace that belongs to it. */
static const entry *pick_default(const table *t) {
    for (size_t i = 0; i < t->n; i++) {
        if (is_height(t, &t->entry[i])) {
            const char *name = name_of(&t->entry[i]);
            size_t equals = 0;
            return pick(&(wish){.name = name, .length = strlen(name)}, t, &equals);
        }
    }
    return NULL;
}

static haft_status refuse(const table *t, const char *what, haft_error *error) {
    char labels[300], quoted[48];
    const char *wanted = t->header->file->options.channel;
    const char *quote = wanted[0] != '\0' ? "\"" : "";
    list_labels(t, NULL, labels, sizeof labels);
    return haft_error_set(
        error, HAFT_ERROR_INPUT, "%s: %s %s%s%s; it has: %s", t->header->file->path, what, quote,
        wanted[0] != '\0' ? haft_map_quote(quoted, wanted, 40) : "of heights", quote, labels);
}

static haft_status choose(haft_nanoscope_channel *chosen, const table *t, haft_error *error) {
    const char *wanted = t->header->file->options.channel;
    const entry *e = NULL;
    bool open = wanted[0] == '\0'; /* the user has not chosen a channel */
    if (open) {
        e = pick_default(t);
    } else {
        wish w;
        size_t equals = 0;
        e = read_wish(&w, t, wanted) ? pick(&w, t, &equals) : NULL;
        if (e != NULL && equals > 1) {
            return refuse(t, "has several channels", error);
        }
        open = e != NULL && e->same > 1 && wanted[w.length] == '\0';
    }
    if (e == NULL) {
        return refuse(t, "has no channel", error);
    }
    chosen->list = e->list;
    label(t, e, chosen->label);
    chosen->remark[0] = '\0';
    if (open && t->n > 1) {
        char others[200];
        list_labels(t, e, others, sizeof others);
        snprintf(chosen->remark, sizeof chosen->remark, "other channels: %s", others);
    }
    return HAFT_OK;
}

haft_status haft_nanoscope_choose(haft_nanoscope_channel *chosen, const haft_nanoscope *h,
                                  haft_error *error) {
    table *t = haft_memory_alloc(1, sizeof *t, error);
    if (t == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    fill(t, h);
    haft_status status = t->n > 0
                             ? choose(chosen, t, error)
                             : haft_error_set(error, HAFT_ERROR_INPUT, "%s: %s", h->file->path,
                                              haft_nanoscope_is_force(h)
                                                  ? "holds Nanoscope force curves, no height map"
                                                  : "its header lists no image");
    haft_memory_free(t);
    return status;
}
