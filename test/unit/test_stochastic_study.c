/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Studies of a stochastic model in its order and its vectors. */
#include "chaos_model.h"

#include "haft/study.h"

enum { M = 320 };

/* Laws without curves, and their model, as a case would have them. */
static haft_laws *make_laws(haft_case *c, size_t m, double spread, haft_chaos_kernel kernel) {
    haft_law_vector *v = skewed_vectors(m, 21, spread);
    haft_laws *laws = NULL;
    haft_error error = {0};
    *c = (haft_case){.seed = 3};
    c->law.f_limit = TEST_F_LIMIT;
    c->law.sampler = HAFT_SAMPLER_GPCE;
    c->law.chaos.spec =
        (haft_chaos_spec){.f_limit = TEST_F_LIMIT, .components = 3, .order = 5, .kernel = kernel};
    check_ok(haft_study_fit_laws(&laws, c, m, v, &error), error);
    free(v);
    return laws;
}

static void errors_are_those_of_the_model_itself(void **state) {
    (void)state;
    haft_case c;
    haft_error error = {0};
    haft_laws *laws = make_laws(&c, M, 0.1, HAFT_CHAOS_KERNEL_SCOTT);
    haft_order_error o[] = {{.germ = HAFT_CHAOS_GERM_LEGENDRE, .order = 5},
                            {.germ = HAFT_CHAOS_GERM_LEGENDRE, .order = 1},
                            {.germ = HAFT_CHAOS_GERM_HERMITE, .order = 5},
                            {.germ = HAFT_CHAOS_GERM_JACOBI, .order = 5}};
    check_ok(haft_study_model_orders(laws, &c, 4, o, &error), error);
    haft_chaos_errors own;
    haft_chaos_effort effort = {.maps = HAFT_STUDY_MAPS, .samples = 16384};
    check_ok(haft_chaos_measure(laws->chaos, &effort, &own, &error), error);
    check_near(o[0].errors.relmise_total, own.relmise_total, 0);
    check_near(o[0].errors.relmise_own_total, own.relmise_own_total, 0);
    check_near(o[0].errors.kernel[1].ks, own.kernel[1].ks, 0);
    assert_int_equal(o[0].terms, 56);
    assert_int_equal(o[1].terms, 4);
    for (int i = 0; i < 3; i++) {
        check_near(o[0].errors.relmise[i], own.relmise[i], 0);
        assert_true(o[1].errors.relmise[i] > 2 * o[0].errors.relmise[i]);
    }
    /* nearly normal vectors: Hermite polynomials do better */
    assert_true(o[2].errors.relmise_total < o[0].errors.relmise_total);
    assert_true(o[3].errors.relmise_total < o[0].errors.relmise_total);
    haft_laws_destroy(&laws);
}

static void more_vectors_are_closer_to_all(void **state) {
    (void)state;
    for (int kernel = 0; kernel < 2; kernel++) {
        haft_case c;
        haft_error error = {0};
        size_t m[HAFT_STUDY_PARTS];
        haft_vectors_error v[HAFT_STUDY_PARTS];
        haft_laws *laws = make_laws(&c, M, 0.1, (haft_chaos_kernel)kernel);
        size_t n = haft_study_model_parts(laws, m);
        assert_int_equal(n, 4);
        for (size_t i = 0; i < n; i++) {
            assert_int_equal(m[i], M >> (n - 1 - i));
        }
        check_ok(haft_study_model_vectors(laws, &c, n, m, v, &error), error);
        for (size_t i = 0; i < n; i++) {
            assert_int_equal(v[i].parts, M / m[i] < 8 ? M / m[i] : 8);
            for (int j = 0; j < 3; j++) {
                if (i + 1 < n) { /* by quarters the fall is plain, by halves chance may hide it */
                    assert_true(v[i].density[j] > 0 && v[i].density_error[j] > 0);
                    check_less(i + 2 < n ? v[i + 2].density[j] : 0, v[i].density[j]);
                } else {
                    check_near(v[i].density[j], 0, 1e-24);
                    assert_true(isnan(v[i].density_error[j]));
                }
                check_less(v[n - 1].w1[j], v[0].w1[j]);
            }
        }
        check_near(v[n - 1].relmise, laws->errors.relmise_total, 0); /* the model itself */
        haft_laws_destroy(&laws);
    }
}

static void impossible_numbers_of_vectors_are_told(void **state) {
    (void)state;
    haft_case c;
    haft_error error = {0};
    haft_vectors_error v[1];
    haft_laws *laws = make_laws(&c, 60, 0.1, HAFT_CHAOS_KERNEL_SCOTT);
    assert_int_equal(haft_study_model_vectors(laws, &c, 1, (size_t[]){61}, v, &error),
                     HAFT_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "there are 60 vectors, not 61"));
    error = (haft_error){0};
    assert_int_equal(haft_study_model_vectors(laws, &c, 1, (size_t[]){2}, v, &error),
                     HAFT_ERROR_INPUT);
    haft_laws_destroy(&laws);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_are_those_of_the_model_itself),
        cmocka_unit_test(more_vectors_are_closer_to_all),
        cmocka_unit_test(impossible_numbers_of_vectors_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
