/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Work against precision: the error of a cycle's answer and the cost of the cycle, as one choice at
 * a time goes from coarse to fine: element length, gap step, ledger tolerance, flow step.
 *
 *     bench-precision [-b beams] [-r rounds] [-m] [-o FILE.csv] [case directory]
 *     gnuplot -e "csv='FILE.csv'; png='FILE.png'" tools/plot/precision.gp     (from the top folder)
 *
 * The laws are those of the case's out/laws.h5. Without that file, and always with -m, they are
 * random Morse laws like those of the DelRio beams. Errors of l_e are against the exact mesh;
 * errors of a step or tolerance are against the finest steps on the same mesh (the case's own). So
 * the two kinds add up. Each error is the root mean square over the beams:
 *
 *     crack   of the crack length at rest [m];
 *     load    of the loads of jumps: by how much they must be moved, on average, over the greatest;
 *     loss    of the total dissipation, over the total dissipation.
 *
 * The time is the median over beams of the best of the rounds, on one thread. */
#include "bench.h"

#include "haft/study.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum { BEAM_LIMIT = 100, JUMP_LIMIT = 1000 };

typedef struct bench {
    haft_case *c;
    haft_laws *laws; /* NULL: random ones */
    haft_law *law[BEAM_LIMIT];
    haft_site_laws *site[BEAM_LIMIT];
    int beams, rounds;
    FILE *csv; /* may be NULL */
} bench;

/* One choice of options; element_length 0: the exact mesh. */
typedef struct setting {
    const char *varied;
    double value; /* in SI */
    double element_length;
    haft_path_options options;
} setting;

typedef struct score {
    double seconds, crack, load, loss;
    double jumps, steps, flow;
    int differ; /* number of beams with another number of jumps */
} score;

/* ---- laws ---- */

static haft_law *draw_laws(uint64_t beam, size_t sites) {
    haft_error error = {0};
    haft_law *law = haft_memory_alloc(sites, sizeof *law, &error);
    must(law == NULL ? HAFT_ERROR_MEMORY : HAFT_OK, &error);
    for (size_t r = 0; r < sites; r++) {
        haft_law_fault fault = HAFT_LAW_INVALID;
        for (uint64_t attempt = 0; fault != HAFT_LAW_SOUND; attempt++) {
            double z[4];
            haft_random_normals((haft_random_key){1, HAFT_RANDOM_TEST}, beam, r, 4 * attempt, 4, z);
            haft_law_vector v = {3.6e-3 * exp(0.3 * z[0]), 1e6 * exp(0.3 * z[1]),
                                 11e-9 + 0.4e-9 * z[2], 8.2e-9 + 0.2e-9 * z[3]};
            fault = haft_law_morse(&law[r], &v, 5e6);
        }
    }
    return law;
}

static void get_laws(bench *b, const char *directory, bool random) {
    char path[4096];
    haft_error error = {0};
    size_t sites = (size_t)llround(b->c->beam.length / b->c->mesh.l_meso);
    snprintf(path, sizeof path, "%s/out/laws.h5", directory);
    bool read = !random && haft_laws_read(&b->laws, NULL, path, &error) == HAFT_OK;
    if (read && !haft_study_has_sites(b->c, b->laws, 0)) {
        fprintf(stderr, "bench-precision: %s holds other sites than the case's\n", path);
        exit(1);
    }
    int held = read ? (int)(b->laws->m / b->laws->sites) : BEAM_LIMIT;
    b->beams = b->beams < held ? b->beams : held;
    for (int k = 0; k < b->beams; k++) {
        if (read) {
            must(haft_study_site_laws(&b->site[k], b->c, b->laws, (size_t)k, &error), &error);
            b->law[k] = b->site[k]->law;
        } else {
            b->law[k] = draw_laws((uint64_t)k, sites);
        }
    }
    printf("%s: %zu sites, %d beams, laws %s\n", b->c->name, sites, b->beams,
           read ? path : "random");
}

/* ---- cycles ---- */

static haft_model *make_model(const bench *b, double element_length) {
    haft_error error = {0};
    haft_model *model = NULL;
    haft_mesh_spec mesh = b->c->mesh;
    mesh.kind = element_length > 0 ? HAFT_MESH_UNIFORM : HAFT_MESH_EXACT;
    mesh.element_length = element_length;
    must(haft_model_create_beam(&model, &b->c->beam, &mesh, &error), &error);
    return model;
}

static haft_path *follow(const bench *b, const haft_model *model, const setting *s, int beam,
                         int rounds, double *best) {
    haft_error error = {0};
    haft_path *path = NULL;
    *best = INFINITY;
    for (int r = 0; r < rounds; r++) {
        haft_path_destroy(&path);
        double start = haft_clock_seconds();
        must(haft_solve_path(&path, model, b->law[beam], &b->c->programme, &s->options, &error),
             &error);
        *best = fmin(*best, haft_clock_seconds() - start);
    }
    if (path->outcome != HAFT_OUTCOME_STUCK && path->outcome != HAFT_OUTCOME_FREE) {
        printf("beam %d: %s\n", beam, haft_outcome_name(path->outcome));
    }
    return path;
}

static int sorted_loads(const haft_path *path, double load[JUMP_LIMIT]) {
    int n = 0;
    for (size_t j = 0; j < path->jumps && n < JUMP_LIMIT; j++) {
        load[n++] = path->jump[j].load;
    }
    qsort(load, (size_t)n, sizeof *load, compare);
    return n;
}

/* How far the loads of one path's jumps must be moved, on average, to become those of the other
 * path, over the greatest load. This is the integral of the distance between the quantile
 * functions, so the numbers of jumps may differ. */
static double load_error(const haft_path *a, const haft_path *b) {
    double x[JUMP_LIMIT], y[JUMP_LIMIT], sum = 0, done = 0;
    int n = sorted_loads(a, x), m = sorted_loads(b, y), i = 0, j = 0;
    if (n == 0 || m == 0) {
        return n == m ? 0 : 1;
    }
    while (i < n && j < m) {
        double end_x = (i + 1.0) / n, end_y = (j + 1.0) / m, end = fmin(end_x, end_y);
        sum += (end - done) * fabs(x[i] - y[j]);
        done = end;
        i += end_x <= end;
        j += end_y <= end;
    }
    return sum / fmax(fabs(y[0]), fabs(y[m - 1]));
}

static score judge(const bench *b, const setting *s, haft_path *const *reference) {
    score x = {0};
    double time[BEAM_LIMIT], n = b->beams;
    haft_model *model = make_model(b, s->element_length);
    for (int k = 0; k < b->beams; k++) {
        haft_path *path = follow(b, model, s, k, b->rounds, &time[k]);
        const haft_path *r = reference[k];
        haft_path_point p = path->point[path->points - 1], q = r->point[r->points - 1];
        double load = load_error(path, r), loss = p.dissipated / q.dissipated - 1;
        x.crack += pow(p.crack_length - q.crack_length, 2) / n;
        x.load += load * load / n;
        x.loss += loss * loss / n;
        x.jumps += (double)path->jumps / n;
        x.steps += (double)path->cost.steps / n;
        x.flow += (double)path->cost.flow_steps / n;
        x.differ += path->jumps != r->jumps;
        haft_path_destroy(&path);
    }
    haft_model_destroy(&model);
    qsort(time, (size_t)b->beams, sizeof *time, compare);
    x.seconds = 0.5 * (time[b->beams / 2] + time[(b->beams - 1) / 2]);
    x.crack = sqrt(x.crack);
    x.load = sqrt(x.load);
    x.loss = sqrt(x.loss);
    return x;
}

static void print_score(const bench *b, const setting *s, const score *x, bool is_default) {
    printf("%-16s %9g %c %9.4f %10.2e %10.2e %10.2e %6.1f %7d %7.0f %7.0f\n", s->varied, s->value,
           is_default ? '*' : ' ', x->seconds, 1e6 * x->crack, x->load, x->loss, x->jumps,
           x->differ, x->steps, x->flow);
    fflush(stdout);
    if (b->csv != NULL) {
        fprintf(b->csv, "%s,%.9g,%.6g,%.6g,%.6g,%.6g,%.6g,%d,%d\n", s->varied, s->value, x->seconds,
                1e6 * x->crack, x->load, x->loss, x->jumps, x->differ, is_default);
    }
}

static void make_reference(const bench *b, const setting *s, haft_path **reference) {
    double seconds;
    haft_model *model = make_model(b, s->element_length);
    for (int k = 0; k < b->beams; k++) {
        reference[k] = follow(b, model, s, k, 1, &seconds);
    }
    haft_model_destroy(&model);
}

static void drop_reference(const bench *b, haft_path **reference) {
    for (int k = 0; k < b->beams; k++) {
        haft_path_destroy(&reference[k]);
    }
}

/* ---- sweeps ---- */

static const haft_path_options defaults = {
    .gap_step = 0.5, .ledger_tolerance = 1e-10, .flow_step = 0.1};
/* Finer than any step of the sweeps. */
static const haft_path_options finest = {
    .gap_step = 0.04, .ledger_tolerance = 1e-12, .residual_tolerance = 1e-12, .flow_step = 0.001};

static void sweep_elements(const bench *b) {
    static const double lengths[] = {30e-6, 15e-6, 10e-6, 7.5e-6, 5e-6, 3e-6, 1.5e-6};
    haft_path *reference[BEAM_LIMIT];
    setting exact = {"element_length", 0, 0, finest};
    make_reference(b, &exact, reference);
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        setting s = {"element_length", lengths[i], lengths[i], defaults};
        score x = judge(b, &s, reference);
        print_score(b, &s, &x, fabs(lengths[i] - b->c->mesh.element_length) < 1e-12);
    }
    exact.options = defaults;
    score x = judge(b, &exact, reference);
    print_score(b, &exact, &x, b->c->mesh.kind == HAFT_MESH_EXACT);
    drop_reference(b, reference);
}

