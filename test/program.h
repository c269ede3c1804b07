/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs the built programs on small cases in a scratch folder; every failure here ends the test. */
#ifndef HAFT_TEST_PROGRAM_H
#define HAFT_TEST_PROGRAM_H

#include "scratch.h"

#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <signal.h>
#include <stdbool.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#define HAFT HAFT_PROGRAM_DIR "/haft"
#define HAFT_LAWS HAFT_PROGRAM_DIR "/haft-laws"

/* ---- a case ---- */

typedef struct edit {
    const char *from, *to;
} edit;

/* What makes the model case small: a beam of 90 um over 30 patches that sticks at about 40 um. */
static const edit small_edits[] = {
    {"grid_step: 5 nm", "grid_step: 10 nm\n  kernel_tolerance: 1e-3"},
    {"step: 0.1 nm", "step: 0.2 nm"},
    {"length: 600 um", "length: 90 um"},
    {"width: 30 um", "width: 3 um"},
    {"thickness: 2.62 um", "thickness: 1 um"},
    {"gap: 1.9 um", "gap: 400 nm"},
    {"  mesh: active ", "  element_length: 3 um\n  mesh: uniform "},
    {"position: 60 um", "position: 12 um"},
    {"crack_length: 120 um", "crack_length: 30 um"},
    {"realizations: 20", "realizations: 2"},
};

/* The small case with further edits, the last {NULL, NULL}; to be freed with free(). */
static inline char *small_case(const edit *edits) {
    char *text = read_whole_file(HAFT_SOURCE_DIR "/cases/delrio-rh85/case.yaml", NULL);
    size_t count = sizeof small_edits / sizeof *small_edits;
    for (size_t i = 0; i < count || (edits != NULL && edits[i - count].from != NULL); i++) {
        edit e = i < count ? small_edits[i] : edits[i - count];
        char *next = replaced(text, e.from, e.to);
        free(text);
        text = next;
    }
    return text;
}

/* A case folder in a scratch folder of its own. */
typedef struct case_folder {
    scratch top;
    char path[250];
} case_folder;

static inline const char *path_in(const case_folder *c, const char *name, char path[400]) {
    snprintf(path, 400, "%s/%s", c->path, name);
    return path;
}

/* (Over)writes case.yaml. */
static inline void case_write(const case_folder *c, const edit *edits) {
    char path[400], *text = small_case(edits);
    write_file(path_in(c, "case.yaml", path), text, strlen(text));
    free(text);
}

static inline case_folder case_create(const edit *edits) {
    case_folder c = {.top = scratch_create()};
    snprintf(c.path, sizeof c.path, "%s/case", c.top.folder);
    assert_int_equal(mkdir(c.path, 0777), 0);
    case_write(&c, edits);
    return c;
}

static inline int remove_entry(const char *path, const struct stat *facts, int kind,
                               struct FTW *place) {
    (void)facts;
    (void)kind;
    (void)place;
    return remove(path);
}

static inline void case_remove(const case_folder *c) {
    assert_int_equal(nftw(c->top.folder, remove_entry, 16, FTW_DEPTH | FTW_PHYS), 0);
}

static inline bool exists(const case_folder *c, const char *name) {
    char path[400];
    return access(path_in(c, name, path), F_OK) == 0;
}

/* The names in the case folder and in its out/, sorted, a space after each; to be freed. */
static inline char *listing(const case_folder *c) {
    char *text = calloc(1, 4096);
    assert_non_null(text);
    for (int level = 0; level < 2; level++) {
        char path[400];
        struct dirent **entry = NULL;
        int n = scandir(path_in(c, level == 0 ? "." : "out", path), &entry, NULL, alphasort);
        for (int i = 0; i < n; i++) {
            if (entry[i]->d_name[0] != '.') {
                size_t used = strlen(text);
                snprintf(text + used, 4096 - used, "%s%s ", level == 0 ? "" : "out/",
                         entry[i]->d_name);
            }
            free(entry[i]);
        }
        free(entry);
    }
    return text;
}

/* ---- a program ---- */

/* Arguments after the program's name, the last NULL. */
#define ARGS(...)                                                                                  \
    (const char *const[]) {                                                                        \
        __VA_ARGS__, NULL                                                                          \
    }

typedef struct child {
    pid_t pid;
    FILE *out, *err;
} child;

