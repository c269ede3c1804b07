/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads results.h5 back. Opening the file verifies the checksum of the whole, so a caller that
 * reads many realizations opens it once. */
#include "hdf.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- the summary ---- */

static void check_summary(haft_hdf *hdf, const haft_results_view *view) {
    for (size_t k = 0; k < view->realizations; k++) {
        int outcome = view->summary[k].outcome;
        if (outcome < -1 || outcome >= HAFT_OUTCOMES) {
            haft_hdf_refuse(hdf, "has a status numbered %d, of realization %zu", outcome, k);
            return;
        }
    }
}

static void read_view(haft_hdf *hdf, haft_results_view *view) {
    haft_hdf_shape(hdf, "/summary/crack_length", 1, &view->realizations);
    if (hdf->status == HAFT_OK) {
        view->summary = haft_memory_alloc(view->realizations, sizeof *view->summary, hdf->error);
        hdf->status = view->summary == NULL ? HAFT_ERROR_MEMORY : HAFT_OK;
    }
    haft_hdf_read_columns(hdf, "/summary", haft_hdf_summary_column_count, haft_hdf_summary_columns,
                          view->summary, sizeof *view->summary, view->realizations);
    haft_hdf_read_text(hdf, "/", "case", &view->resolved_case);
    if (hdf->status == HAFT_OK) {
        check_summary(hdf, view);
    }
}

haft_status haft_results_read(haft_results_view **out, const char *path, haft_error *error) {
    *out = haft_memory_alloc(1, sizeof **out, error);
    if (*out == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    haft_hdf_voice voice = haft_hdf_hush();
    haft_hdf hdf;
    if (haft_hdf_open(&hdf, path, HAFT_HDF_RESULTS, error) == HAFT_OK) {
        read_view(&hdf, *out);
        (*out)->rewritten = hdf.rewritten;
        haft_hdf_close(&hdf);
    }
    haft_hdf_unhush(voice);
    if (hdf.status != HAFT_OK) {
        haft_results_view_destroy(out);
    }
    return hdf.status;
}

void haft_results_view_destroy(haft_results_view **view) {
    if (view != NULL && *view != NULL) {
        haft_memory_free((*view)->summary);
        haft_memory_free((*view)->resolved_case);
        haft_memory_free(*view);
        *view = NULL;
    }
}

/* ---- a path ---- */

static void read_rows(haft_hdf *hdf, const char *group, const char *first, size_t columns,
                      const haft_hdf_column *column, void **rows, size_t stride, size_t *n) {
    char name[128];
    snprintf(name, sizeof name, "%s/%s", group, first);
    haft_hdf_shape(hdf, name, 1, n);
    if (hdf->status != HAFT_OK) {
        return;
    }
    *rows = haft_memory_alloc(*n, stride, hdf->error);
    if (*rows == NULL) {
        hdf->status = HAFT_ERROR_MEMORY;
        return;
    }
    haft_hdf_read_columns(hdf, group, columns, column, *rows, stride, *n);
}

static void check_path(haft_hdf *hdf, const haft_path *path, uint64_t turn, uint64_t outcome) {
    if (outcome >= HAFT_OUTCOMES || (turn >= path->points && turn != 0)) {
        haft_hdf_refuse(hdf, "has a path that ends at no known outcome or turns beyond its end");
        return;
    }
    for (size_t i = 0; i < path->points; i++) {
        const haft_path_point *point = &path->point[i];
        if (point->jump < -1 || (point->jump >= 0 && (size_t)point->jump >= path->jumps)) {
            haft_hdf_refuse(hdf, "has a path whose point %zu names jump %d of %zu", i, point->jump,
                            path->jumps);
            return;
        }
    }
}

static void read_cost(haft_hdf *hdf, const char *root, haft_path_cost *cost) {
    struct {
        const char *name;
        size_t *field;
    } counts[] = {
        {"cost_steps", &cost->steps},
        {"cost_rejected", &cost->rejected},
        {"cost_newton_iterations", &cost->newton_iterations},
        {"cost_factorizations", &cost->factorizations},
        {"cost_solves", &cost->solves},
        {"cost_folds", &cost->folds},
        {"cost_flow_steps", &cost->flow_steps},
    };
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        uint64_t value = 0;
        haft_hdf_read_count(hdf, root, counts[i].name, &value);
        *counts[i].field = (size_t)value;
    }
}

static void read_path(haft_hdf *hdf, size_t realization, haft_path *path) {
    char root[64], group[80];
    uint64_t turn = 0, outcome = 0;
    snprintf(root, sizeof root, "/realizations/%zu", realization);
    if (hdf->status == HAFT_OK && !haft_hdf_has(hdf, root)) {
        hdf->status = haft_error_set(hdf->error, HAFT_ERROR_INPUT, "%s: holds no realization %zu",
                                     hdf->path, realization);
        return;
    }
    void *rows = NULL;
    snprintf(group, sizeof group, "%s/jumps", root);
    read_rows(hdf, group, "load", haft_hdf_jump_column_count, haft_hdf_jump_columns, &rows,
              sizeof *path->jump, &path->jumps);
    path->jump = rows;
    rows = NULL;
    snprintf(group, sizeof group, "%s/path", root);
    read_rows(hdf, group, "load", haft_hdf_point_column_count, haft_hdf_point_columns, &rows,
              sizeof *path->point, &path->points);
    path->point = rows;
    haft_hdf_read_count(hdf, root, "turn", &turn);
    haft_hdf_read_count(hdf, root, "outcome", &outcome);
    haft_hdf_read_real(hdf, root, "ledger_error", &path->ledger_error);
    read_cost(hdf, root, &path->cost);
    if (hdf->status == HAFT_OK) {
        path->point_capacity = path->points;
        path->jump_capacity = path->jumps;
        path->turn = (size_t)turn;
        path->outcome = (haft_outcome)outcome;
        check_path(hdf, path, turn, outcome);
    }
}

