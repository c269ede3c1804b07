/* SPDX-License-Identifier: GPL-3.0-or-later */
/* haft: checks, runs and plots a case. */
#include "against.h"
#include "compare.h"
#include "draw.h"
#include "init.h"
#include "report.h"
#include "run.h"
#include "summary_report.h"
#include "sweep.h"

#include <argp.h>
#include <errno.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    KEY_FORCE = 'f',
    KEY_QUIET = 'q',
    KEY_JSON = 'j',
    KEY_THREADS = 't',
    KEY_REALIZATION = 'r',
    KEY_AGAINST = 'a',
    KEY_BEAMS = 'b',
    KEY_OUTPUT = 'o',
    KEY_SHARD = 's',
    BUDGET_BEAMS = 4,
    FOLDERS_MAX = 64,
};

typedef struct arguments {
    const char *command, *folder, *against; /* folder is the first; against may be NULL */
    char *folders[FOLDERS_MAX];
    size_t count; /* number of folders */
    const char *output;
    bool force, quiet, json;
    haft_shard shard; /* {0}: all */
    int threads;
    long realization; /* -1: the first with evidence */
    long beams;       /* of each term of a budget, or of a study; 0: the default */
    init_words init;
} arguments;

static const char DOC[] =
    "Predicts how far a micro-cantilever stays stuck to its substrate, and how uncertain that is, "
    "from the roughness of the two surfaces. CASE is a folder that holds case.yaml; what a run "
    "makes goes into CASE/out.\v"
    "Commands:\n"
    "  init     make CASE from a height map (--map=FILE), or from --rms, --correlation-length and\n"
    "           --hurst: a case.yaml that runs in a minute or two, to be changed as you like\n"
    "  check    read CASE/case.yaml and say whether it can be used\n"
    "  run      build the laws where needed, follow every beam, write CASE/out\n"
    "  resume   do what is left of a run that was stopped or killed\n"
    "  merge    make the results of a run's shards, all of which must be done\n"
    "  plot     draw the figures of a finished run into CASE/out/plots (gnuplot)\n"
    "  info     say what a finished run holds\n"
    "  report   tell a finished run on one page, CASE/out/report.html\n"
    "  budget   measure what each approximation contributes to the mean crack length\n"
    "  compare  put two cases or more, or the variants of a sweep, beside the first of them\n\n"
    "Where case.yaml holds a sweep, these do so for all its variants, each a case of its own in "
    "CASE/out. Built with MPI, `mpirun -n N haft run CASE` spreads the beams over N "
    "ranks.\n\n" EXIT_CODES;

static const struct argp_option OPTIONS[] = {
    {"force", KEY_FORCE, 0, 0, "run: replace results and parts that are there already", 0},
    {"quiet", KEY_QUIET, 0, 0, "no progress, only results and errors", 0},
    {"json", KEY_JSON, 0, 0, "run, resume, merge, info: print the summary as JSON", 0},
    {"threads", KEY_THREADS, "N", 0, "run, resume: use N threads (default: all cores)", 0},
    {"shard", KEY_SHARD, "I/N", 0,
     "run, of one case: follow the beams of part I of N alone, from where it was stopped if it was",
     0},
    {"realization", KEY_REALIZATION, "K", 0,
     "plot, report, of one case: the beam whose path is drawn (default: the first with evidence, "
     "else 0)",
     0},
    {"against", KEY_AGAINST, "REFERENCE", 0,
     "info, plot, of one case: hold its crack lengths against those of another case", 0},
    {"output", KEY_OUTPUT, "DIR", 0,
     "compare: put tables and figure into DIR (default: out/compare of the first case)", 0},
    {"beams", KEY_BEAMS, "N", 0,
     "budget: follow N beams for each term (default: 4); init: of the study (default: 50)", 0},
    {0}};

static long parse_count(struct argp_state *state, const char *text, long least, long most,
                        const char *what) {
    char *end = NULL;
    errno = 0;
    long value = strtol(text, &end, 10);
    if (errno != 0 || end == text || *end != '\0' || value < least || value > most) {
        terminal_misuse(state, "%s must be a whole number from %ld to %ld, not \"%s\"", what, least,
                        most, text);
    }
    return value;
}

static haft_shard parse_shard(struct argp_state *state, const char *text) {
    unsigned long index = 0, count = 0;
    char end = '\0';
    int read = strspn(text, "0123456789/") == strlen(text)
                   ? sscanf(text, "%7lu/%7lu%c", &index, &count, &end)
                   : 0;
    if (read != 2 || index < 1 || index > count) {
        terminal_misuse(state, "--shard must be I/N, as in 2/8, with I from 1 to N, not \"%s\"",
                        text);
    }
    return (haft_shard){index, count};
}

