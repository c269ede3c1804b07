/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Data files that another program wrote anew: with the same data they are read as before, else the
 * message names what was changed. */
#include "data_files.h"
#include "hostile_hdf.h"
#include "program.h"

/* ---- what other programs do and leave the data as they are ---- */

typedef struct rewriting {
    const char *path, *copy;
    hid_t from, to;
    bool big_endian;
} rewriting;

static void open_and_close(const char *path) {
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
    assert_true(file >= 0 && H5Fclose(file) >= 0);
}

/* Opens a data file for writing; its name is the first dataset of Haft's in it. */
static hid_t open_for_writing(const char *path, const char **dataset) {
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
    assert_true(file >= 0);
    *dataset = H5Lexists(file, "laws", H5P_DEFAULT) > 0 ? "/laws/e" : "/summary/gamma";
    return file;
}

static void add_attributes(const char *path) {
    const char *dataset = NULL;
    hid_t file = open_for_writing(path, &dataset), text = hdf_text_type(5);
    double numbers[3] = {1, 2, 3};
    hdf_attach(file, "/", "note", text, 0, "mine");
    hdf_attach(file, dataset, "numbers", H5T_NATIVE_DOUBLE, 3, numbers);
    assert_true(H5Fclose(file) >= 0);
    H5Tclose(text);
}

