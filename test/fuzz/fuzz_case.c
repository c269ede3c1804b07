/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A case's text, beside files that it may name: psd.csv, film.csv, map.gsf. What was read must emit
 * a text that reads back and emits the same, and so must a variant of a sweep. */
#include "entry.h"

#include <stdio.h>

static void put_companions(void) {
    static const char psd[] = "zeta [rad/um],s [nm^4]\n19.4,6460\n100,3\n289,0.00646\n";
    static const char film[] = "humidity [%],thickness [nm]\n5,0.1\n50,0.3\n95,1\n";
    haft_error error = {0};
    haft_map *map = NULL;
    fuzz_put("psd.csv", psd, sizeof psd - 1);
    fuzz_put("film.csv", film, sizeof film - 1);
    if (haft_map_create(&map, 8, 8, 1e-8, 1e-8, &error) != HAFT_OK) {
        abort();
    }
    for (size_t i = 0; i < 64; i++) {
        map->z[i] = 1e-9 * (double)((i * 37 + i * i * 11) % 17);
    }
    if (haft_map_write(map, fuzz_path("map.gsf"), &error) != HAFT_OK) {
        abort();
    }
    haft_map_destroy(&map);
}

static void check_round_trip(const haft_case *c) {
    haft_error error = {0};
    haft_case *again = NULL;
    char *text = NULL, *back = NULL;
    haft_status status = haft_case_emit(&text, c, &error);
    FUZZ_DEMAND(status == HAFT_OK, "%s", error.message);
    const char *path = fuzz_put("emitted.yaml", text, strlen(text));
    status = haft_case_read(&again, path, &error);
    FUZZ_DEMAND(status == HAFT_OK, "what was emitted is refused: %s\n%s", error.message, text);
    status = haft_case_emit(&back, again, &error);
    FUZZ_DEMAND(status == HAFT_OK, "%s", error.message);
    FUZZ_DEMAND(strcmp(text, back) == 0, "first:\n%s\nthen:\n%s", text, back);
    haft_memory_free(text);
    haft_memory_free(back);
    haft_case_destroy(&again);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static bool begun;
    haft_error error = {0};
    haft_case *c = NULL;
    if (size > 8192) {
        return -1;
    }
    if (!begun) {
        put_companions();
        begun = true;
    }
    const char *path = fuzz_put("case.yaml", data, size);
    haft_status status = haft_case_read(&c, path, &error);
    fuzz_check_status(status, &error);
    if (status == HAFT_OK) {
        size_t variants = c->sweep.variants;
        check_round_trip(c);
        haft_case_destroy(&c);
        if (variants > 1) {
            path = fuzz_path("case.yaml");
            status = haft_case_read_variant(&c, path, variants - 1, &error);
            fuzz_check_status(status, &error);
            if (status == HAFT_OK) {
                check_round_trip(c);
            }
        }
    }
    haft_case_destroy(&c);
    return 0;
}
