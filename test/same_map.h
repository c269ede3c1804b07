/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One map of 64 x 64 pixels and 2.56 x 2.56 um, written in every format that Haft reads. */
#ifndef HAFT_TEST_SAME_MAP_H
#define HAFT_TEST_SAME_MAP_H

#include "gwy_files.h"

#include <hdf5.h>

enum { SIDE = 64 };
static const double STEP = 40e-9;

static inline FILE *begin(const char *path) {
    FILE *stream = fopen(path, "wb");
    assert_non_null(stream);
    return stream;
}

static inline void end(FILE *stream) {
    assert_int_equal(fclose(stream), 0);
}

static inline void write_matrix(FILE *stream, const double *z, double unit, char separator) {
    for (size_t i = 0; i < SIDE; i++) {
        for (size_t j = 0; j < SIDE; j++) {
            fprintf(stream, "%.9g%c", z[i * SIDE + j] / unit, j + 1 < SIDE ? separator : '\n');
        }
    }
}

/* 16 bits of 20 nm/V, from the bottom. */
static inline void write_nanoscope_map(const char *path, const double *z) {
    enum { HEADER = 2048 };
    char header[HEADER] = "";
    FILE *stream = begin(path);
    sprintf(header,
            "\\*File list\r\n\\Version: 0x07200000\r\n\\Data length: %d\r\n\\*Scanner list\r\n"
            "\\@Sens. Zsens: V 20.00000 nm/V\r\n\\*Ciao image list\r\n\\Data offset: %d\r\n"
            "\\Data length: %d\r\n\\Bytes/pixel: 2\r\n\\Samps/line: %d\r\n\\Number of lines: %d\r\n"
            "\\Aspect Ratio: 1:1\r\n\\Scan Size: 2.56 2.56 ~m\r\n"
            "\\@2:Z scale: V [Sens. Zsens] (0.0001 V/LSB) 2.56 V\r\n"
            "\\@2:Image Data: S [Height] \"Height\"\r\n\\*File list end\r\n\x1a",
            HEADER, HEADER, 2 * SIDE * SIDE, SIDE, SIDE);
    assert_int_equal(fwrite(header, 1, HEADER, stream), HEADER);
    for (size_t i = SIDE; i-- > 0;) {
        for (size_t j = 0; j < SIDE; j++) {
            long raw = lround(z[i * SIDE + j] / (20e-9 * 2.56 / 65536));
            fputc((int)((unsigned long)raw & 0xff), stream);
            fputc((int)((unsigned long)raw >> 8 & 0xff), stream);
        }
    }
    end(stream);
}

static inline void write_gsf(const char *path, const double *z) {
    FILE *stream = begin(path);
    char header[200];
    int n = sprintf(header,
                    "Gwyddion Simple Field 1.0\nXRes = %d\nYRes = %d\nXReal = 2.56e-6\n"
                    "YReal = 2.56e-6\nXYUnits = m\nZUnits = m\n",
                    SIDE, SIDE);
    fwrite(header, 1, (size_t)n, stream);
    for (int k = 0; k < 4 - n % 4; k++) {
        fputc(0, stream);
    }
    for (size_t k = 0; k < (size_t)SIDE * SIDE; k++) {
        float value = (float)z[k];
        fwrite(&value, sizeof value, 1, stream);
    }
    end(stream);
}

static inline void write_hdf(const char *path, const double *z) {
    hsize_t shape[2] = {SIDE, SIDE}, two = 2;
    double size[2] = {2.56e-6, 2.56e-6};
    hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    hid_t space = H5Screate_simple(2, shape, NULL), pair = H5Screate_simple(1, &two, NULL);
    hid_t one = H5Screate(H5S_SCALAR), text = H5Tcopy(H5T_C_S1);
    H5Tset_size(text, 2);
    hid_t set =
        H5Dcreate2(file, "height", H5T_NATIVE_FLOAT, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    hid_t unit = H5Acreate2(set, "unit", text, one, H5P_DEFAULT, H5P_DEFAULT);
    hid_t sides = H5Acreate2(set, "size", H5T_NATIVE_DOUBLE, pair, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, z) >= 0 &&
                H5Awrite(unit, text, "m") >= 0 && H5Awrite(sides, H5T_NATIVE_DOUBLE, size) >= 0);
    H5Aclose(sides);
    H5Aclose(unit);
    H5Dclose(set);
    H5Tclose(text);
    H5Sclose(one);
    H5Sclose(pair);
    H5Sclose(space);
    assert_true(H5Fclose(file) >= 0);
}

static inline void write_gwyddion_text(const char *path, const double *z) {
    FILE *stream = begin(path);
    fprintf(stream, "# Channel: Height\n# Width: 2.56 \xc2\xb5m\n# Height: 2.56 \xc2\xb5m\n"
                    "# Value units: m\n");
    write_matrix(stream, z, 1, '\t');
    end(stream);
}

