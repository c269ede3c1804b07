/* SPDX-License-Identifier: GPL-3.0-or-later */
/* laws.h5 with edits, of explicit laws or of a fitted model. What is read must be usable. */
#include "hdf_edits.h"

#include "haft/study.h"

#include <math.h>

enum { LAWS = 6, DISTANCES = 21, VECTORS = 40 };

static void fail(const haft_error *error) {
    fuzz_found("the sound file", "%s", error->message);
}

static void write_explicit(const char *path) {
    haft_error error = {0};
    haft_laws *laws = NULL;
    if (haft_laws_create(&laws, LAWS, DISTANCES, &error) != HAFT_OK) {
        fail(&error);
    }
    laws->sites = 3;
    laws->f_limit = 5e6;
    for (size_t i = 0; i < DISTANCES; i++) {
        laws->distance[i] = 1e-9 * (double)(i + 3);
    }
    for (size_t i = 0; i < LAWS * DISTANCES; i++) {
        laws->force[i] = sin(0.1 * (double)i) * 1e6 / 3;
    }
    for (size_t i = 0; i < LAWS; i++) {
        double x = 1 + (double)i / 7;
        laws->vector[i] = (haft_law_vector){1e-3 * x, 2e6 * x, 9e-9 * x, 6e-9 * x};
    }
    if (haft_laws_write(laws, fuzz_case(2), path, &error) != HAFT_OK) {
        fail(&error);
    }
    haft_laws_destroy(&laws);
}

static void write_model(const char *path) {
    haft_error error = {0};
    haft_law_vector vector[VECTORS];
    haft_laws *laws = NULL;
    haft_case *c = NULL;
    if (haft_case_read(&c, HAFT_SOURCE_DIR "/cases/delrio-rh85-gpce/case.yaml", &error) !=
        HAFT_OK) {
        fail(&error);
    }
    c->law.chaos.spec.order = 2;
    for (uint64_t k = 0; k < VECTORS; k++) {
        double z[4];
        haft_random_normals((haft_random_key){7, HAFT_RANDOM_TEST}, 0, k, 0, 4, z);
        double d_max = 11e-9 + 0.4e-9 * z[2];
        vector[k] = (haft_law_vector){3.6e-3 * exp(0.3 * z[0]), 1e6 * exp(0.25 * z[0] + 0.1 * z[1]),
                                      d_max, d_max - 2.8e-9 * exp(0.1 * z[3])};
    }
    if (haft_study_fit_laws(&laws, c, VECTORS, vector, &error) != HAFT_OK ||
        haft_laws_write(laws, c, path, &error) != HAFT_OK) {
        fail(&error);
    }
    haft_laws_destroy(&laws);
    haft_case_destroy(&c);
}

/* What the users of laws do with them. */
static void use(haft_laws *laws) {
    haft_error error = {0};
    FUZZ_DEMAND(laws->sites > 0 && laws->m % laws->sites == 0, "%zu laws of %zu sites", laws->m,
                laws->sites);
    haft_status status = haft_laws_tabulate(laws, &error);
    FUZZ_DEMAND(status == HAFT_OK, "%s", error.message);
    for (size_t k = 0; k < laws->m; k++) {
        haft_law law;
        const double *curve = haft_laws_curve(laws, k);
        FUZZ_DEMAND(curve == NULL || isfinite(curve[laws->n - 1]), "curve %zu", k);
        if (laws->fault[k] == HAFT_LAW_SOUND &&
            haft_law_morse(&law, &laws->vector[k], laws->f_limit) == HAFT_LAW_SOUND) {
            haft_law_value value = haft_law_evaluate(&law, laws->vector[k].d_max);
            FUZZ_DEMAND(!isnan(value.force), "law %zu is not a number", k);
        }
    }
    if (laws->chaos != NULL) {
        haft_chaos_work *work = NULL;
        status = haft_chaos_work_create(&work, laws->chaos, &error);
        fuzz_check_status(status, &error);
        haft_chaos_work_destroy(&work);
    }
}

/* Before the first input, whose time is bounded. */
static fuzz_hdf file[2];

int LLVMFuzzerInitialize(int *count, char ***words) {
    (void)count;
    (void)words;
    write_explicit(fuzz_path("data.h5"));
    fuzz_hdf_open(&file[0], fuzz_path("data.h5"));
    write_model(fuzz_path("data.h5"));
    fuzz_hdf_open(&file[1], fuzz_path("data.h5"));
    return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    haft_error error = {0};
    if (size == 0 || size > 2048) {
        return -1;
    }
    fuzz_bytes in = {data + 1, size - 1};
    const char *path = fuzz_hdf_put(&file[data[0] & 1], "data.h5", &in);
    char digest[HAFT_DIGEST_CAPACITY], origin[HAFT_DIGEST_CAPACITY];
    haft_laws *laws = NULL;
    fuzz_check_status(haft_laws_peek(digest, origin, path, &error), &error);
    haft_status status = haft_laws_read(&laws, digest, path, &error);
    fuzz_check_status(status, &error);
    FUZZ_DEMAND((status == HAFT_OK) == (laws != NULL), "laws after a failure");
    FUZZ_DEMAND(size > 1 || status == HAFT_OK, "the sound file: %s", error.message);
    if (laws != NULL) {
        use(laws);
    }
    haft_laws_destroy(&laws);
    return 0;
}
