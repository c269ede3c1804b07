/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Data of a case's surfaces: a piece of the first one, and its PSD beside the prescribed one
 * (Figs. 3 and 11 of Hoang et al., 2017). */
#include "sheet.h"

#include <math.h>

enum { MAP_POINTS = 300, SPECTRUM_LEAST = 16, SPECTRUM_MOST = 4096 }; /* points a side */
enum { ASKED_POINTS = 200 };

/* Side of the piece in the figure [m]. */
#define MAP_SIZE 6e-6

/* A ring of the measured PSD ends at most this far beyond its mean wave number: half its width
 * of a fortieth of a decade. */
static const double RING_REACH = 1.03;

typedef struct piece {
    size_t rows, columns; /* along the beam, across it */
    size_t stride;        /* every so many points carry the surface's shortest wave */
    double step;          /* [m] */
    double *z;            /* [rows][columns] */
} piece;

static haft_status generate_piece(piece *p, const haft_case *c, size_t patches, haft_error *error) {
    haft_surface_plan *plan = NULL;
    haft_surface_work *work = NULL;
    haft_status status = haft_study_surface_plan(&plan, c, patches, error);
    HAFT_THEN(status, haft_surface_work_create(&work, plan, error));
    HAFT_THEN(status, haft_surface_prepare(work, 0, 0, 0, error));
    HAFT_THEN(status, haft_surface_rows(work, 0, p->rows, p->z, error));
    haft_surface_work_destroy(&work);
    haft_surface_plan_destroy(&plan);
    return status;
}

/* A piece as wide as the beam and long enough for the figure and a spectrum, from the corner of
 * realization 0. For maps, whose waves are as short as their pixels, only the first patch. */
static haft_status draw_piece(piece *p, const haft_case *c, haft_error *error) {
    haft_tiling *tiling = NULL;
    HAFT_TRY(haft_study_tiling(&tiling, c, error));
    double step = c->surface.grid_step;
    size_t patch = (size_t)llround(c->mesh.l_meso / step), shown = (size_t)llround(MAP_SIZE / step);
    size_t ratio = tiling != NULL ? 1 : haft_surface_lattice_ratio(&c->surface.psd, step);
    *p = (piece){.columns = (size_t)llround(c->beam.width / step), .step = step};
    p->stride = ratio > 0 ? ratio : 1;
    size_t rows = shown > SPECTRUM_LEAST * p->stride ? shown : SPECTRUM_LEAST * p->stride;
    p->rows = tiling != NULL ? patch : rows;
    p->z = haft_memory_alloc(p->rows * p->columns, sizeof *p->z, error);
    haft_status status = p->z == NULL ? HAFT_ERROR_MEMORY : HAFT_OK;
    if (status == HAFT_OK && tiling != NULL) {
        haft_tiling_fill(tiling, 0, 0, p->z);
    } else if (status == HAFT_OK) {
        status = generate_piece(p, c, (rows + patch - 1) / patch, error);
    }
    haft_tiling_destroy(&tiling);
    return status;
}

/* A square from the piece's corner. */
static haft_status write_heights(const piece *p, const char *directory, haft_error *error) {
    static const char *const name[] = {"x [um]", "y [um]", "z [nm]"};
    haft_sheet t = {0};
    size_t shown = (size_t)llround(MAP_SIZE / p->step), side = p->rows < shown ? p->rows : shown;
    HAFT_TRY(haft_sheet_make(&t, (size_t)MAP_POINTS * MAP_POINTS, 3, error));
    for (size_t i = 0; i < MAP_POINTS; i++) {
        for (size_t j = 0; j < MAP_POINTS; j++) {
            size_t r = i * side / MAP_POINTS, s = j * side / MAP_POINTS;
            double *row = t.value + (i * MAP_POINTS + j) * 3;
            row[0] = (double)r * p->step * 1e6;
            row[1] = (double)s * p->step * 1e6;
            row[2] = s < p->columns ? p->z[r * p->columns + s] * 1e9 : NAN;
        }
    }
    haft_sheet_name(&t, name);
    return haft_sheet_write(&t, directory, "surface.csv", error);
}

