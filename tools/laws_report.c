/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints the statistics of a set of laws and the errors of its stochastic model. */
#include "laws_report.h"

#include <math.h>
#include <stdio.h>

/* Mean, deviation and range of one number over the laws that have it. */
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

/* Prints one line: Haft's numbers, and the reference's range if the case gives one. */
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
    bool share = laws->f_limit < 0;
    printf("  law vectors (push limit %.4g %s)\n", fabs(laws->f_limit) * (share ? 100 : 1e-6),
           share ? "% of f_max" : "MPa");
    print_spread("energy e [mJ/m2]", v[0], 1e3, NULL);
    print_spread("greatest pull f_max [MPa]", v[1], 1e-6, NULL);
    print_spread("its distance d_max [nm]", v[2], 1e9, NULL);
    print_spread("limit distance d_limit [nm]", v[3], 1e9, NULL);
}

/* Prints the energy of all stored curves, with or without a Morse law, and the misfit of the Morse
 * laws. Prints nothing if the laws were made of vectors without curves. */
static void print_curves(const haft_laws *laws) {
    spread misfit = {0}, energy = {0};
    for (size_t k = 0; k < laws->m; k++) {
        const double *curve = haft_laws_curve(laws, k);
        haft_law law;
        if (curve != NULL) {
            take(&energy, haft_law_energy(laws->n, laws->distance, curve));
        }
        if (curve != NULL && laws->fault[k] == HAFT_LAW_SOUND &&
            haft_law_morse(&law, &laws->vector[k], laws->f_limit) == HAFT_LAW_SOUND) {
            take(&misfit, haft_law_misfit(&law, laws->n, laws->distance, curve));
        }
    }
    if (laws->n > 0) {
        print_spread("energy of all curves [mJ/m2]", energy, 1e3, NULL);
        print_spread("misfit of the Morse law [%]", misfit, 100, NULL);
    }
}

/* Prints one number of each component in a row. */
static void print_row(const char *label, const double *value, size_t n, size_t stride,
                      const char *format) {
    printf("  %-44s", label);
    for (size_t j = 0; j < n; j++) {
        printf(format, value[j * stride]);
    }
    printf("\n");
}

static void print_distance(const char *law, const haft_chaos_distance *d, size_t n) {
    static const char *const label[] = {"Kolmogorov-Smirnov distance", "Wasserstein-1 [std. dev.]",
                                        "0.1 % quantile off by [std. dev.]",
                                        "99.9 % quantile off by [std. dev.]"};
    const double *first[] = {&d->ks, &d->w1, &d->low_quantile, &d->high_quantile};
    for (int i = 0; i < 4; i++) {
        char text[80];
        snprintf(text, sizeof text, "%s, from %s", label[i], law);
        print_row(text, first[i], n, sizeof *d / sizeof(double), i < 2 ? "%10.4f" : "%+10.3f");
    }
}

static void print_chaos(const haft_laws *laws) {
    haft_chaos_parts p;
    haft_chaos_get_parts(laws->chaos, &p);
    const haft_chaos_errors *e = &laws->errors;
    printf("  model of %zu vectors: %s bounds, %zu of %d components (%.3g %% of the variance left "
           "out),\n    %s kernels of bandwidth %.4f, germ %s, order %zu: %zu terms from %zu points "
           "a direction\n",
           p.m, haft_chaos_bounds_name(p.bounds), p.components, HAFT_CHAOS_DIMENSION,
           100 * e->reduction, haft_chaos_kernel_name(p.kernel), p.bandwidth,
           haft_chaos_germ_name(p.germ), p.order, p.terms, p.points);
    printf("  %-44s", "component");
    for (size_t j = 0; j < p.components; j++) {
        printf("%10zu", j + 1);
    }
    printf("\n");
    print_row("eigenvalue [1]", p.eigenvalue, p.components, 1, "%10.4g");
    print_row("relMISE by the projection's own rule", e->relmise_own, p.components, 1, "%10.2e");
    print_row("relMISE by an independent rule", e->relmise, p.components, 1, "%10.4f");
    print_row("variance of the kernel density", e->variance, p.components, 1, "%10.4f");
    print_row("share of it that the expansion lacks", e->variance_error, p.components, 1, "%10.4f");
    print_distance("kernels", e->kernel, p.components);
    print_distance("data", e->data, p.components);
    printf("  relMISE of all components: %.3e by its own rule, %.3e by an independent one (paper: "
           "5 %%)\n  drawn vectors without a Morse law: %.3g %%\n",
           e->relmise_own_total, e->relmise_total, 100 * e->outside);
}

