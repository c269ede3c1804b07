/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints the parameters of ISO 25178, and a map as the `surface` section of a case. */
#include "inspect_print.h"

#include <math.h>

static const char *const levels[] = {"mean", "plane", "quadratic", "lines"};
static const char *const windows[] = {"none", "hann", "welch", "blackman", "tukey"};
static const char *const treatments[] = {"exclude", "fill"};

/* ---- texture ---- */

static void print_decay(FILE *stream, const haft_map_texture *t) {
    if (isnan(t->sal)) {
        fprintf(stream,
                "    Sal, Str  -              the autocorrelation falls to %.1f nowhere "
                "within half the map\n",
                HAFT_TEXTURE_DECAY);
        return;
    }
    fprintf(stream, "    Sal   %12.4g nm  fastest decay of the autocorrelation to %.1f\n",
            t->sal * 1e9, HAFT_TEXTURE_DECAY);
    if (isinf(t->slowest)) {
        fprintf(stream,
                "    Str   below %.4g       Sal over the slowest decay, which is not "
                "reached within %.4g nm, half the map\n",
                t->sal / t->reach, t->reach * 1e9);
    } else {
        fprintf(stream, "    Str   %12.4g     Sal over the slowest decay, %.4g nm; 1: isotropic\n",
                t->str, t->slowest * 1e9);
    }
}

void inspect_print_texture(FILE *stream, const haft_map_texture *t) {
    fprintf(stream, "  by ISO 25178-2, about the mean, missing pixels left out\n");
    fprintf(stream, "    Sq    %12.4f nm  root mean square height\n", t->sq * 1e9);
    fprintf(stream, "    Sa    %12.4f nm  mean of |z|\n", t->sa * 1e9);
    fprintf(stream, "    Sz    %12.4f nm  highest peak Sp %.4f nm + deepest pit Sv %.4f nm\n",
            t->sz * 1e9, t->sp * 1e9, t->sv * 1e9);
    fprintf(stream, "    Ssk   %12.4f     skewness, mean of z^3/Sq^3; 0: normal\n", t->ssk);
    fprintf(stream, "    Sku   %12.4f     kurtosis, mean of z^4/Sq^4; 3: normal\n", t->sku);
    fprintf(stream, "    Sdq   %12.4g     root mean square slope, of neighbouring pixels\n",
            t->sdq);
    fprintf(stream, "    Sdr   %12.4g %%   area over its projection, less 1, by triangles\n",
            t->sdr * 100);
    print_decay(stream, t);
}

/* ---- surface section ---- */

double inspect_grid_step(double zeta_max) {
    static const double plain[] = {7.5, 6, 5, 4, 3, 2.5, 2, 1.5, 1};
    double most = M_PI / zeta_max * 1e9 * (1 + 1e-9), power = pow(10, floor(log10(most)));
    for (size_t i = 0; i < sizeof plain / sizeof *plain; i++) {
        if (plain[i] * power <= most) {
            return plain[i] * power * 1e-9;
        }
    }
    return power * 1e-9; /* not reached, since 1 always fits */
}

static haft_status print_texts(FILE *stream, const char *key, const char *const *text, size_t n,
                               bool list, haft_error *error) {
    haft_status status = HAFT_OK;
    fprintf(stream, "  %s: %s", key, list ? "[" : "");
    for (size_t k = 0; k < n && status == HAFT_OK; k++) {
        char *quoted = NULL;
        status = haft_case_quote(&quoted, text[k], error);
        if (status == HAFT_OK) {
            fprintf(stream, "%s%s", k > 0 ? ", " : "", quoted);
        }
        haft_memory_free(quoted);
    }
    fprintf(stream, "%s\n", list ? "]" : "");
    return status;
}

static void print_options(FILE *stream, const inspect_wishes *w) {
    const haft_map_options *o = &w->options;
    if (o->width > 0) {
        fprintf(stream, "  map_size: [%.15g um, %.15g um]\n", o->width * 1e6, o->height * 1e6);
    }
    if (o->unit > 0) {
        fprintf(stream, "  map_unit: %.15g nm\n", o->unit * 1e9);
    }
    if (o->lateral_unit > 0) {
        fprintf(stream, "  map_lateral_unit: %.15g um\n", o->lateral_unit * 1e6);
    }
    fprintf(stream, "  level: %s\n", levels[w->clean.level]);
    if (w->clean.outlier_limit > 0) {
        fprintf(stream, "  outliers: %.15g\n", w->clean.outlier_limit);
    }
    fprintf(stream, "  missing: %s\n  window: %s\n", treatments[w->clean.missing],
            windows[w->window]);
    if (w->tip_radius > 0) {
        fprintf(stream, "  tip_radius: %.15g nm\n", w->tip_radius * 1e9);
    }
}

/* Prints the fit as comments. To use it, remove the comment signs and the keys of the map. */
static void print_fit_form(FILE *stream, const haft_psd_fit *fit) {
    const haft_psd *p = &fit->psd;
    double hurst = haft_psd_get_hurst(p);
    fprintf(stream,
            "  # Its self-affine fit, in place of maps to tip_radius:\n  # zeta_max: %.6g rad/um\n"
            "  # zeta_0: %.6g rad/um\n  # s_0: %.6g nm^4\n  # s_1: %.6g nm^4\n",
            p->zeta_max * 1e-6, p->zeta_0 * 1e-6, p->s_0 * 1e36, p->s_1 * 1e36);
    if (hurst > 0 && hurst <= 1) {
        fprintf(stream,
                "  # or, in place of zeta_0, s_0 and s_1:\n  # rms: %.6g nm\n"
                "  # correlation_length: %.6g nm\n  # hurst: %.6g\n",
                sqrt(haft_psd_get_moments(p).m0) * 1e9, haft_psd_get_correlation_length(p) * 1e9,
                hurst);
    }
}

haft_status inspect_print_block(FILE *stream, const surface_block *b, haft_error *error) {
    fputs("surface:\n", stream);
    haft_status status = print_texts(stream, "maps", b->file, b->files, true, error);
    if (status == HAFT_OK && b->opposite_files > 0) {
        status = print_texts(stream, "opposite_maps", b->opposite, b->opposite_files, true, error);
    }
    if (status == HAFT_OK && b->channel[0] != '\0') {
        status = print_texts(stream, "channel", &b->channel, 1, false, error);
    }
    if (status != HAFT_OK) {
        return status;
    }
    print_options(stream, b->wishes);
    fprintf(stream, "  grid_step: %.10g nm\n", b->grid_step * 1e9);
    if (b->kernel_tolerance > 0) {
        fprintf(stream, "  kernel_tolerance: %.6g\n", b->kernel_tolerance);
    }
    if (b->fit != NULL) {
        print_fit_form(stream, b->fit);
    }
    return HAFT_OK;
}
