/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Digests tell whether an input has changed; they guard against accidents, not against malice. */
#include "haft/base.h"

#include <stdio.h>
#include <xxhash.h>

void haft_digest_memory(const void *data, size_t size, char digest[HAFT_DIGEST_CAPACITY]) {
    XXH128_hash_t hash = XXH3_128bits(data, size);
    snprintf(digest, HAFT_DIGEST_CAPACITY, "%016llx%016llx", (unsigned long long)hash.high64,
             (unsigned long long)hash.low64);
}
