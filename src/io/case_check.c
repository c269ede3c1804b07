/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks of a case that need several keys at once. Each runs only if the keys it needs are valid by
 * themselves, and suggests the nearest valid value. "Divides" means to a relative 1e-9. */
#include "case.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double DIVIDES = 1e-9;
static const double PI = 3.14159265358979323846;

enum {
    LENGTH_CAPACITY = 40,
    NEAREST_LIMIT = 2000000, /* counts tried in the search for the nearest length that divides */
    DISTANCES_LEAST = 16,
    DISTANCES_MOST = 1000000,
};
static const double PATCH_POINTS_MOST = 1e9;

static haft_mark place(const haft_case_reader *reader, const char *path) {
    return reader->mark[haft_case_find_key(path)];
}

/* Complains of a key at its position and marks it as invalid. */
#define WRONG(reader, path, ...)                                                                   \
    do {                                                                                           \
        haft_case_complain(reader, place(reader, path), path, __VA_ARGS__);                        \
        (reader)->state[haft_case_find_key(path)] = HAFT_BAD;                                      \
    } while (0)

static const char *length_text(double length, char text[LENGTH_CAPACITY]) {
    bool micro = fabs(length) >= 0.9999e-6;
    snprintf(text, LENGTH_CAPACITY, "%.12g %s", length * (micro ? 1e6 : 1e9), micro ? "um" : "nm");
    return text;
}

static bool divides(double part, double whole) {
    double ratio = whole / part;
    return ratio >= 1 - DIVIDES && fabs(ratio - round(ratio)) <= DIVIDES * ratio;
}

/* The nearest length to `part` that divides `whole` and is a multiple of `unit` (0: any); 0 if none
 * was found. */
static double nearest_part(double part, double whole, double unit) {
    double start = fmax(1, round(whole / part));
    double nearest = 0;
    for (double k = 0; k < NEAREST_LIMIT; k++) {
        for (int side = -1; side <= 1; side += 2) {
            double candidate = start + side * k >= 1 ? whole / (start + side * k) : 0;
            bool fits = candidate > 0 && (unit == 0 || divides(unit, candidate));
            if (fits && (nearest == 0 || fabs(candidate - part) < fabs(nearest - part))) {
                nearest = candidate;
            }
        }
        /* Shorter lengths move away from `part` in ever smaller steps, longer ones in growing
         * steps. Once a shorter length is farther than the best, no later candidate is nearer. */
        if (nearest > 0 && part - whole / (start + k - 1) > fabs(nearest - part)) {
            break;
        }
    }
    return nearest;
}

static void check_surface(haft_case_reader *reader, double *lattice) {
    haft_case *c = reader->c;
    const haft_psd *psd = &c->surface.psd;
    *lattice = 0;
    char a[LENGTH_CAPACITY], b[LENGTH_CAPACITY];
    bool band = haft_case_is_sound(reader, "surface.zeta_max") &&
                haft_case_is_sound(reader, "surface.zeta_0");
    bool levels =
        haft_case_is_sound(reader, "surface.s_0") && haft_case_is_sound(reader, "surface.s_1");
    band = band && c->surface.table == NULL; /* which has been checked already */
    levels = levels && c->surface.table == NULL;
    if (band && psd->zeta_0 >= psd->zeta_max) {
        WRONG(reader, "surface.zeta_0",
              "%.6g rad/um is not below zeta_max; give less than %.6g "
              "rad/um",
              psd->zeta_0 * 1e-6, psd->zeta_max * 1e-6);
        band = false;
    }
    if (levels && psd->s_1 > psd->s_0) {
        WRONG(reader, "surface.s_1", "%.6g nm^4 is above the plateau s_0; give %.6g nm^4 at most",
              psd->s_1 * 1e36, psd->s_0 * 1e36);
        levels = false;
    }
    bool known = c->surface.table != NULL || (band && levels);
    if (!known || !(psd->zeta_max > 0) || !haft_case_is_sound(reader, "surface.grid_step")) {
        return;
    }
    double largest = PI / psd->zeta_max, least = largest / HAFT_SURFACE_FINEST;
    bool generated = c->surface.source != HAFT_SOURCE_MAPS;
    if (generated && c->surface.grid_step < least) {
        WRONG(reader, "surface.grid_step",
              "%s is finer than the shortest wave of the PSD can use; give %s (pi/zeta_max/%d) at "
              "least",
              length_text(c->surface.grid_step, a), length_text(ceil(least * 1e13) * 1e-13, b),
              HAFT_SURFACE_FINEST);
        return;
    }
    size_t ratio = haft_surface_lattice_ratio(psd, c->surface.grid_step);
    if (ratio == 0 && c->surface.grid_step < largest) {
        *lattice = c->surface.grid_step; /* arbitrary for patches of a map */
        return;
    }
    if (ratio == 0) {
        WRONG(reader, "surface.grid_step",
              "%s is too coarse for the shortest wave of the PSD; give "
              "%s (pi/zeta_max) at most",
              length_text(c->surface.grid_step, a), length_text(floor(largest * 1e13) * 1e-13, b));
        return;
    }
    *lattice = (double)ratio * c->surface.grid_step;
}

