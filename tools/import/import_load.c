/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a file with Gwyddion's modules. Only those that read files are loaded, from Gwyddion's own
 * folder. None of them needs a display as long as the user is asked nothing. Types have to be
 * registered, and colour gradients loaded, since some readers look them up. */
#include "import.h"

#include <libdraw/gwydraw.h>
#include <libgwydgets/gwydgets.h>
#include <libgwymodule/gwymodule.h>

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

void import_complain(const char *format, ...) {
    va_list list;
    va_start(list, format);
    char *text = g_strdup_vprintf(format, list), *line = import_clean(text);
    va_end(list);
    fprintf(stderr, "haft-import: %s\n", line);
    g_free(line);
    g_free(text);
}

char *import_clean(const char *text) {
    char *valid = g_utf8_make_valid(text, -1);
    GString *clean = g_string_new(NULL);
    for (char *at = valid; *at != '\0'; at = g_utf8_next_char(at)) {
        gunichar c = g_utf8_get_char(at);
        if (c == '\n' || c == '\r' || c == '\t') {
            c = ' ';
        }
        g_string_append_unichar(clean, g_unichar_isprint(c) ? c : '?');
    }
    g_free(valid);
    return g_string_free(clean, FALSE);
}

static void stay_silent(const char *domain, GLogLevelFlags level, const char *message,
                        gpointer data) {
    (void)domain;
    (void)level;
    (void)message;
    (void)data;
}

static void count_function(gpointer name, gpointer count) {
    (void)name;
    ++*(guint *)count;
}

bool import_begin(void) {
    /* other messages of the readers are meant for their authors */
    g_log_set_default_handler(stay_silent, NULL);
    gwy_widgets_type_init();
    gwy_resource_class_load(g_type_class_peek(GWY_TYPE_GRADIENT));
    char *modules = gwy_find_self_dir("modules");
    char *readers = modules != NULL ? g_build_filename(modules, "file", NULL) : NULL;
    const char *folders[] = {readers, NULL};
    guint functions = 0;
    if (readers != NULL && g_file_test(readers, G_FILE_TEST_IS_DIR)) {
        gwy_module_register_modules(folders);
        gwy_file_func_foreach(count_function, &functions);
    }
    if (functions == 0) {
        import_complain("Gwyddion's modules are not in %s, or cannot be loaded; install Gwyddion "
                        "itself (Debian: apt install gwyddion)",
                        readers != NULL ? readers : "their place");
    }
    g_free(readers);
    g_free(modules);
    return functions > 0;
}

/* ---- crashes ---- */

/* The message for a crash, made before it can happen. */
static char crash_message[400];

static void end_crashed(int signal_number) {
    (void)signal_number;
    ssize_t written = write(STDERR_FILENO, crash_message, strlen(crash_message));
    _exit(written >= 0 ? IMPORT_INTERNAL : IMPORT_IO);
}

