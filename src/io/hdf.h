/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HDF5 as this room uses it: files made in memory, tables by columns, every dataset with its unit
 * and description. The first failure is kept: further calls do nothing. The serial HDF5 library is
 * not thread-safe: one thread at a time. Private to this room. */
#ifndef HAFT_IO_HDF_H
#define HAFT_IO_HDF_H

#include "haft/io.h"
#include "store.h"

#include <hdf5.h>

/* The text of /contents: one line with a digest for each dataset and attribute that is written. */
typedef struct haft_hdf_list {
    char *text;
    size_t used, capacity;
    bool kept; /* if true, writing adds lines */
} haft_hdf_list;

/* A file or a group being written or read. */
typedef struct haft_hdf {
    hid_t file;
    void *bytes;            /* of a file being read */
    const char *path;       /* for messages */
    const char *remedy;     /* what to do about a file that cannot be read */
    size_t file_bytes;      /* of a file being read */
    haft_hdf_list contents; /* of a file being written */
    bool rewritten;         /* by another program, with Haft's data unchanged */
    haft_status status;
    haft_error *error;
} haft_hdf;

/* ---- the library itself: hdf_image.c ---- */

/* Between these two calls HDF5 prints no errors and loads no plugins, which a file can request. */
typedef struct haft_hdf_voice {
    H5E_auto2_t function;
    void *data;
    unsigned plugins;
    bool plugins_known;
} haft_hdf_voice;
haft_hdf_voice haft_hdf_hush(void);
void haft_hdf_unhush(haft_hdf_voice voice);

/* Opens an HDF5 file in memory for reading; the bytes must stay valid until it is closed. Negative
 * if they are not HDF5. */
hid_t haft_hdf_open_image(const void *bytes, size_t size);

/* Records a failure of the library, with its innermost message. */
void haft_hdf_fail(haft_hdf *hdf, const char *what);

/* Records that the contents of a file being read are wrong. */
void haft_hdf_refuse(haft_hdf *hdf, const char *format, ...) HAFT_PRINTF(2, 3);

typedef enum haft_hdf_type {
    HAFT_HDF_REAL, /* double */
    HAFT_HDF_INT,  /* int */
    HAFT_HDF_BYTE, /* unsigned char: the characters of a text */
} haft_hdf_type;

/* The HDF5 type of such numbers in memory. */
hid_t haft_hdf_native_type(haft_hdf_type type);

/* A dataset that holds one member of an array of C structs. */
typedef struct haft_hdf_column {
    const char *name;
    haft_hdf_type type;
    size_t offset;
    const char *unit, *description;
} haft_hdf_column;

/* ---- writing: hdf_write.c ---- */

void haft_hdf_begin(haft_hdf *hdf);
void haft_hdf_drop(haft_hdf *hdf);

/* Writes a dataset, and makes missing groups of its path. `value` is an array of numbers of the
 * type. Without a unit (NULL) neither unit nor description is written. */
void haft_hdf_write(haft_hdf *hdf, const char *path, haft_hdf_type type, int rank,
                    const hsize_t *dims, const void *value, const char *unit,
                    const char *description);

/* Makes a group and the missing groups of its path. */
void haft_hdf_write_group(haft_hdf *hdf, const char *path);

/* Writes columns of n structs into a group. */
void haft_hdf_write_columns(haft_hdf *hdf, const char *group, size_t columns,
                            const haft_hdf_column *column, const void *rows, size_t stride,
                            size_t n);

void haft_hdf_write_text(haft_hdf *hdf, const char *object, const char *name, const char *text);
void haft_hdf_write_real(haft_hdf *hdf, const char *object, const char *name, double value);
void haft_hdf_write_count(haft_hdf *hdf, const char *object, const char *name, uint64_t value);

/* Writes the root attributes: format and origin of the file. */
void haft_hdf_write_origin(haft_hdf *hdf, const char *format, const haft_case *c,
                           const char *laws_digest);

/* Takes the bytes of the file in memory, to be freed with haft_memory_free(). */
void haft_hdf_take_image(haft_hdf *hdf, void **bytes, size_t *size);

/* Writes the file in memory to a store, with a checksum, and commits the store; closes both. */
haft_status haft_hdf_store(haft_hdf *hdf, haft_store *store);

/* ---- checks before the library reads: hdf_check.c ---- */

/* The reason that haft_hdf_enter() gives if there is no such link. */
extern const char haft_hdf_missing[];

/* Opens the object at a path of hard links, to be closed with H5Oclose(). If there is none, returns
 * a negative number and the reason. */
hid_t haft_hdf_enter(hid_t file, const char *path, const char **reason);

typedef struct haft_hdf_set {
    H5T_class_t class; /* H5T_FLOAT or H5T_INTEGER; H5T_NO_CLASS for all others */
    size_t type_bytes;
    int rank; /* 0: not an array */
    hsize_t dims[H5S_MAX_RANK];
} haft_hdf_set;

/* Checks that the data of an open dataset are inside the file and compressed only by HDF5's own
 * filters, and for numbers also that they are not larger than the file can hold. Returns NULL, or
 * what is wrong ("is a virtual dataset ..."). */
const char *haft_hdf_inspect(haft_hdf_set *set, hid_t dataset, size_t file_bytes);

