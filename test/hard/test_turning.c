/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads that turn beside a fold, and jumps that land beside one. Springs over Morse laws, whose
 * folds have closed forms: k = A f'(d), i.e. E (1 - E) = k / (2 A f_max a); with two springs
 * coupled weakly, folds by one scalar equation in long double. */
#include "check.h"
#include "haft/solve.h"

#define GAP 100e-9
#define AREA 1e-12
#define F_LIMIT 5e6

static const haft_law_vector VECTOR = {7e-3, 3e6, 9e-9, 7e-9};

/* Springs of stiffness k[i] under site i, each carrying its share of the load, and one of
 * stiffness c between them. */
static haft_model *make_springs(int n, const double *k, double c) {
    haft_element element[3];
    haft_site site[2], load = {.dof = {-1, -1, -1, -1}};
    for (int i = 0; i < n; i++) {
        element[i] = (haft_element){
            .dof = {i, -1, -1, -1}, .mode = {{1}}, .stiffness = {k[i] / k[0]}, .mass = {1}};
        site[i] = (haft_site){.area = AREA, .dof = {i, -1, -1, -1}, .shape = {GAP}};
        load.dof[i] = i;
        load.shape[i] = GAP / n;
    }
    element[n] =
        (haft_element){.dof = {0, n - 1, -1, -1}, .mode = {{1, -1}}, .stiffness = {c / k[0]}};
    haft_model_parts parts = {.dofs = (size_t)n,
                              .energy_unit = k[0] * GAP * GAP,
                              .gap = GAP,
                              .elements = (size_t)(n == 2 ? 3 : 1),
                              .element = element,
                              .sites = (size_t)n,
                              .site = site,
                              .load = load};
    haft_model *model = NULL;
    haft_error error = {0};
    check_ok(haft_model_create(&model, &parts, &error), error);
    return model;
}

static haft_path *follow(const haft_model *model, const haft_law *law, double limit) {
    haft_error error = {0};
    haft_programme programme = {-1, 0.5, limit};
    haft_path *path = NULL;
    check_ok(haft_solve_path(&path, model, law, &programme, NULL, &error), error);
    check_less(path->ledger_error, 1e-10);
    return path;
}

/* The law from its vector, in long double. */
static void law_at(const haft_law_vector *v, long double d, long double *f, long double *slope) {
    long double top = v->f_max, rise = sqrtl(1 + F_LIMIT / top);
    long double left = logl(1 + rise) / ((long double)v->d_max - v->d_limit);
    long double right = 1.5L / (v->e / top - 0.5L / left), y = d - v->d_max;
    long double a = y < 0 ? left : right, e = expl(-a * y), t = d - v->d_limit;
    *f = t < 0 ? F_LIMIT - 2 * top * left * (1 + rise) * rise * t : top * (e * e - 2 * e);
    *slope = t < 0 ? -2 * top * left * (1 + rise) * rise : -2 * a * top * (e * e - e);
}

/* Load at a fold of one spring: pulling in (far) or out. */
static double fold_load(const haft_law_vector *v, double k, bool far) {
    long double top = v->f_max, rise = sqrtl(1 + F_LIMIT / top), f, slope;
    long double left = logl(1 + rise) / ((long double)v->d_max - v->d_limit);
    long double right = 1.5L / (v->e / top - 0.5L / left), c = k / (2 * AREA * top * right);
    long double e = far ? 2 * c / (1 + sqrtl(1 - 4 * c)) : (1 + sqrtl(1 - 4 * c)) / 2;
    long double d = v->d_max - logl(e) / right;
    law_at(v, d, &f, &slope);
    return (double)(k * (GAP - d) + AREA * f);
}

static double slope_scale(void) { /* softness 1: the spring barely does not snap */
    haft_law law;
    assert_int_equal(haft_law_morse(&law, &VECTOR, F_LIMIT), HAFT_LAW_SOUND);
    return AREA * law.f_max * law.a_right / 2;
}

