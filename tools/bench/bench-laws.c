/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the laws of one beam cost, against a floor: bare FFTW complex-to-real 2-D transforms of as
 * many points, block by block, planned with the same flag. Also prints where the time goes; what a
 * finer grid or kernel gains; and what a beam with its own surface costs in all, with the laws of
 * every site and with only those that can come into range.
 *
 *     bench-laws [-r rounds] [-p patches] [-s] [case directory]
 *
 * -p shortens the beam, -s leaves out the study of error. Each build and each floor runs in its own
 * process, so that its peak memory is its own. Half of the floor runs before the build and half
 * after it, so that a machine that slows down slows both. */
#include "bench.h"

#include "haft/study.h"

#include <fftw3.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { ROUND_LIMIT = 99, GRIDS = 3, TOLERANCES = 3 };

/* The study of error skips builds that would take longer than this [s]. */
#define PATIENCE 60.0

typedef struct sample {
    double seconds, megabytes;      /* megabytes: peak of the process */
    double e, f_max, zero_distance; /* means over the beam */
    size_t sound;
    haft_error error;
} sample;

typedef struct breakdown {
    double plan, noise, prepare, rows, islands, summits, vdw_islands, vdw_summits, characterise,
        above;
} breakdown;

/* The number of sites that get laws. */
static size_t sites_of(const haft_case *c) {
    return haft_study_sites(c) - haft_study_first_site(c);
}

static size_t rows_of(const haft_case *c) {
    return (size_t)llround(c->mesh.l_meso / c->surface.grid_step);
}

static size_t columns_of(const haft_case *c) {
    return (size_t)llround(c->beam.width / c->surface.grid_step);
}

static void average(const haft_laws *laws, sample *out) {
    size_t zeros = 0;
    for (size_t k = 0; k < laws->m; k++) {
        if (isfinite(laws->vector[k].e)) {
            out->e += laws->vector[k].e;
            out->f_max += laws->vector[k].f_max;
            out->sound++;
        }
        if (isfinite(laws->zero_distance[k])) {
            out->zero_distance += laws->zero_distance[k];
            zeros++;
        }
    }
    out->e /= (double)out->sound;
    out->f_max /= (double)out->sound;
    out->zero_distance /= (double)zeros;
}

static void build(const haft_case *c, int threads, sample *out) {
    haft_laws *laws = NULL;
    omp_set_num_threads(threads);
    double start = haft_clock_seconds();
    haft_status status = haft_study_build_laws(&laws, c, NULL, &out->error);
    out->seconds = haft_clock_seconds() - start;
    if (status == HAFT_OK) {
        average(laws, out);
        haft_laws_destroy(&laws);
    }
}

/* Runs half of the blocks' transforms on the threads, and times the transforms alone. */
static void transform(const haft_case *c, int threads, sample *out) {
    int rows = (int)(haft_study_block_patches(c) * rows_of(c)), columns = (int)columns_of(c);
    size_t half = (size_t)rows * ((size_t)columns / 2 + 1), points = (size_t)rows * (size_t)columns;
    double blocks = (double)sites_of(c) / (double)haft_study_block_patches(c);
    int runs = (int)fmax(1, ceil(0.5 * blocks));
    fftw_complex *in[2];
    double *z[2];
    for (int i = 0; i < threads; i++) {
        in[i] = fftw_alloc_complex(half);
        z[i] = fftw_alloc_real(points);
    }
    fftw_plan plan = fftw_plan_dft_c2r_2d(rows, columns, in[0], z[0], FFTW_ESTIMATE);
    double busy[2] = {0, 0};
#pragma omp parallel for schedule(static) num_threads(threads)
    for (int r = 0; r < runs; r++) {
        int me = omp_get_thread_num();
        for (size_t i = 0; i < half; i++) {
            in[me][i][0] = in[me][i][1] = (double)(i % 7) - 3;
        }
        double start = haft_clock_seconds();
        fftw_execute_dft_c2r(plan, in[me], z[me]);
        busy[me] += haft_clock_seconds() - start;
    }
    out->seconds = fmax(busy[0], busy[1]) * 0.5 * blocks / runs;
    if (threads > 1) { /* with an odd count one thread is idle for one transform */
        out->seconds = (busy[0] + busy[1]) / threads * 0.5 * blocks / runs;
    }
    fftw_destroy_plan(plan);
    for (int i = 0; i < threads; i++) {
        fftw_free(in[i]);
        fftw_free(z[i]);
    }
}

