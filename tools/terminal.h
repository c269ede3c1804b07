/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What both programs say and how: progress with the time left, errors, exit codes, case folders. */
#ifndef HAFT_TOOLS_TERMINAL_H
#define HAFT_TOOLS_TERMINAL_H

#include "haft/study.h"

#include <stdio.h>

/* Exit codes, as `--help` lists them. */
enum {
    EXIT_OK = 0,
    EXIT_NUMERIC = 1,
    EXIT_USAGE = 2,
    EXIT_INPUT = 3,
    EXIT_IO = 4,
    EXIT_EXISTS = 5,
    EXIT_INTERNAL = 6,
    EXIT_INTERRUPTED = 130,
};

#define EXIT_CODES                                                                                 \
    "Exit codes: 0 done; 1 a computation failed; 2 wrong usage; 3 input that cannot be used; "     \
    "4 a file cannot be read or written; 5 results are there already; 6 internal failure; "        \
    "130 interrupted, with what was done saved."

enum { PATH_CAPACITY = 4096 };

typedef struct terminal {
    const char *program;
    bool quiet;
    bool live; /* standard error is a terminal */
    const char *stage;
    double started, shown;
    size_t before; /* done when the stage began */
    size_t tenth;  /* tenths told so far, where lines are all there is */
} terminal;

/* Sets up output. SIGINT and SIGTERM end the program, as ever, until there is a progress. */
void terminal_open(terminal *t, const char *program, bool quiet);

/* A progress that speaks through this terminal and stops on SIGINT and SIGTERM, which are caught
 * from here on: only for who asks it whether to stop. */
haft_progress terminal_progress(terminal *t);

/* Prints one line, as printf does, made safe to show whatever names of files and keys are in it
 * (haft_text_quote); the line break is added. */
void terminal_print(FILE *stream, const char *format, ...) HAFT_PRINTF(2, 3);

/* Says so what is wrong with the command line, and ends the program. */
struct argp_state;
void terminal_misuse(const struct argp_state *state, const char *format, ...) HAFT_PRINTF(2, 3);

/* Ends a progress line. */
void terminal_close_line(terminal *t);

/* Prints an error and gives the exit code for its status. */
int terminal_fail(terminal *t, haft_status status, const haft_error *error);

/* The exit code of a program that has nothing more to say: `code`, or EXIT_IO if what was printed
 * did not arrive. */
int terminal_finish(terminal *t, int code);

/* CASE/name, or CASE/out/name. */
haft_status case_path(char path[PATH_CAPACITY], const char *folder, const char *name,
                      haft_error *error);
haft_status case_out_path(char path[PATH_CAPACITY], const char *folder, const char *name,
                          haft_error *error);

/* Makes CASE/out (and CASE/out/name, where name is not NULL) if need be. */
haft_status make_out_folder(const char *folder, const char *name, haft_error *error);

/* Takes CASE/out away again if nothing is in it, as after a failure. */
void drop_empty_out_folder(const char *folder);

/* Reads CASE/case.yaml. */
haft_status read_case(haft_case **out, const char *folder, haft_error *error);

/* Writes CASE/out/laws.csv. */
haft_status save_laws_table(const haft_laws *laws, const char *folder, haft_error *error);

/* Reads results that hold the case's number of realizations. */
haft_status read_results(haft_results_view **out, const haft_case *c, const char *path,
                         haft_error *error);

/* The same where they must be of the case as it stands, to its last input. */
haft_status read_own_results(haft_results_view **out, const haft_case *c, const char *path,
                             haft_error *error);

#endif
