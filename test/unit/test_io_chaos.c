/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stochastic model in laws.h5: what is written reads back to the same bits and draws the same
 * vectors; a model that was tampered with is refused; and tables of vectors made elsewhere. */
#include "scratch.h"

#include <hdf5.h>

#include "haft/study.h"

static haft_case *read_case(haft_sampler sampler) {
    haft_error error = {0};
    haft_case *c = NULL;
    check_ok(haft_case_read(&c, HAFT_SOURCE_DIR "/cases/delrio-rh85-gpce/case.yaml", &error),
             error);
    c->law.sampler = sampler;
    c->law.chaos.spec.order = 4;
    return c;
}

enum { M = 200 };

static void draw_vectors(haft_law_vector vector[M]) {
    for (uint64_t k = 0; k < M; k++) {
        double z[4];
        haft_random_normals((haft_random_key){7, HAFT_RANDOM_TEST}, 0, k, 0, 4, z);
        double d_max = 11e-9 + 0.4e-9 * z[2];
        vector[k] = (haft_law_vector){3.6e-3 * exp(0.3 * z[0]), 1e6 * exp(0.25 * z[0] + 0.1 * z[1]),
                                      d_max, d_max - 2.8e-9 * exp(0.1 * z[3])};
    }
}

static haft_laws *fit(const haft_case *c) {
    haft_error error = {0};
    haft_law_vector vector[M];
    haft_laws *laws = NULL;
    draw_vectors(vector);
    check_ok(haft_study_fit_laws(&laws, c, M, vector, &error), error);
    return laws;
}

/* A fitted model, and the file it was written to. */
typedef struct written_model {
    scratch s;
    char path[400];
    haft_case *c;
    haft_laws *laws;
} written_model;

static written_model write_model(void) {
    written_model w = {.s = scratch_create(), .c = read_case(HAFT_SAMPLER_GPCE)};
    haft_error error = {0};
    w.laws = fit(w.c);
    scratch_path(&w.s, "laws.h5", w.path);
    check_ok(haft_laws_write(w.laws, w.c, w.path, &error), error);
    return w;
}

static void drop_model(written_model *w) {
    haft_laws_destroy(&w->laws);
    haft_case_destroy(&w->c);
    scratch_remove(&w->s);
}

static void a_model_reads_back_to_the_same_bits(void **state) {
    (void)state;
    written_model w = write_model();
    haft_error error = {0};
    haft_case *c = w.c;
    haft_laws *laws = w.laws, *back = NULL;
    const char *path = w.path;
    check_ok(haft_laws_read(&back, NULL, path, &error), error);
    assert_int_equal(back->n, 0);
    assert_int_equal(back->m, M);
    assert_non_null(back->chaos);
    assert_memory_equal(&back->errors, &laws->errors, sizeof laws->errors);
    haft_chaos_parts p, q;
    haft_chaos_get_parts(laws->chaos, &p);
    haft_chaos_get_parts(back->chaos, &q);
    assert_int_equal(q.terms, p.terms);
    assert_memory_equal(q.coefficient, p.coefficient, p.terms * p.components * sizeof(double));
    assert_memory_equal(q.index, p.index, p.terms * p.components * sizeof *p.index);
    assert_memory_equal(q.centre, p.centre, p.m * p.components * sizeof(double));
    for (haft_sampler k = HAFT_SAMPLER_GPCE; k <= HAFT_SAMPLER_MEAN; k++) {
        haft_law_vector a[50], b[50];
        c->law.sampler = k;
        check_ok(haft_study_draw(laws, c, 3, 50, a, &error), error);
        check_ok(haft_study_draw(back, c, 3, 50, b, &error), error);
        assert_memory_equal(a, b, sizeof a);
    }
    haft_laws_destroy(&back);
    drop_model(&w);
}

