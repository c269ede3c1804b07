/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Islands: 8-connected regions above the distance, each a paraboloid with the region's area A and
 * volume V. The distance decreases in steps. In each step a bunch of points emerges between one
 * distance and the next. Each point joins or creates an island by union-find, and each island keeps
 * its number of points and the sum of their heights. The order within a bunch does not matter, so a
 * counting sort by bunch is enough.
 *
 * With penetration 2V/A and radius A^2/(4 pi V), sqrt(R) delta^(3/2) = sqrt(2/pi) V / sqrt(A) and
 * the Hertz area is A/2. An island cut by the patch's border counts with the part inside. */
#include <math.h>
#include <string.h>

#include "contact/patch.h"

typedef struct islands {
    uint32_t *label; /* of each point, within a frame of empty points: 1 + its island, 0 if below
                        the distance */
    uint32_t *parent, *count, *live;
    double *sum;
    uint32_t total, alive;
    bool fitted;
} islands;

/* Whether an island counts as an asperity; fitting a sphere needs three points. */
static inline bool is_counted(const islands *all, uint32_t island) {
    return !all->fitted || all->count[island] >= 3;
}

static inline uint32_t find(uint32_t *parent, uint32_t island) {
    while (parent[island] != island) {
        parent[island] = parent[parent[island]];
        island = parent[island];
    }
    return island;
}

static uint32_t merge(islands *all, uint32_t a, uint32_t b) {
    uint32_t into = a < b ? a : b, from = a < b ? b : a;
    all->parent[from] = into;
    all->count[into] += all->count[from];
    all->sum[into] += all->sum[from];
    return into;
}

static inline uint32_t found_island(islands *all) {
    uint32_t island = all->total++;
    all->parent[island] = island;
    all->count[island] = 0;
    all->sum[island] = 0;
    all->live[all->alive++] = island;
    return island;
}

static void add_point(islands *all, size_t place, size_t pitch, double rise) {
    const size_t near[8] = {place - pitch - 1, place - pitch,    place - pitch + 1,
                            place - 1,         place + 1,        place + pitch - 1,
                            place + pitch,     place + pitch + 1};
    uint32_t mine = UINT32_MAX, last = 0;
    for (int k = 0; k < 8; k++) {
        uint32_t label = all->label[near[k]];
        if (label == last || label == 0) {
            continue;
        }
        last = label;
        uint32_t other = find(all->parent, label - 1);
        if (mine == UINT32_MAX) {
            mine = other;
        } else if (mine != other) {
            mine = merge(all, mine, other);
        }
    }
    if (mine == UINT32_MAX) {
        mine = found_island(all);
    }
    all->label[place] = mine + 1;
    all->count[mine]++;
    all->sum[mine] += rise;
}

/* Removes islands that were merged into others from the list. */
static void drop_merged(islands *all) {
    uint32_t kept = 0;
    for (uint32_t k = 0; k < all->alive; k++) {
        uint32_t island = all->live[k];
        if (all->parent[island] == island) {
            all->live[kept++] = island;
        }
    }
    all->alive = kept;
}

/* Sums over the islands, at a distance `depth` above the lowest. */
static void add_up(const islands *all, double depth, double *push, double *points, double *number) {
    double sum = 0, covered = 0, counted = 0;
    for (uint32_t k = 0; k < all->alive; k++) {
        uint32_t island = all->live[k];
        if (!is_counted(all, island)) {
            continue;
        }
        double n = all->count[island];
        sum += fmax(all->sum[island] - n * depth, 0) / sqrt(n);
        covered += n;
        counted++;
    }
    *push = sum;
    *points = covered;
    *number = counted;
}

/* The same, with a Maugis sphere for each island. Its pull is limited to the adhesive strength
 * times its area, which is all the area within range, and is the pull of a rigid paraboloid.
 * Otherwise an island of one point just above the level would have an unbounded radius and pull, as
 * with `fitted`. */
