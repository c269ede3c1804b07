/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The data of a case's figures, as CSV that any plotting program reads. */
#include "sheet.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CURVES = 10, SHAPES = 14, SHAPE_POINTS = 401 };

/* The laws in the figure and their curves, NULL if they were not kept. */
typedef struct shown {
    size_t count, index[CURVES]; /* of the site, or of the model's patch */
    const double *curve[CURVES];
    haft_law law[CURVES];
    haft_law_vector vector[CURVES];
} shown;

/* Laws of sites of the first realization, spread over the part of the beam that has laws. */
static void show_sites(shown *s, const haft_case *c, const haft_site_laws *sites,
                       const haft_laws *laws) {
    bool drawn = haft_study_draws_patches(c);
    size_t first = haft_study_first_site(c);
    size_t n = sites->sites - first;
    s->count = n < CURVES ? n : CURVES;
    for (size_t k = 0; k < s->count; k++) {
        s->index[k] = first + k * n / s->count;
        s->curve[k] =
            haft_laws_curve(laws, drawn ? haft_chaos_draw_patch(c->seed, 0, s->index[k], laws->m)
                                        : s->index[k] - laws->first_site);
        s->law[k] = sites->law[s->index[k]];
        s->vector[k] = sites->vector[s->index[k]];
    }
}

/* Sound laws among those that a model was built from. */
static void show_patches(shown *s, const haft_case *c, const haft_laws *laws) {
    s->count = 0;
    for (size_t k = 0; k < CURVES; k++) {
        size_t i = k * laws->m / CURVES, end = (k + 1) * laws->m / CURVES;
        while (i < end && laws->fault[i] != HAFT_LAW_SOUND) {
            i++;
        }
        if (i < end &&
            haft_law_morse(&s->law[s->count], &laws->vector[i], laws->f_limit) == HAFT_LAW_SOUND) {
            s->law[s->count].far = c->contact.far;
            s->vector[s->count] = laws->vector[i];
            s->curve[s->count] = haft_laws_curve(laws, i);
            s->index[s->count++] = i;
        }
    }
}

/* Curves and their laws; laws replace curves that were not kept. */
static haft_status write_curves(const haft_case *c, const haft_laws *laws, const shown *s,
                                const char *directory, haft_error *error) {
    enum { GRID = 221 };
    size_t columns = 1 + 2 * s->count, n = laws->n > 0 ? laws->n : GRID;
    double span = c->contact.distance_to - c->contact.distance_from;
    char(*name)[32] = haft_memory_alloc(columns, sizeof *name, error);
    haft_sheet t = {0};
    haft_status status = name == NULL ? HAFT_ERROR_MEMORY : haft_sheet_make(&t, n, columns, error);
    for (size_t i = 0; status == HAFT_OK && i < n; i++) {
        double *row = t.value + i * columns;
        double d = laws->n > 0 ? laws->distance[i]
                               : c->contact.distance_from + span * (double)i / (double)(n - 1);
        double pull = 0; /* curves are without the far field */
        if (c->contact.far != NULL) {
            haft_far_field_evaluate(c->contact.far, 1, &d,
                                    &(haft_far_field_values){.pressure = &pull});
        }
        row[0] = d * 1e9;
        for (size_t k = 0; k < s->count; k++) {
            double law = haft_law_evaluate(&s->law[k], d).force;
            row[1 + 2 * k] = (s->curve[k] != NULL ? s->curve[k][i] - pull : law) * 1e-6;
            row[2 + 2 * k] = law * 1e-6;
        }
    }
    if (status == HAFT_OK) {
        t.column[0].name = "distance [nm]";
        for (size_t k = 0; k < s->count; k++) {
            snprintf(name[1 + 2 * k], sizeof *name, "curve %zu [MPa]", s->index[k]);
            snprintf(name[2 + 2 * k], sizeof *name, "law %zu [MPa]", s->index[k]);
            t.column[1 + 2 * k].name = name[1 + 2 * k];
            t.column[2 + 2 * k].name = name[2 + 2 * k];
        }
        status = haft_sheet_write(&t, directory, "laws.csv", error);
    }
    haft_memory_free(name);
    return status;
}

/* The numbers of those curves' laws; NaN where a curve has none. */
static haft_status write_vectors(const haft_laws *laws, const shown *s, const char *directory,
                                 haft_error *error) {
    static const char *const name[] = {"site",       "Morse",        "e [mJ/m2]",    "f_max [MPa]",
                                       "d_max [nm]", "d_limit [nm]", "f_limit [MPa]"};
    haft_sheet t = {0};
    HAFT_TRY(haft_sheet_make(&t, s->count, 7, error));
    for (size_t k = 0; k < s->count; k++) {
        const haft_law_vector *v = &s->vector[k];
        double row[7] = {(double)s->index[k],
                         s->law[k].kind == HAFT_LAW_MORSE,
                         v->e * 1e3,
                         v->f_max * 1e-6,
                         v->d_max * 1e9,
                         v->d_limit * 1e9,
                         haft_law_limit(laws->f_limit, v->f_max) * 1e-6};
        memcpy(t.value + k * 7, row, sizeof row);
    }
    haft_sheet_name(&t, name);
    return haft_sheet_write(&t, directory, "vectors.csv", error);
}

