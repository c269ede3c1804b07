/* SPDX-License-Identifier: GPL-3.0-or-later */
/* CSV for quick plotting, made in memory and then stored whole. Names are quoted where necessary.
 */
#include "haft/io.h"
#include "store.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

haft_status haft_text_write(const char *path, const char *text, haft_error *error) {
    return haft_store_put(path, text, strlen(text), error);
}

static void write_name(FILE *stream, const char *name) {
    if (strpbrk(name, ",\"\r\n") == NULL) {
        fputs(name, stream);
        return;
    }
    fputc('"', stream);
    for (; *name != '\0'; name++) {
        if (*name == '"') {
            fputc('"', stream);
        }
        fputc(*name, stream);
    }
    fputc('"', stream);
}

static void write_rows(FILE *stream, size_t rows, size_t columns, const haft_csv_column *column) {
    for (size_t j = 0; j < columns; j++) {
        fputs(j > 0 ? "," : "", stream);
        write_name(stream, column[j].name);
    }
    fputc('\n', stream);
    for (size_t i = 0; i < rows; i++) {
        for (size_t j = 0; j < columns; j++) {
            size_t stride = column[j].stride == 0 ? 1 : column[j].stride;
            double factor = column[j].factor == 0 ? 1 : column[j].factor;
            fprintf(stream, "%s%.12g", j > 0 ? "," : "", column[j].value[i * stride] * factor);
        }
        fputc('\n', stream);
    }
}

haft_status haft_csv_write(const char *path, size_t rows, size_t columns,
                           const haft_csv_column *column, haft_error *error) {
    if (columns == 0) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT, "%s: a CSV file needs a column", path);
    }
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    bool failed = stream == NULL;
    if (!failed) {
        write_rows(stream, rows, columns, column);
        failed = ferror(stream) != 0;
        failed = fclose(stream) != 0 || failed || text == NULL; /* the last write may fail here */
    }
    if (failed) {
        free(text);
        return haft_error_set(error, HAFT_ERROR_MEMORY, "%s: out of memory for its text", path);
    }
    haft_status status = haft_store_put(path, text, size, error);
    free(text);
    return status;
}