static void check_grid(haft_case_reader *reader, double lattice) {
    haft_case *c = reader->c;
    char a[LENGTH_CAPACITY], b[LENGTH_CAPACITY], d[LENGTH_CAPACITY];
    double ratio = lattice / c->surface.grid_step;
    if (haft_case_is_sound(reader, "beam.width") && !divides(lattice, c->beam.width)) {
        WRONG(reader, "beam.width",
              "%s is no multiple of %s, which is %.0f surface.grid_step (the "
              "coarsest that carries the PSD); nearest is %s",
              length_text(c->beam.width, a), length_text(lattice, b), ratio,
              length_text(fmax(1, round(c->beam.width / lattice)) * lattice, d));
    }
    if (haft_case_is_sound(reader, "beam.l_meso") && !divides(lattice, c->mesh.l_meso)) {
        double nearest = haft_case_is_sound(reader, "beam.length")
                             ? nearest_part(c->mesh.l_meso, c->beam.length, lattice)
                             : 0;
        if (nearest == 0) {
            nearest = fmax(1, round(c->mesh.l_meso / lattice)) * lattice;
        }
        WRONG(reader, "beam.l_meso",
              "%s is no multiple of %s, which is %.0f surface.grid_step (the "
              "coarsest that carries the PSD); nearest is %s",
              length_text(c->mesh.l_meso, a), length_text(lattice, b), ratio,
              length_text(nearest, d));
    }
    double points = c->mesh.l_meso / c->surface.grid_step * (c->beam.width / c->surface.grid_step);
    if (haft_case_is_sound(reader, "beam.width") && haft_case_is_sound(reader, "beam.l_meso") &&
        points > PATCH_POINTS_MOST) {
        WRONG(reader, "surface.grid_step",
              "%s gives a patch %.3g points; at most %.0g can be "
              "done, so give a coarser step",
              length_text(c->surface.grid_step, a), points, PATCH_POINTS_MOST);
    }
}

static void check_part(haft_case_reader *reader, const char *path, double part, double unit) {
    char a[LENGTH_CAPACITY], b[LENGTH_CAPACITY], d[LENGTH_CAPACITY];
    double length = reader->c->beam.length;
    if (!haft_case_is_sound(reader, path) || part <= 0 ||
        !haft_case_is_sound(reader, "beam.length")) {
        return;
    }
    if (!divides(part, length)) {
        double nearest = nearest_part(part, length, unit);
        WRONG(reader, path, "%s does not divide beam.length, %s; nearest is %s",
              length_text(part, a), length_text(length, b),
              length_text(nearest > 0 ? nearest : length, d));
    } else if (length / part > HAFT_MOST_ELEMENTS) {
        WRONG(reader, path, "%s divides the beam into %.3g pieces; give %s at least",
              length_text(part, a), length / part, length_text(length / HAFT_MOST_ELEMENTS, b));
    }
}

static void check_beam(haft_case_reader *reader, double lattice) {
    const haft_case *c = reader->c;
    bool missing = haft_case_is_sound(reader, "beam.mesh") && c->mesh.kind == HAFT_MESH_UNIFORM &&
                   haft_case_is_sound(reader, "beam.element_length") &&
                   !haft_case_is_given(reader, "beam.element_length");
    if (missing && place(reader, "beam.element_length").line != 0) {
        WRONG(reader, "beam.element_length",
              "is missing; add \"element_length: 15 um\", or "
              "\"mesh: exact\", which needs none");
    }
    check_part(reader, "beam.l_meso", c->mesh.l_meso, lattice);
    check_part(reader, "beam.element_length", c->mesh.element_length, 0);
}

