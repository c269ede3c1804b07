/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs a sweep. Its variants are cases of their own under CASE/out. They run one after another, and
 * each can be inspected, drawn or run again alone. Laws of the same patches are built together
 * beforehand, since the surfaces are most of their cost. */
#include "sweep.h"

#include "draw.h"
#include "run.h"
#include "summary_report.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* The variants, and their results. */
typedef struct sweep {
    size_t variants;
    haft_case **c;
    haft_variant *variant;
    char (*inputs)[HAFT_DIGEST_CAPACITY]; /* digest of the inputs of each variant's laws */
} sweep;

static void close_sweep(sweep *s) {
    for (size_t i = 0; s->c != NULL && i < s->variants; i++) {
        haft_case_destroy(&s->c[i]);
    }
    haft_memory_free(s->c);
    haft_memory_free(s->variant);
    haft_memory_free(s->inputs);
}

static haft_status open_sweep(sweep *s, const haft_case *first, const char *folder,
                              haft_error *error) {
    char path[PATH_CAPACITY];
    size_t n = first->sweep.variants;
    *s = (sweep){.variants = n,
                 .c = haft_memory_alloc(n, sizeof *s->c, error),
                 .variant = haft_memory_alloc(n, sizeof *s->variant, error),
                 .inputs = haft_memory_alloc(n, sizeof *s->inputs, error)};
    haft_status status = s->c && s->variant && s->inputs ? HAFT_OK : HAFT_ERROR_MEMORY;
    HAFT_THEN(status, case_path(path, folder, "case.yaml", error));
    for (size_t i = 0; i < n && status == HAFT_OK; i++) {
        status = haft_case_read_variant(&s->c[i], path, i, error);
        s->variant[i].c = s->c[i];
        HAFT_THEN(status, haft_case_laws_digest(s->c[i], s->inputs[i], error));
    }
    if (status != HAFT_OK) {
        close_sweep(s);
    }
    return status;
}

/* Whether the laws of variant i, or how they are used, differ from those of all earlier
 * variants. */
static bool has_new_laws(const sweep *s, size_t i) {
    for (size_t k = 0; k < i; k++) {
        const haft_case *a = s->c[k], *b = s->c[i];
        if (strcmp(s->inputs[k], s->inputs[i]) == 0 && a->law.kind == b->law.kind &&
            a->law.unfit == b->law.unfit) {
            return false;
        }
    }
    return true;
}

haft_status check_sweep(const haft_case *c, const char *folder, haft_error *error) {
    sweep s;
    haft_status status = open_sweep(&s, c, folder, error);
    if (status != HAFT_OK) {
        return status;
    }
    for (size_t i = 0; i < s.variants && status == HAFT_OK; i++) {
        status = haft_study_check(s.c[i], has_new_laws(&s, i), error);
        if (status != HAFT_OK) {
            haft_error_prefix(error, "variant %s: ", s.c[i]->sweep.label);
        }
    }
    close_sweep(&s);
    return status;
}

static haft_status variant_folder(char path[PATH_CAPACITY], const char *folder, const haft_case *c,
                                  haft_error *error) {
    return case_out_path(path, folder, c->sweep.label, error);
}

/* Makes the path of variant i's laws. */
static bool laws_path(char path[PATH_CAPACITY], const sweep *s, size_t i, const char *folder) {
    char variant[PATH_CAPACITY];
    return variant_folder(variant, folder, s->c[i], NULL) == HAFT_OK &&
           case_out_path(path, variant, "laws.h5", NULL) == HAFT_OK;
}

/* Whether the laws at `path` are those of variant i. */
static bool has_laws(const sweep *s, size_t i, const char *path) {
    char digest[HAFT_DIGEST_CAPACITY], origin[HAFT_DIGEST_CAPACITY], wanted[HAFT_DIGEST_CAPACITY];
    return access(path, R_OK) == 0 && haft_laws_peek(digest, origin, path, NULL) == HAFT_OK &&
           haft_laws_identify(wanted, s->c[i], origin, NULL) == HAFT_OK &&
           strcmp(digest, wanted) == 0;
}

/* Makes `to` a second name of the file `from`, and replaces what was there, all or nothing. */
static void link_over(const char *from, const char *to) {
    char temporary[PATH_CAPACITY];
    int length = snprintf(temporary, sizeof temporary, "%s.tmp.%ld", to, (long)getpid());
    if (length > 0 && (size_t)length < sizeof temporary && link(from, temporary) == 0 &&
        rename(temporary, to) != 0) {
        unlink(temporary);
    }
}

/* Gives variant i the laws of an earlier variant with the same inputs. Both share one file; this is
 * safe, since laws are replaced, never changed. If sharing fails, the variant builds its laws
 * itself, with the same bits. */
