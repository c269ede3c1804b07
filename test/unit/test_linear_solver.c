/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The linear solver, by KLU and by the band factor, on random matrices of a beam's pattern,
 * definite and not: solutions, leading blocks, and inertia against GSL's dense eigenvalues.
 * Products by diagonals against the whole matrix. */
#include "check.h"

#include <gsl/gsl_eigen.h>

#include "solve/band.h"
#include "solve/diagonals.h"
#include "solve/factor.h"

enum { MOST = 40, BAND = 3 };

/* A symmetric matrix in compressed columns, and whole. */
typedef struct banded {
    size_t n;
    int column[MOST + 1], row[MOST * (2 * BAND + 1)];
    double value[MOST * (2 * BAND + 1)], full[MOST][MOST];
} banded;

/* Whether the pattern has (i, j): a beam's couples the two unknowns of a node with those of its
 * neighbours, so that every other column is shorter. */
static bool has(size_t i, size_t j, bool beam) {
    size_t a = i > j ? i : j, b = i > j ? j : i;
    return a - b <= BAND && (!beam || a / 2 - b / 2 <= 1);
}

/* Random entries in -1 .. 1, the diagonal raised by `lift`. */
static void draw(banded *m, size_t n, bool beam, double lift, uint64_t which) {
    *m = (banded){.n = n};
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j <= i; j++) {
            double z;
            haft_random_normals((haft_random_key){7, HAFT_RANDOM_TEST}, which, i, j, 1, &z);
            m->full[i][j] = m->full[j][i] = has(i, j, beam) ? tanh(z) + (i == j ? lift : 0) : 0;
        }
    }
    int at = 0;
    for (size_t j = 0; j < n; j++) {
        m->column[j] = at;
        for (size_t i = 0; i < n; i++) {
            if (has(i, j, beam)) {
                m->row[at] = (int)i;
                m->value[at++] = m->full[i][j];
            }
        }
    }
    m->column[n] = at;
}

static gsl_matrix *dense(const banded *m) {
    gsl_matrix *a = gsl_matrix_alloc(m->n, m->n);
    for (size_t i = 0; i < m->n; i++) {
        for (size_t j = 0; j < m->n; j++) {
            gsl_matrix_set(a, i, j, m->full[i][j]);
        }
    }
    return a;
}

static int negative_eigenvalues(const banded *m) {
    gsl_matrix *a = dense(m);
    gsl_vector *values = gsl_vector_alloc(m->n);
    gsl_eigen_symm_workspace *work = gsl_eigen_symm_alloc(m->n);
    gsl_eigen_symm(a, values, work);
    int negative = 0;
    for (size_t i = 0; i < m->n; i++) {
        negative += gsl_vector_get(values, i) < 0;
    }
    gsl_eigen_symm_free(work);
    gsl_vector_free(values);
    gsl_matrix_free(a);
    return negative;
}

static haft_factor *factored(haft_factor_kind kind, const banded *m) {
    haft_error error = {0};
    haft_factor *factor = NULL;
    banded definite;
    draw(&definite, m->n, true, 5, 99); /* the first is to be definite */
    check_ok(haft_factor_create(&factor, kind, m->n, m->column, m->row, definite.value, &error),
             error);
    assert_true(haft_factor_update(factor, m->value));
    return factor;
}

static void fill_by_cosines(double *b, size_t n) {
    for (size_t i = 0; i < n; i++) {
        b[i] = cos((double)(i * i));
    }
}

/* Largest component of b - A x over that of |A| |x|. */
static double backward_error(const banded *m, const double *b, const double *x) {
    double worst = 0, scale = 0;
    for (size_t i = 0; i < m->n; i++) {
        double sum = b[i], size = 0;
        for (size_t j = 0; j < m->n; j++) {
            sum -= m->full[i][j] * x[j];
            size += fabs(m->full[i][j] * x[j]);
        }
        worst = fmax(worst, fabs(sum));
        scale = fmax(scale, size);
    }
    return worst / scale;
}

static void solves_definite_matrices(void **state) {
    haft_factor_kind kind = *(const haft_factor_kind *)*state;
    for (size_t n = 2; n <= MOST; n += 2) {
        banded m;
        draw(&m, n, true, 5, n);
        haft_factor *factor = factored(kind, &m);
        double b[2 * MOST], x[2 * MOST], at_once[MOST];
        fill_by_cosines(b, 2 * n);
        memcpy(x, b, 2 * n * sizeof *b);
        haft_factor_solve(factor, x, 2);
        assert_true(backward_error(&m, b, x) < 8e-16);
        assert_true(backward_error(&m, b + n, x + n) < 8e-16);
        assert_int_equal(haft_factor_inertia(factor).negative, 0);
        memcpy(at_once, b, n * sizeof *b);
        assert_true(haft_factor_update_solve(factor, m.value, at_once));
        assert_memory_equal(at_once, x, n * sizeof *x);
        haft_factor_destroy(&factor);
    }
}

