/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes results.h5, realization by realization. It grows in memory and is stored whole at the end.
 * Its temporary file is made at the start, so that a folder that is not writable is reported before
 * the work, not after it. */
#include "hdf.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

struct haft_results {
    haft_hdf hdf;
    haft_store store;
    char *path;
    haft_case c; /* a copy with its own evidence */
    haft_summary *summary;
    bool *added;
};

static void release(haft_results *results) {
    haft_memory_free(results->path);
    haft_memory_free(results->c.evidence.realization);
    haft_memory_free(results->summary);
    haft_memory_free(results->added);
    haft_memory_free(results);
}

static haft_status copy_inputs(haft_results *results, const char *path, const haft_case *c,
                               haft_error *error) {
    size_t count = c->evidence.count, length = strlen(path);
    results->c = *c;
    results->c.evidence.realization = haft_memory_alloc(count, sizeof(size_t), error);
    results->path = haft_memory_alloc(length + 1, 1, error);
    results->summary = haft_memory_alloc(c->realizations, sizeof *results->summary, error);
    results->added = haft_memory_alloc(c->realizations, sizeof *results->added, error);
    if (results->c.evidence.realization == NULL || results->path == NULL ||
        results->summary == NULL || results->added == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    memcpy(results->path, path, length + 1);
    if (count > 0) {
        memcpy(results->c.evidence.realization, c->evidence.realization, count * sizeof(size_t));
    }
    for (size_t k = 0; k < c->realizations; k++) {
        results->summary[k] = (haft_summary){.crack_length = NAN,
                                             .loaded_crack_length = NAN,
                                             .gamma = NAN,
                                             .work = NAN,
                                             .dissipated = NAN,
                                             .ledger_error = NAN,
                                             .seconds = NAN,
                                             .outcome = -1,
                                             .jumps = -1,
                                             .steps = -1,
                                             .unfit = -1};
    }
    return HAFT_OK;
}

haft_status haft_results_create(haft_results **out, const char *path, const haft_case *c,
                                const char *laws_digest, bool overwrite, haft_error *error) {
    *out = NULL;
    haft_results *results = haft_memory_alloc(1, sizeof *results, error);
    if (results == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    results->hdf.file = -1;
    results->store.descriptor = -1;
    haft_status status = copy_inputs(results, path, c, error);
    HAFT_THEN(status, haft_store_open(&results->store, path, overwrite, error));
    if (status == HAFT_OK) {
        haft_hdf_voice voice = haft_hdf_hush();
        results->hdf = (haft_hdf){.file = -1, .path = results->path, .error = error};
        haft_hdf_begin(&results->hdf);
        haft_hdf_write_origin(&results->hdf, HAFT_HDF_RESULTS, c, laws_digest);
        status = results->hdf.status;
        results->hdf.error = NULL;
        haft_hdf_unhush(voice);
    }
    if (status != HAFT_OK) {
        haft_results_abandon(&results);
        return status;
    }
    *out = results;
    return HAFT_OK;
}

void haft_results_abandon(haft_results **results) {
    if (results == NULL || *results == NULL) {
        return;
    }
    haft_hdf_voice voice = haft_hdf_hush();
    haft_hdf_drop(&(*results)->hdf);
    haft_hdf_unhush(voice);
    haft_store_abandon(&(*results)->store);
    release(*results);
    *results = NULL;
}

/* ---- a path ---- */

static void write_path(haft_hdf *hdf, size_t realization, const haft_path *path) {
    char root[64], group[80];
    snprintf(root, sizeof root, "/realizations/%zu", realization);
    snprintf(group, sizeof group, "%s/path", root);
    haft_hdf_write_columns(hdf, group, haft_hdf_point_column_count, haft_hdf_point_columns,
                           path->point, sizeof *path->point, path->points);
    snprintf(group, sizeof group, "%s/jumps", root);
    haft_hdf_write_columns(hdf, group, haft_hdf_jump_column_count, haft_hdf_jump_columns,
                           path->jump, sizeof *path->jump, path->jumps);
    haft_hdf_write_count(hdf, root, "turn", path->turn);
    haft_hdf_write_count(hdf, root, "outcome", (uint64_t)path->outcome);
    haft_hdf_write_text(hdf, root, "outcome_name", haft_outcome_name(path->outcome));
    haft_hdf_write_real(hdf, root, "ledger_error", path->ledger_error);
    haft_hdf_write_count(hdf, root, "cost_steps", path->cost.steps);
    haft_hdf_write_count(hdf, root, "cost_rejected", path->cost.rejected);
    haft_hdf_write_count(hdf, root, "cost_newton_iterations", path->cost.newton_iterations);
    haft_hdf_write_count(hdf, root, "cost_factorizations", path->cost.factorizations);
    haft_hdf_write_count(hdf, root, "cost_solves", path->cost.solves);
    haft_hdf_write_count(hdf, root, "cost_folds", path->cost.folds);
    haft_hdf_write_count(hdf, root, "cost_flow_steps", path->cost.flow_steps);
}

/* ---- evidence ---- */

/* The data of each site that an independent program needs. */
typedef struct site_row {
    double x, area;
    haft_law_vector vector;
    int kind;
} site_row;
static const haft_hdf_column site_columns[] = {
    {"site_x", HAFT_HDF_REAL, offsetof(site_row, x), "m", "position of a contact site"},
    {"site_area", HAFT_HDF_REAL, offsetof(site_row, area), "m^2", "area a site stands for"},
    {"e", HAFT_HDF_REAL, offsetof(site_row, vector.e), "J/m^2",
     "energy of its law's attractive part; NaN where the curve has none"},
    {"f_max", HAFT_HDF_REAL, offsetof(site_row, vector.f_max), "Pa", "its greatest pull"},
    {"d_max", HAFT_HDF_REAL, offsetof(site_row, vector.d_max), "m", "gap of the greatest pull"},
    {"d_limit", HAFT_HDF_REAL, offsetof(site_row, vector.d_limit), "m",
     "gap at which the push reaches f_limit"},
    {"law_kind", HAFT_HDF_INT, offsetof(site_row, kind), "1",
     "0 Morse law of (e, f_max, d_max, d_limit), 1 the curve itself as a monotone table"},
};

static void write_sites(haft_hdf *hdf, const char *group, const haft_model_data *model,
                        const haft_law *laws, const haft_law_vector *vectors) {
    site_row *row = haft_memory_alloc(model->sites, sizeof *row, hdf->error);
    if (row == NULL) {
        hdf->status = HAFT_ERROR_MEMORY;
        return;
    }
    for (size_t r = 0; r < model->sites; r++) {
        row[r] = (site_row){.x = model->site[r].x,
                            .area = model->site[r].area,
                            .vector = vectors[r],
                            .kind = (int)laws[r].kind};
    }
    haft_hdf_write_columns(hdf, group, sizeof site_columns / sizeof *site_columns, site_columns,
                           row, sizeof *row, model->sites);
    haft_memory_free(row);
}

/* The far field that all laws share, where they have one: as it is evaluated. */
static void write_far_field(haft_hdf *hdf, const char *group, const haft_far_field *far) {
    char name[96];
    hsize_t terms[1] = {HAFT_FAR_FIELD_TERMS};
    snprintf(name, sizeof name, "%s/far_field", group);
    haft_hdf_write(hdf, name, HAFT_HDF_REAL, 1, terms, far->coefficient, "J/m^2",
                   "c_j of the energy U that adds to every law's, with its pull dU/dd: U(d) = "
                   "t^3 sum_j c_j u^j, t = s/(s + d) - s/(s + d_out), u = far_stretch t - 1, s = "
                   "far_scale, d_out = far_out; 0 beyond d_out; below far_first the pull goes on "
                   "along its tangent");
    haft_hdf_write_real(hdf, group, "far_first", far->first);
    haft_hdf_write_real(hdf, group, "far_out", far->out);
    haft_hdf_write_real(hdf, group, "far_scale", far->scale);
    haft_hdf_write_real(hdf, group, "far_stretch", far->stretch);
}

/* (w, rotation) of every node in every state; node 0 is the clamp and has no unknowns. */
static void write_displacement(haft_hdf *hdf, const char *name, const haft_path *path,
                               const haft_model_data *model) {
    hsize_t dims[3] = {path->points, model->nodes, 2};
    size_t row = 2 * model->nodes, size = 0;
    if (__builtin_mul_overflow(path->points, row, &size)) {
        size = SIZE_MAX;
    }
    double *value = haft_memory_alloc(size, sizeof *value, hdf->error);
    if (value == NULL) {
        hdf->status = HAFT_ERROR_MEMORY;
        return;
    }
    for (size_t p = 0; p < path->points; p++) {
        for (size_t i = 0; i < model->dofs; i++) {
            value[p * row + 2 + i] = model->scale[i] * path->state[p * model->dofs + i];
        }
    }
    haft_hdf_write(hdf, name, HAFT_HDF_REAL, 3, dims, value, "m, rad",
                   "(w, dw/dx) of each node in each accepted state; w is positive towards the "
                   "substrate, so that the gap of a site is d = gap - w(x); between nodes w is "
                   "the cubic of its end values (Hermite)");
    haft_memory_free(value);
}

static void write_evidence(haft_results *results, size_t realization, const haft_path *path,
                           const haft_model_data *model, const haft_law *laws,
                           const haft_law_vector *vectors) {
    haft_hdf *hdf = &results->hdf;
    const haft_case *c = &results->c;
    char group[64], name[96];
    snprintf(group, sizeof group, "/realizations/%zu/evidence", realization);
    write_sites(hdf, group, model, laws, vectors);
    hsize_t nodes[1] = {model->nodes};
    snprintf(name, sizeof name, "%s/node_x", group);
    haft_hdf_write(hdf, name, HAFT_HDF_REAL, 1, nodes, model->node_x, "m",
                   "position of a node; the first is the clamp");
    static const haft_hdf_column load_column = {"load", HAFT_HDF_REAL,
                                                offsetof(haft_path_point, load), "N",
                                                "load P of each accepted state"};
    haft_hdf_write_columns(hdf, group, 1, &load_column, path->point, sizeof *path->point,
                           path->points);
    snprintf(name, sizeof name, "%s/displacement", group);
    if (hdf->status == HAFT_OK) {
        write_displacement(hdf, name, path, model);
    }
    if (model->sites > 0 && laws[0].far != NULL) {
        write_far_field(hdf, group, laws[0].far);
    }
    haft_hdf_write_real(hdf, group, "gap", model->gap);
    haft_hdf_write_limit(hdf, group, haft_case_limit(c));
    haft_hdf_write_real(hdf, group, "bending_stiffness", haft_beam_bending_stiffness(&c->beam));
    haft_hdf_write_real(hdf, group, "load_position", model->load.x);
    haft_hdf_write_text(
        hdf, group, "convention",
        "SI units; gap, load_position [m], f_limit in f_limit_unit, bending_stiffness "
        "[N m^2]; w positive towards the substrate; gap of a site d = gap - w; "
        "pressure positive pushing apart; load positive towards the substrate");
}

static haft_status check_addition(const haft_results *results, size_t realization,
                                  const haft_path *path, const haft_model_data *model,
                                  haft_error *error) {
    if (realization >= results->c.realizations || results->added[realization]) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                              "%s: realization %zu was added before or is not one of %zu",
                              results->path, realization, results->c.realizations);
    }
    /* a beam without any state has none to keep, and is still a result */
    bool lost = path->state == NULL && path->points > 0;
    if (haft_case_wants_evidence(&results->c, realization) &&
        (lost || model->nodes == 0 || model->dofs != 2 * (model->nodes - 1))) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                              "%s: realization %zu shall leave evidence, but its states were not "
                              "kept or its structure is no clamped beam",
                              results->path, realization);
    }
    return HAFT_OK;
}

