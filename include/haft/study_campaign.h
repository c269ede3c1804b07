/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file study_campaign.h
 *  Runs: check a case, follow its realizations over threads, ranks and shards. */
#ifndef HAFT_STUDY_CAMPAIGN_H
#define HAFT_STUDY_CAMPAIGN_H

#include "haft/study_laws.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Takes the first steps of a run of the case, without following a beam: mesh, surfaces or
 *  windows of maps, forces, and the law of the first site of realization 0 if laws are built
 *  from curves. A case that a run would refuse is refused here with the same message.
 *  @param[in] c the case
 *  @param[in] laws whether surfaces, forces and law are tried too, which may take seconds
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_INPUT if a run would refuse the case. Not thread-safe (FFTW's planner). */
haft_status haft_study_check(const haft_case *c, bool laws, haft_error *error) HAFT_MUST_CHECK;

/** Follows one realization, and makes its summary. Thread-safe. */
haft_status haft_study_realize(haft_path **out, haft_summary *summary, const haft_case *c,
                               const haft_model *model, const haft_site_laws *laws,
                               bool keep_states, haft_error *error) HAFT_MUST_CHECK;

/** Joins the processes that `mpirun` started for this program (MPI_Init_thread). Call it first
 *  in main, from the thread that will call haft_study_run(). Does nothing if Haft was built
 *  without HAFT_MPI. */
void haft_study_ranks_begin(void);

/** Leaves the processes again (MPI_Finalize) if they were joined; suitable for atexit(). */
void haft_study_ranks_end(void);

/** The rank of this process, from 0. */
int haft_study_rank(void);

/** The number of processes; 1 without MPI. */
int haft_study_ranks(void);

/** Whether all processes are ready. Each must call it once before each haft_study_run(), whether
 *  ready or not; none calls that unless all are. */
bool haft_study_ranks_agree(bool ready);

/** A share of a run's realizations, for processes that do not communicate: all k with k mod
 *  count = index - 1. Shards 1 .. count are disjoint and together contain all realizations. */
typedef struct haft_shard {
    size_t index; /**< from 1 to count */
    size_t count; /**< 0: the whole run */
} haft_shard;

/** Whether a realization belongs to the shard. Thread-safe. */
bool haft_shard_has(haft_shard shard, size_t realization);

/** The files of a run. */
typedef struct haft_run_files {
    const char *laws;    /**< laws.h5: read, or built if its inputs changed */
    const char *results; /**< results.h5 */
    const char *parts;   /**< folder of the checkpoints of an unfinished run */
    const char *folder;  /**< the case's folder, for messages */
    /** Writes the files beside the results. Called when the results are in place and before the
     *  parts are removed, so that a run killed in between can be resumed. May be NULL. */
    haft_status (*beside)(void *user, const haft_summary *summary, const haft_laws *laws,
                          haft_error *error);
    void *user; /**< handed to it */
} haft_run_files;

/** What a run does with earlier results and parts. */
typedef enum haft_run_mode {
    HAFT_RUN_NEW,    /**< refuses to run if there are any */
    HAFT_RUN_ANEW,   /**< replaces them */
    HAFT_RUN_RESUME, /**< continues an unfinished run */
    HAFT_RUN_MERGE,  /**< makes the results from complete parts, and computes nothing
                      */
} haft_run_mode;

/** Runs the realizations of a case over OpenMP threads, and over ranks if there are several. All
 *  ranks call it with the same arguments and see the same files. Rank 0 builds the model that
 *  laws are drawn from, hands out the realizations one by one, reports progress, and makes the
 *  results. The others return HAFT_OK without results, or HAFT_ERROR_INTERRUPTED if rank 0
 *  fails. If beams have laws of their own, the thread that follows a beam first builds its laws,
 *  unless laws.h5 holds them. (With fewer beams than threads, one process and no stop rule, all
 *  threads build the laws together first.) Each realization is appended to a part file with its
 *  laws as soon as it is done, so that an interrupted run loses only the realizations in
 *  progress. At the end the parts become the laws and results files, in order of realization,
 *  and are removed. The results have the same bits for any number of threads, ranks and
 *  interruptions, except /summary/seconds. But laws.h5 may hold laws of more beams than a run
 *  needs, if they were there before.
 *
 *  Stop rule (case key study.stop.crack_length_mean): the run needs only the realizations 0 to
 *  n-1, where n is the least multiple of HAFT_STOP_STRIDE, at least HAFT_STOP_LEAST, for which
 *  half the width of the mean's interval is at most that value. Realizations beyond are dropped.
 *
 *  A shard follows its own realizations and leaves them in parts of its own, which
 *  HAFT_RUN_MERGE (or RESUME) turns into the same files as those of a single run. NEW continues
 *  from the shard's own parts; ANEW clears them first. Shards share only the folder of parts,
 *  and not even that if parts are copied into one later. A shard ignores the stop rule, and a
 *  model that its laws are drawn from must have been built before.
 *
 *  If stopped through `progress`, it keeps the parts, and, unless it is a shard, also writes the
 *  results so far.
 *  @param[in] c the case
 *  @param[in] files where all is
 *  @param[in] mode what to do about what is there
 *  @param[in] progress may be NULL
 *  @param[in] shard {0} for all realizations; only with NEW and ANEW
 *  @param[out] summary the case's realizations; outcome -1 where one was not run or was dropped;
 *  rank 0's alone
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_EXISTS if results or parts are there (NEW) or another process is at work
 *  on them; HAFT_ERROR_INPUT if there is nothing to resume or merge, or not all of it to merge
 *  (the message tells the shards that lack and the command that does them), or it belongs to
 *  another case, other laws or another build; HAFT_ERROR_INTERRUPTED if stopped, after writing.
 *  After any failure the parts stay where they hold anything. */
haft_status haft_study_run(haft_summary *summary, const haft_case *c, const haft_run_files *files,
                           haft_run_mode mode, haft_shard shard, const haft_progress *progress,
                           haft_error *error) HAFT_MUST_CHECK;

#ifdef __cplusplus
}
#endif
#endif
