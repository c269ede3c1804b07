/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the fuzzers share: the entry that libFuzzer calls, files in memory for readers that want a
 * path, checks of what came out, and numbers taken from the input. */
#ifndef HAFT_FUZZ_ENTRY_H
#define HAFT_FUZZ_ENTRY_H

#include "haft/io.h"

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Reads one input; @return 0, or -1 for an input that is not worth keeping. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Makes what takes its time ready, where a harness has such; @return 0. */
int LLVMFuzzerInitialize(int *count, char ***words);

/* What must hold of every input; ends the program where it does not, which is a finding. */
#define FUZZ_DEMAND(condition, ...)                                                                \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            fuzz_found(#condition, __VA_ARGS__);                                                   \
        }                                                                                          \
    } while (0)
void fuzz_found(const char *condition, const char *format, ...) HAFT_PRINTF(2, 3)
    __attribute__((noreturn));

/* What a status and its error must be like: a failure has a message, and memory is not short. */
void fuzz_check_status(haft_status status, const haft_error *error);

/* FOLDER/name in a folder of this process in memory; kept until the next but three calls. */
const char *fuzz_path(const char *name);

/* Makes that file, or puts other bytes into it; @return its path. */
const char *fuzz_put(const char *name, const void *data, size_t size);

/* All bytes of a file; to be freed with free(). */
uint8_t *fuzz_get(const char *path, size_t *size);

/* The case of cases/delrio-rh85 with so many realizations; made once, never freed. */
haft_case *fuzz_case(size_t realizations);

/* An input that is read bit by bit; zeros behind its end. */
typedef struct fuzz_bytes {
    const uint8_t *at;
    size_t left;
} fuzz_bytes;
uint8_t fuzz_byte(fuzz_bytes *bytes);
uint64_t fuzz_word(fuzz_bytes *bytes);

/* Below n; n > 0. */
size_t fuzz_choice(fuzz_bytes *bytes, size_t n);

/* A number that readers like least, or any: not finite, huge, tiny, 0, negative. */
double fuzz_real(fuzz_bytes *bytes);

#endif
