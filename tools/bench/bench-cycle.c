/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a load-unload cycle of one beam costs, against a floor: bare KLU refactorizations and solves
 * of the same pattern, as many as the path made. Those on the shorter meshes of an active mesh
 * count in proportion to their unknowns. The meshes are the paper's, the exact one and the active
 * one. Also prints how the cost grows with the number of sites, and what finer steps gain.
 *
 *     bench-cycle [-b beams] [-r rounds] [-m] [-s] [case directory]
 *
 * The laws are those of the case's out/laws.h5. Without that file, and always with -m, they are
 * random Morse laws. -s leaves out the study of error. */
#include "bench.h"

#include "haft/study.h"

#include <klu.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { BEAM_LIMIT = 100, ROUND_LIMIT = 99 };

typedef struct bench {
    haft_case *c;
    haft_laws *laws; /* NULL: random ones */
    haft_site_laws *beam[BEAM_LIMIT];
    int beams, rounds;
} bench;

/* ---- laws ---- */

/* Draws a law with numbers of the order that the DelRio beams have at 85 %. If no Morse law fits,
 * draws again. */
static haft_law draw_law(uint64_t beam, uint64_t site) {
    double deviation = sqrt(log1p(0.3 * 0.3));
    for (uint64_t attempt = 0;; attempt++) {
        double z[4];
        haft_random_normals((haft_random_key){1, HAFT_RANDOM_TEST}, beam, site, 4 * attempt, 4, z);
        haft_law_vector v = {.e = 3.6e-3 * exp(deviation * z[0] - 0.5 * deviation * deviation),
                             .f_max = 1e6 * exp(deviation * z[1] - 0.5 * deviation * deviation),
                             .d_max = 11e-9 + 0.4e-9 * z[2],
                             .d_limit = 8.2e-9 + 0.2e-9 * z[3]};
        haft_law law;
        if (haft_law_morse(&law, &v, 5e6) == HAFT_LAW_SOUND) {
            return law;
        }
    }
}

static haft_site_laws *draw_laws(uint64_t beam, size_t sites, haft_error *error) {
    haft_site_laws *s = haft_memory_alloc(1, sizeof *s, error);
    must(s == NULL ? HAFT_ERROR_MEMORY : HAFT_OK, error);
    s->sites = sites;
    s->law = haft_memory_alloc(sites, sizeof *s->law, error);
    must(s->law == NULL ? HAFT_ERROR_MEMORY : HAFT_OK, error);
    for (size_t r = 0; r < sites; r++) {
        s->law[r] = draw_law(beam, r);
    }
    return s;
}

static void get_laws(bench *b, const char *directory, bool random) {
    char path[4096];
    haft_error error = {0};
    size_t sites = (size_t)llround(b->c->beam.length / b->c->mesh.l_meso);
    snprintf(path, sizeof path, "%s/out/laws.h5", directory);
    if (!random && haft_laws_read(&b->laws, NULL, path, &error) == HAFT_OK) {
        if (!haft_study_has_sites(b->c, b->laws, 0)) {
            fprintf(stderr, "bench-cycle: %s holds other sites than the case's\n", path);
            exit(1);
        }
        int held = (int)(b->laws->m / b->laws->sites);
        b->beams = b->beams < held ? b->beams : held;
    }
    for (int k = 0; k < b->beams; k++) {
        if (b->laws != NULL) {
            must(haft_study_site_laws(&b->beam[k], b->c, b->laws, (size_t)k, &error), &error);
        } else {
            b->beam[k] = draw_laws((uint64_t)k, sites, &error);
        }
    }
    printf("%s: %zu sites, %d beams, laws %s\n", b->c->name, sites, b->beams,
           b->laws != NULL ? path : "random");
}

/* ---- a cycle against bare factorizations ---- */

/* Seconds of a KLU refactorization and of a solve. */
typedef struct klu_time {
    double refactor, solve;
} klu_time;

