/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the model refuses, each with one sentence that names what is wrong and what would do. */
#include "chaos_model.h"

enum { M = 60 };

static void refuse(size_t m, const haft_law_vector *v, haft_chaos_spec spec, const char *first,
                   const char *second) {
    haft_chaos *c = (haft_chaos *)&spec; /* must be cleared */
    haft_error error = {0};
    haft_status status = haft_chaos_create(&c, m, v, &spec, &error);
    if (status != HAFT_ERROR_INPUT || c != NULL || strstr(error.message, first) == NULL ||
        strstr(error.message, second) == NULL) {
        fail_msg("wanted \"%s\" and \"%s\", got %s: %s", first, second, haft_status_name(status),
                 error.message);
    }
}

static haft_chaos_spec usual(void) {
    return (haft_chaos_spec){.f_limit = TEST_F_LIMIT, .components = 3, .order = 2};
}

static void bad_vectors_are_named(void **state) {
    (void)state;
    haft_law_vector *v = skewed_vectors(M, 1, 0.3), good = v[17];
    refuse(3, v, usual(), "3 law vectors are too few for 3 components", "4 are the fewest");
    refuse(0, v, usual(), "0 law vectors", "4");
    v[17].d_max = NAN;
    refuse(M, v, usual(), "law vector 17 of 60", "finite");
    v[17] = good;
    v[17].e = -good.e;
    refuse(M, v, usual(), "law vector 17 of 60", "positive");
    v[17] = good;
    v[17].f_max = 0;
    refuse(M, v, usual(), "law vector 17 of 60", "positive");
    v[17] = good;
    v[17].d_limit = good.d_max;
    refuse(M, v, usual(), "law vector 17 of 60", "positive");
    v[17] = good;
    v[17].e = 0.1 * good.e; /* below the left wing's energy */
    refuse(M, v, usual(), "law vector 17 of 60", "paper's bounds");
    haft_chaos_spec paper = usual();
    paper.bounds = HAFT_CHAOS_BOUNDS_PAPER;
    haft_chaos *c = make_model(M, v, &paper);
    haft_chaos_destroy(&c);
    free(v);
}

static void constant_and_dependent_numbers_are_named(void **state) {
    (void)state;
    haft_law_vector *v = skewed_vectors(M, 1, 0.3);
    for (size_t k = 0; k < M; k++) {
        v[k] = test_vector(2e-3 * exp(0.1 * sin((double)k)), 4e5, 1e-8 * (1 + 0.1 * cos((double)k)),
                           3e-9);
    }
    refuse(M, v, usual(), "number 1, ln f_max, is the same in all 60", "vary");
    for (size_t k = 0; k < M; k++) { /* two sources in four numbers */
        double a = sin((double)k), b = cos(2.3 * (double)k);
        v[k] = test_vector(2e-3 * exp(0.1 * a), 4e5 * exp(0.2 * b), 1e-8 + 1e-10 * (a + b),
                           3e-9 * exp(0.1 * (a - b)));
    }
    refuse(M, v, usual(), "3 components asked for", "take 2");
    haft_chaos_spec spec = usual();
    spec.components = 0;
    spec.epsilon = 1e-15; /* as many as there are */
    haft_chaos *c = make_model(M, v, &spec);
    haft_chaos_parts p;
    haft_chaos_get_parts(c, &p);
    assert_int_equal(p.components, 2);
    haft_chaos_destroy(&c);
    free(v);
}

static void bad_choices_are_named(void **state) {
    (void)state;
    haft_law_vector *v = skewed_vectors(M, 1, 0.3);
    haft_chaos_spec s = usual();
#define REFUSE(change, first, second)                                                              \
    do {                                                                                           \
        s = usual();                                                                               \
        change;                                                                                    \
        refuse(M, v, s, first, second);                                                            \
    } while (0)
    REFUSE(s.f_limit = 0, "f_limit", "positive");
    REFUSE(s.f_limit = INFINITY, "f_limit", "positive");
    REFUSE(s.components = 5, "5 components", "4 at most");
    REFUSE(s.components = 0, "epsilon = 0", "between 0 and 1");
    REFUSE((s.components = 0, s.epsilon = 1), "epsilon = 1", "between 0 and 1");
    REFUSE(s.bandwidth = -1, "bandwidth = -1", "Scott");
    REFUSE(s.bandwidth = NAN, "bandwidth = nan", "Scott");
    REFUSE(s.order = 41, "order 41", "40 is the highest");
    REFUSE(s.points = 2, "2 Gauss points", "give 3 to 128");
    REFUSE(s.points = 129, "129 Gauss points", "give 3 to 128");
    REFUSE((s.components = 4, s.points = 46), "46 Gauss points in each of 4", "take 45");
    REFUSE(s.component_order[1] = 3, "entry 1 is 3", "0 to 2");
    REFUSE(s.component_order[2] = 1, "entry 1 is 0", "once");
    REFUSE(s.germ = (haft_chaos_germ)7, "germ 7", "0 is always one");
    REFUSE(s.kernel = (haft_chaos_kernel)7, "kernel 7", "0 is always one");
    REFUSE(s.bounds = (haft_chaos_bounds)7, "bounds 7", "0 is always one");
#undef REFUSE
    free(v);
}

