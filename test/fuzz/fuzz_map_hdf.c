/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Height maps: HDF5, damaged byte by byte. A crash inside the library alone is foreign:
 * test/fuzz/run tells it from a finding by the stack. */
#include "map_input.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char magic[] = "\211HDF\r\n\032\n";
    if (size == 0 || size > 1 << 15) {
        return -1;
    }
    char digest[HAFT_DIGEST_CAPACITY];
    haft_map_options options = map_options(data[0]);
    haft_map *map = NULL;
    haft_error error = {0};
    uint8_t *bytes = malloc(sizeof magic - 1 + size);
    memcpy(bytes, magic, sizeof magic - 1);
    memcpy(bytes + sizeof magic - 1, data + 1, size - 1);
    const char *path = fuzz_put("data.h5", bytes, sizeof magic - 2 + size);
    free(bytes);
    check_map(haft_map_read(&map, path, &options, digest, &error), map, &error);
    return 0;
}
