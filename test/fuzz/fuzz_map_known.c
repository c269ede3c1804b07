/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Height maps: any bytes, for formats that are known by name alone. */
#include "map_input.h"

static haft_status refuse(haft_map **out, const haft_map_file *file, haft_error *error) {
    return haft_map_is_known(file) ? haft_map_refuse_known(out, file, error)
                                   : haft_map_refuse_unknown(out, file, error);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    return read_map_of(refuse, "", data, size);
}
