/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws a finished run: the library writes the data as CSV, gnuplot draws the figures. */
#include "draw.h"

#include "against.h"
#include "gnuplot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DEFINITIONS_CAPACITY = 640, ROUGHNESS_CAPACITY = 128 };

typedef struct pen {
    const haft_case *c;
    const char *folder;
    char definitions[DEFINITIONS_CAPACITY];
} pen;

static haft_status draw_each(const pen *p, const char *const *figures, size_t count,
                             haft_error *error) {
    haft_status status = HAFT_OK;
    for (size_t i = 0; status == HAFT_OK && i < count; i++) {
        status = draw_script(figures[i], p->folder, p->c->title, p->definitions, error);
    }
    return status;
}

/* Defines the roughness of the PSD asked for: the standard deviations of heights [nm], slopes and
 * curvatures [1/um]. */
static void define_roughness(char out[ROUGHNESS_CAPACITY], const haft_case *c) {
    haft_psd_moments m = haft_case_moments(c);
    snprintf(out, ROUGHNESS_CAPACITY, "rms=%.9g; slope=%.9g; curvature=%.9g; ", sqrt(m.m0) * 1e9,
             sqrt(m.m2), sqrt(m.m4) * 1e-6);
}

static void take_pen(pen *p, const haft_case *c, const char *folder) {
    char roughness[ROUGHNESS_CAPACITY];
    define_roughness(roughness, c);
    p->c = c;
    p->folder = folder;
    snprintf(p->definitions, sizeof p->definitions,
             "%spaper=%.9g; measured=%.9g; beam_length=%.9g; gap=%.9g; load_position=%.9g; "
             "confidence=%.9g; order=%zu; germ=%d",
             roughness,
             isfinite(c->reference.paper_crack_length) ? c->reference.paper_crack_length * 1e6 : -1,
             isfinite(c->reference.measured_crack_length) ? c->reference.measured_crack_length * 1e6
                                                          : -1,
             c->beam.length * 1e6, c->beam.gap * 1e6, c->mesh.load_position * 1e6,
             c->stop.confidence, c->law.chaos.spec.order, (int)c->law.chaos.spec.germ);
}

static haft_status draw_path(const pen *p, haft_error *error) {
    static const char *const figures[] = {"surface", "psd",    "laws",     "shapes",
                                          "energy",  "cracks", "overview", "convergence"};
    size_t count = sizeof figures / sizeof *figures;
    count -= p->c->realizations < 3; /* too few beams to show convergence */
    return draw_each(p, figures, count, error);
}

/* Draws how the laws along a seamless surface correlate. */
static haft_status draw_correlation(const pen *p, const haft_laws *laws, haft_error *error) {
    static const char *const figure[] = {"correlation"};
    if (p->c->law.sampler != HAFT_SAMPLER_EXPLICIT || laws->sites < 2 || laws->m <= laws->sites) {
        return HAFT_OK;
    }
    haft_status status = haft_study_write_correlation(p->c, laws, p->folder, error);
    return status == HAFT_OK ? draw_each(p, figure, 1, error) : status;
}

static haft_status draw_model(const pen *p, const haft_laws *laws, haft_error *error) {
    static const char *const figures[] = {"generated", "reduction", "components",
                                          "marginals", "vectors",   "orders"};
    if (laws->chaos == NULL) {
        return HAFT_OK;
    }
    haft_status status = haft_study_write_model_figures(p->c, laws, p->folder, error);
    return status == HAFT_OK ? draw_each(p, figures, sizeof figures / sizeof *figures, error)
                             : status;
}

static haft_status draw_against(const pen *p, const char *reference, haft_error *error) {
    static const char *const figure[] = {"against"};
    char title[HAFT_TEXT_CAPACITY] = "";
    if (reference == NULL) {
        return HAFT_OK;
    }
    haft_status status = write_against(title, reference, p->folder, error);
    HAFT_THEN(status, give_text("HAFT_REFERENCE", title, error));
    return status == HAFT_OK ? draw_each(p, figure, 1, error) : status;
}

static haft_status draw_all(const haft_case *c, const haft_laws *laws, const char *folder,
                            const char *reference, haft_error *error) {
    pen p;
    take_pen(&p, c, folder);
    haft_status status = draw_path(&p, error);
    HAFT_THEN(status, draw_correlation(&p, laws, error));
    HAFT_THEN(status, draw_model(&p, laws, error));
    return status == HAFT_OK ? draw_against(&p, reference, error) : status;
}

/* The unit of the axis, and the factor that converts the swept values to it. */
static const char *axis_unit(const char *unit, double greatest, double *factor) {
    bool length = strcmp(unit, "m") == 0, micro = greatest >= 0.9999e-6;
    *factor = !length ? 1 : micro ? 1e6 : 1e9;
    return !length ? (strcmp(unit, "1") == 0 ? "" : unit) : micro ? "µm" : "nm";
}

/* Draws a surface that all variants have in common (Figs. 3 and 11 of the paper). Draws none if a
 * key of the surface is swept. */
static haft_status draw_shared_surface(const haft_case *c, const char *folder, haft_error *error) {
    for (size_t k = 0; k < c->sweep.keys; k++) {
        if (strncmp(c->sweep.key[k], "surface.", strlen("surface.")) == 0) {
            return HAFT_OK;
        }
    }
    char definitions[ROUGHNESS_CAPACITY];
    define_roughness(definitions, c);
    haft_status status = haft_study_write_surface(c, folder, error);
    HAFT_THEN(status, draw_script("surface", folder, c->title, definitions, error));
    return status == HAFT_OK ? draw_script("psd", folder, c->title, definitions, error) : status;
}

