/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A path's landings against an oracle that knows nothing of folds or null vectors: it starts from
 * the last stable state before each jump, at the fold's load and a ten-millionth more. */
#ifndef HAFT_TEST_LANDINGS_H
#define HAFT_TEST_LANDINGS_H

#include "check.h"
#include "haft/solve.h"

/* Lets `u` come to rest at a load [N]. */
typedef void let_rest(void *oracle, double load, double *u);

/* How far apart two states' gaps are at most [m]. */
static inline double farthest_gap(const haft_model *m, const double *u, const double *v) {
    const haft_model_data *data = haft_model_get(m);
    double most = 0;
    for (size_t r = 0; r < data->sites; r++) {
        most = fmax(most, fabs(haft_model_displacement(&data->site[r], u) -
                               haft_model_displacement(&data->site[r], v)));
    }
    return most;
}

/* @return how many landings there were. */
static inline size_t check_landings_of(const haft_model *model, const haft_path *path,
                                       let_rest *rest, void *oracle, double *worst) {
    size_t n = haft_model_get(model)->dofs, jumps = 0;
    double *u = haft_memory_alloc(n, sizeof *u, NULL);
    for (size_t i = 1; i < path->points; i++) {
        const haft_path_point *p = &path->point[i];
        if (p->jump < 0) {
            continue;
        }
        memcpy(u, path->state + (i - 1) * n, n * sizeof *u);
        rest(oracle, p->load * (p->phase == 0 ? 1 + 1e-7 : 1 - 1e-7), u);
        double miss = farthest_gap(model, u, path->state + i * n);
        *worst = fmax(*worst, miss);
        check_less(miss, 1e-12); /* a thousandth of a law's range */
        jumps++;
    }
    haft_memory_free(u);
    return jumps;
}

#endif