static size_t points_kept(size_t n, size_t stride) {
    size_t kept = (n + stride - 1) / stride;
    return kept < SPECTRUM_MOST ? kept : SPECTRUM_MOST;
}

/* The piece's radial PSD; none, and no error, if it is too narrow. */
static haft_status measure(haft_psd_table **out, const piece *p, haft_error *error) {
    haft_map *map = NULL;
    size_t rows = points_kept(p->rows, p->stride), columns = points_kept(p->columns, p->stride);
    double step = (double)p->stride * p->step;
    if (rows < SPECTRUM_LEAST || columns < SPECTRUM_LEAST) {
        return HAFT_OK;
    }
    HAFT_TRY(haft_map_create(&map, rows, columns, step, step, error));
    for (size_t i = 0; i < rows; i++) {
        for (size_t j = 0; j < columns; j++) {
            map->z[i * columns + j] = p->z[p->stride * (i * p->columns + j)];
        }
    }
    const haft_map *const maps[] = {map};
    haft_status status = haft_psd_estimate(out, 1, maps, HAFT_WINDOW_HANN, error);
    haft_map_destroy(&map);
    return status;
}

static double asked(const haft_case *c, double zeta) {
    return c->surface.table != NULL ? haft_psd_table_value(c->surface.table, zeta)
                                    : haft_psd_value(&c->surface.psd, zeta);
}

/* The prescribed PSD, from a tenth of its roll-off, or from its first point, to its end. */
static haft_status write_asked(const haft_case *c, const haft_psd_table *measured,
                               const char *directory, haft_error *error) {
    static const char *const name[] = {"zeta [rad/um]", "s [nm^4]"};
    const haft_psd *psd = &c->surface.psd;
    double low = 0.1 * psd->zeta_0, most = psd->zeta_max;
    low = measured != NULL ? fmin(low, measured->zeta[0]) : low;
    haft_sheet t = {0};
    HAFT_TRY(haft_sheet_make(&t, ASKED_POINTS, 2, error));
    for (size_t i = 0; i < ASKED_POINTS; i++) {
        double share = (double)i / (ASKED_POINTS - 1);
        double zeta = i + 1 < ASKED_POINTS ? low * pow(most / low, share) : most;
        t.value[2 * i] = zeta * 1e-6;
        t.value[2 * i + 1] = asked(c, zeta) * 1e36;
    }
    haft_sheet_name(&t, name);
    return haft_sheet_write(&t, directory, "psd.csv", error);
}

/* The measured rings within the range of the prescribed PSD; one row of NaN if there are none. */
static haft_status write_rings(const haft_case *c, const haft_psd_table *measured,
                               const char *directory, haft_error *error) {
    static const char *const name[] = {"zeta [rad/um]", "s [nm^4]", "relative error",
                                       "asked [nm^4]"};
    haft_sheet t = {0};
    size_t n = 0;
    while (measured != NULL && n < measured->n &&
           measured->zeta[n] * RING_REACH < c->surface.psd.zeta_max) {
        n++;
    }
    HAFT_TRY(haft_sheet_make(&t, n > 0 ? n : 1, 4, error));
    for (size_t i = 0; i < t.rows; i++) {
        double *row = t.value + 4 * i;
        row[0] = n > 0 ? measured->zeta[i] * 1e-6 : NAN;
        row[1] = n > 0 ? measured->s[i] * 1e36 : NAN;
        row[2] = n > 0 ? 1 / sqrt(measured->count[i]) : NAN;
        row[3] = n > 0 ? asked(c, measured->zeta[i]) * 1e36 : NAN;
    }
    haft_sheet_name(&t, name);
    return haft_sheet_write(&t, directory, "rings.csv", error);
}

haft_status haft_study_write_surface(const haft_case *c, const char *directory, haft_error *error) {
    piece p = {0};
    haft_psd_table *measured = NULL;
    haft_status status = draw_piece(&p, c, error);
    HAFT_THEN(status, write_heights(&p, directory, error));
    HAFT_THEN(status, measure(&measured, &p, error));
    HAFT_THEN(status, write_asked(c, measured, directory, error));
    HAFT_THEN(status, write_rings(c, measured, directory, error));
    haft_psd_table_destroy(&measured);
    haft_memory_free(p.z);
    return status;
}
