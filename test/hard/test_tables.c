/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Laws as tables of noisy points: their slope has a knot every tenth of a nanometre, and the branch
 * is full of small folds. Each jump must lose energy and none come back to the fold it came from,
 * be the valley it leads to ever so narrow. */
#include "random_beam.h"
#include "single_spring.h"

enum { POINTS = 221 };

/* The Morse laws of a random beam as tables, each point off by up to 3 % of the greatest pull. */
static void make_tables(const random_beam *b, uint64_t seed, haft_law_table **table) {
    for (size_t r = 0; r < haft_model_get(b->model)->sites; r++) {
        double d[POINTS], f[POINTS], z[POINTS];
        haft_error error = {0};
        haft_random_normals((haft_random_key){seed, HAFT_RANDOM_TEST}, 1, r, 0, POINTS, z);
        for (int i = 0; i < POINTS; i++) {
            d[i] = 6e-9 + 0.1e-9 * i;
            double fade = fmin(1, (POINTS - 1 - i) / 60.0); /* the last points are nil */
            f[i] = haft_law_evaluate(&b->law[r], d[i]).force * (fade > 0 ? 1 : 0) +
                   0.01 * b->law[r].f_max * fade * fmax(-3, fmin(3, z[i])) * (i > 0);
        }
        check_ok(haft_law_table_create(&table[r], POINTS, d, f, &error), error);
        b->law[r] = haft_law_from_table(table[r]);
    }
}

/* The cycle of a beam over such tables, its corrector as exact as asked; 0: the default. */
static haft_path *cycle_over_tables(uint64_t seed, double ledger_tolerance,
                                    double residual_tolerance) {
    haft_mesh_spec mesh = {HAFT_MESH_UNIFORM, 15e-6, 3e-6, 60e-6, 0};
    random_beam b = random_beam_create(seed, mesh);
    haft_law_table *table[200] = {NULL};
    make_tables(&b, seed, table);
    haft_path *path =
        random_beam_cycle(&b, (haft_path_options){.step_limit = 60000,
                                                  .ledger_tolerance = ledger_tolerance,
                                                  .residual_tolerance = residual_tolerance});
    for (size_t r = 0; r < 200; r++) {
        haft_law_table_destroy(&table[r]);
    }
    random_beam_destroy(&b);
    return path;
}

static void every_jump_goes_down(void **state) {
    (void)state;
    size_t jumps = 0, most = 0;
    double least = INFINITY, ledger = 0;
    for (uint64_t seed = 1; seed <= 6; seed++) {
        haft_path *path = cycle_over_tables(seed, 1e-7, 0);
        assert_int_equal(path->outcome, HAFT_OUTCOME_STUCK);
        for (size_t j = 0; j < path->jumps; j++) {
            least = fmin(least, path->jump[j].dissipated);
        }
        jumps += path->jumps;
        most = path->jumps > most ? path->jumps : most;
        ledger = fmax(ledger, path->ledger_error);
        haft_path_destroy(&path);
    }
    print_message("  %zu jumps, %zu at most a beam, each losing %.1e J or more; ledger to %.1e\n",
                  jumps, most, least, ledger);
    assert_true(least > 0);
    assert_true(most < 500);
    check_less(ledger, 1e-6);
}

/* A state that is off its branch by what the corrector was allowed, in the soft direction of a
 * fold nearby, ends no path: the energy it misses is of no step. */
static void a_loose_corrector_ends_no_path(void **state) {
    (void)state;
    double ledger = 0, crack = 0;
    for (uint64_t seed = 1; seed <= 6; seed++) {
        haft_path *tight = cycle_over_tables(seed, 0, 0), *loose = cycle_over_tables(seed, 0, 5e-7);
        assert_int_equal(loose->outcome, HAFT_OUTCOME_STUCK);
        double length = tight->point[tight->points - 1].crack_length;
        crack = fmax(crack, fabs(loose->point[loose->points - 1].crack_length - length));
        ledger = fmax(ledger, loose->ledger_error);
        haft_path_destroy(&tight);
        haft_path_destroy(&loose);
    }
    print_message("  cracks moved by %.1e m; ledger to %.1e\n", crack, ledger);
    check_less(crack, 1e-8);
    check_less(ledger, 1e-9);
}

/* A spring over a law of fine, noisy points: valleys narrower than what a fold is left by. Loads of
 * the folds against those of the load's own curve, walked along in small steps. */
#define SPRING_GAP 100e-9
#define SPRING_AREA 1e-12

enum { FINE = 400, WALK = 1 << 21, FOLDS = 400 };

/* A pull of 1 MPa over 8 nm, its points off by so much that the spring is now and then too soft. */
static double make_fine_table(uint64_t seed, double step, haft_law_table **table) {
    double d[FINE], f[FINE], z[FINE], length = step * (FINE - 1);
    haft_error error = {0};
    haft_random_normals((haft_random_key){seed, HAFT_RANDOM_TEST}, 2, 0, 0, FINE, z);
    double steepest = 0.5e6 * M_PI / length;
    for (int i = 0; i < FINE; i++) {
        double s = (double)i / (FINE - 1);
        d[i] = i == 0 ? 9e-9 : 10e-9 + step * i; /* a wall in front */
        f[i] = i == 0 ? 5e6
                      : -0.5e6 * (1 + cos(M_PI * s)) +
                            (i < FINE - 1 ? 0.05 * steepest * step * z[i] : 0);
    }
    check_ok(haft_law_table_create(table, FINE, d, f, &error), error);
    return steepest;
}