static error_t parse(int key, char *value, struct argp_state *state) {
    arguments *a = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &a->init;
        return 0;
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
    case KEY_BEAMS:
        a->beams = parse_count(state, value, 2, 1000000, "--beams");
        return 0;
    case KEY_SHARD:
        a->shard = parse_shard(state, value);
        return 0;
    case KEY_OUTPUT:
        a->output = value;
        return 0;
    case KEY_AGAINST:
        a->against = value;
        return 0;
    case ARGP_KEY_ARG:
        if (state->arg_num == 0) {
            a->command = value;
            return 0;
        }
        if (a->count > 0 && (strcmp(a->command, "compare") != 0 || a->count == FOLDERS_MAX)) {
            terminal_misuse(state, "one command and one case, please; \"%s\" is too much", value);
        }
        a->folders[a->count++] = value;
        a->folder = a->folders[0];
        return 0;
    case ARGP_KEY_END:
        if (state->arg_num < 2) {
            terminal_misuse(state,
                            "a command and a case are needed, as in: haft run cases/delrio-rh85");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* ---- check ---- */

/* Prints what the readers of the maps assumed. */
static void print_notes(const haft_case_files *files, const haft_map_set *maps) {
    for (size_t k = 0; k < maps->count; k++) {
        if (maps->map[k]->note[0] != '\0') {
            terminal_print(stdout, "  %s: %s", files->path[k], maps->map[k]->note);
        }
    }
}

/* Compares the fitted form that replaces the maps with the maps. */
static void print_fit(const haft_case *c) {
    const haft_psd_fit *fit = &c->surface.fit;
    double own = c->surface.map_rms;
    if (!c->surface.fitted) {
        return;
    }
    printf(
        "  fit to the maps      %.3g nm rms, 95 %% interval %.3g to %.3g; the maps have %.3g nm\n",
        fit->rms[0] * 1e9, fit->rms[1] * 1e9, fit->rms[2] * 1e9, own * 1e9);
    if (!(own >= fit->rms[1] && own <= fit->rms[2])) {
        printf(
            "    warning: the rms of the maps lies outside the interval; see haft-laws inspect\n");
    }
    if (fit->p_value < 1e-3) {
        printf("    warning: the form does not fit (misfit %.3g, p = %.2g); use: table\n",
               fit->misfit, fit->p_value);
    }
    static const char *const names[] = {"s_0", "zeta_0", "the Hurst exponent"};
    for (int k = 0; k < 3; k++) {
        if (!fit->determined[k]) {
            printf("    warning: %s is not determined by the maps; see haft-laws inspect\n",
                   names[k]);
        }
    }
}

static void print_parameters(const char *label, const haft_psd *psd) {
    printf("  %-20s s_0 %.6g nm^4, zeta_0 %.6g rad/um, s_1 %.6g nm^4, zeta_max %.6g rad/um\n",
           label, psd->s_0 * 1e36, psd->zeta_0 * 1e-6, psd->s_1 * 1e36, psd->zeta_max * 1e-6);
}

static void print_roughness(const char *label, double m0, double length, const haft_psd *psd) {
    double hurst = haft_psd_get_hurst(psd);
    printf("  %-20s rms %.6g nm, correlation_length %.6g nm, hurst %.6g%s, zeta_max %.6g rad/um\n",
           label, sqrt(m0) * 1e9, length * 1e9, hurst,
           hurst > 0 && hurst <= 1 ? "" : " (not self-affine: outside 0 to 1)",
           psd->zeta_max * 1e-6);
}

/* Prints both forms of the PSD; if it is given by points, those of its fit. */
static void print_psd(const haft_case *c) {
    const haft_psd_table *table = c->surface.table;
    haft_psd_fit fit = {.psd = c->surface.psd};
    haft_error why_not = {0};
    if (table != NULL) {
        printf("  PSD                  %zu points, %.6g to %.6g rad/um; rms %.6g nm, correlation "
               "length %.6g nm\n",
               table->n, table->zeta[0] * 1e-6, table->zeta[table->n - 1] * 1e-6,
               sqrt(haft_case_moments(c).m0) * 1e9, haft_case_correlation_length(c) * 1e9);
        if (haft_psd_fit_self_affine(&fit, table, &why_not) != HAFT_OK) {
            terminal_print(stdout, "  no self-affine form  %s", why_not.message);
            return;
        }
    }
    print_parameters(table != NULL ? "its self-affine fit" : "PSD", &fit.psd);
    print_roughness("  or as", haft_psd_get_moments(&fit.psd).m0,
                    haft_psd_get_correlation_length(&fit.psd), &fit.psd);
}

static void print_dispersion(const haft_case *c) {
    haft_dispersion law;
    if (!c->contact.has_dispersion || haft_case_dispersion(&law, c, NULL) != HAFT_OK) {
        return;
    }
    const haft_far_field *far = c->contact.far;
    double d[2] = {c->contact.distance_from, c->contact.distance_to}, pressure[2];
    haft_far_field_evaluate(far, 2, d, &(haft_far_field_values){.pressure = pressure});
    printf(
        "  dispersion           %.4g J, gaps from %.3g to %.4g nm; %.3g kPa at %.3g nm, %.3g kPa "
        "at %.3g nm\n",
        law.substrate, law.cut_off * 1e9, far->out * 1e9, pressure[0] * 1e-3, d[0] * 1e9,
        pressure[1] * 1e-3, d[1] * 1e9);
}

static void print_derived(const haft_case *c) {
    haft_psd_moments m = haft_case_moments(c);
    haft_gw gw = haft_gw_from_moments(m);
    terminal_print(stdout, "%s: %s", c->name, c->title);
    print_notes(&c->surface.maps, &c->surface.map);
    print_notes(&c->surface.opposite_maps, &c->surface.opposite);
    print_psd(c);
    printf("  roughness            %.3g nm rms, slope %.3g, curvature %.3g 1/um (rms)\n",
           sqrt(m.m0) * 1e9, sqrt(m.m2), sqrt(m.m4) * 1e-6);
    print_fit(c);
    printf("  asperities           %.3g a um2, radius %.3g nm, heights %.3g nm (rms)\n",
           gw.density * 1e-12, gw.radius * 1e9, gw.summit_deviation * 1e9);
    haft_physics physics = haft_case_physics(c);
    printf("  forces               %s%s\n", haft_physics_name(physics),
           c->contact.forces == HAFT_FORCES_AUTO ? ", chosen by humidity" : "");
    haft_capillary capillary;
    if (physics.capillary &&
        haft_capillary_from_spec(&capillary, &c->contact.capillary, NULL) == HAFT_OK) {
        printf("  capillary            %.3g MPa within %.3g nm\n", capillary.pressure * 1e-6,
               (capillary.range + 2 * haft_case_film(c)) * 1e9);
        if (haft_case_film(c) > 0) {
            printf("  adsorbed water       %.3g nm on each face, in that range\n",
                   haft_case_film(c) * 1e9);
        }
    }
    haft_contact_spec contact;
    if (physics.vdw && haft_study_contact_spec(&contact, c, NULL) == HAFT_OK) {
        printf("  van der Waals        %.4g mJ/m2, -%.4g MPa within %.3g nm, %s air, on %s\n",
               contact.vdw.energy * 1e3, contact.vdw.stress * 1e-6, contact.vdw.range * 1e9,
               physics.humid ? "humid" : "dry",
               contact.path == HAFT_VDW_APPROACH ? "approach" : "separation");
    }
    print_dispersion(c);
    printf("  beam                 bending stiffness %.4g N m2, %ld patches, %zu realizations\n",
           haft_beam_bending_stiffness(&c->beam), lround(c->beam.length / c->mesh.l_meso),
           c->realizations);
}

static int command_check(const haft_case *c, const arguments *a, terminal *t) {
    haft_error error = {0};
    haft_status status =
        c->sweep.keys > 0 ? check_sweep(c, a->folder, &error) : haft_study_check(c, true, &error);
    if (status != HAFT_OK) {
        return terminal_fail(t, status, &error);
    }
    if (!a->quiet) {
        print_derived(c);
        if (c->sweep.keys > 0) {
            printf("  sweep                %zu variants; the above is the first\n",
                   c->sweep.variants);
        }
        terminal_print(stdout, "%s/case.yaml can be used", a->folder);
    }
    return EXIT_OK;
}

/* ---- info ---- */

static int command_info(const haft_case *c, const arguments *a, terminal *t) {
    haft_error error = {0};
    char path[PATH_CAPACITY];
    haft_results_view *view = NULL;
    haft_status status = case_out_path(path, a->folder, "results.h5", &error);
    HAFT_THEN(status, read_results(&view, c, path, &error));
    if (status == HAFT_OK) {
        print_result(c, view->summary, a->json);
        if (view->rewritten && !a->json) {
            terminal_print(stdout, "%s was rewritten by another program; its data are unchanged",
                           path);
        }
    }
    haft_results_view_destroy(&view);
    return status == HAFT_OK ? EXIT_OK : terminal_fail(t, status, &error);
}

enum { INIT, CHECK, RUN, RESUME, MERGE, PLOT, INFO, REPORT, BUDGET, COMPARE, COMMANDS };
static const char *const commands[COMMANDS] = {"init", "check", "run",    "resume", "merge",
                                               "plot", "info",  "report", "budget", "compare"};

/* Refuses a command that works on one case only, where the case has a sweep. */
static int refuse_sweep(const haft_case *c, const arguments *a, terminal *t) {
    haft_error error = {0};
    if (haft_study_rank() != 0) {
        return EXIT_OK;
    }
    return terminal_fail(t,
                         haft_error_set(&error, HAFT_ERROR_INPUT,
                                        "%s holds a sweep; this is for one case, as %s/out/%s",
                                        a->folder, a->folder, c->sweep.label),
                         &error);
}

static int do_command(size_t command, const haft_case *c, const arguments *a, terminal *t) {
    bool swept = c->sweep.keys > 0;
    haft_run_mode mode = command == RESUME  ? HAFT_RUN_RESUME
                         : command == MERGE ? HAFT_RUN_MERGE
                         : a->force         ? HAFT_RUN_ANEW
                                            : HAFT_RUN_NEW;
    if (swept && (command == MERGE || a->shard.count > 0 || command == REPORT ||
                  command == BUDGET || (a->against != NULL && command >= PLOT))) {
        return refuse_sweep(c, a, t);
    }
    switch (command) {
    case CHECK:
        return command_check(c, a, t);
    case RUN:
    case RESUME:
    case MERGE:
        return swept ? run_sweep(c, a->folder, mode, a->json, t)
                     : run_case(c, a->folder, mode, a->shard, a->json, t);
    case PLOT:
        return swept ? plot_sweep(c, a->folder, t)
                     : draw_case(c, a->folder, a->realization, a->against, t);
    case REPORT:
        return report_case(c, a->folder, a->realization, t);
    case BUDGET:
        return budget_case(c, a->folder, a->beams > 0 ? (size_t)a->beams : BUDGET_BEAMS, t);
    default:
        return swept                ? tell_sweep(c, a->folder, a->json, t)
               : a->against != NULL ? tell_against(c, a->folder, a->against, a->json, t)
                                    : command_info(c, a, t);
    }
}

/* With several ranks, only rank 0 prints, and it alone does the commands that are not runs. */
static int start(const arguments *a, terminal *t) {
    bool leads = haft_study_rank() == 0;
    size_t command = 0;
    while (command < COMMANDS && strcmp(a->command, commands[command]) != 0) {
        command++;
    }
    bool runs = command == RUN || command == RESUME || command == MERGE;
    if (!leads && !runs) {
        return EXIT_OK;
    }
    if (command == COMMANDS) {
        terminal_print(
            stderr,
            "haft: there is no command \"%s\"; try init, check, run, resume, merge, plot, "
            "info, report, budget or compare",
            a->command);
        return EXIT_USAGE;
    }
    if (a->against != NULL && command != PLOT && command != INFO) {
        if (leads) {
            fprintf(stderr, "haft: --against belongs to info and plot, not to %s\n", a->command);
        }
        return EXIT_USAGE;
    }
    if (a->shard.count > 0 && (command != RUN || a->json)) {
        if (leads) {
            fprintf(stderr, "haft: --shard belongs to run, and goes without --json: the summary "
                            "is of all shards, by haft merge\n");
        }
        return EXIT_USAGE;
    }
    if (a->init.any && command != INIT) {
        terminal_print(stderr,
                       "haft: --map, --rms, --beam and what goes with them belong to init, "
                       "not to %s",
                       a->command);
        return EXIT_USAGE;
    }
    if (a->threads > 0) {
        omp_set_num_threads(a->threads);
    }
    if (command == INIT) {
        return terminal_finish(t, init_case(&a->init, a->folder, (size_t)a->beams, t));
    }
    if (command == COMPARE) {
        return terminal_finish(t, compare_cases(a->count, a->folders, a->output, t));
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
    static const struct argp_child children[] = {{&init_options, 0, NULL, 0}, {0}};
    static const struct argp program = {
        OPTIONS, parse, "COMMAND CASE\ncompare CASE CASE...", DOC, children, NULL, NULL};
    arguments a = {.realization = -1};
    error_t fault = argp_parse(&program, argc, argv, leads ? 0 : ARGP_SILENT, NULL, &a);
    if (fault == ENOMEM) {
        fputs("haft: out of memory\n", stderr);
        return EXIT_INTERNAL;
    }
    if (fault != 0) {
        return EXIT_OK; /* rank 0 reports the error */
    }
    terminal t;
    terminal_open(&t, "haft", a.quiet);
    return start(&a, &t);
}
