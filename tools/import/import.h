/* SPDX-License-Identifier: GPL-3.0-or-later */
/* haft-import: channels of foreign files, read by Gwyddion's own modules, and their way into a
 * Gwyddion Simple Field. */
#ifndef HAFT_TOOLS_IMPORT_H
#define HAFT_TOOLS_IMPORT_H

#include <libgwyddion/gwyddion.h>
#include <libprocess/gwyprocess.h>

#include <stdbool.h>
#include <stddef.h>

/* Exit codes, as those of haft. */
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
    bool own;           /* Gwyddion's own, where a mask is the user's and no gap in the data */
    GArray *channels;   /* of import_channel, by number */
} import_file;

/* Makes Gwyddion's types and modules ready, without a display. @return false after a message. */
bool import_begin(void);

/* Reads a file. A crash in the foreign reader ends the program with IMPORT_INTERNAL and a message.
 * @return IMPORT_OK, or another exit code after a message */
int import_load(import_file *file, const char *path);

/* Mends what a reader of Gwyddion is known to get wrong. */
void import_mend(import_file *file, const char *path, const char *reader);

void import_free(import_file *file);

/* Writes a channel, whole or not at all; `mask_missing`: pixels of its mask are missing.
 * @return an exit code, after a message where that is not IMPORT_OK */
int import_write(const import_channel *channel, bool mask_missing, const char *path, bool force);

/* One line to standard error, with what could steer a terminal replaced by '?'. */
void import_complain(const char *format, ...) G_GNUC_PRINTF(1, 2);

/* A text without control characters or bytes that are no UTF-8; freed with g_free(). */
char *import_clean(const char *text);

#endif