/* A KLU factorization of K + M, which has a model's pattern, in the solver's order. */
typedef struct bare_klu {
    const haft_model *model;
    double *value, *b;
    klu_common common;
    klu_symbolic *symbolic;
    klu_numeric *numeric;
} bare_klu;

static void make_bare_klu(bare_klu *k, const haft_model *m, haft_error *error) {
    const haft_model_data *data = haft_model_get(m);
    *k = (bare_klu){.model = m};
    k->value = haft_memory_alloc(data->nonzeros, sizeof *k->value, error);
    k->b = haft_memory_alloc(data->dofs, sizeof *k->b, error);
    must(k->value == NULL || k->b == NULL ? HAFT_ERROR_MEMORY : HAFT_OK, error);
    for (size_t i = 0; i < data->nonzeros; i++) {
        k->value[i] = data->stiffness[i] + data->mass[i];
    }
    klu_defaults(&k->common);
    k->common.btf = 0;
    k->common.scale = -1;
    k->common.tol = 0;
    k->symbolic = klu_analyze((int)data->dofs, data->column, data->row, &k->common);
    k->numeric = klu_factor(data->column, data->row, k->value, k->symbolic, &k->common);
}

static void free_bare_klu(bare_klu *k) {
    klu_free_numeric(&k->numeric, &k->common);
    klu_free_symbolic(&k->symbolic, &k->common);
    haft_memory_free(k->value);
    haft_memory_free(k->b);
}

/* Times refactorizations and solves: means over 200 runs. */
static klu_time time_klu(bare_klu *k) {
    enum { RUNS = 200 };
    const haft_model_data *m = haft_model_get(k->model);
    double start = haft_clock_seconds();
    for (int r = 0; r < RUNS; r++) {
        if (!klu_refactor(m->column, m->row, k->value, k->symbolic, k->numeric, &k->common)) {
            fprintf(stderr, "bench-cycle: KLU cannot factor K + M\n");
            exit(1);
        }
    }
    double middle = haft_clock_seconds();
    for (int r = 0; r < RUNS; r++) {
        for (size_t i = 0; i < m->dofs; i++) {
            k->b[i] = 1;
        }
        klu_solve(k->symbolic, k->numeric, (int)m->dofs, 1, k->b, &k->common);
    }
    return (klu_time){(middle - start) / RUNS, (haft_clock_seconds() - middle) / RUNS};
}

/* All laws that take part, and the gaps at the end of a path. */
typedef struct bare_laws {
    haft_law_rows *rows;
    size_t sites, room;
    double *d; /* four arrays of length `room`: gaps, and the three values */
} bare_laws;

static void make_bare_laws(bare_laws *b, const haft_model *m, const haft_law *laws,
                           const haft_path *path, haft_error *error) {
    const haft_model_data *data = haft_model_get(m);
    *b = (bare_laws){.sites = data->sites - data->inert, .room = data->sites};
    b->d = haft_memory_alloc(4 * b->room, sizeof *b->d, error);
    must(b->d == NULL ? HAFT_ERROR_MEMORY : HAFT_OK, error);
    must(haft_law_rows_create(&b->rows, b->sites, laws + data->inert, error), error);
    haft_model_gaps(m, path->final_state, b->d);
    memmove(b->d, b->d + data->inert, b->sites * sizeof *b->d);
}

static void free_bare_laws(bare_laws *b) {
    haft_law_rows_destroy(&b->rows);
    haft_memory_free(b->d);
}

/* Seconds of an evaluation of all these laws, as for one state: the mean over 200. */
static double time_laws(const bare_laws *b) {
    enum { RUNS = 200 };
    double *d = b->d, start = haft_clock_seconds();
    haft_law_values out = {d + b->room, d + 2 * b->room, NULL, d + 3 * b->room};
    for (int r = 0; r < RUNS; r++) {
        haft_law_rows_evaluate(b->rows, 0, b->sites, d, &out);
    }
    return (haft_clock_seconds() - start) / RUNS;
}

