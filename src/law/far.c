/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Adds the far field that laws share to what their near parts have. */
#include "law/far.h"

enum { CHUNK = 32 };

/* Up to CHUNK gaps. */
static void add_chunk(const haft_far_field *far, size_t n, const double *d,
                      const haft_law_values *out) {
    double energy[CHUNK], pressure[CHUNK], slope[CHUNK], curvature[CHUNK];
    bool force_alone = out->slope == NULL, bends = out->curvature != NULL;
    haft_far_field_evaluate(far, n, d,
                            &(haft_far_field_values){energy, pressure, force_alone ? NULL : slope,
                                                     bends ? curvature : NULL});
    for (size_t i = 0; i < n; i++) {
        out->force[i] -= pressure[i];
    }
    for (size_t i = 0; i < n && !force_alone; i++) {
        out->slope[i] -= slope[i];
        out->potential[i] += energy[i];
    }
    for (size_t i = 0; i < n && bends; i++) {
        out->curvature[i] -= curvature[i];
    }
}

static bool all_beyond(const haft_far_field *far, size_t n, const double *d) {
    while (n > 0 && d[n - 1] >= far->out) {
        n--;
    }
    return n == 0;
}

size_t haft_law_add_far(const haft_far_field *far, size_t n, const double *d,
                        const haft_law_values *out, size_t zeros) {
    size_t beyond = 0;
    while (beyond < n && d[beyond] >= far->out) {
        beyond++;
    }
    for (size_t i = beyond; i < n; i += CHUNK) {
        size_t some = n - i < CHUNK ? n - i : CHUNK;
        haft_law_values at = {out->force + i, out->slope != NULL ? out->slope + i : NULL,
                              out->curvature != NULL ? out->curvature + i : NULL,
                              out->potential != NULL ? out->potential + i : NULL};
        if (!all_beyond(far, some, d + i)) {
            add_chunk(far, some, d + i, &at);
        }
    }
    zeros = zeros < beyond ? zeros : beyond;
    return zeros < n ? zeros / HAFT_SIMD_WIDTH * HAFT_SIMD_WIDTH : n;
}
