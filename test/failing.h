/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Programs run with an allocation that fails (test/fault/failing_memory.c), and what must hold of
 * each such run: it ends well, with the results that it always makes, or with a message and an
 * error; never by a crash of Haft's own; nothing half-written is left; and the same command, run
 * again, ends in the same results. */
#ifndef HAFT_TEST_FAILING_H
#define HAFT_TEST_FAILING_H

#include "same_bits.h"

/* Which allocations count, and which fail. */
typedef enum failing_mode {
    FAILING_OWN,  /* the n-th of Haft's own */
    FAILING_ANY,  /* the n-th of all, those of the libraries beneath it too */
    FAILING_REST, /* the n-th of all, and every one after it */
} failing_mode;

/* A command and the folder that it works on. */
typedef struct failing {
    const char *name, *program;
    const char *args[8];  /* its first run */
    const char *again[8]; /* how it goes on after a failure */
    char map[400], folder[420];
    bool timed;               /* what it prints tells how long it took */
    const char *const *files; /* what it makes, in the case folder; ends in NULL */
    case_folder before;       /* as it is before each run */
    case_folder work;         /* where it runs */
    case_folder sound;        /* as a run leaves it when nothing fails */
    char *out;                /* what that prints */
    unsigned long own, all;   /* allocations of such a run */
    failing_mode mode;
    size_t runs, refused, completed, foreign; /* how the runs went */
} failing;

/* ---- folders ---- */

static char copied_from[400], copied_to[400];

static inline int copy_entry(const char *path, const struct stat *facts, int kind,
                             struct FTW *place) {
    char to[800];
    (void)place;
    snprintf(to, sizeof to, "%s%s", copied_to, path + strlen(copied_from));
    if (kind == FTW_D) {
        return mkdir(to, 0777) == 0 || errno == EEXIST ? 0 : -1;
    }
    if (S_ISREG(facts->st_mode)) {
        size_t size = 0;
        char *data = read_whole_file(path, &size);
        write_file(to, data, size);
        free(data);
    }
    return 0;
}

static inline void copy_folder(const case_folder *from, const case_folder *to) {
    snprintf(copied_from, sizeof copied_from, "%s", from->path);
    snprintf(copied_to, sizeof copied_to, "%s", to->path);
    assert_int_equal(nftw(copied_to, remove_entry, 16, FTW_DEPTH | FTW_PHYS), 0);
    assert_int_equal(nftw(copied_from, copy_entry, 16, FTW_PHYS), 0);
}

static char half_written[800];

static inline int note_temporary(const char *path, const struct stat *facts, int kind,
                                 struct FTW *place) {
    (void)facts;
    (void)kind;
    const char *name = path + place->base;
    /* parts that are no longer wanted and could not be removed: the next run does */
    bool retired = strncmp(name, "parts.tmp.", 10) == 0;
    if (strstr(name, ".tmp") != NULL && !retired) {
        snprintf(half_written, sizeof half_written, "%s", path);
    }
    return 0;
}

/* The path of something half-written in the folder, or "". */
static inline const char *find_temporary(const case_folder *c) {
    half_written[0] = '\0';
    assert_int_equal(nftw(c->path, note_temporary, 16, FTW_PHYS), 0);
    return half_written;
}

static uint64_t tree_sum;

static inline int add_entry(const char *path, const struct stat *facts, int kind,
                            struct FTW *place) {
    char text[400];
    int n = snprintf(text, sizeof text, "%s %d %lld", path + place->base, kind,
                     kind == FTW_F ? (long long)facts->st_size : 0);
    char digest[HAFT_DIGEST_CAPACITY];
    haft_digest_memory(text, (size_t)n, digest);
    digest[16] = '\0';
    tree_sum += place->level == 0 ? 0 : strtoull(digest, NULL, 16);
    return 0;
}

/* A number that tells folders apart by the names and sizes of what is in them. */
static inline uint64_t sum_of_tree(const case_folder *c) {
    tree_sum = 0;
    assert_int_equal(nftw(c->path, add_entry, 16, FTW_PHYS), 0);
    return tree_sum;
}

static inline bool same_file(const case_folder *a, const case_folder *b, const char *name) {
    char path_a[400], path_b[400];
    size_t size_a = 0, size_b = 0;
    if (!exists(a, name) || !exists(b, name)) {
        return false;
    }
    path_in(a, name, path_a);
    path_in(b, name, path_b);
    bool results = strcmp(name, "out/results.h5") == 0;
    char *bytes_a =
        results ? reproducible_bytes(path_a, &size_a) : read_whole_file(path_a, &size_a);
    char *bytes_b =
        results ? reproducible_bytes(path_b, &size_b) : read_whole_file(path_b, &size_b);
    bool same = size_a == size_b && memcmp(bytes_a, bytes_b, size_a) == 0;
    free(bytes_a);
    free(bytes_b);
    return same;
}