/* With the last unknowns frozen, a matrix solves as its leading block and leaves them alone; after
 * that it solves as before to the bit. */
static void solves_leading_blocks(void **state) {
    haft_factor_kind kind = *(const haft_factor_kind *)*state;
    banded m;
    draw(&m, MOST, true, 5, 7);
    haft_factor *factor = factored(kind, &m);
    double b[MOST], x[MOST], all[MOST];
    fill_by_cosines(b, MOST);
    memcpy(all, b, sizeof b);
    haft_factor_solve(factor, all, 1);
    for (size_t n = 2; n < MOST; n += 2) {
        assert_true(haft_factor_use_leading(factor, n));
        assert_true(haft_factor_update(factor, m.value));
        memcpy(x, b, sizeof b);
        haft_factor_solve(factor, x, 1);
        banded part = m;
        part.n = n;
        assert_true(backward_error(&part, b, x) < 8e-16);
        assert_memory_equal(x + n, b + n, (MOST - n) * sizeof *x);
        assert_int_equal(haft_factor_inertia(factor).negative, 0);
    }
    assert_false(haft_factor_use_leading(factor, 0));
    assert_false(haft_factor_use_leading(factor, MOST + 2));
    assert_true(haft_factor_use_leading(factor, MOST));
    assert_true(haft_factor_update(factor, m.value));
    haft_factor_solve(factor, b, 1);
    assert_memory_equal(b, all, sizeof all);
    haft_factor_destroy(&factor);
}

/* The pivots have the signs of the eigenvalues. */
static void tells_the_inertia(void **state) {
    haft_factor_kind kind = *(const haft_factor_kind *)*state;
    int seen[MOST] = {0};
    for (size_t n = 4; n <= MOST; n += 2) {
        for (size_t k = 0; k < 12; k++) {
            banded m;
            draw(&m, n, true, 0.3 * (double)k - 0.5, 100 * n + k);
            haft_factor *factor = factored(kind, &m);
            haft_inertia inertia = haft_factor_inertia(factor);
            assert_int_equal(inertia.negative, negative_eigenvalues(&m));
            assert_true((inertia.least_pivot < 0) == (inertia.negative > 0));
            seen[inertia.negative]++;
            haft_factor_destroy(&factor);
        }
    }
    assert_true(seen[0] > 0 && seen[1] > 0 && seen[5] > 0);
}

/* KLU's factor is another, with the same solution and the same inertia. */
static void both_agree(void **state) {
    (void)state;
    for (uint64_t k = 0; k < 50; k++) {
        banded m;
        draw(&m, MOST, true, 5, k);
        haft_factor *band = factored(HAFT_FACTOR_BAND, &m), *klu = factored(HAFT_FACTOR_KLU, &m);
        double a[MOST], b[MOST];
        fill_by_cosines(a, MOST);
        fill_by_cosines(b, MOST);
        haft_factor_solve(band, a, 1);
        haft_factor_solve(klu, b, 1);
        for (size_t i = 0; i < MOST; i++) {
            check_near(a[i], b[i], 1e-13);
        }
        assert_int_equal(haft_factor_inertia(band).negative, haft_factor_inertia(klu).negative);
        haft_factor_destroy(&band);
        haft_factor_destroy(&klu);
    }
}

/* 0.5 A x - y, of the narrow and of the smallest matrices, and of their leading parts. */
static void multiplies_by_diagonals(void **state) {
    (void)state;
    haft_error error = {0};
    for (size_t n = 1; n <= MOST; n++) {
        banded m;
        draw(&m, n, n % 2, 0, n);
        double x[MOST], y[MOST], out[2][MOST];
        for (size_t i = 0; i < n; i++) {
            x[i] = cos((double)(i * i));
            y[i] = sin((double)i);
        }
        haft_diagonals *diagonals = NULL;
        check_ok(haft_diagonals_create(&diagonals, n, m.column, m.row, m.value, &error), error);
        for (size_t part = n; part > 0; part--) {
            haft_diagonals_multiply(diagonals, part, 0.5, x, y, out[0]);
            haft_diagonals_multiply(diagonals, part, 0.5, x, NULL, out[1]);
            for (size_t i = 0; i < part; i++) {
                long double sum = 0;
                for (size_t j = 0; j < part; j++) {
                    sum += 0.5L * m.full[i][j] * x[j];
                }
                assert_true(fabs((double)(out[0][i] - (sum - y[i]))) < 2e-15);
                assert_true(fabs((double)(out[1][i] - sum)) < 2e-15);
            }
        }
        haft_diagonals_destroy(&diagonals);
    }
}

