/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Maps in formats of others, written after their public descriptions. Heights are in metres, rows
 * from the top, and a multiple of 0.1 nm, so that formats of whole numbers hold them. */
#ifndef HAFT_TEST_FOREIGN_MAPS_H
#define HAFT_TEST_FOREIGN_MAPS_H

#include "gwy_files.h"

enum { FOREIGN_ROWS = 12, FOREIGN_COLUMNS = 16 };

static const double foreign_width = 4.8e-6, foreign_height = 1.2e-6, foreign_step = 1e-10;

/* Height of a pixel in steps. */
static inline int foreign_steps(size_t i, size_t j) {
    return (int)(37 * i * i + 11 * j + 5 * i * j) % 2001 - 1000;
}

/* ISO 25178-71 as text: a header of "name = value", a line "*", the numbers, a line "*". Heights
 * are in units of Zscale, points apart by Xscale and profiles by Yscale, in metres. */
static inline void write_sdf(const char *path) {
    FILE *stream = fopen(path, "wb");
    assert_non_null(stream);
    fprintf(stream,
            "aISO-1.0\r\nManufacID   = Haft\r\nCreateDate  = 010120261200\r\n"
            "ModDate     = 010120261200\r\nNumPoints   = %d\r\nNumProfiles = %d\r\n"
            "Xscale      = %.9e\r\nYscale      = %.9e\r\nZscale      = %.9e\r\n"
            "Zresolution = -1\r\nCompression = 0\r\nDataType    = 6\r\nCheckType   = 0\r\n*\r\n",
            FOREIGN_COLUMNS, FOREIGN_ROWS, foreign_width / FOREIGN_COLUMNS,
            foreign_height / FOREIGN_ROWS, foreign_step);
    for (size_t i = 0; i < FOREIGN_ROWS; i++) {
        for (size_t j = 0; j < FOREIGN_COLUMNS; j++) {
            fprintf(stream, " %d", foreign_steps(i, j));
        }
        fprintf(stream, "\r\n");
    }
    fprintf(stream, "*\r\n");
    assert_int_equal(fclose(stream), 0);
}

/* WSxM: a text header whose length stands in it, then doubles from the last column of the last row
 * to the first of the first; the difference of the greatest and the least is the Z amplitude. */
static inline void write_stp(const char *path) {
    gwy_part file = {NULL, 0};
    char header[1200];
    int least = 0, greatest = 0;
    for (size_t k = 0; k < FOREIGN_ROWS * FOREIGN_COLUMNS; k++) {
        int steps = foreign_steps(k / FOREIGN_COLUMNS, k % FOREIGN_COLUMNS);
        least = steps < least ? steps : least;
        greatest = steps > greatest ? steps : greatest;
    }
    for (int pass = 0, size = 0; pass < 2; pass++) {
        size =
            snprintf(header, sizeof header,
                     "WSxM file copyright UAM\r\nSxM Image file\r\nImage header size: %4d\r\n"
                     "\r\n[Control]\r\n\r\n    X Amplitude: 4.8 \xb5m\r\n"
                     "    Y Amplitude: 1.2 \xb5m\r\n    X scanning direction: Forward\r\n"
                     "\r\n[General Info]\r\n\r\n    Acquisition channel: Topography\r\n"
                     "    Image Data Type: double\r\n    Number of columns: %d\r\n"
                     "    Number of rows: %d\r\n    Z Amplitude: %.6f nm\r\n\r\n[Header end]\r\n",
                     size, FOREIGN_COLUMNS, FOREIGN_ROWS, 0.1 * (greatest - least));
    }
    gwy_put(&file, header, strlen(header));
    for (size_t k = FOREIGN_ROWS * FOREIGN_COLUMNS; k-- > 0;) {
        double value = foreign_steps(k / FOREIGN_COLUMNS, k % FOREIGN_COLUMNS);
        uint64_t word = 0;
        memcpy(&word, &value, 8);
        gwy_put_word(&file, word, 8);
    }
    write_file(path, file.bytes, file.size);
    free(file.bytes);
}

