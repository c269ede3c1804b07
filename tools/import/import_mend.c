/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Corrects known faults of Gwyddion's readers.
 *
 * WSxM: the reader gives the sides of a map the unit of its heights (seen in 2.62), so that 4.8 um
 * become 4.8 nm if heights are in nm. The header has the right unit: lines "X Amplitude: 4.8 um",
 * in Latin-1. */
#include "import.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { HEADER_MOST = 1 << 16 };

/* The length after a key of the header, in metres; 0 if there is none. */
static double find_length(const char *header, const char *key) {
    const char *at = strstr(header, key);
    if (at == NULL) {
        return 0;
    }
    char *rest = NULL;
    double number = g_ascii_strtod(at + strlen(key), &rest);
    char *line = g_strndup(rest, strcspn(rest, "\r\n"));
    char *text = g_convert(line, -1, "UTF-8", "ISO-8859-1", NULL, NULL, NULL);
    int power = 0;
    GwySIUnit *unit = gwy_si_unit_new_parse(text != NULL ? text : "", &power);
    GwySIUnit *metre = gwy_si_unit_new("m");
    bool length = gwy_si_unit_equal(unit, metre);
    g_object_unref(metre);
    g_object_unref(unit);
    g_free(text);
    g_free(line);
    return length && isfinite(number) && number > 0 ? number * pow(10, power) : 0;
}

static void mend_wsxm(import_file *file, const char *path) {
    char *header = g_new0(char, HEADER_MOST + 1);
    FILE *stream = fopen(path, "rb");
    size_t n = stream != NULL ? fread(header, 1, HEADER_MOST, stream) : 0;
    char *end = g_strstr_len(header, (gssize)n, "[Header end]");
    if (stream != NULL) {
        fclose(stream);
    }
    if (end != NULL && memchr(header, '\0', (size_t)(end - header)) == NULL) {
        *end = '\0';
        double width = find_length(header, "X Amplitude:");
        double height = find_length(header, "Y Amplitude:");
        height = height > 0 ? height : width;
        for (guint k = 0; width > 0 && k < file->channels->len; k++) {
            GwyDataField *field = g_array_index(file->channels, import_channel, k).field;
            gwy_data_field_set_xreal(field, width);
            gwy_data_field_set_yreal(field, height);
        }
    }
    g_free(header);
}

void import_mend(import_file *file, const char *path, const char *reader) {
    if (strcmp(reader, "wsxmfile") == 0) {
        mend_wsxm(file, path);
    }
}