/* Ten curves with the laws that the solver or the model uses. */
static haft_status write_laws(const haft_case *c, const haft_laws *laws, const char *directory,
                              haft_error *error) {
    haft_site_laws *sites = NULL;
    haft_status status = HAFT_OK;
    shown s = {0};
    if (laws->chaos != NULL) {
        show_patches(&s, c, laws);
    } else {
        haft_case own = *c;
        own.law.unfit = HAFT_UNFIT_TABLE;
        status = haft_study_site_laws(&sites, &own, laws, 0, error);
        if (status == HAFT_OK) {
            show_sites(&s, c, sites, laws);
        }
    }
    HAFT_THEN(status, write_curves(c, laws, &s, directory, error));
    HAFT_THEN(status, write_vectors(laws, &s, directory, error));
    haft_site_laws_destroy(&sites);
    return status;
}

/* Deflection at x by the Hermite shape between two nodes. */
static double shape_at(const haft_results_shapes *s, size_t point, double x) {
    const double *w = s->deflection + point * s->nodes, *r = s->rotation + point * s->nodes;
    size_t e = 0;
    while (e + 2 < s->nodes && s->node_x[e + 1] <= x) {
        e++;
    }
    double l = s->node_x[e + 1] - s->node_x[e], t = (x - s->node_x[e]) / l;
    double t2 = t * t, t3 = t2 * t;
    return (1 - 3 * t2 + 2 * t3) * w[e] + l * (t - 2 * t2 + t3) * r[e] +
           (3 * t2 - 2 * t3) * w[e + 1] + l * (t3 - t2) * r[e + 1];
}

/* The first state after the jump between two points that moved the crack most; 0 if none. */
static size_t find_greatest_jump(const haft_path *path, size_t from, size_t to) {
    size_t found = 0;
    double greatest = 0;
    for (size_t i = from + 1; i <= to; i++) {
        double moved = fabs(path->point[i].crack_length - path->point[i - 1].crack_length);
        if (path->point[i].jump >= 0 && moved > greatest) {
            greatest = moved;
            found = i;
        }
    }
    return found;
}

/* Chooses up to SHAPES accepted states between two points, including both, evenly in the
 * deflection of the load point; adds the two states before and after the largest jump. */
static size_t choose_states(const haft_path *path, size_t from, size_t to, size_t landed,
                            size_t chosen[SHAPES + 2]) {
    double start = path->point[from].deflection, span = path->point[to].deflection - start;
    size_t n = 0, even = 0;
    for (size_t i = from; i <= to; i++) {
        double share = span != 0 ? (path->point[i].deflection - start) / span : 1;
        bool due = even + 1 < SHAPES && share * (SHAPES - 1) >= (double)even - 1e-9;
        even += due || i == to;
        if (due || i == to || (landed > 0 && (i == landed || i + 1 == landed))) {
            chosen[n++] = i;
        }
    }
    return n;
}

static void fill_shape(double *row, const haft_case *c, const haft_path_point *p,
                       const haft_results_shapes *s, size_t point, const double label[3]) {
    for (size_t i = 0; i < SHAPE_POINTS; i++, row += 7) {
        double x = c->beam.length * (double)i / (SHAPE_POINTS - 1);
        double height = (c->beam.gap - shape_at(s, point, x)) * 1e6;
        double value[7] = {label[0],      label[1], p->crack_length * 1e6, x * 1e6, height,
                           p->load * 1e6, label[2]};
        memcpy(row, value, sizeof value);
    }
}

/* Heights above the substrate, SHAPE_POINTS rows per state. */
static haft_status write_shapes(const haft_case *c, const haft_path *path,
                                const haft_results_shapes *s, const char *directory,
                                haft_error *error) {
    static const char *const name[] = {"phase",       "state",     "crack length [um]", "x [um]",
                                       "height [um]", "load [uN]", "at greatest jump"};
    size_t chosen[2 * (SHAPES + 2)], last = path->points - 1;
    size_t landed[2] = {find_greatest_jump(path, 0, path->turn),
                        find_greatest_jump(path, path->turn, last)};
    size_t loading = choose_states(path, 0, path->turn, landed[0], chosen);
    size_t n = loading + choose_states(path, path->turn, last, landed[1], chosen + loading);
    haft_sheet t = {0};
    HAFT_TRY(haft_sheet_make(&t, n * SHAPE_POINTS, 7, error));
    for (size_t k = 0; k < n; k++) {
        bool unloading = k >= loading;
        size_t jump = landed[unloading];
        /* 1 just before the jump, 2 just after, else 0 */
        double mark = jump == 0 ? 0 : chosen[k] + 1 == jump ? 1 : chosen[k] == jump ? 2 : 0;
        double label[3] = {unloading, (double)(unloading ? k - loading : k), mark};
        fill_shape(t.value + k * SHAPE_POINTS * 7, c, &path->point[chosen[k]], s, chosen[k], label);
    }
    haft_sheet_name(&t, name);
    return haft_sheet_write(&t, directory, "shapes.csv", error);
}

