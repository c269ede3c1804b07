/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Layout of a part file. Private to this room.
 *
 * A head, the resolved case as text, then one record after another. Numbers are in the machine's
 * own byte order, which the head records. A record is its head and its payload: haft_part_counts;
 * then row by row the columns of the summary, the points and the jumps; then the states; then the
 * laws: their f_limit, vectors, faults and numbers per curve, the distances, the laws whose curves
 * are kept, and these curves. */
#ifndef HAFT_IO_PARTS_H
#define HAFT_IO_PARTS_H

#include "hdf.h"

enum {
    HAFT_PART_LAYOUT = 2,
    HAFT_PART_ORDER = 0x01020304,
    HAFT_PART_DIGITS = 32, /* of a digest, without a final 0 */
};
#define HAFT_PART_MAGIC "haftpart"
#define HAFT_PART_RECORD_MAGIC "haftreal"
#define HAFT_PART_PREFIX "part-"

typedef struct haft_part_head {
    char magic[8];
    uint32_t layout, order;
    uint64_t text_size;
    char program[64]; /* version and revision */
    char laws[40];    /* digest of the laws' inputs */
    char digest[40];  /* of the head before it, then the text */
} haft_part_head;
_Static_assert(sizeof(haft_part_head) == 168, "no holes");

typedef struct haft_part_record {
    char magic[8];
    uint64_t realization, size;
    char payload_digest[HAFT_PART_DIGITS];
    char digest[HAFT_PART_DIGITS]; /* of the record's head before it */
} haft_part_record;
_Static_assert(sizeof(haft_part_record) == 88, "no holes");

typedef struct haft_part_counts {
    uint64_t points, jumps;
    uint64_t dofs; /* of a state; 0: no states were kept */
    uint64_t turn, outcome;
    uint64_t steps, rejected, newton_iterations, factorizations, solves, folds, flow_steps;
    uint64_t laws, first_site, curves, distances; /* 0: none were kept */
    double ledger_error, end_influence;
} haft_part_counts;
_Static_assert(sizeof(haft_part_counts) == 144, "no holes");

/* Makes the head of a part of this case and its text, to be freed with haft_memory_free(). */
haft_status haft_part_make_head(haft_part_head *head, char **text, const haft_case *c,
                                const char *laws_digest, haft_error *error) HAFT_MUST_CHECK;

/* Digest of a head and its text. */
haft_status haft_part_head_digest(char digest[HAFT_DIGEST_CAPACITY], const haft_part_head *head,
                                  const char *text, haft_error *error) HAFT_MUST_CHECK;

/* Bytes of one packed row. */
size_t haft_part_row_size(size_t columns, const haft_hdf_column *column);

/* Bytes of a payload with these counts; 0 if it would be too large. */
size_t haft_part_payload_size(const haft_part_counts *counts);

/* ---- parts_laws.c: a realization's laws at the end of its payload ---- */

/* Sets the counts of the laws, which may be NULL. */
void haft_part_count_laws(haft_part_counts *counts, const haft_laws *laws);

/* The bytes of the laws; false if they would be too large. */
bool haft_part_laws_size(const haft_part_counts *counts, size_t *size);

void haft_part_pack_laws(char *at, const haft_laws *laws);

/* Reads the laws back, and rejects an invalid set. */
haft_status haft_part_unpack_laws(haft_laws **out, const haft_part_counts *counts, const char *at,
                                  haft_error *error) HAFT_MUST_CHECK;

#endif
