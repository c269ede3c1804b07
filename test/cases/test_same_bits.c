/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The same case gives the same bits: for any number of threads, from the resolved case, and for a
 * realization whatever others are run with it. */
#include "same_bits.h"

static const edit all_evidence[] = {
    {"realizations: 2", "realizations: 3"}, {"evidence: [0]", "evidence: all"}, {NULL, NULL}};

static void any_number_of_threads_gives_the_same_files(void **state) {
    (void)state;
    case_folder one = case_create(all_evidence), more = case_create(all_evidence);
    must_run(HAFT, ARGS("run", "--quiet", "--threads", "1", one.path));
    static const char *const counts[] = {"2", "5"};
    for (int i = 0; i < 2; i++) {
        char path[400];
        unlink(path_in(&more, "out/laws.h5", path));
        must_run(HAFT, ARGS("run", "--quiet", "--force", "--threads", counts[i], more.path));
        check_same_bytes(&one, &more, "out/laws.h5");
        check_same_bytes(&one, &more, "out/results.h5");
        check_same_bytes(&one, &more, "out/summary.csv");
        check_same_bytes(&one, &more, "out/resolved.yaml");
    }
    case_remove(&one);
    case_remove(&more);
}

static void the_resolved_case_reruns_to_the_same_files(void **state) {
    (void)state;
    /* numbers whose decimals end nowhere in binary, units of all sorts, defaults left out */
    static const edit odd[] = {{"gap: 400 nm", "gap: 0.00040001 mm"},
                               {"surface_energy: 72 mN/m", "surface_energy: 71.97 erg/cm^2"},
                               {"crack_threshold: 1 %", "crack_threshold: 0.013"},
                               {"reference:", "path: {gap_step: 0.3}\nreference:"},
                               {NULL, NULL}};
    case_folder first = case_create(odd), again = case_create(NULL);
    must_run(HAFT, ARGS("run", "--quiet", first.path));
    char path[400];
    size_t size = 0;
    char *resolved = read_whole_file(path_in(&first, "out/resolved.yaml", path), &size);
    write_file(path_in(&again, "case.yaml", path), resolved, size);
    free(resolved);
    must_run(HAFT, ARGS("run", "--quiet", again.path));
    check_same_bytes(&first, &again, "out/laws.h5");
    check_same_bytes(&first, &again, "out/results.h5");
    check_same_bytes(&first, &again, "out/resolved.yaml");
    case_remove(&first);
    case_remove(&again);
}

/* Reads one dataset whole; 0 elements are allowed. */
static char *read_dataset(hid_t file, const char *name, size_t *size) {
    hid_t data = H5Dopen2(file, name, H5P_DEFAULT);
    assert_true(data >= 0);
    hid_t type = H5Dget_type(data), space = H5Dget_space(data);
    *size = (size_t)H5Sget_simple_extent_npoints(space) * H5Tget_size(type);
    char *bytes = calloc(1, *size + 1);
    assert_non_null(bytes);
    assert_true(H5Dread(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes) >= 0);
    H5Sclose(space);
    H5Tclose(type);
    H5Dclose(data);
    return bytes;
}

typedef struct comparison {
    hid_t other;
    int datasets;
} comparison;

static herr_t compare_dataset(hid_t group, const char *name, const H5O_info_t *info, void *user) {
    comparison *c = user;
    if (info->type != H5O_TYPE_DATASET) {
        return 0;
    }
    size_t size_a = 0, size_b = 0;
    char *a = read_dataset(group, name, &size_a), *b = read_dataset(c->other, name, &size_b);
    if (size_a != size_b || memcmp(a, b, size_a) != 0) {
        fail_msg("dataset %s differs", name);
    }
    free(a);
    free(b);
    c->datasets++;
    return 0;
}

static void a_realization_does_not_depend_on_the_others(void **state) {
    (void)state;
    case_folder three = case_create(all_evidence),
                two = case_create((edit[]){all_evidence[1], {NULL, NULL}});
    must_run(HAFT, ARGS("run", "--quiet", three.path));
    must_run(HAFT, ARGS("run", "--quiet", two.path));
    char path[400];
    hid_t a = H5Fopen(path_in(&three, "out/results.h5", path), H5F_ACC_RDONLY, H5P_DEFAULT);
    hid_t b = H5Fopen(path_in(&two, "out/results.h5", path), H5F_ACC_RDONLY, H5P_DEFAULT);
    assert_true(a >= 0 && b >= 0);
    for (int k = 0; k < 2; k++) {
        char name[40];
        snprintf(name, sizeof name, "/realizations/%d", k);
        hid_t group_a = H5Gopen2(a, name, H5P_DEFAULT), group_b = H5Gopen2(b, name, H5P_DEFAULT);
        comparison c = {.other = group_b};
        assert_true(H5Ovisit2(group_a, H5_INDEX_NAME, H5_ITER_INC, compare_dataset, &c,
                              H5O_INFO_BASIC) >= 0);
        assert_true(c.datasets >= 11 + 12 + 10); /* path, jumps, evidence */
        H5Gclose(group_a);
        H5Gclose(group_b);
    }
    H5Fclose(a);
    H5Fclose(b);
    case_remove(&three);
    case_remove(&two);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_number_of_threads_gives_the_same_files),
        cmocka_unit_test(the_resolved_case_reruns_to_the_same_files),
        cmocka_unit_test(a_realization_does_not_depend_on_the_others),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
