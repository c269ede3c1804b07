/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A height map's file as a fuzzer's input: the first byte tells what is given beside it. */
#ifndef HAFT_FUZZ_MAP_INPUT_H
#define HAFT_FUZZ_MAP_INPUT_H

#include "entry.h"

#include "io/map_file.h"

#include <math.h>

static inline haft_map_options map_options(uint8_t choice) {
    static const char *const channels[] = {
        "", "Height", "data", "z", "Height (retrace)", "Height 2", "height trace, main", "z/z"};
    return (haft_map_options){.channel = channels[(choice & 3) | (choice >> 3 & 4)],
                              .width = (choice & 4) != 0 ? 1e-6 : 0,
                              .height = (choice & 4) != 0 ? 2e-6 : 0,
                              .unit = (choice & 8) != 0 ? 1e-9 : 0,
                              .lateral_unit = (choice & 16) != 0 ? 1e-6 : 0};
}

/* What every map must be like. */
static inline void check_map(haft_status status, haft_map *map, const haft_error *error) {
    fuzz_check_status(status, error);
    FUZZ_DEMAND((status == HAFT_OK) == (map != NULL), "a map after a failure, or none after none");
    if (map == NULL) {
        return;
    }
    for (size_t i = 0; i < map->rows * map->columns; i++) {
        FUZZ_DEMAND(!isinf(map->z[i]), "an infinite height at %zu", i);
    }
    haft_map_destroy(&map);
}

/* Reads bytes by the reader of one kind, from memory of their very size. */
static inline int read_map_of(haft_status (*read)(haft_map **, const haft_map_file *, haft_error *),
                              const char *magic, const uint8_t *data, size_t size) {
    size_t begins = strlen(magic);
    if (size == 0 || size > 1 << 16) {
        return -1;
    }
    char *bytes = calloc(1, begins + size);
    memcpy(bytes, magic, begins);
    memcpy(bytes + begins, data + 1, size - 1);
    haft_map_file file = {
        .path = "map", .bytes = bytes, .size = begins + size - 1, .options = map_options(data[0])};
    haft_map *map = NULL;
    haft_error error = {0};
    check_map(read(&map, &file, &error), map, &error);
    free(bytes);
    return 0;
}

#endif