static haft_path *follow(const bench *b, const haft_model *model, const haft_path_options *options,
                         int beam, double *seconds) {
    haft_error error = {0};
    haft_path *path = NULL;
    double start = haft_clock_seconds();
    must(haft_solve_path(&path, model, b->beam[beam]->law, &b->c->programme, options, &error),
         &error);
    *seconds = haft_clock_seconds() - start;
    if (path->outcome != HAFT_OUTCOME_STUCK && path->outcome != HAFT_OUTCOME_FREE) {
        printf("beam %d: %s\n", beam, haft_outcome_name(path->outcome));
    }
    return path;
}

typedef struct mean_cost {
    double steps, rejected, newton, factorizations, solves, flow, jumps, unknowns;
} mean_cost;

static void add_cost(mean_cost *sum, const haft_path *path, int beams) {
    sum->steps += (double)path->cost.steps / beams;
    sum->rejected += (double)path->cost.rejected / beams;
    sum->newton += (double)path->cost.newton_iterations / beams;
    sum->factorizations += (double)path->cost.factorizations / beams;
    sum->solves += (double)path->cost.solves / beams;
    sum->flow += (double)path->cost.flow_steps / beams;
    sum->jumps += (double)path->jumps / beams;
    sum->unknowns += (double)path->cost.unknowns / beams;
}

static haft_model *make_model(const bench *b, haft_mesh_kind kind) {
    haft_error error = {0};
    haft_model *model = NULL;
    haft_mesh_spec mesh = b->c->mesh;
    mesh.kind = kind;
    mesh.active_from = 0.5 * b->c->programme.crack_length;
    if (kind == HAFT_MESH_UNIFORM && !(mesh.element_length > 0)) {
        mesh.element_length = 15e-6;
    }
    must(haft_model_create_beam(&model, &b->c->beam, &mesh, &error), &error);
    return model;
}

/* The cost of a beam's cycle: seconds; the floor; and ratios to the floor, to the floor with laws,
 * and to all work of KLU. */
typedef struct beam_cost {
    double time, floor, ratio, lawful, all;
} beam_cost;

/* Medians over the rounds. Each round times the floor right after the cycle, since the speed of a
 * shared processor changes from second to second. */
static beam_cost time_beam(const bench *b, const haft_model *model, bare_klu *klu, int beam,
                           mean_cost *sum) {
    haft_error error = {0};
    double round[5][ROUND_LIMIT];
    bare_laws laws = {0};
    for (int r = 0; r < b->rounds; r++) {
        haft_path *path = follow(b, model, &b->c->path, beam, &round[0][r]);
        if (r == 0) {
            make_bare_laws(&laws, model, b->beam[beam]->law, path, &error);
            add_cost(sum, path, b->beams);
        }
        klu_time one = time_klu(klu);
        double bare = one.refactor + one.solve, time = round[0][r];
        double whole =
            (double)path->cost.unknowns / (double)haft_model_get(model)->dofs; /* factorizations */
        double solves = whole * (double)path->cost.solves / (double)path->cost.factorizations;
        round[1][r] = bare;
        round[2][r] = time / (bare * whole);
        round[3][r] = time / ((bare + time_laws(&laws)) * whole);
        round[4][r] = time / (one.refactor * whole + one.solve * solves);
        haft_path_destroy(&path);
    }
    free_bare_laws(&laws);
    double m[5];
    for (int i = 0; i < 5; i++) {
        m[i] = median(round[i], b->rounds);
    }
    return (beam_cost){m[0], m[1], m[2], m[3], m[4]};
}