/* The accepted states, and before each landing the fold, so that curves of branches reach their
 * ends. */
static haft_status write_energy(const haft_path *path, const char *directory, haft_error *error) {
    static const char *const name[] = {"phase", "jump", "load [uN]", "crack length [um]",
                                       "internal energy [pJ]"};
    size_t rows = path->points;
    for (size_t i = 0; i < path->points; i++) {
        rows += path->point[i].jump >= 0;
    }
    haft_sheet t = {0};
    HAFT_TRY(haft_sheet_make(&t, rows, 5, error));
    double *row = t.value;
    for (size_t i = 0; i < path->points; i++) {
        const haft_path_point *p = &path->point[i];
        if (p->jump >= 0) {
            const haft_jump *j = &path->jump[p->jump];
            double fold[5] = {j->phase, -1, j->load * 1e6, j->crack_before * 1e6,
                              j->internal_before * 1e12};
            memcpy(row, fold, sizeof fold);
            row += 5;
        }
        double state[5] = {p->phase, p->jump, p->load * 1e6, p->crack_length * 1e6,
                           p->internal_energy * 1e12};
        memcpy(row, state, sizeof state);
        row += 5;
    }
    haft_sheet_name(&t, name);
    return haft_sheet_write(&t, directory, "energy.csv", error);
}

enum { JUMP_COLUMNS = 10 };

static haft_status write_jumps(const haft_path *path, const char *directory, haft_error *error) {
    haft_sheet t = {0};
    HAFT_TRY(haft_sheet_make(&t, path->jumps, JUMP_COLUMNS, error));
    for (size_t i = 0; i < path->jumps; i++) {
        const haft_jump *j = &path->jump[i];
        double row[JUMP_COLUMNS] = {j->phase,
                                    j->kind == HAFT_JUMP_PULL_IN ? 0 : 1,
                                    j->load * 1e6,
                                    j->crack_before * 1e6,
                                    j->crack_after * 1e6,
                                    j->internal_before * 1e12,
                                    j->internal_after * 1e12,
                                    j->dissipated * 1e12,
                                    j->site,
                                    j->sites_switched};
        memcpy(t.value + i * JUMP_COLUMNS, row, sizeof row);
    }
    static const char *const name[] = {"phase",
                                       "pull-out",
                                       "load [uN]",
                                       "crack before [um]",
                                       "crack after [um]",
                                       "internal energy before [pJ]",
                                       "internal energy after [pJ]",
                                       "dissipated [pJ]",
                                       "site",
                                       "sites switched"};
    haft_sheet_name(&t, name);
    return haft_sheet_write(&t, directory, "jumps.csv", error);
}

static haft_status write_path(const haft_case *c, const haft_laws *laws, const char *results_path,
                              size_t realization, const char *directory, haft_error *error) {
    haft_path *path = NULL;
    haft_results_shapes *shapes = NULL;
    haft_status status = haft_results_read_path(&path, results_path, realization, error);
    if (status == HAFT_OK && path->points == 0) {
        status = haft_error_set(error, HAFT_ERROR_INPUT,
                                "%s: realization %zu found no state (%s), so there is nothing to "
                                "draw; choose another realization",
                                results_path, realization, haft_outcome_name(path->outcome));
    }
    HAFT_THEN(status, haft_study_shapes(&shapes, c, laws, results_path, realization, error));
    if (status == HAFT_OK && shapes->points != path->points) {
        status = haft_error_set(error, HAFT_ERROR_INPUT,
                                "%s: realization %zu holds %zu points and %zu shapes; run the "
                                "case again with --force",
                                results_path, realization, path->points, shapes->points);
    }
    HAFT_THEN(status, write_shapes(c, path, shapes, directory, error));
    HAFT_THEN(status, write_energy(path, directory, error));
    HAFT_THEN(status, write_jumps(path, directory, error));
    haft_results_shapes_destroy(&shapes);
    haft_path_destroy(&path);
    return status;
}

haft_status haft_study_write_figures(const haft_case *c, const haft_laws *laws,
                                     const char *results_path, size_t realization,
                                     const char *directory, haft_error *error) {
    HAFT_TRY(haft_study_write_surface(c, directory, error));
    HAFT_TRY(write_laws(c, laws, directory, error));
    return write_path(c, laws, results_path, realization, directory, error);
}