typedef void work_of(const haft_case *c, int threads, sample *out);

/* Runs `work` in a child process. Its result comes through a pipe, its peak memory from the
 * system. */
static sample apart(work_of *work, const haft_case *c, int threads) {
    sample out = {0};
    int ends[2];
    fflush(stdout);
    if (pipe(ends) != 0) {
        perror("bench-laws: pipe");
        exit(1);
    }
    pid_t child = fork();
    if (child == 0) {
        work(c, threads, &out);
        ssize_t sent = write(ends[1], &out, sizeof out);
        _exit(sent == (ssize_t)sizeof out ? 0 : 1);
    }
    close(ends[1]);
    size_t got = 0;
    ssize_t n = 1;
    while (child > 0 && got < sizeof out && n > 0) {
        n = read(ends[0], (char *)&out + got, sizeof out - got);
        got += n > 0 ? (size_t)n : 0;
    }
    close(ends[0]);
    struct rusage usage;
    if (child < 0 || wait4(child, NULL, 0, &usage) != child || got != sizeof out) {
        fprintf(stderr, "bench-laws: a measurement failed\n");
        exit(1);
    }
    if (out.error.status != HAFT_OK) {
        fprintf(stderr, "bench-laws: %s\n", out.error.message);
        exit(1);
    }
    out.megabytes = (double)usage.ru_maxrss / 1024;
    return out;
}

static void compare_with_floor(const haft_case *c, int rounds, double *floor_one) {
    printf("\nA beam's laws against bare transforms of as many points, median of %d\n", rounds);
    printf("%8s %12s %12s %10s %10s %10s %12s\n", "threads", "laws [s]", "floor [s]", "ratio",
           "least", "greatest", "peak [MiB]");
    for (int threads = 1; threads <= 2; threads++) {
        double time[ROUND_LIMIT], floor[ROUND_LIMIT], ratio[ROUND_LIMIT], peak = 0;
        for (int r = 0; r < rounds; r++) {
            floor[r] = apart(transform, c, threads).seconds;
            sample s = apart(build, c, threads);
            floor[r] += apart(transform, c, threads).seconds;
            time[r] = s.seconds;
            ratio[r] = time[r] / floor[r];
            peak = fmax(peak, s.megabytes);
        }
        double mid = median(ratio, rounds), base = median(floor, rounds);
        printf("%8d %12.3f %12.3f %10.2f %10.2f %10.2f %12.1f\n", threads, median(time, rounds),
               base, mid, ratio[0], ratio[rounds - 1], peak);
        if (threads == 1) {
            *floor_one = base;
        }
    }
}

/* ---- where the time goes ---- */

typedef struct bench {
    const haft_case *c;
    haft_contact_spec contact;
    haft_surface_plan *plan;
    haft_surface_work *surface;
    haft_contact_work *work;
    haft_maugis_table *maugis;
    size_t n;
    double *z, *distance, *force, *contact_area, *wet_area, *asperities;
} bench;

static void make_bench(bench *b, const haft_case *c, haft_error *error) {
    size_t points = rows_of(c) * columns_of(c);
    double span = c->contact.distance_to - c->contact.distance_from;
    b->c = c;
    b->n = (size_t)llround(span / c->contact.distance_step) + 1;
    must(haft_study_contact_spec(&b->contact, c, error), error);
    must(haft_maugis_table_create(&b->maugis, error), error);
    b->contact.maugis = b->maugis;
    must(haft_study_surface_plan(&b->plan, c, haft_study_block_patches(c), error), error);
    must(haft_surface_work_create(&b->surface, b->plan, error), error);
    must(haft_contact_work_create(&b->work, rows_of(c), columns_of(c), error), error);
    b->z = haft_memory_alloc(points + 5 * b->n, sizeof(double), error);
    must(b->z == NULL ? HAFT_ERROR_MEMORY : HAFT_OK, error);
    b->distance = b->z + points;
    b->force = b->distance + b->n;
    b->contact_area = b->force + b->n;
    b->wet_area = b->contact_area + b->n;
    b->asperities = b->wet_area + b->n;
    for (size_t i = 0; i < b->n; i++) {
        b->distance[i] = c->contact.distance_from + span * (double)i / (double)(b->n - 1);
    }
}

