/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file study_campaign.h
 *  Runs: check a case, follow its realizations over threads, ranks and shards. */
#ifndef HAFT_STUDY_CAMPAIGN_H
#define HAFT_STUDY_CAMPAIGN_H

#include "haft/study_laws.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Takes the steps that a run of the case takes first, without following a beam: mesh, surfaces or
 *  windows of maps, forces, and the law of the first site of realization 0 where laws are built
 * from curves. So what a run would refuse there is known before it, by the same message.
 *  @param[in] c the case
 *  @param[in] laws whether surfaces, forces and law are tried too, which may take seconds
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_INPUT with what a run would refuse. Not thread-safe (FFTW's planner). */
haft_status haft_study_check(const haft_case *c, bool laws, haft_error *error) HAFT_MUST_CHECK;

/** Follows one realization and sums it up. Thread-safe. */
haft_status haft_study_realize(haft_path **out, haft_summary *summary, const haft_case *c,
                               const haft_model *model, const haft_site_laws *laws,
                               bool keep_states, haft_error *error) HAFT_MUST_CHECK;

/** Joins the processes that `mpirun` started for this program (MPI_Init_thread); to be called first
 *  thing in main, by the thread that will call haft_study_run(). Does nothing where Haft was built
 *  without HAFT_MPI. */
void haft_study_ranks_begin(void);

/** Leaves them again (MPI_Finalize), if they were joined; fit for atexit(). */
void haft_study_ranks_end(void);

/** This process's number among them, from 0. */
int haft_study_rank(void);

/** How many they are; 1 where there are no others. */
int haft_study_ranks(void);

/** Are all of them ready? Each must call it once, ready or not, before each haft_study_run(), which
 *  none then calls unless all are. */
bool haft_study_ranks_agree(bool ready);

/** A share of a run's realizations, for processes that know nothing of each other: those k with
 *  k mod count = index - 1. Shards 1 .. count are disjoint, and together all there are. */
typedef struct haft_shard {
    size_t index; /**< from 1 to count */
    size_t count; /**< 0: no shard but the whole run */
} haft_shard;

/** Whether a realization is one of the shard's. Thread-safe. */
bool haft_shard_has(haft_shard shard, size_t realization);

/** Where a run finds its laws and keeps what it makes. */
typedef struct haft_run_files {
    const char *laws;    /**< laws.h5: read, or built where its inputs changed */
    const char *results; /**< results.h5 */
    const char *parts;   /**< folder of the realizations of an unfinished run */
    const char *folder;  /**< the case's, as messages name it */
    /** Writes what lies beside the results, once they are in place and before the parts go: so a
     * run killed in between is resumed. May be NULL. */
    haft_status (*beside)(void *user, const haft_summary *summary, const haft_laws *laws,
                          haft_error *error);
    void *user; /**< handed to it */
} haft_run_files;

/** What a run does about what is there already. */
typedef enum haft_run_mode {
    HAFT_RUN_NEW,    /**< nothing of an earlier run may be there */
    HAFT_RUN_ANEW,   /**< replaces what is there */
    HAFT_RUN_RESUME, /**< does what an unfinished run has left to do */
    HAFT_RUN_MERGE,  /**< makes the results of parts that leave nothing to do, and does nothing else
                      */
} haft_run_mode;

/** Runs the realizations of a case over OpenMP threads, and over ranks where there are several: all
 *  call it with the same arguments and see the same files; rank 0 builds the model that
 *  laws are drawn from, hands out the realizations one by one, tells progress, and makes the
 * results; the others return HAFT_OK with nothing to tell, or HAFT_ERROR_INTERRUPTED where rank 0
 * returns a failure. Where beams have laws of their own, those that laws.h5 does not hold are built
 * by whoever follows the beam, just before. Each realization is appended to a part file, its laws
 * with it, as soon as it is done, so that a run ended by whatever means loses only what was in
 * work; at the end the parts become the laws and results files, in order of realization, and go.
 * (Fewer beams than threads, of one process and without a stop rule, have their laws built by all
 * threads together first.) The same bits for any number of threads, ranks and interruptions, but
 * for /summary/seconds; but laws.h5 may keep more beams' laws than a run needs if they were there
 * before.
 *
 *  Stop rule (case key study.stop.crack_length_mean): the run needs only the realizations 0 to n-1,
 *  n the least multiple of HAFT_STOP_STRIDE from HAFT_STOP_LEAST on for which half the width of the
 *  mean's interval over them is at most that; what was done beyond is dropped.
 *
 *  A shard follows its own realizations and leaves them in parts of its own, which HAFT_RUN_MERGE
 *  (or RESUME) turns into the same files as a single run's. NEW goes on from the shard's own parts,
 *  ANEW clears them first. Shards share nothing but the folder of parts, or not even that: parts
 *  may be copied into one. A shard looks at no stop rule, and a model that its laws are drawn from
 *  must have been built before.
 *
 *  Stopped through `progress`, it keeps the parts and, if no shard, writes the results done so far
 *  as well.
 *  @param[in] c the case
 *  @param[in] files where all is
 *  @param[in] mode what to do about what is there
 *  @param[in] progress may be NULL
 *  @param[in] shard {0} for all realizations; only with NEW and ANEW
 *  @param[out] summary the case's realizations; outcome -1 where one was not run or was dropped;
 *  rank 0's alone
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_EXISTS if results or parts are there (NEW) or another process is at work on
 *  them; HAFT_ERROR_INPUT if there is nothing to resume or merge, or not all of it to merge (the
 *  message tells the shards that lack and the command that does them), or it belongs to another
 *  case, other laws or another build; HAFT_ERROR_INTERRUPTED if stopped, after writing. After any
 * failure the parts stay where they hold anything. */
haft_status haft_study_run(haft_summary *summary, const haft_case *c, const haft_run_files *files,
                           haft_run_mode mode, haft_shard shard, const haft_progress *progress,
                           haft_error *error) HAFT_MUST_CHECK;

#ifdef __cplusplus
}
#endif
#endif
