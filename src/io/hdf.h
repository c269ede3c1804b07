/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HDF5 as this room uses it: files made in memory, tables by columns, every dataset with its unit
 * and description. Failures stick: after the first, further calls do nothing. The serial HDF5
 * library is not thread-safe: one thread at a time. Private to this room. */
#ifndef HAFT_IO_HDF_H
#define HAFT_IO_HDF_H

#include "haft/io.h"
#include "store.h"

#include <hdf5.h>

/* Digests of what is written, line by line: the text of /contents. */
typedef struct haft_hdf_list {
    char *text;
    size_t used, capacity;
    bool kept; /* lines are added */
} haft_hdf_list;

/* A file or a group being written or read. */
typedef struct haft_hdf {
    hid_t file;
    void *bytes;            /* of a file being read */
    const char *path;       /* for messages */
    const char *remedy;     /* what to do about a file that cannot be read */
    size_t file_bytes;      /* of a file being read */
    haft_hdf_list contents; /* of a file being written */
    bool rewritten;         /* by another program, with the data that Haft wrote */
    haft_status status;
    haft_error *error;
} haft_hdf;

/* ---- the library itself: hdf_image.c ---- */

/* Between these two HDF5 prints no errors, and loads no plugins, which a file can ask for. */
typedef struct haft_hdf_voice {
    H5E_auto2_t function;
    void *data;
    unsigned plugins;
    bool plugins_known;
} haft_hdf_voice;
haft_hdf_voice haft_hdf_hush(void);
void haft_hdf_unhush(haft_hdf_voice voice);

/* Opens an HDF5 file in memory for reading; the bytes must stay until it is closed. Negative if it
 * is none. */
hid_t haft_hdf_open_image(const void *bytes, size_t size);

/* Notes a failure of the library, with the innermost message of its own. */
void haft_hdf_fail(haft_hdf *hdf, const char *what);

/* Notes that a file being read holds something else than it should. */
void haft_hdf_refuse(haft_hdf *hdf, const char *format, ...) HAFT_PRINTF(2, 3);

typedef enum haft_hdf_type {
    HAFT_HDF_REAL, /* double */
    HAFT_HDF_INT,  /* int */
    HAFT_HDF_BYTE, /* unsigned char: the characters of a text */
} haft_hdf_type;

/* HDF5's type of such numbers in memory. */
hid_t haft_hdf_native_type(haft_hdf_type type);

/* One dataset that is a member of a C struct, row after row. */
typedef struct haft_hdf_column {
    const char *name;
    haft_hdf_type type;
    size_t offset;
    const char *unit, *description;
} haft_hdf_column;

/* ---- writing: hdf_write.c ---- */

void haft_hdf_begin(haft_hdf *hdf);
void haft_hdf_drop(haft_hdf *hdf);

/* Writes a dataset; groups on the way are made. `value` is an array of the type's numbers. Without
 * a unit (NULL) neither unit nor description are written. */
void haft_hdf_write(haft_hdf *hdf, const char *path, haft_hdf_type type, int rank,
                    const hsize_t *dims, const void *value, const char *unit,
                    const char *description);

/* Makes a group, and those on the way. */
void haft_hdf_write_group(haft_hdf *hdf, const char *path);

/* Writes columns of n structs into a group. */
void haft_hdf_write_columns(haft_hdf *hdf, const char *group, size_t columns,
                            const haft_hdf_column *column, const void *rows, size_t stride,
                            size_t n);

void haft_hdf_write_text(haft_hdf *hdf, const char *object, const char *name, const char *text);
void haft_hdf_write_real(haft_hdf *hdf, const char *object, const char *name, double value);
void haft_hdf_write_count(haft_hdf *hdf, const char *object, const char *name, uint64_t value);

/* Root attributes: what this is and where it comes from. */
void haft_hdf_write_origin(haft_hdf *hdf, const char *format, const haft_case *c,
                           const char *laws_digest);

/* The bytes of the file in memory, freed with haft_memory_free(). */
void haft_hdf_take_image(haft_hdf *hdf, void **bytes, size_t *size);