static double time_noise(const bench *b) {
    haft_surface_facts facts;
    haft_surface_get_facts(b->plan, &facts);
    double lattice = (double)facts.lattice_ratio * b->c->surface.grid_step;
    size_t halo = (size_t)(facts.reach / lattice + 0.5), ratio = facts.lattice_ratio;
    size_t rows = haft_study_block_patches(b->c) * rows_of(b->c) / ratio + 2 * halo;
    size_t columns = columns_of(b->c) / ratio + 2 * halo;
    haft_error error = {0};
    double *z = haft_memory_alloc(columns, sizeof *z, &error);
    must(z == NULL ? HAFT_ERROR_MEMORY : HAFT_OK, &error);
    double start = haft_clock_seconds();
    for (size_t i = 0; i < rows; i++) {
        haft_random_normals((haft_random_key){1, HAFT_RANDOM_TEST}, 0, i, 0, columns, z);
    }
    double time = haft_clock_seconds() - start;
    haft_memory_free(z);
    return time;
}

/* Times the same curve with van der Waals forces through water, for two asperity models. */
static void time_vdw(bench *b, haft_curve *curve, breakdown *t, haft_error *error) {
    const haft_case *c = b->c;
    haft_contact_spec spec = b->contact;
    haft_vdw_spec water = {.hamaker = 9.75e-20, .r0 = 2.09e-10};
    spec.has_vdw = true;
    must(haft_vdw_from_spec(&spec.vdw, &water, error), error);
    for (int k = 0; k < 2; k++) {
        spec.asperities = k == 0 ? HAFT_ASPERITY_ISLANDS : HAFT_ASPERITY_SUMMITS;
        double start = haft_clock_seconds();
        must(haft_contact_curve(b->work, &spec, b->z, rows_of(c), columns_of(c),
                                c->surface.grid_step, curve, error),
             error);
        *(k == 0 ? &t->vdw_islands : &t->vdw_summits) += haft_clock_seconds() - start;
    }
}

static void time_patch(bench *b, breakdown *t, haft_error *error) {
    const haft_case *c = b->c;
    haft_curve curve = {b->n, b->distance, b->force, b->contact_area, b->wet_area, b->asperities};
    time_vdw(b, &curve, t, error);
    b->contact.has_vdw = false;
    haft_asperity_model own = c->contact.asperities;
    haft_asperity_model other =
        own == HAFT_ASPERITY_SUMMITS ? HAFT_ASPERITY_ISLANDS : HAFT_ASPERITY_SUMMITS;
    for (int k = 0; k < 2; k++) { /* the case's own model last, since its curve is characterised */
        b->contact.asperities = k == 0 ? other : own;
        double start = haft_clock_seconds();
        must(haft_contact_curve(b->work, &b->contact, b->z, rows_of(c), columns_of(c),
                                c->surface.grid_step, &curve, error),
             error);
        bool summits = b->contact.asperities == HAFT_ASPERITY_SUMMITS;
        *(summits ? &t->summits : &t->islands) += haft_clock_seconds() - start;
    }
    haft_law_vector vector;
    haft_law law;
    double start = haft_clock_seconds();
    if (haft_law_characterise(b->n, b->distance, b->force, haft_case_limit(c), &vector) ==
        HAFT_LAW_SOUND) {
        haft_law_morse(&law, &vector, haft_case_limit(c));
    }
    haft_contact_zero_force(&curve);
    t->characterise += haft_clock_seconds() - start;
    size_t points = rows_of(c) * columns_of(c), above = 0;
    for (size_t i = 0; i < points; i++) {
        above += b->z[i] > b->distance[0];
    }
    t->above += (double)above / (double)points;
}

