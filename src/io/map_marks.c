/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fill values for missing pixels that a file does not declare: -9999, the largest float, and the
 * like. Read as heights, they make all statistics meaningless. Only the user can say whether they
 * are fill values, so a map with one is rejected.
 *
 * The smallest and the largest value are checked, each by itself. A usual fill value is suspicious
 * at some distance from the others, any other value at more than a thousand times their range.
 * Limits of integer types also occur where an instrument clips or a map was stretched to the type,
 * so for them the distance must be larger than for a usual fill value. */
#include "map_file.h"

#include <float.h>
#include <math.h>

/* Upper limit of a height [m]; it also detects wrong units, such as metres. */
static const double HEIGHT_MOST = 1e3;
/* Distance to the other values at which a value is suspicious, in units of their range: for a usual
 * fill value, for the limit of a type, and for any value. */
static const double APART_MARK = 0.01, APART_LIMIT = 1, APART_ANY = 1e3;

/* An extreme value and the value next to it. */
typedef struct edge {
    double value, next; /* NAN: there is none */
    size_t count;
} edge;

static bool is_among(double value, const double *list, size_t n) {
    for (size_t i = 0; i < n; i++) {
        if (value == list[i]) {
            return true;
        }
    }
    return false;
}

static bool is_known_mark(double value) {
    static const double nines[] = {-999, -9999, -99999, -999999, -9999999, 99999, 999999, 9999999};
    return is_among(value, nines, sizeof nines / sizeof *nines);
}

static bool is_type_limit(double value) {
    static const double limits[] = {-32768.0,      -32767.0,      32767.0,      65535.0,
                                    -2147483648.0, -2147483647.0, 2147483647.0, 4294967295.0};
    return is_among(value, limits, sizeof limits / sizeof *limits);
}

/* Finds the largest value, or with `sign` -1 the smallest. */
static edge find_edge(const haft_map *map, double sign) {
    edge e = {NAN, NAN, 0};
    for (size_t i = 0; i < map->rows * map->columns; i++) {
        double z = sign * map->z[i];
        if (isnan(z) || z < e.next) {
            continue;
        }
        if (isnan(e.value) || z > e.value) {
            e.next = e.value;
            e.value = z;
            e.count = 1;
        } else if (z == e.value) {
            e.count++;
        } else {
            e.next = z;
        }
    }
    e.value *= sign;
    e.next *= sign;
    return e;
}

/* Whether an edge looks like a fill value; `range` is that of the other values. */
static bool is_mark(const edge *e, double range) {
    double gap = fabs(e->value - e->next);
    if (is_known_mark(e->value)) {
        return gap >= APART_MARK * range;
    }
    if (is_type_limit(e->value)) {
        return gap >= APART_LIMIT * range;
    }
    return range > 0 && gap >= APART_ANY * range;
}

static haft_status refuse(const haft_map_file *file, const edge *e, double low, double high,
                          haft_error *error) {
    return haft_error_set(
        error, HAFT_ERROR_INPUT,
        "%s: the value %.9g stands there %zu times, far from all others (%.6g to "
        "%.6g): a mark for missing pixels, it seems, and no height; write missing "
        "pixels as nan, or in HDF5 declare them by the attribute _FillValue",
        file->path, e->value, e->count, low, high);
}

haft_status haft_map_check_marks(const haft_map *map, const haft_map_file *file, double unit,
                                 haft_error *error) {
    edge top = find_edge(map, 1), bottom = find_edge(map, -1);
    const edge *far = fabs(top.value) > fabs(bottom.value) ? &top : &bottom;
    if (fabs(far->value) * unit > HEIGHT_MOST) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "%s: the value %.9g, which stands there %zu times, is %.3g m, no "
            "height of a map: if it marks missing pixels, write them as nan (or "
            "in HDF5 declare it by the attribute _FillValue), else give the right "
            "unit",
            file->path, far->value, far->count, far->value * unit);
    }
    if (isnan(top.next)) {
        return HAFT_OK; /* at most one value: nothing to compare with */
    }
    if (is_mark(&top, top.next - bottom.value)) {
        return refuse(file, &top, bottom.value, top.next, error);
    }
    if (is_mark(&bottom, top.value - bottom.next)) {
        return refuse(file, &bottom, bottom.next, top.value, error);
    }
    return HAFT_OK;
}
