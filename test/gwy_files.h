/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gwyddion's own files, written by the tests item by item. */
#ifndef HAFT_TEST_GWY_FILES_H
#define HAFT_TEST_GWY_FILES_H

#include "scratch.h"

/* An object, or the items of one. To be freed with free(bytes). */
typedef struct gwy_part {
    char *bytes;
    size_t size;
} gwy_part;

static inline void gwy_put(gwy_part *p, const void *bytes, size_t size) {
    p->bytes = realloc(p->bytes, p->size + size + 1);
    assert_non_null(p->bytes);
    memcpy(p->bytes + p->size, bytes, size);
    p->size += size;
}

static inline void gwy_put_word(gwy_part *p, uint64_t word, size_t n) {
    for (size_t k = 0; k < n; k++) {
        char byte = (char)(word >> (8 * k));
        gwy_put(p, &byte, 1);
    }
}

/* The name of an item and the letter of its type. */
static inline void gwy_put_name(gwy_part *p, const char *name, char type) {
    gwy_put(p, name, strlen(name) + 1);
    gwy_put(p, &type, 1);
}

static inline void gwy_put_int(gwy_part *p, const char *name, uint32_t value) {
    gwy_put_name(p, name, 'i');
    gwy_put_word(p, value, 4);
}

static inline void gwy_put_double(gwy_part *p, const char *name, double value) {
    uint64_t word = 0;
    memcpy(&word, &value, 8);
    gwy_put_name(p, name, 'd');
    gwy_put_word(p, word, 8);
}

static inline void gwy_put_text(gwy_part *p, const char *name, const char *text) {
    gwy_put_name(p, name, 's');
    gwy_put(p, text, strlen(text) + 1);
}

static inline void gwy_put_doubles(gwy_part *p, const char *name, const double *value, size_t n) {
    gwy_put_name(p, name, 'D');
    gwy_put_word(p, n, 4);
    for (size_t i = 0; i < n; i++) {
        uint64_t word = 0;
        memcpy(&word, &value[i], 8);
        gwy_put_word(p, word, 8);
    }
}

/* An object with these items, which it frees. */
static inline void gwy_put_object(gwy_part *p, const char *name, const char *object,
                                  gwy_part items) {
    if (name != NULL) {
        gwy_put_name(p, name, 'o');
    }
    gwy_put(p, object, strlen(object) + 1);
    gwy_put_word(p, items.size, 4);
    if (items.size > 0) {
        gwy_put(p, items.bytes, items.size);
    }
    free(items.bytes);
}

static inline void gwy_put_unit(gwy_part *p, const char *name, const char *unit) {
    gwy_part items = {NULL, 0};
    gwy_put_text(&items, "unitstr", unit);
    gwy_put_object(p, name, "GwySIUnit", items);
}

/* What a channel or a mask is made of. */
typedef struct gwy_field {
    uint32_t columns, rows;
    double width, height;
    const char *lateral, *unit; /* NULL: no such item */
    const double *z;
} gwy_field;

static inline void gwy_put_field(gwy_part *p, const char *name, const gwy_field *f) {
    gwy_part items = {NULL, 0};
    gwy_put_int(&items, "xres", f->columns);
    gwy_put_int(&items, "yres", f->rows);
    gwy_put_double(&items, "xreal", f->width);
    gwy_put_double(&items, "yreal", f->height);
    gwy_put_double(&items, "xoff", 1e-6);
    if (f->lateral != NULL) {
        gwy_put_unit(&items, "si_unit_xy", f->lateral);
    }
    if (f->unit != NULL) {
        gwy_put_unit(&items, "si_unit_z", f->unit);
    }
    gwy_put_doubles(&items, "data", f->z, (size_t)f->columns * f->rows);
    gwy_put_object(p, name, "GwyDataField", items);
}

/* A whole file of the items of its container, which it frees. */
static inline gwy_part gwy_make_file(gwy_part items) {
    gwy_part file = {NULL, 0};
    gwy_put(&file, "GWYP", 4);
    gwy_put_object(&file, NULL, "GwyContainer", items);
    return file;
}

#endif