static inline void put_at(char *header, size_t at, uint64_t value, size_t n) {
    for (size_t k = 0; k < n; k++) {
        header[at + k] = (char)(value >> (8 * k));
    }
}

static inline void put_single_at(char *header, size_t at, float value) {
    uint32_t word = 0;
    memcpy(&word, &value, 4);
    put_at(header, at, word, 4);
}

/* Digital Surf: a header of 512 bytes, then whole numbers of 32 bits, in steps of the z axis. */
static inline void write_sur(const char *path) {
    gwy_part file = {NULL, 0};
    char header[512] = {0};
    memcpy(header, "DIGITAL SURF", 12);
    put_at(header, 14, 1, 2); /* objects */
    put_at(header, 16, 1, 2); /* version */
    put_at(header, 18, 2, 2); /* a surface */
    memcpy(header + 20, "Scan forward", 12);
    put_at(header, 88, 1, 2);  /* heights are absolute */
    put_at(header, 98, 32, 2); /* bits */
    put_at(header, 100, (uint32_t)-1000, 4);
    put_at(header, 104, 1000, 4);
    put_at(header, 108, FOREIGN_COLUMNS, 4);
    put_at(header, 112, FOREIGN_ROWS, 4);
    put_at(header, 116, FOREIGN_ROWS * FOREIGN_COLUMNS, 4);
    put_single_at(header, 120, 0.3F); /* steps along x, y and z */
    put_single_at(header, 124, 0.1F);
    put_single_at(header, 128, 0.1F);
    memcpy(header + 132, "X", 1);
    memcpy(header + 148, "Y", 1);
    memcpy(header + 164, "Z", 1);
    for (size_t k = 0; k < 2; k++) { /* units of the steps, and of the axes */
        memcpy(header + 180 + 48 * k, "um", 2);
        memcpy(header + 196 + 48 * k, "um", 2);
        memcpy(header + 212 + 48 * k, "nm", 2);
    }
    put_single_at(header, 276, 1);
    put_single_at(header, 280, 1);
    put_single_at(header, 284, 1);
    gwy_put(&file, header, sizeof header);
    for (size_t k = 0; k < FOREIGN_ROWS * FOREIGN_COLUMNS; k++) {
        gwy_put_word(&file, (uint32_t)foreign_steps(k / FOREIGN_COLUMNS, k % FOREIGN_COLUMNS), 4);
    }
    write_file(path, file.bytes, file.size);
    free(file.bytes);
}

/* Gwyddion's own: two channels of heights and one of volts, a mask on the first. */
static inline void write_gwy(const char *path) {
    enum { PIXELS = FOREIGN_ROWS * FOREIGN_COLUMNS };
    double z[PIXELS], back[PIXELS], mask[PIXELS] = {0};
    for (size_t k = 0; k < PIXELS; k++) {
        z[k] = foreign_step * foreign_steps(k / FOREIGN_COLUMNS, k % FOREIGN_COLUMNS);
        back[k] = -z[k];
    }
    mask[21] = 1;
    gwy_field f = {.columns = FOREIGN_COLUMNS,
                   .rows = FOREIGN_ROWS,
                   .width = foreign_width,
                   .height = foreign_height,
                   .lateral = "m",
                   .unit = "m",
                   .z = z};
    gwy_field retrace = f, volts = f, marks = f;
    retrace.z = back;
    volts.unit = "V";
    marks.unit = "";
    marks.z = mask;
    gwy_part items = {NULL, 0}, meta = {NULL, 0};
    gwy_put_field(&items, "/0/data", &f);
    gwy_put_text(&items, "/0/data/title", "Height");
    gwy_put_field(&items, "/0/mask", &marks);
    gwy_put_text(&meta, "Scan direction", "Forward");
    gwy_put_object(&items, "/0/meta", "GwyContainer", meta);
    gwy_put_field(&items, "/1/data", &retrace);
    gwy_put_text(&items, "/1/data/title", "Height retrace");
    gwy_put_field(&items, "/2/data", &volts);
    gwy_put_text(&items, "/2/data/title", "Amplitude");
    gwy_part file = gwy_make_file(items);
    write_file(path, file.bytes, file.size);
    free(file.bytes);
}

#endif