static void sweep_steps(const bench *b) {
    static const double gap[] = {2.5, 1, 0.5, 0.25, 0.1, 0.05};
    static const double ledger[] = {1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-11};
    static const double flow[] = {1, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005};
    enum { GAPS = sizeof gap / sizeof *gap, LEDGERS = sizeof ledger / sizeof *ledger };
    enum { FLOWS = sizeof flow / sizeof *flow };
    double length = b->c->mesh.kind == HAFT_MESH_UNIFORM ? b->c->mesh.element_length : 0;
    haft_path *reference[BEAM_LIMIT];
    make_reference(b, &(setting){"finest", 0, length, finest}, reference);
    for (int i = 0; i < GAPS + LEDGERS + FLOWS; i++) {
        setting s = {"", 0, length, defaults};
        double usual;
        if (i < GAPS) {
            s.varied = "gap_step";
            usual = defaults.gap_step;
            s.options.gap_step = s.value = gap[i];
        } else if (i < GAPS + LEDGERS) {
            s.varied = "ledger_tolerance";
            usual = defaults.ledger_tolerance;
            s.options.ledger_tolerance = s.value = ledger[i - GAPS];
        } else {
            s.varied = "flow_step";
            usual = defaults.flow_step;
            s.options.flow_step = s.value = flow[i - GAPS - LEDGERS];
        }
        score x = judge(b, &s, reference);
        print_score(b, &s, &x, fabs(s.value / usual - 1) < 1e-9);
    }
    drop_reference(b, reference);
}

