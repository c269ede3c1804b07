/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Zeroed, aligned memory. 64 bytes are a cache line and enough for every FFTW codelet. */
#include "haft/base.h"

#include <stdlib.h>
#include <string.h>

enum { ALIGNMENT = 64 };

void *haft_memory_alloc(size_t count, size_t size, haft_error *error) {
    size_t bytes = 0;
    if (__builtin_mul_overflow(count, size, &bytes) || bytes > SIZE_MAX - ALIGNMENT) {
        haft_error_set(error, HAFT_ERROR_MEMORY,
                       "%zu items of %zu bytes overflow the address space", count, size);
        return NULL;
    }
    size_t padded = (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    void *memory = aligned_alloc(ALIGNMENT, padded == 0 ? ALIGNMENT : padded);
    if (memory == NULL) {
        haft_error_set(error, HAFT_ERROR_MEMORY, "out of memory asking for %zu bytes", bytes);
        return NULL;
    }
    memset(memory, 0, padded == 0 ? ALIGNMENT : padded);
    return memory;
}

void haft_memory_free(void *memory) {
    free(memory);
}
