/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random beams for the stress of the solver. Each is a function of a seed and an index alone; its
 * family says which hard kind it is sure to have. */
#ifndef HAFT_TEST_STRESS_BEAMS_H
#define HAFT_TEST_STRESS_BEAMS_H

#include "haft/solve.h"
#include "stress_curves.h"

typedef enum stress_family {
    STRESS_MEASURED, /* laws that scatter as measured ones do */
    STRESS_WIDE,     /* Morse laws over decades, each site its own */
    STRESS_FAR,      /* the gap is 1e4 to 1e6 ranges */
    STRESS_FELT,     /* laws are felt at rest */
    STRESS_TABLES,   /* tables of one shape */
    STRESS_PUSHING,  /* tables whose outermost part pushes */
    STRESS_STRAIGHT, /* linear laws and thin walls */
    STRESS_ALIKE,    /* one law at all sites, which are few */
    STRESS_DECADES,  /* all shapes in one beam, six decades of force */
    STRESS_APART,    /* out of reach altogether */
    STRESS_BESIDE,   /* the load almost on a site */
    STRESS_CANCELS,  /* tables whose wall holds nearly all of the energy */
    STRESS_FAMILIES
} stress_family;

static inline const char *stress_family_name(stress_family family) {
    static const char *const name[STRESS_FAMILIES] = {
        "measured",           "wide Morse",    "far gap", "felt at rest", "tables",
        "pushes last",        "straight laws", "alike",   "six decades",  "out of reach",
        "load beside a site", "great walls"};
    return name[family];
}

typedef struct stress_beam {
    uint64_t seed, index;
    stress_family family;
    stress_shape shape; /* of its laws, where it is one */
    haft_beam_spec spec;
    size_t sites;
    double load_position, active_from;
    haft_programme programme;
    size_t laws;
    stress_law *law; /* laws, owned */
    size_t *law_of;  /* sites */
    haft_law *given; /* sites: the library's */
} stress_beam;

static inline const stress_law *stress_beam_law(const stress_beam *b, size_t site) {
    return &b->law[b->law_of[site]];
}

static inline double stress_site_x(const stress_beam *b, size_t site) {
    return b->spec.length * ((double)site + 0.5) / (double)b->sites;
}

/* The mesh of a kind; the uniform one has a node at each site and, unlike the exact one, halfway
 * between. */
static inline haft_mesh_spec stress_beam_mesh(const stress_beam *b, haft_mesh_kind kind) {
    double pitch = b->spec.length / (double)b->sites;
    return (haft_mesh_spec){kind, 0.5 * pitch, pitch, b->load_position, b->active_from};
}

static inline void stress_draw_shape(stress_beam *b, stress_stream *s) {
    double length = stress_decades(s, 20e-6, 2e-3);
    double gap = b->family == STRESS_FAR    ? stress_decades(s, 3e-6, 20e-6)
                 : b->family == STRESS_FELT ? stress_decades(s, 20e-9, 1e-6)
                 : b->family == STRESS_APART && stress_chance(s, 0.3)
                     ? stress_decades(s, 1e-4, 1)
                     : stress_decades(s, 20e-9, 20e-6);
    double slender = stress_decades(s, 20, 500);
    b->spec = (haft_beam_spec){length, length * stress_decades(s, 0.01, 0.2), length / slender, gap,
                               stress_decades(s, 1e9, 4e11)};
    b->sites = (size_t)stress_decades(s, 1, 201);
    if (b->family == STRESS_MEASURED) {
        b->spec = (haft_beam_spec){600e-6, 30e-6, 2.62e-6, 1.9e-6, 163e9};
        b->sites = 50 + stress_pick(s, 151);
    } else if (b->family == STRESS_ALIKE) {
        b->sites = 1 + stress_pick(s, 20);
    }
}

/* Anywhere, on a site, almost on one, or at the end. */
static inline void stress_draw_load(stress_beam *b, stress_stream *s) {
    double length = b->spec.length, x = length * stress_decades(s, 0.03, 1);
    double site = stress_site_x(b, stress_pick(s, b->sites));
    double how = b->family == STRESS_BESIDE ? 0.25 : stress_between(s, 0, 1);
    if (how < 0.2) {
        x = site;
    } else if (how < 0.3) {
        double off = length * stress_decades(s, 1e-12, 1e-4);
        x = stress_chance(s, 0.5) ? site + off : site - off;
    } else if (how < 0.33) {
        x = length;
    }
    b->load_position = fmin(x, length);
}

/* The load that brings its point down to the substrate, in a beam without laws [N]. */
static inline double stress_touching_load(const stress_beam *b) {
    double x = b->load_position;
    return 3 * haft_beam_bending_stiffness(&b->spec) * b->spec.gap / (x * x * x);
}

static inline void stress_draw_programme(stress_beam *b, stress_stream *s) {
    double length = b->spec.length;
    double crack = length * stress_between(s, 0.05, 0.98);
    if (stress_chance(s, 0.7) && b->load_position < 0.9 * length) {
        crack = stress_between(s, b->load_position, length);
    }
    double most =
        stress_touching_load(b) *
        (b->family == STRESS_APART ? stress_decades(s, 0.01, 0.3) : stress_decades(s, 1, 300));
    bool limited = b->family == STRESS_APART || stress_chance(s, 0.6);
    b->programme = (haft_programme){crack, 0.01, limited ? most : INFINITY};
    if (limited && stress_chance(s, 0.2)) {
        b->programme.crack_length = -1;
    }
    b->active_from = fmin(crack, length) * stress_between(s, 0.1, 0.9);
}