/* Of kinds that Haft itself would refuse to read, too. */
static void add_objects(const char *path) {
    const char *dataset = NULL;
    hid_t file = open_for_writing(path, &dataset);
    H5Gclose(H5Gcreate2(file, "mine", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    hdf_matrix(file, "/mine/plain", 3, 4, &(hdf_layout){0});
    hdf_matrix(file, "/mine/outside", 3, 4, &(hdf_layout){.external = "elsewhere"});
    hdf_matrix(file, "/mine/virtual", 3, 4, &(hdf_layout){.virtual_of = "elsewhere.h5"});
    assert_true(H5Lcreate_soft(dataset, file, "/mine/link", H5P_DEFAULT, H5P_DEFAULT) >= 0);
    assert_true(
        H5Lcreate_external("elsewhere.h5", "/z", file, "/mine/far", H5P_DEFAULT, H5P_DEFAULT) >= 0);
    assert_true(H5Fclose(file) >= 0);
}

static void cut_header(const char *path) {
    size_t size = 0;
    char *bytes = read_whole_file(path, &size);
    write_file(path, bytes + DATA_HEADER, size - DATA_HEADER);
    free(bytes);
}

static void widen_user_block(const char *path) {
    size_t size = 0;
    char *bytes = read_whole_file(path, &size), *both = calloc(1, 1024 + size);
    assert_non_null(both);
    memcpy(both, "notes of another program\n", 25);
    memcpy(both + 1024, bytes + DATA_HEADER, size - DATA_HEADER);
    write_file(path, both, 1024 + size - DATA_HEADER);
    free(both);
    free(bytes);
}

static herr_t copy_attribute(hid_t object, const char *name, const H5A_info_t *info, void *to) {
    (void)info;
    hid_t old = H5Aopen(object, name, H5P_DEFAULT), space = H5Aget_space(old);
    hid_t type = H5Aget_type(old), made = *(hid_t *)to;
    char value[8192];
    assert_true(H5Tget_size(type) <= sizeof value && H5Aread(old, type, value) >= 0);
    hid_t new = H5Acreate2(made, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(new >= 0 && H5Awrite(new, type, value) >= 0);
    H5Aclose(new);
    H5Tclose(type);
    H5Sclose(space);
    H5Aclose(old);
    return 0;
}

/* As chunks that are compressed; empty ones stay as they are. */
static hid_t copy_dataset(const rewriting *r, hid_t set, const char *name) {
    hid_t space = H5Dget_space(set), type = H5Dget_type(set), creation = H5Dget_create_plist(set);
    hsize_t dims[8];
    int rank = H5Sget_simple_extent_dims(space, dims, NULL);
    size_t points = (size_t)H5Sget_simple_extent_npoints(space);
    void *value = calloc(points + 1, 8);
    assert_non_null(value);
    if (points > 0) {
        assert_true(H5Pset_layout(creation, H5D_CHUNKED) >= 0);
        assert_true(H5Pset_chunk(creation, rank, dims) >= 0 && H5Pset_shuffle(creation) >= 0);
        assert_true(H5Pset_deflate(creation, 6) >= 0);
    }
    hid_t stored = H5Tcopy(type), native = H5Tget_native_type(type, H5T_DIR_ASCEND);
    if (r->big_endian) {
        assert_true(H5Tset_order(stored, H5T_ORDER_BE) >= 0);
    }
    hid_t made = H5Dcreate2(r->to, name, stored, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    assert_true(H5Dread(set, native, H5S_ALL, H5S_ALL, H5P_DEFAULT, value) >= 0);
    assert_true(made >= 0 && H5Dwrite(made, native, H5S_ALL, H5S_ALL, H5P_DEFAULT, value) >= 0);
    free(value);
    H5Tclose(native);
    H5Tclose(stored);
    H5Pclose(creation);
    H5Tclose(type);
    H5Sclose(space);
    return made;
}

static herr_t copy_object(hid_t from, const char *name, const H5O_info_t *info, void *user) {
    const rewriting *r = user;
    hid_t object = H5Oopen(from, name, H5P_DEFAULT), made = -1;
    if (info->type == H5O_TYPE_DATASET) {
        made = copy_dataset(r, object, name);
    } else if (strcmp(name, ".") == 0) {
        made = H5Oopen(r->to, "/", H5P_DEFAULT);
    } else {
        made = H5Gcreate2(r->to, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    }
    assert_true(object >= 0 && made >= 0);
    assert_true(H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, NULL, copy_attribute, &made) >= 0);
    H5Oclose(made);
    H5Oclose(object);
    return 0;
}

/* What h5repack does: all is copied into a new file, the user block too or not. */
static void repack(const char *path, bool latest, bool user_block) {
    char copy[420];
    snprintf(copy, sizeof copy, "%s.new", path);
    hid_t access = H5Pcreate(H5P_FILE_ACCESS), creation = H5Pcreate(H5P_FILE_CREATE);
    if (latest) {
        assert_true(H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST) >= 0);
    }
    if (user_block) {
        assert_true(H5Pset_userblock(creation, DATA_HEADER) >= 0);
    }
    rewriting r = {.from = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT),
                   .to = H5Fcreate(copy, H5F_ACC_TRUNC, creation, access),
                   .big_endian = latest};
    assert_true(r.from >= 0 && r.to >= 0);
    assert_true(H5Ovisit2(r.from, H5_INDEX_NAME, H5_ITER_NATIVE, copy_object, &r, H5O_INFO_BASIC) >=
                0);
    assert_true(H5Fclose(r.from) >= 0 && H5Fclose(r.to) >= 0);
    H5Pclose(access);
    H5Pclose(creation);
    size_t size = 0, old_size = 0;
    char *new = read_whole_file(copy, &size), *old = read_whole_file(path, &old_size);
    if (user_block) {
        memcpy(new, old, DATA_HEADER);
    }
    write_file(path, new, size);
    free(old);
    free(new);
    assert_int_equal(unlink(copy), 0);
}

enum { REWRITINGS = 9 };

static void rewrite(const char *path, int how) {
    switch (how) {
    case 0:
        open_and_close(path);
        break;
    case 1:
        add_attributes(path);
        break;
    case 2:
        add_objects(path);
        break;
    case 3:
        cut_header(path);
        break;
    case 4:
        widen_user_block(path);
        break;
    case 5:
        repack(path, false, true);
        break;
    case 6:
        repack(path, false, false);
        break;
    case 7:
        repack(path, true, true);
        break;
    default:
        add_attributes(path);
        repack(path, true, false);
        add_objects(path);
        break;
    }
}

/* ---- files with the same data ---- */

static void check_laws(const char *path) {
    haft_error error = {0};
    haft_laws *laws = NULL;
    char digest[HAFT_DIGEST_CAPACITY], origin[HAFT_DIGEST_CAPACITY];
    check_ok(haft_laws_read(&laws, digest, path, &error), error);
    assert_int_equal(laws->m, DATA_LAWS);
    assert_int_equal(laws->n, DATA_DISTANCES);
    assert_int_equal(laws->sites, 2);
    check_near(laws->f_limit, 5e6, 0);
    for (int i = 0; i < DATA_DISTANCES; i++) {
        check_near(laws->distance[i], 1e-9 * (i + 3), 0);
    }
    haft_laws_destroy(&laws);
    check_ok(haft_laws_peek(digest, origin, path, &error), error);
}

static void check_results(const char *path, bool rewritten) {
    haft_error error = {0};
    haft_results_view *view = NULL;
    haft_path *p = NULL;
    haft_results_shapes *shapes = NULL;
    check_ok(haft_results_read(&view, path, &error), error);
    assert_int_equal(view->realizations, 2);
    assert_int_equal(view->summary[0].steps, DATA_POINTS);
    assert_int_equal(view->summary[1].outcome, -1);
    assert_int_equal(view->rewritten, rewritten);
    haft_results_view_destroy(&view);
    check_ok(haft_results_read_path(&p, path, 0, &error), error);
    check_near(p->point[0].load, 1.5, 0);
    haft_path_destroy(&p);
    check_ok(haft_results_read_shapes(&shapes, path, 0, &error), error);
    check_near(shapes->deflection[1], 1, 0);
    haft_results_shapes_destroy(&shapes);
}

static void rewritten_files_are_read(void **state) {
    (void)state;
    scratch s = scratch_create();
    char laws[400], results[400];
    scratch_path(&s, "laws.h5", laws);
    scratch_path(&s, "results.h5", results);
    for (int how = 0; how < REWRITINGS; how++) {
        data_write_laws(laws);
        check_laws(laws);
        rewrite(laws, how);
        check_laws(laws);
        data_write_results(results, 1.5);
        check_results(results, false);
        rewrite(results, how);
        check_results(results, true);
    }
    scratch_remove(&s);
}

/* ---- files with other data ---- */

typedef struct change {
    const char *remove;   /* this object */
    const char *of, *key; /* this attribute is removed, or is another */
    const char *value;    /* the first number of this dataset is another */
    const char *says;
} change;

static void put_value(hid_t file, const char *dataset) {
    double number = 123;
    hid_t set = H5Dopen2(file, dataset, H5P_DEFAULT), space = H5Dget_space(set);
    hid_t one = H5Screate(H5S_SCALAR);
    hsize_t at[3] = {0};
    assert_true(H5Sselect_elements(space, H5S_SELECT_SET, 1, at) >= 0);
    assert_true(H5Dwrite(set, H5T_NATIVE_DOUBLE, one, space, H5P_DEFAULT, &number) >= 0);
    H5Sclose(one);
    H5Sclose(space);
    H5Dclose(set);
}

static void apply(const char *path, const change *c) {
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT), text = hdf_text_type(3);
    assert_true(file >= 0);
    if (c->remove != NULL) {
        assert_true(H5Ldelete(file, c->remove, H5P_DEFAULT) >= 0);
    }
    if (c->key != NULL) {
        assert_true(H5Adelete_by_name(file, c->of, c->key, H5P_DEFAULT) >= 0);
        if (c->remove == NULL) {
            hdf_attach(file, c->of, c->key, text, 0, "km");
        }
    }
    if (c->value != NULL) {
        put_value(file, c->value);
    }
    assert_true(H5Fclose(file) >= 0);
    H5Tclose(text);
}

static const change laws_changes[] = {
    {.value = "/laws/e", .says = "not as written: /laws/e; "},
    {.value = "/curves/force", .says = "not as written: /curves/force; "},
    {.remove = "/curves/wet_area", .says = "missing: /curves/wet_area; "},
    {.remove = "/curves",
     .says = "missing: /curves/distance, /curves/force, /curves/zero_distance, "
             "/curves/contact_area and 2 more; "},
    {.of = "/laws/d_max", .key = "unit", .says = "not as written: /laws/d_max; "},
    {.of = "/laws", .key = "order", .says = "not as written: the attribute `order` of /laws; "},
    {.remove = "/laws/e",
     .of = "/laws",
     .key = "order",
     .value = "/laws/f_max",
     .says = "not as written: /laws/f_max; missing: /laws/e, the attribute `order` of /laws; "},
    {.value = "/contents", .says = "so was its list of digests"},
    {.remove = "/contents", .says = "missing: /contents; "},
};
static const change results_changes[] = {
    {.value = "/summary/gamma", .says = "not as written: /summary/gamma; "},
    {.value = "/realizations/0/evidence/displacement",
     .says = "not as written: /realizations/0/evidence/displacement; "},
    {.remove = "/summary/seconds", .says = "missing: /summary/seconds; "},
    {.remove = "/realizations/0/evidence", .says = " more; "},
    {.of = "/realizations/0",
     .key = "outcome_name",
     .says = "not as written: the attribute `outcome_name` of /realizations/0; "},
    {.of = "/", .key = "case", .says = "not as written: the attribute `case` of /; "},
};

/* With the header left in front, and without. */
static void check_refused_data(const char *path, bool laws, const change *c) {
    for (int bare = 0; bare < 2; bare++) {
        haft_error error = {0};
        haft_laws *l = NULL;
        haft_results_view *view = NULL;
        if (bare) {
            cut_header(path);
        }
        haft_status status =
            laws ? haft_laws_read(&l, NULL, path, &error) : haft_results_read(&view, path, &error);
        assert_int_equal(status, HAFT_ERROR_INPUT);
        assert_true(l == NULL && view == NULL);
        if (strstr(error.message, c->says) == NULL || strstr(error.message, path) == NULL) {
            fail_msg("\"%s\" is not in: %s", c->says, error.message);
        }
        assert_non_null(strstr(error.message, "was changed since Haft wrote it"));
        assert_non_null(strstr(error.message, "put back a copy of it, or move it away"));
        assert_null(strstr(error.message, "--force"));
    }
}

static void changed_data_are_named(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400];
    for (size_t i = 0; i < sizeof laws_changes / sizeof *laws_changes; i++) {
        data_write_laws(scratch_path(&s, "laws.h5", path));
        apply(path, &laws_changes[i]);
        check_refused_data(path, true, &laws_changes[i]);
    }
    for (size_t i = 0; i < sizeof results_changes / sizeof *results_changes; i++) {
        data_write_results(scratch_path(&s, "results.h5", path), 1.5);
        apply(path, &results_changes[i]);
        check_refused_data(path, false, &results_changes[i]);
    }
    scratch_remove(&s);
}

