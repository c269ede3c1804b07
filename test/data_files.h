/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A small laws.h5 and a small results.h5, written by the library; every failure here ends the test.
 */
#ifndef HAFT_TEST_DATA_FILES_H
#define HAFT_TEST_DATA_FILES_H

#include "scratch.h"

#include <hdf5.h>

#include "haft/io.h"

/* Bytes in front of the HDF5 part; sizes of what is written. */
enum {
    DATA_HEADER = 512,
    DATA_LAWS = 4,
    DATA_DISTANCES = 30,
    DATA_POINTS = 3,
    DATA_NODES = 3,
};

static inline haft_case *data_model(void) {
    haft_error error = {0};
    haft_case *c = NULL;
    check_ok(haft_case_read(&c, HAFT_SOURCE_DIR "/cases/delrio-rh85/case.yaml", &error), error);
    c->realizations = 2;
    return c;
}

static inline void data_write_laws(const char *path) {
    haft_error error = {0};
    haft_case *c = data_model();
    haft_laws *laws = NULL;
    check_ok(haft_laws_create(&laws, DATA_LAWS, DATA_DISTANCES, &error), error);
    laws->sites = 2;
    laws->f_limit = 5e6;
    for (size_t i = 0; i < DATA_DISTANCES; i++) {
        laws->distance[i] = 1e-9 * (double)(i + 3);
    }
    check_ok(haft_laws_write(laws, c, path, &error), error);
    haft_laws_destroy(&laws);
    haft_case_destroy(&c);
}

/* One realization, with evidence. */
static inline void data_write_results(const char *path, double load) {
    haft_error error = {0};
    haft_case *c = data_model();
    haft_results *results = NULL;
    haft_path_point point[DATA_POINTS] = {{.load = load, .jump = -1}, {.jump = -1}, {.jump = -1}};
    double state[DATA_POINTS * 4] = {1, 2, 3, 4}, scale[4] = {1, 1, 1, 1},
                               x[DATA_NODES] = {0, 1e-4, 2e-4};
    haft_path p = {.points = DATA_POINTS,
                   .point = point,
                   .turn = 1,
                   .state = state,
                   .outcome = HAFT_OUTCOME_FREE};
    haft_site site = {.x = 1e-4, .area = 1e-10};
    haft_law law = {.kind = HAFT_LAW_MORSE};
    haft_law_vector vector = {1e-3, 2e6, 9e-9, 6e-9};
    haft_summary summary = {.outcome = HAFT_OUTCOME_FREE, .steps = DATA_POINTS};
    haft_model_data model = {.dofs = 4,
                             .scale = scale,
                             .gap = 2e-6,
                             .sites = 1,
                             .site = &site,
                             .load = {.x = 6e-5},
                             .nodes = DATA_NODES,
                             .node_x = x};
    check_ok(
        haft_results_create(&results, path, c, "0123456789abcdef0123456789abcdef", true, &error),
        error);
    check_ok(haft_results_add(results, 0, &p, &model, &law, &vector, &summary, &error), error);
    check_ok(haft_results_finish(&results, &error), error);
    haft_case_destroy(&c);
}

/* Makes it a file as if written by another program: without the header and the list of digests.
 * Returns its bytes, to be freed with free(). */
static inline char *data_strip(const char *path, size_t *size) {
    char *bytes = read_whole_file(path, size);
    write_file(path, bytes + DATA_HEADER, *size - DATA_HEADER);
    free(bytes);
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
    assert_true(file >= 0 && H5Ldelete(file, "/contents", H5P_DEFAULT) >= 0);
    assert_true(H5Adelete(file, "contents_digest") >= 0 && H5Fclose(file) >= 0);
    return read_whole_file(path, size);
}

#endif
