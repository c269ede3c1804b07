/* SPDX-License-Identifier: GPL-3.0-or-later */
/* haft-laws: builds the force laws of a case, or fits its stochastic model to law vectors measured
 * elsewhere; prints their statistics, and draws law vectors from the model. */
#include "inspect.h"
#include "laws_report.h"
#include "terminal.h"

#include <argp.h>
#include <errno.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    KEY_FORCE = 'f',
    KEY_QUIET = 'q',
    KEY_THREADS = 't',
    KEY_COUNT = 'n',
    KEY_OUTPUT = 'o',
    KEY_CHANNEL = 256,
    KEY_LEVEL,
    KEY_WINDOW,
    KEY_MISSING,
    KEY_OUTLIERS,
    KEY_SIZE,
    KEY_UNIT,
    KEY_LATERAL_UNIT,
    KEY_TIP_RADIUS,
    KEY_END
};

enum { SAMPLE_LIMIT = 100000000 };

typedef struct arguments {
    const char *command, *folder, *table, *output;
    bool force, quiet;
    int threads;
    size_t count;
    inspect_words map;
} arguments;

static const char DOC[] =
    "Builds the force laws that a case's beams are solved with, from its rough surfaces. CASE is a "
    "folder that holds case.yaml; the laws go into CASE/out/laws.h5.\v"
    "Commands:\n"
    "  build      build CASE/out/laws.h5\n"
    "  info       say what it holds\n"
    "  study      say how its model settles with order and number of vectors\n"
    "  sample     draw law vectors from its model, by the case's sampler\n"
    "  fit TABLE  build it from the law vectors in a CSV file, not from surfaces;\n"
    "             its first line names the columns: e [mJ/m2],f_max [MPa],\n"
    "             d_max [nm],d_limit [nm]\n"
    "  inspect MAP  say what a height map (a file, not a case) holds, and draw it\n\n" EXIT_CODES;

static const struct argp_option OPTIONS[] = {
    {"force", KEY_FORCE, 0, 0, "build, fit: replace laws that are there already", 0},
    {"count", KEY_COUNT, "N", 0, "sample: draw N vectors (default 1000)", 0},
    {"output", KEY_OUTPUT, "FILE", 0,
     "sample: write them here (default CASE/out/sample.csv); inspect: the folder of the figure "
     "(default MAP.inspect)",
     0},
    {"channel", KEY_CHANNEL, "NAME", 0, "inspect: this channel (default: the first of heights)", 0},
    {"level", KEY_LEVEL, "HOW", 0, "inspect: mean, plane (default), quadratic or lines", 0},
    {"window", KEY_WINDOW, "WHICH", 0, "inspect: none, hann (default), welch, blackman, tukey", 0},
    {"missing", KEY_MISSING, "HOW", 0, "inspect: exclude (default) or fill missing pixels", 0},
    {"outliers", KEY_OUTLIERS, "N", 0, "inspect: mask what is N deviations off the median", 0},
    {"size", KEY_SIZE, "WxH", 0, "inspect: a bare matrix's sides, as \"10 um x 10 um\"", 0},
    {"unit", KEY_UNIT, "UNIT", 0, "inspect: of heights, where the file says none", 0},
    {"lateral-unit", KEY_LATERAL_UNIT, "UNIT", 0, "inspect: of columns x and y", 0},
    {"tip-radius", KEY_TIP_RADIUS, "LENGTH", 0, "inspect: cut where such a tip cannot be trusted",
     0},
    {"quiet", KEY_QUIET, 0, 0, "no progress, only results and errors", 0},
    {"threads", KEY_THREADS, "N", 0, "build: use N threads (default: all cores)", 0},
    {0}};

/* Where inspect's options put their words, in the order of their keys. */
static const char **map_word(inspect_words *map, int key) {
    const char **const words[] = {&map->channel, &map->level,        &map->window,
                                  &map->missing, &map->outliers,     &map->size,
                                  &map->unit,    &map->lateral_unit, &map->tip_radius};
    return words[key - KEY_CHANNEL];
}

