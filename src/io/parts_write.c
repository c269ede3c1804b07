/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One process's part of a campaign: an append-only log with one record per realization. A record is
 * one write, so a killed process leaves whole records and at most one incomplete one at the end; a
 * failed write is undone. Data that the kernel has taken survive the process; the file is flushed
 * to the disk at most once a second. */
#include "parts_folder.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const double SYNC_EVERY = 1; /* [s] */

enum { NUMBERS = 1000000 };

struct haft_part {
    int descriptor;
    char *path;
    off_t size; /* of all whole records */
    size_t records;
    double synced;
};

/* ---- shared by reader and writer ---- */

haft_status haft_part_head_digest(char digest[HAFT_DIGEST_CAPACITY], const haft_part_head *head,
                                  const char *text, haft_error *error) {
    size_t fixed = offsetof(haft_part_head, digest), size = (size_t)head->text_size;
    char *all = haft_memory_alloc(fixed + size, 1, error);
    if (all == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    memcpy(all, head, fixed);
    memcpy(all + fixed, text, size);
    haft_digest_memory(all, fixed + size, digest);
    haft_memory_free(all);
    return HAFT_OK;
}

haft_status haft_part_make_head(haft_part_head *head, char **text, const haft_case *c,
                                const char *laws_digest, haft_error *error) {
    char digest[HAFT_DIGEST_CAPACITY];
    HAFT_TRY(haft_case_emit(text, c, error));
    *head = (haft_part_head){
        .layout = HAFT_PART_LAYOUT, .order = HAFT_PART_ORDER, .text_size = strlen(*text)};
    memcpy(head->magic, HAFT_PART_MAGIC, sizeof head->magic);
    snprintf(head->program, sizeof head->program, "%s %s", haft_version(), haft_revision());
    snprintf(head->laws, sizeof head->laws, "%s", laws_digest);
    haft_status status = haft_part_head_digest(digest, head, *text, error);
    if (status == HAFT_OK) {
        memcpy(head->digest, digest, sizeof digest);
    }
    return status;
}

size_t haft_part_row_size(size_t columns, const haft_hdf_column *column) {
    size_t size = 0;
    for (size_t j = 0; j < columns; j++) {
        size += column[j].type == HAFT_HDF_REAL ? sizeof(double) : sizeof(int);
    }
    return size;
}

size_t haft_part_payload_size(const haft_part_counts *counts) {
    size_t points = haft_part_row_size(haft_hdf_point_column_count, haft_hdf_point_columns);
    size_t jumps = haft_part_row_size(haft_hdf_jump_column_count, haft_hdf_jump_columns);
    size_t total = sizeof *counts +
                   haft_part_row_size(haft_hdf_summary_column_count, haft_hdf_summary_columns);
    size_t state = 0, laws = 0;
    bool over = !haft_part_laws_size(counts, &laws) ||
                __builtin_add_overflow(total, laws, &total) ||
                __builtin_mul_overflow(points, counts->points, &points) ||
                __builtin_mul_overflow(jumps, counts->jumps, &jumps) ||
                __builtin_mul_overflow(counts->points, counts->dofs, &state) ||
                __builtin_mul_overflow(state, sizeof(double), &state) ||
                __builtin_add_overflow(total, points, &total) ||
                __builtin_add_overflow(total, jumps, &total) ||
                __builtin_add_overflow(total, state, &total);
    return over ? 0 : total;
}

/* ---- writing ---- */

static haft_status refused(const haft_part *part, int reason, haft_error *error) {
    return haft_error_set(error, HAFT_ERROR_IO, "%s: cannot be written: %s", part->path,
                          strerror(reason));
}

/* Appends all bytes, or none. */
static haft_status append(haft_part *part, const void *data, size_t size, haft_error *error) {
    const char *bytes = data;
    for (size_t done = 0; done < size;) {
        ssize_t n = write(part->descriptor, bytes + done, size - done);
        if (n < 0 && errno == EINTR) {
            continue;
        }
        if (n <= 0) {
            int reason = n < 0 ? errno : ENOSPC;
            if (ftruncate(part->descriptor, part->size) ==
                0) { /* else an incomplete record, skipped when read */
                (void)lseek(part->descriptor, part->size, SEEK_SET);
            }
            return refused(part, reason, error);
        }
        done += (size_t)n;
    }
    part->size += (off_t)size;
    return HAFT_OK;
}

static haft_status open_new(haft_part *part, const char *folder, size_t shard, size_t shards,
                            int rank, haft_error *error) {
    char prefix[HAFT_PART_NAME_CAPACITY];
    haft_parts_prefix(prefix, shard, shards);
    size_t capacity = strlen(folder) + sizeof prefix + 64;
    part->path = haft_memory_alloc(capacity, 1, error);
    if (part->path == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    for (int i = 0; i < NUMBERS && part->descriptor < 0; i++) {
        snprintf(part->path, capacity, "%s/%s%d-%d", folder, prefix, rank, i);
        part->descriptor = open(part->path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (part->descriptor < 0 && errno != EEXIST) {
            break;
        }
    }
    return part->descriptor >= 0 ? HAFT_OK
                                 : haft_error_set(error, HAFT_ERROR_IO, "%s: cannot be created: %s",
                                                  part->path, strerror(errno));
}

haft_status haft_part_create(haft_part **out, const char *folder, size_t shard, size_t shards,
                             int rank, const haft_case *c, const char *laws_digest,
                             haft_error *error) {
    *out = NULL;
    haft_part *part = haft_memory_alloc(1, sizeof *part, error);
    if (part == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    part->descriptor = -1;
    haft_part_head head;
    char *text = NULL;
    haft_status status = haft_part_make_head(&head, &text, c, laws_digest, error);
    HAFT_THEN(status, open_new(part, folder, shard, shards, rank, error));
    HAFT_THEN(status, append(part, &head, sizeof head, error));
    HAFT_THEN(status, append(part, text, (size_t)head.text_size, error));
    haft_memory_free(text);
    if (status != HAFT_OK) {
        (void)haft_part_close(&part, NULL);
        return status;
    }
    *out = part;
    return HAFT_OK;
}

static char *pack_rows(char *at, size_t columns, const haft_hdf_column *column, const void *rows,
                       size_t stride, size_t n) {
    for (size_t i = 0; i < n; i++) {
        const char *row = (const char *)rows + i * stride;
        for (size_t j = 0; j < columns; j++) {
            size_t size = column[j].type == HAFT_HDF_REAL ? sizeof(double) : sizeof(int);
            memcpy(at, row + column[j].offset, size);
            at += size;
        }
    }
    return at;
}

static void pack(char *at, const haft_part_counts *counts, const haft_path *path,
                 const haft_summary *summary, const haft_laws *laws) {
    memcpy(at, counts, sizeof *counts);
    at += sizeof *counts;
    at = pack_rows(at, haft_hdf_summary_column_count, haft_hdf_summary_columns, summary,
                   sizeof *summary, 1);
    at = pack_rows(at, haft_hdf_point_column_count, haft_hdf_point_columns, path->point,
                   sizeof *path->point, path->points);
    at = pack_rows(at, haft_hdf_jump_column_count, haft_hdf_jump_columns, path->jump,
                   sizeof *path->jump, path->jumps);
    if (counts->dofs > 0 && path->points > 0) {
        size_t size = path->points * counts->dofs * sizeof(double);
        memcpy(at, path->state, size);
        at += size;
    }
    if (laws != NULL) {
        haft_part_pack_laws(at, laws);
    }
}

haft_status haft_part_append(haft_part *part, size_t realization, const haft_path *path,
                             size_t dofs, const haft_summary *summary, const haft_laws *laws,
                             haft_error *error) {
    const haft_path_cost *cost = &path->cost;
    haft_part_counts counts = {.points = path->points,
                               .jumps = path->jumps,
                               .dofs = path->state != NULL ? dofs : 0,
                               .turn = path->turn,
                               .outcome = (uint64_t)path->outcome,
                               .steps = cost->steps,
                               .rejected = cost->rejected,
                               .newton_iterations = cost->newton_iterations,
                               .factorizations = cost->factorizations,
                               .solves = cost->solves,
                               .folds = cost->folds,
                               .flow_steps = cost->flow_steps,
                               .ledger_error = path->ledger_error,
                               .end_influence = path->end_influence};
    haft_part_count_laws(&counts, laws);
    haft_part_record head = {.realization = realization, .size = haft_part_payload_size(&counts)};
    char *bytes = haft_memory_alloc(sizeof head + head.size, 1, error);
    if (bytes == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    char digest[HAFT_DIGEST_CAPACITY];
    pack(bytes + sizeof head, &counts, path, summary, laws);
    memcpy(head.magic, HAFT_PART_RECORD_MAGIC, sizeof head.magic);
    haft_digest_memory(bytes + sizeof head, head.size, digest);
    memcpy(head.payload_digest, digest, sizeof head.payload_digest);
    haft_digest_memory(&head, offsetof(haft_part_record, digest), digest);
    memcpy(head.digest, digest, sizeof head.digest);
    memcpy(bytes, &head, sizeof head);
    haft_status status = append(part, bytes, sizeof head + head.size, error);
    haft_memory_free(bytes);
    part->records += status == HAFT_OK;
    if (status == HAFT_OK && haft_clock_seconds() - part->synced > SYNC_EVERY) {
        if (fdatasync(part->descriptor) != 0 && errno != EINVAL && errno != ENOTSUP) {
            status = refused(part, errno, error);
        }
        part->synced = haft_clock_seconds();
    }
    return status;
}

haft_status haft_part_close(haft_part **part, haft_error *error) {
    if (part == NULL || *part == NULL) {
        return HAFT_OK;
    }
    haft_part *p = *part;
    haft_status status = HAFT_OK;
    if (p->descriptor >= 0) {
        int reason =
            fdatasync(p->descriptor) != 0 && errno != EINVAL && errno != ENOTSUP ? errno : 0;
        if (close(p->descriptor) != 0 && reason == 0) {
            reason = errno;
        }
        if (p->records == 0) {
            unlink(p->path);
        }
        if (reason != 0) {
            status = refused(p, reason, error);
        }
    }
    haft_memory_free(p->path);
    haft_memory_free(p);
    *part = NULL;
    return status;
}
