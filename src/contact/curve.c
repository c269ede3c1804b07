/* SPDX-License-Identifier: GPL-3.0-or-later */
/* f(d) of a patch. One pass over the heights counts them for the wet area at all distances, and
 * lists the few points above the lowest distance for the asperities. Curves that differ only in the
 * water share this pass and the asperities. Elastic interaction of asperities is neglected. */
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

/* Frees the arrays of make_room(). */
static void free_room(haft_contact_work *work) {
    haft_memory_free(work->level_data);
    haft_memory_free(work->wet.at);
    haft_memory_free(work->wet.of);
    haft_memory_free(work->wet.start);
    haft_memory_free(work->counts);
    haft_memory_free(work->shift);
    haft_memory_free(work->next);
    work->level_data = work->shift = NULL;
    work->counts = NULL;
    work->next = NULL;
    work->wet = (haft_wet){0};
    work->levels = work->curves = 0;
}

void haft_contact_work_destroy(haft_contact_work **work) {
    if (work == NULL || *work == NULL) {
        return;
    }
    haft_contact_work *w = *work;
    free_room(w);
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

static haft_status make_room(haft_contact_work *work, size_t curves, size_t levels,
                             haft_error *error) {
    if (levels <= work->levels && curves <= work->curves) {
        return HAFT_OK;
    }
    levels = levels > work->levels ? levels : work->levels;
    curves = curves > work->curves ? curves : work->curves;
    free_room(work);
    haft_wet *wet = &work->wet;
    size_t held = curves * (levels + 1);
    work->level_data = haft_memory_alloc(4 * (levels + 1) + held, sizeof(double), error);
    wet->at = haft_memory_alloc(held, sizeof *wet->at, error);
    wet->of = haft_memory_alloc(held, sizeof *wet->of, error);
    wet->start = haft_memory_alloc(HAFT_WET_BINS, sizeof *wet->start, error);
    wet->counts = work->counts =
        haft_memory_alloc(held, HAFT_CONTACT_PARTIALS * sizeof *work->counts, error);
    work->shift = haft_memory_alloc(curves, sizeof *work->shift, error);
    work->next = haft_memory_alloc(curves, sizeof *work->next, error);
    if (!work->level_data || !wet->at || !wet->of || !wet->start || !wet->counts || !work->shift ||
        !work->next) {
        free_room(work);
        return HAFT_ERROR_MEMORY;
    }
    work->levels = levels;
    work->curves = curves;
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

enum { CHUNK = HAFT_CONTACT_CHUNK, BUNCH = 16, PARTIALS = HAFT_CONTACT_PARTIALS };

/* Whether any of BUNCH points is above d. */
static inline bool any_above(double d, const double *z) {
    double top[PARTIALS] = {d, d, d, d};
    for (size_t j = 0; j < BUNCH; j += PARTIALS) {
        for (size_t k = 0; k < PARTIALS; k++) {
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

/* 0 z is NAN exactly if z is not finite, and a NAN stays in the sum. */
static bool all_finite(const double *z, size_t n) {
    double sum[PARTIALS] = {0};
    size_t j = 0;
    for (; j + PARTIALS <= n; j += PARTIALS) {
        for (size_t k = 0; k < PARTIALS; k++) {
            sum[k] += 0 * z[j + k];
        }
    }
    for (; j < n; j++) {
        sum[0] += 0 * z[j];
    }
    return !isnan((sum[0] + sum[1]) + (sum[2] + sum[3]));
}

/* n curves of one patch, with a spec for each. */
typedef struct request {
    const haft_patch *patch;
    size_t n;
    const haft_contact_spec *spec;
    haft_curve *curve;
} request;

/* Whether two curves have the same tally: they may differ only in the water. */
static bool same_asperities(const request *q, size_t i, size_t j) {
    const haft_contact_spec *a = &q->spec[i], *b = &q->spec[j];
    const haft_vdw *v = &a->vdw, *w = &b->vdw;
    bool vdw = a->has_vdw == b->has_vdw &&
               (!a->has_vdw || (a->path == b->path && v->energy == w->energy &&
                                v->stress == w->stress && v->range == w->range));
    size_t n = q->curve[i].n;
    return vdw && a->asperities == b->asperities && a->modulus == b->modulus &&
           q->curve[j].n == n &&
           memcmp(q->curve[i].distance, q->curve[j].distance, n * sizeof(double)) == 0;
}

/* Sets up the wet thresholds of the curves from `first` on that share its asperities and have
 * water. @return the number of these curves */
static size_t set_up_wet(haft_contact_work *work, const request *q, size_t first) {
    const haft_curve *curve = &q->curve[first];
    size_t count = 0;
    for (size_t j = first; j < q->n; j++) {
        if (q->spec[j].has_capillary && same_asperities(q, first, j)) {
            work->shift[count++] = q->spec[j].capillary_range;
        }
    }
    if (count > 0) {
        haft_wet_set_up(&work->wet, count, work->shift, curve->distance, curve->n, work->next);
    }
    return count;
}

/* The pass over the heights for all curves with the same asperities; false if a height is not
 * finite; *row is the row of the first such height. */
static bool scan(haft_contact_work *work, const haft_patch *patch, double lowest, bool wet,
                 size_t *above, size_t *row) {
    size_t points = patch->rows * patch->columns, found = 0;
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
        if (wet) {
            haft_wet_count(&work->wet, z, n);
        }
        found += list_above(lowest, z, (uint32_t)start, n, work->found + found);
    }
    *above = found;
    return true;
}

/* The curve from a tally and the shares of wet points (NULL without water). */
static void put_together(const haft_contact_spec *spec, const haft_patch *patch,
                         const haft_tally *tally, const double *wet, haft_curve *curve) {
    double nominal = (double)patch->rows * (double)patch->columns * patch->step * patch->step;
    for (size_t j = 0; j < curve->n; j++) {
        double contact = tally->area[j] / nominal;
        double force = 4.0 / 3.0 * spec->modulus * tally->push[j] / nominal;
        if (wet != NULL) {
            force += spec->pressure * fmax(wet[j] - contact, 0);
        }
        curve->force[j] = force;
        if (curve->contact_area != NULL) {
            curve->contact_area[j] = contact;
        }
        if (curve->wet_area != NULL) {
            curve->wet_area[j] = wet != NULL ? wet[j] : 0;
        }
        if (curve->asperities != NULL) {
            curve->asperities[j] = tally->number[j] / nominal;
        }
    }
}

/* Makes the curves from `first` on that share its asperities. */
static haft_status make_alike(haft_contact_work *work, const request *q, size_t first,
                              haft_error *error) {
    const haft_contact_spec *spec = &q->spec[first];
    const haft_patch *patch = q->patch;
    haft_adhesion adhesion = {0};
    if (spec->has_vdw) {
        HAFT_TRY(haft_adhesion_make(&adhesion, spec, (double)patch->rows, (double)patch->columns,
                                    patch->step, error));
    }
    bool summits = spec->asperities == HAFT_ASPERITY_SUMMITS;
    size_t n = q->curve[first].n, above = 0, row = 0, wet = set_up_wet(work, q, first);
    double *data = work->level_data;
    haft_levels levels =
        make_levels(data, &q->curve[first], summits ? adhesion.reach : adhesion.range);
    if (!scan(work, patch, levels.at[0], wet > 0, &above, &row)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "a height in row %zu of the patch is not finite", row);
    }
    double *share = data + 4 * (n + 1);
    if (wet > 0) {
        haft_wet_shares(&work->wet, (double)patch->rows * (double)patch->columns, share);
    }
    haft_tally tally = {data + n + 1, data + 2 * (n + 1), data + 3 * (n + 1)};
    const haft_adhesion *pull = spec->has_vdw ? &adhesion : NULL;
    if (summits) {
        haft_contact_summits(work, patch, &levels, above, pull, &tally);
    } else {
        haft_contact_islands(work, patch, &levels, above, pull,
                             spec->asperities == HAFT_ASPERITY_FITTED, &tally);
    }
    for (size_t j = first, k = 0; j < q->n; j++) {
        if (same_asperities(q, first, j)) {
            bool is_wet = q->spec[j].has_capillary;
            put_together(&q->spec[j], patch, &tally, is_wet ? share + k++ * n : NULL, &q->curve[j]);
        }
    }
    return HAFT_OK;
}

/* Whether the curve was already made, together with one before it that shares its asperities. */
static bool is_made(const request *q, size_t i) {
    for (size_t j = 0; j < i; j++) {
        if (same_asperities(q, j, i)) {
            return true;
        }
    }
    return false;
}

haft_status haft_contact_curves(haft_contact_work *work, size_t n, const haft_contact_spec *spec,
                                const double *z, size_t rows, size_t columns, double step,
                                haft_curve *curve, haft_error *error) {
    haft_patch patch = {z, rows, columns, step};
    request q = {&patch, n, spec, curve};
    haft_status status = HAFT_OK;
    size_t levels = 0;
    for (size_t i = 0; i < n && status == HAFT_OK; i++) {
        status = check(work, &spec[i], &patch, &curve[i], error);
        levels = curve[i].n > levels ? curve[i].n : levels;
    }
    HAFT_THEN(status, make_room(work, n, levels, error));
    for (size_t i = 0; i < n && status == HAFT_OK; i++) {
        if (!is_made(&q, i)) {
            status = make_alike(work, &q, i, error);
        }
    }
    return status;
}

haft_status haft_contact_curve(haft_contact_work *work, const haft_contact_spec *spec,
                               const double *z, size_t rows, size_t columns, double step,
                               haft_curve *curve, haft_error *error) {
    return haft_contact_curves(work, 1, spec, z, rows, columns, step, curve, error);
}
