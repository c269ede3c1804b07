/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far laws reach. With a far field the sum has no closed form for its greatest pull, nor for
 * the gap at which the pull passes a level: both are looked for between points that the near part
 * gives, close enough that it turns at most once between two, and points spread by their ratio
 * beyond. */
#include "law/far.h"

#include <math.h>

#include "law/table.h"

/* A level so small is passed nowhere but at the far field's end. */
#define LEAST_SHARE 1e-12

/* Decay lengths of a Morse law that its points go out to, and how many they are a length. */
#define DECAYS 40
enum { CHUNK = 32, A_DECAY = 2, LEFT = 8, TAIL = 48 };

/* The gaps between which something is looked for: the near part's, then the tail's. */
typedef struct points {
    const haft_law *law;
    size_t near, all;
    double first, last; /* of the near part */
} points;

static points points_of(const haft_law *law) {
    points p = {.law = law};
    if (law->kind == HAFT_LAW_TABLE) {
        p.near = haft_law_table_points(law->table);
        p.first = haft_law_table_point(law->table, 0);
        p.last = haft_law_table_point(law->table, p.near - 1);
    } else {
        p.near = LEFT + 1 + DECAYS * A_DECAY;
        p.first = law->wall_distance;
        p.last = law->d_max + DECAYS / law->a_right;
    }
    p.all = p.near + (law->far->out > p.last && p.last > 0 ? TAIL : 0);
    return p;
}

static double point_at(const points *p, size_t i) {
    const haft_law *law = p->law;
    if (i >= p->near) {
        double share = (double)(i + 1 - p->near) / TAIL;
        return i + 1 == p->all ? law->far->out : p->last * pow(law->far->out / p->last, share);
    }
    if (law->kind == HAFT_LAW_TABLE) {
        return haft_law_table_point(law->table, i);
    }
    double left = (double)i / LEFT, right = (double)(i - LEFT) / A_DECAY;
    return i < LEFT ? p->first + left * (law->d_max - p->first) : law->d_max + right / law->a_right;
}

static double near_force(const points *p, size_t i, double d) {
    if (p->law->kind == HAFT_LAW_TABLE) {
        return i + 1 < p->near ? haft_law_table_force(p->law->table, i) : 0;
    }
    haft_law near = haft_law_near(p->law);
    return haft_law_evaluate(&near, d).force;
}

/* Forces at up to CHUNK points. */
static void forces_at(const points *p, size_t from, size_t n, double *force) {
    double d[CHUNK];
    for (size_t i = 0; i < n; i++) {
        d[i] = point_at(p, from + i);
        force[i] = near_force(p, from + i, d[i]);
    }
    haft_law_add_far(p->law->far, n, d, &(haft_law_values){.force = force}, 0);
}

static double slope_at(const void *data, double d, double *slope) {
    haft_law_value value = haft_law_evaluate(data, d);
    *slope = value.curvature;
    return value.slope;
}

/* The greatest pull, about the point of the greatest: where the force turns between its neighbours,
 * or the point itself. */
static double refine(const points *p, size_t at, double most, double *where) {
    double low = point_at(p, at > 0 ? at - 1 : 0);
    double high = point_at(p, at + 1 < p->all ? at + 1 : at);
    double turn = haft_root_find(slope_at, p->law, low, high, true);
    double pull = -haft_law_evaluate(p->law, turn).force;
    *where = pull > most ? turn : point_at(p, at);
    return fmax(pull, most);
}

static double greatest_pull(const points *p, double *where) {
    double most = 0, force[CHUNK];
    size_t at = p->all;
    for (size_t i = 0; i < p->all; i += CHUNK) {
        size_t n = p->all - i < CHUNK ? p->all - i : CHUNK;
        forces_at(p, i, n, force);
        for (size_t k = 0; k < n; k++) {
            if (-force[k] > most) {
                most = -force[k];
                at = i + k;
            }
        }
    }
    if (at == p->all) {
        return 0;
    }
    return refine(p, at, most, where);
}

/* How much a law's force exceeds a level in one direction. */
typedef struct excess {
    const haft_law *law;
    double sign, level;
} excess;

static double exceeds(const void *data, double d, double *slope) {
    const excess *e = data;
    haft_law_value value = haft_law_evaluate(e->law, d);
    *slope = e->sign * value.slope;
    return e->sign * value.force - e->level;
}

/* Where, beyond `from`, whose pull exceeds the level, the last pull (or push) of so much ends. */
static double last_passage(const points *p, double level, bool pushes, double from) {
    double force[CHUNK], end = point_at(p, p->all - 1);
    for (size_t i = p->all; i > 0;) {
        size_t n = i < CHUNK ? i : CHUNK;
        i -= n;
        forces_at(p, i, n, force);
        for (size_t k = n; k-- > 0;) {
            double here = point_at(p, i + k);
            bool push = pushes && here > from && force[k] >= level;
            if (push || here <= from || force[k] <= -level) {
                excess e = {p->law, push ? 1 : -1, level};
                return haft_root_find(exceeds, &e, fmax(here, from), end, false);
            }
            end = here;
        }
    }
    return from;
}

static double far_reach(const haft_law *law, double share, bool pushes) {
    haft_law near = haft_law_near(law);
    points p = points_of(law);
    double where = p.first, most = greatest_pull(&p, &where);
    if (!(most > 0)) {
        return haft_law_reach(&near, share);
    }
    return share < LEAST_SHARE ? fmax(haft_law_extent(&near, share), law->far->out)
                               : last_passage(&p, share * most, pushes, where);
}

double haft_law_reach(const haft_law *law, double share) {
    if (!(share > 0 && share < 1)) {
        return NAN;
    }
    if (law->far != NULL) {
        return far_reach(law, share, false);
    }
    if (law->kind == HAFT_LAW_TABLE) {
        return haft_law_table_reach(law->table, share);
    }
    /* 1 - sqrt(1 - share) without the cancellation. */
    return law->d_max - log(share / (1 + sqrt(1 - share))) / law->a_right;
}

double haft_law_extent(const haft_law *law, double share) {
    if (law->far != NULL && share > 0 && share < 1) {
        return far_reach(law, share, true);
    }
    bool is_table = law->kind == HAFT_LAW_TABLE && share > 0 && share < 1;
    return is_table ? haft_law_table_extent(law->table, share) : haft_law_reach(law, share);
}