static void take_over_laws(const sweep *s, size_t i, const char *folder) {
    char from[PATH_CAPACITY], to[PATH_CAPACITY];
    if (!laws_path(to, s, i, folder) || has_laws(s, i, to)) {
        return;
    }
    for (size_t k = 0; k < i; k++) {
        if (strcmp(s->inputs[k], s->inputs[i]) == 0 && laws_path(from, s, k, folder) &&
            has_laws(s, i, from)) {
            link_over(from, to);
            return;
        }
    }
}

/* Whether the file contains exactly this text. */
static bool holds(const char *path, const char *text) {
    char *bytes = NULL;
    size_t size = 0, length = strlen(text);
    bool same = haft_file_read(&bytes, &size, path, length, NULL) == HAFT_OK && size == length &&
                memcmp(bytes, text, length) == 0;
    haft_memory_free(bytes);
    return same;
}

/* Writes a variant's case.yaml. A different case.yaml is not replaced, since there may be results
 * of it, unless everything is to be done anew. */
static haft_status write_variant(const haft_case *c, const char *path, haft_run_mode mode,
                                 haft_error *error) {
    char file[PATH_CAPACITY], *text = NULL;
    haft_status status = case_path(file, path, "case.yaml", error);
    HAFT_THEN(status, haft_case_emit(&text, c, error));
    if (status == HAFT_OK && !holds(file, text)) {
        status =
            mode != HAFT_RUN_ANEW && access(file, F_OK) == 0
                ? haft_error_set(error, HAFT_ERROR_EXISTS,
                                 "%s is of another case.yaml than there is now; put that back, "
                                 "or start anew with `haft run --force`",
                                 file)
                : haft_case_write(c, file, error);
    }
    haft_memory_free(text);
    return status;
}

/* Makes CASE/out/LABEL a case folder. */
static haft_status make_variant(const sweep *s, size_t i, const char *folder, haft_run_mode mode,
                                char path[PATH_CAPACITY], haft_error *error) {
    haft_status status = variant_folder(path, folder, s->c[i], error);
    if (haft_study_rank() != 0 || status != HAFT_OK) {
        return status;
    }
    status = make_out_folder(folder, s->c[i]->sweep.label, error);
    HAFT_THEN(status, write_variant(s->c[i], path, mode, error));
    HAFT_THEN(status, make_out_folder(path, NULL, error));
    if (status == HAFT_OK) {
        take_over_laws(s, i, folder);
    }
    return status;
}

/* Most memory for the curves of a group, which are all kept at once. */
#define GROUP_BYTES 1e9

/* Variants whose laws come from the same patches, and the paths of these laws. */
typedef struct group {
    size_t n;
    const haft_case **c;
    haft_laws **laws;
    char (*path)[PATH_CAPACITY];
} group;

static void close_group(group *g) {
    for (size_t i = 0; i < g->n; i++) {
        haft_laws_destroy(&g->laws[i]);
    }
    haft_memory_free(g->c);
    haft_memory_free(g->laws);
    haft_memory_free(g->path);
}

/* Whether a variant's laws come from patches and are still to be built; they go to `path`. */
static bool lacks_laws(const sweep *s, size_t i, const char *folder, haft_run_mode mode,
                       char path[PATH_CAPACITY]) {
    char variant[PATH_CAPACITY], results[PATH_CAPACITY];
    return haft_sampler_is_stochastic(s->c[i]->law.sampler) &&
           variant_folder(variant, folder, s->c[i], NULL) == HAFT_OK &&
           case_out_path(results, variant, "results.h5", NULL) == HAFT_OK &&
           (mode == HAFT_RUN_ANEW || access(results, F_OK) != 0) && laws_path(path, s, i, folder) &&
           !has_laws(s, i, path);
}

/* Whether a variant from `first` to i - 1 has the same laws as variant i, which then shares
 * them. */
static bool is_repeated(const sweep *s, size_t first, size_t i) {
    while (first < i && strcmp(s->inputs[first], s->inputs[i]) != 0) {
        first++;
    }
    return first < i;
}

/* Memory that the curves of a case's patches take, in bytes. */
static double bytes_of_curves(const haft_case *c) {
    double span = c->contact.distance_to - c->contact.distance_from;
    return sizeof(double) * (double)c->law.chaos.vectors * (span / c->contact.distance_step + 1);
}

/* Collects variant `first` and the later ones with the same patches, as many as memory allows. A
 * variant whose folder cannot be made is left out; its own run then reports the error. */
