/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The Rosenblatt map of the kernel density and its inverse, at one point and over a tensor grid,
 * where all points with the same first coordinates share one conditional distribution. */
#include <math.h>
#include <omp.h>

#include "chaos/model.h"

void haft_chaos_rosenblatt(const haft_chaos *chaos, haft_chaos_work *work, const double *eta,
                           double *xi, double *tail) {
    const haft_chaos_parts *p = &chaos->parts;
    double x[HAFT_CHAOS_DIMENSION];
    for (size_t i = 0; i < p->components; i++) {
        double above;
        x[i] = eta[p->component_order[i]];
        chaos_line line = haft_chaos_mixture_condition(&chaos->mixture, work, i, x);
        haft_chaos_line_cdf(&line, x[i], &xi[i], tail == NULL ? &above : &tail[i]);
    }
}

haft_status haft_chaos_inverse(const haft_chaos *chaos, haft_chaos_work *work, const double *xi,
                               const double *tail, double *eta, haft_error *error) {
    const haft_chaos_parts *p = &chaos->parts;
    double x[HAFT_CHAOS_DIMENSION];
    for (size_t i = 0; i < p->components; i++) {
        double above = tail == NULL ? 1 - xi[i] : tail[i];
        if (!(xi[i] >= HAFT_CHAOS_LEAST_TAIL && above >= HAFT_CHAOS_LEAST_TAIL && xi[i] <= 1 &&
              above <= 1)) {
            return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                                  "xi[%zu] = %.17g with tail %.17g; both must lie between 0 and 1",
                                  i, xi[i], above);
        }
        chaos_line line = haft_chaos_mixture_condition(&chaos->mixture, work, i, x);
        x[i] = haft_chaos_line_quantile(&line, xi[i], above);
        eta[p->component_order[i]] = x[i];
    }
    return HAFT_OK;
}

typedef struct grid {
    const haft_chaos *chaos;
    size_t points;
    double p[HAFT_CHAOS_POINTS_LIMIT], q[HAFT_CHAOS_POINTS_LIMIT];
    double *const *value;
} grid;

/* Coordinate i at the points below parent number `parent` of the level before. */
static void map_below(const grid *g, haft_chaos_work *work, size_t i, size_t parent) {
    double x[HAFT_CHAOS_DIMENSION];
    size_t ancestor = parent;
    for (size_t j = i; j-- > 0; ancestor /= g->points) {
        x[j] = g->value[j][ancestor];
    }
    chaos_line line = haft_chaos_mixture_condition(&g->chaos->mixture, work, i, x);
    for (size_t k = 0; k < g->points; k++) {
        g->value[i][parent * g->points + k] = haft_chaos_line_quantile(&line, g->p[k], g->q[k]);
    }
}

static void map_level(const grid *g, const chaos_workspaces *team, size_t i) {
    size_t parents = i == 0 ? 1 : haft_chaos_grid_size(g->points, i - 1);
#pragma omp parallel for schedule(dynamic, 4) num_threads(team->threads)
    for (size_t parent = 0; parent < parents; parent++) {
        map_below(g, team->work[omp_get_thread_num()], i, parent);
    }
}

haft_status haft_chaos_map_grid(const haft_chaos *chaos, size_t points,
                                double *const value[HAFT_CHAOS_DIMENSION], haft_error *error) {
    grid g = {.chaos = chaos, .points = points, .value = value};
    double x[HAFT_CHAOS_POINTS_LIMIT], weight[HAFT_CHAOS_POINTS_LIMIT];
    HAFT_TRY(haft_chaos_gauss(chaos->parts.germ, points, x, weight, error));
    for (size_t k = 0; k < points; k++) {
        haft_chaos_germ_cdf(chaos->parts.germ, x[k], &g.p[k], &g.q[k]);
    }
    chaos_workspaces team;
    haft_status status = haft_chaos_workspaces_init(&team, chaos, error);
    for (size_t i = 0; i < chaos->parts.components && status == HAFT_OK; i++) {
        map_level(&g, &team, i);
    }
    haft_chaos_workspaces_clear(&team);
    return status;
}

haft_status haft_chaos_workspaces_init(chaos_workspaces *team, const haft_chaos *chaos,
                                       haft_error *error) {
    *team = (chaos_workspaces){.threads = omp_get_max_threads()};
    team->work = haft_memory_alloc((size_t)team->threads, sizeof(haft_chaos_work *), error);
    haft_status status = team->work == NULL ? HAFT_ERROR_MEMORY : HAFT_OK;
    for (int i = 0; i < team->threads && status == HAFT_OK; i++) {
        status = haft_chaos_work_create(&team->work[i], chaos, error);
    }
    return status;
}

void haft_chaos_workspaces_clear(chaos_workspaces *team) {
    for (int i = 0; team->work != NULL && i < team->threads; i++) {
        haft_chaos_work_destroy(&team->work[i]);
    }
    haft_memory_free(team->work);
    *team = (chaos_workspaces){0};
}