haft_status haft_results_add(haft_results *results, size_t realization, const haft_path *path,
                             const haft_model_data *model, const haft_law *laws,
                             const haft_law_vector *vectors, const haft_summary *summary,
                             haft_error *error) {
    HAFT_TRY(check_addition(results, realization, path, model, error));
    haft_hdf_voice voice = haft_hdf_hush();
    haft_hdf *hdf = &results->hdf;
    hdf->error = error;
    if (hdf->status != HAFT_OK) {
        haft_error_set(error, hdf->status, "%s: an earlier realization could not be added",
                       results->path);
    }
    write_path(hdf, realization, path);
    if (hdf->status == HAFT_OK && haft_case_wants_evidence(&results->c, realization)) {
        write_evidence(results, realization, path, model, laws, vectors);
    }
    if (hdf->status == HAFT_OK) {
        results->summary[realization] = *summary;
        results->added[realization] = true;
    }
    hdf->error = NULL;
    haft_hdf_unhush(voice);
    return hdf->status;
}

/* ---- the end ---- */

static void write_summary(haft_hdf *hdf, const haft_results *results) {
    haft_hdf_write_columns(hdf, "/summary", haft_hdf_summary_column_count, haft_hdf_summary_columns,
                           results->summary, sizeof *results->summary, results->c.realizations);
    char names[2048] = "-1 never computed";
    size_t used = strlen(names);
    for (int i = 0; i < HAFT_OUTCOMES && used < sizeof names; i++) {
        int n = snprintf(names + used, sizeof names - used, ", %d %s", i,
                         haft_outcome_name((haft_outcome)i));
        used += n < 0 ? 0 : (size_t)n;
    }
    haft_hdf_write_text(hdf, "/summary/status", "names", names);
}

haft_status haft_results_finish(haft_results **results, haft_error *error) {
    haft_results *r = *results;
    haft_hdf_voice voice = haft_hdf_hush();
    r->hdf.error = error;
    if (r->hdf.status != HAFT_OK) {
        haft_error_set(error, r->hdf.status, "%s: a realization could not be added", r->path);
    }
    write_summary(&r->hdf, r);
    haft_status status = haft_hdf_store(&r->hdf, &r->store);
    haft_hdf_unhush(voice);
    release(r);
    *results = NULL;
    return status;
}