static void break_down(const haft_case *c, double floor) {
    bench b = {0};
    breakdown t = {0};
    haft_error error = {0};
    double start = haft_clock_seconds();
    make_bench(&b, c, &error);
    t.plan = haft_clock_seconds() - start;
    size_t patches = haft_study_block_patches(c), sites = sites_of(c), rows = rows_of(c);
    bool whole = c->law.sampler == HAFT_SAMPLER_EXPLICIT;
    for (size_t first = 0; first < sites; first += patches) {
        t.noise += time_noise(&b);
        start = haft_clock_seconds();
        must(haft_surface_prepare(b.surface, 0, whole ? 0 : first, whole ? (long)(first * rows) : 0,
                                  &error),
             &error);
        t.prepare += haft_clock_seconds() - start;
        for (size_t p = 0; p < patches && first + p < sites; p++) {
            start = haft_clock_seconds();
            must(haft_surface_rows(b.surface, p * rows, rows, b.z, &error), &error);
            t.rows += haft_clock_seconds() - start;
            time_patch(&b, &t, &error);
        }
    }
    double points = (double)sites * (double)rows * (double)columns_of(c);
    const struct {
        const char *name;
        double time;
    } part[] = {{"plan (once a case)", t.plan},         {"surface: prepare", t.prepare},
                {"  of it normals", t.noise},           {"surface: rows", t.rows},
                {"curve, islands", t.islands},          {"curve, summits", t.summits},
                {"  with vdW, islands", t.vdw_islands}, {"  with vdW, summits", t.vdw_summits},
                {"characterise", t.characterise},       {"floor", floor}};
    printf("\nWhere the time goes, one thread; %.2f %% of the points lie above the least "
           "distance\n",
           100 * t.above / (double)sites);
    printf("%-20s %10s %12s %12s\n", "part", "a beam [s]", "a point [ns]", "of the floor");
    for (size_t i = 0; i < sizeof part / sizeof *part; i++) {
        printf("%-20s %10.3f %12.3f %12.3f\n", part[i].name, part[i].time,
               1e9 * part[i].time / points, part[i].time / floor);
    }
    double patch = t.prepare + t.rows;
    printf("a patch with van der Waals forces over one without: islands %.2f, summits %.2f\n",
           (patch + t.vdw_islands) / (patch + t.islands),
           (patch + t.vdw_summits) / (patch + t.summits));
    haft_memory_free(b.z);
    haft_maugis_table_destroy(&b.maugis);
    haft_contact_work_destroy(&b.work);
    haft_surface_work_destroy(&b.surface);
    haft_surface_plan_destroy(&b.plan);
}

/* ---- a whole beam ---- */

/* Builds the laws and follows the path of a beam. The time of the path goes into `zero_distance`,
 * the crack length into `e`. */
static void follow(const haft_case *c, int threads, sample *out) {
    haft_laws *laws = NULL;
    haft_site_laws *sites = NULL;
    haft_model *model = NULL;
    haft_path *path = NULL;
    haft_summary summary = {0};
    omp_set_num_threads(threads);
    double start = haft_clock_seconds();
    haft_status status = haft_study_build_laws(&laws, c, NULL, &out->error);
    out->seconds = haft_clock_seconds() - start;
    start = haft_clock_seconds();
    HAFT_THEN(status, haft_model_create_beam(&model, &c->beam, &c->mesh, &out->error));
    HAFT_THEN(status, haft_study_site_laws(&sites, c, laws, 0, &out->error));
    HAFT_THEN(status, haft_study_realize(&path, &summary, c, model, sites, false, &out->error));
    out->zero_distance = haft_clock_seconds() - start;
    out->e = summary.crack_length;
    haft_path_destroy(&path);
    haft_site_laws_destroy(&sites);
    haft_model_destroy(&model);
    haft_laws_destroy(&laws);
}

static void time_beam(const haft_case *base, int rounds) {
    static const haft_mesh_kind mesh[] = {HAFT_MESH_EXACT, HAFT_MESH_ACTIVE};
    printf("\nA beam of %g um in all, its laws and its path, one thread, median of %d\n",
           1e6 * base->beam.length, rounds);
    printf("%-22s %8s %10s %10s %10s %14s\n", "laws of", "sites", "laws [s]", "path [s]", "all [s]",
           "crack [um]");
    for (int i = 0; i < 2; i++) {
        double laws[ROUND_LIMIT], path[ROUND_LIMIT], crack = NAN;
        haft_case c = *base;
        c.mesh.kind = mesh[i];
        for (int r = 0; r < rounds; r++) {
            sample s = apart(follow, &c, 1);
            laws[r] = s.seconds;
            path[r] = s.zero_distance;
            crack = s.e;
        }
        double a = median(laws, rounds), b = median(path, rounds);
        printf("%-22s %8zu %10.2f %10.2f %10.2f %14.9f\n",
               i == 0 ? "every site" : "those that may touch", sites_of(&c), a, b, a + b,
               1e6 * crack);
    }
}