static void add_spheres(const islands *all, double depth, double step,
                        const haft_adhesion *adhesion, double *push, double *area, double *number) {
    double sum = 0, covered = 0, touching = 0;
    for (uint32_t k = 0; k < all->alive; k++) {
        uint32_t island = all->live[k];
        if (!is_counted(all, island)) {
            continue;
        }
        double n = all->count[island], base = n * step * step;
        double mean = fmax(all->sum[island] / n - depth, 0);
        haft_sphere sphere = haft_adhesion_sphere(adhesion, base / (4 * M_PI * mean));
        double contact, force = haft_sphere_force(&sphere, 2 * mean - adhesion->range, &contact);
        sum += all->fitted ? force : fmax(force, -adhesion->strength * base);
        covered += fmin(contact, base);
        touching += contact > 0;
    }
    *push = sum;
    *area = covered;
    *number = touching;
}

/* Prefetches the data of a point: the points of a bunch are far apart in memory. */
enum { AHEAD = 12 };
static inline void call_up(const islands *all, const haft_patch *patch, uint32_t point) {
    size_t pitch = patch->columns + 1;
    const uint32_t *label = all->label + point + point / (uint32_t)patch->columns + 1;
    __builtin_prefetch(patch->z + point);
    __builtin_prefetch(label);
    __builtin_prefetch(label + pitch);
    __builtin_prefetch(label + 2 * pitch);
}

/* Sorts the found points by the number of distances that they exceed, in decreasing order;
 * next[level] becomes the end of that level's range. */
static void make_bunches(haft_contact_work *work, const haft_patch *patch,
                         const haft_levels *distances, size_t n, uint32_t *order) {
    uint32_t *counts = work->counts, *next = work->counts + distances->n + 1;
    memset(counts, 0, (distances->n + 1) * sizeof *counts);
    for (size_t k = 0; k < n; k++) {
        counts[haft_levels_below(distances, patch->z[work->found[k]])]++;
    }
    uint32_t before = 0;
    for (size_t level = distances->n + 1; level-- > 0;) {
        next[level] = before;
        before += counts[level];
    }
    for (size_t k = 0; k < n; k++) {
        uint32_t point = work->found[k];
        order[next[haft_levels_below(distances, patch->z[point])]++] = point;
    }
}

void haft_contact_islands(haft_contact_work *work, const haft_patch *patch,
                          const haft_levels *levels, size_t n, const haft_adhesion *adhesion,
                          bool fitted, const haft_tally *tally) {
    uint32_t *order = work->spare;
    make_bunches(work, patch, levels, n, order);
    const uint32_t *end = work->counts + levels->n + 1;
    size_t pitch = patch->columns + 1; /* one empty point separates two rows */
    islands all = {.label = work->found,
                   .parent = work->top_parent,
                   .count = work->top_count,
                   .live = work->top_live,
                   .sum = work->top_a,
                   .fitted = fitted};
    memset(all.label, 0, (pitch * (patch->rows + 2) + 1) * sizeof *all.label);
    double lowest = levels->at[0], step = patch->step;
    uint32_t columns = (uint32_t)patch->columns;
    size_t k = 0;
    for (size_t level = levels->n; level-- > 0;) {
        for (; k < end[level + 1]; k++) {
            if (k + AHEAD < n) {
                call_up(&all, patch, order[k + AHEAD]);
            }
            uint32_t point = order[k];
            add_point(&all, point + point / columns + pitch + 1, pitch, patch->z[point] - lowest);
        }
        drop_merged(&all);
        double depth = levels->at[level] - lowest, push = 0, points = 0, number = 0;
        if (adhesion != NULL) {
            add_spheres(&all, depth, step, adhesion, &tally->push[level], &tally->area[level],
                        &tally->number[level]);
            continue;
        }
        add_up(&all, depth, &push, &points, &number);
        tally->push[level] = sqrt(2 / M_PI) * step * push;
        tally->area[level] = 0.5 * step * step * points;
        tally->number[level] = number;
    }
}
