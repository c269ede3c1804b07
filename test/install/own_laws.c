/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A beam over force laws of one's own: 200 patches whose pull scatters by 30 % about 1 MPa. It is
 * pressed down 60 um from its clamp until its crack is 120 um long, let go, and its jumps and
 * crack length are printed.
 *
 *     cc own_laws.c $(pkg-config --cflags --libs haft) -o own_laws && ./own_laws
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <haft/haft.h>

enum { PATCHES = 200 };

/* The law of patch r: energy e [J/m2], greatest pull f_max [Pa] at d_max [m]; it pushes with 5 MPa
 * at d_limit. The same for the same r, whatever was drawn before. */
static haft_law law_of(size_t r) {
    haft_random_key key = {2026, HAFT_RANDOM_TEST};
    haft_law law;
    double z = 0;
    haft_random_normals(key, 0, r, 0, 1, &z);
    double pull = 1e6 * (z < -2 ? 0.4 : 1 + 0.3 * z);
    haft_law_vector v = {3.6e-9 * pull, pull, 11e-9, 8.2e-9};
    if (haft_law_morse(&law, &v, 5e6) != HAFT_LAW_SOUND) {
        fprintf(stderr, "patch %zu has no Morse law\n", r);
        exit(1);
    }
    return law;
}

static void must(haft_status status, const haft_error *error) {
    if (status != HAFT_OK) {
        fprintf(stderr, "%s\n", error->message);
        exit(1);
    }
}

int main(void) {
    haft_error error = {HAFT_OK, ""};
    haft_beam_spec beam = {600e-6, 30e-6, 2.62e-6, 1.9e-6, 163e9};
    haft_mesh_spec mesh = {HAFT_MESH_ACTIVE, 0, beam.length / PATCHES, 60e-6, 60e-6};
    haft_programme programme = {120e-6, 0.01, INFINITY};
    haft_model *model = NULL;
    haft_path *path = NULL;
    haft_law law[PATCHES];
    for (size_t r = 0; r < PATCHES; r++) {
        law[r] = law_of(r);
    }
    must(haft_model_create_beam(&model, &beam, &mesh, &error), &error);
    must(haft_solve_path(&path, model, law, &programme, NULL, &error), &error);
    for (size_t k = 0; k < path->jumps; k++) {
        const haft_jump *jump = &path->jump[k];
        printf("%s at %7.2f uN: crack %6.1f -> %6.1f um, %.3g pJ lost\n",
               jump->kind == HAFT_JUMP_PULL_IN ? "pull-in " : "pull-out", 1e6 * jump->load,
               1e6 * jump->crack_before, 1e6 * jump->crack_after, 1e12 * jump->dissipated);
    }
    double crack = path->point[path->points - 1].crack_length;
    printf("%s; crack %.1f um, Gamma %.2f mJ/m2, ledger closed to %.0e\n",
           haft_outcome_name(path->outcome), 1e6 * crack,
           1e3 * haft_beam_effective_energy(&beam, crack), path->ledger_error);
    int stuck = path->outcome == HAFT_OUTCOME_STUCK && path->jumps > 0;
    haft_path_destroy(&path);
    haft_model_destroy(&model);
    return stuck ? 0 : 1;
}
