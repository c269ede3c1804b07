/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs a case: makes the paths of its files, writes the files beside the results, prints
 * messages. */
#include "run.h"

#include "summary_report.h"

typedef struct runner {
    const haft_case *c;
    const char *folder;
} runner;

/* Makes the path CASE/out/name, and removes what a killed run may have left of that file. */
static haft_status companion(char path[PATH_CAPACITY], const char *folder, const char *name,
                             haft_error *error) {
    haft_status status = case_out_path(path, folder, name, error);
    if (status == HAFT_OK) {
        haft_io_drop_stale(path);
    }
    return status;
}

/* Saves the files beside results.h5. */
static haft_status save_companions(void *user, const haft_summary *summary, const haft_laws *laws,
                                   haft_error *error) {
    const runner *r = user;
    const haft_case *c = r->c;
    const char *folder = r->folder;
    char path[PATH_CAPACITY];
    haft_status status = companion(path, folder, "resolved.yaml", error);
    HAFT_THEN(status, haft_case_write(c, path, error));
    HAFT_THEN(status, companion(path, folder, "laws.csv", error));
    if (status == HAFT_OK && laws != NULL) {
        status = save_laws_table(laws, folder, error);
    }
    HAFT_THEN(status, companion(path, folder, "summary.csv", error));
    HAFT_THEN(status, haft_study_write_summary(summary, c->realizations, path, error));
    HAFT_THEN(status, companion(path, folder, "convergence.csv", error));
    return status == HAFT_OK
               ? haft_study_write_convergence(c, summary, c->realizations, path, error)
               : status;
}

/* Reports beams without a result. Everything is saved, but the exit code must show a script that
 * not all beams have one. */
static haft_status tell_failures(const haft_case *c, const haft_summary *summary,
                                 const char *results, haft_error *error) {
    haft_statistics s = haft_study_statistics(c, summary, c->realizations);
    for (size_t k = 0; k < c->realizations && s.failed > 0; k++) {
        int outcome = summary[k].outcome;
        if (outcome >= 0 && outcome != HAFT_OUTCOME_STUCK && outcome != HAFT_OUTCOME_FREE) {
            return haft_error_set(error, HAFT_ERROR_NUMERIC,
                                  "%zu of %zu beams could not be followed to the end, the first of "
                                  "them realization %zu (%s: %s); all are kept in %s",
                                  s.failed, s.run, k, haft_outcome_name((haft_outcome)outcome),
                                  haft_outcome_advice((haft_outcome)outcome), results);
        }
    }
    return HAFT_OK;
}

static const char NOT_ALL_RANKS[] = "another rank cannot begin; do all see the same files?";

static bool any_done(const haft_case *c, const haft_summary *summary) {
    for (size_t k = 0; k < c->realizations; k++) {
        if (summary[k].outcome >= 0) {
            return true;
        }
    }
    return false;
}

typedef struct run_paths {
    char results[PATH_CAPACITY], laws[PATH_CAPACITY], parts[PATH_CAPACITY];
} run_paths;

/* Prepares a run. Only rank 0 makes the folder. */
static haft_status prepare_run(run_paths *paths, haft_summary **summary, const haft_case *c,
                               const char *folder, haft_error *error) {
    *summary = haft_memory_alloc(c->realizations, sizeof **summary, error);
    if (*summary == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    haft_status status = case_out_path(paths->results, folder, "results.h5", error);
    HAFT_THEN(status, case_out_path(paths->laws, folder, "laws.h5", error));
    HAFT_THEN(status, case_out_path(paths->parts, folder, "parts", error));
    return status == HAFT_OK && haft_study_rank() == 0 ? make_out_folder(folder, NULL, error)
                                                       : status;
}

haft_status run_one(haft_summary **summary, bool *complete, const haft_case *c, const char *folder,
                    haft_run_mode mode, haft_shard shard, terminal *t, haft_error *error) {
    run_paths paths;
    *summary = NULL;
    *complete = false;
    haft_status status = prepare_run(&paths, summary, c, folder, error);
    if (!haft_study_ranks_agree(status == HAFT_OK) && status == HAFT_OK) {
        status = haft_error_set(error, HAFT_ERROR_IO, NOT_ALL_RANKS);
    }
    if (status == HAFT_OK) {
        runner r = {c, folder};
        haft_run_files files = {.laws = paths.laws,
                                .results = paths.results,
                                .parts = paths.parts,
                                .folder = folder,
                                .beside = save_companions,
                                .user = &r};
        haft_progress progress = terminal_progress(t);
        status = haft_study_run(*summary, c, &files, mode, shard, &progress, error);
    }
    *complete = status == HAFT_OK;
    if (status == HAFT_OK && haft_study_rank() == 0 && shard.count == 0) {
        status = tell_failures(c, *summary, paths.results, error);
    }
    return status;
}

int run_case(const haft_case *c, const char *folder, haft_run_mode mode, haft_shard shard,
             bool json, terminal *t) {
    haft_error error = {0};
    haft_summary *summary = NULL;
    bool complete = false;
    haft_status status = run_one(&summary, &complete, c, folder, mode, shard, t, &error);
    int code = EXIT_OK;
    if (haft_study_rank() == 0) {
        bool told =
            status == HAFT_OK || status == HAFT_ERROR_NUMERIC || status == HAFT_ERROR_INTERRUPTED;
        if (told && shard.count == 0 && summary != NULL && any_done(c, summary)) {
            print_result(c, summary, json);
        }
        if (status != HAFT_OK) {
            drop_empty_out_folder(folder);
            code = terminal_fail(t, status, &error);
        }
    }
    haft_memory_free(summary);
    return code;
}
