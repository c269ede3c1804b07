/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads parts back. Every record with valid checksums is used, even after a crash, a full disk or a
 * disk failure: after a damaged record, the next one is found by its magic number. */
#include "parts_folder.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { BLOCK = 1 << 16, TEXT_LIMIT = 1 << 20 /* of a resolved case */ };

/* A part being scanned. */
typedef struct scan {
    haft_parts *parts;
    size_t file;
    char *path;
    int descriptor;
    uint64_t size, at;
    const haft_part_head *head; /* the expected head */
    const char *text;
    void (*note)(void *user, const char *text);
    void *user;
    haft_error *error;
} scan;

static void tell(const scan *s, const char *format, ...) HAFT_PRINTF(2, 3);
static void tell(const scan *s, const char *format, ...) {
    char text[HAFT_TEXT_CAPACITY];
    va_list list;
    va_start(list, format);
    vsnprintf(text, sizeof text, format, list);
    va_end(list);
    if (s->note != NULL) {
        s->note(s->user, text);
    }
}

/* Reads bytes at an offset; false if the file is too short or cannot be read. */
static bool read_at(int descriptor, uint64_t offset, void *data, size_t size) {
    char *at = data;
    while (size > 0) {
        ssize_t n = pread(descriptor, at, size, (off_t)offset);
        if (n < 0 && errno == EINTR) {
            continue;
        }
        if (n <= 0) {
            return false;
        }
        at += n;
        offset += (uint64_t)n;
        size -= (size_t)n;
    }
    return true;
}

/* ---- the head ---- */

/* Finds the first lines that differ: the one of `ours` and the one of `theirs`. */
static void find_difference(const char *theirs, const char *ours, char line[2][160]) {
    line[0][0] = line[1][0] = '\0';
    while (*theirs != '\0' && *ours != '\0') {
        size_t n = strcspn(theirs, "\n"), m = strcspn(ours, "\n");
        if (n != m || strncmp(theirs, ours, n) != 0) {
            theirs += strspn(theirs, " ");
            ours += strspn(ours, " ");
            snprintf(line[0], sizeof line[0], "%.*s", (int)strcspn(theirs, "\n"), theirs);
            snprintf(line[1], sizeof line[1], "%.*s", (int)strcspn(ours, "\n"), ours);
            return;
        }
        theirs += n + (theirs[n] == '\n');
        ours += m + (ours[m] == '\n');
    }
}

static haft_status refuse_foreign(const scan *s, const haft_part_head *head, const char *text) {
    static const char way[] = "; to start anew, give `haft run --force`";
    if (memcmp(head->program, s->head->program, sizeof head->program) != 0) {
        return haft_error_set(s->error, HAFT_ERROR_INPUT,
                              "%s: was made by another build of the program, %.64s, this is %s; "
                              "resume with that one%s",
                              s->path, head->program, s->head->program, way);
    }
    char line[2][160];
    find_difference(text, s->text, line);
    if (line[0][0] != '\0' || strcmp(text, s->text) != 0) {
        return haft_error_set(s->error, HAFT_ERROR_INPUT,
                              "%s: belongs to another case: there \"%s\", here \"%s\"; to resume, "
                              "put case.yaml back as it was%s",
                              s->path, line[0], line[1], way);
    }
    return haft_error_set(s->error, HAFT_ERROR_INPUT,
                          "%s: was computed with other laws; to resume, put laws.h5 back as it "
                          "was%s",
                          s->path, way);
}

