/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The model of law vectors: transformation and its bounds, principal components, samplers by
 * counter, and its parts there and back. */
#include "chaos_model.h"

enum { M = 300 };

static haft_chaos_spec usual(void) {
    return (haft_chaos_spec){.f_limit = TEST_F_LIMIT, .components = 3, .order = 4};
}

/* To round-off of q sigma, and of e and d_max beside what is taken from them. */
static void vectors_come_back_from_q(void **state) {
    (void)state;
    haft_law_vector *v = skewed_vectors(M, 1, 0.5);
    for (int bounds = 0; bounds < 2; bounds++) {
        haft_chaos_spec spec = usual();
        spec.bounds = bounds == 0 ? HAFT_CHAOS_BOUNDS_STRICT : HAFT_CHAOS_BOUNDS_PAPER;
        haft_chaos *c = make_model(M, v, &spec);
        haft_chaos_parts p;
        haft_chaos_get_parts(c, &p);
        for (size_t k = 0; k < M; k++) {
            double q[4], again[4], width = v[k].d_max - v[k].d_limit;
            haft_chaos_q_from_vector(c, &v[k], q);
            haft_law_vector back = haft_chaos_vector_from_q(c, q);
            check_relative(back.e, v[k].e, 1e-14);
            check_relative(back.f_max, v[k].f_max, 1e-14);
            check_relative(back.d_max, v[k].d_max, 1e-15);
            check_relative(back.d_limit, v[k].d_limit, 1e-14);
            haft_chaos_q_from_vector(c, &back, again);
            for (int i = 0; i < 4; i++) {
                check_near(again[i] * p.sigma[i], q[i] * p.sigma[i],
                           i == 2 ? 1e-22 : 1e-13 * v[k].d_max / width);
            }
        }
        haft_chaos_destroy(&c);
    }
    free(v);
}

/* Eq. 24 by hand, and the third bound's place for ln e. */
static void q_is_what_the_equations_say(void **state) {
    (void)state;
    haft_law_vector *v = skewed_vectors(M, 1, 0.5), w = test_vector(3e-3, 3e5, 1.2e-8, 2e-9);
    for (int bounds = 0; bounds < 2; bounds++) {
        haft_chaos_spec spec = usual();
        spec.bounds = bounds == 0 ? HAFT_CHAOS_BOUNDS_STRICT : HAFT_CHAOS_BOUNDS_PAPER;
        haft_chaos *c = make_model(M, v, &spec);
        haft_chaos_parts p;
        haft_chaos_get_parts(c, &p);
        double q[4];
        haft_chaos_q_from_vector(c, &w, q);
        check_relative(q[0] * p.sigma[0], bounds == 0 ? log(3e-3) : log(w.e), 1e-12);
        check_relative(q[1] * p.sigma[1], log(3e5), 1e-14);
        check_relative(q[2] * p.sigma[2], 1.2e-8, 1e-14);
        check_relative(q[3] * p.sigma[3], log(2e-9), 1e-14);
        haft_law_vector bad = w;
        bad.d_limit = 2e-8;
        haft_chaos_q_from_vector(c, &bad, q);
        assert_true(isnan(q[3]));
        haft_chaos_destroy(&c);
    }
    free(v);
}

/* However far out q lies, the strict bounds give a law. */
static void any_q_gives_a_law_by_the_strict_bounds(void **state) {
    (void)state;
    haft_law_vector *v = skewed_vectors(M, 1, 0.5);
    haft_chaos_spec spec = usual();
    haft_chaos *c = make_model(M, v, &spec);
    haft_chaos_parts p;
    haft_chaos_get_parts(c, &p);
    for (uint64_t k = 0; k < 20000; k++) {
        double q[4];
        for (uint64_t i = 0; i < 4; i++) {
            double far = pow(10, 6 * test_uniform(k, i) - 2);
            q[i] = p.mean[i] + far * (test_uniform(k, 4 + i) < 0.5 ? -1 : 1);
        }
        haft_law law;
        haft_law_vector w = haft_chaos_vector_from_q(c, q);
        if (haft_law_morse(&law, &w, TEST_F_LIMIT) != HAFT_LAW_SOUND) {
            fail_msg("q (%g %g %g %g) gives (%g %g %g %g)", q[0], q[1], q[2], q[3], w.e, w.f_max,
                     w.d_max, w.d_limit);
        }
    }
    haft_chaos_destroy(&c);
    free(v);
}

