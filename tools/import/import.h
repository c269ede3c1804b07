/* SPDX-License-Identifier: GPL-3.0-or-later */
/* haft-import: reads channels of foreign files with Gwyddion's modules, and writes one as a
 * Gwyddion Simple Field. */
#ifndef HAFT_TOOLS_IMPORT_H
#define HAFT_TOOLS_IMPORT_H

#include <libgwyddion/gwyddion.h>
#include <libprocess/gwyprocess.h>

#include <stdbool.h>
#include <stddef.h>

/* Exit codes, the same as those of haft. */
enum { IMPORT_OK = 0, IMPORT_USAGE = 2, IMPORT_INPUT = 3, IMPORT_IO = 4, IMPORT_EXISTS = 5 };
enum { IMPORT_INTERNAL = 6 };

typedef struct import_channel {
    int number;
    char *title; /* with the direction of the scan, if the file gives one */
    char *lateral, *unit;
    GwyDataField *field;
    GwyDataField *mask; /* NULL: none */
    size_t masked;      /* pixels */
} import_channel;

typedef struct import_file {
    GwyContainer *container;
    const char *format; /* as Gwyddion describes it */
    bool own; /* Gwyddion's own format, where a mask is the user's and marks no gap in the data */
    GArray *channels; /* of import_channel, by number */
} import_file;

/* Loads Gwyddion's types and modules, without a display. @return false after a message */
bool import_begin(void);

/* Reads a file. If the foreign reader crashes, the program ends with IMPORT_INTERNAL and a message.
 * @return IMPORT_OK, or another exit code after a message */
int import_load(import_file *file, const char *path);

/* Corrects known faults of Gwyddion's readers. */
void import_mend(import_file *file, const char *path, const char *reader);

void import_free(import_file *file);

/* Writes a channel, all or nothing. With `mask_missing` the pixels of its mask are missing. @return
 * IMPORT_OK, or another exit code after a message */
int import_write(const import_channel *channel, bool mask_missing, const char *path, bool force);

/* Prints one line to standard error. Characters that could steer a terminal are replaced by '?'. */
void import_complain(const char *format, ...) G_GNUC_PRINTF(1, 2);

/* Copies a text without control characters and without bytes that are not UTF-8. Free it with
 * g_free(). */
char *import_clean(const char *text);

#endif
