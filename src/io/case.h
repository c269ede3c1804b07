/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The schema of case.yaml, and what the files of the case reader share. Private to this room. */
#ifndef HAFT_IO_CASE_READER_H
#define HAFT_IO_CASE_READER_H

#include "haft/io.h"

enum {
    HAFT_CASE_SIZE_LIMIT = 256 * 1024, /* bytes in a case file */
    HAFT_CASE_DEPTH_LIMIT = 8,         /* of nesting; the schema needs 3 */
    HAFT_KEY_CAPACITY = 64,            /* of a dotted path */
    HAFT_EVIDENCE_LIMIT = 4096,        /* entries; keeps the resolved case within an attribute */
};

typedef enum haft_key_type {
    HAFT_KEY_NAME,     /* letters, digits, . _ - */
    HAFT_KEY_TEXT,     /* one line */
    HAFT_KEY_SEED,     /* uint64_t */
    HAFT_KEY_COUNT,    /* size_t */
    HAFT_KEY_REAL,     /* double with a unit, or `count` of them in a list */
    HAFT_KEY_CHOICE,   /* an enum whose values are the indices in `choices` */
    HAFT_KEY_EVIDENCE, /* a list of realizations, or "all" */
    HAFT_KEY_FILES,    /* haft_case_files: at most `count` paths, in a list or a single one */
} haft_key_type;

/* When the laws depend on a key. */
typedef enum haft_laws_need {
    HAFT_LAWS_NEVER,
    HAFT_LAWS_ALWAYS,
    HAFT_LAWS_DIRECT, /* if each beam has its own laws */
    HAFT_LAWS_CHAOS,  /* if a stochastic model is built from them */
} haft_laws_need;

/* When a key of the surface is written to resolved cases: only if it has a meaning there. */
typedef enum haft_surface_part {
    HAFT_PART_ALWAYS,
    HAFT_PART_SELF_AFFINE, /* if the PSD is given by its parameters */
    HAFT_PART_MAPS,        /* if maps are given */
    HAFT_PART_FACES,       /* if maps of both faces are given */
    HAFT_PART_MARGINAL,    /* if heights are not Gaussian */
    HAFT_PART_FILM,        /* if a water film is adsorbed */
    HAFT_PART_ROUGHNESS,   /* never: the PSD's parameters replace them */
} haft_surface_part;

/* One key: its path, the allowed values and its field in haft_case. */
typedef struct haft_key {
    const char *path; /* dotted */
    haft_key_type type;
    const char *unit; /* SI, for reals */
    double low, high; /* bounds of the value in that unit. `low_in` and `high_in`: whether a real
                         may equal the bound; a count always may */
    bool low_in, high_in;
    const char *const *choices; /* ends in NULL */
    const char *fallback; /* read if the key is missing; NULL: the key is required; "none": the
                             field keeps the value from haft_case_preset() */
    const char *example;  /* shown if the key is missing or of the wrong type */
    size_t offset;        /* in haft_case */
    size_t count;         /* reals in a list; 0: not a list */
    int laws;             /* a haft_laws_need: when the laws depend on it */
    int where;            /* a haft_surface_part: when it is written */
} haft_key;

typedef enum haft_section_kind {
    HAFT_SECTION_REQUIRED,
    HAFT_SECTION_OPTIONAL, /* if missing, its keys take their defaults */
    HAFT_SECTION_SWITCH,   /* if missing, the feature is turned off: contact.capillary */
} haft_section_kind;

typedef struct haft_section {
    const char *path;
    haft_section_kind kind;
} haft_section;

extern const haft_key haft_case_keys[];
extern const size_t haft_case_key_count;
extern const haft_section haft_case_sections[];
extern const size_t haft_case_section_count;

/* Upper bounds of the numbers of keys and sections, for arrays parallel to them. */
enum { HAFT_KEYS_MAX = 160, HAFT_SECTIONS_MAX = 16 };

/* Index of a dotted path among the keys or sections, or -1. */
int haft_case_find_key(const char *path);
int haft_case_find_section(const char *path);

/* Whether `path` lies directly in `section` ("" for the top level). */
bool haft_case_is_member(const char *path, const char *section);

/* The last part of a dotted path. */
const char *haft_case_leaf(const char *path);

/* Sets the fields that keep their value if a key with the fallback "none" is missing. */
void haft_case_preset(haft_case *c);

/* ---- complaints ---- */

typedef struct haft_mark {
    size_t line, column; /* from 1; 0: no position */
} haft_mark;

typedef struct haft_complaint {
    haft_mark mark;
    char text[512];
} haft_complaint;

enum { HAFT_COMPLAINTS_MAX = 128 };

typedef enum haft_key_state { HAFT_UNSEEN, HAFT_DEFAULTED, HAFT_GOOD, HAFT_BAD } haft_key_state;

/* A case being read. */
typedef struct haft_case_reader {
    haft_case *c;
    const char *path; /* of the file */
    const haft_units *units;
    haft_key_state state[HAFT_KEYS_MAX];
    haft_mark mark[HAFT_KEYS_MAX];
    haft_mark section_mark[HAFT_SECTIONS_MAX];
    haft_mark sweep_mark;
    haft_mark *evidence_mark; /* one per entry of the evidence */
    size_t complaints;        /* number of all, including those not kept */
    haft_complaint complaint[HAFT_COMPLAINTS_MAX];
    haft_error *error;   /* for failures that end the reading: out of memory */
    haft_status failure; /* of this kind */
} haft_case_reader;

/* Notes that the key at `path` is wrong at `mark`. */
void haft_case_complain(haft_case_reader *reader, haft_mark mark, const char *path,
                        const char *format, ...) HAFT_PRINTF(4, 5);

/* Writes all complaints into an error, in order of their position, one per line. */
haft_status haft_case_report(haft_case_reader *reader, const char *file, haft_error *error);

/* The nearest of n words by edit distance, NULL if none is near. */
const char *haft_case_nearest(const char *word, const char *const *words, size_t n);

/* Reads the text of a key (a scalar or one entry of a list) into the case; complains and returns
 * false if it is invalid. `entry` is the index in a list of reals. */
bool haft_case_store(haft_case_reader *reader, int key, size_t entry, const char *text,
                     size_t length, haft_mark mark);

/* The value of a key's field as a number; for a choice its index among the choices. */
double haft_case_number(const haft_case *c, const haft_key *key);

/* Reads the files that the keys of the surface name, and makes PSD, marginal and maps of them.
 * Complains at the keys' positions. */
void haft_case_load_surface(haft_case_reader *reader);

/* Loads the adsorbed film, from its table if the case has one. */
void haft_case_load_film(haft_case_reader *reader);

/* Reads two named columns of the one file in `files`, multiplied by `factors`, and the digest of
 * the file: points[n][2], to be freed even after a failure. */
haft_status haft_case_read_points(double **points, size_t *n, haft_case_files *files,
                                  const char *const names[2], const double factors[2],
                                  haft_error *error);

/* Makes contact.far of a case with dispersion that is sound in all else. */
haft_status haft_case_make_far_field(haft_case *c, haft_error *error);

/* Whether a key belongs to the case at all. */
bool haft_case_has_part(const haft_case *c, const haft_key *key);

/* Whether a key has valid values, and whether it was written with valid values. */
bool haft_case_is_sound(const haft_case_reader *reader, const char *path);
bool haft_case_is_given(const haft_case_reader *reader, const char *path);

/* Checks that need several keys at once. */
void haft_case_cross_check(haft_case_reader *reader);

#endif
