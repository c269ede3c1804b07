/* SPDX-License-Identifier: GPL-3.0-or-later */
/* laws.h5 and results.h5 that are damaged or hostile: what no checksum vouches for is read in a
 * child process and compared with the digests in the file, and none leads out of its file. */
#include "data_files.h"
#include "hostile_hdf.h"

#include <signal.h>

/* ---- every reader of them ---- */

enum { READERS = 6 };
static const char *const reader_names[READERS] = {"laws", "peek", "view", "path", "shapes", "open"};

static void note(char print[HAFT_DIGEST_CAPACITY], const void *data, size_t size) {
    char both[2 * HAFT_DIGEST_CAPACITY] = "", own[HAFT_DIGEST_CAPACITY];
    haft_digest_memory(data, size, own);
    snprintf(both, sizeof both, "%s%s", print, own);
    haft_digest_memory(both, strlen(both), print);
}

static haft_status read_laws(const char *path, char print[HAFT_DIGEST_CAPACITY],
                             haft_error *error) {
    char digest[HAFT_DIGEST_CAPACITY];
    haft_laws *laws = NULL;
    haft_status status = haft_laws_read(&laws, digest, path, error);
    assert_true((status == HAFT_OK) == (laws != NULL));
    if (laws != NULL) {
        note(print, laws->distance, laws->n * sizeof *laws->distance);
        note(print, laws->force, laws->n * laws->curves * sizeof *laws->force);
        note(print, laws->vector, laws->m * sizeof *laws->vector);
        note(print, laws->wet_area, laws->m * sizeof *laws->wet_area);
        note(print, &laws->f_limit, sizeof laws->f_limit);
        note(print, digest, sizeof digest);
    }
    haft_laws_destroy(&laws);
    return status;
}

static haft_status read_view(const char *path, char print[HAFT_DIGEST_CAPACITY],
                             haft_error *error) {
    haft_results_view *view = NULL;
    haft_status status = haft_results_read(&view, path, error);
    assert_true((status == HAFT_OK) == (view != NULL));
    for (size_t k = 0; view != NULL && k < view->realizations; k++) {
        view->summary[k].seconds = 0; /* the only values that have no digest */
    }
    if (view != NULL) {
        note(print, view->summary, view->realizations * sizeof *view->summary);
        note(print, view->resolved_case, strlen(view->resolved_case));
    }
    haft_results_view_destroy(&view);
    return status;
}

/* Reads by one of them, and checks what must hold of all that is accepted. `print` is a digest of
 * what was read. */
static haft_status read_by(int reader, const char *path, char print[HAFT_DIGEST_CAPACITY],
                           haft_error *error) {
    char digest[HAFT_DIGEST_CAPACITY], origin[HAFT_DIGEST_CAPACITY];
    haft_path *p = NULL;
    haft_results_shapes *shapes = NULL;
    haft_results_file *file = NULL;
    haft_status status = HAFT_OK;
    print[0] = '\0';
    switch (reader) {
    case 0:
        return read_laws(path, print, error);
    case 1:
        status = haft_laws_peek(digest, origin, path, error);
        break;
    case 2:
        return read_view(path, print, error);
    case 3:
        status = haft_results_read_path(&p, path, 0, error);
        assert_true((status == HAFT_OK) == (p != NULL));
        if (p != NULL) {
            note(print, p->point, p->points * sizeof *p->point);
        }
        haft_path_destroy(&p);
        break;
    case 4:
        status = haft_results_read_shapes(&shapes, path, 0, error);
        assert_true((status == HAFT_OK) == (shapes != NULL));
        if (shapes != NULL) {
            note(print, shapes->deflection, shapes->points * shapes->nodes * sizeof(double));
        }
        haft_results_shapes_destroy(&shapes);
        break;
    default:
        status = haft_results_open(&file, path, error);
        assert_true((status == HAFT_OK) == (file != NULL));
        haft_results_close(&file);
        break;
    }
    return status;
}

static bool is_of_laws(int reader) {
    return reader < 2;
}

static void refuse_by(int reader, const char *path, const char *says) {
    haft_error error = {0};
    char print[HAFT_DIGEST_CAPACITY];
    haft_status status = read_by(reader, path, print, &error);
    if (status != HAFT_ERROR_INPUT || strstr(error.message, says) == NULL ||
        strncmp(error.message, path, strlen(path)) != 0) {
        fail_msg("%s: status %d where \"%s\" was to be said: %s", reader_names[reader], status,
                 says, error.message);
    }
}

static void accept_by(int reader, const char *path) {
    haft_error error = {0};
    char print[HAFT_DIGEST_CAPACITY];
    if (read_by(reader, path, print, &error) != HAFT_OK) {
        fail_msg("%s: %s", reader_names[reader], error.message);
    }
}

/* ---- damage ---- */