/* Files of versions that wrote no digests: as they were written they are read; that another program
 * changed them is told, and how to take them all the same. */
static void files_without_digests_are_read_as_written(void **state) {
    (void)state;
    scratch s = scratch_create();
    char path[400];
    haft_error error = {0};
    haft_results_view *view = NULL;
    size_t size = 0;
    data_write_results(scratch_path(&s, "results.h5", path), 1.5);
    free(data_strip(path, &size));
    check_results(path, false); /* as other programs write them */
    hdf_vouch(path);
    check_results(path, false);
    add_attributes(path);
    assert_int_equal(haft_results_read(&view, path, &error), HAFT_ERROR_INPUT);
    assert_non_null(strstr(error.message, "which older versions did not write"));
    assert_non_null(strstr(error.message, "take off the first 512 bytes"));
    cut_header(path);
    check_results(path, false);
    scratch_remove(&s);
}

/* ---- the programs ---- */

static void check_all_programs(const case_folder *c) {
    ran r = run_expect(0, HAFT, ARGS("info", c->path));
    check_says(r.out, "results.h5 was rewritten by another program; its data are unchanged");
    ran_free(&r);
    must_run(HAFT_LAWS, ARGS("info", c->path));
    must_run(HAFT, ARGS("report", "--quiet", c->path));
    must_run(HAFT, ARGS("compare", "--quiet", c->path, c->path));
    for (int i = 0; i < 2; i++) {
        r = run_expect(0, HAFT, ARGS(i == 0 ? "resume" : "merge", c->path));
        check_says(r.err, "the run is complete");
        ran_free(&r);
    }
}

