/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Height maps: HDF5, a sound one with edits. */
#include "hdf_edits.h"
#include "map_input.h"

static void write_map(const char *path) {
    double z[8][6], size[2] = {1e-6, 2e-6};
    for (int i = 0; i < 48; i++) {
        z[i / 6][i % 6] = (i * i * 11) % 17;
    }
    hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    hid_t group = H5Gcreate2(file, "maps", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    hid_t space = H5Screate_simple(2, (const hsize_t[]){8, 6}, NULL);
    hid_t two = H5Screate_simple(1, (const hsize_t[]){2}, NULL), one = H5Screate(H5S_SCALAR);
    hid_t text = H5Tcopy(H5T_C_S1);
    H5Tset_size(text, 3);
    hid_t set =
        H5Dcreate2(group, "data", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    hid_t unit = H5Acreate2(set, "unit", text, one, H5P_DEFAULT, H5P_DEFAULT);
    hid_t sides = H5Acreate2(set, "size", H5T_NATIVE_DOUBLE, two, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, z);
    H5Awrite(unit, text, "nm");
    H5Awrite(sides, H5T_NATIVE_DOUBLE, size);
    H5Aclose(sides);
    H5Aclose(unit);
    H5Dclose(set);
    H5Tclose(text);
    H5Sclose(one);
    H5Sclose(two);
    H5Sclose(space);
    H5Gclose(group);
    H5Fclose(file);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static fuzz_hdf file;
    if (size == 0 || size > 2048) {
        return -1;
    }
    if (file.bytes == NULL) {
        write_map(fuzz_path("data.h5"));
        fuzz_hdf_open(&file, fuzz_path("data.h5"));
    }
    char digest[HAFT_DIGEST_CAPACITY];
    fuzz_bytes in = {data + 1, size - 1};
    haft_map_options options = map_options(data[0]);
    haft_map *map = NULL;
    haft_error error = {0};
    const char *path = fuzz_hdf_put(&file, "data.h5", &in);
    haft_status status = haft_map_read(&map, path, &options, digest, &error);
    FUZZ_DEMAND(size > 1 || options.channel[0] != '\0' || status == HAFT_OK, "the sound file: %s",
                error.message);
    check_map(status, map, &error);
    return 0;
}
