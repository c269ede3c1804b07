/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The contents of a data file, as the dataset /contents: a line for each dataset and attribute that
 * Haft writes, with a digest of its value. If another program opens the file for writing, repacks
 * it or adds to it, the bytes change but the lines stay valid; if a value changes, its line shows
 * which. Descriptions and objects added by others are not covered. */
#include "hdf.h"

#include <stdio.h>
#include <string.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "digests are of little-endian numbers");

/* The only dataset whose values differ between runs of the same case. It has no digest, since that
 * would be a second difference between the files. */
static const char TIMES[] = "/summary/seconds";

enum { SHAPE_CAPACITY = 32 + 21 * H5S_MAX_RANK, NAMES_CAPACITY = 600, NAMED_MOST = 4 };

/* ---- digests ---- */

static const char *word_of(haft_hdf_kind kind) {
    return kind == HAFT_HDF_TEXT ? "text" : kind == HAFT_HDF_REALS ? "real" : "count";
}

/* The digest of three lines: type and extents, digest of the unit, digest of the values. */
static void digest_value(char digest[HAFT_DIGEST_CAPACITY], const char *shape, const char *unit,
                         const void *value, size_t bytes) {
    char own[2][HAFT_DIGEST_CAPACITY], all[SHAPE_CAPACITY + sizeof own + 8];
    haft_digest_memory(unit, strlen(unit), own[0]);
    haft_digest_memory(bytes > 0 ? value : "", bytes, own[1]);
    int n = snprintf(all, sizeof all, "%s\n%s\n%s\n", shape, own[0], own[1]);
    haft_digest_memory(all, (size_t)n, digest);
}

static void digest_dataset(char digest[HAFT_DIGEST_CAPACITY], const char *path, haft_hdf_type type,
                           int rank, const hsize_t *dims, const void *value, const char *unit) {
    char shape[SHAPE_CAPACITY];
    size_t used = 0, bytes = type == HAFT_HDF_REAL ? sizeof(double) : sizeof(int);
    used += (size_t)snprintf(shape, sizeof shape, "%s", type == HAFT_HDF_REAL ? "real" : "integer");
    for (int i = 0; i < rank; i++) {
        used += (size_t)snprintf(shape + used, sizeof shape - used, " %llu",
                                 (unsigned long long)dims[i]);
        bytes *= (size_t)dims[i];
    }
    digest_value(digest, shape, unit, value, strcmp(path, TIMES) == 0 ? 0 : bytes);
}

/* ---- the list of a file being written ---- */

static bool make_room(haft_hdf *hdf, size_t more) {
    haft_hdf_list *list = &hdf->contents;
    if (list->used + more <= list->capacity) {
        return true;
    }
    size_t capacity = 2 * list->capacity + more + 1024;
    char *text = haft_memory_alloc(capacity, 1, hdf->error);
    if (text == NULL) {
        hdf->status = HAFT_ERROR_MEMORY;
        return false;
    }
    if (list->used > 0) {
        memcpy(text, list->text, list->used);
    }
    haft_memory_free(list->text);
    list->text = text;
    list->capacity = capacity;
    return true;
}

/* Adds a line; an empty name means that it is of a dataset. */
static void add_line(haft_hdf *hdf, const char *digest, const char *path, const char *name) {
    size_t more = HAFT_DIGEST_CAPACITY + strlen(path) + strlen(name) + 3;
    if (make_room(hdf, more)) {
        hdf->contents.used +=
            (size_t)snprintf(hdf->contents.text + hdf->contents.used, more, "%s %s%s%s\n", digest,
                             path, name[0] == '\0' ? "" : "@", name);
    }
}

void haft_hdf_list_begin(haft_hdf *hdf) {
    hdf->contents.kept = true;
}

void haft_hdf_list_dataset(haft_hdf *hdf, const char *path, haft_hdf_type type, int rank,
                           const hsize_t *dims, const void *value, const char *unit) {
    if (hdf->contents.kept && hdf->status == HAFT_OK) {
        char digest[HAFT_DIGEST_CAPACITY];
        digest_dataset(digest, path, type, rank, dims, value, unit);
        add_line(hdf, digest, path, "");
    }
}

void haft_hdf_list_attribute(haft_hdf *hdf, const char *object, const char *name,
                             haft_hdf_kind kind, const void *value, size_t bytes) {
    if (hdf->contents.kept && hdf->status == HAFT_OK) {
        char digest[HAFT_DIGEST_CAPACITY];
        digest_value(digest, word_of(kind), "", value, bytes);
        add_line(hdf, digest, object, name);
    }
}

