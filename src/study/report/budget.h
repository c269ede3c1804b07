/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A case with some of its choices changed, and its beams. Private to this room. */
#ifndef HAFT_STUDY_BUDGET_H
#define HAFT_STUDY_BUDGET_H

#include "haft/study_report.h"

/* Changes of a case; they can be combined. */
enum {
    HAFT_CHANGE_GRID = 1 << 0,       /* half the grid step */
    HAFT_CHANGE_ASPERITIES = 1 << 1, /* another model of asperities */
    HAFT_CHANGE_TABLE = 1 << 2,      /* the curves themselves for Morse laws */
    HAFT_CHANGE_EXACT = 1 << 3,      /* the stochastic model without expansion */
    HAFT_CHANGE_PATCHES = 1 << 4,    /* independent patches for the stochastic model */
    HAFT_CHANGE_SEAMLESS = 1 << 5,   /* one seamless surface for independent patches */
    HAFT_CHANGE_PATCH = 1 << 6,      /* half of l_meso */
    HAFT_CHANGE_MESH = 1 << 7,       /* the exact mesh */
    HAFT_CHANGE_LENGTH = 1 << 8,     /* a quarter more of the beam */
    HAFT_CHANGE_STEPS = 1 << 9,      /* half the steps along the path and in landings */
};

enum { HAFT_VARIANTS_KEPT = 24 };

/* A changed case, its beams and their cost. */
typedef struct haft_changed {
    unsigned changes;
    haft_case *c;
    haft_summary *beam;
    double seconds; /* per beam, including its laws */
} haft_changed;

/* All changed cases that were run, and the laws they share. */
typedef struct haft_changed_set {
    const haft_case *c;
    size_t beams;
    const char *directory;
    const haft_progress *progress;
    size_t count, laws_count;
    haft_changed changed[HAFT_VARIANTS_KEPT];
    struct {
        char digest[HAFT_DIGEST_CAPACITY];
        size_t sites; /* of the beams they are for; 0: for any */
        haft_laws *laws;
        double seconds;
    } built[HAFT_VARIANTS_KEPT];
} haft_changed_set;

/* Runs the case with these changes, or returns it if it was run before; the set owns it.
 * @return HAFT_ERROR_INPUT if the changed case cannot be used; the message says why. */
haft_status haft_changed_get(const haft_changed **out, haft_changed_set *set, unsigned changes,
                             haft_error *error) HAFT_MUST_CHECK;
void haft_changed_close(haft_changed_set *set);

#endif
