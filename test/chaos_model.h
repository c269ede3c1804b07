/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Law vectors and models for the tests of the room chaos. */
#ifndef HAFT_TEST_CHAOS_MODEL_H
#define HAFT_TEST_CHAOS_MODEL_H

#include "check.h"

#include "haft/chaos.h"

#define TEST_F_LIMIT 5e6

/* A law vector with a right wing of energy `right`: always a Morse law. */
static inline haft_law_vector test_vector(double right, double f_max, double d_max, double width) {
    haft_law_vector v = {.f_max = f_max, .d_max = d_max, .d_limit = d_max - width};
    double left = log(1 + sqrt(1 + TEST_F_LIMIT / f_max)) / (v.d_max - v.d_limit);
    v.e = f_max / (2 * left) + right;
    return v;
}

/* m skewed, dependent law vectors; `spread` of the right wing's logarithm. */
static inline haft_law_vector *skewed_vectors(size_t m, uint64_t seed, double spread) {
    haft_law_vector *v = malloc(m * sizeof *v);
    for (size_t k = 0; k < m; k++) {
        double z[4];
        haft_random_normals((haft_random_key){seed, HAFT_RANDOM_TEST}, k, 0, 0, 4, z);
        v[k] = test_vector(
            2e-3 * exp(spread * z[3] + 0.24 * z[0]), 4e5 * exp(0.25 * z[0] + 0.05 * z[0] * z[0]),
            1.1e-8 + 5e-10 * (exp(0.3 * z[2]) + 0.5 * z[0]), 3e-9 * exp(0.1 * z[1] - 0.05 * z[0]));
    }
    return v;
}

static inline haft_chaos *make_model(size_t m, const haft_law_vector *v,
                                     const haft_chaos_spec *spec) {
    haft_chaos *c = NULL;
    haft_error error = {0};
    check_ok(haft_chaos_create(&c, m, v, spec, &error), error);
    return c;
}

/* A model whose kernels stand at given centres [m][g]; no expansion, unit transformation. */
static inline haft_chaos *model_of_centres(size_t m, size_t g, const double *centre, double h) {
    enum { TERMS = 1 };
    haft_law_vector *v = malloc(m * sizeof *v);
    for (size_t k = 0; k < m; k++) {
        v[k] = test_vector(2e-3, 4e5, 1.1e-8, 3e-9);
    }
    unsigned index[HAFT_CHAOS_DIMENSION] = {0};
    double coefficient[HAFT_CHAOS_DIMENSION] = {0};
    haft_chaos_parts p = {.f_limit = TEST_F_LIMIT,
                          .sigma = {1, 1, 1, 1},
                          .eigenvalue = {1, 1, 1, 1},
                          .components = g,
                          .component_order = {0, 1, 2, 3},
                          .bandwidth = h,
                          .m = m,
                          .vector = v,
                          .centre = centre,
                          .points = 1,
                          .terms = TERMS,
                          .index = index,
                          .coefficient = coefficient};
    for (size_t i = 0; i < HAFT_CHAOS_DIMENSION; i++) {
        p.eigenvector[i][i] = 1;
    }
    haft_chaos *c = NULL;
    haft_error error = {0};
    check_ok(haft_chaos_create_from_parts(&c, &p, &error), error);
    free(v);
    return c;
}

static inline haft_chaos_work *make_work(const haft_chaos *c) {
    haft_chaos_work *work = NULL;
    haft_error error = {0};
    check_ok(haft_chaos_work_create(&work, c, &error), error);
    return work;
}

static inline double test_uniform(uint64_t k, uint64_t j) {
    uint64_t words[4];
    haft_random_words((haft_random_key){11, HAFT_RANDOM_TEST}, k, j, 0, words);
    return haft_random_uniform(words[0]);
}

#endif