/* Load that holds the spring at displacement w. */
static double load_at(const haft_law *law, double k, double w) {
    return k * w + SPRING_AREA * haft_law_evaluate(law, SPRING_GAP - w).force;
}

/* Loads of the folds met in loading from 0 up to `limit`, in order; how many. */
static int walk(const haft_law *law, double k, double limit, double *fold) {
    int folds = 0;
    double dw = 0.9 * SPRING_GAP / WALK, highest = -INFINITY;
    bool falling = false;
    for (int i = 0; i <= WALK && highest < limit; i++) {
        double load = load_at(law, k, i * dw);
        if (load >= highest) {
            highest = load;
            falling = false;
        } else if (!falling) {
            assert_true(folds < FOLDS);
            fold[folds++] = highest;
            falling = true;
        }
    }
    return folds;
}

static void narrow_valleys_are_left_for_good(void **state) {
    (void)state;
    int all = 0;
    double worst = 0;
    for (uint64_t seed = 1; seed <= 10; seed++) {
        haft_law_table *table = NULL;
        double k = 1.05 * SPRING_AREA * make_fine_table(seed, 0.02e-9, &table);
        double limit = k * 0.9 * SPRING_GAP, fold[FOLDS];
        haft_law law = haft_law_from_table(table);
        int folds = walk(&law, k, limit, fold);
        haft_model *model = single_spring(k, SPRING_GAP, SPRING_AREA);
        haft_programme programme = {-1, 0.01, limit};
        haft_path_options options = {.ledger_tolerance = 0}; /* the default: it tells hops */
        haft_path *path = NULL;
        haft_error error = {0};
        check_ok(haft_solve_path(&path, model, &law, &programme, &options, &error), error);
        assert_int_equal(path->outcome, HAFT_OUTCOME_FREE);
        assert_true(folds > 15 && path->jumps >= (size_t)folds);
        for (int i = 0; i < folds; i++) {
            assert_int_equal(path->jump[i].phase, 0);
            worst = fmax(worst, fabs(path->jump[i].load / fold[i] - 1));
        }
        assert_int_equal(path->jump[folds].phase, 1);
        all += folds;
        haft_path_destroy(&path);
        haft_model_destroy(&model);
        haft_law_table_destroy(&table);
    }
    print_message("  %d folds, loads within %.1e of the curve's own\n", all, worst);
    check_less(worst, 2e-10);
}

enum { COARSE = 40 };

/* A pull of 1 MPa on uneven points, each off by some 40 %: its slope leaps from knot to knot. */
static haft_law_table *make_leaping_table(uint64_t seed, double *softness) {
    double d[COARSE], f[COARSE], z[3 * COARSE], x = 10e-9;
    haft_error error = {0};
    haft_law_table *table = NULL;
    haft_random_normals((haft_random_key){seed, HAFT_RANDOM_TEST}, 3, 0, 0, 3 * COARSE, z);
    for (int i = 0; i < COARSE; i++) {
        d[i] = x;
        x += 0.2e-9 * exp(1.2 * z[i]);
    }
    for (int i = 0; i < COARSE; i++) {
        double s = (d[i] - d[0]) / (d[COARSE - 1] - d[0]);
        f[i] = -0.5e6 * (1 + cos(M_PI * s)) * (1 + 0.4 * z[COARSE + i]);
    }
    f[0] = 5e6;
    f[COARSE - 1] = 0;
    check_ok(haft_law_table_create(&table, COARSE, d, f, &error), error);
    *softness = exp(0.7 * z[2 * COARSE]);
    return table;
}

/* On the first two, of 58000 looked at, the stages of a flow step cancelled time after time on a
 * knot, with an error that was allowed. */
static void no_landing_is_caught_on_a_knot(void **state) {
    (void)state;
    static const uint64_t seeds[] = {15949, 42326, 1, 2, 3, 4, 5, 6, 7, 8};
    int most = 0;
    for (size_t i = 0; i < sizeof seeds / sizeof *seeds; i++) {
        double softness = 1;
        haft_law_table *table = make_leaping_table(seeds[i], &softness);
        double k = SPRING_AREA * 1e6 / 8e-9 * softness; /* a pull of 1 MPa over 8 nm [N/m] */
        haft_law law = haft_law_from_table(table);
        haft_model *model = single_spring(k, SPRING_GAP, SPRING_AREA);
        haft_programme programme = {-1, 0.01, k * 0.9 * SPRING_GAP};
        haft_path_options options = {.ledger_tolerance = 1e-7};
        haft_path *path = NULL;
        haft_error error = {0};
        check_ok(haft_solve_path(&path, model, &law, &programme, &options, &error), error);
        assert_true(path->outcome == HAFT_OUTCOME_FREE || path->outcome == HAFT_OUTCOME_STUCK);
        for (size_t j = 0; j < path->jumps; j++) {
            most = path->jump[j].flow_steps > most ? path->jump[j].flow_steps : most;
        }
        haft_path_destroy(&path);
        haft_model_destroy(&model);
        haft_law_table_destroy(&table);
    }
    print_message("  %d flow steps a landing at most\n", most);
    assert_true(most < 1000);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(no_landing_is_caught_on_a_knot),
                                       cmocka_unit_test(every_jump_goes_down),
                                       cmocka_unit_test(a_loose_corrector_ends_no_path),
                                       cmocka_unit_test(narrow_valleys_are_left_for_good)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
