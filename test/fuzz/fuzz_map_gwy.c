/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Height maps: Gwyddion's own files. The input follows the first bytes that every such file has. */
#include "map_input.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    return read_map_of(haft_map_read_gwy, "GWYP", data, size);
}