static void check_load(haft_case_reader *reader) {
    const haft_case *c = reader->c;
    char a[LENGTH_CAPACITY], b[LENGTH_CAPACITY], d[LENGTH_CAPACITY];
    bool length = haft_case_is_sound(reader, "beam.length");
    if (haft_case_is_sound(reader, "load.position") && length &&
        c->mesh.load_position > c->beam.length) {
        WRONG(reader, "load.position", "%s is off the beam; give %s (its end) at most",
              length_text(c->mesh.load_position, a), length_text(c->beam.length, b));
    }
    if (!haft_case_is_sound(reader, "load.crack_length")) {
        return;
    }
    double crack = c->programme.crack_length;
    if (length && crack >= c->beam.length) {
        WRONG(reader, "load.crack_length", "%s is not shorter than the beam; give less than %s",
              length_text(crack, a), length_text(c->beam.length, b));
    } else if (length && haft_case_is_sound(reader, "load.position") &&
               crack <= c->mesh.load_position) {
        WRONG(reader, "load.crack_length",
              "%s is not beyond load.position; give more than %s and "
              "less than %s",
              length_text(crack, a), length_text(c->mesh.load_position, b),
              length_text(c->beam.length, d));
    }
}

static void check_distance(haft_case_reader *reader) {
    const haft_case *c = reader->c;
    char a[LENGTH_CAPACITY], b[LENGTH_CAPACITY], d[LENGTH_CAPACITY];
    double from = c->contact.distance_from, to = c->contact.distance_to;
    double step = c->contact.distance_step, range = to - from;
    if (!haft_case_is_sound(reader, "contact.distance.from") ||
        !haft_case_is_sound(reader, "contact.distance.to")) {
        return;
    }
    if (range <= 0) {
        WRONG(reader, "contact.distance.to", "%s is not above `from`; give more than %s",
              length_text(to, a), length_text(from, b));
        return;
    }
    if (haft_case_is_sound(reader, "beam.gap") && to >= c->beam.gap) {
        WRONG(reader, "contact.distance.to",
              "%s reaches up to the beam at rest; give less than "
              "beam.gap, %s",
              length_text(to, a), length_text(c->beam.gap, b));
    }
    if (!haft_case_is_sound(reader, "contact.distance.step")) {
        return;
    }
    if (step > range / (DISTANCES_LEAST - 1) * (1 + DIVIDES)) {
        WRONG(reader, "contact.distance.step", "%s gives fewer than %d distances; give %s at most",
              length_text(step, a), DISTANCES_LEAST, length_text(range / (DISTANCES_LEAST - 1), b));
    } else if (range / step > DISTANCES_MOST) {
        WRONG(reader, "contact.distance.step", "%s gives %.3g distances; give %s at least",
              length_text(step, a), range / step, length_text(range / DISTANCES_MOST, b));
    } else if (!divides(step, range)) {
        WRONG(reader, "contact.distance.step",
              "%s does not divide the range from `from` to `to`, "
              "%s; nearest is %s",
              length_text(step, a), length_text(range, b),
              length_text(nearest_part(step, range, 0), d));
    }
}

static void check_forces(haft_case_reader *reader) {
    const haft_case *c = reader->c;
    bool both = c->contact.has_capillary && c->contact.has_vdw;
    if (!haft_case_is_sound(reader, "contact.forces")) {
        return;
    }
    bool needs_vdw = c->contact.forces == HAFT_FORCES_VDW && !c->contact.has_vdw;
    if (needs_vdw || (c->contact.forces == HAFT_FORCES_CAPILLARY && !c->contact.has_capillary)) {
        const char *section = needs_vdw ? "vdw" : "capillary";
        WRONG(reader, "contact.forces",
              "%s has no section contact.%s to act on; add it%s, or give forces: given", section,
              section, needs_vdw ? " (\"vdw: {}\" is enough)" : "");
    } else if (c->contact.forces == HAFT_FORCES_AUTO && !both) {
        WRONG(reader, "contact.forces",
              "auto chooses between contact.capillary and contact.vdw by humidity, but there is no "
              "section contact.%s; add it%s, or give forces: given",
              c->contact.has_capillary ? "vdw" : "capillary",
              c->contact.has_capillary ? " (\"vdw: {}\" is enough)" : "");
    } else if (haft_case_physics(c).capillary &&
               haft_case_is_given(reader, "contact.capillary.humidity") &&
               !(c->contact.capillary.humidity > 0)) {
        WRONG(reader, "contact.capillary.humidity",
              "no water condenses in dry air; give a humidity above 0 %%, or leave "
              "contact.capillary out for dry contact, or add \"forces: auto\" to contact, which "
              "chooses by humidity");
    }
}

