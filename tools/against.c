/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares a run with another one, the reference: as a table, as JSON, and as data for a figure. */
#include "against.h"

#include "summary_report.h"

#include "haft/study_report.h"

#include <math.h>
#include <stdio.h>

typedef struct side {
    haft_case *c;
    haft_results_view *view;
    haft_statistics statistics;
} side;

static void close_side(side *s) {
    haft_results_view_destroy(&s->view);
    haft_case_destroy(&s->c);
}

/* Opens a finished run. `own` is its case, where the caller has it already. */
static haft_status open_side(side *s, const haft_case *own, const char *folder, haft_error *error) {
    char path[PATH_CAPACITY];
    *s = (side){0};
    haft_status status = own == NULL ? read_case(&s->c, folder, error) : HAFT_OK;
    const haft_case *c = own == NULL ? s->c : own;
    if (status == HAFT_OK && c->sweep.keys > 0) {
        status = haft_error_set(error, HAFT_ERROR_INPUT,
                                "%s holds a sweep; what is compared is one case, as %s/out/%s",
                                folder, folder, c->sweep.label);
    }
    HAFT_THEN(status, case_out_path(path, folder, "results.h5", error));
    HAFT_THEN(status, read_results(&s->view, c, path, error));
    if (status == HAFT_OK) {
        s->statistics = haft_study_statistics(c, s->view->summary, s->view->realizations);
    } else {
        close_side(s);
    }
    return status;
}

static void print_text(const side *reference, const side *this, const haft_difference *d) {
    const haft_statistics *r = &reference->statistics, *s = &this->statistics;
    printf("\n%-30s %10s %10s %9s %7s\n", "crack length at rest [um]", "reference", "this", "shift",
           "s.e.");
    printf("  %-28s %10zu %10zu\n", "beams that stuck", r->stuck, s->stuck);
    printf("  %-28s %10zu %10zu\n", "free", r->free, s->free);
    printf("  %-28s %10.2f %10.2f %+9.2f %7.2f\n", "mean", r->mean * 1e6, s->mean * 1e6,
           d->difference * 1e6, d->mean_error * 1e6);
    printf("  %-28s %10.2f %10.2f %+9.2f %7.2f\n", "standard deviation", r->deviation * 1e6,
           s->deviation * 1e6, d->deviation_shift * 1e6, d->deviation_error * 1e6);
    printf("  Kolmogorov-Smirnov distance %.4f; with a chance of %.2g as great between samples of "
           "one law\n",
           d->distance, d->p_value);
    printf("  Wasserstein-1 distance %.2f um, standard error %.2f; %.2f on average between samples "
           "of one law\n",
           d->w1 * 1e6, d->w1_error * 1e6, d->w1_by_chance * 1e6);
}

static void print_json(const side *reference, const side *this, const haft_difference *d) {
    const haft_statistics *r = &reference->statistics, *s = &this->statistics;
    printf("{\n  \"reference_stuck\": %zu,\n  \"stuck\": %zu,\n  \"reference_free\": %zu,\n  "
           "\"free\": %zu,\n",
           r->stuck, s->stuck, r->free, s->free);
    const struct {
        const char *key;
        double value;
    } numbers[] = {{"reference_crack_length_mean_m", r->mean},
                   {"crack_length_mean_m", s->mean},
                   {"mean_shift_m", d->difference},
                   {"mean_shift_standard_error_m", d->mean_error},
                   {"reference_crack_length_deviation_m", r->deviation},
                   {"crack_length_deviation_m", s->deviation},
                   {"deviation_shift_m", d->deviation_shift},
                   {"deviation_shift_standard_error_m", d->deviation_error},
                   {"kolmogorov_smirnov", d->distance},
                   {"kolmogorov_smirnov_chance", d->p_value},
                   {"wasserstein_m", d->w1},
                   {"wasserstein_standard_error_m", d->w1_error},
                   {"wasserstein_by_chance_m", d->w1_by_chance}};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        print_json_number(numbers[i].key, numbers[i].value, ",");
    }
    print_json_number("seconds_per_beam", s->seconds, "");
    printf("}\n");
}

int tell_against(const haft_case *c, const char *case_folder, const char *reference, bool json,
                 terminal *t) {
    haft_error error = {0};
    haft_difference d;
    side r = {0}, s = {0};
    haft_status status = open_side(&s, c, case_folder, &error);
    HAFT_THEN(status, open_side(&r, NULL, reference, &error));
    if (status == HAFT_OK && (r.statistics.stuck < 2 || s.statistics.stuck < 2)) {
        status = haft_error_set(&error, HAFT_ERROR_INPUT,
                                "a comparison needs two beams that stuck on either side; there are "
                                "%zu, and %zu of the reference",
                                s.statistics.stuck, r.statistics.stuck);
    }
    HAFT_THEN(status, haft_study_differ(&d, r.c, r.view->summary, r.view->realizations, c,
                                        s.view->summary, s.view->realizations, &error));
    if (status == HAFT_OK) {
        (json ? print_json : print_text)(&r, &s, &d);
    }
    close_side(&r);
    close_side(&s);
    return status == HAFT_OK ? EXIT_OK : terminal_fail(t, status, &error);
}

haft_status write_against(char title[HAFT_TEXT_CAPACITY], const char *reference, const char *folder,
                          haft_error *error) {
    char path[PATH_CAPACITY];
    side r;
    HAFT_TRY(open_side(&r, NULL, reference, error));
    snprintf(title, HAFT_TEXT_CAPACITY, "%s", r.c->title);
    haft_status status = case_path(path, folder, "reference_summary.csv", error);
    HAFT_THEN(status, haft_study_write_summary(r.view->summary, r.view->realizations, path, error));
    HAFT_THEN(status, case_path(path, folder, "reference_convergence.csv", error));
    HAFT_THEN(status, haft_study_write_convergence(r.c, r.view->summary, r.view->realizations, path,
                                                   error));
    close_side(&r);
    return status;
}
