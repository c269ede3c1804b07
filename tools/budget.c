/* SPDX-License-Identifier: GPL-3.0-or-later */
/* haft budget: the library measures the error budget; this file prints it as a table. */
#include "report.h"

#include "haft/study_report.h"

#include <math.h>
#include <stdio.h>

static void print_term(const haft_budget_term *t) {
    if (!t->measured) {
        printf("  %-24s %9s %8s %6s %7s  %s\n", t->name, "-", "-", "-", "-", t->change);
        return;
    }
    printf("  %-24s %+9.3f %8.3f %6zu ", t->name, t->shift * 1e6, t->half_width * 1e6, t->beams);
    if (isfinite(t->cost)) {
        printf("%7.2f", t->cost);
    } else {
        printf("%7s", "");
    }
    printf("  %s%s\n", t->change, t->paired ? "" : " (independent beams)");
}

static void print_budget(const haft_case *c, const haft_budget *b) {
    printf("\n");
    terminal_print(stdout, "%s", c->title);
    printf("mean crack length %.3f um over %zu beams; what each approximation moves it by:\n",
           b->mean * 1e6, b->beams);
    printf("  %-24s %9s %8s %6s %7s\n", "", "shift", "+-", "beams", "cost");
    printf("  %-24s %9s %8s %6s %7s\n", "", "[um]", "[um]", "", "[times]");
    for (size_t i = 0; i < b->count; i++) {
        print_term(&b->term[i]);
    }
    printf("  %-24s %9s %8.3f %6zu %7.2f  four times as many beams halve it\n", "sample count", "",
           b->sampling * 1e6, b->sampled, 4.0);
    printf("  %-24s %9.3f %8.3f %14s  sizes added, other models left out\n", "sum of refinements",
           b->total * 1e6, b->total_half_width * 1e6, "");
    print_term(&b->together);
    print_term(&b->interaction);
    printf("+- is the half width of a %.4g %% interval; cost that of a beam, laws included\n",
           100 * b->confidence);
}

/* Finds the sampling error of the whole run, if there are results of this very case. */
static bool find_headline(haft_statistics *s, const haft_case *c, const char *folder) {
    char path[PATH_CAPACITY];
    haft_results_view *view = NULL;
    bool found = case_out_path(path, folder, "results.h5", NULL) == HAFT_OK &&
                 read_own_results(&view, c, path, NULL) == HAFT_OK;
    if (found) {
        *s = haft_study_statistics(c, view->summary, view->realizations);
    }
    haft_results_view_destroy(&view);
    return found;
}

int budget_case(const haft_case *c, const char *folder, size_t beams, terminal *t) {
    haft_error error = {0};
    haft_budget budget;
    haft_statistics s;
    char path[PATH_CAPACITY], kept[PATH_CAPACITY];
    bool run = find_headline(&s, c, folder);
    haft_status status = make_out_folder(folder, "budget", &error);
    HAFT_THEN(status, case_out_path(kept, folder, "budget", &error));
    HAFT_THEN(status, case_out_path(path, folder, "budget.csv", &error));
    if (status == HAFT_OK) {
        haft_progress progress = terminal_progress(t);
        status = haft_study_budget(&budget, c, beams, run ? &s : NULL, kept, &progress, &error);
    }
    HAFT_THEN(status, haft_study_write_budget(&budget, c, path, &error));
    if (status != HAFT_OK) {
        return terminal_fail(t, status, &error);
    }
    print_budget(c, &budget);
    return EXIT_OK;
}