/* A length that is good by itself must also lie in [least, most]. */
static void check_length(haft_case_reader *reader, const char *path, double length, double least,
                         double most, const char *why) {
    char a[LENGTH_CAPACITY], b[LENGTH_CAPACITY], d[LENGTH_CAPACITY];
    if (haft_case_is_sound(reader, path) && !(length >= least && length <= most)) {
        WRONG(reader, path, "%s is %s; give %s to %s", length_text(length, a), why,
              length_text(least, b), length_text(most, d));
    }
}

static void check_reach(haft_case_reader *reader) {
    const haft_case *c = reader->c;
    char a[LENGTH_CAPACITY], b[LENGTH_CAPACITY], d[LENGTH_CAPACITY];
    double reach = c->contact.dispersion.reach;
    if (haft_case_is_sound(reader, "contact.dispersion.reach") &&
        haft_case_is_sound(reader, "contact.distance.to") &&
        haft_case_is_sound(reader, "beam.gap") &&
        !(reach > c->contact.distance_to && reach < c->beam.gap)) {
        WRONG(reader, "contact.dispersion.reach",
              "%s is not between the end of the laws of contact and the beam at rest; give more "
              "than contact.distance.to, %s, and less than beam.gap, %s",
              length_text(reach, a), length_text(c->contact.distance_to, b),
              length_text(c->beam.gap, d));
    }
}

/* The law, and what it must leave of the energy of contact. */
static void check_tail(haft_case_reader *reader) {
    const haft_case *c = reader->c;
    haft_dispersion law;
    haft_vdw vdw;
    haft_error own = {0};
    if (haft_case_dispersion(&law, c, &own) != HAFT_OK) {
        WRONG(reader, "contact.dispersion.hamaker", "%.400s", own.message);
    } else if (haft_case_physics(c).vdw && haft_case_vdw(&vdw, c, &own) != HAFT_OK) {
        WRONG(reader, "contact.dispersion.cut_off", "%.400s", own.message);
    }
}

/* Last of all: it is made of a case that is sound in all else. */
static void make_far_field(haft_case_reader *reader) {
    haft_error own = {0};
    bool wanted = reader->c->contact.has_dispersion && reader->complaints == 0;
    haft_status status = wanted ? haft_case_make_far_field(reader->c, &own) : HAFT_OK;
    if (status == HAFT_ERROR_MEMORY) {
        reader->failure = haft_error_set(reader->error, status, "%s", own.message);
    } else if (status != HAFT_OK) {
        WRONG(reader, "contact.dispersion.reach", "%.400s", own.message);
    }
}

static void check_dispersion(haft_case_reader *reader) {
    const haft_case *c = reader->c;
    if (!c->contact.has_dispersion) {
        return;
    }
    check_length(reader, "contact.dispersion.cut_off", c->contact.dispersion.cut_off,
                 HAFT_DISPERSION_CUT_OFF_LEAST, HAFT_DISPERSION_LENGTH_MOST,
                 "no distance of faces, the nearest being that of atoms which touch");
    if (c->contact.dispersion.oxide_thickness > 0) {
        check_length(reader, "contact.dispersion.oxide.thickness",
                     c->contact.dispersion.oxide_thickness, 0, HAFT_DISPERSION_LENGTH_MOST,
                     "thicker than a native oxide is");
    }
    check_reach(reader);
    if (!haft_case_is_given(reader, "contact.dispersion.hamaker") && !c->contact.has_vdw &&
        haft_case_is_sound(reader, "contact.dispersion.hamaker")) {
        WRONG(reader, "contact.dispersion.hamaker",
              "is missing, and there is no section contact.vdw to take it from; add \"hamaker: "
              "18.65e-20 J\", that of the bodies through air");
    }
    if (reader->complaints == 0) {
        check_tail(reader);
    }
}

/* Every asperity that a patch can have must be a sphere that the table of van der Waals forces
 * holds. */
