/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The radial PSD of height maps: ring means of the windowed spectra, with missing pixels filled. */
#include "spectrum.h"

#include <math.h>

/* Modes are used up to the smaller of the map's Nyquist wave numbers. */
static double band_of(const haft_map *map) {
    return M_PI / fmax(map->step_row, map->step_column) * (1 + 1e-12);
}

/* A map with missing pixels is filled first. The drawn heights carry no information, so the map's
 * modes are weighted by the square of the known share of the window's weight. */
static haft_status enter_filled(haft_rings *r, const haft_map *map, haft_window window,
                                haft_error *error) {
    haft_map *filled = NULL;
    double known = 0, all = 0;
    for (size_t i = 0; i < map->rows; i++) {
        double across = haft_window_value(window, i, map->rows);
        for (size_t j = 0; j < map->columns; j++) {
            double w = across * haft_window_value(window, j, map->columns);
            all += w * w;
            known += isnan(map->z[i * map->columns + j]) ? 0 : w * w;
        }
    }
    haft_status status = haft_map_copy(&filled, map, error);
    HAFT_THEN(status, haft_map_fill(filled, error));
    if (status == HAFT_OK) {
        double share = known / all;
        status = haft_rings_enter(r, filled, window, band_of(map), share * share, error);
    }
    haft_map_destroy(&filled);
    return status;
}

haft_status haft_psd_estimate(haft_psd_table **out, size_t n, const haft_map *const *maps,
                              haft_window window, haft_error *error) {
    *out = NULL;
    double width = 0, most = 0;
    for (size_t k = 0; k < n; k++) {
        const haft_map *map = maps[k];
        double side =
            fmin((double)map->rows * map->step_row, (double)map->columns * map->step_column);
        width = fmax(width, 2 * M_PI / side);
        most = fmax(most, M_PI / fmax(map->step_row, map->step_column));
    }
    if (n == 0) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "a spectrum needs a map");
    }
    haft_rings r = {.n = 0};
    haft_status status = haft_rings_create(&r, width, most, error);
    for (size_t k = 0; k < n && status == HAFT_OK; k++) {
        status = haft_map_count_missing(maps[k]) > 0
                     ? enter_filled(&r, maps[k], window, error)
                     : haft_rings_enter(&r, maps[k], window, band_of(maps[k]), 1, error);
        if (status != HAFT_OK && n > 1) {
            haft_error_prefix(error, "map %zu: ", k);
        }
    }
    HAFT_THEN(status, haft_rings_to_table(out, &r, error));
    haft_rings_destroy(&r);
    return status;
}
