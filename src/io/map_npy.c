/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NumPy arrays (.npy): a magic string, the version, the length of the header, the header, which is
 * a Python dictionary {'descr': '<f8', 'fortran_order': False, 'shape': (256, 256), }, then the
 * numbers. The length has two bytes in version 1.0 and four in 2.0 and 3.0. Real numbers and
 * integers of up to eight bytes are read, in either byte order, by rows or by columns. The file
 * gives neither size nor unit. */
#include "map_file.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { DIMENSIONS_MOST = 8, PREFIX = 8 };

typedef struct npy_header {
    char type[24]; /* as in '<f8' */
    bool by_columns;
    size_t rank, dims[DIMENSIONS_MOST];
    size_t start; /* of the numbers in the file */
    bool found[3];
} npy_header;

/* The text of the header still to be read. */
typedef struct cursor {
    const char *at, *end;
} cursor;

static haft_status refuse_header(const haft_map_file *file, const char *what, haft_error *error) {
    return haft_error_set(error, HAFT_ERROR_INPUT,
                          "%s: is a NumPy file with a damaged header: %s; save the array anew "
                          "with numpy.save",
                          file->path, what);
}

/* ---- words of the header ---- */

static void skip_blanks(cursor *c) {
    while (c->at < c->end && strchr(" \t\r\n", *c->at) != NULL && *c->at != '\0') {
        c->at++;
    }
}

static bool take(cursor *c, char sign) {
    skip_blanks(c);
    if (c->at == c->end || *c->at != sign) {
        return false;
    }
    c->at++;
    return true;
}

static bool take_word(cursor *c, const char *word) {
    size_t n = strlen(word);
    skip_blanks(c);
    if ((size_t)(c->end - c->at) < n || memcmp(c->at, word, n) != 0) {
        return false;
    }
    c->at += n;
    return true;
}

/* Takes a quoted text without escapes; cuts a long one. */
static bool take_text(cursor *c, char *text, size_t capacity) {
    skip_blanks(c);
    if (c->at == c->end || (*c->at != '\'' && *c->at != '"')) {
        return false;
    }
    const char *from = c->at + 1;
    const char *quote = memchr(from, *c->at, (size_t)(c->end - from));
    if (quote == NULL) {
        return false;
    }
    size_t n = (size_t)(quote - from) < capacity - 1 ? (size_t)(quote - from) : capacity - 1;
    memcpy(text, from, n);
    text[n] = '\0';
    c->at = quote + 1;
    return true;
}

/* Takes an unsigned integer; a number too large for a map is clamped to one that is too large. */
static bool take_number(cursor *c, size_t *number) {
    skip_blanks(c);
    const char *from = c->at;
    *number = 0;
    while (c->at < c->end && *c->at >= '0' && *c->at <= '9') {
        *number = *number > 1000000000 ? *number : 10 * *number + (size_t)(*c->at - '0');
        c->at++;
    }
    bool any = c->at > from;
    take(c, 'L'); /* Python 2's long integers */
    return any;
}

static bool take_shape(cursor *c, npy_header *h) {
    if (!take(c, '(')) {
        return false;
    }
    while (!take(c, ')')) {
        size_t side = 0;
        if (!take_number(c, &side)) {
            return false;
        }
        if (h->rank < DIMENSIONS_MOST) {
            h->dims[h->rank] = side;
        }
        h->rank++;
        if (!take(c, ',') && (c->at == c->end || *c->at != ')')) {
            return false;
        }
    }
    return true;
}

/* Takes one "key: value" of the dictionary. A `descr` that is not a text is a list of fields. */
static const char *take_entry(cursor *c, npy_header *h) {
    static const char *const keys[] = {"descr", "fortran_order", "shape"};
    char key[24];
    int k = 0;
    if (!take_text(c, key, sizeof key) || !take(c, ':')) {
        return "it is no Python dictionary";
    }
    while (k < 3 && strcmp(key, keys[k]) != 0) {
        k++;
    }
    if (k == 3 || h->found[k]) {
        return "it does not hold descr, fortran_order and shape, each once";
    }
    h->found[k] = true;
    if (k == 0) {
        return take_text(c, h->type, sizeof h->type) ? NULL : "fields";
    }
    if (k == 1) {
        h->by_columns = take_word(c, "True");
        return h->by_columns || take_word(c, "False") ? NULL
                                                      : "fortran_order is neither True nor False";
    }
    return take_shape(c, h) ? NULL : "the shape is no tuple of whole numbers";
}

