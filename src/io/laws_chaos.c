/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stochastic model in laws.h5, under /chaos: everything that another program needs to sample
 * from it. The model itself checks the data that are read. */
#include "hdf.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { DIMENSION = HAFT_CHAOS_DIMENSION };

static const char NORMALISATION[] =
    "eta_j = sum over terms of coefficient[term][j] * product over i of psi_(index[term][i])(x_i), "
    "x_i the germ of component component_order[i]; mean of psi^2 under the germ's law is 1. "
    "q = mean + sum_j eigenvector[:][j] sqrt(eigenvalue[j]) eta_j; logarithms of SI numbers, "
    "divided by sigma: paper: q = [ln e, ln f_max, d_max, ln(d_max - d_limit)] / sigma; strict: "
    "ln(e - f_max / (2 a_left)) first, a_left = ln(1 + sqrt(1 + f_limit / f_max)) / (d_max - "
    "d_limit)";

/* ---- errors ---- */

/* Errors with one number per component. */
typedef struct error_row {
    const char *name, *description;
    size_t offset, stride; /* offset in haft_chaos_errors; stride in doubles */
} error_row;
#define ROW(member, text)                                                                          \
    { #member, text, offsetof(haft_chaos_errors, member), 1 }
#define DISTANCE(law, member, text)                                                                \
    {                                                                                              \
#law "_" #member, text, offsetof(haft_chaos_errors, law[0].member),                        \
            sizeof(haft_chaos_distance) / sizeof(double)                                           \
    }
static const error_row error_rows[] = {
    ROW(relmise_own, "mean square error by the projection's own Gauss rule, relative"),
    ROW(relmise, "mean square error by an independent rule, relative"),
    ROW(variance, "variance of the kernel density"),
    ROW(variance_error, "share of that variance the expansion lacks"),
    DISTANCE(kernel, ks, "Kolmogorov-Smirnov distance of the expansion from the kernel density"),
    DISTANCE(kernel, w1, "Wasserstein-1 distance, in standard deviations"),
    DISTANCE(kernel, low_quantile, "difference of the 0.1 % quantiles"),
    DISTANCE(kernel, high_quantile, "difference of the 99.9 % quantiles"),
    DISTANCE(data, ks, "Kolmogorov-Smirnov distance of the expansion from the data"),
    DISTANCE(data, w1, "Wasserstein-1 distance, in standard deviations"),
    DISTANCE(data, low_quantile, "difference of the 0.1 % quantiles"),
    DISTANCE(data, high_quantile, "difference of the 99.9 % quantiles"),
};
enum { ERROR_ROWS = sizeof error_rows / sizeof *error_rows };

static double *error_of(haft_chaos_errors *errors, const error_row *row, size_t component) {
    return (double *)(void *)((char *)errors + row->offset) + component * row->stride;
}

static void write_errors(haft_hdf *hdf, const haft_chaos_errors *given, size_t components) {
    haft_chaos_errors errors = *given;
    hsize_t dims[1] = {components};
    for (int i = 0; i < ERROR_ROWS; i++) {
        double value[DIMENSION];
        for (size_t j = 0; j < components; j++) {
            value[j] = *error_of(&errors, &error_rows[i], j);
        }
        char path[96];
        snprintf(path, sizeof path, "/chaos/errors/%s", error_rows[i].name);
        haft_hdf_write(hdf, path, HAFT_HDF_REAL, 1, dims, value, "1", error_rows[i].description);
    }
    haft_hdf_write_real(hdf, "/chaos/errors", "relmise_own_total", errors.relmise_own_total);
    haft_hdf_write_real(hdf, "/chaos/errors", "relmise_total", errors.relmise_total);
    haft_hdf_write_real(hdf, "/chaos/errors", "outside", errors.outside);
    haft_hdf_write_real(hdf, "/chaos/errors", "reduction", errors.reduction);
}

static void read_errors(haft_hdf *hdf, haft_chaos_errors *errors, size_t components) {
    size_t dims[1] = {components};
    for (int i = 0; i < ERROR_ROWS; i++) {
        double value[DIMENSION] = {0};
        char path[96];
        snprintf(path, sizeof path, "/chaos/errors/%s", error_rows[i].name);
        haft_hdf_read(hdf, path, HAFT_HDF_REAL, 1, dims, value);
        for (size_t j = 0; j < components; j++) {
            *error_of(errors, &error_rows[i], j) = value[j];
        }
    }
    haft_hdf_read_real(hdf, "/chaos/errors", "relmise_own_total", &errors->relmise_own_total);
    haft_hdf_read_real(hdf, "/chaos/errors", "relmise_total", &errors->relmise_total);
    haft_hdf_read_real(hdf, "/chaos/errors", "outside", &errors->outside);
    haft_hdf_read_real(hdf, "/chaos/errors", "reduction", &errors->reduction);
}

/* ---- the model ---- */

static void write_arrays(haft_hdf *hdf, const haft_chaos_parts *p) {
    hsize_t four[2] = {DIMENSION, DIMENSION}, centre[2] = {p->m, p->components};
    hsize_t terms[2] = {p->terms, p->components};
    haft_hdf_write(hdf, "/chaos/sigma", HAFT_HDF_REAL, 1, four, p->sigma, "1",
                   "what each of the four transformed numbers is divided by");
    haft_hdf_write(hdf, "/chaos/mean", HAFT_HDF_REAL, 1, four, p->mean, "1", "mean of q");
    haft_hdf_write(hdf, "/chaos/eigenvalue", HAFT_HDF_REAL, 1, four, p->eigenvalue, "1",
                   "eigenvalues of the covariance of q, falling");
    haft_hdf_write(hdf, "/chaos/eigenvector", HAFT_HDF_REAL, 2, four, p->eigenvector, "1",
                   "part of q_i (row) in principal component j (column)");
    haft_hdf_write(hdf, "/chaos/centre", HAFT_HDF_REAL, 2, centre, p->centre, "1",
                   "eta of each vector: the kernels' centres before any shrinking");
    haft_hdf_write(hdf, "/chaos/coefficient", HAFT_HDF_REAL, 2, terms, p->coefficient, "1",
                   "of each term (row) in each component (column); see `expansion`");
    haft_hdf_write_columns(hdf, "/chaos/vector", DIMENSION, haft_hdf_vector_columns, p->vector,
                           sizeof *p->vector, p->m);
}

static void write_whole(haft_hdf *hdf, const haft_chaos_parts *p) {
    hsize_t order[1] = {p->components}, terms[2] = {p->terms, p->components};
    int component[DIMENSION];
    for (size_t i = 0; i < p->components; i++) {
        component[i] = (int)p->component_order[i];
    }
    haft_hdf_write(hdf, "/chaos/component_order", HAFT_HDF_INT, 1, order, component, "1",
                   "the principal component that comes 1st, 2nd, ... in the Rosenblatt map");
    haft_hdf_write(hdf, "/chaos/index", HAFT_HDF_INT, 2, terms, p->index, "1",
                   "degree of each term (row) in each germ variable (column)");
    haft_hdf_write_text(hdf, "/chaos", "bounds", haft_chaos_bounds_name(p->bounds));
    haft_hdf_write_text(hdf, "/chaos", "kernel", haft_chaos_kernel_name(p->kernel));
    haft_hdf_write_text(hdf, "/chaos", "germ", haft_chaos_germ_name(p->germ));
    haft_hdf_write_text(hdf, "/chaos", "expansion", NORMALISATION);
    haft_hdf_write_limit(hdf, "/chaos", p->f_limit);
    haft_hdf_write_real(hdf, "/chaos", "bandwidth", p->bandwidth);
    haft_hdf_write_count(hdf, "/chaos", "components", p->components);
    haft_hdf_write_count(hdf, "/chaos", "order", p->order);
    haft_hdf_write_count(hdf, "/chaos", "points", p->points);
}

void haft_laws_write_chaos(haft_hdf *hdf, const haft_laws *laws) {
    haft_chaos_parts parts;
    haft_chaos_get_parts(laws->chaos, &parts);
    _Static_assert(sizeof(unsigned) == sizeof(int), "degrees are written as ints");
    write_arrays(hdf, &parts);
    write_whole(hdf, &parts);
    write_errors(hdf, &laws->errors, parts.components);
}

/* ---- reading ---- */

/* Reads an attribute that is one of `count` names; returns its index. */
static int read_choice(haft_hdf *hdf, const char *name, const char *(*name_of)(int), int count) {
    char *text = NULL;
    haft_hdf_read_text(hdf, "/chaos", name, &text);
    int found = -1;
    for (int i = 0; text != NULL && i < count; i++) {
        found = strcmp(text, name_of(i)) == 0 ? i : found;
    }
    if (hdf->status == HAFT_OK && found < 0) {
        haft_hdf_refuse(hdf, "has an unknown `%s`, \"%.40s\", in /chaos", name, text);
    }
    haft_memory_free(text);
    return found < 0 ? 0 : found;
}

static const char *bounds_name(int i) {
    return haft_chaos_bounds_name((haft_chaos_bounds)i);
}

static const char *kernel_name(int i) {
    return haft_chaos_kernel_name((haft_chaos_kernel)i);
}

static const char *germ_name(int i) {
    return haft_chaos_germ_name((haft_chaos_germ)i);
}

/* Arrays read from the file, from which the model is made. */
typedef struct arrays {
    haft_law_vector *vector;
    double *centre, *coefficient;
    unsigned *index;
} arrays;

static void free_arrays(arrays *a) {
    haft_memory_free(a->vector);
    haft_memory_free(a->centre);
    haft_memory_free(a->coefficient);
    haft_memory_free(a->index);
}

static void read_scalars(haft_hdf *hdf, haft_chaos_parts *p) {
    uint64_t components = 0, order = 0, points = 0;
    p->bounds = (haft_chaos_bounds)read_choice(hdf, "bounds", bounds_name, 2);
    p->kernel = (haft_chaos_kernel)read_choice(hdf, "kernel", kernel_name, 2);
    p->germ = (haft_chaos_germ)read_choice(hdf, "germ", germ_name, 3);
    haft_hdf_read_limit(hdf, "/chaos", &p->f_limit);
    haft_hdf_read_real(hdf, "/chaos", "bandwidth", &p->bandwidth);
    haft_hdf_read_count(hdf, "/chaos", "components", &components);
    haft_hdf_read_count(hdf, "/chaos", "order", &order);
    haft_hdf_read_count(hdf, "/chaos", "points", &points);
    if (hdf->status == HAFT_OK && (components < 1 || components > DIMENSION)) {
        haft_hdf_refuse(hdf, "has %llu components in /chaos; a law vector has 1 to %d",
                        (unsigned long long)components, DIMENSION);
    }
    p->components = (size_t)components;
    p->order = (size_t)order;
    p->points = (size_t)points;
}

static void read_arrays(haft_hdf *hdf, haft_chaos_parts *p, arrays *a) {
    size_t four[2] = {DIMENSION, DIMENSION}, centre[2] = {0}, terms[2] = {0};
    haft_hdf_read(hdf, "/chaos/sigma", HAFT_HDF_REAL, 1, four, p->sigma);
    haft_hdf_read(hdf, "/chaos/mean", HAFT_HDF_REAL, 1, four, p->mean);
    haft_hdf_read(hdf, "/chaos/eigenvalue", HAFT_HDF_REAL, 1, four, p->eigenvalue);
    haft_hdf_read(hdf, "/chaos/eigenvector", HAFT_HDF_REAL, 2, four, p->eigenvector);
    haft_hdf_shape(hdf, "/chaos/centre", 2, centre);
    haft_hdf_shape(hdf, "/chaos/coefficient", 2, terms);
    if (hdf->status == HAFT_OK && (centre[1] != p->components || terms[1] != p->components)) {
        haft_hdf_refuse(hdf, "has arrays in /chaos that are not of %zu components", p->components);
    }
    if (hdf->status != HAFT_OK) {
        return;
    }
    p->m = centre[0];
    p->terms = terms[0];
    a->vector = haft_memory_alloc(p->m, sizeof *a->vector, hdf->error);
    a->centre = haft_memory_alloc(p->m * p->components, sizeof(double), hdf->error);
    a->coefficient = haft_memory_alloc(p->terms * p->components, sizeof(double), hdf->error);
    a->index = haft_memory_alloc(p->terms * p->components, sizeof *a->index, hdf->error);
    if (!a->vector || !a->centre || !a->coefficient || !a->index) {
        hdf->status = HAFT_ERROR_MEMORY;
        return;
    }
    haft_hdf_read_columns(hdf, "/chaos/vector", DIMENSION, haft_hdf_vector_columns, a->vector,
                          sizeof *a->vector, p->m);
    haft_hdf_read(hdf, "/chaos/centre", HAFT_HDF_REAL, 2, centre, a->centre);
    haft_hdf_read(hdf, "/chaos/coefficient", HAFT_HDF_REAL, 2, terms, a->coefficient);
    haft_hdf_read(hdf, "/chaos/index", HAFT_HDF_INT, 2, terms, a->index);
    int component[DIMENSION] = {0};
    haft_hdf_read(hdf, "/chaos/component_order", HAFT_HDF_INT, 1, &p->components, component);
    for (size_t i = 0; i < p->components; i++) {
        p->component_order[i] = component[i] < 0 ? DIMENSION : (size_t)component[i];
    }
}

void haft_laws_read_chaos(haft_hdf *hdf, haft_laws *laws) {
    haft_chaos_parts parts = {0};
    arrays a = {0};
    read_scalars(hdf, &parts);
    if (hdf->status == HAFT_OK) {
        read_arrays(hdf, &parts, &a);
    }
    if (hdf->status == HAFT_OK) {
        read_errors(hdf, &laws->errors, parts.components);
    }
    if (hdf->status == HAFT_OK) {
        parts.vector = a.vector;
        parts.centre = a.centre;
        parts.coefficient = a.coefficient;
        parts.index = a.index;
        haft_error own = {0};
        haft_status status = haft_chaos_create_from_parts(&laws->chaos, &parts, &own);
        if (status == HAFT_ERROR_INPUT) {
            haft_hdf_refuse(hdf, "has a model in /chaos that cannot be used: %.300s", own.message);
        } else if (status != HAFT_OK) {
            hdf->status = haft_error_set(hdf->error, status, "%s", own.message);
        }
    }
    free_arrays(&a);
}