static void too_great_an_effort_is_named(void **state) {
    (void)state;
    haft_law_vector *v = skewed_vectors(M, 1, 0.3);
    haft_chaos_spec spec = usual();
    haft_chaos *c = make_model(M, v, &spec);
    haft_chaos_errors errors;
    haft_error error = {0};
    haft_chaos_effort effort = {HAFT_CHAOS_GRID_LIMIT + 1, 1};
    assert_int_equal(haft_chaos_measure(c, &effort, &errors, &error), HAFT_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "4194305 maps"));
    effort = (haft_chaos_effort){1, HAFT_CHAOS_GRID_LIMIT + 1};
    assert_int_equal(haft_chaos_measure(c, &effort, &errors, &error), HAFT_ERROR_ARGUMENT);
    haft_chaos_destroy(&c);
    free(v);
}

/* ---- parts from a file ---- */

typedef struct copy {
    haft_chaos_parts p;
    haft_law_vector vector[M];
    double centre[3 * M], coefficient[3 * 10];
    unsigned index[3 * 10];
} copy;

static void take(copy *to, const haft_chaos_parts *p) {
    to->p = *p;
    memcpy(to->vector, p->vector, sizeof to->vector);
    memcpy(to->centre, p->centre, sizeof to->centre);
    memcpy(to->coefficient, p->coefficient, sizeof to->coefficient);
    memcpy(to->index, p->index, sizeof to->index);
    to->p.vector = to->vector;
    to->p.centre = to->centre;
    to->p.coefficient = to->coefficient;
    to->p.index = to->index;
}

static void refuse_parts(const copy *bad, const char *words) {
    haft_chaos *c = (haft_chaos *)&words;
    haft_error error = {0};
    haft_status status = haft_chaos_create_from_parts(&c, &bad->p, &error);
    if (status != HAFT_ERROR_INPUT || c != NULL || strstr(error.message, words) == NULL) {
        fail_msg("wanted \"%s\", got %s: %s", words, haft_status_name(status), error.message);
    }
}

static void bad_parts_are_named(void **state) {
    (void)state;
    haft_law_vector *v = skewed_vectors(M, 1, 0.3);
    haft_chaos_spec spec = usual();
    haft_chaos *c = make_model(M, v, &spec), *d = NULL;
    haft_chaos_parts p;
    haft_error error = {0};
    haft_chaos_get_parts(c, &p);
    copy x;
    take(&x, &p);
    check_ok(haft_chaos_create_from_parts(&d, &x.p, &error), error);
    haft_chaos_destroy(&d);
#define REFUSE(change, words)                                                                      \
    do {                                                                                           \
        take(&x, &p);                                                                              \
        change;                                                                                    \
        refuse_parts(&x, words);                                                                   \
    } while (0)
    REFUSE(x.p.germ = (haft_chaos_germ)4, "germ 4");
    REFUSE(x.p.components = 0, "components is 0");
    REFUSE(x.p.components = 5, "components is 5");
    REFUSE(x.p.m = 0, "m is 0");
    REFUSE(x.p.order = 41, "order is 41");
    REFUSE(x.p.points = 2, "points is 2");
    REFUSE(x.p.terms = 9, "have 10");
    REFUSE(x.p.order = 1, "have 4");
    REFUSE(x.p.centre = NULL, "missing");
    REFUSE(x.p.f_limit = 0, "f_limit");
    REFUSE(x.p.bandwidth = 0, "bandwidth is 0");
    REFUSE(x.p.bandwidth = NAN, "bandwidth is nan");
    REFUSE(x.p.sigma[3] = 0, "sigma[3] is 0");
    REFUSE(x.p.mean[1] = INFINITY, "mean[1] is inf");
    REFUSE(x.p.eigenvalue[2] = 3.9, "eigenvalue[2] is 3.9");
    REFUSE(x.p.eigenvalue[0] = NAN, "eigenvalue[0] is nan");
    REFUSE(x.p.eigenvector[1][1] += 1e-3, "eigenvectors");
    REFUSE(x.p.component_order[1] = 0, "component_order[1] is 0");
    REFUSE(x.p.component_order[2] = 3, "component_order[2] is 3");
    REFUSE(x.vector[5].e = 0, "vector[5]");
    REFUSE(x.vector[5].d_limit = NAN, "vector[5]");
    REFUSE(x.centre[3 * 7 + 2] = NAN, "centre[7][2] is nan");
    REFUSE(x.centre[3 * 7 + 2] = 1e10, "centre[7][2] is 1e+10");
    REFUSE(x.index[3 * 4 + 1] = 5, "index[4][1] is 5");
    REFUSE(x.coefficient[3 * 9] = NAN, "coefficient[9][0] is nan");
    REFUSE(x.coefficient[3 * 1] = 0.5, "coefficient[1][0] is 0.5; it must be 0");
#undef REFUSE
    haft_chaos_destroy(&c);
    free(v);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bad_vectors_are_named),
        cmocka_unit_test(constant_and_dependent_numbers_are_named),
        cmocka_unit_test(bad_choices_are_named),
        cmocka_unit_test(too_great_an_effort_is_named),
        cmocka_unit_test(bad_parts_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
