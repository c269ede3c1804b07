/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Data files that are missing, damaged or foreign, folders that cannot be written and disks that
 * are full: a clear message each, nothing left behind, never a crash. */
#include "data_files.h"

#include <fcntl.h>
#include <hdf5.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "haft/io.h"

static const char MODEL[] = HAFT_SOURCE_DIR "/cases/delrio-rh85/case.yaml";

static haft_case *read_model(void) {
    haft_error error = {0};
    haft_case *c = NULL;
    check_ok(haft_case_read(&c, MODEL, &error), error);
    c->realizations = 2;
    return c;
}

static haft_status write_laws(const char *path, haft_error *error) {
    enum { M = 4, N = 30 };
    haft_case *c = read_model();
    haft_laws *laws = NULL;
    check_ok(haft_laws_create(&laws, M, N, error), *error);
    laws->sites = 2;
    laws->f_limit = 5e6;
    for (size_t i = 0; i < N; i++) {
        laws->distance[i] = 1e-9 * (double)(i + 3);
    }
    haft_status status = haft_laws_write(laws, c, path, error);
    haft_laws_destroy(&laws);
    haft_case_destroy(&c);
    return status;
}

static void check_laws_refused(const char *path, haft_status status, const char *says) {
    haft_error error = {0};
    haft_laws *laws = NULL;
    char digest[HAFT_DIGEST_CAPACITY];
    haft_status found = haft_laws_read(&laws, digest, path, &error);
    if (found != status || laws != NULL) {
        fail_msg("status %d, not %d, where \"%s\" was to be said: %s", found, status, says,
                 error.message);
    }
    if (strstr(error.message, says) == NULL || strstr(error.message, path) == NULL) {
        fail_msg("\"%s\" or the path is not in: %s", says, error.message);
    }
}

static void missing_and_foreign_files_are_refused(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400], results[400];
    scratch_path(&s, "laws.h5", path);
    haft_error error = {0};
    check_laws_refused(path, HAFT_ERROR_IO, "No such file or directory; build it with haft-laws");
    check_laws_refused(s.folder, HAFT_ERROR_IO, "is a directory");
    assert_int_equal(mkfifo(path, 0600), 0);
    check_laws_refused(path, HAFT_ERROR_IO, "give a regular file");
    assert_int_equal(unlink(path), 0);
    write_file(path, "", 0);
    check_laws_refused(path, HAFT_ERROR_INPUT, "is empty; put back a copy");
    write_file(path, "some text\n", 10);
    check_laws_refused(path, HAFT_ERROR_INPUT, "is no HDF5 file");
    write_file(path, "\211HDF\r\n\032\n and no more", 20);
    check_laws_refused(path, HAFT_ERROR_INPUT, "cannot be read as HDF5");
    hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(file >= 0 && H5Fclose(file) >= 0);
    check_laws_refused(path, HAFT_ERROR_INPUT, "not of Haft");
    /* results where laws are wanted, and the other way about */
    haft_case *c = read_model();
    haft_results *unfinished = NULL;
    scratch_path(&s, "results.h5", results);
    check_ok(haft_results_create(&unfinished, results, c, NULL, false, &error), error);
    check_ok(haft_results_finish(&unfinished, &error), error);
    check_laws_refused(results, HAFT_ERROR_INPUT, "holds \"haft-results\"");
    check_ok(write_laws(path, &error), error);
    haft_results_view *view = NULL;
    assert_int_equal(haft_results_read(&view, path, &error), HAFT_ERROR_INPUT);
    assert_non_null(strstr(error.message, "holds \"haft-laws\""));
    assert_null(view);
    haft_case_destroy(&c);
    scratch_remove(&s);
}

/* Cut anywhere, within the header too. */
static void no_cut_file_is_taken(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400];
    scratch_path(&s, "laws.h5", path);
    haft_error error = {0};
    check_ok(write_laws(path, &error), error);
    size_t size = 0;
    char *bytes = read_whole_file(path, &size);
    haft_random_key key = {7, HAFT_RANDOM_TEST};
    for (uint64_t i = 0; i < 200; i++) {
        uint64_t w[4];
        haft_random_words(key, i, 0, 0, w);
        write_file(path, bytes, i < 20 ? i * 40 : w[0] % size);
        check_laws_refused(path, HAFT_ERROR_INPUT, "move it away and build it anew");
    }
    write_file(path, bytes, size - 1);
    check_laws_refused(path, HAFT_ERROR_INPUT, "is damaged: it should be");
    write_file(path, bytes, size);
    haft_laws *laws = NULL;
    check_ok(haft_laws_read(&laws, NULL, path, &error), error);
    haft_laws_destroy(&laws);
    free(bytes);
    scratch_remove(&s);
}

