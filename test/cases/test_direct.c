/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Campaigns whose beams have laws of their own: which are built and kept, and that they are the
 * same bits however they came about. */
#include "same_bits.h"

#include "haft/study.h"

/* A small case whose mesh leaves the first sites out. */
#define ACTIVE                                                                                     \
    { "element_length: 3 um\n  mesh: uniform ", "mesh: active " }

static haft_laws *read_laws(const case_folder *c) {
    char path[400];
    haft_error error = {0};
    haft_laws *laws = NULL;
    check_ok(haft_laws_read(&laws, NULL, path_in(c, "out/laws.h5", path), &error), error);
    return laws;
}

/* All that is known of law k of `a` is what is known of law l of `b`. */
static void check_same_law(const haft_laws *a, size_t k, const haft_laws *b, size_t l) {
    assert_memory_equal(&a->vector[k], &b->vector[l], sizeof *a->vector);
    assert_int_equal(a->fault[k], b->fault[l]);
    assert_memory_equal(&a->zero_distance[k], &b->zero_distance[l], sizeof(double));
    assert_memory_equal(&a->wet_area[k], &b->wet_area[l], sizeof(double));
    const double *curve = haft_laws_curve(a, k), *other = haft_laws_curve(b, l);
    assert_non_null(curve);
    assert_non_null(other);
    assert_int_equal(a->n, b->n);
    assert_memory_equal(curve, other, a->n * sizeof(double));
}

/* The zone begins at 15 um, amid a block of 12 um: the laws behind it are those of a whole beam,
 * also where they are built alone. */
static void sites_that_stay_out_of_range_get_no_laws(void **state) {
    (void)state;
    static const edit active[] = {ACTIVE, {NULL, NULL}};
    case_folder whole = case_create(NULL), part = case_create(active), alone = case_create(active);
    must_run(HAFT_LAWS, ARGS("build", "--quiet", whole.path));
    must_run(HAFT, ARGS("run", "--quiet", part.path));
    must_run(HAFT_LAWS, ARGS("build", "--quiet", alone.path));
    check_same_bytes(&part, &alone, "out/laws.h5");
    haft_laws *all = read_laws(&whole), *some = read_laws(&part);
    assert_true(all->first_site == 0 && all->sites == 30);
    assert_true(some->first_site == 5 && some->sites == 25 && some->m == 50);
    for (size_t k = 0; k < some->m; k++) {
        check_same_law(some, k, all, k / 25 * 30 + 5 + k % 25);
    }
    haft_laws_destroy(&all);
    haft_laws_destroy(&some);
    /* the whole beam's laws serve as well, to the same results */
    copy_laws(&whole, &alone);
    ran r = run_expect(0, HAFT, ARGS("run", alone.path));
    check_says(r.err, "built from the same inputs: reading them");
    ran_free(&r);
    check_same_bytes(&part, &alone, "out/results.h5");
    case_remove(&whole);
    case_remove(&part);
    case_remove(&alone);
}

/* The crack of a beam whose first sites have none is that of the exact mesh. */
static void the_active_mesh_gives_the_exact_cracks(void **state) {
    (void)state;
    static const edit active[] = {ACTIVE, {NULL, NULL}};
    static const edit exact[] = {{"element_length: 3 um\n  mesh: uniform ", "mesh: exact "},
                                 {NULL, NULL}};
    case_folder a = case_create(active), b = case_create(exact);
    case_folder *c[2] = {&a, &b};
    haft_results_view *view[2] = {NULL, NULL};
    haft_error error = {0};
    for (int i = 0; i < 2; i++) {
        char path[400];
        must_run(HAFT, ARGS("run", "--quiet", c[i]->path));
        check_ok(haft_results_read(&view[i], path_in(c[i], "out/results.h5", path), &error), error);
    }
    for (size_t k = 0; k < 2; k++) {
        assert_int_equal(view[0]->summary[k].outcome, HAFT_OUTCOME_STUCK);
        check_relative(view[0]->summary[k].crack_length, view[1]->summary[k].crack_length, 1e-9);
        assert_int_equal(view[0]->summary[k].jumps, view[1]->summary[k].jumps);
    }
    for (int i = 0; i < 2; i++) {
        haft_results_view_destroy(&view[i]);
        case_remove(c[i]);
    }
}

/* More beams than there are laws of: those that are there are read, and the file ends as if all had
 * been built at once. */
