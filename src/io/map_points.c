/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A height map from points x, y, z: finds the even grid of the points and puts the heights onto it.
 * The grid of a coordinate is fitted to its distinct values by least squares, since single gaps
 * between rounded values are inaccurate. */
#include "map_text.h"

#include <math.h>
#include <stdlib.h>

/* Largest distance of a value from the grid, in steps: if no column is missing; the same with the
 * rounding to the last decimal digit; and if columns may be missing. */
static const double NEXT_TOLERANCE = 0.1, ROUNDED_TOLERANCE = 0.35, APART_TOLERANCE = 0.03;
static const double SAME = 1e-6; /* share of the range: values closer than this are equal */

typedef struct axis {
    double first, step;
    size_t n;
} axis;

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The least-squares line through (place, value). */
static axis fit_line(const double *value, const size_t *place, size_t n) {
    double mean_place = 0, mean_value = 0, square = 0, product = 0;
    for (size_t i = 0; i < n; i++) {
        mean_place += (double)place[i] / (double)n;
        mean_value += value[i] / (double)n;
    }
    for (size_t i = 0; i < n; i++) {
        double d = (double)place[i] - mean_place;
        square += d * d;
        product += d * (value[i] - mean_value);
    }
    double step = product / square;
    return (axis){mean_value - step * mean_place, step, place[n - 1] + 1};
}

/* Half a unit of the last decimal digit of sorted values; 0 if they have too many digits. */
static double half_digit(const double *value, size_t n) {
    double range = value[n - 1] - value[0];
    for (double digit = pow(10, ceil(log10(range))); digit > 1e-7 * range; digit /= 10) {
        bool whole = true;
        for (size_t i = 0; i < n && whole; i++) {
            double count = value[i] / digit;
            whole = fabs(count - round(count)) < 1e-5;
        }
        if (whole) {
            return 0.5 * digit;
        }
    }
    return 0;
}

/* Whether all sorted values are within `tolerance` of a step, or `margin`, of the grid. */
static bool fits(const axis *a, const double *value, size_t n, double tolerance, double margin) {
    double most = tolerance * a->step;
    if (margin > most) {
        most = margin < ROUNDED_TOLERANCE * a->step ? margin : ROUNDED_TOLERANCE * a->step;
    }
    for (size_t i = 0; i < n; i++) {
        double off = value[i] - a->first, place = round(off / a->step);
        if (!(fabs(off - place * a->step) <= most) || place < 0 || place >= (double)a->n) {
            return false;
        }
    }
    return true;
}

/* The means of runs of sorted values whose gaps are at most `same`. @return their number */
static size_t gather(double *mean, const double *value, size_t n, double same) {
    size_t m = 0;
    for (size_t i = 0; i < n;) {
        size_t first = i;
        double sum = value[i];
        for (i++; i < n && value[i] - value[i - 1] <= same; i++) {
            sum += value[i];
        }
        mean[m++] = sum / (double)(i - first);
    }
    return m;
}

/* The places of the m columns on the grid: consecutive, or with `apart` by their gaps in units of
 * the smallest gap. False if there would be too many. */
static bool put_places(size_t *place, const double *mean, size_t m, bool apart) {
    double smallest = mean[m - 1] - mean[0];
    for (size_t k = 1; k < m; k++) {
        smallest = fmin(smallest, mean[k] - mean[k - 1]);
    }
    place[0] = 0;
    for (size_t k = 1; k < m; k++) {
        double gap = apart ? round((mean[k] - mean[k - 1]) / smallest) : 1;
        if (!(gap < HAFT_MAP_SIDE_MOST) ||
            (place[k] = place[k - 1] + (size_t)gap) >= HAFT_MAP_SIDE_MOST) {
            return false;
        }
    }
    return true;
}

/* Fits a grid to columns at `mean`; true if all values are on it. */
static bool try_columns(axis *a, const double *value, size_t n, const double *mean, size_t m,
                        size_t *place, bool apart, double margin) {
    if (m < 2 || !put_places(place, mean, m, apart)) {
        return false;
    }
    *a = fit_line(mean, place, m);
    if (apart) { /* again: the smallest gap alone is too inaccurate for large gaps */
        for (size_t k = 1; k < m; k++) {
            double at = round((mean[k] - mean[0]) / a->step);
            if (!(at > (double)place[k - 1]) || at >= HAFT_MAP_SIDE_MOST) {
                return false;
            }
            place[k] = (size_t)at;
        }
        *a = fit_line(mean, place, m);
    }
    return a->step > 0 && fits(a, value, n, apart ? APART_TOLERANCE : NEXT_TOLERANCE, margin);
}

