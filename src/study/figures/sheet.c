/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of figures: filled row by row, then written whole as CSV and freed. */
#include "sheet.h"

haft_status haft_sheet_make(haft_sheet *t, size_t rows, size_t columns, haft_error *error) {
    *t = (haft_sheet){rows, columns, haft_memory_alloc(rows * columns, sizeof(double), error),
                      haft_memory_alloc(columns, sizeof(haft_csv_column), error)};
    if (t->value == NULL || t->column == NULL) {
        haft_sheet_drop(t);
        return HAFT_ERROR_MEMORY;
    }
    for (size_t j = 0; j < columns; j++) {
        t->column[j] = (haft_csv_column){"", t->value + j, columns, 1};
    }
    return HAFT_OK;
}

void haft_sheet_name(haft_sheet *t, const char *const *name) {
    for (size_t j = 0; j < t->columns; j++) {
        t->column[j].name = name[j];
    }
}

haft_status haft_sheet_write(haft_sheet *t, const char *directory, const char *name,
                             haft_error *error) {
    char path[4096];
    haft_status status = haft_path_join(path, sizeof path, directory, name, error);
    HAFT_THEN(status, haft_csv_write(path, t->rows, t->columns, t->column, error));
    haft_sheet_drop(t);
    return status;
}

void haft_sheet_drop(haft_sheet *t) {
    haft_memory_free(t->value);
    haft_memory_free(t->column);
    *t = (haft_sheet){0};
}