/* Nothing of an earlier matrix stays. */
static void factors_anew(void **state) {
    haft_factor_kind kind = *(const haft_factor_kind *)*state;
    banded first, second;
    draw(&first, 30, true, -3, 1);
    draw(&second, 30, true, 5, 2);
    haft_factor *used = factored(kind, &first), *fresh = factored(kind, &second);
    assert_true(haft_factor_update(used, second.value));
    double a[MOST], b[MOST];
    fill_by_cosines(a, MOST);
    fill_by_cosines(b, MOST);
    haft_factor_solve(used, a, 1);
    haft_factor_solve(fresh, b, 1);
    assert_memory_equal(a, b, sizeof a);
    haft_factor_destroy(&used);
    haft_factor_destroy(&fresh);
}

/* Value of the entry (i, j). */
static double *entry(banded *m, int i, int j) {
    for (int k = m->column[j]; k < m->column[j + 1]; k++) {
        if (m->row[k] == i) {
            return &m->value[k];
        }
    }
    fail();
    return NULL;
}

/* Wherever the matrix is singular, or an entry is not finite, it is refused. */
static void refuses_what_cannot_be_factored(void **state) {
    (void)state;
    for (int i = 0; i < 14; i++) {
        static const double bad[] = {NAN, INFINITY, -INFINITY, 0};
        for (int k = 0; k < 4; k++) {
            banded m;
            draw(&m, 14, true, 5, 3);
            haft_factor *factor = factored(HAFT_FACTOR_BAND, &m);
            for (int j = 0; j < 14; j++) {
                if (bad[k] == 0 && has((size_t)i, (size_t)j, true)) {
                    *entry(&m, i, j) = *entry(&m, j, i) = 0;
                }
            }
            *entry(&m, i, i) = bad[k];
            double b[14] = {1};
            assert_false(haft_factor_update(factor, m.value));
            assert_false(haft_factor_update_solve(factor, m.value, b));
            haft_factor_destroy(&factor);
        }
    }
}

/* Patterns that are not a beam's are left to KLU. */
static void leaves_other_patterns(void **state) {
    (void)state;
    haft_error error = {0};
    banded m;
    haft_band *band = NULL;
    draw(&m, 20, false, 5, 4); /* wider by one in every other column */
    assert_int_equal(haft_band_create(&band, m.n, m.column, m.row, &error), HAFT_OK);
    assert_null(band);
    draw(&m, 19, true, 5, 4);
    assert_int_equal(haft_band_create(&band, m.n, m.column, m.row, &error), HAFT_OK);
    assert_null(band);
    int column[MOST + 1], row[MOST]; /* no diagonal */
    for (int j = 0; j <= 20; j++) {
        column[j] = j;
        row[j] = (j + 1) % 20;
    }
    assert_int_equal(haft_band_create(&band, 20, column, row, &error), HAFT_OK);
    assert_null(band);
    haft_factor *factor = NULL;
    draw(&m, 20, false, 5, 4);
    check_ok(haft_factor_create(&factor, HAFT_FACTOR_BAND, m.n, m.column, m.row, m.value, &error),
             error);
    double b[MOST], x[MOST];
    fill_by_cosines(b, 20);
    fill_by_cosines(x, 20);
    haft_factor_solve(factor, x, 1);
    assert_true(backward_error(&m, b, x) < 8e-16);
    haft_factor_destroy(&factor);
}

int main(void) {
    static haft_factor_kind klu = HAFT_FACTOR_KLU, band = HAFT_FACTOR_BAND;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_prestate(solves_definite_matrices, &klu),
        cmocka_unit_test_prestate(solves_definite_matrices, &band),
        cmocka_unit_test_prestate(solves_leading_blocks, &klu),
        cmocka_unit_test_prestate(solves_leading_blocks, &band),
        cmocka_unit_test_prestate(tells_the_inertia, &klu),
        cmocka_unit_test_prestate(tells_the_inertia, &band),
        cmocka_unit_test_prestate(factors_anew, &klu),
        cmocka_unit_test_prestate(factors_anew, &band),
        cmocka_unit_test(both_agree),
        cmocka_unit_test(refuses_what_cannot_be_factored),
        cmocka_unit_test(leaves_other_patterns),
        cmocka_unit_test(multiplies_by_diagonals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
