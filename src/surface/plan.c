/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A plan: transform lengths, FFTW plans, and the kernel's transform.
 *
 * The kernel is sampled on the fine grid and is even in both directions, so its transform is real
 * and even, and cosine transforms of a quarter of the plane give it. Only wave numbers inside the
 * disc of radius zeta_max + smear are kept; outside, the transform is below exp(-24) of its value
 * at the edge. */
#include "surface/plan.h"

#include "surface/kernel.h"
#include "surface/marginal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double DEFAULT_TOLERANCE = 1e-5;
static const double LEAST_TOLERANCE = 1e-9;

size_t haft_surface_lattice_ratio(const haft_psd *psd, double grid_step) {
    double ratio = M_PI / (psd->zeta_max * grid_step);
    return ratio > 0 && ratio < 1e6 ? (size_t)(ratio * (1 + 1e-12)) : 0;
}

/* Whether n is even, with no prime factor above 7 and at most two factors of 3. With more of those,
 * FFTW's estimated plans take up to twice as long per point. */
static bool is_quick(size_t n) {
    static const size_t primes[] = {2, 3, 5, 7};
    bool quick = n % 2 == 0 && n % 27 != 0;
    for (size_t i = 0; i < 4; i++) {
        while (n % primes[i] == 0) {
            n /= primes[i];
        }
    }
    return quick && n == 1;
}

static surface_axis make_axis(size_t interior, size_t halo, size_t ratio, double grid_step,
                              double cut) {
    surface_axis axis = {.interior = interior, .lattice = interior + 2 * halo};
    while (!is_quick(axis.lattice)) {
        axis.lattice++;
    }
    axis.fine = ratio * axis.lattice;
    double highest = cut * grid_step * (double)axis.fine / (2 * M_PI);
    axis.cut = highest < (double)(axis.fine / 2) ? (size_t)highest : axis.fine / 2;
    return axis;
}

static haft_status check_size(const char *name, size_t size, size_t ratio, haft_error *error) {
    if (size == 0 || size > 1u << 24) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "%s = %zu: must be between 1 and %u", name,
                              size, 1u << 24);
    }
    if (size % ratio != 0) {
        size_t below = size / ratio * ratio;
        size_t above = below + ratio;
        size_t nearest = below == 0 || above - size < size - below ? above : below;
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "%s = %zu: must be a multiple of %zu, the grid steps in a step of the "
            "noise lattice; the nearest is %zu",
            name, size, ratio, nearest);
    }
    return HAFT_OK;
}

static haft_status check_grid(const haft_surface_spec *spec, haft_error *error) {
    if (!(isfinite(spec->grid_step) && spec->grid_step > 0)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "grid step = %g m: must be positive and finite", spec->grid_step);
    }
    double largest = M_PI / spec->psd.zeta_max;
    if (spec->grid_step < largest / HAFT_SURFACE_FINEST) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "grid step = %g nm is finer than waves up to zeta_max = %g rad/um can "
            "use; the smallest step allowed is %.5f nm",
            1e9 * spec->grid_step, 1e-6 * spec->psd.zeta_max,
            ceil(1e14 * largest / HAFT_SURFACE_FINEST) / 1e5);
    }
    if (haft_surface_lattice_ratio(&spec->psd, spec->grid_step) == 0) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "grid step = %g nm is too coarse for waves up to zeta_max = %g "
                              "rad/um; the largest step allowed is %.4f nm",
                              1e9 * spec->grid_step, 1e-6 * spec->psd.zeta_max,
                              floor(1e13 * largest) / 1e4);
    }
    return HAFT_OK;
}

