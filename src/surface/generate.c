/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Surfaces by overlap-save convolution of lattice noise, and zero-padded interpolation.
 *
 * Cell (r, c) of the lattice, with r along the beam from its corner and c across it, contains
 * number COLUMN_ORIGIN + c of the stream with counter (realization, stream * 2^32 + ROW_ORIGIN +
 * r). So any part of any row can be drawn alone. The origins leave room for the negative indices of
 * the halo. A block's noise is transformed across the beam. Then, one tile of columns at a time, it
 * is transformed along the beam, multiplied by the kernel's transform and transformed back to fine
 * rows; those of the halo are dropped. Wave numbers beyond the lattice's band use the periodic
 * images of the noise spectrum. So the kernel stays compact, and blocks join to round-off. The
 * inverse transform across the beam is done when rows are requested; the fine block is never stored
 * as a whole.
 *
 * Limits: streams below 2^32, lattice rows within 2^31 of the corner. */
#include "surface/marginal.h"
#include "surface/plan.h"

#include <string.h>

static const uint64_t ROW_ORIGIN = UINT64_C(1) << 31;
static const uint64_t COLUMN_ORIGIN = UINT64_C(1) << 31;

struct haft_surface_work {
    const haft_surface_plan *plan;
    bool prepared;
    surface_sizes sizes;
    fftw_complex *field;        /* [lattice or fine rows][field_columns] */
    fftw_complex *noise, *tile; /* [SURFACE_TILE][lattice rows] before and after the transform */
    fftw_complex *product;      /* [fine rows] */
    fftw_complex *spread;       /* [SURFACE_TILE][fine rows] */
    fftw_complex *row_complex;
    double *row_real;
};