/* eta has mean 0 and covariance I; with all components q comes back. */
static void components_are_standardised(void **state) {
    (void)state;
    haft_law_vector *v = skewed_vectors(M, 2, 0.3);
    haft_chaos_spec spec = usual();
    spec.components = 4;
    spec.order = 1;
    haft_chaos *c = make_model(M, v, &spec);
    haft_chaos_parts p;
    haft_chaos_get_parts(c, &p);
    double trace = 0;
    for (int a = 0; a < 4; a++) {
        double mean = 0, greatest = 0;
        for (int i = 0; i < 4; i++) {
            greatest = fabs(p.eigenvector[i][a]) > fabs(greatest) ? p.eigenvector[i][a] : greatest;
        }
        assert_true(greatest > 0);
        trace += p.eigenvalue[a];
        assert_true(a == 0 || p.eigenvalue[a] <= p.eigenvalue[a - 1]);
        for (int b = 0; b < 4; b++) {
            double covariance = 0;
            for (size_t k = 0; k < M; k++) {
                covariance += p.centre[4 * k + (size_t)a] * p.centre[4 * k + (size_t)b];
            }
            check_near(covariance / (M - 1), a == b, 1e-12);
        }
        for (size_t k = 0; k < M; k++) {
            mean += p.centre[4 * k + (size_t)a] / M;
        }
        check_near(mean, 0, 1e-13);
    }
    check_near(trace, 4, 1e-12); /* q is standardised */
    for (size_t k = 0; k < M; k++) {
        double q[4], back[4], eta[4];
        haft_chaos_q_from_vector(c, &v[k], q);
        haft_chaos_eta_from_q(c, q, eta);
        haft_chaos_q_from_eta(c, eta, back);
        for (int i = 0; i < 4; i++) {
            check_near(eta[i], p.centre[4 * k + (size_t)i], 1e-12);
            check_near(back[i], q[i], 1e-13 * (1 + fabs(q[i])));
        }
    }
    haft_chaos_destroy(&c);
    free(v);
}

/* Eq. 32, from the eigenvalues. */
static void epsilon_chooses_the_fewest_components(void **state) {
    (void)state;
    haft_law_vector *v = skewed_vectors(M, 2, 0.3);
    haft_chaos_spec spec = usual();
    spec.order = 1;
    for (double epsilon = 1e-6; epsilon < 1; epsilon *= 1.7) {
        spec.components = 0;
        spec.epsilon = epsilon;
        haft_chaos *c = make_model(M, v, &spec);
        haft_chaos_parts p;
        haft_chaos_get_parts(c, &p);
        double rest = 0;
        for (size_t j = p.components; j < 4; j++) {
            rest += p.eigenvalue[j] / 4;
        }
        assert_true(rest < epsilon);
        assert_true(p.components == 1 || rest + p.eigenvalue[p.components - 1] / 4 >= epsilon);
        haft_chaos_destroy(&c);
    }
    free(v);
}

/* The expansion is the sum its parts say. */
static void expansion_is_the_sum_of_its_terms(void **state) {
    (void)state;
    haft_law_vector *v = skewed_vectors(M, 2, 0.3);
    for (size_t g = 1; g <= 4; g++) {
        haft_chaos_spec spec = usual();
        spec.components = g;
        spec.germ = (haft_chaos_germ)(g % 3);
        for (size_t i = 0; i < g; i++) {
            spec.component_order[i] = g - 1 - i;
        }
        haft_chaos *c = make_model(M, v, &spec);
        haft_chaos_parts p;
        haft_chaos_get_parts(c, &p);
        for (uint64_t k = 0; k < 20; k++) {
            double x[4], psi[4][5], eta[4], sum[4] = {0};
            for (size_t i = 0; i < g; i++) {
                x[i] = haft_chaos_germ_quantile(p.germ, test_uniform(k, i));
                haft_chaos_polynomials(p.germ, 4, x[i], psi[i]);
            }
            haft_chaos_expand(c, x, eta);
            for (size_t t = 0; t < p.terms; t++) {
                double product = 1;
                for (size_t i = 0; i < g; i++) {
                    product *= psi[i][p.index[t * g + i]];
                }
                for (size_t j = 0; j < g; j++) {
                    sum[j] += p.coefficient[t * g + j] * product;
                }
            }
            for (size_t j = 0; j < g; j++) {
                check_near(eta[j], sum[j], 1e-13 * (1 + fabs(sum[j])));
            }
        }
        haft_chaos_destroy(&c);
    }
    free(v);
}