static haft_status check_spec(const haft_surface_spec *spec, haft_error *error) {
    haft_status status = spec->table != NULL ? haft_psd_table_check(spec->table, error)
                                             : haft_psd_check(&spec->psd, error);
    HAFT_THEN(status, check_grid(spec, error));
    if (status != HAFT_OK) {
        return status;
    }
    if (!(spec->tolerance == 0 || (spec->tolerance >= LEAST_TOLERANCE && spec->tolerance <= 0.1))) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "tolerance = %g: must be 0 (for %g) or between %g and 0.1",
                              spec->tolerance, DEFAULT_TOLERANCE, LEAST_TOLERANCE);
    }
    size_t ratio = haft_surface_lattice_ratio(&spec->psd, spec->grid_step);
    status = check_size("rows", spec->rows, ratio, error);
    return status != HAFT_OK ? status : check_size("columns", spec->columns, ratio, error);
}

surface_sizes haft_surface_plan_sizes(const haft_surface_plan *plan) {
    const surface_axis *along = &plan->along, *across = &plan->across;
    size_t rows = along->lattice > plan->spec.rows ? along->lattice : plan->spec.rows;
    return (surface_sizes){
        .field_columns = across->cut + 1,
        .field = rows * (across->cut + 1),
        .tile = SURFACE_TILE * along->lattice,
        .spread = SURFACE_TILE * along->fine,
        .row_real = across->fine,
        .row_complex = across->fine / 2 + 1,
    };
}

