/* SPDX-License-Identifier: GPL-3.0-or-later */
/* haft-laws: builds the force laws of a case and says what they are like. */
#include "terminal.h"

#include <argp.h>
#include <errno.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { KEY_FORCE = 'f', KEY_QUIET = 'q', KEY_THREADS = 't' };

typedef struct arguments {
    const char *command, *folder;
    bool force, quiet;
    int threads;
} arguments;

static const char DOC[] =
    "Builds the force laws that a case's beams are solved with, from its rough surfaces. CASE is a "
    "folder that holds case.yaml; the laws go into CASE/out/laws.h5.\v"
    "Commands:\n"
    "  build    build CASE/out/laws.h5\n"
    "  info     say what CASE/out/laws.h5 holds\n\n" EXIT_CODES;

static const struct argp_option OPTIONS[] = {
    {"force", KEY_FORCE, 0, 0, "build: replace laws that are there already", 0},
    {"quiet", KEY_QUIET, 0, 0, "no progress, only results and errors", 0},
    {"threads", KEY_THREADS, "N", 0, "build: use N threads (default: all cores)", 0},
    {0}};

static error_t parse(int key, char *value, struct argp_state *state) {
    arguments *a = state->input;
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
            argp_error(state, "--threads must be a whole number from 1 to 4096, not \"%s\"", value);
        }
        a->threads = (int)count;
        return 0;
    case ARGP_KEY_ARG:
        if (state->arg_num > 1) {
            argp_error(state, "one command and one case, please; \"%s\" is too much", value);
        }
        *(state->arg_num == 0 ? &a->command : &a->folder) = value;
        return 0;
    case ARGP_KEY_END:
        if (state->arg_num < 2) {
            argp_error(state,
                       "a command and a case are needed, as in: haft-laws build cases/delrio-rh85");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* Spread of one number over the laws that have it. */
typedef struct spread {
    size_t n;
    double mean, deviation, least, greatest;
} spread;

static void take(spread *s, double value) {
    if (!isfinite(value)) {
        return;
    }
    s->n++;
    double delta = value - s->mean;
    s->mean += delta / (double)s->n;
    s->deviation += delta * (value - s->mean);
    s->least = s->n == 1 ? value : fmin(s->least, value);
    s->greatest = s->n == 1 ? value : fmax(s->greatest, value);
}

/* One line: ours, and the reference's range where the case gives one. */
static void print_spread(const char *label, spread s, double unit, const double reference[2]) {
    double deviation = s.n > 1 ? sqrt(s.deviation / (double)(s.n - 1)) : NAN;
    printf("  %-30s %9.4g %9.3g %9.4g %9.4g", label, s.mean * unit, deviation * unit,
           s.least * unit, s.greatest * unit);
    if (reference != NULL && isfinite(reference[0])) {
        printf("   %.3g to %.3g", reference[0] * unit, reference[1] * unit);
    }
    printf("\n");
}

static void print_zero_force(const haft_laws *laws, const haft_case *c) {
    spread zero = {0}, contact = {0}, wet = {0}, asperities = {0};
    for (size_t k = 0; k < laws->m; k++) {
        take(&zero, laws->zero_distance[k]);
        take(&contact, laws->contact_area[k]);
        take(&wet, laws->wet_area[k]);
        take(&asperities, laws->asperities[k]);
    }
    printf("  %-30s %9s %9s %9s %9s   %s\n", "where the force vanishes", "mean", "std. dev.",
           "least", "greatest", isfinite(c->reference.zero_distance[0]) ? "reference" : "");
    print_spread("distance [nm]", zero, 1e9, c->reference.zero_distance);
    print_spread("contact area [%]", contact, 100, c->reference.contact_area);
    print_spread("wet area [%]", wet, 100, c->reference.wet_area);
    print_spread("asperities in contact [1]", asperities, 1, c->reference.asperities);
}

static void print_vectors(const haft_laws *laws) {
    spread v[4] = {{0}};
    for (size_t k = 0; k < laws->m; k++) {
        take(&v[0], laws->vector[k].e);
        take(&v[1], laws->vector[k].f_max);
        take(&v[2], laws->vector[k].d_max);
        take(&v[3], laws->vector[k].d_limit);
    }
    printf("  law vectors (push limit %.4g MPa)\n", laws->f_limit * 1e-6);
    print_spread("energy e [mJ/m2]", v[0], 1e3, NULL);
    print_spread("greatest pull f_max [MPa]", v[1], 1e-6, NULL);
    print_spread("its distance d_max [nm]", v[2], 1e9, NULL);
    print_spread("limit distance d_limit [nm]", v[3], 1e9, NULL);
}

static void print_laws(const haft_laws *laws, const haft_case *c) {
    printf("%zu laws, %zu a beam, on %zu distances from %.4g to %.4g nm\n", laws->m, laws->sites,
           laws->n, laws->distance[0] * 1e9, laws->distance[laws->n - 1] * 1e9);
    print_zero_force(laws, c);
    print_vectors(laws);
    size_t count[HAFT_LAW_FAULTS];
    haft_study_count_faults(laws, count);
    printf("  Morse law fits %zu of %zu", count[HAFT_LAW_SOUND], laws->m);
    for (int f = 1; f < HAFT_LAW_FAULTS; f++) {
        if (count[f] > 0) {
            printf("; %s: %zu", haft_law_fault_name((haft_law_fault)f), count[f]);
        }
    }
    printf("\n");
}

static haft_status build(haft_laws **laws, const haft_case *c, const arguments *a, terminal *t,
                         const char *path, haft_error *error) {
    if (!a->force && access(path, F_OK) == 0) {
        return haft_error_set(error, HAFT_ERROR_EXISTS,
                              "%s is there already; add --force to replace it", path);
    }
    haft_progress progress = terminal_progress(t);
    haft_status status = make_out_folder(a->folder, NULL, error);
    if (status == HAFT_OK) {
        status = haft_study_build_laws(laws, c, &progress, error);
    }
    if (status == HAFT_OK) {
        status = haft_laws_write(*laws, c, path, error);
    }
    return status == HAFT_OK ? save_laws_table(*laws, a->folder, error) : status;
}

int main(int argc, char **argv) {
    argp_err_exit_status = EXIT_USAGE;
    argp_program_version = haft_version();
    static const struct argp program = {OPTIONS, parse, "COMMAND CASE", DOC, NULL, NULL, NULL};
    arguments a = {0};
    argp_parse(&program, argc, argv, 0, NULL, &a);
    terminal t;
    terminal_open(&t, "haft-laws", a.quiet);
    bool building = strcmp(a.command, "build") == 0;
    if (!building && strcmp(a.command, "info") != 0) {
        fprintf(stderr, "haft-laws: there is no command \"%s\"; try build or info\n", a.command);
        return EXIT_USAGE;
    }
    if (a.threads > 0) {
        omp_set_num_threads(a.threads);
    }
    haft_error error = {0};
    haft_case *c = NULL;
    haft_laws *laws = NULL;
    char path[PATH_CAPACITY];
    haft_status status = read_case(&c, a.folder, &error);
    if (status == HAFT_OK) {
        status = case_out_path(path, a.folder, "laws.h5", &error);
    }
    if (status == HAFT_OK) {
        status = building ? build(&laws, c, &a, &t, path, &error)
                          : haft_laws_read(&laws, NULL, path, &error);
    }
    if (status == HAFT_OK && !(building && a.quiet)) {
        print_laws(laws, c);
    }
    haft_laws_destroy(&laws);
    haft_case_destroy(&c);
    if (status != HAFT_OK && building) {
        drop_empty_out_folder(a.folder);
    }
    return status == HAFT_OK ? terminal_finish(&t, EXIT_OK) : terminal_fail(&t, status, &error);
}