typedef struct ran {
    int code; /* exit code; 1000 + the signal that killed it */
    char *out, *err;
} ran;

/* What was written so far, followed by a 0. */
static inline char *written(FILE *stream) {
    struct stat facts;
    assert_int_equal(fstat(fileno(stream), &facts), 0);
    char *text = calloc(1, (size_t)facts.st_size + 1);
    assert_non_null(text);
    assert_true(pread(fileno(stream), text, (size_t)facts.st_size, 0) >= 0);
    return text;
}

/* Starts a program; file_limit > 0 bounds the size of every file it writes. */
static inline child start_program(const char *program, const char *const *args, rlim_t file_limit) {
    const char *argv[16] = {program};
    for (int i = 0; args[i] != NULL; i++) {
        assert_true(i < 14);
        argv[i + 1] = args[i];
    }
    child c = {.out = tmpfile(), .err = tmpfile()};
    assert_true(c.out != NULL && c.err != NULL);
    c.pid = fork();
    assert_true(c.pid >= 0);
    if (c.pid == 0) {
        struct rlimit limit = {file_limit, file_limit};
        char *plain[16];
        memcpy(plain, argv, sizeof plain);
        alarm(200); /* a program that hangs fails its test */
        if (dup2(fileno(c.out), 1) < 0 || dup2(fileno(c.err), 2) < 0 ||
            (file_limit > 0 && setrlimit(RLIMIT_FSIZE, &limit) != 0)) {
            _exit(126);
        }
        execv(program, plain);
        _exit(127);
    }
    return c;
}

static inline ran end_program(child c) {
    int state = 0;
    while (waitpid(c.pid, &state, 0) < 0) {
        assert_int_equal(errno, EINTR);
    }
    ran r = {.code = WIFEXITED(state) ? WEXITSTATUS(state) : 1000 + WTERMSIG(state),
             .out = written(c.out),
             .err = written(c.err)};
    fclose(c.out);
    fclose(c.err);
    return r;
}

static inline void ran_free(ran *r) {
    free(r->out);
    free(r->err);
    *r = (ran){0};
}

static inline ran run_program(const char *program, const char *const *args) {
    return end_program(start_program(program, args, 0));
}

/* Runs a program that must end with this code; prints what it said when it does not. */
static inline ran run_expect(int code, const char *program, const char *const *args) {
    ran r = run_program(program, args);
    if (r.code != code) {
        fail_msg("%s %s ended with %d, not %d\n%s%s", program, args[0], r.code, code, r.out, r.err);
    }
    return r;
}

/* The same where what it says is of no interest. */
static inline void must_run(const char *program, const char *const *args) {
    ran r = run_expect(0, program, args);
    ran_free(&r);
}

static inline void check_says(const char *text, const char *says) {
    if (strstr(text, says) == NULL) {
        fail_msg("\"%s\" is not in:\n%s", says, text);
    }
}

static inline void check_silent_about(const char *text, const char *says) {
    if (strstr(text, says) != NULL) {
        fail_msg("\"%s\" is in:\n%s", says, text);
    }
}

/* Runs, and checks the code, the words, that only a message came, and that no file came or went. */
static inline void check_program_refuses(const case_folder *c, int code, const char *program,
                                         const char *const *args, const char *const *says) {
    char *before = listing(c);
    ran r = run_expect(code, program, args);
    for (; *says != NULL; says++) {
        check_says(r.err, *says);
    }
    check_says(r.err, strstr(program, "haft-laws") == NULL ? "haft: " : "haft-laws: ");
    assert_string_equal(r.out, "");
    ran_free(&r);
    char *after = listing(c);
    assert_string_equal(before, after);
    free(before);
    free(after);
}

#define SAYS(...)                                                                                  \
    (const char *const[]) {                                                                        \
        __VA_ARGS__, NULL                                                                          \
    }

/* The number after "key": in JSON. */
static inline double json_number(const char *json, const char *key) {
    char quoted[100];
    snprintf(quoted, sizeof quoted, "\"%s\": ", key);
    const char *at = strstr(json, quoted);
    if (at == NULL) {
        fail_msg("no %s in:\n%s", quoted, json);
    }
    return strncmp(at + strlen(quoted), "null", 4) == 0 ? (double)NAN
                                                        : strtod(at + strlen(quoted), NULL);
}

#endif