/* Another program's view: an expansion evaluated from the file alone gives the vectors' means. */
static void the_file_alone_is_enough_to_sample(void **state) {
    (void)state;
    written_model m = write_model();
    const haft_laws *laws = m.laws;
    hid_t file = H5Fopen(m.path, H5F_ACC_RDONLY, H5P_DEFAULT);
    assert_true(file >= 0);
    double coefficient[300 * 3], sigma[4], mean[4], value[4], vectors[4][4];
    int index[300 * 3];
    struct {
        const char *name;
        void *into;
        hid_t type;
    } sets[] = {{"/chaos/coefficient", coefficient, H5T_NATIVE_DOUBLE},
                {"/chaos/index", index, H5T_NATIVE_INT},
                {"/chaos/sigma", sigma, H5T_NATIVE_DOUBLE},
                {"/chaos/mean", mean, H5T_NATIVE_DOUBLE},
                {"/chaos/eigenvalue", value, H5T_NATIVE_DOUBLE},
                {"/chaos/eigenvector", vectors, H5T_NATIVE_DOUBLE}};
    for (size_t i = 0; i < sizeof sets / sizeof *sets; i++) {
        hid_t set = H5Dopen2(file, sets[i].name, H5P_DEFAULT);
        assert_true(H5Dread(set, sets[i].type, H5S_ALL, H5S_ALL, H5P_DEFAULT, sets[i].into) >= 0);
        H5Dclose(set);
    }
    H5Fclose(file);
    double x[3] = {0.3, 0.8, 0.45}, eta[3] = {0}, expected[3];
    for (size_t t = 0; t < 35; t++) { /* C(4 + 3, 3) terms, Legendre polynomials on (0, 1) */
        double product = 1;
        for (size_t i = 0; i < 3; i++) {
            double y = 2 * x[i] - 1, p[5] = {1, y};
            for (int n = 1; n < 4; n++) {
                p[n + 1] = ((2 * n + 1) * y * p[n] - n * p[n - 1]) / (n + 1);
            }
            int degree = index[3 * t + i];
            product *= p[degree] * sqrt(2 * degree + 1);
        }
        for (size_t j = 0; j < 3; j++) {
            eta[j] += coefficient[3 * t + j] * product;
        }
    }
    haft_chaos_expand(laws->chaos, x, expected);
    double q[4], own[4];
    haft_chaos_q_from_eta(laws->chaos, expected, own);
    for (int i = 0; i < 4; i++) {
        q[i] = mean[i];
        for (int j = 0; j < 3; j++) {
            q[i] += vectors[i][j] * sqrt(value[j]) * eta[j];
        }
        check_near(q[i], own[i], 1e-12 * fabs(own[i]));
    }
    haft_law_vector v = haft_chaos_vector_from_q(laws->chaos, own);
    double a_left = log(1 + sqrt(1 + 5e6 / v.f_max)) / (v.d_max - v.d_limit);
    check_relative(exp(q[1] * sigma[1]), v.f_max, 1e-11);
    check_relative(exp(q[0] * sigma[0]), v.e - v.f_max / (2 * a_left), 1e-11);
    drop_model(&m);
}

/* Writes `value` over the first number of a dataset, as another program might. */
static void tamper(const char *path, const char *name, double value) {
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
    hid_t set = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(set);
    hsize_t at[2] = {0, 0}, one[2] = {1, 1};
    H5Sselect_hyperslab(space, H5S_SELECT_SET, at, NULL, one, NULL);
    hid_t cell = H5Screate_simple(1, one, NULL);
    assert_true(H5Dwrite(set, H5T_NATIVE_DOUBLE, cell, space, H5P_DEFAULT, &value) >= 0);
    H5Sclose(cell);
    H5Sclose(space);
    H5Dclose(set);
    H5Fclose(file);
}

/* A copy without the checksum's block, as another HDF5 tool leaves it. */
static void strip(const char *from, const char *to) {
    size_t size = 0;
    char *data = read_whole_file(from, &size);
    write_file(to, data + 512, size - 512);
    free(data);
}

static void a_model_tampered_with_is_refused(void **state) {
    (void)state;
    static const struct {
        const char *name;
        double value;
        const char *says;
    } changes[] = {
        {"/chaos/sigma", -1, "sigma"},
        {"/chaos/centre", (double)NAN, "centre"},
        {"/chaos/coefficient", INFINITY, "coef"},
        {"/chaos/index", 3, "/chaos"},
        {"/chaos/component_order", -2, "/chaos"},
        {"/chaos/eigenvalue", (double)NAN, "eigenvalue"},
    };
    written_model w = write_model();
    char copy[400];
    scratch_path(&w.s, "copy.h5", copy);
    haft_error error = {0};
    haft_laws *back = NULL;
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        strip(w.path, copy);
        tamper(copy, changes[i].name, changes[i].value);
        assert_int_equal(haft_laws_read(&back, NULL, copy, &error), HAFT_ERROR_INPUT);
        assert_null(back);
        if (strstr(error.message, changes[i].says) == NULL || strstr(error.message, copy) == NULL) {
            fail_msg("%s: %s", changes[i].name, error.message);
        }
    }
    drop_model(&w);
}

