/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Height-map files written by the tests themselves, independently of the readers: Nanoscope of
 * three ages, matrices, points. The heights are a known function of the pixel. */
#ifndef HAFT_TEST_MAP_FILES_H
#define HAFT_TEST_MAP_FILES_H

#include "scratch.h"

#include "haft/io.h"

/* Height of pixel (i from the top, j from the left) as an integer of the instrument. */
static inline long map_raw(size_t i, size_t j) {
    return (long)(37 * i * i + 11 * j + 5 * i * j) % 2001 - 1000;
}

typedef struct nanoscope_file {
    const char *version;   /* NULL: a header without one */
    const char *scan_size; /* "2000 1000 nm" */
    const char *aspect;
    size_t rows, columns;
    int stored, said;     /* bytes a pixel in the file, and in its header */
    long factor;          /* of the raw heights, so that 32 bits are used */
    const char *extra[2]; /* lines of the two channels */
    const char *names[2]; /* the lines that name them */
} nanoscope_file;

/* Bytes of the file; the second channel has the heights negated. To be freed with free(). */
static inline char *write_nanoscope(const nanoscope_file *f, size_t *size) {
    enum { HEADER = 4096 };
    size_t length = f->rows * f->columns * (size_t)f->stored;
    char *bytes = calloc(HEADER + 2 * length, 1);
    assert_non_null(bytes);
    char *at = bytes;
    at += sprintf(at, "\\*File list\r\n");
    if (f->version != NULL) {
        at += sprintf(at, "\\Version: %s\r\n", f->version);
    }
    at += sprintf(at,
                  "\\Data length: %d\r\n\\*Scanner list\r\n\\@Sens. Zsens: V 20.00000 nm/V\r\n"
                  "\\*Ciao scan list\r\n\\Scan Size: 9999 nm\r\n",
                  HEADER);
    for (int k = 0; k < 2; k++) {
        at += sprintf(at,
                      "\\*Ciao image list\r\n\\Data offset: %zu\r\n\\Data length: %zu\r\n"
                      "\\Bytes/pixel: %d\r\n\\Samps/line: %zu\r\n\\Number of lines: %zu\r\n"
                      "\\Aspect Ratio: %s\r\n\\Scan Size: %s\r\n%s\r\n%s\r\n",
                      HEADER + (size_t)k * length, length, f->said, f->columns, f->rows, f->aspect,
                      f->scan_size, f->names[k], f->extra[k]);
    }
    at += sprintf(at, "\\*File list end\r\n\x1a");
    assert_true(at < bytes + HEADER);
    for (size_t k = 0; k < 2; k++) {
        for (size_t i = 0; i < f->rows; i++) {
            for (size_t j = 0; j < f->columns; j++) {
                long value = map_raw(i, j) * f->factor * (k == 0 ? 1 : -1);
                size_t place = (f->rows - 1 - i) * f->columns + j; /* from the bottom */
                char *out = bytes + HEADER + k * length + place * (size_t)f->stored;
                for (int b = 0; b < f->stored; b++) {
                    out[b] = (char)((unsigned long)value >> (8 * b));
                }
            }
        }
    }
    *size = HEADER + 2 * length;
    return bytes;
}

static inline nanoscope_file new_nanoscope(void) {
    return (nanoscope_file){
        .version = "0x07200000",
        .scan_size = "2 1 ~m",
        .aspect = "1:1",
        .rows = 12,
        .columns = 16,
        .stored = 2,
        .said = 2,
        .factor = 1,
        .names = {"\\@2:Image Data: S [Height] \"Height\"",
                  "\\@2:Image Data: S [ZSensor] \"Height Sensor\""},
        /* stored with a range of its own: not the instrument's V/LSB */
        .extra = {"\\@2:Z scale: V [Sens. Zsens] (0.005 V/LSB) 6.5536 V",
                  "\\@2:Z scale: V [Sens. Zsens] (0.0003 V/LSB) 13.1072 V"},
    };
}

#endif
