/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Output of the programs. */
#include "terminal.h"

#include <argp.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static volatile sig_atomic_t caught;

static void catch_signal(int number) {
    caught = number;
}

/* Opens closed standard streams. Otherwise the next file opened would get the number of a closed
 * stream, and progress would be written into the results. Each is opened for the wrong direction,
 * so that using it fails. */
static void occupy_standard_streams(void) {
    for (int number = 0; number <= STDERR_FILENO; number++) {
        if (fcntl(number, F_GETFD) == -1) {
            (void)!open("/dev/null", number == STDIN_FILENO ? O_WRONLY : O_RDONLY);
        }
    }
}

void terminal_open(terminal *t, const char *program, bool quiet) {
    *t = (terminal){.program = program, .quiet = quiet, .live = isatty(STDERR_FILENO) == 1};
    occupy_standard_streams();
    struct sigaction action = {.sa_handler = SIG_IGN}; /* so that a full file or a closed pipe */
    sigemptyset(&action.sa_mask);                      /* is reported as an error */
    sigaction(SIGXFSZ, &action, NULL);
    sigaction(SIGPIPE, &action, NULL);
}

/* Size of a line before it is quoted. The longest lines contain a few paths. The buffer is not
 * allocated, since a line must be printed even without memory. */
enum { LINE_CAPACITY = 1 << 15 };

void terminal_print(FILE *stream, const char *format, ...) {
    char text[LINE_CAPACITY], safe[HAFT_SPELLED_CAPACITY];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    for (size_t i = 0, size = strlen(text); i < size;) {
        i += haft_text_spell(safe, text + i, size - i);
        fputs(safe, stream);
    }
    fputc('\n', stream);
}

void terminal_misuse(const struct argp_state *state, const char *format, ...) {
    char text[LINE_CAPACITY], safe[LINE_CAPACITY];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    (void)haft_text_quote(safe, sizeof safe, text, strlen(text));
    argp_error(state, "%s", safe);
}

static void format_time(char text[32], double seconds) {
    long s = (long)(seconds + 0.5);
    if (s >= 3600) {
        snprintf(text, 32, "%ld:%02ld:%02ld h", s / 3600, s / 60 % 60, s % 60);
    } else {
        snprintf(text, 32, "%ld:%02ld min", s / 60, s % 60);
    }
}

static void advance(void *user, const char *stage, size_t done, size_t total) {
    terminal *t = user;
    if (t->quiet) {
        return;
    }
    double time = haft_clock_seconds();
    if (t->stage == NULL || strcmp(t->stage, stage) != 0) {
        t->stage = stage;
        t->started = time;
        t->before = done; /* done by an earlier run, if any */
        t->shown = 0;
        t->tenth = 0;
    }
    char left[32], say[40] = ""; /* the time left is unknown until one more is done */
    double spent = fmax(0, time - t->started);
    size_t own = done > t->before ? done - t->before : 0;
    if (own > 0) {
        format_time(left, spent / (double)own * (double)(total - done));
        snprintf(say, sizeof say, ", %s left", left);
    }
    if (t->live && (time - t->shown > 0.1 || done == total)) {
        t->shown = time;
        fprintf(stderr, "\r%-6s %6zu of %zu, %3zu %%%s   ", stage, done, total, done * 100 / total,
                say);
        if (done == total) {
            format_time(left, spent);
            fprintf(stderr, "\r%-6s %6zu of %zu in %s                \n", stage, done, total, left);
        }
    } else if (!t->live && done * 10 / total > t->tenth) {
        t->tenth = done * 10 / total;
        fprintf(stderr, "%-6s %6zu of %zu, %3zu %%%s\n", stage, done, total, done * 100 / total,
                say);
    }
}

static void note(void *user, const char *text) {
    const terminal *t = user;
    if (!t->quiet) {
        terminal_print(stderr, "%s", text);
    }
}

static bool stop(void *user) {
    (void)user;
    return caught != 0;
}

haft_progress terminal_progress(terminal *t) {
    struct sigaction action = {.sa_handler = catch_signal};
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    return (haft_progress){.advance = advance, .note = note, .stop = stop, .user = t};
}

void terminal_close_line(terminal *t) {
    if (t->live && t->stage != NULL && !t->quiet) {
        fputc('\n', stderr);
    }
    t->stage = NULL;
}

