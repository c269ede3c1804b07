/* SPDX-License-Identifier: GPL-3.0-or-later */
/* laws.h5: m laws, the numbers of their patches, and the kept curves on n distances. The reader
 * checks everything: an accepted file has consistent shapes, an increasing grid and finite
 * forces. */
#include "hdf.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- writing ---- */

static void write_fault(haft_hdf *hdf, const haft_laws *laws) {
    _Static_assert(sizeof(haft_law_fault) == sizeof(int), "enums are ints");
    hsize_t dims[1] = {laws->m};
    char names[512] = "";
    size_t used = 0;
    for (int i = 0; i < HAFT_LAW_FAULTS && used < sizeof names; i++) {
        int n = snprintf(names + used, sizeof names - used, "%s%d %s", i > 0 ? ", " : "", i,
                         haft_law_fault_name((haft_law_fault)i));
        used += n < 0 ? 0 : (size_t)n;
    }
    haft_hdf_write(hdf, "/laws/fault", HAFT_HDF_INT, 1, dims, laws->fault, "1",
                   "why the curve has no law vector or no Morse law; see `names`");
    haft_hdf_write_text(hdf, "/laws/fault", "names", names);
}

static void write_curves(haft_hdf *hdf, const haft_laws *laws) {
    hsize_t dims[2] = {laws->curves, laws->n}, rows[1] = {laws->m};
    haft_hdf_write(hdf, "/curves/distance", HAFT_HDF_REAL, 1, dims + 1, laws->distance, "m",
                   "gap between the plane and the mean plane of the patch");
    haft_hdf_write(hdf, "/curves/force", HAFT_HDF_REAL, 2, dims, laws->force, "Pa",
                   "pressure of each patch at each distance, positive pushing apart");
    if (laws->curve_law != NULL) {
        haft_hdf_write(hdf, "/curves/law", HAFT_HDF_INT, 1, dims, laws->curve_law, "1",
                       "the law that a curve of /curves/force is of, from 0; the other curves are "
                       "not kept");
    }
    for (int i = 0; i < HAFT_LAWS_ROWS; i++) {
        const haft_laws_row *row = &haft_laws_rows[i];
        char path[64];
        snprintf(path, sizeof path, "/curves/%s", row->name);
        haft_hdf_write(hdf, path, HAFT_HDF_REAL, 1, rows, haft_laws_row_of(laws, row), row->unit,
                       row->description);
    }
}

static void write_laws(haft_hdf *hdf, const haft_laws *laws) {
    if (laws->n > 0) {
        write_curves(hdf, laws);
    }
    haft_hdf_write_columns(hdf, "/laws", HAFT_CHAOS_DIMENSION, haft_hdf_vector_columns,
                           laws->vector, sizeof *laws->vector, laws->m);
    write_fault(hdf, laws);
    haft_hdf_write_limit(hdf, "/laws", laws->f_limit);
    haft_hdf_write_count(hdf, "/laws", "sites", laws->sites);
    haft_hdf_write_count(hdf, "/laws", "first_site", laws->first_site);
    haft_hdf_write_text(hdf, "/laws", "order",
                        "law number j * sites + i is of site first_site + i of realization j, at x "
                        "= (first_site + i + 1/2) l_meso from the clamp; where there is a model, "
                        "the laws are those of the patches it was built from");
    haft_hdf_write_text(hdf, "/laws", "fitted_to", laws->origin);
    if (laws->chaos != NULL) {
        haft_laws_write_chaos(hdf, laws);
    }
}

haft_status haft_laws_write(const haft_laws *laws, const haft_case *c, const char *path,
                            haft_error *error) {
    char digest[HAFT_DIGEST_CAPACITY];
    if (laws->m == 0 || (laws->n == 0 && laws->chaos == NULL) || laws->sites == 0 ||
        laws->m % laws->sites != 0) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                              "%s: %zu laws of %zu points are no whole number of realizations of "
                              "%zu sites",
                              path, laws->m, laws->n, laws->sites);
    }
    haft_status status = haft_laws_identify(digest, c, laws->origin, error);
    haft_store store;
    HAFT_THEN(status, haft_store_open(&store, path, true, error));
    if (status != HAFT_OK) {
        return status;
    }
    haft_hdf_voice voice = haft_hdf_hush();
    haft_hdf hdf = {.file = -1, .path = path, .error = error};
    haft_hdf_begin(&hdf);
    haft_hdf_write_origin(&hdf, HAFT_HDF_LAWS, c, digest);
    write_laws(&hdf, laws);
    status = haft_hdf_store(&hdf, &store);
    haft_hdf_unhush(voice);
    return status;
}

/* ---- reading ---- */

