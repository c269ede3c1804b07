/* SPDX-License-Identifier: GPL-3.0-or-later */
/* f(d) of a patch. One pass over the heights counts them into the intervals between the distances
 * less the capillary range, which gives the wet area at all distances at once, and lists the few
 * points above the lowest distance for the asperities. Elastic interaction of asperities is left
 * out. */
#include <math.h>
#include <string.h>

#include "contact/patch.h"

double haft_contact_modulus(double young_1, double poisson_1, double young_2, double poisson_2) {
    return 1 / ((1 - poisson_1 * poisson_1) / young_1 + (1 - poisson_2 * poisson_2) / young_2);
}

haft_status haft_contact_work_create(haft_contact_work **out, size_t rows, size_t columns,
                                     haft_error *error) {
    *out = NULL;
    size_t framed = 0;
    if (rows < 3 || columns < 3 || __builtin_mul_overflow(rows + 2, columns + 2, &framed) ||
        framed > INT32_MAX) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                              "a patch of %zu x %zu points; it needs at least 3 x 3 and at most "
                              "2^31 points in all",
                              rows, columns);
    }
    haft_contact_work *work = haft_memory_alloc(1, sizeof *work, error);
    if (work == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    size_t tops = ((rows + 1) / 2) * ((columns + 1) / 2);
    work->rows = rows;
    work->columns = columns;
    work->found = haft_memory_alloc(framed + 2, sizeof *work->found, error);
    work->spare = haft_memory_alloc(framed + 2, sizeof *work->found, error);
    work->top_a = haft_memory_alloc(tops, sizeof *work->top_a, error);
    work->top_b = haft_memory_alloc(tops, sizeof *work->top_b, error);
    work->top_count = haft_memory_alloc(tops, sizeof *work->top_count, error);
    work->top_parent = haft_memory_alloc(tops, sizeof *work->top_parent, error);
    work->top_live = haft_memory_alloc(tops, sizeof *work->top_live, error);
    if (work->found == NULL || work->spare == NULL || work->top_a == NULL || work->top_b == NULL ||
        work->top_count == NULL || work->top_parent == NULL || work->top_live == NULL) {
        haft_contact_work_destroy(&work);
        return HAFT_ERROR_MEMORY;
    }
    *out = work;
    return HAFT_OK;
}

void haft_contact_work_destroy(haft_contact_work **work) {
    if (work == NULL || *work == NULL) {
        return;
    }
    haft_contact_work *w = *work;
    haft_memory_free(w->level_data);
    haft_memory_free(w->counts);
    haft_memory_free(w->found);
    haft_memory_free(w->spare);
    haft_memory_free(w->top_a);
    haft_memory_free(w->top_b);
    haft_memory_free(w->top_count);
    haft_memory_free(w->top_parent);
    haft_memory_free(w->top_live);
    haft_memory_free(w);
    *work = NULL;
}

static haft_status make_room(haft_contact_work *work, size_t levels, haft_error *error) {
    if (levels <= work->levels) {
        return HAFT_OK;
    }
    haft_memory_free(work->level_data);
    haft_memory_free(work->counts);
    work->levels = 0;
    work->level_data = haft_memory_alloc(levels + 1, 5 * sizeof *work->level_data, error);
    work->counts = haft_memory_alloc(levels + 1, HAFT_CONTACT_LANES * sizeof *work->counts, error);
    if (work->level_data == NULL || work->counts == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    work->levels = levels;
    return HAFT_OK;
}

static haft_status check_curve(const haft_curve *curve, haft_error *error) {
    size_t n = curve->n;
    const double *d = curve->distance;
    if (n < 2 || n > INT32_MAX) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                              "a curve of %zu distances; it needs at least 2", n);
    }
    double step = (d[n - 1] - d[0]) / (double)(n - 1);
    for (size_t i = 0; i < n; i++) {
        if (!(step > 0) || !(fabs(d[i] - (d[0] + (double)i * step)) <= 1e-6 * step)) {
            return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                                  "distance %zu, %g m, is off an even, increasing grid; %g m would "
                                  "be on it",
                                  i, d[i], d[0] + (double)i * step);
        }
    }
    return HAFT_OK;
}