/* How strong and how long-ranged a law of the family is: its energy is some share of what holds the
 * crack asked for. */
static inline stress_scale stress_draw_scale(const stress_beam *b, stress_stream *s) {
    double gap = b->spec.gap, crack = fmax(b->programme.crack_length, 0.3 * b->spec.length);
    double energy = haft_beam_effective_energy(&b->spec, crack) * stress_decades(s, 1e-4, 30);
    double range = stress_decades(s, fmin(0.1e-9, 0.01 * gap), 0.1 * gap);
    double near = range * stress_between(s, 0.5, 5), most = gap;
    if (b->family == STRESS_FAR) {
        range = gap / stress_decades(s, 1e4, 1e6);
        near = range * stress_decades(s, 1, 1e3);
    } else if (b->family == STRESS_FELT) {
        range = gap * stress_decades(s, 0.03, 1);
        near = gap * stress_between(s, 0, 0.9);
        most = 3 * gap;
    } else if (b->family == STRESS_APART) {
        range = fmin(range, 1e-3 * gap);
        near = range;
        most = 0.1 * gap;
    }
    return (stress_scale){energy / (2 * range), range, fmin(near, 0.5 * most), most};
}

static inline stress_shape stress_draw_law_shape(const stress_beam *b, stress_stream *s) {
    switch (b->family) {
    case STRESS_MEASURED:
    case STRESS_WIDE:
        return STRESS_MORSE;
    case STRESS_FAR:
        return stress_chance(s, 0.7) ? STRESS_MORSE : STRESS_FINE;
    case STRESS_TABLES:
        return STRESS_KINKS + (stress_shape)stress_pick(s, 3);
    case STRESS_PUSHING:
        return stress_chance(s, 0.8) ? STRESS_PUSH_LAST : STRESS_PUSH_ALONE;
    case STRESS_STRAIGHT:
        return stress_chance(s, 0.5) ? STRESS_LINEAR : STRESS_THIN_WALL;
    case STRESS_CANCELS:
        return STRESS_GREAT_WALL;
    default:
        return (stress_shape)stress_pick(s, STRESS_SHAPES);
    }
}

/* Scatters a scale about the beam's own. */
static inline stress_scale stress_scatter(stress_stream *s, stress_scale scale, double force,
                                          double length) {
    scale.pull *= stress_decades(s, 1 / force, force);
    scale.range *= stress_decades(s, 1 / length, length);
    scale.near *= stress_decades(s, 1 / length, length);
    scale.near = fmin(scale.near, 0.5 * scale.most);
    return scale;
}

/* The laws: one a site, or a few that the sites share. @return false if one is refused. */
static inline bool stress_draw_laws(stress_beam *b, stress_stream *s, haft_error *error) {
    stress_scale scale = stress_draw_scale(b, s);
    b->shape = stress_draw_law_shape(b, s);
    bool alike = b->family == STRESS_ALIKE || stress_chance(s, 0.1);
    b->laws = alike ? 1 : b->sites;
    b->law = calloc(b->laws, sizeof *b->law);
    b->law_of = calloc(b->sites, sizeof *b->law_of);
    b->given = calloc(b->sites, sizeof *b->given);
    double force = 1.5, length = 1.1;
    if (b->family == STRESS_WIDE || b->family == STRESS_DECADES) {
        force = 1e3;
        length = 3;
    } else if (stress_chance(s, 0.3)) {
        force = 5;
        length = 1.5;
    }
    for (size_t k = 0; k < b->laws; k++) {
        bool mixed = b->family == STRESS_DECADES || (b->family == STRESS_FELT && b->index % 2);
        stress_shape shape = mixed ? (stress_shape)stress_pick(s, STRESS_SHAPES) : b->shape;
        stress_scale own = alike ? scale : stress_scatter(s, scale, force, length);
        if (b->family == STRESS_MEASURED) {
            own =
                (stress_scale){1e6 * stress_decades(s, 0.5, 2), 2e-9 * stress_decades(s, 0.7, 1.4),
                               11e-9 + stress_between(s, -1e-9, 1e-9), b->spec.gap};
        }
        if (!stress_law_draw(&b->law[k], s, shape, own, error)) {
            return false;
        }
    }
    for (size_t r = 0; r < b->sites; r++) {
        b->law_of[r] = alike ? 0 : r;
        b->given[r] = b->law[b->law_of[r]].law;
    }
    return true;
}

/* @return false if the library refuses a law; the beam is to be freed all the same. */
static inline bool stress_beam_draw(stress_beam *b, uint64_t seed, uint64_t index,
                                    haft_error *error) {
    *b = (stress_beam){.seed = seed, .index = index};
    stress_stream s = {seed, index, 0};
    b->family = (stress_family)(index % STRESS_FAMILIES);
    stress_draw_shape(b, &s);
    stress_draw_load(b, &s);
    stress_draw_programme(b, &s);
    return stress_draw_laws(b, &s, error);
}

static inline void stress_beam_free(stress_beam *b) {
    for (size_t k = 0; k < b->laws && b->law != NULL; k++) {
        stress_law_free(&b->law[k]);
    }
    free(b->law);
    free(b->law_of);
    free(b->given);
}

#endif