int terminal_fail(terminal *t, haft_status status, const haft_error *error) {
    terminal_close_line(t);
    fprintf(stderr, "%s: %s\n", t->program, error->message);
    switch (status) {
    case HAFT_OK:
        return EXIT_OK;
    case HAFT_ERROR_NUMERIC:
        return EXIT_NUMERIC;
    case HAFT_ERROR_INPUT:
        return EXIT_INPUT;
    case HAFT_ERROR_IO:
        return EXIT_IO;
    case HAFT_ERROR_EXISTS:
        return EXIT_EXISTS;
    case HAFT_ERROR_INTERRUPTED:
        return EXIT_INTERRUPTED;
    case HAFT_ERROR_MEMORY:
    case HAFT_ERROR_ARGUMENT:
    case HAFT_ERROR_LIBRARY:
        return EXIT_INTERNAL;
    }
    return EXIT_INTERNAL;
}

int terminal_finish(terminal *t, int code) {
    errno = 0;
    bool arrived = fflush(stdout) == 0 && ferror(stdout) == 0;
    if (!arrived && code == EXIT_OK) {
        fprintf(stderr, "%s: standard output cannot be written: %s\n", t->program,
                errno != 0 ? strerror(errno) : "an earlier write failed");
        return EXIT_IO;
    }
    return code;
}

haft_status case_path(char path[PATH_CAPACITY], const char *folder, const char *name,
                      haft_error *error) {
    return haft_path_join(path, PATH_CAPACITY, folder, name, error);
}

haft_status case_out_path(char path[PATH_CAPACITY], const char *folder, const char *name,
                          haft_error *error) {
    char out[PATH_CAPACITY];
    HAFT_TRY(haft_path_join(out, sizeof out, folder, "out", error));
    return haft_path_join(path, PATH_CAPACITY, out, name, error);
}

static haft_status make_folder(const char *path, haft_error *error) {
    struct stat found;
    if (mkdir(path, 0777) != 0 &&
        !(errno == EEXIST && stat(path, &found) == 0 && S_ISDIR(found.st_mode))) {
        return haft_error_set(error, HAFT_ERROR_IO, "%s: cannot make this folder: %s", path,
                              strerror(errno));
    }
    if (access(path, W_OK | X_OK) != 0) { /* report it before the work, not after */
        return haft_error_set(error, HAFT_ERROR_IO, "%s: cannot write into this folder: %s", path,
                              strerror(errno));
    }
    return HAFT_OK;
}

haft_status make_out_folder(const char *folder, const char *name, haft_error *error) {
    char path[PATH_CAPACITY];
    haft_status status = case_path(path, folder, "out", error);
    HAFT_THEN(status, make_folder(path, error));
    if (status == HAFT_OK && name != NULL) {
        status = case_out_path(path, folder, name, error);
        HAFT_THEN(status, make_folder(path, error));
    }
    return status;
}

void drop_empty_out_folder(const char *folder) {
    char path[PATH_CAPACITY];
    if (case_path(path, folder, "out", NULL) == HAFT_OK) {
        rmdir(path); /* fails if the folder is not empty, as intended */
    }
}

haft_status read_case(haft_case **out, const char *folder, haft_error *error) {
    char path[PATH_CAPACITY];
    struct stat found;
    HAFT_TRY(case_path(path, folder, "case.yaml", error));
    if (stat(folder, &found) != 0) {
        return haft_error_set(error, HAFT_ERROR_IO, "%s: %s; give the folder of a case", folder,
                              strerror(errno));
    }
    if (!S_ISDIR(found.st_mode)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s is no folder; give the folder that holds case.yaml", folder);
    }
    return haft_case_read(out, path, error);
}

haft_status save_laws_table(const haft_laws *laws, const char *folder, haft_error *error) {
    char path[PATH_CAPACITY];
    haft_status status = case_out_path(path, folder, "laws.csv", error);
    return status == HAFT_OK ? haft_study_write_laws(laws, path, error) : status;
}

haft_status read_results(haft_results_view **out, const haft_case *c, const char *path,
                         haft_error *error) {
    haft_status status = haft_results_read(out, path, error);
    if (status == HAFT_OK && (*out)->realizations != c->realizations) {
        status = haft_error_set(error, HAFT_ERROR_INPUT,
                                "%s holds %zu realizations, the case asks for %zu; run it again "
                                "with --force",
                                path, (*out)->realizations, c->realizations);
        haft_results_view_destroy(out);
    }
    return status;
}

haft_status read_own_results(haft_results_view **out, const haft_case *c, const char *path,
                             haft_error *error) {
    char *text = NULL;
    haft_status status = read_results(out, c, path, error);
    HAFT_THEN(status, haft_case_emit(&text, c, error));
    if (status == HAFT_OK && strcmp(text, (*out)->resolved_case) != 0) {
        status = haft_error_set(error, HAFT_ERROR_INPUT,
                                "%s is of another case than there is now; run it again with "
                                "--force",
                                path);
    }
    haft_memory_free(text);
    if (status != HAFT_OK) {
        haft_results_view_destroy(out);
    }
    return status;
}
