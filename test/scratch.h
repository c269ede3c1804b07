/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scratch folder of a test program and whole files in it; every failure here ends the test. */
#ifndef HAFT_TEST_SCRATCH_H
#define HAFT_TEST_SCRATCH_H

#include "check.h"

#include <dirent.h>
#include <unistd.h>

typedef struct scratch {
    char folder[200];
} scratch;

/* Makes an empty folder. */
static inline scratch scratch_create(void) {
    scratch s;
    const char *base = getenv("TMPDIR");
    snprintf(s.folder, sizeof s.folder, "%.150s/haft-test-XXXXXX", base != NULL ? base : "/tmp");
    assert_non_null(mkdtemp(s.folder));
    return s;
}

/* How many files are in it. */
static inline int scratch_count(const scratch *s) {
    int n = 0;
    DIR *folder = opendir(s->folder);
    assert_non_null(folder);
    for (struct dirent *entry = readdir(folder); entry != NULL; entry = readdir(folder)) {
        n += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
    }
    closedir(folder);
    return n;
}

/* Removes the folder and the plain files in it. */
static inline void scratch_remove(const scratch *s) {
    char path[600];
    DIR *folder = opendir(s->folder);
    assert_non_null(folder);
    for (struct dirent *entry = readdir(folder); entry != NULL; entry = readdir(folder)) {
        snprintf(path, sizeof path, "%s/%s", s->folder, entry->d_name);
        unlink(path);
    }
    closedir(folder);
    assert_int_equal(rmdir(s->folder), 0);
}

/* The path of a file in the folder. */
static inline const char *scratch_path(const scratch *s, const char *name, char path[400]) {
    snprintf(path, 400, "%s/%s", s->folder, name);
    return path;
}

static inline void write_file(const char *path, const void *data, size_t size) {
    FILE *stream = fopen(path, "wb");
    assert_non_null(stream);
    assert_int_equal(fwrite(data, 1, size, stream), size);
    assert_int_equal(fclose(stream), 0);
}

/* All of a file, followed by a 0; to be freed with free(). */
static inline char *read_whole_file(const char *path, size_t *size) {
    FILE *stream = fopen(path, "rb");
    if (stream == NULL) {
        fail_msg("%s cannot be opened", path);
    }
    assert_int_equal(fseek(stream, 0, SEEK_END), 0);
    long end = ftell(stream);
    assert_true(end >= 0);
    rewind(stream);
    char *data = malloc((size_t)end + 1);
    assert_non_null(data);
    assert_int_equal(fread(data, 1, (size_t)end, stream), end);
    data[end] = '\0';
    fclose(stream);
    if (size != NULL) {
        *size = (size_t)end;
    }
    return data;
}

/* `text` with the first `from`, which must be there, replaced; to be freed with free(). */
static inline char *replaced(const char *text, const char *from, const char *to) {
    const char *at = strstr(text, from);
    if (at == NULL) {
        fail_msg("\"%s\" is not in the text", from);
    }
    size_t size = strlen(text) - strlen(from) + strlen(to) + 1;
    char *result = malloc(size);
    assert_non_null(result);
    snprintf(result, size, "%.*s%s%s", (int)(at - text), text, to, at + strlen(from));
    return result;
}

#endif
