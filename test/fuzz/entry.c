/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "entry.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <sys/stat.h>
#include <udunits2.h>
#include <unistd.h>

void fuzz_found(const char *condition, const char *format, ...) {
    va_list list;
    va_start(list, format);
    fprintf(stderr, "\nHAFT FINDING: %s does not hold: ", condition);
    vfprintf(stderr, format, list);
    fprintf(stderr, "\n");
    va_end(list);
    abort();
}

void fuzz_check_status(haft_status status, const haft_error *error) {
    if (status == HAFT_OK) {
        return;
    }
    FUZZ_DEMAND(error->message[0] != '\0', "a failure, %d, without a message", (int)status);
    FUZZ_DEMAND(memchr(error->message, '\0', sizeof error->message) != NULL, "no end");
    FUZZ_DEMAND(status == HAFT_ERROR_INPUT || status == HAFT_ERROR_IO ||
                    status == HAFT_ERROR_MEMORY,
                "status %s of an input: %s", haft_status_name(status), error->message);
}

/* ---- files ---- */

static char folder[110];

static void remove_folder(void) {
    static const char *const names[] = {"case.yaml",      "emitted.yaml", "psd.csv", "film.csv",
                                        "map.gsf",        "map",          "table",   "data.h5",
                                        "parts/part-0-0", "parts/lock"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        unlink(fuzz_path(names[i]));
    }
    rmdir(fuzz_path("parts"));
    rmdir(folder);
}

const char *fuzz_path(const char *name) {
    static char path[4][200];
    static int turn;
    if (folder[0] == '\0') {
        const char *base = getenv("TMPDIR");
        base = base != NULL ? base : access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp";
        snprintf(folder, sizeof folder, "%.80s/haft-fuzz-XXXXXX", base);
        if (mkdtemp(folder) == NULL) {
            perror(folder);
            exit(2);
        }
        atexit(remove_folder);
    }
    turn = (turn + 1) % 4;
    snprintf(path[turn], sizeof path[turn], "%s/%s", folder, name);
    return path[turn];
}

const char *fuzz_put(const char *name, const void *data, size_t size) {
    const char *path = fuzz_path(name);
    FILE *stream = fopen(path, "wb");
    if (stream == NULL || fwrite(data, 1, size, stream) != size || fclose(stream) != 0) {
        perror(path);
        exit(2);
    }
    return path;
}

uint8_t *fuzz_get(const char *path, size_t *size) {
    struct stat facts;
    FILE *stream = fopen(path, "rb");
    if (stream == NULL || fstat(fileno(stream), &facts) != 0) {
        perror(path);
        exit(2);
    }
    uint8_t *bytes = malloc((size_t)facts.st_size + 1);
    *size = bytes == NULL ? 0 : fread(bytes, 1, (size_t)facts.st_size, stream);
    fclose(stream);
    return bytes;
}

haft_case *fuzz_case(size_t realizations) {
    static haft_case *c;
    haft_error error = {0};
    if (c == NULL &&
        haft_case_read(&c, HAFT_SOURCE_DIR "/cases/delrio-rh85/case.yaml", &error) != HAFT_OK) {
        fprintf(stderr, "%s\n", error.message);
        exit(2);
    }
    c->realizations = realizations;
    return c;
}

/* ---- the units database, once ---- */

ut_system *__real_ut_read_xml(const char *path);
ut_system *__wrap_ut_read_xml(const char *path);
void __wrap_ut_free_system(ut_system *system);

ut_system *__wrap_ut_read_xml(const char *path) {
    static ut_system *system;
    if (system == NULL) {
        system = __real_ut_read_xml(path);
    }
    return system;
}

void __wrap_ut_free_system(ut_system *system) {
    (void)system;
}

/* ---- numbers ---- */

uint8_t fuzz_byte(fuzz_bytes *bytes) {
    if (bytes->left == 0) {
        return 0;
    }
    bytes->left--;
    return *bytes->at++;
}

uint64_t fuzz_word(fuzz_bytes *bytes) {
    uint64_t word = 0;
    for (int i = 0; i < 8; i++) {
        word |= (uint64_t)fuzz_byte(bytes) << (8 * i);
    }
    return word;
}

size_t fuzz_choice(fuzz_bytes *bytes, size_t n) {
    size_t number = fuzz_byte(bytes);
    number |= n > 256 ? (size_t)fuzz_byte(bytes) << 8 : 0;
    return number % n;
}

double fuzz_real(fuzz_bytes *bytes) {
    static const double bad[] = {0,     -0.0,   1,      -1,  NAN,        INFINITY,      -INFINITY,
                                 1e308, -1e308, 1e-320, 1e9, 2147483648, -2147483649.0, 0.5,
                                 1e-9,  1e-300};
    size_t which = fuzz_choice(bytes, 32);
    double number = 0;
    if (which < sizeof bad / sizeof *bad) {
        return bad[which];
    }
    uint64_t word = fuzz_word(bytes);
    memcpy(&number, &word, sizeof number);
    return number;
}
