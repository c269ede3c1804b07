/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fifty random beams: every landing against CVODE, and what other drag than the consistent mass
 * matrix would change. */
#include "landing_oracle.h"

static void fifty_beams_land_where_cvode_does(void **state) {
    (void)state;
    size_t jumps = 0;
    double worst = 0;
    for (uint64_t seed = 1; seed <= 50; seed++) {
        jumps += check_landings(seed, &worst);
    }
    print_message("  %zu jumps, gaps within %.1e m of CVODE's\n", jumps, worst);
}

/* Drag by M's diagonal alone, and by K (dashpots in the beam itself) with a little of M. */
static void put_drag(haft_model *model, int kind) {
    const haft_model_data *m = haft_model_get(model);
    double mass = 0, stiffness = 0;
    for (size_t j = 0; j < m->dofs; j++) {
        for (int k = m->column[j]; k < m->column[j + 1]; k++) {
            if (m->row[k] == (int)j) {
                mass = fmax(mass, m->mass[k]);
                stiffness = fmax(stiffness, m->stiffness[k]);
            }
        }
    }
    for (size_t j = 0; j < m->dofs; j++) {
        for (int k = m->column[j]; k < m->column[j + 1]; k++) {
            if (kind == 1) {
                m->mass[k] = m->row[k] == (int)j ? m->mass[k] : 0;
            } else if (kind == 2) {
                m->mass[k] = 1e-3 * m->mass[k] + mass / stiffness * m->stiffness[k];
            }
        }
    }
}

static void the_drag_matrix_is_told_where_it_matters(void **state) {
    (void)state;
    static const char *const name[] = {"", "diagonal of M", "K, dashpots in the beam"};
    for (int kind = 1; kind <= 2; kind++) {
        size_t beams = 0, ends = 0, jumps = 0;
        double farthest = 0;
        for (uint64_t seed = 1; seed <= 50; seed++) {
            haft_mesh_spec mesh = {HAFT_MESH_UNIFORM, 15e-6, 3e-6, 60e-6, 0};
            random_beam b = random_beam_create(seed, mesh);
            haft_path *path = random_beam_cycle(&b, (haft_path_options){0});
            put_drag(b.model, kind);
            haft_path *other = random_beam_cycle(&b, (haft_path_options){0});
            assert_int_equal(other->outcome, HAFT_OUTCOME_STUCK);
            check_less(other->ledger_error, 1e-10); /* the ledger closes for any drag */
            bool same = other->jumps == path->jumps;
            for (size_t j = 0; same && j < path->jumps; j++) {
                same = fabs(other->jump[j].dissipated / path->jump[j].dissipated - 1) < 1e-6;
            }
            double moved = fabs(other->point[other->points - 1].crack_length -
                                path->point[path->points - 1].crack_length);
            farthest = fmax(farthest, moved);
            beams += !same;
            ends += moved > 1e-9;
            jumps += path->jumps;
            haft_path_destroy(&other);
            haft_path_destroy(&path);
            random_beam_destroy(&b);
        }
        print_message("  drag by %s: %zu of 50 beams jump otherwise (%zu jumps in all), %zu end "
                      "otherwise, by %.2g um at most\n",
                      name[kind], beams, jumps, ends, farthest * 1e6);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fifty_beams_land_where_cvode_does),
        cmocka_unit_test(the_drag_matrix_is_told_where_it_matters),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