static void compare_with_floor(const bench *b, haft_mesh_kind kind) {
    haft_error error = {0};
    haft_model *model = make_model(b, kind);
    static const char *const name[] = {"uniform", "exact", "active"};
    double time[BEAM_LIMIT], ratio[BEAM_LIMIT], all[BEAM_LIMIT], lawful[BEAM_LIMIT], floor = 0;
    mean_cost cost = {0};
    bare_klu klu;
    make_bare_klu(&klu, model, &error);
    for (int k = 0; k < b->beams; k++) {
        beam_cost one = time_beam(b, model, &klu, k, &cost);
        time[k] = one.time;
        ratio[k] = one.ratio;
        lawful[k] = one.lawful;
        all[k] = one.all;
        floor += one.floor / b->beams;
    }
    free_bare_klu(&klu);
    double middle = median(time, b->beams);
    printf("%-8s %5zu %9zu %9.3f %9.3f %9.3f %9.2f %7.2f %7.2f %7.2f %7.0f %8.0f %8.0f %8.0f %8.0f "
           "%8.0f %6.0f %6.1f\n",
           name[kind], haft_model_get(model)->dofs, haft_model_get(model)->nonzeros, middle,
           time[0], time[b->beams - 1], 1e6 * floor, median(ratio, b->beams),
           median(lawful, b->beams), median(all, b->beams), cost.steps, cost.rejected, cost.newton,
           cost.factorizations, cost.solves, cost.unknowns / fmax(cost.factorizations, 1),
           cost.flow, cost.jumps);
    haft_model_destroy(&model);
}

/* ---- cost against the number of sites ---- */