/* The limit just below the fold's load: no jump; just above: the jump. */
static void a_load_that_turns_beside_a_fold(void **state) {
    (void)state;
    static const double distance[] = {1e-3, 1e-6, 1e-9, 1e-11, 1e-12};
    haft_law law;
    assert_int_equal(haft_law_morse(&law, &VECTOR, F_LIMIT), HAFT_LAW_SOUND);
    for (double softness = 0.01; softness < 0.9; softness *= 3) {
        double k = softness * slope_scale();
        double in = fold_load(&VECTOR, k, true), out = fold_load(&VECTOR, k, false);
        haft_model *model = make_springs(1, &k, 0);
        for (size_t i = 0; i < sizeof distance / sizeof *distance; i++) {
            haft_path *path = follow(model, &law, in * (1 - distance[i]));
            assert_int_equal(path->jumps, 0);
            assert_int_equal(path->outcome, HAFT_OUTCOME_FREE);
            assert_true(path->turned_by_load);
            check_relative(path->point[path->turn].load, in * (1 - distance[i]), 0);
            haft_path_destroy(&path);
            path = follow(model, &law, in * (1 + distance[i]));
            assert_int_equal(path->jumps, out > 0 ? 2 : 1);
            assert_int_equal(path->jump[0].departure, HAFT_DEPARTURE_FOLD);
            assert_int_equal(path->jump[0].phase, 0);
            check_relative(path->jump[0].load, in, 1e-12);
            check_relative(path->point[path->turn].load, in * (1 + distance[i]), 0);
            haft_path_destroy(&path);
        }
        haft_model_destroy(&model);
    }
}

/* The pull-out just above no load, or just below it: free or stuck. */
static void an_unloading_that_ends_beside_a_fold(void **state) {
    (void)state;
    haft_law law;
    assert_int_equal(haft_law_morse(&law, &VECTOR, F_LIMIT), HAFT_LAW_SOUND);
    double low = 0.001 * slope_scale(), high = 0.9 * slope_scale();
    assert_true(fold_load(&VECTOR, low, false) < 0 && fold_load(&VECTOR, high, false) > 0);
    for (int i = 0; i < 100; i++) {
        double middle = 0.5 * (low + high);
        *(fold_load(&VECTOR, middle, false) < 0 ? &low : &high) = middle;
    }
    for (double distance = 1e-3; distance > 0.9e-11; distance /= 10) {
        for (int side = -1; side <= 1; side += 2) {
            double k = low * (1 + side * distance), in = fold_load(&VECTOR, k, true);
            haft_model *model = make_springs(1, &k, 0);
            haft_path *path = follow(model, &law, 1.1 * in);
            double out = fold_load(&VECTOR, k, false);
            assert_true((out > 0) == (side > 0));
            assert_int_equal(path->jumps, side > 0 ? 2 : 1);
            assert_int_equal(path->outcome, side > 0 ? HAFT_OUTCOME_FREE : HAFT_OUTCOME_STUCK);
            if (side > 0) {
                check_near(path->jump[1].load, out, 1e-12 * in);
            }
            assert_true(path->point[path->points - 1].load == 0);
            haft_path_destroy(&path);
            haft_model_destroy(&model);
        }
    }
}

/* Two springs, a weak one between them; site 1's law may be shifted. */
typedef struct pair {
    haft_law_vector v[2];
    long double k[2], c;
} pair;

/* Force of spring i at displacement w beside the other at w_other, and its slope in w. */
static long double pull_of(const pair *p, int i, long double w, long double other,
                           long double *slope) {
    long double f, s;
    law_at(&p->v[i], (long double)GAP - w, &f, &s);
    *slope = p->k[i] + p->c - AREA * s;
    return p->k[i] * w + p->c * (w - other) + AREA * f;
}

/* With spring `lead` held at w, where the other rests on its branch (between low and high, where
 * its slope is positive): bisection. @return dP/dw and *load. */
static long double rate_along(const pair *p, int lead, long double w, const long double range[2],
                              long double *load) {
    long double low = range[0], high = range[1], own, theirs;
    long double lead_slope, other_slope;
    for (int i = 0; i < 66; i++) {
        long double middle = (low + high) / 2;
        own = pull_of(p, lead, w, middle, &lead_slope);
        theirs = pull_of(p, 1 - lead, middle, w, &other_slope);
        *(theirs - own < 0 ? &low : &high) = middle;
    }
    own = pull_of(p, lead, w, low, &lead_slope);
    pull_of(p, 1 - lead, low, w, &other_slope);
    *load = 2 * own;
    /* own(w, o) = theirs(o, w): o' = (lead_slope + c) / (other_slope + c) */
    long double follow_rate = (lead_slope + p->c) / (other_slope + p->c);
    return lead_slope - p->c * follow_rate;
}

