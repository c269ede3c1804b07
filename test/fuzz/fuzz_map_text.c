/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Height maps: text, matrices and points; and files of any kind, as their first bytes tell. */
#include "map_input.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    if (size == 0 || size > 1 << 16) {
        return -1;
    }
    char digest[HAFT_DIGEST_CAPACITY];
    haft_map_options options = map_options(data[0]);
    haft_map *map = NULL;
    haft_error error = {0};
    if ((data[0] & 32) == 0) {
        return read_map_of(haft_map_read_text, "", data, size);
    }
    const char *path = fuzz_put("map", data + 1, size - 1);
    check_map(haft_map_read(&map, path, &options, digest, &error), map, &error);
    return 0;
}