/* Compares all linear solvers with the finest steps. Value 0 is auto, 1 KLU, 2 the band solver. */
static void sweep_linear_solvers(const bench *b) {
    double length = b->c->mesh.kind == HAFT_MESH_UNIFORM ? b->c->mesh.element_length : 0;
    haft_path *reference[BEAM_LIMIT];
    make_reference(b, &(setting){"finest", 0, length, finest}, reference);
    for (int i = HAFT_LINEAR_SOLVER_AUTO; i <= HAFT_LINEAR_SOLVER_BAND; i++) {
        setting s = {"linear_solver", i, length, defaults};
        s.options.linear_solver = (haft_linear_solver)i;
        score x = judge(b, &s, reference);
        print_score(b, &s, &x, i == HAFT_LINEAR_SOLVER_AUTO);
    }
    drop_reference(b, reference);
}

static void run(const bench *b) {
    static const char *heads[][2] = {{"cycle", "[s]"}, {"crack", "[um]"}, {"loads", ""},
                                     {"loss", ""},     {"jumps", ""},     {"differ", ""},
                                     {"steps", ""},    {"flow", "steps"}};
    for (int row = 0; row < 2; row++) {
        printf("%-16s %9s   %9s %10s %10s %10s %6s %7s %7s %7s\n", row ? "" : "varied",
               row ? "[SI]" : "value", heads[0][row], heads[1][row], heads[2][row], heads[3][row],
               heads[4][row], heads[5][row], heads[6][row], heads[7][row]);
    }
    if (b->csv != NULL) {
        fprintf(b->csv, "varied,value,seconds,crack_error_um,load_error,loss_error,jumps,"
                        "beams_that_differ,default\n");
    }
    sweep_elements(b);
    sweep_steps(b);
    sweep_linear_solvers(b);
    printf("linear_solver: 0 auto (KLU behind KINSOL, else band), 1 klu, 2 band\n"
           "* the default. Errors: root mean square over beams; l_e against the exact mesh, the "
           "others against the finest steps on the case's mesh\n");
}

