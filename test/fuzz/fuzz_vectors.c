/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Law vectors from a table made elsewhere. */
#include "entry.h"

#include <math.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    haft_error error = {0};
    haft_law_vector *vector = NULL;
    size_t m = 0;
    if (size > 16384) {
        return -1;
    }
    const char *path = fuzz_put("table", data, size);
    haft_status status = haft_vectors_read(&vector, &m, path, &error);
    fuzz_check_status(status, &error);
    FUZZ_DEMAND((status == HAFT_OK) == (m > 0), "%zu vectors and status %d", m, (int)status);
    for (size_t i = 0; i < m; i++) {
        FUZZ_DEMAND(isfinite(vector[i].e + vector[i].f_max) && isfinite(vector[i].d_max) &&
                        isfinite(vector[i].d_limit),
                    "vector %zu is not finite", i);
    }
    haft_memory_free(vector);
    return 0;
}