static void check_spheres(haft_case_reader *reader) {
    const haft_case *c = reader->c;
    static const char *const needed[] = {"surface.grid_step",     "contact.young_modulus",
                                         "contact.poisson_ratio", "contact.vdw.hamaker_dry",
                                         "contact.vdw.r0",        "contact.vdw.hamaker_humid",
                                         "beam.l_meso",           "beam.width"};
    bool acts = haft_case_physics(c).vdw;
    for (size_t i = 0; i < sizeof needed / sizeof *needed; i++) {
        acts = acts && haft_case_is_sound(reader, needed[i]);
    }
    acts = acts && !(c->contact.has_dispersion && reader->complaints > 0);
    if (!acts) {
        return;
    }
    double modulus = haft_contact_modulus(c->contact.young_modulus, c->contact.poisson_ratio,
                                          c->contact.young_modulus, c->contact.poisson_ratio);
    double step = c->surface.grid_step;
    haft_vdw vdw;
    haft_error own = {0};
    haft_status status = haft_case_vdw(&vdw, c, &own);
    if (status == HAFT_OK) {
        status = haft_contact_check_spheres(&vdw, modulus, round(c->mesh.l_meso / step),
                                            round(c->beam.width / step), step, &own);
    }
    if (status != HAFT_OK) {
        WRONG(reader, "contact.vdw.r0", "%s", own.message);
    }
}

static void check_limit(haft_case_reader *reader) {
    bool push = haft_case_is_given(reader, "law.f_limit"),
         share = haft_case_is_given(reader, "law.f_limit_share");
    if (push && share) {
        WRONG(reader, "law.f_limit_share",
              "stands beside f_limit, and only one can be the limit push; leave out one of them");
    } else if (!push && !share && haft_case_is_sound(reader, "law.f_limit") &&
               haft_case_is_sound(reader, "law.f_limit_share") &&
               place(reader, "law.f_limit").line != 0) {
        WRONG(reader, "law.f_limit",
              "is missing; add \"f_limit: 5 MPa\", or \"f_limit_share: 20 %%\" of each curve's "
              "greatest pull");
    }
}

static void check_chaos(haft_case_reader *reader) {
    const haft_case *c = reader->c;
    if (!haft_case_is_sound(reader, "law.sampler") || !haft_sampler_is_stochastic(c->law.sampler)) {
        return;
    }
    if (haft_case_is_sound(reader, "law.kind") && c->law.kind == HAFT_LAW_TABLE &&
        c->law.sampler != HAFT_SAMPLER_BOOTSTRAP) {
        WRONG(reader, "law.kind",
              "table needs curves, and this stochastic sampler draws law vectors; give morse, or "
              "law.sampler: bootstrap, which draws patches, or explicit");
    }
    size_t order = c->law.chaos.spec.order, points = c->law.chaos.spec.points;
    if (haft_case_is_sound(reader, "law.chaos.points") &&
        haft_case_is_sound(reader, "law.chaos.order") && points != 0 && points <= order) {
        WRONG(reader, "law.chaos.points",
              "%zu points a direction cannot tell order %zu; give %zu at least, or 0 for as many",
              points, order, order + 1);
    }
}

static void check_stop(haft_case_reader *reader) {
    const haft_case *c = reader->c;
    if (haft_case_is_given(reader, "study.stop.crack_length_mean") &&
        haft_case_is_sound(reader, "study.realizations") && c->realizations <= HAFT_STOP_LEAST) {
        WRONG(reader, "study.stop.crack_length_mean",
              "can end nothing before %d realizations, of which there are %zu; give realizations: "
              "%d at least, or leave it out",
              HAFT_STOP_LEAST, c->realizations, HAFT_STOP_LEAST + 1);
    }
}

static void check_evidence(haft_case_reader *reader) {
    const haft_case *c = reader->c;
    if (!haft_case_is_sound(reader, "output.evidence") ||
        !haft_case_is_sound(reader, "study.realizations")) {
        return;
    }
    for (size_t i = 0; i < c->evidence.count; i++) {
        if (c->evidence.realization[i] >= c->realizations) {
            haft_case_complain(reader, reader->evidence_mark[i], "output.evidence",
                               "there is no realization %zu; they count from 0, so give %zu at "
                               "most",
                               c->evidence.realization[i], c->realizations - 1);
        }
    }
}

void haft_case_cross_check(haft_case_reader *reader) {
    double lattice = 0;
    haft_case_load_surface(reader);
    haft_case_load_film(reader);
    check_surface(reader, &lattice);
    check_beam(reader, lattice);
    if (lattice > 0) {
        check_grid(reader, lattice);
    }
    check_load(reader);
    check_distance(reader);
    check_forces(reader);
    check_dispersion(reader);
    check_spheres(reader);
    check_limit(reader);
    check_chaos(reader);
    check_stop(reader);
    check_evidence(reader);
    make_far_field(reader);
}
