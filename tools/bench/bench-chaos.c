/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the stochastic model costs and how good it is.
 *
 *     bench-chaos [-r rounds] [-m vectors] [-d order] [-n laws] [-w centres.csv] [-s] [laws.csv]
 *
 * Prints the time of the identification against a floor: bare libm erfc calls, one for each centre
 * at each Gauss point of each level of the map. No root finder on the exact conditionals could do
 * with fewer. (Haft's makes two or three evaluations, but leaves out centres of no weight.) Then
 * prints laws a second by sampler, and the errors by germ, kernel and order: on skewed synthetic
 * vectors, or on those of a laws.csv as haft run writes it. -s leaves the errors out. -w writes eta
 * and points of the inverse map for openturns-chaos. Uses one thread, unless OMP_NUM_THREADS says
 * otherwise. */
#include "bench.h"

#include "haft/chaos.h"

#include <math.h>
#include <omp.h>
#include <stdbool.h>
#include <string.h>
#include <unistd.h>

enum { ROUND_LIMIT = 99, LINE = 4096, COLUMN_LIMIT = 32 };

#define F_LIMIT 5e6

typedef struct data {
    size_t m;
    haft_law_vector *vector;
} data;

static void *grab(size_t count, size_t size) {
    haft_error error = {0};
    void *memory = haft_memory_alloc(count, size, &error);
    must(memory == NULL ? HAFT_ERROR_MEMORY : HAFT_OK, &error);
    return memory;
}

/* Makes skewed and dependent vectors, all within the strict bounds. */
static data make_data(size_t m) {
    data d = {m, grab(m, sizeof(haft_law_vector))};
    for (size_t k = 0; k < m; k++) {
        double z[4];
        haft_random_normals((haft_random_key){1, HAFT_RANDOM_TEST}, k, 0, 0, 4, z);
        haft_law_vector v = {.f_max = 4e5 * exp(0.25 * z[0] + 0.05 * z[0] * z[0]),
                             .d_max = 1.1e-8 + 5e-10 * (exp(0.3 * z[2]) + 0.5 * z[0])};
        double width = 3e-9 * exp(0.1 * z[1] - 0.05 * z[0]);
        v.d_limit = v.d_max - width;
        v.e = v.f_max * width / (2 * log(1 + sqrt(1 + F_LIMIT / v.f_max))) +
              2e-3 * exp(0.06 * z[3] + 0.24 * z[0] + 0.1 * z[2]);
        d.vector[k] = v;
    }
    return d;
}

static size_t split(char *line, char *field[COLUMN_LIMIT]) {
    size_t n = 0;
    line[strcspn(line, "\r\n")] = '\0';
    for (char *rest = line; rest != NULL && n < COLUMN_LIMIT;) {
        field[n++] = strsep(&rest, ",");
    }
    return n;
}

/* Reads those laws of a table that have a Morse law. Finds the columns by their names. */
static data read_data(const char *path) {
    static const char *const name[] = {"fault", "e [mJ/m2]", "f_max [MPa]", "d_max [nm]",
                                       "d_limit [nm]"};
    size_t at[5], capacity = 0, dropped = 0;
    char line[LINE], *field[COLUMN_LIMIT];
    data d = {0, NULL};
    FILE *file = fopen(path, "r");
    haft_error error = {0};
    if (file == NULL || fgets(line, sizeof line, file) == NULL) {
        must(haft_error_set(&error, HAFT_ERROR_IO, "%s: cannot be read", path), &error);
        return d;
    }
    size_t n = split(line, field);
    for (size_t i = 0; i < 5; i++) {
        for (at[i] = 0; at[i] < n && strcmp(field[at[i]], name[i]) != 0;) {
            at[i]++;
        }
        if (at[i] == n) {
            must(haft_error_set(&error, HAFT_ERROR_INPUT, "%s: no column %s", path, name[i]),
                 &error);
        }
    }
    while (fgets(line, sizeof line, file) != NULL) {
        if (d.m == capacity) {
            capacity = capacity == 0 ? 1024 : 2 * capacity;
            d.vector = realloc(d.vector, capacity * sizeof *d.vector);
        }
        haft_law law;
        n = split(line, field);
        double x[5] = {0};
        for (size_t i = 0; i < 5 && at[i] < n; i++) {
            x[i] = strtod(field[at[i]], NULL);
        }
        haft_law_vector v = {x[1] * 1e-3, x[2] * 1e6, x[3] * 1e-9, x[4] * 1e-9};
        bool sound = x[0] == 0 && haft_law_morse(&law, &v, F_LIMIT) == HAFT_LAW_SOUND;
        if (sound) {
            d.vector[d.m++] = v;
        } else {
            dropped++;
        }
    }
    fclose(file);
    printf("%s: %zu laws, %zu more without a Morse law left out\n", path, d.m, dropped);
    return d;
}

static haft_chaos *identify(const data *d, const haft_chaos_spec *spec, double *seconds) {
    haft_chaos *c = NULL;
    haft_error error = {0};
    double start = haft_clock_seconds();
    must(haft_chaos_create(&c, d->m, d->vector, spec, &error), &error);
    *seconds = haft_clock_seconds() - start;
    return c;
}

/* Times one erfc call for each centre at each point of each level. */
static double erfc_calls(const haft_chaos_parts *p) {
    double points = 0, level = 1;
    for (size_t i = 0; i < p->components; i++) {
        level *= (double)p->points;
        points += level;
    }
    return points * (double)p->m;
}

static double time_erfc(const haft_chaos_parts *p, double calls) {
    size_t g = p->components, looks = (size_t)(calls / (double)p->m);
    double sum = 0, factor = M_SQRT1_2 / p->bandwidth, start = haft_clock_seconds();
    for (size_t i = 0; i < looks; i++) {
        double x = 4.0 * ((double)i + 0.5) / (double)looks - 2;
        for (size_t k = 0; k < p->m; k++) {
            sum += erfc((x - p->centre[k * g + i % g]) * factor);
        }
    }
    double seconds = haft_clock_seconds() - start;
    if (!(sum > 0)) {
        printf("impossible\n");
    }
    return seconds;
}

static void compare_with_floor(const data *d, const haft_chaos_spec *base, int rounds) {
    printf("\nIdentification of %zu vectors, N_g = %zu, N_d = %zu, %d thread%s, median of %d\n",
           d->m, base->components, base->order, omp_get_max_threads(),
           omp_get_max_threads() > 1 ? "s" : "", rounds);
    printf("%-10s %12s %14s %12s %8s %8s %9s\n", "germ", "time [s]", "erfc [1e6]", "floor [s]",
           "ratio", "least", "greatest");
    for (int g = 0; g < 3; g++) {
        haft_chaos_spec spec = *base;
        double time[ROUND_LIMIT], floor[ROUND_LIMIT], ratio[ROUND_LIMIT], calls = 0;
        spec.germ = (haft_chaos_germ)g;
        for (int r = 0; r < rounds; r++) {
            haft_chaos *c = identify(d, &spec, &time[r]);
            haft_chaos_parts p;
            haft_chaos_get_parts(c, &p);
            calls = erfc_calls(&p);
            floor[r] = time_erfc(&p, calls);
            ratio[r] = time[r] / floor[r];
            haft_chaos_destroy(&c);
        }
        double mid = median(ratio, rounds);
        printf("%-10s %12.4f %14.2f %12.4f %8.2f %8.2f %9.2f\n", haft_chaos_germ_name(spec.germ),
               median(time, rounds), 1e-6 * calls, median(floor, rounds), mid, ratio[0],
               ratio[rounds - 1]);
    }
}

static void time_samplers(const data *d, const haft_chaos_spec *base, size_t laws) {
    haft_error error = {0};
    haft_law_vector *v = grab(laws, sizeof *v);
    printf("\nSampling, one thread\n%-10s %-10s %10s %12s %14s\n", "sampler", "germ", "laws",
           "time [s]", "laws a second");
    for (int s = 0; s <= HAFT_CHAOS_SAMPLER_MEAN; s++) {
        bool exact = s == HAFT_CHAOS_SAMPLER_EXACT;
        for (int g = 0; g < (s == HAFT_CHAOS_SAMPLER_GPCE ? 3 : 1); g++) {
            haft_chaos_spec spec = *base;
            haft_chaos_work *work = NULL;
            double unused;
            spec.germ = (haft_chaos_germ)g;
            haft_chaos *c = identify(d, &spec, &unused);
            must(haft_chaos_work_create(&work, c, &error), &error);
            size_t n = exact ? laws / 200 + 1 : laws;
            double start = haft_clock_seconds();
            must(haft_chaos_sample(c, work, (haft_chaos_sampler)s, 1, 0, 0, n, v, &error), &error);
            double seconds = haft_clock_seconds() - start;
            printf("%-10s %-10s %10zu %12.4f %14.3e\n",
                   haft_chaos_sampler_name((haft_chaos_sampler)s),
                   s == 0 ? haft_chaos_germ_name(spec.germ) : "-", n, seconds, (double)n / seconds);
            haft_chaos_work_destroy(&work);
            haft_chaos_destroy(&c);
        }
    }
    haft_memory_free(v);
}

/* Prints the errors of the worst component. */
static void print_errors(const haft_chaos_spec *s, size_t components, const haft_chaos_errors *x) {
    double variance = 0, ks = 0, w1 = 0, low = 0, high = 0, data_ks = 0;
    for (size_t j = 0; j < components; j++) {
        variance = fmax(variance, fabs(x->variance_error[j]));
        ks = fmax(ks, x->kernel[j].ks);
        w1 = fmax(w1, x->kernel[j].w1);
        low = fmax(low, fabs(x->kernel[j].low_quantile));
        high = fmax(high, fabs(x->kernel[j].high_quantile));
        data_ks = fmax(data_ks, x->data[j].ks);
    }
    printf("%-9s %-10s %5zu %6zu %10.4f %10.4f %10.3f %9.4f %9.4f %9.3f %9.3f %9.4f %8.3f\n",
           haft_chaos_germ_name(s->germ), haft_chaos_kernel_name(s->kernel), s->order,
           haft_chaos_terms(components, s->order), 100 * x->relmise_own_total,
           100 * x->relmise_total, 100 * variance, ks, w1, low, high, data_ks, 100 * x->outside);
}

static void study_errors(const data *d, const haft_chaos_spec *base) {
    printf("\nErrors of the expansion against the kernel density, by the worst component; sd: its\n"
           "standard deviations; own: by the projection's own rule; KS data: against the vectors;\n"
           "outside: laws that are none\n");
    printf("%-9s %-10s %5s %6s %10s %10s %10s %9s %9s %9s %9s %9s %8s\n", "germ", "kernel", "N_d",
           "terms", "own [%]", "relMISE[%]", "var. [%]", "KS [1]", "W1 [sd]", "q.001[sd]",
           "q.999[sd]", "KS data", "out [%]");
    for (int g = 0; g < 3; g++) {
        for (int k = 0; k < 2; k++) {
            for (size_t order = 4; order <= 14; order += 2) {
                haft_chaos_spec spec = *base;
                haft_chaos_errors errors;
                haft_error error = {0};
                double unused;
                spec.germ = (haft_chaos_germ)g;
                spec.kernel = (haft_chaos_kernel)k;
                spec.order = order;
                haft_chaos *c = identify(d, &spec, &unused);
                must(haft_chaos_measure(c, &(haft_chaos_effort){2048, 0}, &errors, &error), &error);
                print_errors(&spec, spec.components, &errors);
                haft_chaos_destroy(&c);
            }
        }
    }
    printf("\nBy bounds: laws that are none among the expansion's, and the variance of q in the\n"
           "components left out; N_d = %zu\n%-10s %12s %12s\n",
           base->order, "bounds", "none [%]", "left out [%]");
    for (int b = 0; b < 2; b++) {
        haft_chaos_spec spec = *base;
        haft_chaos_errors errors;
        haft_error error = {0};
        double unused;
        spec.bounds = (haft_chaos_bounds)b;
        haft_chaos *c = identify(d, &spec, &unused);
        must(haft_chaos_measure(c, &(haft_chaos_effort){1, 0}, &errors, &error), &error);
        printf("%-10s %12.4f %12.4f\n", haft_chaos_bounds_name(spec.bounds), 100 * errors.outside,
               100 * errors.reduction);
        haft_chaos_destroy(&c);
    }
}

/* The quadrature rule of the projection aliases terms that it does not resolve into the
 * coefficients. This study shows what more points than the order needs cost, and how much they
 * reduce the error. */
static void study_points(const data *d, const haft_chaos_spec *base) {
    printf("\nGauss points a direction, N_d = %zu\n%-9s %7s %10s %10s %10s %10s %9s\n", base->order,
           "germ", "points", "time [s]", "own [%]", "relMISE[%]", "var. [%]", "KS [1]");
    for (int g = 0; g < 3; g++) {
        for (size_t half = 2; half <= 4; half++) {
            haft_chaos_spec spec = *base;
            haft_chaos_errors errors;
            haft_error error = {0};
            double seconds, variance = 0, ks = 0;
            spec.germ = (haft_chaos_germ)g;
            spec.points = half * (spec.order + 1) / 2;
            haft_chaos *c = identify(d, &spec, &seconds);
            must(haft_chaos_measure(c, &(haft_chaos_effort){8192, 0}, &errors, &error), &error);
            haft_chaos_destroy(&c);
            for (size_t j = 0; j < spec.components; j++) {
                variance = fmax(variance, fabs(errors.variance_error[j]));
                ks = fmax(ks, errors.kernel[j].ks);
            }
            printf("%-9s %7zu %10.3f %10.4f %10.4f %10.3f %9.4f\n", haft_chaos_germ_name(spec.germ),
                   spec.points, seconds, 100 * errors.relmise_own_total, 100 * errors.relmise_total,
                   100 * variance, ks);
        }
    }
}

/* Writes the centres, then points: xi and the eta that the inverse map gives there. */
static void write_points(const data *d, const haft_chaos_spec *base, const char *path) {
    enum { POINTS = 200 };
    haft_error error = {0};
    haft_chaos_work *work = NULL;
    haft_chaos_parts p;
    double unused;
    haft_chaos *c = identify(d, base, &unused);
    haft_chaos_get_parts(c, &p);
    must(haft_chaos_work_create(&work, c, &error), &error);
    FILE *file = fopen(path, "w");
    if (file == NULL) {
        must(haft_error_set(&error, HAFT_ERROR_IO, "%s: cannot be written", path), &error);
        return;
    }
    fprintf(file, "bandwidth,%.17g,components,%zu\n", p.bandwidth, p.components);
    for (size_t k = 0; k < p.m; k++) {
        fprintf(file, "centre");
        for (size_t j = 0; j < p.components; j++) {
            fprintf(file, ",%.17g", p.centre[k * p.components + j]);
        }
        fputc('\n', file);
    }
    double spent = 0;
    for (size_t k = 0; k < POINTS; k++) {
        uint64_t words[4];
        double xi[4], eta[4];
        haft_random_words((haft_random_key){2, HAFT_RANDOM_TEST}, k, 0, 0, words);
        for (size_t i = 0; i < p.components; i++) {
            xi[i] = haft_random_uniform(words[i]);
        }
        double start = haft_clock_seconds();
        must(haft_chaos_inverse(c, work, xi, NULL, eta, &error), &error);
        spent += haft_clock_seconds() - start;
        fprintf(file, "point");
        for (size_t i = 0; i < 2 * p.components; i++) {
            fprintf(file, ",%.17g", i < p.components ? xi[i] : eta[i - p.components]);
        }
        fputc('\n', file);
    }
    fclose(file);
    printf("\n%s: %d points of the inverse map, %.3f ms each\n", path, POINTS,
           1e3 * spent / POINTS);
    haft_chaos_work_destroy(&work);
    haft_chaos_destroy(&c);
}

int main(int count, char **arguments) {
    int rounds = 5, option = 0;
    size_t m = 5000, order = 12, laws = 1000000;
    const char *points = NULL;
    bool study = true;
    while ((option = getopt(count, arguments, "r:m:d:n:w:s")) != -1) {
        switch (option) {
        case 'r':
            rounds = atoi(optarg);
            break;
        case 'm':
            m = (size_t)atol(optarg);
            break;
        case 'd':
            order = (size_t)atol(optarg);
            break;
        case 'n':
            laws = (size_t)atol(optarg);
            break;
        case 'w':
            points = optarg;
            break;
        case 's':
            study = false;
            break;
        default:
            fprintf(stderr, "usage: bench-chaos [-r rounds] [-m vectors] [-d order] [-n laws] "
                            "[-w centres.csv] [-s] [laws.csv]\n");
            return 2;
        }
    }
    rounds = rounds < 1 ? 1 : rounds > ROUND_LIMIT ? ROUND_LIMIT : rounds;
    if (getenv("OMP_NUM_THREADS") == NULL) {
        omp_set_num_threads(1);
    }
    data d = optind < count ? read_data(arguments[optind]) : make_data(m);
    haft_chaos_spec spec = {.f_limit = F_LIMIT, .components = 3, .order = order};
    compare_with_floor(&d, &spec, rounds);
    time_samplers(&d, &spec, laws);
    if (points != NULL) {
        write_points(&d, &spec, points);
    }
    if (study) {
        study_errors(&d, &spec);
        study_points(&d, &spec);
    }
    if (optind < count) {
        free(d.vector);
    } else {
        haft_memory_free(d.vector);
    }
    return 0;
}