static haft_status check(const haft_contact_work *work, const haft_contact_spec *spec,
                         const haft_patch *patch, const haft_curve *curve, haft_error *error) {
    if (patch->rows < 3 || patch->columns < 3 || patch->rows > work->rows ||
        patch->columns > work->columns) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                              "a patch of %zu x %zu points does not fit; give at least 3 x 3 and "
                              "at most %zu x %zu",
                              patch->rows, patch->columns, work->rows, work->columns);
    }
    if (!(patch->step > 0 && isfinite(patch->step)) ||
        !(spec->modulus > 0 && isfinite(spec->modulus))) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                              "grid step (%g m) and modulus (%g Pa) must be positive", patch->step,
                              spec->modulus);
    }
    if (spec->has_capillary && (!(spec->pressure <= 0 && isfinite(spec->pressure)) ||
                                !(spec->capillary_range >= 0 && isfinite(spec->capillary_range)))) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                              "a Laplace pressure of %g Pa with a range of %g m; the pressure must "
                              "not be positive, nor the range negative",
                              spec->pressure, spec->capillary_range);
    }
    return check_curve(curve, error);
}

static haft_levels make_levels(double *data, const haft_curve *curve, double shift) {
    size_t n = curve->n;
    for (size_t i = 0; i < n; i++) {
        data[i] = curve->distance[i] - shift;
    }
    data[n] = INFINITY;
    return (haft_levels){n, data[0], (double)(n - 1) / (data[n - 1] - data[0]), data};
}

/* Points gone through at a time: they stay in the nearest cache for all that is asked of them. */
enum { CHUNK = 256, BUNCH = 16, LANES = HAFT_CONTACT_LANES };

/* The part of haft_levels_below() that takes no looking up, many at an instruction. */
static void find_nearest(const haft_levels *levels, const double *restrict z, size_t n,
                         int32_t *restrict nearest) {
    double first = levels->first, per_step = levels->per_step, last = (double)levels->n;
    for (size_t j = 0; j < n; j++) {
        double x = (z[j] - first) * per_step + 0.5;
        x = x > 0 ? x : 0;
        x = x < last ? x : last;
        nearest[j] = (int32_t)x;
    }
}

/* Counts LANES times by turns, for neighbours fall into the same interval and would wait on each
 * other. */
static void count_wet(const haft_levels *levels, const double *z, size_t n, uint32_t *counts) {
    int32_t nearest[CHUNK];
    find_nearest(levels, z, n, nearest);
    for (size_t j = 0; j < n; j++) {
        size_t level = (size_t)nearest[j] + (levels->at[nearest[j]] < z[j]);
        counts[LANES * level + j % LANES]++;
    }
}

/* Whether any of BUNCH points is above d. */
static inline bool any_above(double d, const double *z) {
    double top[LANES] = {d, d, d, d};
    for (size_t j = 0; j < BUNCH; j += LANES) {
        for (size_t k = 0; k < LANES; k++) {
            top[k] = z[j + k] > top[k] ? z[j + k] : top[k];
        }
    }
    return top[0] > d || top[1] > d || top[2] > d || top[3] > d;
}

static size_t list_above(double d, const double *z, uint32_t first, size_t n, uint32_t *found) {
    size_t k = 0;
    for (size_t start = 0; start < n; start += BUNCH) {
        size_t count = n - start < BUNCH ? n - start : BUNCH;
        if (count == BUNCH && !any_above(d, z + start)) {
            continue;
        }
        for (size_t j = start; j < start + count; j++) {
            found[k] = first + (uint32_t)j;
            k += z[j] > d;
        }
    }
    return k;
}

/* 0 z is no number just where z is not finite, and a sum keeps that. */
static bool all_finite(const double *z, size_t n) {
    double sum[LANES] = {0};
    size_t j = 0;
    for (; j + LANES <= n; j += LANES) {
        for (size_t k = 0; k < LANES; k++) {
            sum[k] += 0 * z[j + k];
        }
    }
    for (; j < n; j++) {
        sum[0] += 0 * z[j];
    }
    return !isnan((sum[0] + sum[1]) + (sum[2] + sum[3]));
}