static bool same(const haft_law_vector *a, const haft_law_vector *b) {
    return memcmp(a, b, sizeof *a) == 0;
}

/* Each vector alone, in any order, in any stretch, by any thread: the same bits. */
static void samples_hang_on_their_counter_alone(void **state) {
    (void)state;
    enum { SITES = 61 };
    haft_law_vector *v = skewed_vectors(M, 2, 0.3), all[SITES], part[SITES];
    haft_chaos_spec spec = usual();
    haft_chaos *c = make_model(M, v, &spec);
    haft_chaos_work *work = make_work(c);
    haft_error error = {0};
    for (int s = 0; s <= HAFT_CHAOS_SAMPLER_MEAN; s++) {
        haft_chaos_sampler sampler = (haft_chaos_sampler)s;
        check_ok(haft_chaos_sample(c, work, sampler, 9, 4, 0, SITES, all, &error), error);
        for (size_t k = SITES; k-- > 0;) {
            check_ok(haft_chaos_sample(c, work, sampler, 9, 4, k, 1, part, &error), error);
            assert_true(same(&all[k], part));
        }
        check_ok(haft_chaos_sample(c, work, sampler, 9, 4, 13, 21, part, &error), error);
        assert_memory_equal(part, all + 13, 21 * sizeof *all);
        haft_law_vector shared[SITES];
#pragma omp parallel for num_threads(3)
        for (size_t k = 0; k < SITES; k++) {
            haft_chaos_work *own = make_work(c);
            haft_error mine = {0};
            if (haft_chaos_sample(c, own, sampler, 9, 4, k, 1, &shared[k], &mine) != HAFT_OK) {
                shared[k] = (haft_law_vector){0};
            }
            haft_chaos_work_destroy(&own);
        }
        assert_memory_equal(shared, all, sizeof all);
        check_ok(haft_chaos_sample(c, work, sampler, 9, 5, 0, 1, part, &error), error);
        assert_int_equal(same(&all[0], part), sampler == HAFT_CHAOS_SAMPLER_MEAN);
        check_ok(haft_chaos_sample(c, work, sampler, 8, 4, 0, 1, part, &error), error);
        assert_int_equal(same(&all[0], part), sampler == HAFT_CHAOS_SAMPLER_MEAN);
    }
    assert_int_equal(haft_chaos_sample(c, NULL, HAFT_CHAOS_SAMPLER_EXACT, 1, 0, 0, 1, part, &error),
                     HAFT_ERROR_ARGUMENT);
    assert_int_equal(haft_chaos_sample(c, work, (haft_chaos_sampler)9, 1, 0, 0, 1, part, &error),
                     HAFT_ERROR_ARGUMENT);
    haft_chaos_work_destroy(&work);
    haft_chaos_destroy(&c);
    free(v);
}

static void bootstrap_and_mean_give_what_they_say(void **state) {
    (void)state;
    haft_law_vector *v = skewed_vectors(M, 2, 0.3), out[500];
    haft_chaos_spec spec = usual();
    spec.bounds = HAFT_CHAOS_BOUNDS_PAPER;
    haft_chaos *c = make_model(M, v, &spec);
    haft_error error = {0};
    size_t hits[M] = {0}, seen = 0;
    check_ok(haft_chaos_sample(c, NULL, HAFT_CHAOS_SAMPLER_BOOTSTRAP, 1, 0, 0, 500, out, &error),
             error);
    for (size_t i = 0; i < 500; i++) {
        size_t k = 0;
        while (k < M && !same(&out[i], &v[k])) {
            k++;
        }
        assert_true(k < M);
        seen += hits[k]++ == 0;
    }
    /* M (1 - exp(-500/M)) = 243 distinct ones are expected, give or take 6.2 */
    assert_in_range(seen, 243 - 31, 243 + 31);
    double e = 0, f = 0, d = 0;
    for (size_t k = 0; k < M; k++) {
        e += log(v[k].e) / M;
        f += log(v[k].f_max) / M;
        d += v[k].d_max / M;
    }
    check_ok(haft_chaos_sample(c, NULL, HAFT_CHAOS_SAMPLER_MEAN, 1, 0, 0, 1, out, &error), error);
    check_relative(out[0].e, exp(e), 1e-13);
    check_relative(out[0].f_max, exp(f), 1e-13);
    check_relative(out[0].d_max, d, 1e-13);
    haft_chaos_destroy(&c);
    free(v);
}

