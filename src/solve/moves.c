/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far gaps move, by the lengths over which their forces change. Many times a step, so that it
 * is vector code, and without a division: those are dearer than all else in it. By hand, since
 * compilers see no vector in two numbers chosen by one comparison. */
#include "lanes.h"
#include "tracker.h"

#include <math.h>

/* A motion and the length that it is to be measured by; and as many as there are lanes. */
typedef struct measured {
    double motion, length;
} measured;

typedef struct measured_lanes {
    octet motion, length;
} measured_lanes;

/* Which gaps are measured: from `gap` by motions, or by the way to other gaps; in step lengths or
 * in lengths. */
typedef struct gap_moves {
    const double *gap, *motion, *to; /* one of the last two is NULL */
    bool for_step;
} gap_moves;

HAFT_INLINE measured measure(const haft_tracker *t, const gap_moves *moves, size_t r) {
    double motion = moves->to != NULL ? moves->to[r] - moves->gap[r] : moves->motion[r];
    double gap = moves->gap[r];
    return (measured){fabs(motion), moves->for_step ? haft_tracker_step_length(t, r, gap)
                                                    : haft_tracker_length(t, r, gap)};
}

/* Takes those of `from` that are greater, by their lengths, than the ones so far. */
HAFT_INLINE void take_greater(measured_lanes *most, const measured_lanes *from) {
    const octet_bits more = from->motion * most->length > most->motion * from->length;
    most->motion = (octet)(((octet_bits)from->motion & more) | ((octet_bits)most->motion & ~more));
    most->length = (octet)(((octet_bits)from->length & more) | ((octet_bits)most->length & ~more));
}

/* LANES sites from r on. */
HAFT_INLINE void measure_lanes(const haft_tracker *t, const gap_moves *moves, size_t r,
                               measured_lanes *out) {
    const octet gap = *(const octet *)(moves->gap + r), nil = {0};
    octet motion = *(const octet *)((moves->to != NULL ? moves->to : moves->motion) + r);
    motion -= moves->to != NULL ? gap : nil;
    octet beyond = gap - *(const octet *)(t->far + r);
    beyond = (octet)((octet_bits)beyond & (beyond > nil));
    if (moves->for_step) {
        octet behind = *(const octet *)(t->wall + r) - gap;
        beyond += (octet)((octet_bits)behind & (behind > nil)); /* one of the two is 0 */
    }
    out->motion = (octet)((octet_bits)motion & INT64_MAX);
    octet past = gap - *(const octet *)(t->edge + r), wide = *(const octet *)(t->wide + r);
    octet length = *(const octet *)(t->range + r) + (octet)((octet_bits)past & (past > nil));
    const octet_bits less = length < wide;
    out->length = (octet)(((octet_bits)length & less) | ((octet_bits)wide & ~less)) + beyond;
}

static measured the_greater(measured a, measured b) {
    return b.motion * a.length > a.motion * b.length ? b : a;
}

/* The greatest of the lanes, by halves. */
HAFT_INLINE measured greatest_lane(measured_lanes *most) {
    measured_lanes half = {
        __builtin_shufflevector(most->motion, most->motion, 4, 5, 6, 7, 4, 5, 6, 7),
        __builtin_shufflevector(most->length, most->length, 4, 5, 6, 7, 4, 5, 6, 7)};
    take_greater(most, &half);
    const octet motion = most->motion, length = most->length;
    measured a = the_greater((measured){motion[0], length[0]}, (measured){motion[1], length[1]});
    measured b = the_greater((measured){motion[2], length[2]}, (measured){motion[3], length[3]});
    return the_greater(a, b);
}

/* Two by two, since each waits for the one before it. */
HAFT_INLINE measured greatest(const haft_tracker *t, const gap_moves *moves) {
    measured_lanes most[2] = {{(octet){0}, (octet){0} + 1.0}, {(octet){0}, (octet){0} + 1.0}};
    measured_lanes now;
    size_t r = t->model->inert, sites = t->model->sites;
    for (; r + 2 * LANES <= sites; r += 2 * LANES) {
        measure_lanes(t, moves, r, &now);
        take_greater(&most[0], &now);
        measure_lanes(t, moves, r + LANES, &now);
        take_greater(&most[1], &now);
    }
    if (r + LANES <= sites) {
        measure_lanes(t, moves, r, &now);
        take_greater(&most[0], &now);
        r += LANES;
    }
    take_greater(&most[0], &most[1]);
    measured one = greatest_lane(&most[0]);
    for (; r < sites; r++) {
        one = the_greater(one, measure(t, moves, r));
    }
    return one;
}

HAFT_CLONES static measured greatest_motion(const haft_tracker *t, const double *gap,
                                            const double *motion) {
    return greatest(t, &(gap_moves){gap, motion, NULL, false});
}

HAFT_CLONES static measured greatest_step(const haft_tracker *t, const double *gap,
                                          const double *motion) {
    return greatest(t, &(gap_moves){gap, motion, NULL, true});
}

HAFT_CLONES static measured greatest_way(const haft_tracker *t, const double *gap,
                                         const double *to) {
    return greatest(t, &(gap_moves){gap, NULL, to, false});
}

/* The first site that the greatest motion is of. */
static size_t whose(const haft_tracker *t, const gap_moves *moves, measured most) {
    for (size_t r = t->model->inert; r + 1 < t->model->sites; r++) {
        measured m = measure(t, moves, r);
        if (m.motion == most.motion && m.length == most.length) {
            return r;
        }
    }
    return t->model->sites - 1;
}

double haft_tracker_greatest(const haft_tracker *t, const double *gap, const double *motion,
                             size_t *site) {
    measured most = greatest_step(t, gap, motion);
    if (most.motion > 0) {
        *site = whose(t, &(gap_moves){gap, motion, NULL, true}, most);
    }
    return most.motion / most.length;
}

double haft_tracker_move(const haft_tracker *t, const double *gap, const double *v, size_t *site) {
    haft_model_displacements(t->model, v, t->site[0]);
    measured most = greatest_motion(t, gap, t->site[0]);
    if (site != NULL && most.motion > 0) {
        *site = whose(t, &(gap_moves){gap, t->site[0], NULL, false}, most);
    }
    return most.motion / most.length;
}

double haft_tracker_way(const haft_tracker *t, const double *gap, const double *to) {
    measured most = greatest_way(t, gap, to);
    return most.motion / most.length;
}

/* The sites up to the last that moves by more than `least` lengths. */
static size_t last_moved(const haft_tracker *t, const gap_moves *moves, double least) {
    for (size_t r = t->model->sites; r > t->model->inert; r--) {
        measured m = measure(t, moves, r - 1);
        if (m.motion > least * m.length) {
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
    measured most = greatest_motion(t, t->here.gap, t->motion);
    return last_moved(t, &(gap_moves){t->here.gap, t->motion, NULL, false},
                      share * (most.motion / most.length));
}
