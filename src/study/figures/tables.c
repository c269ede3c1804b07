/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Summaries as CSV, for use without HDF5. */
#include "study/statistics/moments.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { CONVERGENCE_ROWS = 2000 };

haft_status haft_study_write_summary(const haft_summary *summary, size_t n, const char *path,
                                     haft_error *error) {
    enum { COLUMNS = 9 };
    double *flat = haft_memory_alloc(n * COLUMNS, sizeof *flat, error);
    if (flat == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    static const char *const name[COLUMNS] = {
        "realization",     "outcome",   "crack length [um]", "loaded crack length [um]",
        "Gamma [mJ/m2]",   "work [pJ]", "dissipated [pJ]",   "jumps",
        "ledger error [1]"};
    haft_csv_column column[COLUMNS];
    for (size_t k = 0; k < n; k++) {
        const haft_summary *s = &summary[k];
        double row[COLUMNS] = {
            (double)k,      s->outcome,     s->crack_length * 1e6, s->loaded_crack_length * 1e6,
            s->gamma * 1e3, s->work * 1e12, s->dissipated * 1e12,  s->jumps,
            s->ledger_error};
        for (int i = 0; i < COLUMNS; i++) {
            flat[k * COLUMNS + (size_t)i] = row[i];
        }
    }
    for (int i = 0; i < COLUMNS; i++) {
        column[i] = (haft_csv_column){name[i], flat + i, COLUMNS, 1};
    }
    haft_status status = haft_csv_write(path, n, COLUMNS, column, error);
    haft_memory_free(flat);
    return status;
}

/* One row for the first n beams: of all that were run, and of those that stuck. */
static void convergence_row(double row[8], size_t n, const haft_moments *moments,
                            double confidence) {
    double s = haft_moments_deviation(moments);
    haft_interval mean = haft_study_mean_interval(moments->mean, s, moments->n, confidence);
    haft_interval deviation = haft_study_deviation_interval(s, moments->n, confidence);
    double value[8] = {
        (double)n,           (double)moments->n,  moments->n > 0 ? moments->mean * 1e6 : NAN,
        mean.low * 1e6,      mean.high * 1e6,     s * 1e6,
        deviation.low * 1e6, deviation.high * 1e6};
    memcpy(row, value, sizeof value);
}

haft_status haft_study_write_convergence(const haft_case *c, const haft_summary *summary, size_t n,
                                         const char *path, haft_error *error) {
    enum { COLUMNS = 8 };
    static const char *const name[COLUMNS] = {
        "beams",          "stuck",          "mean [um]",          "mean low [um]",
        "mean high [um]", "deviation [um]", "deviation low [um]", "deviation high [um]"};
    double confidence = c->stop.confidence > 0 ? c->stop.confidence : HAFT_STUDY_CONFIDENCE;
    size_t stride = n / CONVERGENCE_ROWS + 1, rows = 0, run = 0;
    double *flat = haft_memory_alloc((n / stride + 2) * COLUMNS, sizeof *flat, error);
    if (flat == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    haft_moments moments = {0};
    for (size_t k = 0; k < n; k++) {
        if (summary[k].outcome >= 0) {
            haft_moments_add(&moments, &summary[k]);
            run++;
            if (run % stride == 0) {
                convergence_row(flat + COLUMNS * rows++, run, &moments, confidence);
            }
        }
    }
    if (run % stride != 0) {
        convergence_row(flat + COLUMNS * rows++, run, &moments, confidence);
    }
    haft_csv_column column[COLUMNS];
    for (int i = 0; i < COLUMNS; i++) {
        column[i] = (haft_csv_column){name[i], flat + i, COLUMNS, 1};
    }
    haft_status status = haft_csv_write(path, rows, COLUMNS, column, error);
    haft_memory_free(flat);
    return status;
}

haft_status haft_study_write_laws(const haft_laws *laws, const char *path, haft_error *error) {
    enum { COLUMNS = 11 };
    double *flat = haft_memory_alloc(laws->m * COLUMNS, sizeof *flat, error);
    if (flat == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    static const char *const name[COLUMNS] = {"realization",
                                              "site",
                                              "fault",
                                              "e [mJ/m2]",
                                              "f_max [MPa]",
                                              "d_max [nm]",
                                              "d_limit [nm]",
                                              "zero-force distance [nm]",
                                              "contact area [1]",
                                              "wet area [1]",
                                              "asperities in contact [1]"};
    haft_csv_column column[COLUMNS];
    for (size_t k = 0; k < laws->m; k++) {
        const haft_law_vector *v = &laws->vector[k];
        double row[COLUMNS] = {(double)(k / laws->sites),
                               (double)(laws->first_site + k % laws->sites),
                               laws->fault[k],
                               v->e * 1e3,
                               v->f_max * 1e-6,
                               v->d_max * 1e9,
                               v->d_limit * 1e9,
                               laws->zero_distance[k] * 1e9,
                               laws->contact_area[k],
                               laws->wet_area[k],
                               laws->asperities[k]};
        for (int i = 0; i < COLUMNS; i++) {
            flat[k * COLUMNS + (size_t)i] = row[i];
        }
    }
    for (int i = 0; i < COLUMNS; i++) {
        column[i] = (haft_csv_column){name[i], flat + i, COLUMNS, 1};
    }
    haft_status status = haft_csv_write(path, laws->m, COLUMNS, column, error);
    haft_memory_free(flat);
    return status;
}

haft_status haft_study_write_sample(const haft_laws *laws, const haft_case *c, size_t n,
                                    const char *path, haft_error *error) {
    enum { COLUMNS = 4 };
    _Static_assert(sizeof(haft_law_vector) == COLUMNS * sizeof(double), "a vector is its columns");
    haft_law_vector *vector = haft_memory_alloc(n, sizeof *vector, error);
    if (vector == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    haft_status status = haft_study_draw(laws, c, 0, n, vector, error);
    if (status == HAFT_OK) {
        haft_csv_column column[COLUMNS] = {{"e [mJ/m2]", &vector->e, COLUMNS, 1e3},
                                           {"f_max [MPa]", &vector->f_max, COLUMNS, 1e-6},
                                           {"d_max [nm]", &vector->d_max, COLUMNS, 1e9},
                                           {"d_limit [nm]", &vector->d_limit, COLUMNS, 1e9}};
        status = haft_csv_write(path, n, COLUMNS, column, error);
    }
    haft_memory_free(vector);
    return status;
}

haft_status haft_study_write_sweep(const haft_variant *variant, size_t variants, const char *path,
                                   haft_error *error) {
    enum { FACTS = 23, COLUMNS = 1 + HAFT_SWEPT_KEYS_MAX + FACTS };
    static const char *const fact[FACTS] = {"run",
                                            "stuck",
                                            "free",
                                            "failed",
                                            "mean [um]",
                                            "mean low [um]",
                                            "mean high [um]",
                                            "deviation [um]",
                                            "Gamma [mJ/m2]",
                                            "internal energy [pJ]",
                                            "dissipated [pJ]",
                                            "jumps",
                                            "seconds",
                                            "end influence [1]",
                                            "ledger error [1]",
                                            "paper [um]",
                                            "measured [um]",
                                            "standard error [um]",
                                            "free share [1]",
                                            "over paper [1]",
                                            "over measured [1]",
                                            "quantile 5 % [um]",
                                            "quantile 95 % [um]"};
    const struct haft_case_sweep *sweep = &variant[0].c->sweep;
    size_t columns = 1 + sweep->keys + FACTS;
    char name[HAFT_SWEPT_KEYS_MAX][HAFT_LABEL_CAPACITY];
    haft_csv_column column[COLUMNS];
    double *flat = haft_memory_alloc(variants * columns, sizeof *flat, error);
    if (flat == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    for (size_t j = 0; j < columns; j++) {
        column[j] = (haft_csv_column){"variant", flat + j, columns, 1};
        if (j > 0 && j <= sweep->keys) {
            snprintf(name[j - 1], sizeof name[j - 1], "%s [%s]", sweep->key[j - 1],
                     sweep->unit[j - 1]);
            column[j].name = name[j - 1];
        } else if (j > 0) {
            column[j].name = fact[j - 1 - sweep->keys];
        }
    }
    for (size_t i = 0; i < variants; i++) {
        const haft_statistics *s = &variant[i].statistics;
        double *row = flat + i * columns;
        double facts[FACTS] = {(double)s->run,
                               (double)s->stuck,
                               (double)s->free,
                               (double)s->failed,
                               s->mean * 1e6,
                               s->mean_interval.low * 1e6,
                               s->mean_interval.high * 1e6,
                               s->deviation * 1e6,
                               s->gamma * 1e3,
                               s->internal_energy * 1e12,
                               s->dissipated * 1e12,
                               s->jumps,
                               s->seconds,
                               s->end_influence,
                               s->ledger_error,
                               variant[i].c->reference.paper_crack_length * 1e6,
                               variant[i].c->reference.measured_crack_length * 1e6,
                               s->standard_error * 1e6,
                               1 - s->stuck_share,
                               s->mean / variant[i].c->reference.paper_crack_length - 1,
                               s->mean / variant[i].c->reference.measured_crack_length - 1,
                               s->quantile[0] * 1e6,
                               s->quantile[HAFT_STUDY_QUANTILES - 1] * 1e6};
        row[0] = (double)i;
        memcpy(row + 1, variant[i].c->sweep.value, sweep->keys * sizeof *row);
        memcpy(row + 1 + sweep->keys, facts, sizeof facts);
    }
    haft_status status = haft_csv_write(path, variants, columns, column, error);
    haft_memory_free(flat);
    return status;
}
