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

/* Number of sites that are evaluated together, and the size of arrays for them: loops go on to a
 * multiple of the SIMD width. Most beams have one stretch. */
enum { HAFT_STRETCH = 256, HAFT_STRETCH_ROOM = HAFT_STRETCH + HAFT_SIMD_WIDTH };

/* A stretch of sites and its runs. The sites of a model's front may end within its last stretch. */
typedef struct haft_stretch {
    size_t first, sites, first_run, runs;
} haft_stretch;

static inline size_t haft_stretch_sites(const haft_model *model, const haft_stretch *s) {
    size_t left = model->data.sites - s->first;
    return s->sites < left ? s->sites : left;
}

/* Adjacent sites of a stretch that share their unknowns, or that have one unknown each. */
typedef struct haft_run {
    size_t first, sites;
    size_t alike; /* the first of sites with the same shapes; all such runs read its entries, which
                     stay in the first-level cache */
    bool shared;
    bool whole; /* its four unknowns are consecutive, and so are the entries of each */
} haft_run;

struct haft_layout {
    size_t runs, idle; /* runs of the active sites, followed by those of the inert ones */
    size_t stride;
    haft_stretch *stretch;
    haft_run *run;
    double *shape; /* HAFT_SPAN rows of `stride`: term k of site r at k stride + r [m] */
    double *area;  /* stride: [m^2], zero behind the model's last site, but not behind a front's */
    double *top;   /* stride: the largest |shape| of a site [m] */
    double *term;  /* HAFT_SPAN per site: the same, stored site by site */
    double *share; /* HAFT_SPAN^2 per site: products of its shapes, by columns of the Hessian */
    int *dof,
        *slot; /* of each site: its first unknown, and the place of that one's diagonal entry */
    size_t element_runs;
    size_t *element_run; /* the first element of each run of equal, adjacent elements */
};

/* Creates the layout of a model's sites, and sets the number of its stretches. */
haft_status haft_layout_create(haft_layout **out, size_t *stretches, const haft_model *model,
                               haft_error *error);
void haft_layout_destroy(haft_layout **layout);

/* Writes the first element of each run of equal elements into run[elements]. @return their
 * number */
size_t haft_strain_find_runs(const haft_model *model, size_t *run);

/* Strain energy of a state in units of energy. Adds its forces to the gradient; raises `largest`
 * to the largest force of an element; adds the change of the energy by rounding of each unknown,
 * in units of 2^-53, to `rounding`. All three may be NULL. */
double haft_strain(const haft_model *model, const double *u, double *gradient, double *largest,
                   double *rounding);

/* Displacements w[HAFT_STRETCH_ROOM] of a stretch's sites under v. The padding holds finite
 * numbers if v is finite. */
void haft_stretch_displacements(const haft_model *model, const haft_stretch *s, const double *v,
                                double *w);

/* Their gaps under u; in the padding, gaps at which all laws are zero. */
void haft_stretch_gaps(const haft_model *model, const haft_stretch *s, const double *u, double *d);

/* Adds the forces [1/m] along the displacements of a stretch's sites to the gradient, and their
 * stiffnesses [1/m^2] to the Hessian, both in units of energy; either may be NULL. Those of the
 * first `zeros` sites are zero. */
void haft_stretch_assemble(const haft_model *model, const haft_stretch *s, size_t zeros,
                           const double *force, const double *stiffness, double *gradient,
                           double *hessian);

/* The element that holds x, the later one at a node. */
size_t haft_beam_find_element(const double *node_x, size_t nodes, double x);

#endif