struct haft_results_file {
    haft_hdf hdf;
    char *path;
};

haft_status haft_results_open(haft_results_file **out, const char *path, haft_error *error) {
    size_t length = strlen(path);
    haft_results_file *file = *out = haft_memory_alloc(1, sizeof **out, error);
    if (file != NULL) {
        file->hdf.file = -1;
        file->path = haft_memory_alloc(length + 1, 1, error);
    }
    if (file == NULL || file->path == NULL) {
        haft_results_close(out);
        return HAFT_ERROR_MEMORY;
    }
    memcpy(file->path, path, length + 1);
    haft_hdf_voice voice = haft_hdf_hush();
    haft_status status = haft_hdf_open(&file->hdf, file->path, HAFT_HDF_RESULTS, error);
    haft_hdf_unhush(voice);
    if (status != HAFT_OK) {
        haft_results_close(out);
    }
    return status;
}

void haft_results_close(haft_results_file **file) {
    if (file != NULL && *file != NULL) {
        haft_hdf_voice voice = haft_hdf_hush();
        haft_hdf_close(&(*file)->hdf);
        haft_hdf_unhush(voice);
        haft_memory_free((*file)->path);
        haft_memory_free(*file);
        *file = NULL;
    }
}

haft_status haft_results_take_path(haft_path **out, haft_results_file *file, size_t realization,
                                   haft_error *error) {
    *out = haft_memory_alloc(1, sizeof **out, error);
    if (*out == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    haft_hdf_voice voice = haft_hdf_hush();
    file->hdf.status = HAFT_OK;
    file->hdf.error = error;
    read_path(&file->hdf, realization, *out);
    haft_hdf_unhush(voice);
    if (file->hdf.status != HAFT_OK) {
        haft_path_destroy(out);
    }
    return file->hdf.status;
}

haft_status haft_results_read_path(haft_path **out, const char *path, size_t realization,
                                   haft_error *error) {
    haft_results_file *file = NULL;
    *out = NULL;
    haft_status status = haft_results_open(&file, path, error);
    HAFT_THEN(status, haft_results_take_path(out, file, realization, error));
    haft_results_close(&file);
    return status;
}

/* ---- shapes ---- */

static void read_shapes(haft_hdf *hdf, size_t realization, haft_results_shapes *shapes) {
    char group[64], name[96];
    size_t dims[3];
    snprintf(group, sizeof group, "/realizations/%zu/evidence", realization);
    if (hdf->status == HAFT_OK && !haft_hdf_has(hdf, group)) {
        hdf->status = haft_error_set(hdf->error, HAFT_ERROR_INPUT,
                                     "%s: realization %zu left no evidence; ask for it with "
                                     "\"output: {evidence: [%zu]}\" in the case",
                                     hdf->path, realization, realization);
        return;
    }
    snprintf(name, sizeof name, "%s/displacement", group);
    haft_hdf_shape(hdf, name, 3, dims);
    if (hdf->status == HAFT_OK && (dims[2] != 2 || dims[1] == 0)) {
        haft_hdf_refuse(hdf, "has displacements that are not (w, rotation) of nodes");
    }
    if (hdf->status != HAFT_OK) {
        return;
    }
    size_t n = dims[0] * dims[1]; /* within the file's size: no overflow */
    shapes->points = dims[0];
    shapes->nodes = dims[1];
    shapes->node_x = haft_memory_alloc(dims[1], sizeof(double), hdf->error);
    shapes->deflection = haft_memory_alloc(n, sizeof(double), hdf->error);
    shapes->rotation = haft_memory_alloc(n, sizeof(double), hdf->error);
    double *both = haft_memory_alloc(n, 2 * sizeof(double), hdf->error);
    if (!shapes->node_x || !shapes->deflection || !shapes->rotation || !both) {
        hdf->status = HAFT_ERROR_MEMORY;
    } else {
        haft_hdf_read(hdf, name, HAFT_HDF_REAL, 3, dims, both);
        snprintf(name, sizeof name, "%s/node_x", group);
        haft_hdf_read(hdf, name, HAFT_HDF_REAL, 1, dims + 1, shapes->node_x);
        for (size_t i = 0; i < n; i++) {
            shapes->deflection[i] = both[2 * i];
            shapes->rotation[i] = both[2 * i + 1];
        }
    }
    haft_memory_free(both);
}

haft_status haft_results_read_shapes(haft_results_shapes **out, const char *path,
                                     size_t realization, haft_error *error) {
    *out = haft_memory_alloc(1, sizeof **out, error);
    if (*out == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    haft_hdf_voice voice = haft_hdf_hush();
    haft_hdf hdf;
    if (haft_hdf_open(&hdf, path, HAFT_HDF_RESULTS, error) == HAFT_OK) {
        read_shapes(&hdf, realization, *out);
        haft_hdf_close(&hdf);
    }
    haft_hdf_unhush(voice);
    if (hdf.status != HAFT_OK) {
        haft_results_shapes_destroy(out);
    }
    return hdf.status;
}

void haft_results_shapes_destroy(haft_results_shapes **shapes) {
    if (shapes != NULL && *shapes != NULL) {
        haft_memory_free((*shapes)->node_x);
        haft_memory_free((*shapes)->deflection);
        haft_memory_free((*shapes)->rotation);
        haft_memory_free(*shapes);
        *shapes = NULL;
    }
}
