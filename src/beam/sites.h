/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sites and elements of a model laid out for vector code, private to the room. */
#ifndef HAFT_BEAM_SITES_H
#define HAFT_BEAM_SITES_H

#include "haft/beam.h"

typedef struct haft_layout haft_layout;

struct haft_model {
    haft_model_data data; /* first: see haft_model_get() */
    int *element_slot;    /* place of each of an element's 16 entries in the pattern, -1 if none */
    int *site_slot;       /* and of a site's */
    haft_layout *layout;  /* the sites once more, laid out for evaluation */
    size_t stretches;     /* into which the layout cuts those that take part */
    haft_model *shorter;  /* owned; see haft_model_shorter() */
};

static inline double larger(double a, double b) {
    return a > b ? a : b;
}

/* Sites that are evaluated together, all but the longest beams' at once, and the room that arrays
 * of them need: work is done in whole lanes, which may run over a stretch's end. */
enum { HAFT_STRETCH = 256, HAFT_STRETCH_ROOM = HAFT_STRETCH + HAFT_SIMD_WIDTH };

/* A stretch of sites, and which runs lie in it; of a model's front, whose sites may end within the
 * last, those up to there. */
typedef struct haft_stretch {
    size_t first, sites, first_run, runs;
} haft_stretch;

static inline size_t haft_stretch_sites(const haft_model *model, const haft_stretch *s) {
    size_t left = model->data.sites - s->first;
    return s->sites < left ? s->sites : left;
}

/* Neighbouring sites of a stretch that share their unknowns, or that have one unknown each. */
typedef struct haft_run {
    size_t first, sites;
    size_t alike; /* the first of as many sites of the same shapes, whose entries all such runs
                     read: they stay in the nearest cache */
    bool shared;
    bool whole; /* four unknowns in a row, so that each one's entries lie side by side */
} haft_run;

struct haft_layout {
    size_t runs, idle; /* of the sites that take part, and, after those, of the inert ones */
    size_t stride;
    haft_stretch *stretch;
    haft_run *run;
    double *shape; /* HAFT_SPAN rows of `stride`: term k of site r at k stride + r [m] */
    double *area;  /* stride: [m^2], zeros behind the model's last site, but not behind a front's */
    double *top;   /* stride: the greatest of a site's shapes in size [m] */
    double *term;  /* HAFT_SPAN a site: the same, a site's side by side */
    double *share; /* HAFT_SPAN^2 a site: products of its shapes, by columns of the Hessian */
    int *dof, *slot; /* of each site: its first unknown, and that one's place on the diagonal */
    size_t element_runs;
    size_t *element_run; /* the first elements of runs that are alike and lie side by side */
};

/* The layout of a model's sites; tells the number of its stretches. */
haft_status haft_layout_create(haft_layout **out, size_t *stretches, const haft_model *model,
                               haft_error *error);
void haft_layout_destroy(haft_layout **layout);

/* Puts the first elements of a model's runs into run[elements]. @return how many there are. */
size_t haft_strain_find_runs(const haft_model *model, size_t *run);

/* Strain energy of a state in units of energy; its forces are added to the gradient. With that,
 * takes the greatest of an element's forces into `largest`, and adds how much the energy moves as
 * each unknown is rounded, in units of 2^-53, to `rounding`. All three may be NULL. */
double haft_strain(const haft_model *model, const double *u, double *gradient, double *largest,
                   double *rounding);

/* Displacements w[HAFT_STRETCH_ROOM] of a stretch's sites under v; lanes beyond hold numbers of no
 * meaning, but finite where v is. */
void haft_stretch_displacements(const haft_model *model, const haft_stretch *s, const double *v,
                                double *w);

/* Their gaps under u; in lanes beyond, gaps at which all laws are zeros. */
void haft_stretch_gaps(const haft_model *model, const haft_stretch *s, const double *u, double *d);

/* Forces [1/m] along, and stiffnesses [1/m^2] against, the displacements of a stretch's sites, in
 * units of energy, into the sums; either sum may be NULL. The first `zeros` sites' are zeros. */
void haft_stretch_assemble(const haft_model *model, const haft_stretch *s, size_t zeros,
                           const double *force, const double *stiffness, double *gradient,
                           double *hessian);

/* The element that holds x, the later one at a node. */
size_t haft_beam_find_element(const double *node_x, size_t nodes, double x);

#endif