/* Divides the gaps of sorted values where successive gap sizes differ by the largest factor: larger
 * gaps are between columns, smaller ones are scatter within a column. Returns the largest of the
 * smaller gaps, or `same` if there is no clear step. `work` is overwritten. */
static double find_split(double *work, const double *value, size_t n, double same) {
    size_t m = 0;
    for (size_t i = 1; i < n; i++) {
        double gap = value[i] - value[i - 1];
        if (gap > same) {
            work[m++] = gap;
        }
    }
    qsort(work, m, sizeof *work, compare);
    double split = same, most = 2.5;
    for (size_t k = m; k-- > 1;) {
        if (work[k] > most * work[k - 1]) {
            most = work[k] / work[k - 1];
            split = work[k - 1];
        }
    }
    return split;
}

static bool find_grid(axis *a, const double *value, size_t n, double *work, size_t *place) {
    double range = value[n - 1] - value[0], same = SAME * range;
    if (!(range > 0)) {
        return false;
    }
    double margin = 1.1 * half_digit(value, n), split = find_split(work, value, n, same);
    size_t m = gather(work, value, n, same);
    if (try_columns(a, value, n, work, m, place, false, margin)) {
        return true;
    }
    m = gather(work, value, n, split);
    if (split > same && try_columns(a, value, n, work, m, place, false, 0)) {
        return true;
    }
    m = gather(work, value, n, same);
    return try_columns(a, value, n, work, m, place, true, 0);
}

/* Finds the even grid of one column of the table; a->n is 0 if there is none. */
static haft_status find_axis(axis *a, const haft_map_table *t, size_t column, haft_error *error) {
    double *value = haft_memory_alloc(t->rows, sizeof *value, error);
    double *work = value != NULL ? haft_memory_alloc(t->rows, sizeof *work, error) : NULL;
    size_t *place = work != NULL ? haft_memory_alloc(t->rows, sizeof *place, error) : NULL;
    haft_status status = place == NULL ? HAFT_ERROR_MEMORY : HAFT_OK;
    if (status == HAFT_OK) {
        for (size_t i = 0; i < t->rows; i++) {
            value[i] = t->value[3 * i + column];
        }
        qsort(value, t->rows, sizeof *value, compare);
        if (!find_grid(a, value, t->rows, work, place)) {
            a->n = 0;
        }
    }
    haft_memory_free(value);
    haft_memory_free(work);
    haft_memory_free(place);
    return status;
}

static bool have_places(const haft_map_table *t) {
    for (size_t i = 0; i < 3 * t->rows; i++) {
        if (isnan(t->value[i]) && i % 3 != 2) {
            return false;
        }
    }
    return true;
}

haft_status haft_map_looks_like_points(bool *points, const haft_map_table *table,
                                       haft_error *error) {
    axis x = {.n = 0}, y = {.n = 0};
    *points = false;
    if (table->rows < 9 || !have_places(table)) {
        return HAFT_OK;
    }
    haft_status status = find_axis(&x, table, 0, error);
    if (status == HAFT_OK && x.n >= 3) {
        status = find_axis(&y, table, 1, error);
    }
    *points = x.n >= 3 && y.n >= 3 && x.n * y.n == table->rows;
    return status;
}

/* ---- the map ---- */