/* The first of the files that is not as it should be, or NULL. */
static inline const char *first_other(const failing *f) {
    for (size_t i = 0; f->files[i] != NULL; i++) {
        if (!same_file(&f->work, &f->sound, f->files[i])) {
            return f->files[i];
        }
    }
    return NULL;
}

/* ---- runs ---- */

static inline const char *failing_log(const failing *f, char path[400]) {
    snprintf(path, 400, "%s/failing.log", f->work.top.folder);
    return path;
}

/* Runs a command with the n-th allocation failing; 0: none. What the shim told goes into *log, to
 * be freed. */
static inline ran run_failing(const failing *f, unsigned long n, char **log) {
    char path[400], number[32];
    unlink(failing_log(f, path));
    snprintf(number, sizeof number, "%lu", n);
    setenv("HAFT_FAIL_AT", number, 1);
    setenv("HAFT_FAIL_LOG", path, 1);
    setenv("LD_PRELOAD", HAFT_FAILING_MEMORY, 1);
    if (f->mode != FAILING_OWN) {
        setenv("HAFT_FAIL_ALL", "1", 1);
    }
    if (f->mode == FAILING_REST) {
        setenv("HAFT_FAIL_LASTS", "1", 1);
    }
    child c = start_program(f->program, f->args, 0);
    static const char *const names[] = {"LD_PRELOAD", "HAFT_FAIL_AT", "HAFT_FAIL_LOG",
                                        "HAFT_FAIL_ALL", "HAFT_FAIL_LASTS"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        unsetenv(names[i]);
    }
    ran r = end_program(c);
    *log = access(path, F_OK) == 0 ? read_whole_file(path, NULL) : calloc(1, 1);
    return r;
}

/* The run that nothing happens to: what it leaves and prints, and how much it allocates. */
static inline void failing_begin(failing *f) {
    char *log;
    copy_folder(&f->before, &f->work);
    ran r = run_failing(f, 0, &log);
    if (r.code != 0) {
        fail_msg("%s ended with %d\n%s", f->name, r.code, r.err);
    }
    const char *count = strstr(log, "count ");
    assert_non_null(count);
    assert_int_equal(sscanf(count, "count %lu %lu", &f->own, &f->all), 2);
    copy_folder(&f->work, &f->sound);
    f->out = r.out;
    r.out = NULL;
    free(log);
    ran_free(&r);
}

static inline void failing_end(failing *f) {
    printf("%s: %zu runs, %zu ended with a message, %zu with the whole result, %zu in a foreign "
           "library; %lu allocations of its own, %lu in all\n",
           f->name, f->runs, f->refused, f->completed, f->foreign, f->own, f->all);
    fflush(stdout);
    case_remove(&f->before);
    case_remove(&f->work);
    case_remove(&f->sound);
    free(f->out);
}

/* What is wrong with a run that failed at the n-th allocation; "" if nothing is. */
static inline void judge(failing *f, const ran *r, const char *log, char wrong[500]) {
    const char *other = NULL, *crash = strstr(log, "crash ");
    bool foreign = (crash != NULL && strstr(crash, " foreign\n") != NULL) ||
                   strstr(log, "exit foreign") != NULL;
    wrong[0] = '\0';
    f->foreign += foreign;
    if (foreign) {
        return;
    }
    if (r->code >= 1000) {
        snprintf(wrong, 500, "killed by signal %d", r->code - 1000);
    } else if (find_temporary(&f->work)[0] != '\0') {
        snprintf(wrong, 500, "leaves %.400s", half_written);
    } else if (r->code == 0 && (other = first_other(f)) != NULL) {
        snprintf(wrong, 500, "ends well, but %s is not what it should be", other);
    } else if (r->code == 0 && strstr(f->name, "run") == NULL &&
               strstr(f->name, "resume") == NULL &&
               strcmp(r->out, f->out) != 0) { /* those print how long they took */
        snprintf(wrong, 500, "ends well, but prints something else:\n%.300s", r->out);
    } else if (r->code != 0 && strncmp(r->err, "haft", 4) != 0 &&
               strstr(r->err, "\nhaft") == NULL) {
        snprintf(wrong, 500, "ends with %d without a message: \"%.300s\"", r->code, r->err);
    }
    f->refused += r->code != 0;
    f->completed += r->code == 0;
}

/* Runs the command again with all the memory there is, or goes on with what is there, and compares.
 */
static inline void go_on(failing *f, char wrong[500]) {
    ran r = run_program(f->program, f->args);
    if (r.code == 5) { /* results or parts are there already */
        ran_free(&r);
        r = run_program(f->program, f->again);
    }
    const char *other = r.code == 0 ? first_other(f) : NULL;
    if (r.code != 0) {
        snprintf(wrong, 500, "cannot be gone on with, %d: %.300s", r.code, r.err);
    } else if (other != NULL) {
        snprintf(wrong, 500, "gone on with, has another %s", other);
    }
    ran_free(&r);
}