static void a_table_of_vectors_is_read_in_any_units(void **state) {
    (void)state;
    static const char table[] =
        "\xef\xbb\xbfsite,d_max [um], e [uJ/m2],f_max [kPa],fault,d_limit [m]\n"
        "0,0.011,3600,1000,0,8.2e-9\n"
        "\n"
        "1,nan,nan,nan,2,nan\r\n"
        "2, 0.012 ,3.7e3,1100,0,9e-9\r\n";
    scratch s = scratch_create();
    char path[400];
    write_file(scratch_path(&s, "v.csv", path), table, strlen(table));
    haft_error error = {0};
    haft_law_vector *v = NULL;
    size_t m = 0;
    check_ok(haft_vectors_read(&v, &m, path, &error), error);
    assert_int_equal(m, 2);
    check_relative(v[0].d_max, 11e-9, 1e-14);
    check_relative(v[0].e, 3.6e-3, 1e-14);
    check_relative(v[0].f_max, 1e6, 1e-14);
    check_relative(v[0].d_limit, 8.2e-9, 1e-14);
    check_relative(v[1].e, 3.7e-3, 1e-14);
    haft_memory_free(v);
    scratch_remove(&s);
}

static void bad_tables_are_told_by_line(void **state) {
    (void)state;
    static const struct {
        const char *table, *says;
    } bad[] = {
        {"e [mJ/m2],f_max [MPa],d_max [nm]\n1,2,3\n", ":1: there is no column d_limit"},
        {"e [mJ/m2],f_max [MPa],d_max,d_limit [nm]\n1,2,3,4\n", ":1: the column d_max has no unit"},
        {"e [mJ/m2],f_max [nm],d_max [nm],d_limit [nm]\n",
         ":1: the column f_max has no unit of Pa"},
        {"e [mJ/m2],f_max [MPa],d_max [nm],d_limit [nm]\n1,2,3\n", ":2: 3 fields where"},
        {"e [mJ/m2],f_max [MPa],d_max [nm],d_limit [nm]\n1,2,3,4\n1,2,x,4\n", ":3: d_max is \"x\""},
        {"e [mJ/m2],f_max [MPa],d_max [nm],d_limit [nm]\n1,2,inf,4\n", ":2: d_max is \"inf\""},
        {"e [mJ/m2],f_max [MPa],d_max [nm],d_limit [nm]\n", "holds no law vector"},
        {"", "holds no law vector"},
    };
    scratch s = scratch_create();
    char path[400];
    scratch_path(&s, "v.csv", path);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        write_file(path, bad[i].table, strlen(bad[i].table));
        haft_error error = {0};
        haft_law_vector *v = NULL;
        size_t m = 0;
        assert_int_equal(haft_vectors_read(&v, &m, path, &error), HAFT_ERROR_INPUT);
        assert_null(v);
        if (strstr(error.message, bad[i].says) == NULL || strstr(error.message, path) == NULL) {
            fail_msg("\"%s\" gives: %s", bad[i].table, error.message);
        }
    }
    haft_error error = {0};
    haft_law_vector *v = NULL;
    size_t m = 0;
    scratch_path(&s, "none.csv", path);
    assert_int_equal(haft_vectors_read(&v, &m, path, &error), HAFT_ERROR_IO);
    scratch_remove(&s);
}

/* The laws' digest: no sampler cares for the beam's length or how many beams there are; a
 * stochastic one not for which of them it is either, but for the model's choices. */
static void the_digest_knows_what_the_model_depends_on(void **state) {
    (void)state;
    haft_error error = {0};
    haft_case *c = read_case(HAFT_SAMPLER_GPCE);
    char first[HAFT_DIGEST_CAPACITY], next[HAFT_DIGEST_CAPACITY];
    check_ok(haft_case_laws_digest(c, first, &error), error);
    c->realizations += 5;
    c->beam.length *= 2;
    c->law.sampler = HAFT_SAMPLER_KERNEL;
    check_ok(haft_case_laws_digest(c, next, &error), error);
    assert_string_equal(next, first);
    c->law.chaos.spec.order++;
    check_ok(haft_case_laws_digest(c, next, &error), error);
    assert_string_not_equal(next, first);
    c->law.sampler = HAFT_SAMPLER_PATCHES;
    check_ok(haft_case_laws_digest(c, first, &error), error);
    c->law.chaos.spec.order++;
    check_ok(haft_case_laws_digest(c, next, &error), error);
    assert_string_equal(next, first);
    c->realizations++;
    c->beam.length *= 2;
    check_ok(haft_case_laws_digest(c, next, &error), error);
    assert_string_equal(next, first);
    c->law.sampler = HAFT_SAMPLER_EXPLICIT;
    check_ok(haft_case_laws_digest(c, next, &error), error);
    assert_string_not_equal(next, first);
    haft_case_destroy(&c);
}

int main(void) {
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_model_reads_back_to_the_same_bits),
        cmocka_unit_test(the_file_alone_is_enough_to_sample),
        cmocka_unit_test(a_model_tampered_with_is_refused),
        cmocka_unit_test(a_table_of_vectors_is_read_in_any_units),
        cmocka_unit_test(bad_tables_are_told_by_line),
        cmocka_unit_test(the_digest_knows_what_the_model_depends_on),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