/* ---- well-formed HDF5 with wrong contents, as another tool may leave it ---- */

static void set_dataset(hid_t file, const char *name, int rank, const hsize_t *dims,
                        const double *value) {
    assert_true(H5Ldelete(file, name, H5P_DEFAULT) >= 0);
    hid_t space = H5Screate_simple(rank, dims, NULL);
    hid_t dataset =
        H5Dcreate2(file, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(dataset >= 0);
    if (value != NULL) {
        assert_true(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, value) >=
                    0);
    }
    H5Dclose(dataset);
    H5Sclose(space);
}

static void set_number(hid_t file, const char *object, const char *name, uint64_t value) {
    assert_true(H5Adelete_by_name(file, object, name, H5P_DEFAULT) >= 0);
    hid_t space = H5Screate(H5S_SCALAR);
    hid_t attribute = H5Acreate_by_name(file, object, name, H5T_STD_U64LE, space, H5P_DEFAULT,
                                        H5P_DEFAULT, H5P_DEFAULT);
    assert_true(attribute >= 0 && H5Awrite(attribute, H5T_NATIVE_UINT64, &value) >= 0);
    H5Aclose(attribute);
    H5Sclose(space);
}

static void spoil(hid_t file, int how) {
    static double value[120];
    for (int i = 0; i < 120; i++) {
        value[i] = i;
    }
    hsize_t dims[3] = {4, 30, 1};
    switch (how) {
    case 0:
        set_number(file, "/", "layout_version", 2);
        break;
    case 1:
        set_dataset(file, "/curves/distance", 1, (hsize_t[]){29}, value);
        break;
    case 2:
        set_dataset(file, "/curves/force", 3, dims, value);
        break;
    case 3:
        value[7] = NAN;
        set_dataset(file, "/curves/force", 2, dims, value);
        break;
    case 4:
        value[7] = 6;
        set_dataset(file, "/curves/distance", 1, dims + 1, value);
        break;
    case 5: /* never written: all fill value, and more than any memory */
        set_dataset(file, "/curves/force", 2, (hsize_t[]){1ULL << 33, 1ULL << 33}, NULL);
        break;
    case 6:
        set_dataset(file, "/curves/force", 2, (hsize_t[]){1ULL << 20, 1ULL << 12}, NULL);
        break;
    case 7:
        assert_true(H5Ldelete(file, "/laws/e", H5P_DEFAULT) >= 0);
        break;
    case 8:
        set_number(file, "/laws", "sites", 3);
        break;
    case 9:
        value[2] = INFINITY;
        set_dataset(file, "/laws/d_max", 1, dims, value);
        break;
    case 10:
        assert_true(H5Adelete_by_name(file, "/laws", "f_limit", H5P_DEFAULT) >= 0);
        break;
    case 11:
        set_dataset(file, "/laws/fault", 1, dims, value);
        break;
    case 12:
        assert_true(H5Ldelete(file, "/curves", H5P_DEFAULT) >= 0);
        break;
    default:
        value[3] = -INFINITY;
        set_dataset(file, "/curves/wet_area", 1, dims, value);
        break;
    }
}

static void wrong_contents_are_refused(void **state) {
    (void)state;
    static const char *const says[] = {
        "layout version 2",
        "/curves/distance of extent 29 where 30",
        "/curves/force in 3 dimensions",
        "force that is not finite, in curve 0",
        "not finite and rising, at 7",
        "a size that the file cannot hold",
        "a size that the file cannot hold",
        "lacks the dataset /laws/e",
        "no whole number of realizations of 3",
        "sound law, number 2",
        "lacks the attribute `f_limit`",
        "/laws/fault of another type",
        "lacks the dataset /curves/force",
        "infinite number in /curves/wet_area",
    };
    scratch s = scratch_create();
    char path[400];
    scratch_path(&s, "laws.h5", path);
    haft_error error = {0};
    check_ok(write_laws(path, &error), error);
    size_t size = 0;
    char *bytes = data_strip(path, &size);
    for (int how = 0; how < (int)(sizeof says / sizeof *says); how++) {
        write_file(path, bytes, size);
        haft_laws *laws = NULL;
        check_ok(haft_laws_read(&laws, NULL, path, &error), error);
        haft_laws_destroy(&laws);
        hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
        assert_true(file >= 0);
        spoil(file, how);
        assert_true(H5Fclose(file) >= 0);
        check_laws_refused(path, HAFT_ERROR_INPUT, says[how]);
    }
    free(bytes);
    scratch_remove(&s);
}

