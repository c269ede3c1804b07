/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a case's surfaces look like: a piece of the first one, and its PSD beside the one asked for
 * (Figs. 3 and 11 of Hoang et al., 2017). */
#include "sheet.h"

#include <math.h>
#include <string.h>

enum { MAP_POINTS = 300, SPECTRUM_MOST = 4096 }; /* points a side */

/* Side of the piece that is shown [m]. */
#define MAP_SIZE 6e-6

/* A ring of the measured PSD reaches at most so far beyond its mean wave number: half its width of
 * a fortieth of a decade. */
static const double RING_REACH = 1.03;

typedef struct piece {
    size_t rows, columns; /* along the beam, across it */
    double step;          /* [m] */
    double *z;            /* [rows][columns] */
} piece;

static haft_status generate_piece(piece *p, const haft_case *c, size_t patches, haft_error *error) {
    haft_surface_plan *plan = NULL;
    haft_surface_work *work = NULL;
    haft_status status = haft_study_surface_plan(&plan, c, patches, error);
    if (status == HAFT_OK) {
        status = haft_surface_work_create(&work, plan, error);
    }
    if (status == HAFT_OK) {
        status = haft_surface_prepare(work, 0, 0, 0, error);
    }
    if (status == HAFT_OK) {
        status = haft_surface_rows(work, 0, p->rows, p->z, error);
    }
    haft_surface_work_destroy(&work);
    haft_surface_plan_destroy(&plan);
    return status;
}

/* As long as is shown and as wide as the beam, from realization 0's corner; of maps its first patch
 * alone. */
static haft_status draw_piece(piece *p, const haft_case *c, haft_error *error) {
    haft_tiling *tiling = NULL;
    double step = c->surface.grid_step;
    size_t patch = (size_t)llround(c->mesh.l_meso / step), shown = (size_t)llround(MAP_SIZE / step);
    size_t patches = (shown + patch - 1) / patch;
    haft_status status = haft_study_tiling(&tiling, c, error);
    if (status != HAFT_OK) {
        return status;
    }
    *p = (piece){tiling != NULL ? patch : shown, (size_t)llround(c->beam.width / step), step, NULL};
    p->z = haft_memory_alloc(p->rows * p->columns, sizeof *p->z, error);
    status = p->z == NULL ? HAFT_ERROR_MEMORY : HAFT_OK;
    if (status == HAFT_OK && tiling != NULL) {
        haft_tiling_fill(tiling, 0, 0, p->z);
    } else if (status == HAFT_OK) {
        status = generate_piece(p, c, patches, error);
    }
    haft_tiling_destroy(&tiling);
    return status;
}

/* A square from the piece's corner. */
static haft_status write_heights(const piece *p, const char *directory, haft_error *error) {
    static const char *const name[] = {"x [um]", "y [um]", "z [nm]"};
    haft_sheet t = {0};
    size_t shown = (size_t)llround(MAP_SIZE / p->step), side = p->rows < shown ? p->rows : shown;
    haft_status status = haft_sheet_make(&t, (size_t)MAP_POINTS * MAP_POINTS, 3, error);
    if (status != HAFT_OK) {
        return status;
    }
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

/* The piece's radial PSD, of every so many points as still carry its shortest wave. */
static haft_status measure(haft_psd_table **out, const piece *p, const haft_case *c,
                           haft_error *error) {
    haft_map *map = NULL;
    size_t stride = haft_surface_lattice_ratio(&c->surface.psd, p->step);
    stride = stride > 0 ? stride : 1;
    double step = (double)stride * p->step;
    haft_status status = haft_map_create(&map, points_kept(p->rows, stride),
                                         points_kept(p->columns, stride), step, step, error);
    if (status != HAFT_OK) {
        return status;
    }
    for (size_t i = 0; i < map->rows; i++) {
        for (size_t j = 0; j < map->columns; j++) {
            map->z[i * map->columns + j] = p->z[stride * (i * p->columns + j)];
        }
    }
    const haft_map *const maps[] = {map};
    status = haft_psd_estimate(out, 1, maps, HAFT_WINDOW_HANN, error);
    haft_map_destroy(&map);
    return status;
}

static double asked(const haft_case *c, double zeta) {
    return c->surface.table != NULL ? haft_psd_table_value(c->surface.table, zeta)
                                    : haft_psd_value(&c->surface.psd, zeta);
}

/* A row a ring, and one at the shortest wave, which no ring inside reaches. */
static haft_status write_spectrum(const haft_psd_table *measured, const haft_case *c,
                                  const char *directory, haft_error *error) {
    static const char *const name[] = {"zeta [rad/um]", "asked [nm^4]", "measured [nm^4]",
                                       "relative error"};
    haft_sheet t = {0};
    double most = c->surface.psd.zeta_max;
    size_t n = 0;
    while (n < measured->n && measured->zeta[n] * RING_REACH < most) {
        n++;
    }
    haft_status status = haft_sheet_make(&t, n + 1, 4, error);
    if (status != HAFT_OK) {
        return status;
    }
    for (size_t i = 0; i <= n; i++) {
        double zeta = i < n ? measured->zeta[i] : most, *row = t.value + 4 * i;
        row[0] = zeta * 1e-6;
        row[1] = asked(c, zeta) * 1e36;
        row[2] = i < n ? measured->s[i] * 1e36 : NAN;
        row[3] = i < n ? 1 / sqrt(measured->count[i]) : NAN;
    }
    haft_sheet_name(&t, name);
    return haft_sheet_write(&t, directory, "psd.csv", error);
}

haft_status haft_study_write_surface(const haft_case *c, const char *directory, haft_error *error) {
    piece p = {0};
    haft_psd_table *measured = NULL;
    haft_status status = draw_piece(&p, c, error);
    if (status == HAFT_OK) {
        status = write_heights(&p, directory, error);
    }
    if (status == HAFT_OK) {
        status = measure(&measured, &p, c, error);
    }
    if (status == HAFT_OK) {
        status = write_spectrum(measured, c, directory, error);
    }
    haft_psd_table_destroy(&measured);
    haft_memory_free(p.z);
    return status;
}
