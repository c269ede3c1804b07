/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Laws as tables of noisy points: their slope has a knot every tenth of a nanometre, and the branch
 * is full of small folds. Each jump must lose energy and none come back to the fold it came from.
 */
#include "random_beam.h"

enum { POINTS = 221 };

/* The Morse laws of a random beam as tables, each point off by up to 3 % of the greatest pull. */
static void make_tables(const random_beam *b, uint64_t seed, haft_law_table **table) {
    for (size_t r = 0; r < b->model->sites; r++) {
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

static void every_jump_goes_down(void **state) {
    (void)state;
    size_t jumps = 0, most = 0;
    double least = INFINITY, ledger = 0;
    for (uint64_t seed = 1; seed <= 6; seed++) {
        haft_mesh_spec mesh = {HAFT_MESH_UNIFORM, 15e-6, 3e-6, 60e-6, 0};
        random_beam b = random_beam_create(seed, mesh);
        haft_law_table *table[200] = {NULL};
        make_tables(&b, seed, table);
        haft_path *path = random_beam_cycle(
            &b, (haft_path_options){.step_limit = 60000, .ledger_tolerance = 1e-7});
        assert_int_equal(path->outcome, HAFT_OUTCOME_STUCK);
        for (size_t j = 0; j < path->jumps; j++) {
            least = fmin(least, path->jump[j].dissipated);
        }
        jumps += path->jumps;
        most = path->jumps > most ? path->jumps : most;
        ledger = fmax(ledger, path->ledger_error);
        haft_path_destroy(&path);
        for (size_t r = 0; r < 200; r++) {
            haft_law_table_destroy(&table[r]);
        }
        random_beam_destroy(&b);
    }
    print_message("  %zu jumps, %zu at most a beam, each losing %.1e J or more; ledger to %.1e\n",
                  jumps, most, least, ledger);
    assert_true(least > 0);
    assert_true(most < 500);
    check_less(ledger, 1e-6);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_jump_goes_down)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