/* Slope of log y over log x. */
static double exponent(const double *x, const double *y, int n) {
    double sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (int i = 0; i < n; i++) {
        double a = log(x[i]), b = log(y[i]);
        sx += a, sy += b, sxx += a * a, sxy += a * b;
    }
    return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

/* A series with more and more sites: the beam and patches of each size, and the title of the
 * table. */
typedef struct growth {
    const char *title;
    haft_beam_spec beam;
    double crack_length, position; /* loaded to this crack, and where [m] */
    double l_meso; /* [m]; 0: divide the beam into as many patches as there are sites */
} growth;

/* For each number of sites: the median cost of a cycle over random laws. The active meshes begin at
 * half the crack length that is loaded to. */
static void study_growth(const bench *b, const growth *g) {
    enum { SIZES = 5, BEAMS = 3 };
    static const size_t sites[SIZES] = {50, 100, 200, 500, 1000};
    double n[SIZES], cycle[SIZES], one[SIZES];
    printf("\nCost against the number of active sites, active mesh, median of %d beams: %s\n"
           "%8s %8s %8s %12s %8s %8s %8s %10s %18s\n",
           BEAMS, g->title, "sites", "active", "dofs", "cycle [ms]", "steps", "jumps", "flow",
           "factoriz.", "a factoriz. [us]");
    for (int i = 0; i < SIZES; i++) {
        haft_error error = {0};
        haft_beam_spec beam = g->beam;
        double l_meso = g->l_meso > 0 ? g->l_meso : beam.length / (double)sites[i];
        beam.length = l_meso * (double)sites[i];
        haft_mesh_spec mesh = {HAFT_MESH_ACTIVE, 0, l_meso, g->position, 0.5 * g->crack_length};
        haft_programme programme = {g->crack_length, 0.01, INFINITY};
        haft_model *model = NULL;
        must(haft_model_create_beam(&model, &beam, &mesh, &error), &error);
        double time[BEAMS], each[BEAMS];
        mean_cost cost = {0};
        for (int k = 0; k < BEAMS; k++) {
            haft_site_laws *laws = draw_laws((uint64_t)k, sites[i], &error);
            haft_path *path = NULL;
            double start = haft_clock_seconds();
            must(haft_solve_path(&path, model, laws->law, &programme, &b->c->path, &error), &error);
            time[k] = haft_clock_seconds() - start;
            each[k] = time[k] / (double)path->cost.factorizations;
            add_cost(&cost, path, BEAMS);
            haft_path_destroy(&path);
            haft_site_laws_destroy(&laws);
        }
        n[i] = (double)(haft_model_get(model)->sites - haft_model_get(model)->inert);
        cycle[i] = median(time, BEAMS);
        one[i] = median(each, BEAMS);
        printf("%8zu %8.0f %8zu %12.1f %8.0f %8.1f %8.0f %10.0f %18.2f\n", sites[i], n[i],
               haft_model_get(model)->dofs, 1e3 * cycle[i], cost.steps, cost.jumps, cost.flow,
               cost.factorizations, 1e6 * one[i]);
        haft_model_destroy(&model);
    }
    printf("exponent: cycle %.2f, a factorization with all that goes with it %.2f\n",
           exponent(n, cycle, SIZES), exponent(n, one, SIZES));
}

/* More sites in two ways: a longer beam, whose first snap runs along its whole length; and finer
 * patches of one beam. */
static void study_sites(const bench *b) {
    growth longer = {"ever longer beams 1 um thick, patches of 3 um",
                     {0, 30e-6, 1e-6, 1.9e-6, 163e9},
                     60e-6,
                     30e-6,
                     3e-6};
    growth finer = {"a beam of 600 um, ever finer patches",
                    {600e-6, 30e-6, 2.62e-6, 1.9e-6, 163e9},
                    120e-6,
                    60e-6,
                    0};
    study_growth(b, &longer);
    study_growth(b, &finer);
}

/* ---- speed against error ---- */

typedef struct result {
    double crack, dissipated, worst_ledger;
    size_t jumps;
} result;

typedef struct setting {
    const char *name;
    double flow_step, gap_step, ledger;
} setting;

static result sum_up(const haft_path *path) {
    haft_path_point end = path->point[path->points - 1];
    return (result){end.crack_length, end.dissipated, path->ledger_error, path->jumps};
}

static void study_setting(const bench *b, const haft_model *model, const setting *s,
                          result *reference, bool is_reference) {
    haft_path_options options = b->c->path;
    options.flow_step = s->flow_step;
    options.gap_step = s->gap_step;
    options.ledger_tolerance = s->ledger;
    double time[BEAM_LIMIT], crack = 0, dissipated = 0, ledger = 0;
    int moved = 0, jumps = 0;
    mean_cost cost = {0};
    for (int k = 0; k < b->beams; k++) {
        haft_path *path = follow(b, model, &options, k, &time[k]);
        result x = sum_up(path);
        if (is_reference) {
            reference[k] = x;
        }
        double off = fabs(x.crack - reference[k].crack);
        moved += off > 1e-9;
        jumps += x.jumps != reference[k].jumps;
        crack = fmax(crack, off);
        dissipated = fmax(dissipated, fabs(x.dissipated / reference[k].dissipated - 1));
        ledger = fmax(ledger, x.worst_ledger);
        add_cost(&cost, path, b->beams);
        haft_path_destroy(&path);
    }
    printf("%-10s %9g %9g %9g %10.3f %7.0f %7.0f %12.2e %7d %7d %12.2e %10.1e\n", s->name,
           s->flow_step, s->gap_step, s->ledger, median(time, b->beams), cost.steps, cost.flow,
           1e6 * crack, moved, jumps, dissipated, ledger);
}

static void study_error(const bench *b) {
    static const setting settings[] = {
        {"finest", 0.001, 0.05, 1e-12}, {"flow", 0.01, 0.5, 1e-10}, {"flow", 0.03, 0.5, 1e-10},
        {"default", 0.1, 0.5, 1e-10},   {"flow", 0.3, 0.5, 1e-10},  {"flow", 1, 0.5, 1e-10},
        {"gap", 0.1, 0.1, 1e-10},       {"gap", 0.1, 0.25, 1e-10},  {"gap", 0.1, 1, 1e-10},
        {"ledger", 0.1, 0.5, 1e-12},    {"ledger", 0.1, 0.5, 1e-8}, {"ledger", 0.1, 0.5, 1e-6},
        {"ledger", 0.1, 0.5, 1e-4},     {"coarse", 1, 1, 1e-6},
    };
    haft_model *model = make_model(b, HAFT_MESH_UNIFORM);
    result reference[BEAM_LIMIT];
    printf("\nSpeed against error, uniform mesh, over %d beams: greatest change against the "
           "finest\n",
           b->beams);
    printf("%-10s %9s %9s %9s %10s %7s %7s %12s %7s %7s %12s %10s\n", "varied", "flow_step",
           "gap_step", "ledger", "cycle [s]", "steps", "flow", "crack [um]", "cracks", "jumps",
           "dissipated", "ledger");
    printf("%-10s %9s %9s %9s %10s %7s %7s %12s %7s %7s %12s %10s\n", "", "[range]", "[range]",
           "tol.", "median", "", "steps", "", "moved", "differ", "[relative]", "error");
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) {
        study_setting(b, model, &settings[i], reference, i == 0);
    }
    haft_model_destroy(&model);
}

