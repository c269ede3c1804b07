/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Output that both programs share: progress with the time left, errors, exit codes, case
 * folders. */
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
    size_t before; /* number done when the stage began */
    size_t tenth;  /* tenths reported so far, if not on a terminal */
} terminal;

/* Sets up output. SIGINT and SIGTERM end the program as usual until terminal_progress() is
 * called. */
void terminal_open(terminal *t, const char *program, bool quiet);

/* Makes a progress that prints through this terminal and reports a stop after SIGINT or SIGTERM.
 * From here on these signals are caught, so call this only for work that checks for a stop. */
haft_progress terminal_progress(terminal *t);

/* Prints one line, as printf does, and adds the line break. Names of files and keys in it are
 * quoted so that they are safe to show (haft_text_quote). */
void terminal_print(FILE *stream, const char *format, ...) HAFT_PRINTF(2, 3);

/* Reports what is wrong with the command line, quoted in the same way, and ends the program. */
struct argp_state;
void terminal_misuse(const struct argp_state *state, const char *format, ...) HAFT_PRINTF(2, 3);

/* Ends a progress line. */
void terminal_close_line(terminal *t);

/* Prints an error and gives the exit code for its status. */
int terminal_fail(terminal *t, haft_status status, const haft_error *error);

/* The exit code of a program that has printed all it had to: `code`, or EXIT_IO if the output could
 * not be written. */
int terminal_finish(terminal *t, int code);

/* Makes the path CASE/name, or CASE/out/name. */
haft_status case_path(char path[PATH_CAPACITY], const char *folder, const char *name,
                      haft_error *error);
haft_status case_out_path(char path[PATH_CAPACITY], const char *folder, const char *name,
                          haft_error *error);

/* Makes CASE/out (and CASE/out/name, where name is not NULL) if need be. */
haft_status make_out_folder(const char *folder, const char *name, haft_error *error);

/* Removes CASE/out if it is empty, as after a failure. */
void drop_empty_out_folder(const char *folder);

/* Reads CASE/case.yaml. */
haft_status read_case(haft_case **out, const char *folder, haft_error *error);

/* Writes CASE/out/laws.csv. */
haft_status save_laws_table(const haft_laws *laws, const char *folder, haft_error *error);

/* Reads results, which must have the case's number of realizations. */
haft_status read_results(haft_results_view **out, const haft_case *c, const char *path,
                         haft_error *error);

/* Reads results that were made from the present case, with all inputs the same. */
haft_status read_own_results(haft_results_view **out, const haft_case *c, const char *path,
                             haft_error *error);

#endif
