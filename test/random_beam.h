/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Beams over random laws that scatter as those of the DelRio surfaces at RH 85 % do: what the tests
 * of the solver share. */
#ifndef HAFT_TEST_RANDOM_BEAM_H
#define HAFT_TEST_RANDOM_BEAM_H

#include "check.h"
#include "haft/solve.h"

static const haft_beam_spec random_beam_spec = {600e-6, 30e-6, 2.62e-6, 1.9e-6, 163e9};

typedef struct random_beam {
    haft_model *model;
    haft_law *law;
} random_beam;

static inline void random_beam_laws(const haft_model *model, uint64_t seed, haft_law *law) {
    for (size_t r = 0; r < haft_model_get(model)->sites; r++) {
        double z[4];
        haft_random_normals((haft_random_key){seed, HAFT_RANDOM_TEST}, 0, r, 0, 4, z);
        double d_max = 11e-9 + 0.4e-9 * z[2];
        haft_law_vector v = {3.6e-3 * exp(0.3 * z[0]), 1e6 * exp(0.25 * z[0] + 0.1 * z[1]), d_max,
                             d_max - 2.8e-9 * exp(0.1 * z[3])};
        assert_int_equal(haft_law_morse(&law[r], &v, 5e6), HAFT_LAW_SOUND);
    }
}

static inline random_beam random_beam_create(uint64_t seed, haft_mesh_spec mesh) {
    random_beam b = {NULL, NULL};
    haft_error error = {0};
    check_ok(haft_model_create_beam(&b.model, &random_beam_spec, &mesh, &error), error);
    b.law = haft_memory_alloc(haft_model_get(b.model)->sites, sizeof *b.law, &error);
    random_beam_laws(b.model, seed, b.law);
    return b;
}

static inline void random_beam_destroy(random_beam *b) {
    haft_memory_free(b->law);
    haft_model_destroy(&b->model);
}

/* Loads to a crack of 150 um, unloads. */
static inline haft_path *random_beam_cycle(const random_beam *b, haft_path_options options) {
    haft_error error = {0};
    haft_path *path = NULL;
    haft_programme programme = {150e-6, 0.01, INFINITY};
    check_ok(haft_solve_path(&path, b->model, b->law, &programme, &options, &error), error);
    return path;
}

#endif