int main(int count, char **arguments) {
    bench b = {.beams = 10, .rounds = 3};
    bool random = false, study = true;
    int option = 0;
    while ((option = getopt(count, arguments, "b:r:ms")) != -1) {
        if (option == 'b') {
            b.beams = atoi(optarg);
        } else if (option == 'r') {
            b.rounds = atoi(optarg);
        } else if (option == 'm') {
            random = true;
        } else if (option == 's') {
            study = false;
        } else {
            fprintf(stderr,
                    "usage: bench-cycle [-b beams] [-r rounds] [-m] [-s] [case directory]\n");
            return 2;
        }
    }
    b.beams = b.beams < 1 ? 1 : b.beams > BEAM_LIMIT ? BEAM_LIMIT : b.beams;
    b.rounds = b.rounds < 1 ? 1 : b.rounds > ROUND_LIMIT ? ROUND_LIMIT : b.rounds;
    const char *directory = optind < count ? arguments[optind] : "cases/delrio-rh85";
    char path[4096];
    haft_error error = {0};
    snprintf(path, sizeof path, "%s/case.yaml", directory);
    must(haft_case_read(&b.c, path, &error), &error);
    get_laws(&b, directory, random);
    printf("\nA load-unload cycle, one thread, each beam the median of %d. Floor: a bare KLU "
           "refactorization and one\nsolve for each factorization made; and laws: with one bare "
           "evaluation of all laws for each; all of KLU:\nas many refactorizations and solves as "
           "the cycle made, by KLU\n",
           b.rounds);
    printf("%-8s %5s %9s %9s %9s %9s %9s %7s %7s %7s %7s %8s %8s %8s %8s %8s %6s %6s\n", "", "", "",
           "median", "least", "greatest", "floor", "to the", "and", "to all", "steps", "rejected",
           "Newton", "factor-", "solves", "dofs in", "flow", "jumps");
    printf("%-8s %5s %9s %9s %9s %9s %9s %7s %7s %7s %7s %8s %8s %8s %8s %8s %6s %6s\n", "mesh",
           "dofs", "nonzeros", "[s]", "[s]", "[s]", "[us]", "floor", "laws", "of KLU", "", "",
           "iter.", "izations", "", "use", "steps", "");
    compare_with_floor(&b, HAFT_MESH_UNIFORM);
    compare_with_floor(&b, HAFT_MESH_EXACT);
    compare_with_floor(&b, HAFT_MESH_ACTIVE);
    study_sites(&b);
    if (study) {
        study_error(&b);
    }
    for (int k = 0; k < b.beams; k++) {
        haft_site_laws_destroy(&b.beam[k]);
    }
    haft_laws_destroy(&b.laws);
    haft_case_destroy(&b.c);
    return 0;
}