static void all_programs_take_rewritten_files(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    char laws[400], results[400];
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    path_in(&c, "out/laws.h5", laws);
    path_in(&c, "out/results.h5", results);
    rewrite(laws, 0);
    rewrite(results, 5);
    check_all_programs(&c);
    assert_int_equal(unlink(results), 0);
    ran r = run_expect(0, HAFT, ARGS("run", c.path));
    check_says(r.err, "built from the same inputs: reading them");
    ran_free(&r);
    must_run(HAFT, ARGS("run", "--quiet", "--force", "--shard=1/2", c.path));
    rewrite(laws, 1);
    must_run(HAFT, ARGS("run", "--quiet", "--force", "--shard=2/2", c.path));
    must_run(HAFT, ARGS("merge", "--quiet", c.path));
    case_remove(&c);
}

/* Changed laws stop a run, with the dataset's name; nothing is replaced. */
static void changed_files_stop_the_programs(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    char laws[400], results[400];
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    apply(path_in(&c, "out/results.h5", results), &results_changes[0]);
    check_program_refuses(
        &c, 3, HAFT, ARGS("info", c.path),
        SAYS("not as written: /summary/gamma; ", "move it away and make it anew"));
    check_program_refuses(&c, 3, HAFT, ARGS("report", c.path),
                          SAYS("not as written: /summary/gamma; "));
    check_program_refuses(&c, 3, HAFT, ARGS("resume", c.path),
                          SAYS("not as written: /summary/gamma; "));
    assert_int_equal(unlink(results), 0);
    apply(path_in(&c, "out/laws.h5", laws), &laws_changes[1]);
    check_program_refuses(
        &c, 3, HAFT, ARGS("run", c.path),
        SAYS("not as written: /curves/force; ", "move it away and build it anew"));
    char kept[400];
    assert_int_equal(rename(laws, path_in(&c, "kept", kept)), 0);
    must_run(HAFT, ARGS("run", "--quiet", c.path)); /* the way out works */
    case_remove(&c);
}

/* Where the parts are there, they are named. */
static void parts_are_named(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    char results[400], kept[400];
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    assert_int_equal(rename(path_in(&c, "out/results.h5", results), path_in(&c, "kept", kept)), 0);
    must_run(HAFT, ARGS("run", "--quiet", "--shard=1/1", c.path));
    assert_int_equal(rename(kept, results), 0);
    apply(results, &results_changes[0]);
    check_program_refuses(&c, 3, HAFT, ARGS("info", c.path),
                          SAYS("haft resume CASE makes it anew"));
    assert_int_equal(unlink(results), 0);
    must_run(HAFT, ARGS("resume", "--quiet", c.path));
    assert_true(exists(&c, "out/results.h5"));
    case_remove(&c);
}

int main(void) {
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rewritten_files_are_read),
        cmocka_unit_test(changed_data_are_named),
        cmocka_unit_test(files_without_digests_are_read_as_written),
        cmocka_unit_test(all_programs_take_rewritten_files),
        cmocka_unit_test(changed_files_stop_the_programs),
        cmocka_unit_test(parts_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