/* One bit: it is in no data and nothing read is other than before, or the file is refused. */
static void a_flipped_bit_is_harmless_or_told(void **state) {
    (void)state;
    scratch s = scratch_create();
    char laws[400], results[400];
    data_write_laws(scratch_path(&s, "laws.h5", laws));
    data_write_results(scratch_path(&s, "results.h5", results), 1);
    haft_random_key key = {24, HAFT_RANDOM_TEST};
    int accepted = 0, refused = 0;
    for (int reader = 0; reader < READERS; reader++) {
        const char *path = is_of_laws(reader) ? laws : results;
        char before[HAFT_DIGEST_CAPACITY], after[HAFT_DIGEST_CAPACITY];
        haft_error error = {0};
        size_t size = 0;
        char *bytes = read_whole_file(path, &size);
        check_ok(read_by(reader, path, before, &error), error);
        for (uint64_t k = 0; k < 30; k++) {
            uint64_t w[4];
            haft_random_words(key, k, (uint64_t)reader, 0, w);
            size_t at = k < 5 ? w[0] % 90 : DATA_HEADER + w[0] % (size - DATA_HEADER);
            bytes[at] = (char)(bytes[at] ^ (1 << w[1] % 8));
            write_file(path, bytes, size);
            haft_status status = read_by(reader, path, after, &error);
            assert_true(status == HAFT_OK || status == HAFT_ERROR_INPUT);
            if (status == HAFT_OK) {
                assert_string_equal(after, before);
                accepted++;
            } else {
                assert_non_null(strstr(error.message, path));
                assert_null(strstr(error.message, "--force"));
                refused++;
            }
            bytes[at] = (char)(bytes[at] ^ (1 << w[1] % 8));
        }
        write_file(path, bytes, size);
        accept_by(reader, path);
        free(bytes);
    }
    assert_true(accepted > 20 && refused > 20);
    scratch_remove(&s);
}

/* Without checksum and digests a changed number cannot be told; but nothing may crash or hang. */
static void changed_bytes_without_checksum_do_no_harm(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400];
    haft_random_key key = {25, HAFT_RANDOM_TEST};
    for (int reader = 0; reader < READERS; reader++) {
        size_t size = 0;
        scratch_path(&s, "data.h5", path);
        if (is_of_laws(reader)) {
            data_write_laws(path);
        } else {
            data_write_results(path, 1);
        }
        char *bytes = data_strip(path, &size);
        accept_by(reader, path);
        for (uint64_t k = 0; k < 40; k++) {
            uint64_t w[4];
            haft_error error = {0};
            char print[HAFT_DIGEST_CAPACITY];
            haft_random_words(key, k, (uint64_t)reader, 0, w);
            size_t at = k % 2 == 0 ? w[0] % size : w[0] % 4000;
            char before = bytes[at];
            bytes[at] = (char)w[1];
            write_file(path, bytes, size);
            haft_status status = read_by(reader, path, print, &error);
            assert_true(status == HAFT_OK || status == HAFT_ERROR_INPUT);
            bytes[at] = before;
        }
        free(bytes);
    }
    scratch_remove(&s);
}

/* ---- out of the file, and attributes of the wrong kind ---- */

static void set_column(hid_t file, const char *name, const hdf_layout *l, const char *other) {
    hsize_t dims[1] = {DATA_LAWS};
    hid_t space = H5Screate_simple(1, dims, NULL), creation = H5Pcreate(H5P_DATASET_CREATE);
    assert_true(H5Ldelete(file, name, H5P_DEFAULT) >= 0);
    if (l->external != NULL) {
        assert_true(H5Pset_external(creation, other, 0, DATA_LAWS * sizeof(double)) >= 0);
    } else {
        assert_true(H5Pset_virtual(creation, space, other, "z", space) >= 0);
    }
    hid_t set = H5Dcreate2(file, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    assert_true(set >= 0);
    H5Dclose(set);
    H5Pclose(creation);
    H5Sclose(space);
}

static void set_attribute(hid_t file, const char *object, const char *name, hid_t type,
                          hsize_t points, const void *value) {
    assert_true(H5Adelete_by_name(file, object, name, H5P_DEFAULT) >= 0);
    hdf_attach(file, object, name, type, points, value);
}

enum { SPOILS = 8 };
static const char *const spoil_says[SPOILS] = {
    "/laws/e, which is behind an external link",
    "/laws/e, which is behind a soft link",
    ", which is behind an external link",
    "/laws/e, which lies in external storage",
    "/laws/e, which is a virtual dataset",
    "attribute `sites` of /laws that is not one number",
    "attribute `laws_digest` of / that is not one text",
    "attribute `laws_digest` of / that is not one text",
};

static void spoil(hid_t file, int how, const char *other) {
    static const uint64_t counts[2] = {2, 2};
    static const char texts[500][HAFT_DIGEST_CAPACITY];
    hid_t fixed = hdf_text_type(HAFT_DIGEST_CAPACITY);
    switch (how) {
    case 0:
        assert_true(H5Ldelete(file, "/laws/e", H5P_DEFAULT) >= 0);
        assert_true(
            H5Lcreate_external(other, "/laws/e", file, "/laws/e", H5P_DEFAULT, H5P_DEFAULT) >= 0);
        break;
    case 1:
        assert_true(H5Ldelete(file, "/laws/e", H5P_DEFAULT) >= 0);
        assert_true(H5Lcreate_soft("/laws/f_max", file, "/laws/e", H5P_DEFAULT, H5P_DEFAULT) >= 0);
        break;
    case 2:
        assert_true(H5Ldelete(file, "/laws", H5P_DEFAULT) >= 0);
        assert_true(H5Lcreate_external(other, "/laws", file, "/laws", H5P_DEFAULT, H5P_DEFAULT) >=
                    0);
        break;
    case 3:
        set_column(file, "/laws/e", &(hdf_layout){.external = other}, other);
        break;
    case 4:
        set_column(file, "/laws/e", &(hdf_layout){.virtual_of = other}, other);
        break;
    case 5:
        set_attribute(file, "/laws", "sites", H5T_NATIVE_UINT64, 2, counts);
        break;
    case 6:
        set_attribute(file, "/", "laws_digest", fixed, 500, texts);
        break;
    default:
        set_attribute(file, "/", "laws_digest", H5T_NATIVE_UINT64, 0, counts);
        break;
    }
    H5Tclose(fixed);
}

/* With a checksum, which anyone can put in front, and without. */
static void files_that_lead_out_or_overrun_are_refused(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400], other[400];
    scratch_path(&s, "laws.h5", path);
    for (int how = 0; how < SPOILS; how++) {
        size_t size = 0;
        data_write_laws(scratch_path(&s, "other.h5", other));
        free(data_strip(other, &size));
        data_write_laws(path);
        free(data_strip(path, &size));
        accept_by(0, path);
        hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
        assert_true(file >= 0);
        spoil(file, how, other);
        assert_true(H5Fclose(file) >= 0);
        refuse_by(0, path, path);
        hdf_vouch(path);
        refuse_by(0, path, spoil_says[how]);
    }
    /* a summary that lies in another file */
    size_t size = 0;
    data_write_results(path, 1);
    free(data_strip(path, &size));
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
    set_column(file, "/summary/crack_length", &(hdf_layout){.external = other}, other);
    assert_true(H5Fclose(file) >= 0);
    refuse_by(2, path, "external storage");
    hdf_vouch(path);
    refuse_by(2, path, "external storage");
    scratch_remove(&s);
}

