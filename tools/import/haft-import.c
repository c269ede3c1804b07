/* SPDX-License-Identifier: GPL-3.0-or-later */
/* haft-import: converts a channel of a file that Gwyddion can read into a Gwyddion Simple Field,
 * which Haft reads. It is a program of its own, so that Haft needs neither Gwyddion nor its
 * libraries, and a crash of a foreign reader ends no other program. */
#include "import.h"

#include <argp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct arguments {
    const char *path, *output, *channel;
    bool list, force, quiet;
    int masked; /* pixels of a mask: 'm' missing, 'k' kept, 0: as the format has it */
} arguments;

enum { OPTION_LIST = 1000, OPTION_CHANNEL, OPTION_MASKED };

static const struct argp_option options[] = {
    {"channel", OPTION_CHANNEL, "NAME", 0,
     "This channel, by its title or its number; the only one of heights if left out", 0},
    {"force", 'f', NULL, 0, "Replace a file that is there already", 0},
    {"list", OPTION_LIST, NULL, 0, "Say which channels there are, and write nothing", 0},
    {"masked", OPTION_MASKED, "HOW", 0,
     "What pixels of a mask are: missing (if left out, but for Gwyddion's own files), or kept", 0},
    {"output", 'o', "FILE", 0, "Write this file; FILE.gsf in the working folder if left out", 0},
    {"quiet", 'q', NULL, 0, "Say nothing but what is wrong", 0},
    {0}};

