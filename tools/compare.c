/* SPDX-License-Identifier: GPL-3.0-or-later */
/* haft compare: compares the statistics of each case with those of the first, and draws the
 * distributions. */
#include "compare.h"

#include "draw.h"

#include "haft/study_report.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* One run. */
typedef struct entry {
    char label[160];
    haft_case *c;
    haft_results_view *view;
    haft_statistics statistics;
    haft_difference against; /* from the first run */
} entry;

typedef struct entries {
    size_t count, capacity;
    entry *entry;
} entries;

/* ---- reading ---- */

static haft_status make_room(entries *all, size_t wanted, haft_error *error) {
    if (wanted <= all->capacity) {
        return HAFT_OK;
    }
    entry *more = haft_memory_alloc(wanted, sizeof *more, error);
    if (more == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    if (all->count > 0) {
        memcpy(more, all->entry, all->count * sizeof *more);
    }
    haft_memory_free(all->entry);
    all->entry = more;
    all->capacity = wanted;
    return HAFT_OK;
}

/* Makes a label: the last part of the folder's path and, for a variant of a sweep, its name,
 * without spaces or quotes. */
static void make_label(entry *e, const char *folder) {
    size_t end = strlen(folder);
    while (end > 1 && folder[end - 1] == '/') {
        end--;
    }
    size_t start = end;
    while (start > 0 && folder[start - 1] != '/') {
        start--;
    }
    bool swept = e->c->sweep.keys > 0;
    snprintf(e->label, sizeof e->label, "%.*s%s%s", (int)(end - start < 60 ? end - start : 60),
             folder + start, swept ? "/" : "", swept ? e->c->sweep.label : "");
    for (char *at = e->label; *at != '\0';) {
        char spelled[HAFT_SPELLED_CAPACITY];
        size_t n = haft_text_spell(spelled, at, strlen(at));
        bool plain = n > 1 ? strncmp(spelled, at, n) == 0
                           : isalnum((unsigned char)*at) || strchr("_-+./%", *at) != NULL;
        memset(at, '_', plain ? 0 : n);
        at += n;
    }
}

static haft_status read_entry(entry *e, const char *folder, size_t variant, haft_error *error) {
    char yaml[PATH_CAPACITY], inside[PATH_CAPACITY], results[PATH_CAPACITY];
    haft_status status = case_path(yaml, folder, "case.yaml", error);
    HAFT_THEN(status, haft_case_read_variant(&e->c, yaml, variant, error));
    if (status == HAFT_OK && e->c->sweep.keys > 0) {
        status = case_out_path(inside, folder, e->c->sweep.label, error);
        folder = inside;
    }
    HAFT_THEN(status, case_out_path(results, folder, "results.h5", error));
    HAFT_THEN(status, read_own_results(&e->view, e->c, results, error));
    if (status == HAFT_OK) {
        e->statistics = haft_study_statistics(e->c, e->view->summary, e->view->realizations);
    }
    return status;
}

static haft_status read_folder(entries *all, const char *folder, haft_error *error) {
    haft_case *c = NULL;
    HAFT_TRY(read_case(&c, folder, error));
    size_t variants = c->sweep.variants;
    haft_case_destroy(&c);
    haft_status status = make_room(all, all->count + variants, error);
    for (size_t i = 0; i < variants && status == HAFT_OK; i++) {
        entry *e = &all->entry[all->count++];
        status = read_entry(e, folder, i, error);
        if (status == HAFT_OK) {
            make_label(e, folder);
        }
    }
    return status;
}

static haft_status compare_all(entries *all, haft_error *error) {
    const entry *first = &all->entry[0];
    haft_status status = HAFT_OK;
    for (size_t i = 0; i < all->count && status == HAFT_OK; i++) {
        entry *e = &all->entry[i];
        status = haft_study_differ(&e->against, first->c, first->view->summary,
                                   first->view->realizations, e->c, e->view->summary,
                                   e->view->realizations, error);
    }
    return status;
}

static void drop(entries *all) {
    for (size_t i = 0; i < all->count; i++) {
        haft_case_destroy(&all->entry[i].c);
        haft_results_view_destroy(&all->entry[i].view);
    }
    haft_memory_free(all->entry);
}

/* ---- printing ---- */

static void print_cases(const entries *all) {
    printf("\n %3s %9s %-20s %8s %8s %6s %6s %-22s  %s\n", "", "crack", "interval [um]", "s. dev.",
           "Gamma", "stuck", "free", "probability to stick", "case");
    printf(" %3s %9s %-20s %8s %8s %6s %6s %-22s\n", "", "[um]", "", "[um]", "[mJ/m2]", "", "",
           "[%]");
    for (size_t i = 0; i < all->count; i++) {
        const haft_statistics *s = &all->entry[i].statistics;
        printf(" %3zu %9.2f %8.2f to %-8.2f %8.2f %8.3g %6zu %6zu %5.1f: %5.1f to %-5.1f   %s\n", i,
               s->mean * 1e6, s->mean_interval.low * 1e6, s->mean_interval.high * 1e6,
               s->deviation * 1e6, s->stuck > 0 ? s->gamma * 1e3 : NAN, s->stuck, s->free,
               100 * s->stuck_share, 100 * s->stuck_interval.low, 100 * s->stuck_interval.high,
               all->entry[i].label);
    }
}

static void print_differences(const entries *all) {
    const haft_difference *any = &all->entry[0].against;
    printf("\nagainst case 0, %.4g %% intervals: means as of independent beams; KS, the two-sample "
           "Kolmogorov-Smirnov test; pairs, beam by beam where the seed is the same\n",
           100 * any->confidence);
    printf(" %3s %29s %7s %9s %31s %7s %28s\n", "", "mean [um]", "KS", "p", "pairs [um]", "corr.",
           "stick [%]");
    for (size_t i = 1; i < all->count; i++) {
        const haft_difference *d = &all->entry[i].against;
        printf(" %3zu %+8.2f: %+8.2f to %+8.2f %7.3f %9.2g", i, d->difference * 1e6,
               d->difference_interval.low * 1e6, d->difference_interval.high * 1e6, d->distance,
               d->p_value);
        if (d->paired && d->pairs > 1) {
            printf("  %+8.2f: %+8.2f to %+8.2f %7.2f", d->pair_difference * 1e6,
                   d->pair_interval.low * 1e6, d->pair_interval.high * 1e6, d->correlation);
        } else {
            printf(" %31s %7s", "-", "-");
        }
        printf("  %+6.1f: %+6.1f to %+6.1f\n", 100 * d->share_difference,
               100 * d->share_interval.low, 100 * d->share_interval.high);
    }
}

enum { FACTS = 23 };

static void fill_facts(double row[FACTS], size_t i, const entry *e) {
    const haft_statistics *s = &e->statistics;
    const haft_difference *d = &e->against;
    double facts[FACTS] = {(double)i,
                           (double)s->run,
                           (double)s->stuck,
                           (double)s->free,
                           s->mean * 1e6,
                           s->mean_interval.low * 1e6,
                           s->mean_interval.high * 1e6,
                           s->deviation * 1e6,
                           s->stuck_share,
                           s->stuck_interval.low,
                           s->stuck_interval.high,
                           d->difference * 1e6,
                           d->difference_interval.low * 1e6,
                           d->difference_interval.high * 1e6,
                           d->distance,
                           d->p_value,
                           (double)d->pairs,
                           d->pair_difference * 1e6,
                           d->pair_interval.low * 1e6,
                           d->pair_interval.high * 1e6,
                           d->correlation,
                           d->share_interval.low,
                           d->share_interval.high};
    memcpy(row, facts, sizeof facts);
}

static haft_status save_table(const entries *all, const char *directory, haft_error *error) {
    static const char *const name[FACTS] = {"case",
                                            "beams",
                                            "stuck",
                                            "free",
                                            "mean [um]",
                                            "low [um]",
                                            "high [um]",
                                            "deviation [um]",
                                            "stuck share [1]",
                                            "share low [1]",
                                            "share high [1]",
                                            "difference [um]",
                                            "difference low [um]",
                                            "difference high [um]",
                                            "KS distance [1]",
                                            "p [1]",
                                            "pairs",
                                            "paired difference [um]",
                                            "paired low [um]",
                                            "paired high [um]",
                                            "correlation [1]",
                                            "share difference low [1]",
                                            "share difference high [1]"};
    char path[PATH_CAPACITY];
    haft_csv_column column[FACTS];
    double *flat = haft_memory_alloc(all->count * FACTS, sizeof *flat, error);
    haft_status status =
        flat == NULL ? HAFT_ERROR_MEMORY : case_path(path, directory, "compare.csv", error);
    for (size_t i = 0; i < all->count && status == HAFT_OK; i++) {
        fill_facts(flat + i * FACTS, i, &all->entry[i]);
    }
    if (status == HAFT_OK) {
        for (size_t j = 0; j < FACTS; j++) {
            column[j] = (haft_csv_column){name[j], flat + j, FACTS, 1};
        }
        status = haft_csv_write(path, all->count, FACTS, column, error);
    }
    haft_memory_free(flat);
    return status;
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Saves the empirical distributions: case, crack length, and the share of all beams followed whose
 * crack is at most that long. */
static haft_status save_distributions(const entries *all, const char *directory,
                                      haft_error *error) {
    char path[PATH_CAPACITY];
    size_t rows = 0, n = 0;
    for (size_t i = 0; i < all->count; i++) {
        rows += all->entry[i].statistics.stuck + 1;
    }
    double *flat = haft_memory_alloc(rows * 3, sizeof *flat, error);
    double *length = haft_memory_alloc(rows, sizeof *length, error);
    haft_status status = flat == NULL || length == NULL
                             ? HAFT_ERROR_MEMORY
                             : case_path(path, directory, "distributions.csv", error);
    for (size_t i = 0; i < all->count && status == HAFT_OK; i++) {
        const entry *e = &all->entry[i];
        size_t stuck = 0;
        for (size_t k = 0; k < e->view->realizations; k++) {
            if (e->view->summary[k].outcome == HAFT_OUTCOME_STUCK) {
                length[stuck++] = e->view->summary[k].crack_length;
            }
        }
        qsort(length, stuck, sizeof *length, by_size);
        double followed = (double)(e->statistics.stuck + e->statistics.free);
        for (size_t k = 0; k <= stuck && stuck > 0; k++) { /* row 0: the start, share zero */
            double row[3] = {(double)i, length[k > 0 ? k - 1 : 0] * 1e6, (double)k / followed};
            memcpy(flat + 3 * n++, row, sizeof row);
        }
    }
    if (status == HAFT_OK) {
        haft_csv_column column[3] = {{"case", flat, 3, 1},
                                     {"crack length [um]", flat + 1, 3, 1},
                                     {"share of the beams [1]", flat + 2, 3, 1}};
        status = haft_csv_write(path, n, 3, column, error);
    }
    haft_memory_free(flat);
    haft_memory_free(length);
    return status;
}

static haft_status draw_all(const entries *all, const char *directory, haft_error *error) {
    size_t size = all->count * (sizeof all->entry->label + 1);
    char *labels = haft_memory_alloc(size, 1, error);
    if (labels == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    size_t used = 0;
    for (size_t i = 0; i < all->count; i++) {
        used += (size_t)snprintf(labels + used, size - used, "%s\n", all->entry[i].label);
    }
    haft_status status =
        draw_comparison(labels, all->count, all->entry[0].statistics.confidence, directory, error);
    haft_memory_free(labels);
    return status;
}

static haft_status find_directory(char path[PATH_CAPACITY], const char *first,
                                  const char *directory, haft_error *error) {
    if (directory == NULL) {
        haft_status status = make_out_folder(first, "compare", error);
        return status == HAFT_OK ? case_out_path(path, first, "compare", error) : status;
    }
    int length = snprintf(path, PATH_CAPACITY, "%s", directory);
    if (length < 0 || length >= PATH_CAPACITY) {
        return haft_error_set(error, HAFT_ERROR_IO, "the path of the folder is too long");
    }
    if (mkdir(path, 0777) != 0 && errno != EEXIST) {
        return haft_error_set(error, HAFT_ERROR_IO, "%s: cannot make this folder: %s", path,
                              strerror(errno));
    }
    return HAFT_OK;
}

int compare_cases(size_t folders, char *const *folder, const char *directory, terminal *t) {
    haft_error error = {0};
    entries all = {0};
    char place[PATH_CAPACITY];
    haft_status status = HAFT_OK;
    for (size_t i = 0; i < folders && status == HAFT_OK; i++) {
        status = read_folder(&all, folder[i], &error);
    }
    if (status == HAFT_OK && all.count < 2) {
        status = haft_error_set(&error, HAFT_ERROR_INPUT,
                                "%s alone cannot be compared; give two cases or more, or one with "
                                "a sweep",
                                folder[0]);
    }
    HAFT_THEN(status, compare_all(&all, &error));
    if (status == HAFT_OK) {
        print_cases(&all);
        print_differences(&all);
        status = find_directory(place, folder[0], directory, &error);
    }
    HAFT_THEN(status, save_table(&all, place, &error));
    HAFT_THEN(status, save_distributions(&all, place, &error));
    HAFT_THEN(status, draw_all(&all, place, &error));
    drop(&all);
    if (status != HAFT_OK) {
        return terminal_fail(t, status, &error);
    }
    if (!t->quiet) {
        printf("\n");
        terminal_print(stdout, "tables and figure in %s", place);
    }
    return EXIT_OK;
}
