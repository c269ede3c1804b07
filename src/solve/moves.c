/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far gaps move, by the lengths over which their forces change. */
#include "lanes.h"
#include "tracker.h"

#include <math.h>

/* Which gaps are measured: from `gap` by motions, or by the way to other gaps; in step lengths or
 * in lengths. */
typedef struct gap_moves {
    const double *gap, *motion, *to; /* one of the last two is NULL */
    bool for_step;
} gap_moves;

HAFT_INLINE double measure(const haft_tracker *t, const gap_moves *moves, size_t r) {
    double gap = moves->gap[r];
    double motion = moves->to != NULL ? moves->to[r] - gap : moves->motion[r];
    return fabs(motion) /
           (moves->for_step ? haft_tracker_step_length(t, r, gap) : haft_tracker_length(t, r, gap));
}

/* Many times a step, so that it is vector code: each choice of what is measured is a constant, and
 * each lane has a greatest of its own. */
HAFT_INLINE double greatest(const haft_tracker *t, const gap_moves *moves) {
    size_t r = t->model->inert, sites = t->model->sites;
    double lane[LANES] = {0}, most = 0;
    for (; r + LANES <= sites; r += LANES) {
#pragma omp simd
        for (size_t l = 0; l < LANES; l++) {
            double move = measure(t, moves, r + l);
            lane[l] = move > lane[l] ? move : lane[l];
        }
    }
    for (size_t l = 0; l < LANES; l++) {
        most = lane[l] > most ? lane[l] : most;
    }
    for (; r < sites; r++) {
        double move = measure(t, moves, r);
        most = move > most ? move : most;
    }
    return most;
}

HAFT_CLONES static double greatest_motion(const haft_tracker *t, const double *gap,
                                          const double *motion) {
    return greatest(t, &(gap_moves){gap, motion, NULL, false});
}

HAFT_CLONES static double greatest_step(const haft_tracker *t, const double *gap,
                                        const double *motion) {
    return greatest(t, &(gap_moves){gap, motion, NULL, true});
}

HAFT_CLONES static double greatest_way(const haft_tracker *t, const double *gap, const double *to) {
    return greatest(t, &(gap_moves){gap, NULL, to, false});
}

/* The first site that the greatest motion is of. */
static size_t whose(const haft_tracker *t, const gap_moves *moves, double most) {
    for (size_t r = t->model->inert; r + 1 < t->model->sites; r++) {
        if (measure(t, moves, r) == most) {
            return r;
        }
    }
    return t->model->sites - 1;
}

double haft_tracker_greatest(const haft_tracker *t, const double *gap, const double *motion,
                             size_t *site) {
    double most = greatest_step(t, gap, motion);
    if (most > 0) {
        *site = whose(t, &(gap_moves){gap, motion, NULL, true}, most);
    }
    return most;
}

double haft_tracker_move(const haft_tracker *t, const double *gap, const double *v, size_t *site) {
    haft_model_displacements(t->model, v, t->site[0]);
    double most = greatest_motion(t, gap, t->site[0]);
    if (site != NULL && most > 0) {
        *site = whose(t, &(gap_moves){gap, t->site[0], NULL, false}, most);
    }
    return most;
}

double haft_tracker_way(const haft_tracker *t, const double *gap, const double *to) {
    return greatest_way(t, gap, to);
}

/* The sites up to the last that moves by more than `least` lengths. */
static size_t last_moved(const haft_tracker *t, const gap_moves *moves, double least) {
    for (size_t r = t->model->sites; r > t->model->inert; r--) {
        if (measure(t, moves, r - 1) > least) {
            return r;
        }
    }
    return t->model->inert;
}

size_t haft_tracker_moved(const haft_tracker *t, const double *gap, const double *to,
                          double least) {
    return last_moved(t, &(gap_moves){gap, NULL, to, false}, least);
}

size_t haft_tracker_stirred(const haft_tracker *t, double share) {
    double most = greatest_motion(t, t->here.gap, t->motion);
    return last_moved(t, &(gap_moves){t->here.gap, t->motion, NULL, false}, share * most);
}