/* The one pass; false if a height is not finite, the first of them in the row *row. */
static bool scan(haft_contact_work *work, const haft_patch *patch, const haft_levels *levels,
                 const haft_levels *wet, size_t *above, size_t *row) {
    size_t points = patch->rows * patch->columns, found = 0;
    memset(work->counts, 0, LANES * (levels->n + 1) * sizeof *work->counts);
    for (size_t start = 0; start < points; start += CHUNK) {
        size_t n = points - start < CHUNK ? points - start : CHUNK;
        const double *z = patch->z + start;
        if (!all_finite(z, n)) {
            size_t j = 0;
            while (fabs(z[j]) < INFINITY) {
                j++;
            }
            *row = (start + j) / patch->columns;
            return false;
        }
        if (wet != NULL) {
            count_wet(wet, z, n, work->counts);
        }
        found += list_above(levels->at[0], z, (uint32_t)start, n, work->found + found);
    }
    *above = found;
    return true;
}

/* Shares of points above each wet level, into `share`; 0 without water. */
static void share_wet(const haft_contact_work *work, const haft_patch *patch, size_t n,
                      double *share) {
    uint64_t points = 0;
    double all = (double)patch->rows * (double)patch->columns;
    for (size_t j = n; j-- > 0;) {
        for (size_t lane = 0; lane < LANES; lane++) {
            points += work->counts[LANES * (j + 1) + lane];
        }
        share[j] = (double)points / all;
    }
}

static void put_together(const haft_contact_spec *spec, const haft_patch *patch,
                         const haft_tally *tally, const double *wet, haft_curve *curve) {
    double nominal = (double)patch->rows * (double)patch->columns * patch->step * patch->step;
    for (size_t j = 0; j < curve->n; j++) {
        double contact = tally->area[j] / nominal;
        double force = 4.0 / 3.0 * spec->modulus * tally->push[j] / nominal;
        if (spec->has_capillary) {
            force += spec->pressure * fmax(wet[j] - contact, 0);
        }
        curve->force[j] = force;
        if (curve->contact_area != NULL) {
            curve->contact_area[j] = contact;
        }
        if (curve->wet_area != NULL) {
            curve->wet_area[j] = wet[j];
        }
        if (curve->asperities != NULL) {
            curve->asperities[j] = tally->number[j] / nominal;
        }
    }
}

haft_status haft_contact_curve(haft_contact_work *work, const haft_contact_spec *spec,
                               const double *z, size_t rows, size_t columns, double step,
                               haft_curve *curve, haft_error *error) {
    haft_patch patch = {z, rows, columns, step};
    haft_status status = check(work, spec, &patch, curve, error);
    if (status == HAFT_OK) {
        status = make_room(work, curve->n, error);
    }
    if (status != HAFT_OK) {
        return status;
    }
    haft_adhesion adhesion = {0};
    if (spec->has_vdw) {
        status = haft_adhesion_make(&adhesion, spec, (double)rows, (double)columns, step, error);
    }
    if (status != HAFT_OK) {
        return status;
    }
    bool summits = spec->asperities == HAFT_ASPERITY_SUMMITS;
    size_t n = curve->n, above = 0, row = 0;
    double *data = work->level_data;
    haft_levels levels = make_levels(data, curve, summits ? adhesion.reach : adhesion.range);
    /* The wet levels have done their work when the pass is over: their shares take their place. */
    double *wet_data = data + n + 1;
    haft_levels wet = make_levels(wet_data, curve, spec->has_capillary ? spec->capillary_range : 0);
    if (!scan(work, &patch, &levels, spec->has_capillary ? &wet : NULL, &above, &row)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "a height in row %zu of the patch is not finite", row);
    }
    share_wet(work, &patch, n, wet_data);
    haft_tally tally = {data + 2 * (n + 1), data + 3 * (n + 1), data + 4 * (n + 1)};
    const haft_adhesion *given = spec->has_vdw ? &adhesion : NULL;
    (summits ? haft_contact_summits : haft_contact_islands)(work, &patch, &levels, above, given,
                                                            &tally);
    put_together(spec, &patch, &tally, wet_data, curve);
    return HAFT_OK;
}