void haft_hdf_list_release(haft_hdf *hdf) {
    haft_memory_free(hdf->contents.text);
    hdf->contents = (haft_hdf_list){.text = NULL};
}

/* ---- the list of a file being read ---- */

char *haft_hdf_list_read(haft_hdf *hdf) {
    size_t n = 0;
    if (!haft_hdf_has(hdf, HAFT_HDF_CONTENTS)) {
        return NULL;
    }
    haft_hdf_shape(hdf, HAFT_HDF_CONTENTS, 1, &n);
    char *text = hdf->status == HAFT_OK ? haft_memory_alloc(n + 1, 1, hdf->error) : NULL;
    if (hdf->status == HAFT_OK && text == NULL) {
        hdf->status = HAFT_ERROR_MEMORY;
    }
    if (text != NULL) {
        haft_hdf_read(hdf, HAFT_HDF_CONTENTS, HAFT_HDF_BYTE, 1, &n, text);
    }
    if (hdf->status != HAFT_OK) {
        haft_memory_free(text);
        return NULL;
    }
    return text;
}

bool haft_hdf_list_has(const char *list, const char *path) {
    size_t n = strlen(path);
    for (const char *at = strstr(list, path); at != NULL; at = strstr(at + 1, path)) {
        if (at > list && at[-1] == ' ' && at[n] == '\n') {
            return true;
        }
    }
    return false;
}

/* ---- verifying ---- */

typedef enum finding { SAME, DIFFERS, MISSING } finding;

/* The number of objects with one finding, and the names of the first few. */
typedef struct found {
    size_t count;
    char names[NAMES_CAPACITY];
} found;

static void note_found(found *f, const char *path, const char *name) {
    size_t used = strlen(f->names);
    if (++f->count > NAMED_MOST) {
        return;
    }
    const char *comma = used > 0 ? ", " : "";
    if (name == NULL) {
        snprintf(f->names + used, sizeof f->names - used, "%s%s", comma, path);
    } else {
        snprintf(f->names + used, sizeof f->names - used, "%sthe attribute `%s` of %s", comma, name,
                 path);
    }
}

static finding digest_attribute(char digest[HAFT_DIGEST_CAPACITY], hid_t object, const char *name,
                                haft_hdf *hdf) {
    char *text = NULL;
    uint64_t count = 0;
    double real = 0;
    haft_hdf_found got = haft_hdf_get_attribute(object, name, HAFT_HDF_TEXT, 1, &text);
    if (got == HAFT_HDF_FOUND) {
        digest_value(digest, word_of(HAFT_HDF_TEXT), "", text, strlen(text));
    } else if (got == HAFT_HDF_FOREIGN &&
               haft_hdf_get_attribute(object, name, HAFT_HDF_COUNTS, 1, &count) == HAFT_HDF_FOUND) {
        digest_value(digest, word_of(HAFT_HDF_COUNTS), "", &count, sizeof count);
    } else if (got == HAFT_HDF_FOREIGN &&
               haft_hdf_get_attribute(object, name, HAFT_HDF_REALS, 1, &real) == HAFT_HDF_FOUND) {
        digest_value(digest, word_of(HAFT_HDF_REALS), "", &real, sizeof real);
    } else if (got == HAFT_HDF_NO_MEMORY) {
        hdf->status = haft_error_set(hdf->error, HAFT_ERROR_MEMORY,
                                     "%s: no memory for the attribute `%s`", hdf->path, name);
    }
    haft_memory_free(text);
    return got == HAFT_HDF_ABSENT ? MISSING : SAME;
}

/* The digest of a dataset in the file; empty if the dataset is not readable in the form that Haft
 * writes. */
static void digest_found(char digest[HAFT_DIGEST_CAPACITY], hid_t dataset, const char *path,
                         haft_hdf *hdf) {
    haft_hdf_set set;
    if (haft_hdf_inspect(&set, dataset, hdf->file_bytes) != NULL || set.class == H5T_NO_CLASS) {
        return;
    }
    bool real = set.class == H5T_FLOAT;
    size_t n = 1;
    for (int i = 0; i < set.rank; i++) {
        n *= (size_t)set.dims[i]; /* no overflow: haft_hdf_inspect() has bounded the size */
    }
    char *unit = NULL;
    void *value = haft_memory_alloc(n, real ? sizeof(double) : sizeof(int), hdf->error);
    haft_hdf_found got = haft_hdf_get_attribute(dataset, "unit", HAFT_HDF_TEXT, 1, &unit);
    if (value == NULL || got == HAFT_HDF_NO_MEMORY) {
        hdf->status =
            haft_error_set(hdf->error, HAFT_ERROR_MEMORY, "%s: no memory for %s", hdf->path, path);
    } else if (H5Dread(dataset, real ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT, H5S_ALL, H5S_ALL,
                       H5P_DEFAULT, value) >= 0) {
        digest_dataset(digest, path, real ? HAFT_HDF_REAL : HAFT_HDF_INT, set.rank, set.dims, value,
                       unit == NULL ? "" : unit);
    }
    haft_memory_free(unit);
    haft_memory_free(value);
}