/* Lets the n-th allocation fail; @return whether there was one. Prints what is wrong. */
static inline bool failing_try(failing *f, unsigned long n, size_t *faults) {
    char wrong[500], *log;
    copy_folder(&f->before, &f->work);
    ran r = run_failing(f, n, &log);
    bool failed = strstr(log, "failed ") != NULL;
    if (failed) {
        f->runs++;
        judge(f, &r, log, wrong);
        if (wrong[0] == '\0' && sum_of_tree(&f->work) != sum_of_tree(&f->before)) {
            go_on(f, wrong);
        }
        if (wrong[0] != '\0') {
            ++*faults;
            fprintf(stderr, "%s, allocation %lu: %s\n%s%s\n", f->name, n, wrong, r.err, log);
        }
    }
    free(log);
    ran_free(&r);
    return failed;
}

/* ---- commands ---- */

/* A gnuplot that leaves empty figures where it is asked for some: the true one takes seconds and is
 * no part of Haft. */
static inline void put_gnuplot(const char *folder) {
    static const char script[] =
        "#!/bin/sh\n"
        "draft=$(printf '%s\\n' \"$*\" | sed -n \"s/.*draft='\\([^']*\\)'.*/\\1/p\")\n"
        "for script; do :; done\n"
        "grep -o 'open_[a-z]*(\"[a-z_]*\"' \"$script\" | tr -d '(' | while IFS='_\"' read -r _ "
        "kind name; do\n"
        "    case $kind in\n"
        "    png) printf '\\211PNG\\r\\n\\032\\n\\0\\0\\0\\0IEND\\256B`\\202' ;;\n"
        "    svg) echo '<svg></svg>' ;;\n"
        "    esac >\"$draft$name.$kind\"\n"
        "done\n";
    char path[400];
    snprintf(path, sizeof path, "%s/gnuplot", folder);
    write_file(path, script, sizeof script - 1);
    assert_int_equal(chmod(path, 0755), 0);
    const char *old = getenv("PATH");
    char both[4096];
    snprintf(both, sizeof both, "%s:%s", folder, old == NULL ? "/usr/bin:/bin" : old);
    setenv("PATH", both, 1);
}

enum { FAILING_COMMANDS = 5 };
static const char *const failing_names[FAILING_COMMANDS] = {"check", "inspect", "run", "resume",
                                                            "report"};

static inline void put_map(const case_folder *c, char path[400]) {
    char text[4096];
    size_t n = 0;
    for (size_t i = 0; i < 16; i++) {
        for (size_t j = 0; j < 16; j++) {
            n += (size_t)snprintf(text + n, sizeof text - n, "%zu%c", (37 * i * i + 11 * j) % 201,
                                  j < 15 ? ' ' : '\n');
        }
    }
    write_file(path_in(c, "map.txt", path), text, n);
}

/* The small case with narrow patches and coarse curves: the same allocations in less time. */
static const edit tiny[] = {
    {"step: 0.2 nm", "step: 1 nm"}, {"width: 3 um", "width: 1 um"}, {NULL, NULL}};

/* Makes the command of that name ready, with its folders. */
static inline void failing_create(failing *f, const char *name, failing_mode mode) {
    static const char *const none[] = {NULL}, *const page[] = {"out/report.html", NULL},
                             *const figures[] = {"found/histogram.csv", "found/psd.csv", NULL},
                             *const made[] = {"out/results.h5",
                                              "out/laws.h5",
                                              "out/laws.csv",
                                              "out/summary.csv",
                                              "out/convergence.csv",
                                              "out/resolved.yaml",
                                              NULL};
    *f = (failing){.name = name, .program = HAFT, .mode = mode, .files = none};
    f->before = case_create(tiny);
    f->work = case_create(tiny);
    f->sound = case_create(tiny);
    f->args[0] = f->again[0] = name;
    f->args[1] = f->again[1] = "--quiet";
    f->args[2] = f->again[2] = "--threads=1";
    f->args[3] = f->again[3] = f->work.path;
    put_gnuplot(f->work.top.folder);
    if (strcmp(name, "run") == 0 || strcmp(name, "resume") == 0) {
        f->again[0] = "resume";
        f->files = made;
        f->timed = true;
    }
    if (strcmp(name, "resume") == 0) {
        must_run(HAFT, ARGS("run", "--quiet", "--threads=1", "--shard=1/2", f->before.path));
    } else if (strcmp(name, "report") == 0) {
        must_run(HAFT, ARGS("run", "--quiet", "--threads=1", f->before.path));
        f->files = page;
    } else if (strcmp(name, "inspect") == 0) {
        f->program = HAFT_LAWS;
        f->files = figures;
        put_map(&f->before, f->map);
        path_in(&f->work, "map.txt", f->map);
        snprintf(f->folder, sizeof f->folder, "--output=%s/found", f->work.path);
        const char *const words[] = {"inspect", "--unit=nm", "--size=1umx1um",
                                     f->folder, f->map,      NULL};
        memcpy(f->args, words, sizeof words);
        memcpy(f->again, words, sizeof words);
    }
}

#endif
