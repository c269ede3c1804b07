/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The error budget read back. A byte 1 in the input stands for the digest of the case, which no
 * fuzzer would find. What was read must be written and read again. */
#include "entry.h"

#include "haft/study_report.h"

/* The digest as the writer of budgets puts it at the end of each line. */
static const char *case_digest(void) {
    static char digest[HAFT_DIGEST_CAPACITY];
    if (digest[0] == '\0') {
        char *text = NULL;
        haft_error error = {0};
        if (haft_case_emit(&text, fuzz_case(20), &error) != HAFT_OK) {
            abort();
        }
        haft_digest_memory(text, strlen(text), digest);
        haft_memory_free(text);
    }
    return digest;
}

static void check_budget(const haft_budget *b) {
    haft_error error = {0};
    haft_budget again;
    FUZZ_DEMAND(b->count <= HAFT_BUDGET_TERMS_MAX, "%zu terms", b->count);
    for (size_t i = 0; i < b->count; i++) {
        FUZZ_DEMAND(memchr(b->term[i].name, '\0', sizeof b->term[i].name) != NULL &&
                        memchr(b->term[i].change, '\0', sizeof b->term[i].change) != NULL,
                    "a text of term %zu has no end", i);
    }
    const char *path = fuzz_path("table");
    haft_status status = haft_study_write_budget(b, fuzz_case(20), path, &error);
    FUZZ_DEMAND(status == HAFT_OK, "%s", error.message);
    status = haft_study_read_budget(&again, fuzz_case(20), path, &error);
    FUZZ_DEMAND(status == HAFT_OK, "%s", error.message);
    FUZZ_DEMAND(again.count >= b->count && again.beams == b->beams, "%zu terms, then %zu", b->count,
                again.count); /* a term without a name comes out where a row lacked */
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static char text[1 << 16];
    haft_error error = {0};
    haft_budget budget;
    const char *digest = case_digest();
    size_t n = 0;
    for (size_t i = 0; i < size && n + HAFT_DIGEST_CAPACITY < sizeof text; i++) {
        if (data[i] == 1) {
            memcpy(text + n, digest, HAFT_DIGEST_CAPACITY - 1);
            n += HAFT_DIGEST_CAPACITY - 1;
        } else {
            text[n++] = (char)data[i];
        }
    }
    const char *path = fuzz_put("table", text, n);
    haft_status status = haft_study_read_budget(&budget, fuzz_case(20), path, &error);
    fuzz_check_status(status, &error);
    if (status == HAFT_OK) {
        check_budget(&budget);
    }
    return 0;
}