haft_status haft_surface_work_create(haft_surface_work **out, const haft_surface_plan *plan,
                                     haft_error *error) {
    *out = NULL;
    haft_surface_work *work = haft_memory_alloc(1, sizeof *work, error);
    if (work == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    work->plan = plan;
    surface_sizes sizes = work->sizes = haft_surface_plan_sizes(plan);
    work->field = haft_memory_alloc(sizes.field, sizeof *work->field, error);
    work->noise = haft_memory_alloc(sizes.tile, sizeof *work->noise, error);
    work->product = haft_memory_alloc(plan->along.fine, sizeof *work->product, error);
    work->tile = haft_memory_alloc(sizes.tile, sizeof *work->tile, error);
    work->spread = haft_memory_alloc(sizes.spread, sizeof *work->spread, error);
    work->row_complex = haft_memory_alloc(sizes.row_complex, sizeof *work->row_complex, error);
    work->row_real = haft_memory_alloc(sizes.row_real, sizeof *work->row_real, error);
    if (work->field == NULL || work->noise == NULL || work->tile == NULL || work->product == NULL ||
        work->spread == NULL || work->row_complex == NULL || work->row_real == NULL) {
        haft_surface_work_destroy(&work);
        return HAFT_ERROR_MEMORY;
    }
    *out = work;
    return HAFT_OK;
}

void haft_surface_work_destroy(haft_surface_work **work) {
    if (work == NULL || *work == NULL) {
        return;
    }
    haft_memory_free((*work)->field);
    haft_memory_free((*work)->noise);
    haft_memory_free((*work)->tile);
    haft_memory_free((*work)->product);
    haft_memory_free((*work)->spread);
    haft_memory_free((*work)->row_complex);
    haft_memory_free((*work)->row_real);
    haft_memory_free(*work);
    *work = NULL;
}

/* Number of columns kept of the noise's half spectrum. */
static size_t source_columns(const haft_surface_plan *plan) {
    size_t half = plan->across.lattice / 2;
    return (plan->across.cut < half ? plan->across.cut : half) + 1;
}

/* The noise of the block's lattice rows, including the halo, transformed across the beam. */
static void transform_noise(haft_surface_work *work, uint64_t realization, uint64_t stream,
                            long first) {
    const haft_surface_plan *plan = work->plan;
    size_t drawn_rows = plan->along.interior + 2 * plan->halo;
    size_t drawn = plan->across.interior + 2 * plan->halo;
    size_t kept = source_columns(plan);
    uint64_t column = COLUMN_ORIGIN - plan->halo;
    for (size_t i = 0; i < plan->along.lattice; i++) {
        fftw_complex *line = work->field + i * work->sizes.field_columns;
        if (i >= drawn_rows) {
            memset(line, 0, kept * sizeof *line);
            continue;
        }
        uint64_t row = ROW_ORIGIN + (uint64_t)(first + (long)i - (long)plan->halo);
        haft_random_normals(plan->spec.key, realization, (stream << 32) + row, column, drawn,
                            work->row_real);
        memset(work->row_real + drawn, 0, (plan->across.lattice - drawn) * sizeof(double));
        fftw_execute_dft_r2c(plan->row_forward, work->row_real, work->row_complex);
        memcpy(line, work->row_complex, kept * sizeof *line);
    }
}

/* Kernel times noise spectrum for one column of fine wave numbers. If `mirrored`, the column is
 * beyond the half spectrum, and its noise is the conjugate at the opposite wave number. */
static void multiply_column(const haft_surface_plan *plan, const fftw_complex *noise, size_t n,
                            bool mirrored, fftw_complex *out) {
    size_t lattice = plan->along.lattice, fine = plan->along.fine, top = plan->disc[n];
    const double *kernel = plan->transform + n * (plan->along.cut + 1);
    memset(out + top + 1, 0, (fine - top - 1) * sizeof *out);
    size_t up = 0, down = 0; /* m and -m, modulo the lattice's length */
    for (size_t m = 0; m <= top; m++) {
        fftw_complex plus = noise[up], minus = noise[down];
        if (mirrored) {
            fftw_complex swap = plus;
            plus = conj(minus);
            minus = conj(swap);
        }
        out[m] = kernel[m] * plus;
        if (m > 0 && 2 * m < fine) {
            out[fine - m] = kernel[m] * minus;
        }
        up = up + 1 == lattice ? 0 : up + 1;
        down = down == 0 ? lattice - 1 : down - 1;
    }
}

/* Copies the block's fine rows from work->spread to columns [first, first + n) of the field. */
static void scatter_rows(haft_surface_work *work, size_t first, size_t n) {
    const haft_surface_plan *plan = work->plan;
    size_t fine = plan->along.fine, offset = plan->halo * plan->ratio;
    for (size_t i = 0; i < plan->spec.rows; i++) {
        fftw_complex *line = work->field + i * work->sizes.field_columns + first;
        for (size_t b = 0; b < n; b++) {
            line[b] = work->spread[b * fine + offset + i];
        }
    }
}

/* multiply_column(), inverse transform and scatter_rows() for the noise columns [first, first + n)
 * of a tile. They become columns base + first... (mirrored: base - first - n + 1...) of the fine
 * spectrum, unless these are beyond its cut or were done already. */
static void emit_tile(haft_surface_work *work, size_t first, size_t n, size_t base, bool mirrored) {
    const haft_surface_plan *plan = work->plan;
    size_t half = plan->across.lattice / 2, cut = plan->across.cut;
    size_t low = mirrored ? base - (first + n - 1) : base + first;
    size_t count = 0, start = 0;
    for (size_t b = 0; b < n; b++) {
        size_t target = low + b;
        size_t source = mirrored ? base - target : target - base;
        bool twice = mirrored && (source == 0 || source == half);
        if (target > cut || twice) {
            if (count == 0 && twice) {
                continue;
            }
            break;
        }
        if (count == 0) {
            start = target;
        }
        multiply_column(plan, work->tile + (source - first) * plan->along.lattice, target, mirrored,
                        work->product);
        fftw_execute_dft(plan->column_inverse, work->product,
                         work->spread + count * plan->along.fine);
        count++;
    }
    if (count > 0) {
        scatter_rows(work, start, count);
    }
}

static void transform_tile(haft_surface_work *work, size_t first, size_t n) {
    const haft_surface_plan *plan = work->plan;
    size_t lattice = plan->along.lattice, width = plan->across.lattice;
    for (size_t i = 0; i < lattice; i++) {
        const fftw_complex *line = work->field + i * work->sizes.field_columns + first;
        for (size_t b = 0; b < n; b++) {
            work->noise[b * lattice + i] = line[b];
        }
    }
    for (size_t b = 0; b < n; b++) {
        fftw_execute_dft(plan->column_forward, work->noise + b * lattice, work->tile + b * lattice);
    }
    for (size_t base = 0; base <= plan->across.cut + width / 2; base += width) {
        emit_tile(work, first, n, base, false);
        if (base > 0) {
            emit_tile(work, first, n, base, true);
        }
    }
}

haft_status haft_surface_prepare(haft_surface_work *work, uint64_t realization, uint64_t stream,
                                 long first_row, haft_error *error) {
    const haft_surface_plan *plan = work->plan;
    long ratio = (long)plan->ratio, limit = 1L << 30;
    work->prepared = false;
    if (stream >> 32 != 0) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT, "stream %llu is not below 2^32",
                              (unsigned long long)stream);
    }
    if (first_row % ratio != 0 || first_row < -limit || first_row > limit) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                              "first row %ld must be a multiple of %ld within 2^30 of the corner",
                              first_row, ratio);
    }
    transform_noise(work, realization, stream, first_row / ratio);
    size_t sources = source_columns(plan);
    for (size_t first = 0; first < sources; first += SURFACE_TILE) {
        size_t n = sources - first < SURFACE_TILE ? sources - first : SURFACE_TILE;
        transform_tile(work, first, n);
    }
    work->prepared = true;
    return HAFT_OK;
}

haft_status haft_surface_rows(haft_surface_work *work, size_t row, size_t n, double *z,
                              haft_error *error) {
    const haft_surface_plan *plan = work->plan;
    size_t columns = plan->spec.columns;
    if (!work->prepared) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT, "rows asked of a block not prepared");
    }
    if (row > plan->spec.rows || n > plan->spec.rows - row) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                              "rows %zu to %zu asked of a block of %zu rows", row, row + n,
                              plan->spec.rows);
    }
    size_t kept = work->sizes.field_columns;
    for (size_t i = 0; i < n; i++) {
        memcpy(work->row_complex, work->field + (row + i) * kept, kept * sizeof *work->field);
        memset(work->row_complex + kept, 0, (work->sizes.row_complex - kept) * sizeof *work->field);
        fftw_execute_dft_c2r(plan->row_inverse, work->row_complex, work->row_real);
        memcpy(z + i * columns, work->row_real + plan->halo * plan->ratio, columns * sizeof *z);
        if (plan->spec.marginal != NULL) {
            haft_marginal_apply(plan->spec.marginal, plan->scale_in, plan->facts.deviation, columns,
                                z + i * columns);
        }
    }
    return HAFT_OK;
}
