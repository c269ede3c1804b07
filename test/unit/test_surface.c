/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Generated surfaces: blocks join, grids nest, the same bits in any order, clear refusals. */
#include "check.h"

#include "haft/surface.h"

enum { ROWS = 64, COLUMNS = 96 };

/* The second published surface: its reach at 1e-4 is 0.7 um, so blocks are quick. */
static const haft_psd PSD = {283e6, 40e6, 0.5e-33, 50e-39};

static haft_surface_spec small_spec(void) {
    return (haft_surface_spec){.psd = PSD,
                               .grid_step = 5e-9,
                               .rows = ROWS,
                               .columns = COLUMNS,
                               .tolerance = 1e-4,
                               .key = {7, HAFT_RANDOM_TEST}};
}

static haft_surface_plan *make_plan(const haft_surface_spec *spec) {
    haft_error error = {0};
    haft_surface_plan *plan = NULL;
    check_ok(haft_surface_plan_create(&plan, spec, &error), error);
    return plan;
}

/* A block by itself, from its own work. */
static double *make_block(const haft_surface_plan *plan, const haft_surface_spec *spec,
                          uint64_t stream, long first_row) {
    haft_error error = {0};
    haft_surface_work *work = NULL;
    double *z = haft_memory_alloc(spec->rows * spec->columns, sizeof *z, &error);
    check_ok(haft_surface_work_create(&work, plan, &error), error);
    check_ok(haft_surface_prepare(work, 3, stream, first_row, &error), error);
    check_ok(haft_surface_rows(work, 0, spec->rows, z, &error), error);
    haft_surface_work_destroy(&work);
    return z;
}

static double largest_difference(const double *a, const double *b, size_t n) {
    double largest = 0;
    for (size_t i = 0; i < n; i++) {
        largest = fmax(largest, fabs(a[i] - b[i]));
    }
    return largest;
}

/* Blocks of one plan at several places agree where they overlap. */
static void check_overlaps(haft_surface_spec spec, long shift) {
    haft_surface_plan *plan = make_plan(&spec);
    double rms = sqrt(haft_surface_covariance(plan, 0, 0));
    long rows = (long)spec.rows;
    static const long places[] = {0, 5, -3, -100000};
    for (size_t p = 0; p < sizeof places / sizeof *places; p++) {
        long first = places[p] * shift;
        double *later = make_block(plan, &spec, 0, first + shift);
        double *a = make_block(plan, &spec, 0, first);
        size_t shared = (size_t)(rows - shift) * spec.columns;
        check_less(largest_difference(a + (size_t)shift * spec.columns, later, shared),
                   1e-12 * rms);
        haft_memory_free(a);
        haft_memory_free(later);
    }
    haft_surface_plan_destroy(&plan);
}

static void blocks_join(void **state) {
    (void)state;
    check_overlaps(small_spec(), 22);
    haft_surface_spec lattice = small_spec(); /* the lattice is the grid */
    lattice.grid_step = 10e-9;
    check_overlaps(lattice, 21);
    haft_surface_spec thirds = small_spec(); /* odd ratio, odd number of lattice steps */
    thirds.grid_step = 3.5e-9;
    thirds.rows = 63;
    thirds.columns = 39;
    check_overlaps(thirds, 21);
}

/* With no room between zeta_max and the lattice's band, and a taper short enough to smear far past
 * it, the kernel's images carry the join. */
static void blocks_join_without_a_guard_band(void **state) {
    (void)state;
    haft_surface_spec spec = small_spec();
    spec.psd.zeta_max = 0.9999 * M_PI / 10e-9;
    spec.tolerance = 1e-2;
    check_overlaps(spec, 22);
    spec.grid_step = 2.5e-9;
    check_overlaps(spec, 20);
    spec.grid_step = 10e-9;
    check_overlaps(spec, 20);
}

/* The size of a block, along or across, does not change the surface. */
static void block_sizes_agree(void **state) {
    (void)state;
    haft_surface_spec spec = small_spec(), wide = small_spec();
    wide.rows = 150;
    wide.columns = 200;
    haft_surface_plan *plan = make_plan(&spec), *wide_plan = make_plan(&wide);
    double *z = make_block(plan, &spec, 0, 40), *w = make_block(wide_plan, &wide, 0, 0);
    double rms = sqrt(haft_surface_covariance(plan, 0, 0));
    for (size_t i = 0; i < ROWS; i++) {
        check_less(largest_difference(z + i * COLUMNS, w + (i + 40) * wide.columns, COLUMNS),
                   1e-12 * rms);
    }
    haft_memory_free(z);
    haft_memory_free(w);
    haft_surface_plan_destroy(&plan);
    haft_surface_plan_destroy(&wide_plan);
}

/* The noise belongs to places, not to blocks: a longer kernel changes the surface by what the
 * tapers take, rms at most (sqrt(loss) + sqrt(loss')). */