void print_laws(const haft_laws *laws, const haft_case *c) {
    printf("%zu laws", laws->m);
    if (!haft_sampler_is_stochastic(c->law.sampler)) {
        printf(", %zu a beam", laws->sites);
        if (laws->first_site > 0) {
            printf(" (the first %zu sites never come into range)", laws->first_site);
        }
    }
    if (laws->n > 0) {
        printf(", on %zu distances from %.4g to %.4g nm", laws->n, laws->distance[0] * 1e9,
               laws->distance[laws->n - 1] * 1e9);
        if (laws->curves < laws->m) {
            printf("; %zu curves kept", laws->curves);
        }
        printf("\n");
        print_zero_force(laws, c);
    } else {
        printf(", vectors alone\n");
    }
    print_vectors(laws);
    print_curves(laws);
    size_t count[HAFT_LAW_FAULTS];
    haft_study_count_faults(laws, count);
    printf("  Morse law fits %zu of %zu", count[HAFT_LAW_SOUND], laws->m);
    for (int f = 1; f < HAFT_LAW_FAULTS; f++) {
        if (count[f] > 0) {
            printf("; %s: %zu", haft_law_fault_name((haft_law_fault)f), count[f]);
        }
    }
    printf("\n");
    if (laws->chaos != NULL) {
        print_chaos(laws);
    }
}

/* ---- study of the model ---- */

static void print_each(const double *value, size_t n, double unit, const char *format) {
    for (size_t j = 0; j < n; j++) {
        printf(format, unit * value[j]);
    }
}

static double worst_of(const double *value, size_t n) {
    double worst = 0;
    for (size_t j = 0; j < n; j++) {
        worst = fmax(worst, fabs(value[j]));
    }
    return worst;
}

static void print_orders(const haft_order_error *o, size_t n, const haft_chaos_parts *p) {
    printf(
        "Expansions of %zu vectors in %zu components; relMISE by %d maps, in all and by component "
        "[%%];\nown: by the projection's own rule [%%]; lacks: share of the variance, the worst "
        "component's [%%]\n",
        p->m, p->components, HAFT_STUDY_MAPS);
    printf("  %-9s %5s %6s %9s %9s %9s  %s\n", "germ", "N_d", "terms", "own", "relMISE", "lacks",
           "by component");
    for (size_t i = 0; i < n; i++) {
        const haft_chaos_errors *e = &o[i].errors;
        printf("  %-9s %5zu %6zu %9.4f %9.3f %9.2f ", haft_chaos_germ_name(o[i].germ), o[i].order,
               o[i].terms, 100 * e->relmise_own_total, 100 * e->relmise_total,
               100 * worst_of(e->variance_error, p->components));
        print_each(e->relmise, p->components, 100, " %8.3f");
        printf("\n");
    }
}

static void print_parts(const haft_vectors_error *v, size_t n, const haft_chaos_parts *p) {
    printf("\nModels of m of the vectors, mean over disjoint parts; density: relMISE of the kernel "
           "density\nof each component against that of all vectors, with its standard error [%%]; "
           "distance: Wasserstein-1,\nof the expansion's components from all vectors' [std. dev.]; "
           "own map: relMISE of the expansion [%%]\n");
    printf("  %6s %6s  %-*s  %-*s %9s\n", "m", "parts", (int)(17 * p->components), "density",
           (int)(8 * p->components), "distance", "own map");
    for (size_t i = 0; i < n; i++) {
        printf("  %6zu %6zu ", v[i].m, v[i].parts);
        for (size_t j = 0; j < p->components; j++) {
            char error[16] = "-";
            if (isfinite(v[i].density_error[j])) {
                snprintf(error, sizeof error, "%.3f", 100 * v[i].density_error[j]);
            }
            printf(" %7.3f +- %-5s", 100 * v[i].density[j], error);
        }
        printf(" ");
        print_each(v[i].w1, p->components, 1, " %7.4f");
        printf(" %9.3f\n", 100 * v[i].relmise);
    }
}

haft_status print_study(const haft_laws *laws, const haft_case *c, haft_error *error) {
    enum { ROWS = HAFT_STUDY_ORDER_ROWS };
    haft_order_error o[ROWS];
    haft_vectors_error v[HAFT_STUDY_PARTS];
    size_t m[HAFT_STUDY_PARTS];
    haft_chaos_parts p;
    if (laws->chaos == NULL) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "these laws hold no stochastic model to study; set law.sampler: gpce, "
            "exact, kernel, bootstrap or mean");
    }
    haft_chaos_get_parts(laws->chaos, &p);
    haft_study_list_orders(o);
    haft_status status = haft_study_model_orders(laws, c, ROWS, o, error);
    if (status == HAFT_OK) {
        print_orders(o, ROWS, &p);
        size_t n = haft_study_model_parts(laws, m);
        status = haft_study_model_vectors(laws, c, n, m, v, error);
        if (status == HAFT_OK) {
            print_parts(v, n, &p);
        }
    }
    return status;
}
