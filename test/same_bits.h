/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares what two runs wrote, byte for byte but for the times taken. */
#ifndef HAFT_TEST_SAME_BITS_H
#define HAFT_TEST_SAME_BITS_H

#include "program.h"

#include <hdf5.h>

/* The bytes of a data file with what may differ set to 0: the header's checksum and the times. */
static inline char *reproducible_bytes(const char *path, size_t *size) {
    enum { FRONT = 512 };
    char *bytes = read_whole_file(path, size);
    hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    hid_t data = H5Dopen2(file, "/summary/seconds", H5P_DEFAULT);
    assert_true(file >= 0 && data >= 0);
    haddr_t offset = H5Dget_offset(data);
    size_t length = (size_t)H5Dget_storage_size(data);
    double seconds[64];
    assert_true(length > 0 && length <= sizeof seconds && offset + length <= *size);
    assert_true(H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, seconds) >= 0);
    assert_memory_equal(bytes + offset, seconds, length); /* they are where HDF5 says */
    memset(bytes + offset, 0, length);
    memset(bytes, 0, FRONT);
    H5Dclose(data);
    H5Fclose(file);
    return bytes;
}

static inline void check_same_bytes(const case_folder *a, const case_folder *b, const char *name) {
    char path_a[400], path_b[400];
    bool results = strcmp(name, "out/results.h5") == 0;
    size_t size_a = 0, size_b = 0;
    path_in(a, name, path_a);
    path_in(b, name, path_b);
    char *bytes_a =
        results ? reproducible_bytes(path_a, &size_a) : read_whole_file(path_a, &size_a);
    char *bytes_b =
        results ? reproducible_bytes(path_b, &size_b) : read_whole_file(path_b, &size_b);
    assert_int_equal(size_a, size_b);
    for (size_t i = 0; i < size_a; i++) {
        if (bytes_a[i] != bytes_b[i]) {
            fail_msg("%s differs from byte %zu of %zu on", name, i, size_a);
        }
    }
    free(bytes_a);
    free(bytes_b);
}

/* Gives a case the laws of another, so that they need not be built. */
static inline void copy_laws(const case_folder *from, const case_folder *to) {
    char path[400];
    size_t size = 0;
    char *laws = read_whole_file(path_in(from, "out/laws.h5", path), &size);
    mkdir(path_in(to, "out", path), 0777);
    write_file(path_in(to, "out/laws.h5", path), laws, size);
    free(laws);
}

#endif
