/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stress as a whole: its beams on all cores, counted by outcome, family and fault, with the
 * first of each kind, so that it can be run alone. */
#ifndef HAFT_TEST_STRESS_REPORT_H
#define HAFT_TEST_STRESS_REPORT_H

#include "stress_study.h"

enum { STRESS_FIRSTS = 12 };

/* How many, the first indices, and the worst. */
typedef struct stress_count {
    size_t beams;
    uint64_t first[STRESS_FIRSTS], worst_index;
    long double worst;
} stress_count;

static inline void stress_tally(stress_count *c, uint64_t index, long double size) {
    if (c->beams < STRESS_FIRSTS) {
        c->first[c->beams] = index;
    }
    if (c->beams == 0 || size > c->worst) {
        c->worst = size;
        c->worst_index = index;
    }
    c->beams++;
}

static inline void stress_print_count(const char *what, const char *where, const stress_count *c) {
    print_message("    %-28s %-8s %6zu beams; worst %.2Le of its bound at %llu; first:", what,
                  where, c->beams, c->worst, (unsigned long long)c->worst_index);
    for (size_t k = 0; k < c->beams && k < STRESS_FIRSTS; k++) {
        print_message(" %llu", (unsigned long long)c->first[k]);
    }
    print_message("\n");
}

/* Beams by outcome on a mesh; of outcomes that do not explain themselves, which. */
static inline void stress_print_outcomes(const stress_result *result, size_t beams, int mesh) {
    for (int o = 0; o < HAFT_OUTCOMES; o++) {
        stress_count c = {0};
        size_t by_family[STRESS_FAMILIES] = {0};
        for (size_t i = 0; i < beams; i++) {
            if (!result[i].run[mesh].refused && result[i].run[mesh].outcome == (haft_outcome)o) {
                stress_tally(&c, result[i].index, 0);
                by_family[result[i].family]++;
            }
        }
        if (c.beams == 0) {
            continue;
        }
        print_message("    %-8s %-18s %6zu beams", stress_mesh_name(mesh),
                      haft_outcome_name((haft_outcome)o), c.beams);
        if (!stress_is_explained((haft_outcome)o, mesh)) {
            for (int k = 0; k < STRESS_FAMILIES; k++) {
                if (by_family[k] > 0) {
                    print_message("; %s %zu", stress_family_name((stress_family)k), by_family[k]);
                }
            }
            print_message("; first:");
            for (size_t k = 0; k < c.beams && k < STRESS_FIRSTS; k++) {
                print_message(" %llu", (unsigned long long)c.first[k]);
            }
        }
        print_message("\n");
    }
}

/* Beams by fault on a mesh. */
static inline void stress_print_faults(const stress_result *result, size_t beams, int mesh) {
    for (int k = 0; k < STRESS_FAULTS; k++) {
        stress_count c = {0};
        for (size_t i = 0; i < beams; i++) {
            long double worst = result[i].run[mesh].finding.worst[k];
            if (!result[i].run[mesh].refused && worst > 1) {
                stress_tally(&c, result[i].index, worst);
            }
        }
        if (c.beams > 0) {
            stress_print_count(stress_fault_name((stress_fault)k), stress_mesh_name(mesh), &c);
        }
    }
}

/* Beams that the library refused, with the first message. */
static inline void stress_print_refusals(const stress_result *result, size_t beams, int mesh) {
    stress_count c = {0};
    const char *why = "";
    for (size_t i = 0; i < beams; i++) {
        if (result[i].run[mesh].refused) {
            why = c.beams == 0 ? result[i].run[mesh].refusal : why;
            stress_tally(&c, result[i].index, 0);
        }
    }
    if (c.beams > 0) {
        stress_print_count("refused", stress_mesh_name(mesh), &c);
        print_message("      %s\n", why);
    }
}