/* Cosine transforms of the kernel's rows across the beam: rows[i][n], i in [0, halo * ratio]. */
static haft_status transform_rows(const haft_surface_plan *plan, const surface_kernel *kernel,
                                  double *rows, haft_error *error) {
    size_t length = plan->across.fine / 2 + 1, kept = plan->across.cut + 1;
    size_t extent = plan->halo * plan->ratio;
    double *line = haft_memory_alloc(length, sizeof *line, error);
    if (line == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    fftw_plan fftw = fftw_plan_r2r_1d((int)length, line, line, FFTW_REDFT00, FFTW_ESTIMATE);
    if (fftw == NULL) {
        haft_memory_free(line);
        return haft_error_set(error, HAFT_ERROR_LIBRARY, "FFTW makes no cosine transform of %zu",
                              length);
    }
    double step = plan->spec.grid_step;
    for (size_t i = 0; i <= extent; i++) {
        memset(line, 0, length * sizeof *line);
        for (size_t j = 0; j <= extent && j < length && i * i + j * j < extent * extent; j++) {
            line[j] = haft_surface_kernel_value(kernel, step * hypot((double)i, (double)j));
        }
        fftw_execute(fftw);
        memcpy(rows + i * kept, line, kept * sizeof *line);
    }
    fftw_destroy_plan(fftw);
    haft_memory_free(line);
    return HAFT_OK;
}

/* Cosine transforms along the beam. The table includes the factor 1/points of the inverse
 * transforms. */
static haft_status transform_columns(haft_surface_plan *plan, const double *rows,
                                     haft_error *error) {
    size_t length = plan->along.fine / 2 + 1, kept = plan->across.cut + 1;
    size_t extent = plan->halo * plan->ratio;
    double *line = haft_memory_alloc(length, sizeof *line, error);
    if (line == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    fftw_plan fftw = fftw_plan_r2r_1d((int)length, line, line, FFTW_REDFT00, FFTW_ESTIMATE);
    if (fftw == NULL) {
        haft_memory_free(line);
        return haft_error_set(error, HAFT_ERROR_LIBRARY, "FFTW makes no cosine transform of %zu",
                              length);
    }
    double scale = 1 / ((double)plan->along.fine * (double)plan->across.fine);
    size_t entries = plan->along.cut + 1;
    for (size_t n = 0; n < kept; n++) {
        memset(line, 0, length * sizeof *line);
        for (size_t i = 0; i <= extent && i < length; i++) {
            line[i] = rows[i * kept + n];
        }
        fftw_execute(fftw);
        for (size_t m = 0; m < entries; m++) {
            plan->transform[n * entries + m] = m <= plan->disc[n] ? scale * line[m] : 0;
        }
    }
    fftw_destroy_plan(fftw);
    haft_memory_free(line);
    return HAFT_OK;
}

/* For each wave number across the beam, the highest along it inside the disc of radius `cut`. On
 * the lattice itself (ratio 1), what the taper smears beyond the band is aliased back into it, so
 * all wave numbers of the band are kept then. */
static void fill_disc(haft_surface_plan *plan, double cut) {
    double step = plan->spec.grid_step;
    for (size_t n = 0; n <= plan->across.cut; n++) {
        double across = 2 * M_PI * (double)n / ((double)plan->across.fine * step);
        double rest = sqrt(fmax(0, cut * cut - across * across));
        double highest = rest * step * (double)plan->along.fine / (2 * M_PI);
        bool folded = plan->ratio == 1 && cut * step > M_PI;
        plan->disc[n] =
            folded || highest >= (double)plan->along.cut ? plan->along.cut : (size_t)highest;
    }
}

static haft_status make_transform(haft_surface_plan *plan, const surface_kernel *kernel,
                                  haft_error *error) {
    size_t kept = plan->across.cut + 1;
    plan->disc = haft_memory_alloc(kept, sizeof *plan->disc, error);
    plan->transform =
        haft_memory_alloc(kept * (plan->along.cut + 1), sizeof *plan->transform, error);
    double *rows = haft_memory_alloc(kept * (plan->halo * plan->ratio + 1), sizeof *rows, error);
    haft_status status = HAFT_ERROR_MEMORY;
    if (plan->disc != NULL && plan->transform != NULL && rows != NULL) {
        fill_disc(plan, plan->spec.psd.zeta_max + kernel->smear);
        status = transform_rows(plan, kernel, rows, error);
        HAFT_THEN(status, transform_columns(plan, rows, error));
    }
    haft_memory_free(rows);
    return status;
}

static haft_status make_fftw_plans(haft_surface_plan *plan, haft_error *error) {
    surface_sizes sizes = haft_surface_plan_sizes(plan);
    fftw_complex *noise = haft_memory_alloc(sizes.tile, sizeof *noise, error);
    fftw_complex *tile = haft_memory_alloc(sizes.tile, sizeof *tile, error);
    fftw_complex *product = haft_memory_alloc(plan->along.fine, sizeof *product, error);
    fftw_complex *spread = haft_memory_alloc(sizes.spread, sizeof *spread, error);
    double *real = haft_memory_alloc(sizes.row_real, sizeof *real, error);
    fftw_complex *half = haft_memory_alloc(sizes.row_complex, sizeof *half, error);
    haft_status status = HAFT_ERROR_MEMORY;
    if (noise != NULL && tile != NULL && product != NULL && spread != NULL && real != NULL &&
        half != NULL) {
        int lattice = (int)plan->along.lattice, fine = (int)plan->along.fine;
        plan->row_forward =
            fftw_plan_dft_r2c_1d((int)plan->across.lattice, real, half, FFTW_ESTIMATE);
        plan->column_forward = fftw_plan_dft_1d(lattice, noise, tile, FFTW_FORWARD, FFTW_ESTIMATE);
        plan->column_inverse =
            fftw_plan_dft_1d(fine, product, spread, FFTW_BACKWARD, FFTW_ESTIMATE);
        plan->row_inverse = fftw_plan_dft_c2r_1d((int)plan->across.fine, half, real, FFTW_ESTIMATE);
        bool made = plan->row_forward != NULL && plan->column_forward != NULL &&
                    plan->column_inverse != NULL && plan->row_inverse != NULL;
        status = made ? HAFT_OK
                      : haft_error_set(error, HAFT_ERROR_LIBRARY,
                                       "FFTW makes no plan for a block of %zu x %zu points",
                                       plan->along.fine, plan->across.fine);
    }
    haft_memory_free(noise);
    haft_memory_free(tile);
    haft_memory_free(product);
    haft_memory_free(spread);
    haft_memory_free(real);
    haft_memory_free(half);
    return status;
}

/* How often a mode of the quarter plane occurs in the whole plane. */
static double multiplicity(size_t mode, size_t length) {
    return mode == 0 || 2 * mode == length ? 1 : 2;
}

static double mode_energy(const haft_surface_plan *plan, size_t m, size_t n) {
    double value = plan->transform[n * (plan->along.cut + 1) + m];
    double weight = multiplicity(m, plan->along.fine) * multiplicity(n, plan->across.fine);
    /* Sum of K^2 over the fine points by Parseval, as a mean over the ratio^2 offsets from the
     * lattice. */
    return weight * value * value * (double)plan->along.lattice * (double)plan->across.lattice;
}

static void fill_facts(haft_surface_plan *plan, const surface_kernel *kernel) {
    surface_sizes sizes = haft_surface_plan_sizes(plan);
    haft_surface_facts *facts = &plan->facts;
    facts->lattice_ratio = plan->ratio;
    facts->reach = kernel->reach;
    facts->taper_loss = kernel->loss;
    facts->halo_points = plan->along.fine * plan->across.fine;
    facts->work_bytes =
        (sizes.field + 2 * sizes.tile + sizes.spread + plan->along.fine + sizes.row_complex) *
            sizeof(fftw_complex) +
        sizes.row_real * sizeof(double);
    double step = plan->spec.grid_step, leak = 0;
    for (size_t n = 0; n <= plan->across.cut; n++) {
        double y = 2 * M_PI * (double)n / (double)plan->across.fine;
        for (size_t m = 0; m <= plan->disc[n]; m++) {
            double x = 2 * M_PI * (double)m / (double)plan->along.fine;
            double energy = mode_energy(plan, m, n), c = 1 - cos(x), d = 1 - cos(y);
            double s = sin(x), t = sin(y);
            facts->moments.m0 += energy;
            facts->moments.m2 += energy * 0.5 * (x * x + y * y);
            facts->moments.m4 += energy * 0.5 * (x * x * x * x + y * y * y * y);
            facts->differences.m2 += energy * 0.5 * (s * s + t * t);
            facts->differences.m4 += energy * 0.5 * (4 * c * c + 4 * d * d);
            if (2 * m > plan->along.lattice || 2 * n > plan->across.lattice) {
                leak += energy;
            }
        }
    }
    facts->differences.m0 = facts->moments.m0;
    facts->moments.m2 /= step * step;
    facts->differences.m2 /= step * step;
    facts->moments.m4 /= step * step * step * step;
    facts->differences.m4 /= step * step * step * step;
    facts->leak = leak / facts->moments.m0;
}

/* The PSD to generate: with a marginal, that of its underlying Gaussian surface, stored in
 * *corrected. */
static haft_status choose_radial(surface_radial *radial, haft_psd_table **corrected,
                                 haft_surface_plan *plan, haft_error *error) {
    *radial = haft_surface_radial(&plan->spec.psd, plan->spec.table);
    *corrected = NULL;
    haft_status status = HAFT_OK;
    if (plan->spec.marginal != NULL) {
        status =
            haft_surface_translate(corrected, radial, plan->spec.marginal, &plan->facts, error);
    }
    if (*corrected != NULL) {
        *radial = haft_surface_radial(&plan->spec.psd, *corrected);
    }
    return status;
}

static haft_status build_plan(haft_surface_plan *plan, const surface_radial *radial,
                              haft_error *error) {
    const haft_surface_spec *spec = &plan->spec;
    plan->ratio = haft_surface_lattice_ratio(&spec->psd, spec->grid_step);
    double tolerance = spec->tolerance == 0 ? DEFAULT_TOLERANCE : spec->tolerance;
    surface_kernel kernel;
    HAFT_TRY(haft_surface_kernel_create(&kernel, radial, (double)plan->ratio * spec->grid_step,
                                        tolerance, error));
    plan->halo = kernel.halo;
    double cut = spec->psd.zeta_max + kernel.smear;
    plan->along =
        make_axis(spec->rows / plan->ratio, kernel.halo, plan->ratio, spec->grid_step, cut);
    plan->across =
        make_axis(spec->columns / plan->ratio, kernel.halo, plan->ratio, spec->grid_step, cut);
    haft_status status = make_transform(plan, &kernel, error);
    HAFT_THEN(status, make_fftw_plans(plan, error));
    if (status == HAFT_OK) {
        fill_facts(plan, &kernel);
        plan->scale_in = 1 / sqrt(plan->facts.moments.m0);
    }
    haft_surface_kernel_destroy(&kernel);
    return status;
}

haft_status haft_surface_plan_create(haft_surface_plan **out, const haft_surface_spec *spec,
                                     haft_error *error) {
    *out = NULL;
    haft_surface_plan *plan = haft_memory_alloc(1, sizeof *plan, error);
    if (plan == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    plan->spec = *spec;
    if (spec->marginal != NULL && haft_marginal_is_normal(spec->marginal)) {
        plan->spec.marginal = NULL;
    }
    if (spec->table != NULL && spec->table->n > 0) {
        plan->spec.psd = haft_surface_radial(&spec->psd, spec->table).psd;
    }
    surface_radial radial;
    haft_psd_table *corrected = NULL;
    haft_status status = check_spec(&plan->spec, error);
    HAFT_THEN(status, choose_radial(&radial, &corrected, plan, error));
    HAFT_THEN(status, build_plan(plan, &radial, error));
    haft_psd_table_destroy(&corrected);
    plan->spec.table = NULL; /* owned by the caller, no longer needed */
    if (status != HAFT_OK) {
        haft_surface_plan_destroy(&plan);
    }
    *out = plan;
    return status;
}

void haft_surface_plan_destroy(haft_surface_plan **plan) {
    if (plan == NULL || *plan == NULL) {
        return;
    }
    fftw_plan fftw[] = {(*plan)->row_forward, (*plan)->column_forward, (*plan)->column_inverse,
                        (*plan)->row_inverse};
    for (size_t i = 0; i < sizeof fftw / sizeof *fftw; i++) {
        if (fftw[i] != NULL) {
            fftw_destroy_plan(fftw[i]);
        }
    }
    haft_memory_free((*plan)->transform);
    haft_memory_free((*plan)->disc);
    haft_memory_free(*plan);
    *plan = NULL;
}

void haft_surface_get_facts(const haft_surface_plan *plan, haft_surface_facts *facts) {
    *facts = plan->facts;
}

double haft_surface_covariance(const haft_surface_plan *plan, long i, long j) {
    size_t extent = plan->halo * plan->ratio;
    size_t lag_i = (size_t)labs(i), lag_j = (size_t)labs(j);
    if (lag_i >= 2 * extent || lag_j >= 2 * extent) {
        return 0;
    }
    if (lag_i > plan->along.fine - 2 * extent || lag_j > plan->across.fine - 2 * extent) {
        return NAN; /* the block's transform is too short to separate it from its periodic image */
    }
    double sum = 0;
    for (size_t n = 0; n <= plan->across.cut; n++) {
        double line = 0;
        for (size_t m = 0; m <= plan->disc[n]; m++) {
            size_t turn = m * lag_i % plan->along.fine;
            line +=
                mode_energy(plan, m, n) * cos(2 * M_PI * (double)turn / (double)plan->along.fine);
        }
        size_t turn = n * lag_j % plan->across.fine;
        sum += line * cos(2 * M_PI * (double)turn / (double)plan->across.fine);
    }
    if (plan->spec.marginal != NULL) {
        double deviation = plan->facts.deviation, rho = sum / plan->facts.moments.m0;
        return deviation * deviation * haft_marginal_correlation(plan->spec.marginal, rho);
    }
    return sum;
}