static haft_status read_header(npy_header *h, const haft_map_file *file, haft_error *error) {
    const unsigned char *bytes = (const unsigned char *)file->bytes;
    if (file->size < PREFIX + 4) {
        return refuse_header(file, "it is cut short", error);
    }
    int major = bytes[6];
    if (major < 1 || major > 3 || bytes[7] != 0) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: is a NumPy file of version %d.%d; 1.0, 2.0 and 3.0 are read",
                              file->path, major, bytes[7]);
    }
    size_t length = (size_t)bytes[8] | (size_t)bytes[9] << 8, prefix = PREFIX + 2;
    if (major > 1) {
        length |= (size_t)bytes[10] << 16 | (size_t)bytes[11] << 24;
        prefix = PREFIX + 4;
    }
    if (length > file->size - prefix) {
        return refuse_header(file, "it is cut short", error);
    }
    h->start = prefix + length;
    cursor c = {file->bytes + prefix, file->bytes + h->start};
    if (!take(&c, '{')) {
        return refuse_header(file, "it is no Python dictionary", error);
    }
    while (!take(&c, '}')) {
        const char *wrong = take_entry(&c, h);
        if (wrong != NULL && strcmp(wrong, "fields") == 0) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "%s: holds an array of records; save the field with the heights "
                                  "alone, as numpy.save(\"map.npy\", a[\"z\"])",
                                  file->path);
        }
        if (wrong != NULL) {
            return refuse_header(file, wrong, error);
        }
        if (!take(&c, ',') && (c.at == c.end || *c.at != '}')) {
            return refuse_header(file, "its dictionary has no end", error);
        }
    }
    skip_blanks(&c);
    if (c.at != c.end) {
        return refuse_header(file, "something follows its dictionary", error);
    }
    if (!h->found[0] || !h->found[1] || !h->found[2]) {
        return refuse_header(file, "it does not hold descr, fortran_order and shape, each once",
                             error);
    }
    return HAFT_OK;
}

/* ---- meaning of the header ---- */

typedef struct number_type {
    char kind; /* 'f', 'i' or 'u' */
    size_t bytes;
    bool big_endian;
} number_type;

/* Reads '<f8': byte order, kind, number of bytes. */
static haft_status read_type(number_type *type, const npy_header *h, const haft_map_file *file,
                             haft_error *error) {
    const char *text = h->type;
    bool ordered = *text == '<' || *text == '>' || *text == '|' || *text == '=';
    char kind = ordered ? text[1] : '\0', size = kind != '\0' ? text[2] : '\0';
    bool whole = kind == 'i' || kind == 'u';
    if ((whole || kind == 'f') && strchr(whole ? "1248" : "248", size) != NULL && size != '\0' &&
        text[3] == '\0' && (size == '1' || *text == '<' || *text == '>')) {
        *type = (number_type){kind, (size_t)(size - '0'), *text == '>'};
        return HAFT_OK;
    }
    char quoted[48];
    const char *what = kind == 'b'                  ? " (true or false)"
                       : kind == 'c'                ? " (complex numbers)"
                       : kind == 'O'                ? " (Python objects)"
                       : kind == 'S' || kind == 'U' ? " (texts)"
                       : kind == 'V'                ? " (records)"
                                                    : "";
    return haft_error_set(error, HAFT_ERROR_INPUT,
                          "%s: holds an array of type '%s'%s; heights must be real or whole "
                          "numbers of 1 to 8 bytes: save it as a.astype(\"<f8\")",
                          file->path, haft_map_quote(quoted, text, strlen(text)), what);
}