/* Puts the file in memory into a store, under a checksum, and commits it; closes both. */
haft_status haft_hdf_store(haft_hdf *hdf, haft_store *store);

/* ---- what a file may ask of the library: hdf_check.c ---- */

/* The reason of haft_hdf_enter() where there is no such link. */
extern const char haft_hdf_missing[];

/* Opens the object that hard links lead to; negative, and why not, if there is none. Close it with
 * H5Oclose(). */
hid_t haft_hdf_enter(hid_t file, const char *path, const char **reason);

typedef struct haft_hdf_set {
    H5T_class_t class; /* H5T_FLOAT or H5T_INTEGER; H5T_NO_CLASS of all others */
    size_t type_bytes;
    int rank; /* 0: no array */
    hsize_t dims[H5S_MAX_RANK];
} haft_hdf_set;

/* Checks that an open dataset lies in the file, is packed by HDF5's own filters and, if it is of
 * numbers, that the file can hold it. NULL, or what is wrong ("is a virtual dataset ..."). */
const char *haft_hdf_inspect(haft_hdf_set *set, hid_t dataset, size_t file_bytes);

/* Visits all objects that hard links lead to, groups before what they hold; `path` begins with a
 * slash. An object is met once a link: its address tells whether it is the same. A link back to a
 * group that it lies in is passed over. Ends where `visit` returns less than 0. `depth_most` is at
 * most HAFT_HDF_DEPTH_MOST. NULL, or why not all were visited: "too many objects", "groups nested
 * too deep" ... */
enum { HAFT_HDF_DEPTH_MOST = 64 };
typedef herr_t haft_hdf_visit(void *user, const char *path, hid_t object, H5I_type_t kind,
                              haddr_t address);
const char *haft_hdf_walk(hid_t file, int depth_most, size_t links_most, haft_hdf_visit *visit,
                          void *user);

typedef enum haft_hdf_kind {
    HAFT_HDF_TEXT,   /* char *, freed with haft_memory_free(): one text of at most 1 MiB */
    HAFT_HDF_REALS,  /* double[points] */
    HAFT_HDF_COUNTS, /* uint64_t[points] */
} haft_hdf_kind;
typedef enum haft_hdf_found {
    HAFT_HDF_FOUND,
    HAFT_HDF_ABSENT,
    HAFT_HDF_FOREIGN, /* of another class, number of points or length */
    HAFT_HDF_UNREADABLE,
    HAFT_HDF_NO_MEMORY,
} haft_hdf_found;

/* Reads an attribute of an open object: the one door to all of them. `points` is 1 for a text. */
haft_hdf_found haft_hdf_get_attribute(hid_t object, const char *name, haft_hdf_kind kind,
                                      size_t points, void *value);

/* ---- digests of what a file holds: hdf_contents.c ---- */

/* The list's dataset, and the attribute with the digest of the list itself. */
#define HAFT_HDF_CONTENTS "/contents"
#define HAFT_HDF_CONTENTS_DIGEST "contents_digest"

/* From here on each dataset and attribute that is written gets a line in the list. */
void haft_hdf_list_begin(haft_hdf *hdf);
void haft_hdf_list_dataset(haft_hdf *hdf, const char *path, haft_hdf_type type, int rank,
                           const hsize_t *dims, const void *value, const char *unit);
void haft_hdf_list_attribute(haft_hdf *hdf, const char *object, const char *name,
                             haft_hdf_kind kind, const void *value, size_t bytes);

/* Writes the list, with its own digest, as the last dataset. */
void haft_hdf_list_write(haft_hdf *hdf);
void haft_hdf_list_release(haft_hdf *hdf);

/* The list of a file being read, freed with haft_memory_free(); NULL if there is none. */
char *haft_hdf_list_read(haft_hdf *hdf);

/* Does it have a line of this dataset? */
bool haft_hdf_list_has(const char *list, const char *path);