/* Checks the head. *usable is false if the file has no data that are certain to be of this case. */
static haft_status check_head(scan *s, bool *usable) {
    haft_part_head head;
    *usable = false;
    if (!read_at(s->descriptor, 0, &head, sizeof head)) {
        tell(s, "%s: ends within its head: it holds nothing", s->path);
        return HAFT_OK;
    }
    bool known = memcmp(head.magic, HAFT_PART_MAGIC, sizeof head.magic) == 0;
    if (known && (head.order != HAFT_PART_ORDER || head.layout != HAFT_PART_LAYOUT)) {
        return haft_error_set(s->error, HAFT_ERROR_INPUT,
                              "%s: has another layout or byte order; resume with the program and "
                              "on the kind of machine that made it, or start anew with `haft run "
                              "--force`",
                              s->path);
    }
    if (!known || head.text_size > TEXT_LIMIT) {
        tell(s, "%s: its head is damaged: what it holds is computed anew", s->path);
        return HAFT_OK;
    }
    char digest[HAFT_DIGEST_CAPACITY];
    char *text = haft_memory_alloc((size_t)head.text_size + 1, 1, s->error);
    if (text == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    haft_status status = HAFT_OK;
    if (!read_at(s->descriptor, sizeof head, text, (size_t)head.text_size)) {
        tell(s, "%s: ends within its head: it holds nothing", s->path);
    } else {
        status = haft_part_head_digest(digest, &head, text, s->error);
        if (status == HAFT_OK && memcmp(head.digest, digest, sizeof digest) != 0) {
            tell(s, "%s: its head is damaged: what it holds is computed anew", s->path);
        } else if (status == HAFT_OK && memcmp(head.digest, s->head->digest, sizeof digest) != 0) {
            status = refuse_foreign(s, &head, text);
        } else if (status == HAFT_OK) {
            *usable = true;
            s->at = sizeof head + head.text_size;
        }
    }
    haft_memory_free(text);
    return status;
}

/* ---- records ---- */

static bool is_record(const scan *s, uint64_t at, haft_part_record *record) {
    char digest[HAFT_DIGEST_CAPACITY];
    if (at + sizeof *record > s->size || !read_at(s->descriptor, at, record, sizeof *record) ||
        memcmp(record->magic, HAFT_PART_RECORD_MAGIC, sizeof record->magic) != 0) {
        return false;
    }
    haft_digest_memory(record, offsetof(haft_part_record, digest), digest);
    return memcmp(record->digest, digest, sizeof record->digest) == 0 &&
           record->realization < s->parts->realizations;
}

/* The offset of the next record from `at` on; the file's size if there is none. */
static uint64_t find_record(const scan *s, uint64_t at) {
    enum { MAGIC = sizeof((haft_part_record *)0)->magic };
    char block[BLOCK];
    haft_part_record record;
    while (at + sizeof record <= s->size) {
        size_t n = s->size - at < sizeof block ? (size_t)(s->size - at) : sizeof block;
        if (!read_at(s->descriptor, at, block, n)) {
            break;
        }
        for (size_t i = 0; i + MAGIC <= n; i++) {
            if (memcmp(block + i, HAFT_PART_RECORD_MAGIC, MAGIC) == 0 &&
                is_record(s, at + i, &record)) {
                return at + i;
            }
        }
        at += n - MAGIC + 1;
    }
    return s->size;
}

static haft_status enter(scan *s, const haft_part_record *record, uint64_t offset) {
    haft_parts_entry *entry = &s->parts->entry[record->realization];
    char digest[HAFT_DIGEST_CAPACITY];
    char *payload = haft_memory_alloc((size_t)record->size, 1, s->error);
    if (payload == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    bool whole = read_at(s->descriptor, offset, payload, (size_t)record->size);
    if (whole) {
        haft_digest_memory(payload, (size_t)record->size, digest);
        whole = memcmp(record->payload_digest, digest, sizeof record->payload_digest) == 0;
    }
    haft_memory_free(payload);
    if (!whole) {
        tell(s, "%s: the record at byte %llu, of realization %llu, is damaged: it is computed anew",
             s->path, (unsigned long long)s->at, (unsigned long long)record->realization);
    } else if (entry->size == 0) {
        *entry = (haft_parts_entry){.file = s->file, .offset = offset, .size = record->size};
        memcpy(entry->digest, record->payload_digest, sizeof entry->digest);
        s->parts->found++;
    } else {
        s->parts->repeated++;
    }
    return HAFT_OK;
}

static haft_status scan_records(scan *s) {
    haft_status status = HAFT_OK;
    while (status == HAFT_OK && s->at < s->size) {
        haft_part_record record;
        if (!is_record(s, s->at, &record)) {
            uint64_t next = find_record(s, s->at + 1);
            if (next == s->size && s->size - s->at < sizeof record) {
                tell(s, "%s: its last record was cut short, at byte %llu: it is dropped", s->path,
                     (unsigned long long)s->at);
            } else {
                tell(s, "%s: bytes %llu to %llu are no whole record: they are skipped", s->path,
                     (unsigned long long)s->at, (unsigned long long)next - 1);
            }
            s->at = next;
            continue;
        }
        uint64_t offset = s->at + sizeof record;
        if (record.size > s->size - offset) {
            tell(s,
                 "%s: its last record was cut short, at byte %llu: realization %llu is computed "
                 "anew",
                 s->path, (unsigned long long)s->at, (unsigned long long)record.realization);
            s->at = find_record(s, offset);
            continue;
        }
        status = enter(s, &record, offset);
        s->at = offset + record.size;
    }
    return status;
}

static haft_status scan_file(scan *s) {
    bool usable = false;
    s->path = haft_parts_join(s->parts, s->parts->file[s->file], s->error);
    if (s->path == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    size_t size = 0;
    haft_status status = haft_file_open(&s->descriptor, &size, s->path, s->error);
    if (status == HAFT_OK) {
        s->size = size;
        status = check_head(s, &usable);
    }
    if (status == HAFT_OK && usable) {
        status = scan_records(s);
    }
    if (s->descriptor >= 0) {
        close(s->descriptor);
    }
    haft_memory_free(s->path);
    return status;
}

haft_status haft_parts_scan(haft_parts *parts, const haft_case *c, const char *laws_digest,
                            void (*note)(void *user, const char *text), void *user,
                            haft_error *error) {
    haft_part_head head;
    char *text = NULL;
    haft_status status = haft_parts_list(parts, error);
    HAFT_THEN(status, haft_part_make_head(&head, &text, c, laws_digest, error));
    if (status == HAFT_OK) {
        parts->realizations = c->realizations;
        parts->entry = haft_memory_alloc(c->realizations, sizeof *parts->entry, error);
        status = parts->entry == NULL ? HAFT_ERROR_MEMORY : HAFT_OK;
    }
    for (size_t i = 0; status == HAFT_OK && i < parts->files; i++) {
        scan s = {.parts = parts,
                  .file = i,
                  .head = &head,
                  .text = text,
                  .note = note,
                  .user = user,
                  .error = error};
        status = scan_file(&s);
    }
    haft_memory_free(text);
    return status;
}

/* ---- one realization ---- */

static const char *unpack_rows(const char *at, size_t columns, const haft_hdf_column *column,
                               void *rows, size_t stride, size_t n) {
    for (size_t i = 0; i < n; i++) {
        char *row = (char *)rows + i * stride;
        for (size_t j = 0; j < columns; j++) {
            size_t size = column[j].type == HAFT_HDF_REAL ? sizeof(double) : sizeof(int);
            memcpy(row + column[j].offset, at, size);
            at += size;
        }
    }
    return at;
}

static haft_status make_path(haft_path **out, const haft_part_counts *counts, haft_error *error) {
    haft_path *path = *out = haft_memory_alloc(1, sizeof *path, error);
    if (path == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    *path = (haft_path){.points = counts->points,
                        .jumps = counts->jumps,
                        .point_capacity = counts->points,
                        .jump_capacity = counts->jumps,
                        .turn = counts->turn,
                        .outcome = (haft_outcome)counts->outcome,
                        .ledger_error = counts->ledger_error,
                        .end_influence = counts->end_influence,
                        .cost = {.steps = counts->steps,
                                 .rejected = counts->rejected,
                                 .newton_iterations = counts->newton_iterations,
                                 .factorizations = counts->factorizations,
                                 .solves = counts->solves,
                                 .folds = counts->folds,
                                 .flow_steps = counts->flow_steps}};
    path->point = haft_memory_alloc(path->points, sizeof *path->point, error);
    path->jump = haft_memory_alloc(path->jumps, sizeof *path->jump, error);
    bool missing = path->point == NULL || path->jump == NULL;
    if (counts->dofs > 0) {
        path->state = haft_memory_alloc(counts->points * counts->dofs, sizeof(double), error);
        missing = missing || path->state == NULL;
    }
    if (missing) {
        haft_path_destroy(out);
        return HAFT_ERROR_MEMORY;
    }
    return HAFT_OK;
}

/* Whether the path's turn, the jumps that its points name and the summary's outcome exist. */
static bool is_sound(const haft_path *path, const haft_summary *summary) {
    bool sound = (path->turn == 0 || path->turn < path->points) && summary->outcome >= 0 &&
                 summary->outcome < HAFT_OUTCOMES;
    for (size_t i = 0; sound && i < path->points; i++) {
        int jump = path->point[i].jump;
        sound = jump >= -1 && (jump < 0 || (size_t)jump < path->jumps);
    }
    return sound;
}

static haft_status unpack(haft_path **out, haft_summary *summary, haft_laws **laws,
                          const char *payload, size_t size, size_t dofs, haft_error *error) {
    haft_part_counts counts;
    bool fits = size >= sizeof counts;
    if (fits) {
        memcpy(&counts, payload, sizeof counts);
        fits = haft_part_payload_size(&counts) == size && counts.outcome < HAFT_OUTCOMES &&
               (counts.dofs == 0 || counts.dofs == dofs);
    }
    if (!fits) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "holds no path of this case");
    }
    haft_status status = make_path(out, &counts, error);
    if (status != HAFT_OK) {
        return status;
    }
    haft_path *path = *out;
    const char *at = payload + sizeof counts;
    at = unpack_rows(at, haft_hdf_summary_column_count, haft_hdf_summary_columns, summary,
                     sizeof *summary, 1);
    at = unpack_rows(at, haft_hdf_point_column_count, haft_hdf_point_columns, path->point,
                     sizeof *path->point, path->points);
    at = unpack_rows(at, haft_hdf_jump_column_count, haft_hdf_jump_columns, path->jump,
                     sizeof *path->jump, path->jumps);
    if (path->state != NULL) {
        size_t states = path->points * counts.dofs * sizeof(double);
        memcpy(path->state, at, states);
        at += states;
    }
    if (!is_sound(path, summary)) {
        status = haft_error_set(error, HAFT_ERROR_INPUT,
                                "holds a path that turns beyond its end, names a jump that it does "
                                "not have or ends at no known outcome; start anew with `haft run "
                                "--force`");
    } else if (laws != NULL) {
        status = haft_part_unpack_laws(laws, &counts, at, error);
    }
    if (status != HAFT_OK) {
        haft_path_destroy(out);
    }
    return status;
}

/* Reads the bytes of an entry, which were intact when the parts were scanned. */
static haft_status read_payload(char *payload, const char *path, const haft_parts_entry *entry,
                                haft_error *error) {
    char digest[HAFT_DIGEST_CAPACITY];
    size_t size = (size_t)entry->size;
    int descriptor = -1;
    HAFT_TRY(haft_file_open(&descriptor, NULL, path, error));
    errno = 0;
    bool whole = read_at(descriptor, entry->offset, payload, size);
    int reason = whole ? 0 : errno; /* 0: the file is too short */
    close(descriptor);
    if (reason != 0) {
        return haft_error_set(error, HAFT_ERROR_IO, "%s: byte %llu: cannot be read: %s", path,
                              (unsigned long long)entry->offset, strerror(reason));
    }
    if (whole) {
        haft_digest_memory(payload, size, digest);
        whole = memcmp(digest, entry->digest, sizeof entry->digest) == 0;
    }
    return whole ? HAFT_OK
                 : haft_error_set(error, HAFT_ERROR_IO,
                                  "%s: byte %llu: changed while it was being read; give `haft "
                                  "resume`",
                                  path, (unsigned long long)entry->offset);
}

haft_status haft_parts_read(haft_path **out, haft_summary *summary, haft_laws **laws,
                            const haft_parts *parts, size_t realization, size_t dofs,
                            haft_error *error) {
    *out = NULL;
    if (laws != NULL) {
        *laws = NULL;
    }
    if (!haft_parts_has(parts, realization)) {
        return haft_error_set(error, HAFT_ERROR_IO,
                              "%s: holds realization %zu no more; give `haft resume`",
                              parts->folder, realization);
    }
    const haft_parts_entry *entry = &parts->entry[realization];
    size_t size = (size_t)entry->size;
    char *payload = haft_memory_alloc(size, 1, error);
    char *path = haft_parts_join(parts, parts->file[entry->file], error);
    haft_status status = payload == NULL || path == NULL ? HAFT_ERROR_MEMORY : HAFT_OK;
    HAFT_THEN(status, read_payload(payload, path, entry, error));
    if (status == HAFT_OK) {
        status = unpack(out, summary, laws, payload, size, dofs, error);
        if (status != HAFT_OK && status != HAFT_ERROR_MEMORY) {
            haft_error_prefix(error, "%s: byte %llu: ", path, (unsigned long long)entry->offset);
        }
    }
    haft_memory_free(path);
    haft_memory_free(payload);
    return status;
}
