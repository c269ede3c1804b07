/* SPDX-License-Identifier: GPL-3.0-or-later */
/* haft: checks, runs and plots a case. */
#include "draw.h"

#include <argp.h>
#include <errno.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { KEY_FORCE = 'f', KEY_QUIET = 'q', KEY_JSON = 'j', KEY_THREADS = 't', KEY_REALIZATION = 'r' };

typedef struct arguments {
    const char *command, *folder;
    bool force, quiet, json;
    int threads;
    long realization; /* -1: the first that left evidence */
} arguments;

static const char DOC[] =
    "Predicts how far a micro-cantilever stays stuck to its substrate, and how uncertain that is, "
    "from the roughness of the two surfaces. CASE is a folder that holds case.yaml; what a run "
    "makes goes into CASE/out.\v"
    "Commands:\n"
    "  check    read CASE/case.yaml and say whether it can be used\n"
    "  run      build the laws where needed, follow every beam, write CASE/out\n"
    "  resume   do what is left of a run that was stopped or killed\n"
    "  plot     draw the figures of a finished run into CASE/out/plots (gnuplot)\n"
    "  info     say what a finished run holds\n\n" EXIT_CODES;

static const struct argp_option OPTIONS[] = {
    {"force", KEY_FORCE, 0, 0, "run: replace results and parts that are there already", 0},
    {"quiet", KEY_QUIET, 0, 0, "no progress, only results and errors", 0},
    {"json", KEY_JSON, 0, 0, "run, resume, info: print the summary as JSON", 0},
    {"threads", KEY_THREADS, "N", 0, "run, resume: use N threads (default: all cores)", 0},
    {"realization", KEY_REALIZATION, "K", 0,
     "plot: the beam whose path is drawn (default: the first with evidence)", 0},
    {0}};

static long parse_count(struct argp_state *state, const char *text, long least, long most,
                        const char *what) {
    char *end = NULL;
    errno = 0;
    long value = strtol(text, &end, 10);
    if (errno != 0 || end == text || *end != '\0' || value < least || value > most) {
        argp_error(state, "%s must be a whole number from %ld to %ld, not \"%s\"", what, least,
                   most, text);
    }
    return value;
}