static error_t parse(int key, char *value, struct argp_state *state) {
    arguments *a = state->input;
    switch (key) {
    case OPTION_CHANNEL:
        a->channel = value;
        return 0;
    case OPTION_LIST:
        a->list = true;
        return 0;
    case OPTION_MASKED:
        if (strcmp(value, "missing") != 0 && strcmp(value, "kept") != 0) {
            argp_error(state, "--masked %s is no choice; give one of missing, kept", value);
        }
        a->masked = value[0];
        return 0;
    case 'f':
        a->force = true;
        return 0;
    case 'o':
        a->output = value;
        return 0;
    case 'q':
        a->quiet = true;
        return 0;
    case ARGP_KEY_ARG:
        if (state->arg_num > 0) {
            argp_error(state, "one file, please; \"%s\" is too much", value);
        }
        a->path = value;
        return 0;
    case ARGP_KEY_END:
        if (state->arg_num == 0) {
            argp_error(state, "a file is needed, as in: haft-import map.sur");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const import_channel *channel_at(const import_file *file, guint k) {
    return &g_array_index(file->channels, import_channel, k);
}

/* Describes a channel: "0 "Height", 256 x 256 pixels, 1e-05 x 1e-05 m, values in m". */
static char *describe(const import_channel *c) {
    GString *line = g_string_new(NULL);
    g_string_append_printf(line, "%d \"%s\", %d x %d pixels, %.6g x %.6g %s, values %s%s",
                           c->number, c->title, gwy_data_field_get_xres(c->field),
                           gwy_data_field_get_yres(c->field), gwy_data_field_get_xreal(c->field),
                           gwy_data_field_get_yreal(c->field),
                           c->lateral[0] != '\0' ? c->lateral : "(no unit)",
                           c->unit[0] != '\0' ? "in " : "of no unit", c->unit);
    if (c->masked > 0) {
        g_string_append_printf(line, ", %zu pixels masked", c->masked);
    }
    return g_string_free(line, FALSE);
}

static void print_channels(const import_file *file, FILE *stream) {
    for (guint k = 0; k < file->channels->len; k++) {
        char *line = describe(channel_at(file, k));
        fprintf(stream, "  %s\n", line);
        g_free(line);
    }
}

/* Whether the values are heights. Gwyddion converts units to metres, so heights are in "m", unless
 * one of its own files has another unit of length. */
static bool has_heights(const import_channel *c) {
    static const char *const lengths[] = {"m",         "cm",        "mm", "um",
                                          "\xc2\xb5m", "\xce\xbcm", "nm", "pm"};
    for (size_t k = 0; k < G_N_ELEMENTS(lengths); k++) {
        if (strcmp(c->unit, lengths[k]) == 0) {
            return true;
        }
    }
    return false;
}

/* How a title matches a name: 2 if they are equal, 1 if only the direction after it differs, 0 if
 * not. */
static int matches(const import_channel *c, const char *name) {
    size_t n = strlen(name);
    return strcmp(c->title, name) == 0
               ? 2
               : n > 0 && strncmp(c->title, name, n) == 0 && strncmp(c->title + n, " [", 2) == 0;
}

static void complain_of_channels(const import_file *file, const char *what) {
    import_complain("%s:", what);
    print_channels(file, stderr);
}

/* Chooses the channel of this name: by its whole title, or by its title without the direction, or
 * by its number. */
static const import_channel *choose_named(const import_file *file, const char *path,
                                          const char *name) {
    const import_channel *titled[3] = {NULL}, *numbered = NULL;
    guint titles[3] = {0};
    for (guint k = 0; k < file->channels->len; k++) {
        const import_channel *c = channel_at(file, k);
        char *number = g_strdup_printf("%d", c->number);
        numbered = strcmp(number, name) == 0 ? c : numbered;
        titled[matches(c, name)] = c;
        titles[matches(c, name)]++;
        g_free(number);
    }
    int best = titles[2] > 0 ? 2 : 1;
    if (titles[best] == 1 || (titles[best] == 0 && numbered != NULL)) {
        return titles[best] == 1 ? titled[best] : numbered;
    }
    char *what =
        g_strdup_printf(titles[best] > 0 ? "%s: several channels are called \"%s\"; give the number"
                                         : "%s: has no channel \"%s\"; it has",
                        path, name);
    complain_of_channels(file, what);
    g_free(what);
    return NULL;
}

/* Chooses the only channel of heights; NULL, after a message, if there is not exactly one. */
static const import_channel *choose_only(const import_file *file, const char *path) {
    const import_channel *heights = NULL;
    guint lengths = 0;
    for (guint k = 0; k < file->channels->len; k++) {
        if (has_heights(channel_at(file, k))) {
            heights = channel_at(file, k);
            lengths++;
        }
    }
    if (lengths != 1) {
        char *what =
            g_strdup_printf(lengths > 0 ? "%s: several channels are of heights; choose one with "
                                          "--channel, by its title or number"
                                        : "%s: no channel is of heights; choose one with "
                                          "--channel if it is one all the same",
                            path);
        complain_of_channels(file, what);
        g_free(what);
        return NULL;
    }
    return heights;
}

static int convert(const import_file *file, const arguments *a) {
    const import_channel *c =
        a->channel != NULL ? choose_named(file, a->path, a->channel) : choose_only(file, a->path);
    if (c == NULL) {
        return IMPORT_INPUT;
    }
    char *name = g_path_get_basename(a->path);
    char *standard = g_strconcat(name, ".gsf", NULL);
    const char *output = a->output != NULL ? a->output : standard;
    bool missing = a->masked != 0 ? a->masked == 'm' : !file->own;
    int code = import_write(c, missing, output, a->force);
    if (code == IMPORT_OK && !a->quiet) {
        char *line = describe(c), *clean = import_clean(output);
        printf("%s: channel %s%s, of %s\n", clean, line,
               c->masked == 0 ? ""
               : missing      ? " (missing)"
                              : " (kept; --masked=missing leaves them out)",
               file->format);
        g_free(line);
        g_free(clean);
    }
    g_free(standard);
    g_free(name);
    return code;
}

int main(int count, char **words) {
    static const char about[] =
        "Hands one channel of a microscope's file over to Haft, as a Gwyddion Simple Field, with "
        "its title, size and units. It reads what Gwyddion reads.\vExit codes: 0 done; 2 wrong "
        "usage; 3 input that cannot be used; 4 a file cannot be read or written; 5 the file is "
        "there already; 6 Gwyddion's reader has crashed.";
    static const struct argp program = {options, parse, "FILE", about, NULL, NULL, NULL};
    arguments a = {.path = NULL};
    argp_err_exit_status = IMPORT_USAGE;
    argp_program_version = HAFT_IMPORT_VERSION;
    if (argp_parse(&program, count, words, 0, NULL, &a) != 0) {
        import_complain("out of memory");
        return IMPORT_INTERNAL;
    }
    if (!import_begin()) {
        return IMPORT_IO;
    }
    import_file file;
    int code = import_load(&file, a.path);
    if (code != IMPORT_OK) {
        return code;
    }
    if (a.list) {
        char *path = import_clean(a.path);
        printf("%s: %s\n", path, file.format);
        print_channels(&file, stdout);
        g_free(path);
    } else {
        code = convert(&file, &a);
    }
    import_free(&file);
    if (fflush(stdout) != 0 && code == IMPORT_OK) {
        import_complain("standard output cannot be written");
        code = IMPORT_IO;
    }
    return code;
}