static void check_curves(haft_hdf *hdf, const haft_laws *laws) {
    for (size_t i = 0; i < laws->n; i++) {
        if (!isfinite(laws->distance[i]) ||
            (i > 0 && !(laws->distance[i] > laws->distance[i - 1]))) {
            haft_hdf_refuse(hdf, "has distances that are not finite and rising, at %zu", i);
            return;
        }
    }
    for (size_t i = 0; i < laws->curves * laws->n; i++) {
        if (!isfinite(laws->force[i])) {
            haft_hdf_refuse(hdf, "has a force that is not finite, in curve %zu", i / laws->n);
            return;
        }
    }
    for (size_t i = 0; laws->curve_law != NULL && i < laws->curves; i++) {
        int law = laws->curve_law[i], before = i == 0 ? -1 : laws->curve_law[i - 1];
        if (law <= before || (size_t)law >= laws->m) {
            haft_hdf_refuse(hdf, "has curves in /curves/law that are not of rising laws, at %zu",
                            i);
            return;
        }
    }
    for (size_t j = 0; j < HAFT_LAWS_ROWS * laws->m; j++) {
        const haft_laws_row *row = &haft_laws_rows[j / laws->m];
        if (isinf(haft_laws_row_of(laws, row)[j % laws->m])) {
            haft_hdf_refuse(hdf, "has an infinite number in /curves/%s", row->name);
            return;
        }
    }
}

static void check_vectors(haft_hdf *hdf, const haft_laws *laws) {
    for (size_t i = 0; i < laws->m; i++) {
        const haft_law_vector *v = &laws->vector[i];
        int fault = (int)laws->fault[i];
        bool finite =
            isfinite(v->e) && isfinite(v->f_max) && isfinite(v->d_max) && isfinite(v->d_limit);
        if (fault < 0 || fault >= HAFT_LAW_FAULTS) {
            haft_hdf_refuse(hdf, "has a fault numbered %d in /laws/fault", fault);
            return;
        }
        if (fault == HAFT_LAW_SOUND && !finite) {
            haft_hdf_refuse(hdf, "has a sound law, number %zu, that is not finite", i);
            return;
        }
    }
}

static void read_curves(haft_hdf *hdf, haft_laws *laws) {
    size_t dims[2] = {laws->curves, laws->n};
    haft_hdf_read(hdf, "/curves/distance", HAFT_HDF_REAL, 1, dims + 1, laws->distance);
    haft_hdf_read(hdf, "/curves/force", HAFT_HDF_REAL, 2, dims, laws->force);
    if (laws->curve_law != NULL) {
        haft_hdf_read(hdf, "/curves/law", HAFT_HDF_INT, 1, dims, laws->curve_law);
    }
    for (int i = 0; i < HAFT_LAWS_ROWS; i++) {
        char path[64];
        snprintf(path, sizeof path, "/curves/%s", haft_laws_rows[i].name);
        haft_hdf_read(hdf, path, HAFT_HDF_REAL, 1, &laws->m,
                      haft_laws_row_of(laws, &haft_laws_rows[i]));
    }
}

/* Allocates the laws in the file. A model fitted only to vectors has no curves; if only some curves
 * were kept, /curves/law lists their laws. */
static void create_read(haft_hdf *hdf, haft_laws **out) {
    size_t curves[2] = {0, 0}, m = 0, kept = 0;
    haft_hdf_shape(hdf, "/laws/fault", 1, &m);
    if (hdf->status == HAFT_OK && (m == 0 || m > INT_MAX)) {
        haft_hdf_refuse(hdf, m == 0 ? "holds no laws" : "holds too many laws");
    }
    if (haft_hdf_has(hdf, "/curves/force") || !haft_hdf_has(hdf, "/chaos")) {
        haft_hdf_shape(hdf, "/curves/force", 2, curves);
        kept = m;
        if (haft_hdf_has(hdf, "/curves/law")) {
            haft_hdf_shape(hdf, "/curves/law", 1, &kept);
        }
        if (hdf->status == HAFT_OK && (curves[1] < 2 || curves[0] != kept || kept > m)) {
            haft_hdf_refuse(hdf, "holds %zu curves of %zu points for %zu laws", curves[0],
                            curves[1], m);
        }
    } else {
        kept = m;
    }
    if (hdf->status == HAFT_OK) {
        hdf->status = haft_laws_create_sparse(out, m, kept, curves[1], hdf->error);
    }
}