/* Written and read back, the model is the same: parts, map, expansion, samples, to the bit. */
static void parts_make_the_same_model(void **state) {
    (void)state;
    haft_law_vector *v = skewed_vectors(M, 2, 0.3);
    haft_error error = {0};
    for (int turn = 0; turn < 3; turn++) {
        haft_chaos_spec spec = usual();
        spec.germ = (haft_chaos_germ)turn;
        spec.kernel = turn == 1 ? HAFT_CHAOS_KERNEL_PRESERVING : HAFT_CHAOS_KERNEL_SCOTT;
        memcpy(spec.component_order, (size_t[]){2, 0, 1, 0}, sizeof spec.component_order);
        haft_chaos *c = make_model(M, v, &spec), *d = NULL;
        haft_chaos_parts p, r;
        haft_chaos_get_parts(c, &p);
        check_ok(haft_chaos_create_from_parts(&d, &p, &error), error);
        haft_chaos_get_parts(d, &r);
        assert_true(r.coefficient != p.coefficient);
        assert_memory_equal(r.coefficient, p.coefficient, p.terms * 3 * sizeof *p.coefficient);
        assert_memory_equal(r.index, p.index, p.terms * 3 * sizeof *p.index);
        assert_memory_equal(r.centre, p.centre, M * 3 * sizeof *p.centre);
        assert_memory_equal(r.vector, p.vector, M * sizeof *p.vector);
        assert_memory_equal(r.sigma, p.sigma, sizeof p.sigma);
        assert_memory_equal(r.mean, p.mean, sizeof p.mean);
        assert_memory_equal(r.eigenvector, p.eigenvector, sizeof p.eigenvector);
        assert_memory_equal(r.component_order, p.component_order, sizeof p.component_order);
        haft_chaos_work *work = make_work(c), *other = make_work(d);
        for (int s = 0; s <= HAFT_CHAOS_SAMPLER_MEAN; s++) {
            haft_law_vector a[20], b[20];
            haft_chaos_sampler sampler = (haft_chaos_sampler)s;
            check_ok(haft_chaos_sample(c, work, sampler, 1, 2, 3, 20, a, &error), error);
            check_ok(haft_chaos_sample(d, other, sampler, 1, 2, 3, 20, b, &error), error);
            assert_memory_equal(a, b, sizeof a);
        }
        haft_chaos_work_destroy(&work);
        haft_chaos_work_destroy(&other);
        haft_chaos_destroy(&c);
        haft_chaos_destroy(&d);
    }
    free(v);
}

static void destroying_nothing_is_allowed(void **state) {
    (void)state;
    haft_chaos *c = NULL;
    haft_chaos_work *work = NULL;
    haft_chaos_destroy(NULL);
    haft_chaos_destroy(&c);
    haft_chaos_work_destroy(NULL);
    haft_chaos_work_destroy(&work);
    for (int k = 0; k < 10; k++) { /* names, of what there is not as well */
        assert_non_null(haft_chaos_bounds_name((haft_chaos_bounds)k));
        assert_non_null(haft_chaos_kernel_name((haft_chaos_kernel)k));
        assert_non_null(haft_chaos_germ_name((haft_chaos_germ)k));
        assert_non_null(haft_chaos_sampler_name((haft_chaos_sampler)k));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vectors_come_back_from_q),
        cmocka_unit_test(q_is_what_the_equations_say),
        cmocka_unit_test(any_q_gives_a_law_by_the_strict_bounds),
        cmocka_unit_test(components_are_standardised),
        cmocka_unit_test(epsilon_chooses_the_fewest_components),
        cmocka_unit_test(expansion_is_the_sum_of_its_terms),
        cmocka_unit_test(samples_hang_on_their_counter_alone),
        cmocka_unit_test(bootstrap_and_mean_give_what_they_say),
        cmocka_unit_test(parts_make_the_same_model),
        cmocka_unit_test(destroying_nothing_is_allowed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
