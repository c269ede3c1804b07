/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Summits: points no lower than their 8 neighbours; of equal neighbours the first in the scan
 * counts. Apex and mean curvature come from the quadratic with the central differences of the 3 x 3
 * block, through the centre and its four neighbours, with the cross difference of the corners. So
 * the curvature at a maximum is never negative, and the apex is never below its sample. The cross
 * term is omitted if with it there is no maximum, or the apex is further than a step.
 *
 * A patch extends half a step beyond its border points. A border point that is highest among its
 * existing neighbours counts if the quadratic of the nearest complete block has its apex inside the
 * patch; otherwise the apex belongs to the adjoining patch. So a cut neither loses nor duplicates a
 * parabolic asperity.
 *
 * A flat block gets a radius of 1000 patch diagonals, so that a flat patch pushes too. */
#include <math.h>
#include <string.h>

#include "contact/patch.h"

typedef struct summit {
    double height, radius;
} summit;

/* Whether no neighbour is higher; z points at the sample, and `up` etc. say which neighbours
 * exist. */
static bool is_highest(const double *z, size_t columns, bool left, bool right, bool up, bool down) {
    double h = *z;
    if ((left && z[-1] >= h) || (right && z[1] > h)) {
        return false;
    }
    if (up) {
        const double *a = z - columns;
        if (a[0] >= h || (left && a[-1] >= h) || (right && a[1] >= h)) {
            return false;
        }
    }
    if (down) {
        const double *b = z + columns;
        if (b[0] > h || (left && b[-1] > h) || (right && b[1] > h)) {
            return false;
        }
    }
    return true;
}

/* The three points of a difference along one axis, centred at the sample or, at a border, from the
 * sample inwards, and the weights of the first difference. Those of the second are 1, -2, 1. */
typedef struct axis {
    int side; /* 0 inside; at a border, the inward direction, 1 or -1 */
    ptrdiff_t at[3];
    double first[3];
} axis;

static axis make_axis(size_t i, size_t n, size_t stride) {
    int side = (i == 0) - (i + 1 == n);
    ptrdiff_t s = (ptrdiff_t)stride;
    if (side == 0) {
        return (axis){0, {-s, 0, s}, {-0.5, 0, 0.5}};
    }
    return (axis){side, {0, side * s, 2 * side * s}, {-1.5 * side, 2.0 * side, -0.5 * side}};
}

/* Gradient and second differences at a sample, per step; x is the direction of the column index. */
typedef struct quadratic {
    double x, y, xx, yy, xy;
} quadratic;

static quadratic fit(const double *z, const axis *row, const axis *column) {
    quadratic q = {0};
    for (int k = 0; k < 3; k++) {
        double second = k == 1 ? -2 : 1;
        q.x += column->first[k] * z[column->at[k]];
        q.y += row->first[k] * z[row->at[k]];
        q.xx += second * (z[column->at[k]] - z[0]);
        q.yy += second * (z[row->at[k]] - z[0]);
        for (int l = 0; l < 3; l++) {
            q.xy += row->first[k] * column->first[l] * z[row->at[k] + column->at[l]];
        }
    }
    return q;
}

static double along(double slope, double bend) {
    return bend < 0 ? -slope / bend : 0;
}

/* Whether an apex is at most half a step beyond the border, if there is one. */
static bool is_owned(const axis *a, double shift, double bend) {
    return a->side == 0 || (bend < 0 && a->side * shift >= -0.5);
}

/* Finds the height of the apex above the sample; false if the apex is outside the patch. */
static bool find_apex(const quadratic *q, const axis *row, const axis *column, double *rise) {
    double det = q->xx * q->yy - q->xy * q->xy;
    double x = (q->xy * q->y - q->yy * q->x) / det;
    double y = (q->xy * q->x - q->xx * q->y) / det;
    if (!(q->xx < 0 && det > 0 && fabs(x) <= 1 && fabs(y) <= 1)) {
        x = along(q->x, q->xx);
        y = along(q->y, q->yy);
    }
    *rise = 0.5 * (q->x * x + q->y * y);
    bool level = q->xx == 0 && q->yy == 0;
    return level || (is_owned(column, x, q->xx) && is_owned(row, y, q->yy));
}