/* Text of any length is how other programs write it. */
static void texts_of_variable_length_are_read(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400], found[HAFT_DIGEST_CAPACITY], origin[HAFT_DIGEST_CAPACITY];
    static const char *const digest = "0123456789abcdef0123456789abcdef";
    haft_error error = {0};
    size_t size = 0;
    data_write_laws(scratch_path(&s, "laws.h5", path));
    free(data_strip(path, &size));
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT), any = hdf_text_type(0);
    set_attribute(file, "/", "laws_digest", any, 0, &digest);
    assert_true(H5Fclose(file) >= 0);
    H5Tclose(any);
    for (int vouched = 0; vouched < 2; vouched++) {
        check_ok(haft_laws_peek(found, origin, path, &error), error);
        assert_string_equal(found, digest);
        hdf_vouch(path);
    }
    scratch_remove(&s);
}

/* ---- files that are open ---- */

static void check_load(haft_results_file *file, double load) {
    haft_error error = {0};
    haft_path *p = NULL;
    check_ok(haft_results_take_path(&p, file, 0, &error), error);
    assert_int_equal(p->points, DATA_POINTS);
    check_near(p->point[0].load, load, 0);
    haft_path_destroy(&p);
}

/* What was verified is what is read, whatever becomes of the file. */
static void open_files_stay_as_they_were_verified(void **state) {
    (void)state;
    scratch s = scratch_create();
    char first[400], second[400], laws[400];
    haft_error error = {0};
    haft_results_file *a = NULL, *b = NULL;
    haft_path *p = NULL;
    data_write_results(scratch_path(&s, "a.h5", first), 1.5);
    data_write_results(scratch_path(&s, "b.h5", second), 2.5);
    data_write_laws(scratch_path(&s, "laws.h5", laws));
    check_ok(haft_results_open(&a, first, &error), error);
    check_ok(haft_results_open(&b, second, &error), error);
    write_file(first, "cut", 3);
    accept_by(0, laws);
    check_load(a, 1.5);
    check_load(b, 2.5);
    assert_int_equal(haft_results_take_path(&p, a, 1, &error), HAFT_ERROR_INPUT);
    assert_non_null(strstr(error.message, "no realization 1"));
    assert_null(p);
    check_load(a, 1.5); /* a failure does not stick */
    haft_results_close(&a);
    check_load(b, 2.5);
    haft_results_close(&b);
    haft_results_close(&b);
    haft_results_close(NULL);
    scratch_remove(&s);
}

int main(void) {
    alarm(250); /* a file that hangs a reader fails the test */
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_flipped_bit_is_harmless_or_told),
        cmocka_unit_test(changed_bytes_without_checksum_do_no_harm),
        cmocka_unit_test(files_that_lead_out_or_overrun_are_refused),
        cmocka_unit_test(texts_of_variable_length_are_read),
        cmocka_unit_test(open_files_stay_as_they_were_verified),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