/* Visits all objects that hard links reach, groups before their members; `path` begins with a
 * slash. An object is visited once per link; its address identifies it. A link to a group that
 * contains it is skipped. Ends when `visit` returns less than 0. `depth_most` is at most
 * HAFT_HDF_DEPTH_MOST. Returns NULL, or why not all objects were visited: "too many objects",
 * "groups nested too deep" ... */
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

/* Reads an attribute of an open object. All attributes are read by this function. `points` is 1 for
 * a text. */
haft_hdf_found haft_hdf_get_attribute(hid_t object, const char *name, haft_hdf_kind kind,
                                      size_t points, void *value);

/* ---- digests of the contents of a file: hdf_contents.c ---- */

/* The dataset with the list, and the attribute with the digest of the list. */
#define HAFT_HDF_CONTENTS "/contents"
#define HAFT_HDF_CONTENTS_DIGEST "contents_digest"

/* From this call on, each dataset and attribute that is written adds a line to the list. */
void haft_hdf_list_begin(haft_hdf *hdf);
void haft_hdf_list_dataset(haft_hdf *hdf, const char *path, haft_hdf_type type, int rank,
                           const hsize_t *dims, const void *value, const char *unit);
void haft_hdf_list_attribute(haft_hdf *hdf, const char *object, const char *name,
                             haft_hdf_kind kind, const void *value, size_t bytes);

/* Writes the list and its digest, as the last dataset. */
void haft_hdf_list_write(haft_hdf *hdf);
void haft_hdf_list_release(haft_hdf *hdf);

/* The list of a file being read, to be freed with haft_memory_free(); NULL if there is none. */
char *haft_hdf_list_read(haft_hdf *hdf);

/* Whether the list has a line for this dataset. */
bool haft_hdf_list_has(const char *list, const char *path);

/* Compares everything in the list with its digest. On a difference, rejects the file and says what
 * differs. False if it did so or if there is no list. */
bool haft_hdf_verify(haft_hdf *hdf);

/* ---- opening: hdf_open.c, hdf_copy.c ---- */

/* Reads a file whole, verifies its checksum, opens it in memory, and checks format and layout
 * version. A file without a checksum, or with a wrong one, is not opened here: a child process
 * copies what Haft reads, and the copy is opened and compared with the digests in it. */
haft_status haft_hdf_open(haft_hdf *hdf, const char *path, const char *format, haft_error *error);
void haft_hdf_close(haft_hdf *hdf);

/* Replaces hdf->bytes by a new HDF5 file that a child process has made from them, with the groups,
 * their attributes, and datasets of numbers. */
void haft_hdf_copy_apart(haft_hdf *hdf);

/* ---- reading: hdf_read.c ---- */

/* Whether there is such an object. Rejects the file if the path has a soft or external link. */
bool haft_hdf_has(haft_hdf *hdf, const char *path);

/* Whether there is such an attribute. */
bool haft_hdf_has_attribute(haft_hdf *hdf, const char *object, const char *name);

/* Shape of a dataset, which must have the given rank and no more data than the file can hold;
 * extents may be 0. */
void haft_hdf_shape(haft_hdf *hdf, const char *path, int rank, size_t *dims);

/* Reads a dataset that must have this shape. */
void haft_hdf_read(haft_hdf *hdf, const char *path, haft_hdf_type type, int rank,
                   const size_t *dims, void *value);

/* Reads columns of n structs. */
void haft_hdf_read_columns(haft_hdf *hdf, const char *group, size_t columns,
                           const haft_hdf_column *column, void *rows, size_t stride, size_t n);

/* *text is to be freed with haft_memory_free(). */
void haft_hdf_read_text(haft_hdf *hdf, const char *object, const char *name, char **text);
void haft_hdf_read_real(haft_hdf *hdf, const char *object, const char *name, double *value);
void haft_hdf_read_count(haft_hdf *hdf, const char *object, const char *name, uint64_t *value);

/* Columns of law vectors. */
/* The limit push as attributes `f_limit` and `f_limit_unit`: "Pa", or "f_max" for a share. */
void haft_hdf_write_limit(haft_hdf *hdf, const char *object, double f_limit);
void haft_hdf_read_limit(haft_hdf *hdf, const char *object, double *f_limit);

extern const haft_hdf_column haft_hdf_vector_columns[HAFT_CHAOS_DIMENSION];

/* ---- laws_set.c: numbers per curve of laws.h5, one row each ---- */

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

/* The header with the checksum at the beginning of a file: HDF5 skips it as its user block. */
enum { HAFT_HDF_HEADER = 512, HAFT_HDF_LAYOUT = 1 };
void haft_hdf_make_header(char header[HAFT_HDF_HEADER], uint64_t size, const char *digest);

/* Formats, as in the root attribute `format`. */
#define HAFT_HDF_LAWS "haft-laws"
#define HAFT_HDF_RESULTS "haft-results"

/* Columns of a path's points and jumps and of the summary, for writer and reader of results. */
extern const haft_hdf_column haft_hdf_point_columns[], haft_hdf_jump_columns[],
    haft_hdf_summary_columns[];
extern const size_t haft_hdf_point_column_count, haft_hdf_jump_column_count,
    haft_hdf_summary_column_count;

#endif