/* ---- speed against error ---- */

static void study_error(const haft_case *base) {
    static const double grid[GRIDS] = {10e-9, 5e-9, 2.5e-9};
    static const double tolerance[TOLERANCES] = {1e-4, 1e-5, 1e-6};
    sample s[GRIDS][TOLERANCES];
    int grids = 0;
    for (int g = 0; g < GRIDS; g++) {
        if (g > 0 && 4.5 * s[g - 1][TOLERANCES - 1].seconds > PATIENCE) {
            break;
        }
        for (int k = 0; k < TOLERANCES; k++) {
            haft_case c = *base;
            c.surface.grid_step = grid[g];
            c.surface.kernel_tolerance = tolerance[k];
            s[g][k] = apart(build, &c, 1);
        }
        grids++;
    }
    sample best = s[grids - 1][TOLERANCES - 1];
    printf("\nSpeed against error on one noise lattice, one thread; against the finest\n");
    printf("finest: mean e %.6f mJ/m2, f_max %.6f MPa, zero-force distance %.6f nm\n", 1e3 * best.e,
           1e-6 * best.f_max, 1e9 * best.zero_distance);
    printf("%9s %10s %11s %10s %10s %12s %8s %8s\n", "grid [nm]", "tolerance", "a beam [s]",
           "e [%]", "f_max [%]", "zero d [nm]", "sound", "[MiB]");
    for (int g = 0; g < grids; g++) {
        for (int k = 0; k < TOLERANCES; k++) {
            const sample *x = &s[g][k];
            printf("%9.1f %10.0e %11.2f %+10.4f %+10.4f %+12.5f %8zu %8.1f\n", 1e9 * grid[g],
                   tolerance[k], x->seconds, 100 * (x->e / best.e - 1),
                   100 * (x->f_max / best.f_max - 1), 1e9 * (x->zero_distance - best.zero_distance),
                   x->sound, x->megabytes);
        }
    }
}

int main(int count, char **arguments) {
    int rounds = 3, option = 0;
    size_t patches = 0;
    bool study = true;
    while ((option = getopt(count, arguments, "r:p:s")) != -1) {
        if (option == 'r') {
            rounds = atoi(optarg);
        } else if (option == 'p') {
            patches = (size_t)atol(optarg);
        } else if (option == 's') {
            study = false;
        } else {
            fprintf(stderr, "usage: bench-laws [-r rounds] [-p patches] [-s] [case directory]\n");
            return 2;
        }
    }
    rounds = rounds < 1 ? 1 : rounds > ROUND_LIMIT ? ROUND_LIMIT : rounds;
    const char *directory = optind < count ? arguments[optind] : "cases/delrio-rh85";
    char path[4096];
    snprintf(path, sizeof path, "%s/case.yaml", directory);
    haft_case *c = NULL;
    haft_error error = {0};
    must(haft_case_read(&c, path, &error), &error);
    c->realizations = 1;
    if (patches > 0) {
        c->beam.length = (double)patches * c->mesh.l_meso;
    }
    printf("%s: %zu patches of %zu x %zu points, grid %g nm, kernel tolerance %g, %s\n", c->name,
           sites_of(c), rows_of(c), columns_of(c), 1e9 * c->surface.grid_step,
           c->surface.kernel_tolerance,
           c->contact.asperities == HAFT_ASPERITY_SUMMITS   ? "summits"
           : c->contact.asperities == HAFT_ASPERITY_ISLANDS ? "islands"
                                                            : "fitted islands");
    double floor = 0;
    compare_with_floor(c, rounds, &floor);
    break_down(c, floor);
    if (patches == 0) { /* a shortened beam has no crack of that length */
        time_beam(c, rounds);
    }
    if (study) {
        study_error(c);
    }
    haft_case_destroy(&c);
    return 0;
}