static error_t parse(int key, char *value, struct argp_state *state) {
    arguments *a = state->input;
    switch (key) {
    case KEY_FORCE:
        a->force = true;
        return 0;
    case KEY_QUIET:
        a->quiet = true;
        return 0;
    case KEY_JSON:
        a->json = true;
        return 0;
    case KEY_THREADS:
        a->threads = (int)parse_count(state, value, 1, 4096, "--threads");
        return 0;
    case KEY_REALIZATION:
        a->realization = parse_count(state, value, 0, 1000000000, "--realization");
        return 0;
    case ARGP_KEY_ARG:
        if (state->arg_num > 1) {
            argp_error(state, "one command and one case, please; \"%s\" is too much", value);
        }
        *(state->arg_num == 0 ? &a->command : &a->folder) = value;
        return 0;
    case ARGP_KEY_END:
        if (state->arg_num < 2) {
            argp_error(state, "a command and a case are needed, as in: haft run cases/delrio-rh85");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* ---- check
 * --------------------------------------------------------------------------------------- */

static void print_derived(const haft_case *c) {
    haft_psd_moments m = haft_psd_get_moments(&c->surface.psd);
    haft_gw gw = haft_gw_from_moments(m);
    printf("%s: %s\n", c->name, c->title);
    printf("  roughness            %.3g nm rms, slope %.3g, curvature %.3g 1/um (rms)\n",
           sqrt(m.m0) * 1e9, sqrt(m.m2), sqrt(m.m4) * 1e-6);
    printf("  asperities           %.3g a um2, radius %.3g nm, heights %.3g nm (rms)\n",
           gw.density * 1e-12, gw.radius * 1e9, gw.summit_deviation * 1e9);
    haft_capillary capillary;
    if (c->contact.has_capillary &&
        haft_capillary_from_spec(&capillary, &c->contact.capillary, NULL) == HAFT_OK) {
        printf("  capillary            %.3g MPa within %.3g nm\n", capillary.pressure * 1e-6,
               capillary.range * 1e9);
    }
    printf("  beam                 bending stiffness %.4g N m2, %ld patches, %zu realizations\n",
           haft_beam_bending_stiffness(&c->beam), lround(c->beam.length / c->mesh.l_meso),
           c->realizations);
}

static int command_check(const haft_case *c, const arguments *a) {
    if (!a->quiet) {
        print_derived(c);
        printf("%s/case.yaml can be used\n", a->folder);
    }
    return EXIT_OK;
}

/* ---- run
 * ----------------------------------------------------------------------------------------- */

static void print_length(double metres) {
    if (isfinite(metres)) {
        printf(" %9.1f", metres * 1e6);
    } else {
        printf(" %9s", "-");
    }
}

/* A number, its interval (NULL where it has none) and what others found. */
static void print_row(const char *label, double ours, const haft_interval *interval, double paper,
                      double measured) {
    printf("  %-26s", label);
    print_length(ours);
    char low[16] = "-", high[16] = "-";
    if (interval != NULL && !isfinite(interval->low) && !isfinite(interval->high)) {
        interval = NULL;
    }
    if (interval != NULL && isfinite(interval->low)) {
        snprintf(low, sizeof low, "%.1f", interval->low * 1e6);
    }
    if (interval != NULL && isfinite(interval->high)) {
        snprintf(high, sizeof high, "%.1f", interval->high * 1e6);
    }
    printf(" %8s %2s %-7s", interval != NULL ? low : "", interval != NULL ? "to" : "",
           interval != NULL ? high : "");
    print_length(paper);
    print_length(measured);
    printf("\n");
}

static void print_quantiles(const haft_case *c, const haft_statistics *s) {
    static const char *const label[HAFT_STUDY_QUANTILES] = {"5 % quantile", "median",
                                                            "95 % quantile"};
    for (size_t i = 0; i < HAFT_STUDY_QUANTILES; i++) {
        char text[40];
        bool beyond = s->quantile[i] > c->beam.length; /* not known but that they let go */
        snprintf(text, sizeof text, beyond ? "%s (free)" : "%s", label[i]);
        print_row(text, s->quantile[i], &s->quantile_interval[i], NAN, NAN);
    }
}

static void print_summary(const haft_case *c, const haft_statistics *s) {
    char interval[40];
    snprintf(interval, sizeof interval, "%.4g %% interval", 100 * s->confidence);
    printf("\n%s\n", c->title);
    printf("  %-26s %9s %-20s %9s %9s\n", "crack length at rest [um]", "Haft", interval, "paper",
           "measured");
    print_row("mean", s->mean, &s->mean_interval, c->reference.paper_crack_length,
              c->reference.measured_crack_length);
    print_row("standard error of the mean", s->standard_error, NULL, NAN, NAN);
    print_row("standard deviation", s->deviation, &s->deviation_interval, NAN, NAN);
    print_quantiles(c, s);
    print_row("least", s->least, NULL, NAN, NAN);
    print_row("greatest", s->greatest, NULL, NAN, NAN);
    if (s->stuck > 0) {
        printf("  effective energy of the mean, Gamma: %.3g mJ/m2\n", s->gamma * 1e3);
    }
    printf("  beams: %zu run, %zu stuck, %zu free, %zu failed; %.1f jumps and %.3f s a beam\n",
           s->run, s->stuck, s->free, s->failed, s->jumps, s->seconds);
    if (s->stuck + s->free > 0) {
        printf("  probability to stick: %.1f %%, %s %.1f to %.1f %%\n", 100 * s->stuck_share,
               interval, 100 * s->stuck_interval.low, 100 * s->stuck_interval.high);
    }
    printf("  energy ledger closed to %.1e of the work; %zu curves that no Morse law fits\n",
           s->ledger_error, s->unfit);
}

static void print_json_number(const char *key, double value, const char *end) {
    if (isfinite(value)) {
        printf("  \"%s\": %.12g%s\n", key, value, end);
    } else {
        printf("  \"%s\": null%s\n", key, end);
    }
}

static void print_json_interval(const char *key, haft_interval interval) {
    char name[80];
    snprintf(name, sizeof name, "%s_low%s", key, strcmp(key, "stuck_share") == 0 ? "" : "_m");
    print_json_number(name, interval.low, ",");
    snprintf(name, sizeof name, "%s_high%s", key, strcmp(key, "stuck_share") == 0 ? "" : "_m");
    print_json_number(name, interval.high, ",");
}

static void print_json(const haft_case *c, const haft_statistics *s) {
    static const char *const quantile[HAFT_STUDY_QUANTILES] = {
        "crack_length_quantile_05", "crack_length_median", "crack_length_quantile_95"};
    printf("{\n  \"case\": \"%s\",\n  \"version\": \"%s\",\n", c->name, haft_version());
    print_json_number("confidence", s->confidence, ",");
    print_json_number("crack_length_mean_m", s->mean, ",");
    print_json_interval("crack_length_mean", s->mean_interval);
    print_json_number("crack_length_standard_error_m", s->standard_error, ",");
    print_json_number("crack_length_deviation_m", s->deviation, ",");
    print_json_interval("crack_length_deviation", s->deviation_interval);
    for (size_t i = 0; i < HAFT_STUDY_QUANTILES; i++) {
        char name[60];
        snprintf(name, sizeof name, "%s_m", quantile[i]);
        print_json_number(name, s->quantile[i], ",");
        print_json_interval(quantile[i], s->quantile_interval[i]);
    }
    print_json_number("crack_length_least_m", s->least, ",");
    print_json_number("crack_length_greatest_m", s->greatest, ",");
    print_json_number("stuck_share", s->stuck_share, ",");
    print_json_interval("stuck_share", s->stuck_interval);
    print_json_number("paper_crack_length_m", c->reference.paper_crack_length, ",");
    print_json_number("measured_crack_length_m", c->reference.measured_crack_length, ",");
    print_json_number("gamma_J_per_m2", s->gamma, ",");
    printf("  \"run\": %zu,\n  \"stuck\": %zu,\n  \"free\": %zu,\n  \"failed\": %zu,\n", s->run,
           s->stuck, s->free, s->failed);
    print_json_number("jumps_per_beam", s->jumps, ",");
    print_json_number("seconds_per_beam", s->seconds, ",");
    print_json_number("ledger_error", s->ledger_error, "");
    printf("}\n");
}

static void print_result(const haft_case *c, const haft_summary *summary, bool json) {
    haft_statistics s = haft_study_statistics(c, summary, c->realizations);
    if (json) {
        print_json(c, &s);
    } else {
        print_summary(c, &s);
    }
}

typedef struct runner {
    const haft_case *c;
    const arguments *a;
} runner;

/* CASE/out/name, without what a killed run may have left of it. */
static haft_status companion(char path[PATH_CAPACITY], const char *folder, const char *name,
                             haft_error *error) {
    haft_status status = case_out_path(path, folder, name, error);
    if (status == HAFT_OK) {
        haft_io_drop_stale(path);
    }
    return status;
}

/* What lies beside results.h5. */
static haft_status save_companions(void *user, const haft_summary *summary, const haft_laws *laws,
                                   haft_error *error) {
    const runner *r = user;
    const haft_case *c = r->c;
    const char *folder = r->a->folder;
    char path[PATH_CAPACITY];
    haft_status status = companion(path, folder, "resolved.yaml", error);
    if (status == HAFT_OK) {
        status = haft_case_write(c, path, error);
    }
    if (status == HAFT_OK) {
        status = companion(path, folder, "laws.csv", error);
    }
    if (status == HAFT_OK) {
        status = save_laws_table(laws, folder, error);
    }
    if (status == HAFT_OK) {
        status = companion(path, folder, "summary.csv", error);
    }
    if (status == HAFT_OK) {
        status = haft_study_write_summary(summary, c->realizations, path, error);
    }
    if (status == HAFT_OK) {
        status = companion(path, folder, "convergence.csv", error);
    }
    return status == HAFT_OK
               ? haft_study_write_convergence(c, summary, c->realizations, path, error)
               : status;
}

/* Everything is saved, but a script must learn that not all beams have a result. */
static haft_status tell_failures(const haft_case *c, const haft_summary *summary,
                                 const char *results, haft_error *error) {
    haft_statistics s = haft_study_statistics(c, summary, c->realizations);
    for (size_t k = 0; k < c->realizations && s.failed > 0; k++) {
        int outcome = summary[k].outcome;
        if (outcome >= 0 && outcome != HAFT_OUTCOME_STUCK && outcome != HAFT_OUTCOME_FREE) {
            return haft_error_set(error, HAFT_ERROR_NUMERIC,
                                  "%zu of %zu beams could not be followed to the end, the first of "
                                  "them realization %zu (%s); all are kept in %s",
                                  s.failed, s.run, k, haft_outcome_name((haft_outcome)outcome),
                                  results);
        }
    }
    return HAFT_OK;
}

static const char NOT_ALL_RANKS[] = "another rank cannot begin; do all see the same files?";

static bool any_done(const haft_case *c, const haft_summary *summary) {
    for (size_t k = 0; k < c->realizations; k++) {
        if (summary[k].outcome >= 0) {
            return true;
        }
    }
    return false;
}

typedef struct run_paths {
    char results[PATH_CAPACITY], laws[PATH_CAPACITY], parts[PATH_CAPACITY];
} run_paths;

/* What a run needs before it can begin; the folder is rank 0's to make. */
static haft_status prepare_run(run_paths *paths, haft_summary **summary, const haft_case *c,
                               const arguments *a, haft_error *error) {
    *summary = haft_memory_alloc(c->realizations, sizeof **summary, error);
    if (*summary == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    haft_status status = case_out_path(paths->results, a->folder, "results.h5", error);
    if (status == HAFT_OK) {
        status = case_out_path(paths->laws, a->folder, "laws.h5", error);
    }
    if (status == HAFT_OK) {
        status = case_out_path(paths->parts, a->folder, "parts", error);
    }
    return status == HAFT_OK && haft_study_rank() == 0 ? make_out_folder(a->folder, NULL, error)
                                                       : status;
}

/* Tells what came of a run, and its exit code. */
static int tell_run(const haft_case *c, const arguments *a, const haft_summary *summary,
                    const char *results, haft_status status, haft_error *error, terminal *t) {
    if (status == HAFT_OK || (status == HAFT_ERROR_INTERRUPTED && any_done(c, summary))) {
        print_result(c, summary, a->json);
    }
    if (status == HAFT_OK) {
        status = tell_failures(c, summary, results, error);
    }
    if (status != HAFT_OK) {
        drop_empty_out_folder(a->folder);
    }
    return status == HAFT_OK ? EXIT_OK : terminal_fail(t, status, error);
}

static int command_run(const haft_case *c, const arguments *a, haft_run_mode mode, terminal *t) {
    haft_error error = {0};
    run_paths paths;
    haft_summary *summary = NULL;
    haft_status status = prepare_run(&paths, &summary, c, a, &error);
    if (!haft_study_ranks_agree(status == HAFT_OK) && status == HAFT_OK) {
        status = haft_error_set(&error, HAFT_ERROR_IO, NOT_ALL_RANKS);
    }
    if (status == HAFT_OK) {
        runner r = {c, a};
        haft_run_files files = {.laws = paths.laws,
                                .results = paths.results,
                                .parts = paths.parts,
                                .beside = save_companions,
                                .user = &r};
        haft_progress progress = terminal_progress(t);
        status = haft_study_run(summary, c, &files, mode, &progress, &error);
    }
    int code = EXIT_OK;
    if (haft_study_rank() == 0) {
        code = tell_run(c, a, summary, paths.results, status, &error, t);
    }
    haft_memory_free(summary);
    return code;
}

/* ---- info
 * ---------------------------------------------------------------------------------------- */

static int command_info(const haft_case *c, const arguments *a, terminal *t) {
    haft_error error = {0};
    char path[PATH_CAPACITY];
    haft_results_view *view = NULL;
    haft_status status = case_out_path(path, a->folder, "results.h5", &error);
    if (status == HAFT_OK) {
        status = read_results(&view, c, path, &error);
    }
    if (status == HAFT_OK) {
        print_result(c, view->summary, a->json);
    }
    haft_results_view_destroy(&view);
    return status == HAFT_OK ? EXIT_OK : terminal_fail(t, status, &error);
}

enum { CHECK, RUN, RESUME, PLOT, INFO, COMMANDS };
static const char *const commands[COMMANDS] = {"check", "run", "resume", "plot", "info"};

static int do_command(size_t command, const haft_case *c, const arguments *a, terminal *t) {
    switch (command) {
    case CHECK:
        return command_check(c, a);
    case RUN:
        return command_run(c, a, a->force ? HAFT_RUN_ANEW : HAFT_RUN_NEW, t);
    case RESUME:
        return command_run(c, a, HAFT_RUN_RESUME, t);
    case PLOT:
        return draw_case(c, a->folder, a->realization, t);
    default:
        return command_info(c, a, t);
    }
}

/* Of several ranks, 0 alone speaks, and does alone what is no run. */
static int start(const arguments *a, terminal *t) {
    bool leads = haft_study_rank() == 0;
    size_t command = 0;
    while (command < COMMANDS && strcmp(a->command, commands[command]) != 0) {
        command++;
    }
    bool runs = command == RUN || command == RESUME;
    if (!leads && !runs) {
        return EXIT_OK;
    }
    if (command == COMMANDS) {
        fprintf(stderr, "haft: there is no command \"%s\"; try check, run, resume, plot or info\n",
                a->command);
        return EXIT_USAGE;
    }
    if (a->threads > 0) {
        omp_set_num_threads(a->threads);
    }
    haft_error error = {0};
    haft_case *c = NULL;
    haft_status status = read_case(&c, a->folder, &error);
    if (status != HAFT_OK) {
        (void)(runs && haft_study_ranks_agree(false));
        return leads ? terminal_fail(t, status, &error) : EXIT_OK;
    }
    int code = do_command(command, c, a, t);
    haft_case_destroy(&c);
    return terminal_finish(t, code);
}

int main(int argc, char **argv) {
    haft_study_ranks_begin();
    atexit(haft_study_ranks_end);
    bool leads = haft_study_rank() == 0;
    argp_err_exit_status = EXIT_USAGE;
    argp_program_version = haft_version();
    static const struct argp program = {OPTIONS, parse, "COMMAND CASE", DOC, NULL, NULL, NULL};
    arguments a = {.realization = -1};
    if (argp_parse(&program, argc, argv, leads ? 0 : ARGP_SILENT, NULL, &a) != 0) {
        return EXIT_OK; /* rank 0 says what is wrong */
    }
    terminal t;
    terminal_open(&t, "haft", a.quiet);
    return start(&a, &t);
}