int main(int count, char **arguments) {
    bench b = {.beams = 8, .rounds = 2};
    bool random = false;
    const char *csv = NULL;
    int option = 0;
    while ((option = getopt(count, arguments, "b:r:mo:")) != -1) {
        if (option == 'b') {
            b.beams = atoi(optarg);
        } else if (option == 'r') {
            b.rounds = atoi(optarg);
        } else if (option == 'm') {
            random = true;
        } else if (option == 'o') {
            csv = optarg;
        } else {
            fprintf(stderr, "usage: bench-precision [-b beams] [-r rounds] [-m] [-o FILE.csv] "
                            "[case directory]\nto draw FILE.csv, from the top folder: gnuplot -e "
                            "\"csv='FILE.csv'; png='FILE.png'\" tools/plot/precision.gp\n");
            return 2;
        }
    }
    b.beams = b.beams < 1 ? 1 : b.beams > BEAM_LIMIT ? BEAM_LIMIT : b.beams;
    b.rounds = b.rounds < 1 ? 1 : b.rounds;
    const char *directory = optind < count ? arguments[optind] : "cases/delrio-rh85";
    char path[4096];
    haft_error error = {0};
    snprintf(path, sizeof path, "%s/case.yaml", directory);
    must(haft_case_read(&b.c, path, &error), &error);
    get_laws(&b, directory, random);
    if (csv != NULL && (b.csv = fopen(csv, "w")) == NULL) {
        fprintf(stderr, "bench-precision: %s cannot be written\n", csv);
        return 1;
    }
    fflush(stdout);
    run(&b);
    if (b.csv != NULL && fclose(b.csv) != 0) {
        fprintf(stderr, "bench-precision: %s cannot be written\n", csv);
        return 1;
    }
    for (int k = 0; k < b.beams; k++) {
        if (b.site[k] == NULL) {
            haft_memory_free(b.law[k]);
        }
        haft_site_laws_destroy(&b.site[k]);
    }
    haft_laws_destroy(&b.laws);
    haft_case_destroy(&b.c);
    return 0;
}