static void tolerances_share_the_noise(void **state) {
    (void)state;
    haft_surface_spec spec = small_spec(), rough = spec;
    rough.tolerance = 1e-3;
    haft_surface_plan *plan = make_plan(&spec), *rough_plan = make_plan(&rough);
    haft_surface_facts facts, rough_facts;
    haft_surface_get_facts(plan, &facts);
    haft_surface_get_facts(rough_plan, &rough_facts);
    check_less(rough_facts.reach, 0.6 * facts.reach);
    double *z = make_block(plan, &spec, 0, 10), *r = make_block(rough_plan, &rough, 0, 10);
    double squares = 0;
    for (size_t i = 0; i < ROWS * COLUMNS; i++) {
        squares += (z[i] - r[i]) * (z[i] - r[i]);
    }
    double rms = sqrt(squares / (ROWS * COLUMNS) / facts.moments.m0);
    check_less(rms, 2 * (sqrt(facts.taper_loss) + sqrt(rough_facts.taper_loss)));
    haft_memory_free(z);
    haft_memory_free(r);
    haft_surface_plan_destroy(&plan);
    haft_surface_plan_destroy(&rough_plan);
}

static void grids_nest(void **state) {
    (void)state;
    haft_surface_spec spec = small_spec();
    spec.grid_step = 10e-9;
    haft_surface_plan *coarse_plan = make_plan(&spec);
    double *coarse = make_block(coarse_plan, &spec, 2, 64);
    double rms = sqrt(haft_surface_covariance(coarse_plan, 0, 0));
    for (size_t p = 2; p <= 4; p += 2) {
        haft_surface_spec fine_spec = spec;
        fine_spec.grid_step = spec.grid_step / (double)p;
        fine_spec.rows *= p;
        fine_spec.columns *= p;
        haft_surface_plan *plan = make_plan(&fine_spec);
        haft_surface_facts facts;
        haft_surface_get_facts(plan, &facts);
        assert_int_equal(facts.lattice_ratio, p);
        double *fine = make_block(plan, &fine_spec, 2, 64 * (long)p);
        double largest = 0;
        for (size_t i = 0; i < ROWS; i++) {
            for (size_t j = 0; j < COLUMNS; j++) {
                double same = fine[i * p * fine_spec.columns + j * p];
                largest = fmax(largest, fabs(same - coarse[i * COLUMNS + j]));
            }
        }
        check_less(largest, 1e-12 * rms);
        haft_memory_free(fine);
        haft_surface_plan_destroy(&plan);
    }
    haft_memory_free(coarse);
    haft_surface_plan_destroy(&coarse_plan);
}

/* The same bits whatever came before, in whatever pieces, on whatever thread. */
static void bits_do_not_depend_on_order_or_threads(void **state) {
    (void)state;
    enum { BLOCKS = 6, SIZE = ROWS * COLUMNS };
    haft_surface_spec spec = small_spec();
    haft_surface_plan *plan = make_plan(&spec);
    double *alone[BLOCKS], *threaded[BLOCKS];
    haft_error error = {0};
    haft_surface_work *work = NULL;
    check_ok(haft_surface_work_create(&work, plan, &error), error);
    for (int b = 0; b < BLOCKS; b++) {
        alone[b] = make_block(plan, &spec, 0, b * ROWS);
        threaded[b] = haft_memory_alloc(SIZE, sizeof(double), &error);
    }
    for (int b = BLOCKS - 1; b >= 0; b--) {
        check_ok(haft_surface_prepare(work, 3, 0, b * ROWS, &error), error);
        double *z = threaded[b];
        for (size_t row = ROWS; row > 0; row -= 16) {
            check_ok(haft_surface_rows(work, row - 16, 16, z + (row - 16) * COLUMNS, &error),
                     error);
        }
        assert_memory_equal(z, alone[b], SIZE * sizeof(double));
        memset(z, 0, SIZE * sizeof(double));
    }
    haft_surface_work_destroy(&work);
    int failures = 0;
#pragma omp parallel num_threads(2) reduction(+ : failures)
    {
        haft_surface_work *own = NULL;
        failures += haft_surface_work_create(&own, plan, NULL) != HAFT_OK;
#pragma omp for schedule(dynamic, 1)
        for (int b = 0; b < BLOCKS; b++) {
            failures += own == NULL || haft_surface_prepare(own, 3, 0, b * ROWS, NULL) != HAFT_OK ||
                        haft_surface_rows(own, 0, ROWS, threaded[b], NULL) != HAFT_OK;
        }
        haft_surface_work_destroy(&own);
    }
    assert_int_equal(failures, 0);
    for (int b = 0; b < BLOCKS; b++) {
        assert_memory_equal(threaded[b], alone[b], SIZE * sizeof(double));
        haft_memory_free(alone[b]);
        haft_memory_free(threaded[b]);
    }
    haft_surface_plan_destroy(&plan);
}

/* Seed, purpose, realization and stream each change the surface. */
static void surfaces_differ_by_every_label(void **state) {
    (void)state;
    haft_surface_spec spec = small_spec(), seed = spec, purpose = spec;
    seed.key.seed++;
    purpose.key.purpose++;
    haft_surface_plan *plans[3] = {make_plan(&spec), make_plan(&seed), make_plan(&purpose)};
    double *z[4];
    for (int i = 0; i < 3; i++) {
        z[i] = make_block(plans[i], &spec, 0, 0);
    }
    z[3] = make_block(plans[0], &spec, 1, 0);
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < i; j++) {
            check_less(1e-9, largest_difference(z[i], z[j], ROWS * COLUMNS));
        }
    }
    for (int i = 0; i < 4; i++) {
        haft_memory_free(z[i]);
    }
    for (int i = 0; i < 3; i++) {
        haft_surface_plan_destroy(&plans[i]);
    }
}