/* ---- writing ---- */

static void check_cannot_write(const char *path) {
    haft_error error = {0};
    assert_int_equal(write_laws(path, &error), HAFT_ERROR_IO);
    assert_non_null(strstr(error.message, path));
    double value = 1;
    haft_csv_column column = {.name = "x", .value = &value};
    assert_int_equal(haft_csv_write(path, 1, 1, &column, &error), HAFT_ERROR_IO);
    haft_case *c = read_model();
    haft_results *results = NULL;
    assert_int_equal(haft_results_create(&results, path, c, NULL, true, &error), HAFT_ERROR_IO);
    assert_null(results);
    haft_case_destroy(&c);
}

static void folders_that_cannot_be_written_are_told(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400], inner[400], plain[400];
    check_cannot_write(scratch_path(&s, "no/such/folder.h5", path));
    check_cannot_write(s.folder);
    write_file(scratch_path(&s, "plain", plain), "x", 1);
    check_cannot_write(scratch_path(&s, "plain/x.h5", path));
    if (geteuid() != 0) {
        assert_int_equal(mkdir(scratch_path(&s, "locked", inner), 0500), 0);
        check_cannot_write(scratch_path(&s, "locked/x.h5", path));
        assert_int_equal(rmdir(inner), 0);
    }
    assert_int_equal(scratch_count(&s), 1);
    scratch_remove(&s);
}

static void existing_results_are_kept(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400];
    scratch_path(&s, "results.h5", path);
    write_file(path, "precious", 8);
    haft_error error = {0};
    haft_case *c = read_model();
    haft_results *results = NULL;
    assert_int_equal(haft_results_create(&results, path, c, NULL, false, &error),
                     HAFT_ERROR_EXISTS);
    assert_non_null(strstr(error.message, "--force"));
    assert_null(results);
    /* abandoned, or overtaken by another writer: what is there stays */
    check_ok(haft_results_create(&results, path, c, NULL, true, &error), error);
    haft_results_abandon(&results);
    haft_results_abandon(&results);
    assert_int_equal(unlink(path), 0);
    check_ok(haft_results_create(&results, path, c, NULL, false, &error), error);
    write_file(path, "precious", 8);
    assert_int_equal(haft_results_finish(&results, &error), HAFT_ERROR_EXISTS);
    assert_null(results);
    char *text = read_whole_file(path, NULL);
    assert_string_equal(text, "precious");
    free(text);
    assert_int_equal(scratch_count(&s), 1);
    haft_case_destroy(&c);
    scratch_remove(&s);
}

/* A limit on the size of files stands for a full disk: write() takes a part, then refuses. */
static void full_disk_is_told_and_leaves_nothing(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400], other[400];
    scratch_path(&s, "laws.h5", path);
    scratch_path(&s, "results.h5", other);
    haft_error error = {0};
    check_ok(write_laws(path, &error), error);
    size_t size = 0, again = 0;
    char *before = read_whole_file(path, &size);
    haft_case *c = read_model();
    haft_results *results = NULL;
    struct rlimit limit, kept;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &kept), 0);
    void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
    for (rlim_t bytes = 0; bytes < size; bytes += size / 7) {
        limit = kept;
        limit.rlim_cur = bytes;
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
        haft_status laws = write_laws(path, &error);
        haft_status made = haft_results_create(&results, other, c, NULL, false, &error);
        haft_status finished = made == HAFT_OK ? haft_results_finish(&results, &error) : made;
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &kept), 0);
        assert_int_equal(laws, HAFT_ERROR_IO);
        assert_int_equal(made, HAFT_OK);
        if (bytes < size / 3) { /* an empty results file is smaller than the laws */
            assert_int_equal(finished, HAFT_ERROR_IO);
            assert_non_null(strstr(error.message, "cannot be written"));
            assert_int_equal(scratch_count(&s), 1);
        }
        unlink(other);
    }
    signal(SIGXFSZ, handler);
    char *after = read_whole_file(path, &again);
    assert_int_equal(size, again);
    assert_memory_equal(before, after, size);
    assert_int_equal(scratch_count(&s), 1);
    free(before);
    free(after);
    haft_case_destroy(&c);
    scratch_remove(&s);
}

int main(void) {
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(missing_and_foreign_files_are_refused),
        cmocka_unit_test(no_cut_file_is_taken),
        cmocka_unit_test(wrong_contents_are_refused),
        cmocka_unit_test(folders_that_cannot_be_written_are_told),
        cmocka_unit_test(existing_results_are_kept),
        cmocka_unit_test(full_disk_is_told_and_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