static error_t parse(int key, char *value, struct argp_state *state) {
    arguments *a = state->input;
    if (key >= KEY_CHANNEL && key < KEY_END) {
        *map_word(&a->map, key) = value;
        return 0;
    }
    char *end = NULL;
    long count;
    switch (key) {
    case KEY_FORCE:
        a->force = true;
        return 0;
    case KEY_QUIET:
        a->quiet = true;
        return 0;
    case KEY_THREADS:
        count = strtol(value, &end, 10);
        if (end == value || *end != '\0' || count < 1 || count > 4096) {
            terminal_misuse(state, "--threads must be a whole number from 1 to 4096, not \"%s\"",
                            value);
        }
        a->threads = (int)count;
        return 0;
    case KEY_COUNT:
        count = strtol(value, &end, 10);
        if (end == value || *end != '\0' || count < 1 || count > SAMPLE_LIMIT) {
            terminal_misuse(state, "--count must be a whole number from 1 to %d, not \"%s\"",
                            SAMPLE_LIMIT, value);
        }
        a->count = (size_t)count;
        return 0;
    case KEY_OUTPUT:
        a->output = value;
        return 0;
    case ARGP_KEY_ARG:
        if (state->arg_num > 2) {
            terminal_misuse(state, "one command and one case, please; \"%s\" is too much", value);
        }
        *(state->arg_num == 0 ? &a->command : state->arg_num == 1 ? &a->folder : &a->table) = value;
        return 0;
    case ARGP_KEY_END:
        if (state->arg_num < 2) {
            terminal_misuse(
                state, "a command and a case are needed, as in: haft-laws build cases/delrio-rh85");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* Refuses to replace existing laws, and makes the folder for new ones. */
static haft_status prepare(const arguments *a, const char *path, haft_error *error) {
    if (!a->force && access(path, F_OK) == 0) {
        return haft_error_set(error, HAFT_ERROR_EXISTS,
                              "%s is there already; add --force to replace it", path);
    }
    return make_out_folder(a->folder, NULL, error);
}

static haft_status save(const haft_laws *laws, const haft_case *c, const arguments *a,
                        const char *path, haft_error *error) {
    haft_status status = haft_laws_write(laws, c, path, error);
    return status == HAFT_OK ? save_laws_table(laws, a->folder, error) : status;
}

static haft_status build(haft_laws **laws, const haft_case *c, const arguments *a, terminal *t,
                         const char *path, haft_error *error) {
    haft_progress progress = terminal_progress(t);
    haft_status status = prepare(a, path, error);
    HAFT_THEN(status, haft_study_build_laws(laws, c, &progress, error));
    return status == HAFT_OK ? save(*laws, c, a, path, error) : status;
}

static haft_status fit(haft_laws **laws, const haft_case *c, const arguments *a, const char *path,
                       haft_error *error) {
    if (!haft_sampler_is_stochastic(c->law.sampler)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "a model is fitted for a case that draws from one; set law.sampler: "
                              "gpce, exact, kernel, bootstrap or mean");
    }
    size_t m = 0;
    haft_law_vector *vector = NULL;
    haft_status status = haft_vectors_read(&vector, &m, a->table, error);
    HAFT_THEN(status, prepare(a, path, error));
    HAFT_THEN(status, haft_study_fit_laws(laws, c, m, vector, error));
    haft_memory_free(vector);
    return status == HAFT_OK ? save(*laws, c, a, path, error) : status;
}

/* Reads the laws, if they are those of the present case. */
static haft_status read_own(haft_laws **laws, const haft_case *c, const char *path,
                            haft_error *error) {
    char found[HAFT_DIGEST_CAPACITY], wanted[HAFT_DIGEST_CAPACITY];
    haft_status status = haft_laws_read(laws, found, path, error);
    HAFT_THEN(status, haft_laws_identify(wanted, c, (*laws)->origin, error));
    if (status == HAFT_OK && strcmp(found, wanted) != 0) {
        status = haft_error_set(error, HAFT_ERROR_INPUT,
                                "%s was built from other inputs than the case has now; give "
                                "haft-laws build --force first",
                                path);
    }
    return status;
}

static haft_status study(haft_laws **laws, const haft_case *c, const char *path,
                         haft_error *error) {
    haft_status status = read_own(laws, c, path, error);
    return status == HAFT_OK ? print_study(*laws, c, error) : status;
}

static haft_status sample(haft_laws **laws, const haft_case *c, const arguments *a,
                          const char *path, haft_error *error) {
    char standard[PATH_CAPACITY];
    haft_status status = read_own(laws, c, path, error);
    HAFT_THEN(status, case_out_path(standard, a->folder, "sample.csv", error));
    const char *output = a->output != NULL ? a->output : standard;
    size_t count = a->count > 0 ? a->count : 1000;
    HAFT_THEN(status, haft_study_write_sample(*laws, c, count, output, error));
    if (status == HAFT_OK && !a->quiet) {
        terminal_print(stdout, "%zu vectors in %s", count, output);
    }
    return status;
}

typedef enum command { BUILD, INFO, STUDY, SAMPLE, FIT, INSPECT, COMMANDS } command;

static command find_command(const arguments *a) {
    static const char *const name[COMMANDS] = {"build",  "info", "study",
                                               "sample", "fit",  "inspect"};
    for (int i = 0; i < COMMANDS; i++) {
        if (strcmp(a->command, name[i]) == 0) {
            return (command)i;
        }
    }
    return COMMANDS;
}

/* @return false, after a message, if the options do not fit the command */
static bool can_be_meant(const arguments *a, command what) {
    if (what == COMMANDS) {
        terminal_print(stderr,
                       "haft-laws: there is no command \"%s\"; try build, info, study, sample, fit "
                       "or inspect",
                       a->command);
    } else if ((what == FIT) != (a->table != NULL)) {
        terminal_print(stderr,
                       what == FIT
                           ? "haft-laws: fit needs a table, as in: haft-laws fit CASE TABLE.csv"
                           : "haft-laws: one command and one case, please; \"%s\" is too much",
                       a->table);
    } else {
        return true;
    }
    return false;
}

static haft_status carry_out(command what, haft_laws **laws, const haft_case *c, const arguments *a,
                             terminal *t, haft_error *error) {
    char path[PATH_CAPACITY];
    HAFT_TRY(case_out_path(path, a->folder, "laws.h5", error));
    switch (what) {
    case BUILD:
        return build(laws, c, a, t, path, error);
    case FIT:
        return fit(laws, c, a, path, error);
    case STUDY:
        return study(laws, c, path, error);
    case SAMPLE:
        return sample(laws, c, a, path, error);
    default:
        return haft_laws_read(laws, NULL, path, error);
    }
}

int main(int argc, char **argv) {
    argp_err_exit_status = EXIT_USAGE;
    argp_program_version = haft_version();
    static const struct argp program = {OPTIONS, parse, "COMMAND CASE [TABLE]", DOC, NULL,
                                        NULL,    NULL};
    arguments a = {0};
    if (argp_parse(&program, argc, argv, 0, NULL, &a) !=
        0) { /* argp_parse() exits on wrong usage */
        fputs("haft-laws: out of memory\n", stderr);
        return EXIT_INTERNAL;
    }
    terminal t;
    terminal_open(&t, "haft-laws", a.quiet);
    command what = find_command(&a);
    if (!can_be_meant(&a, what)) {
        return EXIT_USAGE;
    }
    if (a.threads > 0) {
        omp_set_num_threads(a.threads);
    }
    haft_error error = {0};
    if (what == INSPECT) {
        haft_status seen = inspect_map(a.folder, &a.map, a.output, a.quiet, &error);
        return seen == HAFT_OK ? terminal_finish(&t, EXIT_OK) : terminal_fail(&t, seen, &error);
    }
    haft_case *c = NULL;
    haft_laws *laws = NULL;
    haft_status status = read_case(&c, a.folder, &error);
    if (status == HAFT_OK && c->sweep.keys > 0) {
        status = haft_error_set(&error, HAFT_ERROR_INPUT,
                                "%s holds a sweep, whose variants have laws of their own; give the "
                                "folder of one, as %s/out/%s (`haft run` makes them)",
                                a.folder, a.folder, c->sweep.label);
    }
    HAFT_THEN(status, carry_out(what, &laws, c, &a, &t, &error));
    bool makes = what == BUILD || what == FIT;
    if (status == HAFT_OK && (what == INFO || (makes && !a.quiet))) {
        print_laws(laws, c);
    }
    haft_laws_destroy(&laws);
    haft_case_destroy(&c);
    if (status != HAFT_OK && makes) {
        drop_empty_out_folder(a.folder);
    }
    return status == HAFT_OK ? terminal_finish(&t, EXIT_OK) : terminal_fail(&t, status, &error);
}