static void laws_that_are_there_are_added_to(void **state) {
    (void)state;
    static const edit many[] = {{"realizations: 2", "realizations: 5"}, {NULL, NULL}};
    case_folder grown = case_create(NULL), whole = case_create(many);
    must_run(HAFT, ARGS("run", "--quiet", grown.path));
    case_write(&grown, many);
    ran r = run_expect(0, HAFT, ARGS("run", "--force", grown.path));
    check_says(r.err, "the laws were built from the same inputs: reading them");
    check_says(r.err, "3 beams have no laws yet: building them");
    ran_free(&r);
    must_run(HAFT, ARGS("run", "--quiet", whole.path));
    check_same_bytes(&whole, &grown, "out/laws.h5");
    check_same_bytes(&whole, &grown, "out/laws.csv");
    check_same_bytes(&whole, &grown, "out/results.h5");
    case_remove(&grown);
    case_remove(&whole);
}

/* A campaign that ends by its rule has laws of the beams it needs and no others. */
static void a_campaign_keeps_laws_of_its_own_beams_alone(void **state) {
    (void)state;
    static const edit stopping[] = {
        {"realizations: 2", "realizations: 50\n  stop: {crack_length_mean: 3 um}"},
        {"width: 3 um", "width: 1 um"},
        {"step: 0.2 nm", "step: 0.5 nm"},
        {NULL, NULL}};
    case_folder one = case_create(stopping), more = case_create(stopping);
    must_run(HAFT, ARGS("run", "--quiet", "--threads", "1", one.path));
    must_run(HAFT, ARGS("run", "--quiet", "--threads", "5", more.path));
    check_same_bytes(&one, &more, "out/laws.h5");
    check_same_bytes(&one, &more, "out/laws.csv");
    check_same_bytes(&one, &more, "out/results.h5");
    haft_laws *laws = read_laws(&one);
    assert_int_equal(laws->m, 30 * 30); /* the rule's first look is at 30 */
    haft_laws_destroy(&laws);
    case_remove(&one);
    case_remove(&more);
}

/* The curves that are kept on request change neither laws nor results; figures can be drawn from
 * them; and curves that are wanted later are built then. */
static void a_case_may_keep_the_needed_curves_alone(void **state) {
    (void)state;
    static const edit needed[] = {{"evidence: [0] ", "curves: needed\n  evidence: [0] #"},
                                  {NULL, NULL}};
    static const edit tables[] = {{"evidence: [0] ", "curves: needed\n  evidence: [0] #"},
                                  {"kind: morse", "kind: table"},
                                  {NULL, NULL}};
    case_folder all = case_create(NULL), some = case_create(needed), alone = case_create(needed);
    must_run(HAFT, ARGS("run", "--quiet", all.path));
    must_run(HAFT, ARGS("run", "--quiet", some.path));
    must_run(HAFT_LAWS, ARGS("build", "--quiet", alone.path));
    check_same_bytes(&some, &alone, "out/laws.h5");
    check_same_bytes(&all, &some, "out/laws.csv");
    check_same_bytes(&all, &some, "out/summary.csv");
    haft_laws *a = read_laws(&all), *b = read_laws(&some);
    size_t unfit = 0;
    for (size_t k = 0; k < a->m; k++) {
        bool wanted = k < a->sites || a->fault[k] != HAFT_LAW_SOUND;
        unfit += k >= a->sites && a->fault[k] != HAFT_LAW_SOUND;
        assert_int_equal(haft_laws_curve(b, k) != NULL, wanted);
        if (wanted) {
            check_same_law(a, k, b, k);
        }
    }
    assert_int_equal(b->curves, a->sites + unfit);
    haft_laws_destroy(&a);
    haft_laws_destroy(&b);
    case_write(&some, tables);
    ran r = run_expect(0, HAFT, ARGS("run", "--force", some.path));
    check_says(r.err, "1 beams have no laws yet: building them");
    ran_free(&r);
    b = read_laws(&some);
    assert_int_equal(b->curves, b->m);
    haft_laws_destroy(&b);
    case_remove(&all);
    case_remove(&some);
    case_remove(&alone);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sites_that_stay_out_of_range_get_no_laws),
        cmocka_unit_test(the_active_mesh_gives_the_exact_cracks),
        cmocka_unit_test(laws_that_are_there_are_added_to),
        cmocka_unit_test(a_campaign_keeps_laws_of_its_own_beams_alone),
        cmocka_unit_test(a_case_may_keep_the_needed_curves_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