static void read_laws(haft_hdf *hdf, haft_laws **out) {
    uint64_t sites = 0, first = 0;
    create_read(hdf, out);
    if (hdf->status != HAFT_OK) {
        return;
    }
    haft_laws *laws = *out;
    size_t dims[1] = {laws->m};
    if (laws->n > 0) {
        read_curves(hdf, laws);
    }
    haft_hdf_read_columns(hdf, "/laws", HAFT_CHAOS_DIMENSION, haft_hdf_vector_columns, laws->vector,
                          sizeof *laws->vector, laws->m);
    haft_hdf_read(hdf, "/laws/fault", HAFT_HDF_INT, 1, dims, laws->fault);
    haft_hdf_read_limit(hdf, "/laws", &laws->f_limit);
    haft_hdf_read_count(hdf, "/laws", "sites", &sites);
    if (haft_hdf_has_attribute(hdf, "/laws", "first_site")) {
        haft_hdf_read_count(hdf, "/laws", "first_site", &first);
    }
    if (hdf->status != HAFT_OK) {
        return;
    }
    if (sites == 0 || sites > laws->m || laws->m % sites != 0) {
        haft_hdf_refuse(hdf, "has %zu laws, no whole number of realizations of %llu sites", laws->m,
                        (unsigned long long)sites);
    } else if (!isfinite(laws->f_limit) || laws->f_limit == 0) {
        haft_hdf_refuse(hdf, "has an f_limit that is not above 0");
    } else if (first > INT_MAX) {
        haft_hdf_refuse(hdf, "has a first site beyond all beams");
    }
    laws->sites = (size_t)sites;
    laws->first_site = (size_t)first;
    check_curves(hdf, laws);
    check_vectors(hdf, laws);
    if (hdf->status == HAFT_OK && haft_hdf_has(hdf, "/chaos")) {
        haft_laws_read_chaos(hdf, laws);
    }
}

/* Reads a digest from an attribute; with `empty`, it may be empty or absent. */
static void read_digest(haft_hdf *hdf, const char *object, const char *name, bool empty,
                        char digest[HAFT_DIGEST_CAPACITY]) {
    char *found = NULL;
    digest[0] = '\0';
    if (empty && hdf->status == HAFT_OK && !haft_hdf_has_attribute(hdf, object, name)) {
        return;
    }
    haft_hdf_read_text(hdf, object, name, &found);
    size_t length = found == NULL ? 0 : strlen(found);
    if (hdf->status == HAFT_OK && length != HAFT_DIGEST_CAPACITY - 1 && !(empty && length == 0)) {
        haft_hdf_refuse(hdf, "has a `%s` that is no digest", name);
    }
    if (hdf->status == HAFT_OK) {
        memcpy(digest, found, length + 1);
    }
    haft_memory_free(found);
}

haft_status haft_laws_identify(char digest[HAFT_DIGEST_CAPACITY], const haft_case *c,
                               const char *origin, haft_error *error) {
    haft_status status = haft_case_laws_digest(c, digest, error);
    if (status == HAFT_OK && origin[0] != '\0') {
        char both[2 * HAFT_DIGEST_CAPACITY];
        int size = snprintf(both, sizeof both, "%s%s", digest, origin);
        haft_digest_memory(both, (size_t)size, digest);
    }
    return status;
}

haft_status haft_laws_peek(char digest[HAFT_DIGEST_CAPACITY], char origin[HAFT_DIGEST_CAPACITY],
                           const char *path, haft_error *error) {
    haft_hdf_voice voice = haft_hdf_hush();
    haft_hdf hdf;
    if (haft_hdf_open(&hdf, path, HAFT_HDF_LAWS, error) == HAFT_OK) {
        read_digest(&hdf, "/", "laws_digest", false, digest);
        read_digest(&hdf, "/laws", "fitted_to", true, origin);
        haft_hdf_close(&hdf);
    }
    haft_hdf_unhush(voice);
    return hdf.status;
}

haft_status haft_laws_read(haft_laws **out, char digest[HAFT_DIGEST_CAPACITY], const char *path,
                           haft_error *error) {
    *out = NULL;
    haft_hdf_voice voice = haft_hdf_hush();
    haft_hdf hdf;
    char found[HAFT_DIGEST_CAPACITY];
    if (haft_hdf_open(&hdf, path, HAFT_HDF_LAWS, error) == HAFT_OK) {
        read_laws(&hdf, out);
        read_digest(&hdf, "/", "laws_digest", false, found);
        if (hdf.status == HAFT_OK) {
            read_digest(&hdf, "/laws", "fitted_to", true, (*out)->origin);
        }
        if (hdf.status == HAFT_OK && digest != NULL) {
            memcpy(digest, found, HAFT_DIGEST_CAPACITY);
        }
        haft_hdf_close(&hdf);
    }
    haft_hdf_unhush(voice);
    if (hdf.status != HAFT_OK) {
        haft_laws_destroy(out);
    }
    return hdf.status;
}