static bool measure(const haft_patch *patch, size_t i, size_t j, summit *out) {
    size_t rows = patch->rows, columns = patch->columns;
    const double *z = patch->z + i * columns + j;
    if (!is_highest(z, columns, j > 0, j + 1 < columns, i > 0, i + 1 < rows)) {
        return false;
    }
    axis row = make_axis(i, rows, columns), column = make_axis(j, columns, 1);
    quadratic q = fit(z, &row, &column);
    double rise = 0;
    if (!find_apex(&q, &row, &column, &rise)) {
        return false;
    }
    out->height = *z + rise;
    double bend = -0.5 * (q.xx + q.yy);
    double flat = 1e3 * patch->step * hypot((double)rows, (double)columns);
    out->radius = bend > 0 ? fmin(patch->step * patch->step / bend, flat) : flat;
    return true;
}
/* Writes the summits in scan order, and counts them by the number of levels that they exceed. */
static size_t collect(haft_contact_work *work, const haft_patch *patch, const haft_levels *levels,
                      size_t n, summit *out, uint32_t *counts) {
    size_t columns = patch->columns, total = 0, row = 0, row_end = columns;
    for (size_t k = 0; k < n; k++) {
        size_t point = work->found[k];
        while (point >= row_end) {
            row++;
            row_end += columns;
        }
        if (measure(patch, row, point + columns - row_end, &out[total])) {
            counts[haft_levels_below(levels, out[total].height)]++;
            total++;
        }
    }
    return total;
}

/* Adds a Maugis sphere for each summit at all levels within its reach. */
static void add_spheres(const summit *scan, size_t total, const haft_levels *levels,
                        const haft_adhesion *adhesion, const haft_tally *tally) {
    for (size_t j = 0; j < levels->n; j++) {
        tally->push[j] = tally->area[j] = tally->number[j] = 0;
    }
    for (size_t k = 0; k < total; k++) {
        haft_sphere sphere = haft_adhesion_sphere(adhesion, scan[k].radius);
        double apex = scan[k].height - adhesion->reach;
        for (size_t j = haft_levels_below(levels, scan[k].height); j-- > 0;) {
            double area, force = haft_sphere_force(&sphere, apex - levels->at[j], &area);
            tally->push[j] += force;
            tally->area[j] += area;
            tally->number[j] += area > 0;
        }
    }
}

void haft_contact_summits(haft_contact_work *work, const haft_patch *patch,
                          const haft_levels *levels, size_t n, const haft_adhesion *adhesion,
                          const haft_tally *tally) {
    summit *scan = work->spare;
    double *height = work->top_a, *root = work->top_b;
    uint32_t *counts = work->counts, *next = work->counts + levels->n + 1;
    memset(counts, 0, (levels->n + 1) * sizeof *counts);
    size_t total = collect(work, patch, levels, n, scan, counts);
    if (adhesion != NULL) {
        add_spheres(scan, total, levels, adhesion, tally);
        return;
    }
    /* Highest first, so that the summits above a distance come first. */
    uint32_t before = 0;
    for (size_t level = levels->n + 1; level-- > 0;) {
        next[level] = before;
        before += counts[level];
    }
    for (size_t k = 0; k < total; k++) {
        size_t place = next[haft_levels_below(levels, scan[k].height)]++;
        height[place] = scan[k].height;
        root[place] = sqrt(scan[k].radius);
    }
    size_t above = 0;
    for (size_t level = levels->n; level-- > 0;) {
        above += counts[level + 1];
        double d = levels->at[level], push = 0, area = 0;
        for (size_t k = 0; k < above; k++) {
            double depth = height[k] - d;
            push += root[k] * (depth * sqrt(depth));
            area += root[k] * root[k] * depth;
        }
        tally->push[level] = push;
        tally->area[level] = M_PI * area;
        tally->number[level] = (double)above;
    }
}