/* Puts the heights onto the map, or destroys it. */
static haft_status place_points(haft_map **out, const haft_map_file *file, const haft_map_table *t,
                                const axis a[2], double unit, haft_error *error) {
    haft_map *map = *out;
    for (size_t i = 0; i < map->rows * map->columns; i++) {
        map->z[i] = NAN;
    }
    unsigned char *taken = haft_memory_alloc(map->rows * map->columns, 1, error);
    haft_status status = taken == NULL ? HAFT_ERROR_MEMORY : HAFT_OK;
    for (size_t k = 0; k < t->rows && status == HAFT_OK; k++) {
        const double *point = t->value + 3 * k;
        size_t j = (size_t)llround((point[0] - a[0].first) / a[0].step);
        size_t i = map->rows - 1 - (size_t)llround((point[1] - a[1].first) / a[1].step);
        size_t at = i * map->columns + j;
        if (taken[at]) {
            status = haft_error_set(error, HAFT_ERROR_INPUT,
                                    "%s: two points at x = %g, y = %g; leave one out", file->path,
                                    point[0], point[1]);
        }
        taken[at] = 1;
        map->z[at] = point[2];
    }
    haft_memory_free(taken);
    if (status != HAFT_OK) {
        haft_map_destroy(out);
        return status;
    }
    return haft_map_end(out, file, unit, error);
}

/* Lengths of one step of the grid: from the unit of the coordinates, or the size of the whole map.
 */
static haft_status find_pixels(double pixel[2], const haft_map_file *file, const axis a[2],
                               const haft_map_title *title, haft_error *error) {
    const double size[2] = {file->options.width, file->options.height};
    for (int k = 0; k < 2; k++) {
        double unit =
            title->lateral[k].value > 0 ? title->lateral[k].value : file->options.lateral_unit;
        double span = unit * a[k].step * (double)a[k].n;
        pixel[k] = unit > 0 ? unit * a[k].step : size[k] / (double)a[k].n;
        if (unit > 0 && size[k] > 0 && fabs(size[k] - span) > 1.01 * pixel[k] + 0.01 * span) {
            return haft_error_set(
                error, HAFT_ERROR_INPUT,
                "%s: the points' %s span %g m in their unit of %g m, but a size of "
                "%g m is given; leave one out",
                file->path, k == 0 ? "x" : "y", span, unit, size[k]);
        }
    }
    return HAFT_OK;
}

static haft_status check_points(const haft_map_file *file, const haft_map_table *t,
                                const haft_map_title *title, haft_error *error) {
    const haft_map_options *o = &file->options;
    bool placed = o->lateral_unit > 0 || o->width > 0 ||
                  (title->lateral[0].value > 0 && title->lateral[1].value > 0);
    if (!placed || !(title->unit.value > 0 || o->unit > 0)) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "%s: three columns of points x, y, z; give the unit of x and y, as um, "
            "and that of heights, as nm (for a matrix three pixels wide give its "
            "size)",
            file->path);
    }
    for (size_t i = 0; i < 3 * t->rows; i++) {
        if (isnan(t->value[i]) && i % 3 != 2) {
            return haft_error_set(error, HAFT_ERROR_INPUT, "%s: point %zu has no place", file->path,
                                  i / 3 + 1);
        }
    }
    return HAFT_OK;
}

haft_status haft_map_from_points(haft_map **out, const haft_map_file *file, const haft_map_table *t,
                                 const haft_map_title *title, haft_error *error) {
    axis a[2];
    double pixel[2] = {0, 0};
    haft_status status = check_points(file, t, title, error);
    for (size_t k = 0; k < 2 && status == HAFT_OK; k++) {
        status = find_axis(&a[k], t, k, error);
        if (status == HAFT_OK && a[k].n == 0) {
            status = haft_error_set(error, HAFT_ERROR_INPUT,
                                    "%s: the points' %s are not on an even grid; interpolate them "
                                    "onto one first",
                                    file->path, k == 0 ? "x" : "y");
        }
    }
    if (status == HAFT_OK && (double)a[0].n * (double)a[1].n > 2 * (double)t->rows) {
        status = haft_error_set(error, HAFT_ERROR_INPUT,
                                "%s: %zu points on a grid of %zu x %zu leave more than half of it "
                                "empty; the file is cut short, or the points are on no grid",
                                file->path, t->rows, a[1].n, a[0].n);
    }
    HAFT_THEN(status, find_pixels(pixel, file, a, title, error));
    HAFT_THEN(status, haft_map_create(out, a[1].n, a[0].n, pixel[1], pixel[0], error));
    if (status == HAFT_OK) {
        double unit = title->unit.value > 0 ? title->unit.value : file->options.unit;
        status = place_points(out, file, t, a, unit, error);
    }
    return status;
}