static void check_refused(haft_surface_spec spec, const char *says) {
    haft_error error = {0};
    haft_surface_plan *plan = NULL;
    assert_int_equal(haft_surface_plan_create(&plan, &spec, &error), HAFT_ERROR_INPUT);
    assert_null(plan);
    if (strstr(error.message, says) == NULL) {
        fail_msg("\"%s\" does not say \"%s\"", error.message, says);
    }
}

static void bad_specs_are_refused(void **state) {
    (void)state;
    haft_surface_spec spec = small_spec();
    spec.grid_step = 12e-9;
    check_refused(spec, "the largest step allowed is 11.1010 nm");
    spec.grid_step = 11.1010e-9;
    haft_surface_plan *plan = make_plan(&spec);
    haft_surface_plan_destroy(&plan);
    spec.grid_step = 0.1e-9;
    check_refused(spec, "the smallest step allowed is 0.17346 nm");
    spec.grid_step = 0;
    check_refused(spec, "grid step");
    spec = small_spec();
    spec.rows = 63;
    check_refused(spec, "rows = 63: must be a multiple of 2");
    spec.grid_step = 2.5e-9;
    spec.rows = 64;
    spec.columns = 97;
    check_refused(spec, "columns = 97: must be a multiple of 4, the grid steps in a step of the "
                        "noise lattice; the nearest is 96");
    spec = small_spec();
    spec.columns = 0;
    check_refused(spec, "columns = 0");
    spec = small_spec();
    spec.tolerance = -1;
    check_refused(spec, "tolerance");
    spec.tolerance = 1e-9; /* this PSD's sharp end would need a kernel of millimetres */
    check_refused(spec, "the least this PSD allows");
    spec = small_spec();
    spec.psd.zeta_0 = -1;
    check_refused(spec, "zeta_0");
}

static void bad_calls_are_refused(void **state) {
    (void)state;
    haft_surface_spec spec = small_spec();
    haft_surface_plan *plan = make_plan(&spec);
    haft_surface_work *work = NULL;
    haft_error error = {0};
    double z[COLUMNS];
    check_ok(haft_surface_work_create(&work, plan, &error), error);
    assert_int_equal(haft_surface_rows(work, 0, 1, z, &error), HAFT_ERROR_ARGUMENT);
    assert_int_equal(haft_surface_prepare(work, 0, 0, 1, &error), HAFT_ERROR_ARGUMENT);
    assert_int_equal(haft_surface_prepare(work, 0, UINT64_C(1) << 32, 0, &error),
                     HAFT_ERROR_ARGUMENT);
    assert_int_equal(haft_surface_prepare(work, 0, 0, 2L << 31, &error), HAFT_ERROR_ARGUMENT);
    check_ok(haft_surface_prepare(work, 0, 0, 0, &error), error);
    assert_int_equal(haft_surface_rows(work, ROWS, 1, z, &error), HAFT_ERROR_ARGUMENT);
    assert_int_equal(haft_surface_rows(work, SIZE_MAX, 2, z, &error), HAFT_ERROR_ARGUMENT);
    check_ok(haft_surface_rows(work, ROWS - 1, 1, z, &error), error);
    haft_surface_work_destroy(&work);
    haft_surface_work_destroy(&work);
    haft_surface_work_destroy(NULL);
    haft_surface_plan_destroy(&plan);
    haft_surface_plan_destroy(&plan);
    haft_surface_plan_destroy(NULL);
}

static void ratio_is_the_largest(void **state) {
    (void)state;
    haft_psd psd = PSD;
    assert_int_equal(haft_surface_lattice_ratio(&psd, 12e-9), 0);
    assert_int_equal(haft_surface_lattice_ratio(&psd, 10e-9), 1);
    assert_int_equal(haft_surface_lattice_ratio(&psd, 5e-9), 2);
    assert_int_equal(haft_surface_lattice_ratio(&psd, 2.5e-9), 4);
    psd.zeta_max = M_PI / 10e-9; /* exactly at the limit, round-off aside */
    for (size_t p = 1; p < 50; p++) {
        assert_int_equal(haft_surface_lattice_ratio(&psd, 10e-9 / (double)p), p);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks_join),
        cmocka_unit_test(blocks_join_without_a_guard_band),
        cmocka_unit_test(block_sizes_agree),
        cmocka_unit_test(tolerances_share_the_noise),
        cmocka_unit_test(grids_nest),
        cmocka_unit_test(bits_do_not_depend_on_order_or_threads),
        cmocka_unit_test(surfaces_differ_by_every_label),
        cmocka_unit_test(bad_specs_are_refused),
        cmocka_unit_test(bad_calls_are_refused),
        cmocka_unit_test(ratio_is_the_largest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