static void find_group(group *g, const sweep *s, size_t first, const char *folder,
                       haft_run_mode mode) {
    char wanted[HAFT_DIGEST_CAPACITY], digest[HAFT_DIGEST_CAPACITY], variant[PATH_CAPACITY];
    if (haft_case_patches_digest(s->c[first], wanted, NULL) != HAFT_OK) {
        return;
    }
    double bytes = 0;
    for (size_t i = first; i < s->variants; i++) {
        if (bytes + bytes_of_curves(s->c[i]) < GROUP_BYTES &&
            lacks_laws(s, i, folder, mode, g->path[g->n]) &&
            haft_case_patches_digest(s->c[i], digest, NULL) == HAFT_OK &&
            strcmp(digest, wanted) == 0 && !is_repeated(s, first, i) &&
            make_variant(s, i, folder, mode, variant, NULL) == HAFT_OK) {
            g->c[g->n++] = s->c[i];
            bytes += bytes_of_curves(s->c[i]);
        }
    }
}

/* Builds and saves the laws of a group. If it has one variant only, that variant's run builds
 * them. */
static haft_status build_group(group *g, terminal *t, haft_error *error) {
    if (g->n < 2) {
        return HAFT_OK;
    }
    char text[100];
    haft_progress progress = terminal_progress(t);
    terminal_close_line(t);
    snprintf(text, sizeof text, "building the laws of %zu variants at once, off the same patches",
             g->n);
    progress.note(progress.user, text);
    haft_status status = haft_study_build_laws_together(g->laws, g->c, g->n, &progress, error);
    for (size_t i = 0; i < g->n && status == HAFT_OK; i++) {
        if (g->laws[i] != NULL) {
            status = haft_laws_write(g->laws[i], g->c[i], g->path[i], error);
        }
    }
    return status;
}

/* Called before variant i runs: builds its laws together with those of later variants that come
 * from the same patches. */
static haft_status build_together(const sweep *s, size_t i, const char *folder, haft_run_mode mode,
                                  terminal *t, haft_error *error) {
    char path[PATH_CAPACITY];
    if (!lacks_laws(s, i, folder, mode, path)) {
        return HAFT_OK;
    }
    group g = {.c = haft_memory_alloc(s->variants, sizeof *g.c, error),
               .laws = haft_memory_alloc(s->variants, sizeof *g.laws, error),
               .path = haft_memory_alloc(s->variants, sizeof *g.path, error)};
    haft_status status = g.c && g.laws && g.path ? HAFT_OK : HAFT_ERROR_MEMORY;
    if (status == HAFT_OK) {
        find_group(&g, s, i, folder, mode);
        status = build_group(&g, t, error);
    }
    close_group(&g);
    return status;
}

/* A variant that was never begun has nothing to resume. */
static haft_run_mode mode_of(haft_run_mode mode, const char *variant) {
    char results[PATH_CAPACITY], parts[PATH_CAPACITY];
    bool begun = case_out_path(results, variant, "results.h5", NULL) == HAFT_OK &&
                 case_out_path(parts, variant, "parts", NULL) == HAFT_OK &&
                 (access(results, F_OK) == 0 || haft_parts_are_in(parts));
    return mode == HAFT_RUN_RESUME && !begun ? HAFT_RUN_NEW : mode;
}

static haft_status run_variant(sweep *s, size_t i, bool *complete, const char *folder,
                               haft_run_mode mode, terminal *t, haft_error *error) {
    char path[PATH_CAPACITY];
    haft_summary *summary = NULL;
    *complete = false;
    haft_status status = make_variant(s, i, folder, mode, path, error);
    if (status == HAFT_OK && haft_study_rank() == 0) {
        status = build_together(s, i, folder, mode, t, error);
    }
    if (status != HAFT_OK) {
        (void)haft_study_ranks_agree(false);
        return status;
    }
    haft_progress progress = terminal_progress(t);
    if (haft_study_rank() == 0) {
        terminal_close_line(t);
        progress.note(progress.user, s->c[i]->sweep.label);
    }
    status =
        run_one(&summary, complete, s->c[i], path, mode_of(mode, path), (haft_shard){0}, t, error);
    if (*complete && haft_study_rank() == 0) {
        s->variant[i].statistics = haft_study_statistics(s->c[i], summary, s->c[i]->realizations);
    }
    haft_memory_free(summary);
    return status;
}

static haft_status save_table(const sweep *s, const char *folder, haft_error *error) {
    char path[PATH_CAPACITY];
    haft_status status = case_out_path(path, folder, "sweep.csv", error);
    return status == HAFT_OK ? haft_study_write_sweep(s->variant, s->variants, path, error)
                             : status;
}