/* Compares all that the list names with its digest; refuses the file and says what differs. False
 * if it did so or if there is no list. */
bool haft_hdf_verify(haft_hdf *hdf);

/* ---- opening: hdf_open.c, hdf_copy.c ---- */

/* Reads a file whole, verifies its checksum, opens it in memory, and checks format and layout
 * version. A file without a checksum, or that does not match it, is not opened: a child process
 * makes a copy of what Haft reads; that is opened, and compared with the digests it holds. */
haft_status haft_hdf_open(haft_hdf *hdf, const char *path, const char *format, haft_error *error);
void haft_hdf_close(haft_hdf *hdf);

/* Puts a new HDF5 file in memory in the place of hdf->bytes, written by a child process that read
 * those: groups, their attributes, and datasets of numbers. */
void haft_hdf_copy_apart(haft_hdf *hdf);

/* ---- reading: hdf_read.c ---- */

/* Is there such an object? A link that is not followed is refused. */
bool haft_hdf_has(haft_hdf *hdf, const char *path);

/* Is there such an attribute? */
bool haft_hdf_has_attribute(haft_hdf *hdf, const char *object, const char *name);

/* Shape of a dataset of the given rank; each extent at least 0, and no more data than the file can
 * hold. */
void haft_hdf_shape(haft_hdf *hdf, const char *path, int rank, size_t *dims);

/* Reads a dataset that must have this shape. */
void haft_hdf_read(haft_hdf *hdf, const char *path, haft_hdf_type type, int rank,
                   const size_t *dims, void *value);

/* Reads columns of n structs. */
void haft_hdf_read_columns(haft_hdf *hdf, const char *group, size_t columns,
                           const haft_hdf_column *column, void *rows, size_t stride, size_t n);

/* *text is freed with haft_memory_free(). */
void haft_hdf_read_text(haft_hdf *hdf, const char *object, const char *name, char **text);
void haft_hdf_read_real(haft_hdf *hdf, const char *object, const char *name, double *value);
void haft_hdf_read_count(haft_hdf *hdf, const char *object, const char *name, uint64_t *value);

/* Columns of law vectors. */
/* The limit push as attributes `f_limit` and `f_limit_unit`: "Pa", or "f_max" of a share. */
void haft_hdf_write_limit(haft_hdf *hdf, const char *object, double f_limit);
void haft_hdf_read_limit(haft_hdf *hdf, const char *object, double *f_limit);

extern const haft_hdf_column haft_hdf_vector_columns[HAFT_CHAOS_DIMENSION];

/* ---- laws_set.c: numbers a curve of laws.h5, one row each ---- */

typedef struct haft_laws_row {
    const char *name, *unit, *description;
    size_t member; /* offset of the pointer in haft_laws */
} haft_laws_row;
enum { HAFT_LAWS_ROWS = 4 };
extern const haft_laws_row haft_laws_rows[HAFT_LAWS_ROWS];
double *haft_laws_row_of(const haft_laws *laws, const haft_laws_row *row);

/* ---- laws_chaos.c: the group /chaos of laws.h5 ---- */

void haft_laws_write_chaos(haft_hdf *hdf, const haft_laws *laws);
void haft_laws_read_chaos(haft_hdf *hdf, haft_laws *laws);

/* The checked header in front of a file: HDF5 skips it as its user block. */
enum { HAFT_HDF_HEADER = 512, HAFT_HDF_LAYOUT = 1 };
void haft_hdf_make_header(char header[HAFT_HDF_HEADER], uint64_t size, const char *digest);

/* Formats, as in the root attribute `format`. */
#define HAFT_HDF_LAWS "haft-laws"
#define HAFT_HDF_RESULTS "haft-results"

/* Columns of a path's points and jumps, for the writer and the reader of results. */
extern const haft_hdf_column haft_hdf_point_columns[], haft_hdf_jump_columns[],
    haft_hdf_summary_columns[];
extern const size_t haft_hdf_point_column_count, haft_hdf_jump_column_count,
    haft_hdf_summary_column_count;

#endif
