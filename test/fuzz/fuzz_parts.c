/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A part of an unfinished run. Its head is sound; the input is what follows, as it stands or with
 * the checksums made right, so that what a record holds is reached: the first byte tells. */
#include "entry.h"

#include "io/parts.h"

#include <sys/stat.h>

enum { BEAMS = 5, DOFS = 6, MOST = 1 << 16 };

static const char LAWS[] = "0123456789abcdef0123456789abcdef";

/* The head as Haft writes it. */
static size_t put_head(uint8_t *out) {
    static uint8_t *head;
    static size_t size;
    if (head == NULL) {
        haft_part_head h;
        haft_error error = {0};
        char *text = NULL;
        if (haft_part_make_head(&h, &text, fuzz_case(BEAMS), LAWS, &error) != HAFT_OK ||
            (mkdir(fuzz_path("parts"), 0777) != 0)) {
            abort();
        }
        size = sizeof h + h.text_size;
        head = malloc(size);
        memcpy(head, &h, sizeof h);
        memcpy(head + sizeof h, text, h.text_size);
        haft_memory_free(text);
    }
    memcpy(out, head, size);
    return size;
}

/* A record of one realization with right checksums; its counts are small, so that a payload of the
 * size that they call for is there, and its bytes are the input's. */
static size_t put_record(uint8_t *out, size_t room, fuzz_bytes *in) {
    haft_part_counts counts = {.points = fuzz_choice(in, 4),
                               .jumps = fuzz_choice(in, 3),
                               .dofs = fuzz_choice(in, 4) == 1 ? DOFS : 0,
                               .turn = fuzz_choice(in, 8),
                               .outcome = fuzz_choice(in, HAFT_OUTCOMES + 1),
                               .laws = fuzz_choice(in, 4),
                               .first_site = fuzz_choice(in, 4),
                               .curves = fuzz_choice(in, 4),
                               .distances = fuzz_choice(in, 6),
                               .ledger_error = fuzz_real(in)};
    uint8_t odd = fuzz_byte(in);
    if (odd >= 240) { /* one count beyond all bounds */
        uint64_t *count = (uint64_t *)&counts + odd % 16;
        *count = fuzz_word(in);
    }
    size_t size = haft_part_payload_size(&counts);
    if (odd >= 200 || size < sizeof counts || size > room / 2) {
        size = sizeof counts + fuzz_byte(in);
    }
    haft_part_record record = {.realization = fuzz_choice(in, BEAMS + 1), .size = size};
    if (sizeof record + size > room) {
        return 0;
    }
    uint8_t *payload = out + sizeof record;
    memset(payload, 0, size);
    memcpy(payload, &counts, sizeof counts);
    size_t rest = size - sizeof counts;
    for (size_t i = 0; i < rest; i++) {
        payload[sizeof counts + i] = fuzz_byte(in);
    }
    char digest[HAFT_DIGEST_CAPACITY];
    memcpy(record.magic, HAFT_PART_RECORD_MAGIC, sizeof record.magic);
    haft_digest_memory(payload, size, digest);
    memcpy(record.payload_digest, digest, sizeof record.payload_digest);
    haft_digest_memory(&record, offsetof(haft_part_record, digest), digest);
    memcpy(record.digest, digest, sizeof record.digest);
    memcpy(out, &record, sizeof record);
    return sizeof record + size;
}

static void ignore(void *user, const char *text) {
    (void)user;
    FUZZ_DEMAND(text[0] != '\0', "an empty note");
}

static void read_all(void) {
    haft_error error = {0};
    haft_parts *parts = NULL;
    haft_case *c = fuzz_case(BEAMS);
    haft_status status = haft_parts_hold(&parts, fuzz_path("parts"), 0, 0, &error);
    FUZZ_DEMAND(status == HAFT_OK, "%s", error.message);
    status = haft_parts_scan(parts, c, LAWS, ignore, NULL, &error);
    fuzz_check_status(status, &error);
    size_t found = 0;
    for (size_t k = 0; k < BEAMS && status == HAFT_OK; k++) {
        haft_path *path = NULL;
        haft_laws *laws = NULL;
        haft_summary summary;
        found += haft_parts_has(parts, k);
        if (!haft_parts_has(parts, k)) {
            continue;
        }
        haft_status one = haft_parts_read(&path, &summary, &laws, parts, k, DOFS, &error);
        fuzz_check_status(one, &error);
        FUZZ_DEMAND((one == HAFT_OK) == (path != NULL), "a path after a failure");
        for (size_t i = 0; path != NULL && i < path->points; i++) {
            int jump = path->point[i].jump;
            FUZZ_DEMAND(jump < 0 || (size_t)jump < path->jumps, "point %zu names jump %d of %zu", i,
                        jump, path->jumps);
        }
        FUZZ_DEMAND(one != HAFT_OK || (summary.outcome >= 0 && summary.outcome < HAFT_OUTCOMES),
                    "outcome %d", summary.outcome);
        haft_path_destroy(&path);
        haft_laws_destroy(&laws);
    }
    FUZZ_DEMAND(status != HAFT_OK || found == haft_parts_found(parts), "%zu of %zu found", found,
                haft_parts_found(parts));
    haft_parts_release(&parts);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static uint8_t file[MOST + 4096];
    if (size == 0 || size > MOST / 2) {
        return -1;
    }
    size_t n = put_head(file);
    fuzz_bytes in = {data + 1, size - 1};
    if ((data[0] & 1) == 0) {
        memcpy(file + n, in.at, in.left);
        n += in.left;
    }
    for (size_t added = 1; (data[0] & 1) == 1 && in.left > 0 && added > 0; n += added) {
        added = put_record(file + n, MOST - n, &in);
    }
    fuzz_put("parts/part-0-0", file, n);
    read_all();
    return 0;
}