/* Runs all variants. Beams that could not be followed do not end the sweep. */
static haft_status run_all(sweep *s, bool *complete, const char *folder, haft_run_mode mode,
                           terminal *t, haft_error *error) {
    haft_status worst = HAFT_OK;
    haft_error said = {0};
    *complete = true;
    haft_progress progress = terminal_progress(t);
    for (size_t i = 0; i < s->variants; i++) {
        if (haft_study_rank() == 0 &&
            progress.stop(progress.user)) { /* a complete variant never checks for a stop */
            *complete = false;
            (void)haft_study_ranks_agree(false);
            return haft_error_set(error, HAFT_ERROR_INTERRUPTED,
                                  "interrupted before variant %s; `haft resume` goes on from there",
                                  s->c[i]->sweep.label);
        }
        haft_status status = run_variant(s, i, complete, folder, mode, t, error);
        if (status != HAFT_OK) {
            haft_error_prefix(error, "variant %s: ", s->c[i]->sweep.label);
        }
        if (!*complete) {
            return status;
        }
        if (status != HAFT_OK && worst == HAFT_OK) {
            worst = status;
            said = *error;
        }
    }
    haft_status status = haft_study_rank() == 0 ? save_table(s, folder, error) : HAFT_OK;
    if (status == HAFT_OK && worst != HAFT_OK) {
        *error = said;
        status = worst;
    }
    return status;
}

int run_sweep(const haft_case *c, const char *folder, haft_run_mode mode, bool json, terminal *t) {
    sweep s;
    haft_error error = {0};
    haft_status status = open_sweep(&s, c, folder, &error);
    if (status != HAFT_OK) {
        (void)haft_study_ranks_agree(false);
        return haft_study_rank() == 0 ? terminal_fail(t, status, &error) : EXIT_OK;
    }
    bool complete = false;
    status = run_all(&s, &complete, folder, mode, t, &error);
    int code = EXIT_OK;
    if (haft_study_rank() == 0) {
        if (complete) {
            print_sweep(s.variant, s.variants, json);
        }
        code = status == HAFT_OK ? EXIT_OK : terminal_fail(t, status, &error);
    }
    close_sweep(&s);
    return code;
}

/* Reads the statistics of all variants from their results. */
static haft_status gather(sweep *s, const char *folder, haft_error *error) {
    char path[PATH_CAPACITY], results[PATH_CAPACITY];
    haft_status status = HAFT_OK;
    for (size_t i = 0; i < s->variants && status == HAFT_OK; i++) {
        haft_results_view *view = NULL;
        status = variant_folder(path, folder, s->c[i], error);
        HAFT_THEN(status, case_out_path(results, path, "results.h5", error));
        HAFT_THEN(status, read_results(&view, s->c[i], results, error));
        if (status == HAFT_OK) {
            s->variant[i].statistics =
                haft_study_statistics(s->c[i], view->summary, view->realizations);
        }
        haft_results_view_destroy(&view);
    }
    return status;
}

int tell_sweep(const haft_case *c, const char *folder, bool json, terminal *t) {
    sweep s;
    haft_error error = {0};
    haft_status status = open_sweep(&s, c, folder, &error);
    if (status == HAFT_OK) {
        status = gather(&s, folder, &error);
        if (status == HAFT_OK) {
            print_sweep(s.variant, s.variants, json);
        }
        close_sweep(&s);
    }
    return status == HAFT_OK ? terminal_finish(t, EXIT_OK) : terminal_fail(t, status, &error);
}

/* Lists the words of a swept choice, one for each variant, as labels of the axis; empty for a
 * number. */
static void list_choices(const sweep *s, char *words, size_t capacity) {
    size_t used = 0;
    words[0] = '\0';
    for (size_t i = 0; i < s->variants && used < capacity && s->c[i]->sweep.choice[0]; i++) {
        used += (size_t)snprintf(words + used, capacity - used, "%s ", s->c[i]->sweep.text[0]);
    }
}

int plot_sweep(const haft_case *c, const char *folder, terminal *t) {
    sweep s;
    haft_error error = {0};
    char words[DRAW_WORDS_CAPACITY] = "";
    double greatest = 0;
    haft_status status = open_sweep(&s, c, folder, &error);
    if (status == HAFT_OK) {
        status = gather(&s, folder, &error);
        HAFT_THEN(status, save_table(&s, folder, &error));
        for (size_t i = 0; i < s.variants; i++) {
            greatest = fmax(greatest, s.c[i]->sweep.value[0]);
        }
        list_choices(&s, words, sizeof words);
        close_sweep(&s);
    }
    return status == HAFT_OK ? draw_sweep(c, greatest, words, folder, t)
                             : terminal_fail(t, status, &error);
}