static inline void write_bare_text(const char *path, const double *z) {
    FILE *stream = begin(path);
    write_matrix(stream, z, 1e-9, ' ');
    end(stream);
}

static inline void write_csv(const char *path, const double *z) {
    FILE *stream = begin(path);
    write_matrix(stream, z, 1e-9, ',');
    end(stream);
}

static inline void write_points(const char *path, const double *z) {
    FILE *stream = begin(path);
    for (size_t k = 0; k < (size_t)SIDE * SIDE; k++) {
        fprintf(stream, "%.10g %.10g %.9g\n", 1e6 * STEP * (double)(k % SIDE),
                1e6 * STEP * (double)(SIDE - k / SIDE), z[k] * 1e9);
    }
    end(stream);
}

/* NumPy: magic, version 1.0, length of a header that ends at a multiple of 64. */
static inline void write_npy(const char *path, const double *z) {
    enum { HEADER = 128 };
    char header[HEADER + 1];
    FILE *stream = begin(path);
    memcpy(header, "\x93NUMPY\1\0\x76\0", 10);
    int n = sprintf(header + 10, "{'descr': '<f8', 'fortran_order': False, 'shape': (%d, %d), }",
                    SIDE, SIDE);
    memset(header + 10 + n, ' ', (size_t)(HEADER - 10 - n));
    header[HEADER - 1] = '\n';
    fwrite(header, 1, HEADER, stream);
    fwrite(z, sizeof *z, (size_t)SIDE * SIDE, stream);
    end(stream);
}

/* Gwyddion's own: heights beside a channel of volts. */
static inline void write_gwyddion(const char *path, const double *z) {
    gwy_part items = {NULL, 0};
    gwy_field f = {SIDE, SIDE, 2.56e-6, 2.56e-6, "m", "V", z};
    gwy_put_field(&items, "/0/data", &f);
    gwy_put_text(&items, "/0/data/title", "Amplitude");
    f.unit = "m";
    gwy_put_field(&items, "/1/data", &f);
    gwy_put_text(&items, "/1/data/title", "Height");
    gwy_part file = gwy_make_file(items);
    write_file(path, file.bytes, file.size);
    free(file.bytes);
}

static inline void put_attribute(hid_t set, const char *name, hid_t type, const void *value) {
    hid_t one = H5Screate(H5S_SCALAR);
    hid_t attribute = H5Acreate2(set, name, type, one, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(H5Awrite(attribute, type, value) >= 0);
    H5Aclose(attribute);
    H5Sclose(one);
}

/* As NetCDF packs: whole numbers of 16 bits, a scale and an offset, a dimension of length 1. */
static inline void write_packed(const char *path, const double *z) {
    hsize_t shape[3] = {1, SIDE, SIDE};
    double scale = 1e-3, offset = 2;
    short *packed = calloc((size_t)SIDE * SIDE, sizeof *packed), fill = -32768;
    assert_non_null(packed);
    for (size_t k = 0; k < (size_t)SIDE * SIDE; k++) {
        packed[k] = (short)lround((z[k] * 1e9 - offset) / scale);
    }
    hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    hid_t space = H5Screate_simple(3, shape, NULL), text = H5Tcopy(H5T_C_S1);
    H5Tset_size(text, 2);
    hid_t set =
        H5Dcreate2(file, "z", H5T_NATIVE_SHORT, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(H5Dwrite(set, H5T_NATIVE_SHORT, H5S_ALL, H5S_ALL, H5P_DEFAULT, packed) >= 0);
    put_attribute(set, "units", text, "nm");
    put_attribute(set, "scale_factor", H5T_NATIVE_DOUBLE, &scale);
    put_attribute(set, "add_offset", H5T_NATIVE_DOUBLE, &offset);
    put_attribute(set, "_FillValue", H5T_NATIVE_SHORT, &fill);
    H5Dclose(set);
    H5Tclose(text);
    H5Sclose(space);
    assert_true(H5Fclose(file) >= 0);
    free(packed);
}

/* As a spreadsheet saves "Unicode text": UTF-16 with a byte order mark, decimal commas. */
static inline void write_utf16(const char *path, const double *z) {
    FILE *stream = begin(path);
    char number[40];
    fputs("\xff\xfe", stream);
    for (size_t k = 0; k < (size_t)SIDE * SIDE; k++) {
        snprintf(number, sizeof number, "%.6f%s", z[k] * 1e9, k % SIDE + 1 < SIDE ? "\t" : "\r\n");
        for (const char *c = number; *c != '\0'; c++) {
            fputc(*c == '.' ? ',' : *c, stream);
            fputc(0, stream);
        }
    }
    end(stream);
}

#endif