/* Gap at which spring i turns unstable, the other held. */
static long double far_fold(const pair *p, int i) {
    long double low = p->v[i].d_max, high = GAP, slope;
    for (int turn = 0; turn < 100; turn++) {
        long double middle = (low + high) / 2;
        pull_of(p, i, (long double)GAP - middle, 0, &slope);
        *(slope < 0 || middle < p->v[i].d_max + 1e-9L ? &low : &high) = middle;
    }
    return high;
}

/* The fold of spring `lead` pulling in: first zero of dP/dw, from afar towards its law. */
static long double coupled_fold(const pair *p, int lead, bool other_closed) {
    long double stop = (long double)GAP - p->v[lead].d_max, step = stop / 100, load;
    long double closed[2] = {(long double)GAP - p->v[1 - lead].d_max, 1.2L * GAP};
    long double open[2] = {-0.2L * GAP, (long double)GAP - far_fold(p, 1 - lead)};
    const long double *range = other_closed ? closed : open;
    long double low = 0.6L * GAP, high;
    while (low + step < stop && rate_along(p, lead, low + step, range, &load) > 0) {
        low += step;
    }
    high = low + step;
    for (int i = 0; i < 50; i++) {
        long double middle = (low + high) / 2;
        *(rate_along(p, lead, middle, range, &load) > 0 ? &low : &high) = middle;
    }
    return load;
}

/* The first jump's landing comes to within `distance` of the second's fold: two jumps if before
 * it, one that takes both if past it. */
static void a_landing_beside_the_next_fold(void **state) {
    (void)state;
    static const double distance[] = {1e-3, 1e-4, 1e-5, 1e-6, -1e-6, -1e-5, -1e-4, -1e-3};
    double k[2] = {0.1 * slope_scale(), 0.1 * slope_scale()}, c = 0.02 * k[0];
    haft_model *model = make_springs(2, k, c);
    for (size_t i = 0; i < sizeof distance / sizeof *distance; i++) {
        pair p = {{VECTOR, VECTOR}, {k[0], k[1]}, 0};
        p.c = k[0] * (long double)(c / k[0]);
        double low = 0, high = 5e-9; /* how much nearer the second site is to its substrate */
        for (int turn = 0; turn < 48; turn++) {
            double shift = 0.5 * (low + high);
            p.v[1].d_max = VECTOR.d_max - shift, p.v[1].d_limit = VECTOR.d_limit - shift;
            long double first = coupled_fold(&p, 0, false), second = coupled_fold(&p, 1, true);
            *(second / first - 1 < distance[i] ? &low : &high) = shift;
        }
        long double first = coupled_fold(&p, 0, false), second = coupled_fold(&p, 1, true);
        check_near((double)(second / first - 1), distance[i], 1e-9);
        haft_law law[2];
        for (int r = 0; r < 2; r++) {
            assert_int_equal(haft_law_morse(&law[r], &p.v[r], F_LIMIT), HAFT_LAW_SOUND);
        }
        haft_path *path = follow(model, law, 1.5 * (double)first);
        size_t in = 0;
        while (in < path->jumps && path->jump[in].phase == 0) {
            in++;
        }
        assert_int_equal(in, distance[i] > 0 ? 2 : 1);
        check_relative(path->jump[0].load, (double)first, 1e-11);
        assert_int_equal(path->jump[0].site, 0);
        assert_int_equal(path->jump[0].sites_switched, distance[i] > 0 ? 1 : 2);
        if (distance[i] > 0) {
            check_relative(path->jump[1].load, (double)second, 1e-11);
            assert_int_equal(path->jump[1].site, 1);
            assert_int_equal(path->jump[1].sites_switched, 1);
        }
        print_message("  %+.0e: %zu jumps in, %d and %d flow steps\n", distance[i], in,
                      path->jump[0].flow_steps, in > 1 ? path->jump[1].flow_steps : 0);
        haft_path_destroy(&path);
    }
    haft_model_destroy(&model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_load_that_turns_beside_a_fold),
        cmocka_unit_test(an_unloading_that_ends_beside_a_fold),
        cmocka_unit_test(a_landing_beside_the_next_fold),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
