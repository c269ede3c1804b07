/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fifty random beams, each followed in eight ways: the same jumps at the same loads, and
 * the same end. */
#include "random_beam.h"

static const struct {
    const char *what;
    haft_path_options options;
} ways[] = {
    {"gap steps a tenth", {.gap_step = 0.05}},
    {"gap steps ten times", {.gap_step = 5}},
    {"flow steps a tenth", {.flow_step = 0.01}},
    {"flow steps ten times", {.flow_step = 1}},
    {"ledger a hundredth", {.ledger_tolerance = 1e-12}},
    {"residual a hundredth", {.residual_tolerance = 1e-13}},
    {"KLU alone", {.linear_solver = HAFT_LINEAR_SOLVER_KLU}},
    {"the band solver alone", {.linear_solver = HAFT_LINEAR_SOLVER_BAND}},
};
enum { WAYS = sizeof ways / sizeof *ways, BEAMS = 50 };

static void all_ways_agree(void **state) {
    (void)state;
    size_t jumps = 0;
    double worst_load[WAYS] = {0}, worst_end[WAYS] = {0};
    for (uint64_t seed = 1; seed <= BEAMS; seed++) {
        haft_mesh_spec mesh = {HAFT_MESH_UNIFORM, 15e-6, 3e-6, 60e-6, 0};
        random_beam b = random_beam_create(seed, mesh);
        haft_path *path = random_beam_cycle(&b, (haft_path_options){0});
        assert_int_equal(path->outcome, HAFT_OUTCOME_STUCK);
        check_less(path->ledger_error, 1e-10);
        jumps += path->jumps;
        for (int k = 0; k < WAYS; k++) {
            haft_path *other = random_beam_cycle(&b, ways[k].options);
            if (other->jumps != path->jumps) {
                fail_msg("beam %d, %s: %zu jumps instead of %zu", (int)seed, ways[k].what,
                         other->jumps, path->jumps);
            }
            for (size_t j = 0; j < path->jumps; j++) {
                assert_int_equal(other->jump[j].site, path->jump[j].site);
                double miss = fabs(other->jump[j].load / path->jump[j].load - 1);
                worst_load[k] = fmax(worst_load[k], miss);
            }
            for (size_t i = 0; i < haft_model_get(b.model)->dofs; i++) {
                double miss = fabs(other->final_state[i] - path->final_state[i]);
                worst_end[k] = fmax(worst_end[k], miss);
            }
            haft_path_destroy(&other);
        }
        haft_path_destroy(&path);
        random_beam_destroy(&b);
    }
    print_message("  %d beams, %zu jumps\n", BEAMS, jumps);
    for (int k = 0; k < WAYS; k++) {
        print_message("  %-22s loads within %.1e, final states within %.1e h\n", ways[k].what,
                      worst_load[k], worst_end[k]);
        check_less(worst_load[k], 1e-9);
        check_less(worst_end[k], 1e-8);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(all_ways_agree)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