/* Draws a sweep over the humidity: Fig. 4b of the paper; and Fig. 21, or Fig. 20 if the forces are
 * swept too. */
static haft_status draw_humidity(const haft_case *c, const char *folder, const char *definitions,
                                 haft_error *error) {
    const struct haft_case_sweep *sweep = &c->sweep;
    if (strcmp(sweep->key[0], "contact.capillary.humidity") != 0) {
        return HAFT_OK;
    }
    bool forces = sweep->keys > 1 && strcmp(sweep->key[1], "contact.forces") == 0;
    haft_status status = haft_study_write_water(c, folder, error);
    HAFT_THEN(status, draw_script("water", folder, c->title, definitions, error));
    return status == HAFT_OK ? draw_script(forces ? "contributions" : "humidity", folder, c->title,
                                           definitions, error)
                             : status;
}

int draw_sweep(const haft_case *c, double greatest, const char *words, const char *case_folder,
               terminal *t) {
    haft_error error = {0};
    char folder[PATH_CAPACITY], definitions[512 + DRAW_WORDS_CAPACITY];
    haft_status status = make_out_folder(case_folder, "plots", &error);
    HAFT_THEN(status, case_out_path(folder, case_folder, "plots", &error));
    if (status == HAFT_OK) {
        double factor;
        const char *unit = axis_unit(c->sweep.unit[0], greatest, &factor);
        snprintf(
            definitions, sizeof definitions,
            "swept='%s'; swept_unit='%s'; swept_factor=%g; keys=%zu; paper=%.9g; "
            "measured=%.9g; confidence=%.9g; gamma_factor=%.9g; choices='%s'",
            haft_sweep_leaf(&c->sweep, 0), unit, factor, c->sweep.keys,
            isfinite(c->reference.paper_crack_length) ? c->reference.paper_crack_length * 1e6 : -1,
            isfinite(c->reference.measured_crack_length) ? c->reference.measured_crack_length * 1e6
                                                         : -1,
            c->stop.confidence,
            1.5e27 * c->beam.young_modulus * pow(c->beam.gap, 2) * pow(c->beam.thickness, 3),
            words);
        status = draw_script("sweep", folder, c->title, definitions, &error);
        HAFT_THEN(status, draw_shared_surface(c, folder, &error));
        HAFT_THEN(status, draw_humidity(c, folder, definitions, &error));
    }
    if (status != HAFT_OK) {
        return terminal_fail(t, status, &error);
    }
    if (!t->quiet) {
        terminal_print(stdout, "figures in %s", folder);
    }
    return EXIT_OK;
}

haft_status draw_comparison(const char *labels, size_t n, double confidence, const char *directory,
                            haft_error *error) {
    char definitions[128];
    if (setenv("HAFT_LABELS", labels, 1) != 0) {
        return haft_error_set(error, HAFT_ERROR_MEMORY, "out of memory for gnuplot");
    }
    snprintf(definitions, sizeof definitions, "cases=%zu; confidence=%.9g", n, confidence);
    return draw_script("compare", directory, "Crack lengths compared", definitions, error);
}

haft_status choose_realization(const haft_case *c, long asked, size_t *chosen, haft_error *error) {
    *chosen = asked >= 0 ? (size_t)asked : c->evidence.count > 0 ? c->evidence.realization[0] : 0;
    if (*chosen >= c->realizations) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "there is no realization %ld; the case has 0 to %zu", asked,
                              c->realizations - 1);
    }
    return HAFT_OK;
}

haft_status read_matching_laws(haft_laws **laws, char built[HAFT_DIGEST_CAPACITY],
                               const haft_case *c, const char *path, haft_error *error) {
    char wanted[HAFT_DIGEST_CAPACITY];
    haft_status status = haft_laws_read(laws, built, path, error);
    HAFT_THEN(status, haft_laws_identify(wanted, c, (*laws)->origin, error));
    if (status == HAFT_OK && strcmp(built, wanted) != 0) {
        status = haft_error_set(error, HAFT_ERROR_INPUT,
                                "%s was built from other inputs than the case has now; run the "
                                "case again with --force",
                                path);
    }
    return status;
}

int draw_case(const haft_case *c, const char *case_folder, long asked, const char *reference,
              terminal *t) {
    haft_error error = {0};
    char results[PATH_CAPACITY], laws_path[PATH_CAPACITY], folder[PATH_CAPACITY];
    char digest[HAFT_DIGEST_CAPACITY];
    haft_laws *laws = NULL;
    haft_results_view *view = NULL;
    size_t realization = 0;
    haft_status status = choose_realization(c, asked, &realization, &error);
    HAFT_THEN(status, case_out_path(results, case_folder, "results.h5", &error));
    HAFT_THEN(status, case_out_path(laws_path, case_folder, "laws.h5", &error));
    HAFT_THEN(status, case_out_path(folder, case_folder, "plots", &error));
    HAFT_THEN(status, read_matching_laws(&laws, digest, c, laws_path, &error));
    if (status == HAFT_OK) {
        status = read_results(&view, c, results, &error);
        haft_results_view_destroy(&view);
    }
    HAFT_THEN(status, make_out_folder(case_folder, "plots", &error));
    HAFT_THEN(status, haft_study_write_figures(c, laws, results, realization, folder, &error));
    HAFT_THEN(status, draw_all(c, laws, folder, reference, &error));
    haft_laws_destroy(&laws);
    if (status != HAFT_OK) {
        return terminal_fail(t, status, &error);
    }
    if (!t->quiet) {
        terminal_print(stdout, "figures in %s", folder);
    }
    return EXIT_OK;
}
