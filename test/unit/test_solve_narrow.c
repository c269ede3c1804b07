/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The narrow factorization against GSL's dense LU and eigenvalues, on random matrices of every
 * parity and of beams' own pattern, definite and not; and what it is not for. Products by diagonals
 * against the whole matrix. */
#include "check.h"

#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>

#include "solve/diagonals.h"
#include "solve/factor.h"
#include "solve/narrow.h"

enum { MOST = 41, BAND = 3 };

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

static haft_narrow *factored(const banded *m) {
    haft_error error = {0};
    haft_narrow *narrow = NULL;
    assert_int_equal(haft_narrow_create(&narrow, m->n, m->column, m->row, &error), HAFT_OK);
    assert_non_null(narrow);
    assert_true(haft_narrow_update(narrow, m->value));
    return narrow;
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
    (void)state;
    for (size_t n = 12; n <= MOST; n++) {
        for (int beam = 0; beam < 2; beam++) {
            banded m;
            draw(&m, n, beam, 5, n);
            haft_narrow *narrow = factored(&m);
            double b[MOST], x[MOST];
            for (size_t i = 0; i < n; i++) {
                b[i] = x[i] = cos((double)(i * i));
            }
            haft_narrow_solve(narrow, x);
            assert_true(backward_error(&m, b, x) < 4e-16);
            assert_int_equal(haft_narrow_inertia(narrow).negative, 0);
            double at_once[MOST];
            memcpy(at_once, b, n * sizeof *b);
            assert_true(haft_narrow_update_solve(narrow, m.value, at_once));
            assert_memory_equal(at_once, x, n * sizeof *x);
            assert_int_equal(haft_narrow_inertia(narrow).negative, 0);
            haft_narrow_destroy(&narrow);
        }
    }
}

/* Held from some unknown on, a matrix solves as its leading part, and leaves what is held alone;
 * let go, it solves as before to the bit. */
static void leads_with_its_first_unknowns(void **state) {
    (void)state;
    banded m;
    draw(&m, MOST, 1, 5, 7);
    haft_narrow *whole = factored(&m);
    double x[MOST], all[MOST];
    for (size_t i = 0; i < MOST; i++) {
        all[i] = cos((double)(i * i));
    }
    haft_narrow_solve(whole, all);
    for (size_t n = 12; n < MOST; n++) {
        assert_true(haft_narrow_lead(whole, n));
        assert_true(haft_narrow_update(whole, m.value));
        double b[MOST];
        for (size_t i = 0; i < MOST; i++) {
            b[i] = x[i] = cos((double)(i * i));
        }
        haft_narrow_solve(whole, x);
        banded part = m;
        part.n = n;
        assert_true(backward_error(&part, b, x) < 4e-16);
        assert_memory_equal(x + n, b + n, (MOST - n) * sizeof *x);
        assert_true(haft_narrow_update_solve(whole, m.value, b));
        assert_memory_equal(b, x, MOST * sizeof *x);
        assert_int_equal(haft_narrow_inertia(whole).negative, 0);
    }
    assert_false(haft_narrow_lead(whole, 11));
    assert_true(haft_narrow_lead(whole, MOST));
    assert_true(haft_narrow_update(whole, m.value));
    for (size_t i = 0; i < MOST; i++) {
        x[i] = cos((double)(i * i));
    }
    haft_narrow_solve(whole, x);
    assert_memory_equal(x, all, sizeof all);
    haft_narrow_destroy(&whole);
}

/* So does KLU's factor, for two right-hand sides too, after matrices that are not definite. */
static void klu_leads_with_its_first_unknowns(void **state) {
    (void)state;
    haft_error error = {0};
    banded m, other;
    draw(&m, MOST, 1, 5, 7);
    draw(&other, MOST, 1, 0.1, 8);
    haft_factor *factor = NULL;
    check_ok(haft_factor_create(&factor, HAFT_FACTOR_KLU, MOST, m.column, m.row, m.value, &error),
             error);
    double b[2 * MOST], x[2 * MOST];
    for (size_t n = MOST; n > 1; n--) {
        assert_true(haft_factor_lead(factor, n));
        haft_factor_update(factor, other.value);
        assert_true(haft_factor_update(factor, m.value));
        assert_int_equal(haft_factor_inertia(factor).negative, 0);
        for (size_t i = 0; i < 2 * n; i++) {
            b[i] = x[i] = cos((double)(i * i));
        }
        haft_factor_solve(factor, x, 2);
        double at_once[MOST];
        memcpy(at_once, b, n * sizeof *b);
        assert_true(haft_factor_update_solve(factor, m.value, at_once));
        assert_memory_equal(at_once, x, n * sizeof *x);
        banded part = m;
        part.n = n;
        assert_true(backward_error(&part, b, x) < 4e-16);
        assert_true(backward_error(&part, b + n, x + n) < 4e-16);
    }
    assert_false(haft_factor_lead(factor, 1));
    assert_false(haft_factor_lead(factor, MOST + 1));
    assert_true(haft_factor_lead(factor, MOST));
    assert_true(haft_factor_update(factor, m.value));
    memcpy(x, b, sizeof x);
    haft_factor_solve(factor, x, 1);
    assert_true(backward_error(&m, b, x) < 4e-16);
    haft_factor_destroy(&factor);
}