/* Compares an attribute, or a dataset if `name` is NULL, with its digest. */
static finding verify_object(haft_hdf *hdf, const char *digest, const char *path,
                             const char *name) {
    char actual[HAFT_DIGEST_CAPACITY] = "";
    const char *reason = NULL;
    finding f = SAME;
    hid_t object = haft_hdf_enter(hdf->file, path, &reason);
    if (object < 0) {
        return MISSING;
    }
    if (name != NULL) {
        f = digest_attribute(actual, object, name, hdf);
    } else {
        digest_found(actual, object, path, hdf);
    }
    H5Oclose(object);
    return f == SAME && strcmp(actual, digest) != 0 ? DIFFERS : f;
}

/* Verifies each line of the list, after verify_list() has verified the list itself. */
static void verify_lines(haft_hdf *hdf, char *list, found *differs, found *missing) {
    for (char *line = list, *end = NULL; hdf->status == HAFT_OK && *line != '\0'; line = end + 1) {
        end = strchr(line, '\n');
        char *path = strchr(line, ' ');
        if (end == NULL || path == NULL || path > end) {
            haft_hdf_refuse(hdf, "has lines in %s that are no digest and path", HAFT_HDF_CONTENTS);
            return;
        }
        *end = *path++ = '\0';
        char *name = strchr(path, '@');
        if (name != NULL) {
            *name++ = '\0';
        }
        finding f = verify_object(hdf, line, path, name);
        if (f != SAME && hdf->status == HAFT_OK) {
            note_found(f == DIFFERS ? differs : missing, path, name);
        }
    }
}

static void refuse_changes(haft_hdf *hdf, const found *differs, const found *missing) {
    char rest[2][40] = {"", ""};
    const found *both[2] = {differs, missing};
    for (int i = 0; i < 2; i++) {
        if (both[i]->count > NAMED_MOST) {
            snprintf(rest[i], sizeof rest[i], " and %zu more", both[i]->count - NAMED_MOST);
        }
    }
    haft_hdf_refuse(hdf, "was changed since Haft wrote it: %s%s%s%s%s%s%s",
                    differs->count > 0 ? "not as written: " : "", differs->names, rest[0],
                    differs->count > 0 && missing->count > 0 ? "; " : "",
                    missing->count > 0 ? "missing: " : "", missing->names, rest[1]);
}

/* Verifies the list by its own digest. */
static void verify_list(haft_hdf *hdf, const char *list) {
    char *noted = NULL, digest[HAFT_DIGEST_CAPACITY];
    haft_hdf_read_text(hdf, "/", HAFT_HDF_CONTENTS_DIGEST, &noted);
    haft_digest_memory(list, strlen(list), digest);
    if (hdf->status == HAFT_OK && strcmp(noted, digest) != 0) {
        haft_hdf_refuse(hdf,
                        "was changed since Haft wrote it, and so was its list of digests, %s, so "
                        "that it cannot be said where",
                        HAFT_HDF_CONTENTS);
    }
    haft_memory_free(noted);
}

bool haft_hdf_verify(haft_hdf *hdf) {
    char *list = haft_hdf_list_read(hdf);
    if (list == NULL) {
        if (hdf->status == HAFT_OK && haft_hdf_has_attribute(hdf, "/", HAFT_HDF_CONTENTS_DIGEST)) {
            haft_hdf_refuse(hdf, "was changed since Haft wrote it: missing: %s", HAFT_HDF_CONTENTS);
        }
        return false;
    }
    found differs = {.count = 0}, missing = {.count = 0};
    verify_list(hdf, list);
    verify_lines(hdf, list, &differs, &missing);
    haft_memory_free(list);
    if (hdf->status == HAFT_OK && differs.count + missing.count > 0) {
        refuse_changes(hdf, &differs, &missing);
    }
    return hdf->status == HAFT_OK;
}