/* Rows and columns of (N, M), (1, N, M) or (N, M, 1). */
static haft_status read_sides(size_t *rows, size_t *columns, const npy_header *h,
                              const haft_map_file *file, haft_error *error) {
    const size_t *d = h->dims;
    bool first = h->rank == 3 && d[0] == 1, last = h->rank == 3 && d[2] == 1;
    if (h->rank != 2 && !first && !last) {
        char shape[120] = "";
        for (size_t k = 0; k < h->rank && k < DIMENSIONS_MOST; k++) {
            size_t used = strlen(shape);
            snprintf(shape + used, sizeof shape - used, "%s%zu", k > 0 ? " x " : "", d[k]);
        }
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: holds an array of %zu dimension%s%s%s; a map has two, rows and "
                              "columns: save one of them",
                              file->path, h->rank, h->rank == 1 ? "" : "s", h->rank > 0 ? ": " : "",
                              shape);
    }
    *rows = d[first ? 1 : 0];
    *columns = d[first ? 2 : 1];
    if (*rows < 2 || *columns < 2 || *rows > HAFT_MAP_SIDE_MOST || *columns > HAFT_MAP_SIDE_MOST) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: holds an array of %zu rows and %zu columns; a map needs 2 to %d "
                              "pixels a side",
                              file->path, *rows, *columns, HAFT_MAP_SIDE_MOST);
    }
    if (*columns == 3 && !(file->options.width > 0)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: holds three columns and no size; points x, y, z are read from "
                              "text, as numpy.savetxt writes it, and a map three pixels wide needs "
                              "its size",
                              file->path);
    }
    return HAFT_OK;
}

/* ---- numbers ---- */

static double from_half(uint64_t word) {
    int exponent = (int)(word >> 10 & 31);
    double fraction = (double)(word & 1023);
    double value = exponent == 31  ? (fraction > 0 ? (double)NAN : (double)INFINITY)
                   : exponent == 0 ? ldexp(fraction, -24)
                                   : ldexp(1024 + fraction, exponent - 25);
    return (word & 0x8000) != 0 ? -value : value;
}

static double read_number(const unsigned char *bytes, number_type type) {
    uint64_t word = 0;
    for (size_t k = 0; k < type.bytes; k++) {
        word |= (uint64_t)bytes[type.big_endian ? type.bytes - 1 - k : k] << (8 * k);
    }
    if (type.kind == 'u') {
        return (double)word;
    }
    if (type.kind == 'i') {
        uint64_t sign = (uint64_t)1 << (8 * type.bytes - 1);
        /* two's complement: the sign bit counts negative */
        return (word & sign) != 0 ? -(double)(2 * sign - word) : (double)word;
    }
    if (type.bytes == 2) {
        return from_half(word);
    }
    double value = 0;
    if (type.bytes == 4) {
        uint32_t half = (uint32_t)word;
        float single = 0;
        memcpy(&single, &half, sizeof single);
        value = single;
    } else {
        memcpy(&value, &word, sizeof value);
    }
    return value;
}

haft_status haft_map_read_npy(haft_map **out, const haft_map_file *file, haft_error *error) {
    npy_header h = {.rank = 0};
    number_type type = {.bytes = 0};
    size_t rows = 0, columns = 0;
    haft_status status = read_header(&h, file, error);
    HAFT_THEN(status, read_type(&type, &h, file, error));
    HAFT_THEN(status, read_sides(&rows, &columns, &h, file, error));
    if (status != HAFT_OK) {
        return status;
    }
    size_t needed = h.start + rows * columns * type.bytes;
    if (file->size != needed) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s: has %zu bytes where %zu x %zu numbers of type '%s' need %zu; it "
                              "is %s",
                              file->path, file->size, rows, columns, h.type, needed,
                              file->size < needed ? "cut short" : "damaged");
    }
    double unit = 0;
    status = haft_map_begin(out, file, rows, columns, 0, 0, &unit, error);
    for (size_t i = 0; status == HAFT_OK && i < rows * columns; i++) {
        size_t place = h.by_columns ? i % columns * rows + i / columns : i;
        (*out)->z[i] =
            read_number((const unsigned char *)file->bytes + h.start + type.bytes * place, type);
    }
    HAFT_THEN(status, haft_map_end(out, file, unit, error));
    if (status == HAFT_OK) {
        snprintf((*out)->format, sizeof(*out)->format, "NumPy array, %.8s", h.type);
    }
    return status;
}