/* The pivots have the signs of the eigenvalues. */
static void tells_the_inertia(void **state) {
    (void)state;
    int seen[MOST] = {0};
    for (size_t n = 12; n <= MOST; n++) {
        for (int k = 0; k < 8; k++) {
            banded m;
            draw(&m, n, k % 2, 0.4 * k - 0.5, 100 * n + (size_t)k);
            haft_narrow *narrow = factored(&m);
            haft_inertia inertia = haft_narrow_inertia(narrow);
            assert_int_equal(inertia.negative, negative_eigenvalues(&m));
            assert_true((inertia.least_pivot < 0) == (inertia.negative > 0));
            seen[inertia.negative]++;
            haft_narrow_destroy(&narrow);
        }
    }
    assert_true(seen[0] > 0 && seen[1] > 0 && seen[5] > 0);
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
    (void)state;
    banded first, second;
    draw(&first, 30, true, -3, 1);
    draw(&second, 30, true, 5, 2);
    haft_narrow *used = factored(&first), *fresh = factored(&second);
    assert_true(haft_narrow_update(used, second.value));
    double a[MOST], b[MOST];
    for (size_t i = 0; i < 30; i++) {
        a[i] = b[i] = (double)i;
    }
    haft_narrow_solve(used, a);
    haft_narrow_solve(fresh, b);
    assert_memory_equal(a, b, 30 * sizeof *a);
    haft_narrow_destroy(&used);
    haft_narrow_destroy(&fresh);
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

/* Wherever a pivot vanishes, or an entry is not finite, the matrix is refused. */
static void refuses_what_cannot_be_factored(void **state) {
    (void)state;
    for (int n = 12; n <= 15; n++) {
        for (int i = 0; i < n; i++) {
            static const double bad[] = {NAN, INFINITY, -INFINITY, 0};
            for (int k = 0; k < 4; k++) {
                banded m;
                draw(&m, (size_t)n, true, 5, 3);
                haft_narrow *narrow = factored(&m);
                for (int j = 0; j < n; j++) {
                    if (bad[k] == 0 && has((size_t)i, (size_t)j, true)) {
                        *entry(&m, i, j) = *entry(&m, j, i) = 0;
                    }
                }
                *entry(&m, i, i) = bad[k];
                assert_false(haft_narrow_update(narrow, m.value));
                double b[15] = {1};
                assert_false(haft_narrow_update_solve(narrow, m.value, b));
                haft_narrow_destroy(&narrow);
            }
        }
    }
}

/* Wider patterns, patterns with gaps and tiny ones are left to KLU. */
static void leaves_other_patterns(void **state) {
    (void)state;
    haft_error error = {0};
    banded m;
    haft_narrow *narrow = NULL;
    draw(&m, 11, false, 5, 4);
    assert_int_equal(haft_narrow_create(&narrow, m.n, m.column, m.row, &error), HAFT_OK);
    assert_null(narrow);
    draw(&m, 20, false, 5, 4);
    m.row[m.column[1] - 1] = 4; /* the first column's last entry, one row too far */
    assert_int_equal(haft_narrow_create(&narrow, m.n, m.column, m.row, &error), HAFT_OK);
    assert_null(narrow);
    int column[MOST + 1], row[MOST]; /* no diagonal */
    for (int j = 0; j <= 20; j++) {
        column[j] = j;
        row[j] = (j + 1) % 20;
    }
    assert_int_equal(haft_narrow_create(&narrow, 20, column, row, &error), HAFT_OK);
    assert_null(narrow);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(solves_definite_matrices),
        cmocka_unit_test(leads_with_its_first_unknowns),
        cmocka_unit_test(klu_leads_with_its_first_unknowns),
        cmocka_unit_test(tells_the_inertia),
        cmocka_unit_test(multiplies_by_diagonals),
        cmocka_unit_test(factors_anew),
        cmocka_unit_test(refuses_what_cannot_be_factored),
        cmocka_unit_test(leaves_other_patterns),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