static void catch_crashes(const char *path) {
    static const int signals[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
    char *name = import_clean(path);
    g_snprintf(crash_message, sizeof crash_message,
               "haft-import: %.200s: Gwyddion's reader of this format has crashed; the file may be "
               "damaged. Nothing was written\n",
               name);
    g_free(name);
    for (size_t k = 0; k < G_N_ELEMENTS(signals); k++) {
        signal(signals[k], end_crashed);
    }
}

/* ---- channels ---- */

static char *get_text(GwyContainer *container, const char *format, int number) {
    const guchar *text = NULL;
    char *key = g_strdup_printf(format, number);
    if (!gwy_container_gis_string_by_name(container, key, &text)) {
        text = (const guchar *)"";
    }
    g_free(key);
    return g_strdup((const char *)text);
}

/* The first direction in the metadata of a channel, in the order of their keys. */
typedef struct direction {
    const char *key, *value;
} direction;

static void find_direction(gpointer key, gpointer value, gpointer data) {
    direction *found = data;
    const char *name = g_quark_to_string(GPOINTER_TO_UINT(key));
    GValue *text = value;
    char *low = name != NULL ? g_ascii_strdown(name, -1) : NULL;
    if (low != NULL && g_str_has_suffix(low, "direction") && G_VALUE_HOLDS_STRING(text) &&
        g_value_get_string(text) != NULL && strlen(g_value_get_string(text)) <= 24 &&
        (found->key == NULL || strcmp(name, found->key) < 0)) {
        *found = (direction){name, g_value_get_string(text)};
    }
    g_free(low);
}

/* Makes the title of a channel, followed by its direction unless the title has it already. */
static char *make_title(GwyContainer *container, int number) {
    char *title = get_text(container, "/%d/data/title", number);
    char *key = g_strdup_printf("/%d/meta", number);
    GObject *meta = NULL;
    direction found = {NULL, NULL};
    if (gwy_container_gis_object_by_name(container, key, (gpointer)&meta) &&
        GWY_IS_CONTAINER(meta)) {
        gwy_container_foreach(GWY_CONTAINER(meta), NULL, find_direction, &found);
    }
    g_free(key);
    char *clean = import_clean(title[0] != '\0' ? title : "untitled");
    g_free(title);
    if (found.value == NULL || found.value[0] == '\0') {
        return clean;
    }
    char *low_title = g_utf8_casefold(clean, -1), *value = import_clean(found.value);
    char *low_value = g_utf8_casefold(value, -1);
    bool said = strstr(low_title, low_value) != NULL;
    char *whole = said ? g_strdup(clean) : g_strdup_printf("%s [%s]", clean, value);
    g_free(low_title);
    g_free(low_value);
    g_free(value);
    g_free(clean);
    return whole;
}

static char *get_unit(GwySIUnit *unit) {
    char *text = gwy_si_unit_get_string(unit, GWY_SI_UNIT_FORMAT_PLAIN);
    char *clean = import_clean(text);
    g_free(text);
    return clean;
}

static void add_channel(gpointer key, gpointer value, gpointer data) {
    import_file *file = data;
    const char *name = g_quark_to_string(GPOINTER_TO_UINT(key));
    int number = 0, end = 0;
    if (name == NULL || sscanf(name, "/%9d/data%n", &number, &end) != 1 || end == 0 ||
        name[end] != '\0' || number < 0 || !G_VALUE_HOLDS_OBJECT((GValue *)value)) {
        return;
    }
    GObject *field = g_value_get_object(value), *mask = NULL;
    if (!GWY_IS_DATA_FIELD(field)) {
        return;
    }
    import_channel c = {.number = number,
                        .title = make_title(file->container, number),
                        .field = GWY_DATA_FIELD(field)};
    c.lateral = get_unit(gwy_data_field_get_si_unit_xy(c.field));
    c.unit = get_unit(gwy_data_field_get_si_unit_z(c.field));
    char *mask_key = g_strdup_printf("/%d/mask", number);
    if (gwy_container_gis_object_by_name(file->container, mask_key, (gpointer)&mask) &&
        GWY_IS_DATA_FIELD(mask) &&
        gwy_data_field_get_xres(GWY_DATA_FIELD(mask)) == gwy_data_field_get_xres(c.field) &&
        gwy_data_field_get_yres(GWY_DATA_FIELD(mask)) == gwy_data_field_get_yres(c.field)) {
        c.mask = GWY_DATA_FIELD(mask);
        const double *set = gwy_data_field_get_data_const(c.mask);
        int n = gwy_data_field_get_xres(c.mask) * gwy_data_field_get_yres(c.mask);
        for (int i = 0; i < n; i++) {
            c.masked += set[i] > 0;
        }
    }
    g_free(mask_key);
    g_array_append_val(file->channels, c);
}

static int compare_numbers(gconstpointer a, gconstpointer b) {
    const import_channel *first = a, *second = b;
    return (first->number > second->number) - (first->number < second->number);
}

int import_load(import_file *file, const char *path) {
    GError *error = NULL;
    const char *reader = NULL;
    *file = (import_file){.container = NULL};
    if (!g_file_test(path, G_FILE_TEST_IS_REGULAR)) {
        import_complain("%s: %s", path,
                        g_file_test(path, G_FILE_TEST_EXISTS) ? "is no regular file"
                                                              : "there is no such file");
        return IMPORT_IO;
    }
    if (access(path, R_OK) != 0) {
        import_complain("%s: cannot be read", path);
        return IMPORT_IO;
    }
    catch_crashes(path);
    file->container = gwy_file_load_with_func(path, GWY_RUN_NONINTERACTIVE, &reader, &error);
    if (file->container == NULL) {
        import_complain("%s: Gwyddion cannot read it%s%s: %s", path, reader != NULL ? " as " : "",
                        reader != NULL ? gwy_file_func_get_description(reader) : "",
                        error != NULL ? error->message : "it does not say why");
        g_clear_error(&error);
        return IMPORT_INPUT;
    }
    const char *said = reader != NULL ? gwy_file_func_get_description(reader) : NULL;
    file->format = said != NULL ? said : "unknown format";
    file->own = reader != NULL && strcmp(reader, "gwyfile") == 0;
    file->channels = g_array_new(FALSE, FALSE, sizeof(import_channel));
    gwy_container_foreach(file->container, NULL, add_channel, file);
    g_array_sort(file->channels, compare_numbers);
    import_mend(file, path, reader != NULL ? reader : "");
    if (file->channels->len == 0) {
        import_complain("%s: holds no channels (%s); curves, volumes and points are no height maps",
                        path, file->format);
        import_free(file);
        return IMPORT_INPUT;
    }
    return IMPORT_OK;
}

void import_free(import_file *file) {
    for (guint k = 0; file->channels != NULL && k < file->channels->len; k++) {
        import_channel *c = &g_array_index(file->channels, import_channel, k);
        g_free(c->title);
        g_free(c->lateral);
        g_free(c->unit);
    }
    if (file->channels != NULL) {
        g_array_free(file->channels, TRUE);
    }
    if (file->container != NULL) {
        g_object_unref(file->container);
    }
    *file = (import_file){.container = NULL};
}