static inline void stress_print_work(const stress_result *result, size_t beams) {
    size_t points = 0, jumps = 0, landings = 0, lost = 0, starts = 0, lost_starts = 0, slow = 0,
           dragged = 0, branches = 0, undecided = 0;
    double slowest = 0;
    for (size_t i = 0; i < beams; i++) {
        for (int m = 0; m < STRESS_MESHES; m++) {
            const stress_run *run = &result[i].run[m];
            points += run->points;
            jumps += run->jumps;
            landings += run->finding.landings;
            lost += run->finding.lost_landings;
            branches += run->finding.branches;
            dragged += run->finding.dragged;
            undecided += run->finding.undecided;
            starts += run->finding.start_felt;
            lost_starts += run->finding.start_lost;
            slow = run->seconds > slowest ? i : slow;
            slowest = fmax(slowest, run->seconds);
        }
    }
    print_message("  %zu states, %zu jumps, %zu steps followed again, %zu landings compared (%zu "
                  "lost by the oracle), %zu "
                  "starts (%zu lost); %zu landings differ by the mesh's drag, %zu undecided; "
                  "slowest path %.1f s: "
                  "%llu\n",
                  points, jumps, branches, landings, lost, starts, lost_starts, dragged, undecided,
                  slowest, (unsigned long long)result[slow].index);
}

/* What one beam came to, on all meshes. */
static inline void stress_print_beam(const stress_result *r) {
    for (int m = 0; m < STRESS_MESHES; m++) {
        const stress_run *run = &r->run[m];
        if (run->refused) {
            print_message("  %llu %s refused: %s\n", (unsigned long long)r->index,
                          stress_mesh_name(m), run->refusal);
            continue;
        }
        print_message("  %llu %s: %s, %zu points, %zu jumps, ledger %.1e, %.3f s\n",
                      (unsigned long long)r->index, stress_mesh_name(m),
                      haft_outcome_name(run->outcome), run->points, run->jumps, run->ledger_error,
                      run->seconds);
        for (int k = 0; k < STRESS_FAULTS; k++) {
            if (run->finding.worst[k] > 1) {
                print_message("    %s: %.3Le of its bound at %zu\n",
                              stress_fault_name((stress_fault)k), run->finding.worst[k],
                              run->finding.point[k]);
            }
        }
    }
}

/* Whether anything went wrong with a beam: on any mesh an outcome that does not explain itself, a
 * refusal or a fault. */
static inline bool stress_is_wrong(const stress_result *r) {
    for (int m = 0; m < STRESS_MESHES; m++) {
        const stress_run *run = &r->run[m];
        bool wrong = run->refused || !stress_is_explained(run->outcome, m);
        for (int k = 0; k < STRESS_FAULTS && !wrong; k++) {
            wrong = run->finding.worst[k] > 1;
        }
        if (wrong) {
            return true;
        }
    }
    return false;
}

/* Runs all beams into `result`, on all cores. */
static inline void stress_run_all(const stress_options *options, stress_result *result) {
#pragma omp parallel for schedule(dynamic, 1)
    for (size_t i = 0; i < options->beams; i++) {
        result[i] = stress_beam_run(options, options->first + i);
    }
}

/* Runs all beams and prints the tables. @return how many went wrong */
static inline size_t stress_study_run(const stress_options *options) {
    size_t beams = options->beams, wrong = 0;
    stress_result *result = calloc(beams, sizeof *result);
    stress_run_all(options, result);
    for (size_t i = 0; i < beams; i++) {
        wrong += stress_is_wrong(&result[i]);
        if (options->told) {
            stress_print_beam(&result[i]);
        }
    }
    print_message("  %zu beams of seed %llu from %llu on, %zu of them wrong\n", beams,
                  (unsigned long long)options->seed, (unsigned long long)options->first, wrong);
    stress_print_work(result, beams);
    for (int m = 0; m < STRESS_MESHES; m++) {
        stress_print_refusals(result, beams, m);
        stress_print_outcomes(result, beams, m);
    }
    for (int m = 0; m < STRESS_MESHES; m++) {
        stress_print_faults(result, beams, m);
    }
    free(result);
    return wrong;
}

#endif
