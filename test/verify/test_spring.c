/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One spring over one Morse law, the smallest structure that snaps. With w the displacement and
 * d = gap - w the load is P(w) = k w + A f(d), so the folds, k = A f'(d), have closed forms:
 * E (1 - E) = k / (2 A f_max a), E = exp(-a (d - d_max)) on the right wing. Landing and dissipation
 * follow from one scalar equation, solved here in long double. */
#include "haft/solve.h"
#include "single_spring.h"

#define GAP 100e-9L
#define AREA 1e-12L

typedef struct spring {
    haft_model *model;
    haft_law law;
    haft_law_vector vector;
    long double f_limit, k, left, right;
} spring;

static spring make_spring(long double softness) {
    spring s = {.vector = {7e-3, 3e6, 9e-9, 7e-9}, .f_limit = 5e6L};
    assert_int_equal(haft_law_morse(&s.law, &s.vector, (double)s.f_limit), HAFT_LAW_SOUND);
    long double f = s.vector.f_max;
    s.left = logl(1 + sqrtl(1 + s.f_limit / f)) /
             ((long double)s.vector.d_max - (long double)s.vector.d_limit);
    s.right = 1.5L / (s.vector.e / f - 0.5L / s.left);
    s.k = softness * AREA * f * s.right / 2; /* softness < 1 snaps */
    s.model = single_spring((double)s.k, (double)GAP, (double)AREA);
    return s;
}

/* The law once more, in long double and from its definition. */
static long double force(const spring *s, long double d, long double *slope, long double *phi) {
    long double f = s->vector.f_max, x = d - (long double)s->vector.d_max;
    long double a = x < 0 ? s->left : s->right, e = expl(-a * x);
    *slope = 2 * f * a * (e - e * e);
    long double base = x < 0 ? -1.5L * f / s->right + 1.5L * f / s->left : 0;
    *phi = base + f * (e * e / 2 - 2 * e) / a;
    return f * (e * e - 2 * e);
}

static long double fold_gap(const spring *s, int far) {
    long double c = s->k / (2 * AREA * s->vector.f_max * s->right);
    long double e = far ? 2 * c / (1 + sqrtl(1 - 4 * c)) : (1 + sqrtl(1 - 4 * c)) / 2;
    return (long double)s->vector.d_max - logl(e) / s->right;
}

static long double load_at(const spring *s, long double d) {
    long double slope, phi;
    return s->k * (GAP - d) + AREA * force(s, d, &slope, &phi);
}

/* The other equilibrium at a load, by Newton from where only it attracts. */
static long double landing_gap(const spring *s, long double load, long double start) {
    long double d = start;
    for (int i = 0; i < 200; i++) {
        long double slope, phi;
        long double miss = s->k * (GAP - d) + AREA * force(s, d, &slope, &phi) - load;
        d -= miss / (-s->k + AREA * slope);
    }
    return d;
}

static long double potential(const spring *s, long double d, long double load) {
    long double slope, phi, w = GAP - d;
    force(s, d, &slope, &phi);
    return s->k * w * w / 2 + AREA * phi - load * w;
}

static haft_path *follow(const spring *s, double limit, bool states) {
    haft_error error = {0};
    haft_programme programme = {-1, 0.01, limit};
    haft_path_options options = {.keep_states = states};
    haft_path *path = NULL;
    check_ok(haft_solve_path(&path, s->model, &s->law, &programme, &options, &error), error);
    return path;
}

static void folds_landings_and_losses_have_closed_forms(void **state) {
    (void)state;
    for (long double softness = 0.002L; softness < 0.99L; softness *= 2.1L) {
        spring s = make_spring(softness);
        long double in = fold_gap(&s, 1), out = fold_gap(&s, 0);
        long double load_in = load_at(&s, in), load_out = load_at(&s, out);
        haft_path *path = follow(&s, (double)(2 * load_in), true);
        assert_int_equal(path->jumps, load_out > 0 ? 2 : 1);
        for (size_t j = 0; j < path->jumps; j++) {
            long double d = j == 0 ? in : out, load = j == 0 ? load_in : load_out;
            long double start = j == 0 ? (long double)s.vector.d_limit : GAP - load / s.k;
            long double land = landing_gap(&s, load, start);
            check_relative(path->jump[j].load, (double)load, 1e-10);
            long double lost = potential(&s, d, load) - potential(&s, land, load);
            check_relative(path->jump[j].dissipated, (double)lost, 1e-9);
            assert_int_equal(path->jump[j].kind, j == 0 ? HAFT_JUMP_PULL_IN : HAFT_JUMP_PULL_OUT);
            for (size_t i = 0; i < path->points; i++) {
                if (path->point[i].jump == (int)j) {
                    check_relative((double)(GAP * (1 - (long double)path->state[i])), (double)land,
                                   1e-10);
                }
            }
        }
        check_less(path->ledger_error, 1e-10);
        assert_int_equal(path->outcome, load_out > 0 ? HAFT_OUTCOME_FREE : HAFT_OUTCOME_STUCK);
        haft_path_destroy(&path);
        haft_model_destroy(&s.model);
    }
}

/* Every accepted state lies on the curve P(w), within what the residual's tolerance leaves of the
 * forces at hand, where it is stable. */
static void accepted_states_lie_on_the_stable_branches(void **state) {
    (void)state;
    spring s = make_spring(0.3L);
    haft_path *path = follow(&s, (double)(1.01L * load_at(&s, fold_gap(&s, 1))), true);
    long double in = fold_gap(&s, 1), out = fold_gap(&s, 0);
    assert_true(path->points > 20);
    for (size_t i = 0; i < path->points; i++) {
        long double d = GAP * (1 - (long double)path->state[i]);
        double force = fmax(path->point[i].load, (double)(AREA * s.vector.f_max));
        check_near(path->point[i].load, (double)load_at(&s, d), 1e-11 * force);
        assert_true(d > in || (d < out && d > (long double)s.vector.d_limit));
        assert_true(path->point[i].lambda_min > 0 && path->point[i].least_pivot > 0);
    }
    haft_path_destroy(&path);
    haft_model_destroy(&s.model);
}

/* Stiffer than its law, a spring never snaps, and the cycle loses nothing. */
static void a_stiff_spring_never_snaps(void **state) {
    (void)state;
    spring s = make_spring(1.05L);
    haft_path *path = follow(&s, (double)(s.k * 1.2L * GAP), false);
    assert_int_equal(path->jumps, 0);
    assert_int_equal(path->outcome, HAFT_OUTCOME_FREE);
    assert_true(path->point[path->points - 1].dissipated == 0);
    double turnover = path->point[path->turn].work;
    check_near(path->point[path->points - 1].work / turnover, 0, 1e-10);
    haft_path_destroy(&path);
    haft_model_destroy(&s.model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(folds_landings_and_losses_have_closed_forms),
        cmocka_unit_test(accepted_states_lie_on_the_stable_branches),
        cmocka_unit_test(a_stiff_spring_never_snaps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
