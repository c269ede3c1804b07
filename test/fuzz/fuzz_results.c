/* SPDX-License-Identifier: GPL-3.0-or-later */
/* results.h5 with edits: the summary, the paths and the shapes. */
#include "hdf_edits.h"

#include <math.h>

enum { BEAMS = 3, POINTS = 5, JUMPS = 2, NODES = 4, DOFS = 6, SITES = 2 };

static void write_results(const char *path) {
    haft_error error = {0};
    haft_results *results = NULL;
    haft_case *c = fuzz_case(BEAMS);
    haft_path_point point[POINTS] = {{0}};
    haft_jump jump[JUMPS] = {{0}};
    double state[POINTS * DOFS], scale[DOFS], node_x[NODES] = {0, 2e-4, 4e-4, 6e-4};
    haft_site site[SITES] = {{.x = 1e-4, .area = 9e-11}, {.x = 2e-4, .area = 9e-11}};
    haft_law laws[SITES] = {{.kind = HAFT_LAW_MORSE}, {.kind = HAFT_LAW_MORSE}};
    haft_law_vector vectors[SITES] = {{1e-3, 2e6, 9e-9, 6e-9}, {1e-3, 2e6, 9e-9, 6e-9}};
    haft_summary summary = {.crack_length = 2e-4, .loaded_crack_length = 1e-4, .gamma = 3e-5};
    for (int i = 0; i < POINTS; i++) {
        point[i].jump = i == 2 ? 0 : i == 4 ? 1 : -1;
        point[i].load = 1e-6 * i;
    }
    for (int i = 0; i < POINTS * DOFS; i++) {
        state[i] = sin(i);
    }
    for (int i = 0; i < DOFS; i++) {
        scale[i] = 1e-6;
    }
    haft_path walked = {
        .points = POINTS, .jumps = JUMPS, .turn = 3, .point = point, .jump = jump, .state = state};
    haft_model_data model = {.dofs = DOFS,
                             .scale = scale,
                             .gap = 1.9e-6,
                             .sites = SITES,
                             .site = site,
                             .load = {.x = 6e-5},
                             .nodes = NODES,
                             .node_x = node_x};
    haft_status status = haft_results_create(&results, path, c, NULL, true, &error);
    for (size_t k = 0; k < BEAMS && status == HAFT_OK; k++) {
        status = haft_results_add(results, k, &walked, &model, laws, vectors, &summary, &error);
    }
    if (status == HAFT_OK) {
        status = haft_results_finish(&results, &error);
    }
    FUZZ_DEMAND(status == HAFT_OK, "%s", error.message);
}

static void read_beam(const char *path, size_t realization) {
    haft_error error = {0};
    haft_path *walked = NULL;
    haft_results_shapes *shapes = NULL;
    haft_status status = haft_results_read_path(&walked, path, realization, &error);
    fuzz_check_status(status, &error);
    if (status == HAFT_OK) {
        FUZZ_DEMAND(walked->turn < walked->points || walked->turn == 0, "turns at %zu of %zu",
                    walked->turn, walked->points);
        for (size_t i = 0; i < walked->points; i++) {
            int jump = walked->point[i].jump;
            FUZZ_DEMAND(jump < 0 || (size_t)jump < walked->jumps, "point %zu names jump %d", i,
                        jump);
        }
    }
    haft_path_destroy(&walked);
    status = haft_results_read_shapes(&shapes, path, realization, &error);
    fuzz_check_status(status, &error);
    if (status == HAFT_OK && shapes->points > 0) {
        FUZZ_DEMAND(shapes->nodes > 0, "shapes without nodes");
        volatile double last = shapes->deflection[shapes->points * shapes->nodes - 1];
        (void)last;
    }
    haft_results_shapes_destroy(&shapes);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static fuzz_hdf file;
    haft_error error = {0};
    if (size > 2048) {
        return -1;
    }
    if (file.bytes == NULL) {
        write_results(fuzz_path("data.h5"));
        fuzz_hdf_open(&file, fuzz_path("data.h5"));
    }
    fuzz_bytes in = {data, size};
    const char *path = fuzz_hdf_put(&file, "data.h5", &in);
    haft_results_view *view = NULL;
    haft_status status = haft_results_read(&view, path, &error);
    fuzz_check_status(status, &error);
    FUZZ_DEMAND(size > 0 || status == HAFT_OK, "the sound file: %s", error.message);
    if (status == HAFT_OK) {
        FUZZ_DEMAND(view->resolved_case != NULL, "no case");
        for (size_t k = 0; k < view->realizations; k++) {
            int outcome = view->summary[k].outcome;
            FUZZ_DEMAND(outcome >= -1 && outcome < HAFT_OUTCOMES, "outcome %d", outcome);
        }
    }
    haft_results_view_destroy(&view);
    read_beam(path, 0);
    read_beam(path, 2);
    return 0;
}
