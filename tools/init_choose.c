/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What haft init chooses. Grid and patches follow from the surface's shortest wave and the sides of
 * the beam, which they must divide. Distances and load follow from the force curves of a few trial
 * patches, since the range of push and pull depends on roughness, humidity and stiffness
 * together. */
#include "init.h"
#include "inspect_print.h"

#include <math.h>

/* Most grid points of all patches together, which limits the number of patches; and most points of
 * one patch on a fine grid. */
static const double POINTS_MOST = 4e8, POINTS_A_PATCH = 1.2e7;
enum { PATCHES_LEAST = 20, PATCHES_MOST = 200, TRIALS = 6, TRIAL_DISTANCES = 160 };
enum { SITES_LEAST = 10, SITES_MOST = 10000, PATCH_LATTICE_LEAST = 8, DISTANCES = 240 };

static const double PATCH_STANDARD = 3e-6, DIVIDES = 1e-9;

/* ---- the surface ---- */

static haft_status read_face(haft_psd_table **psd, init_plan *p, size_t n, const char *const *path,
                             bool first, haft_error *error) {
    haft_map *map[HAFT_FILES_MAX] = {NULL};
    const haft_map *view[HAFT_FILES_MAX] = {NULL};
    haft_status status = HAFT_OK;
    for (size_t k = 0; k < n && status == HAFT_OK; k++) {
        status = haft_map_read(&map[k], path[k], &p->wishes.options, NULL, error);
        if (status == HAFT_OK) {
            status = haft_map_clean(map[k], &p->wishes.clean, NULL, error);
            if (status != HAFT_OK) {
                haft_error_prefix(error, "%s: ", path[k]);
            }
        }
        view[k] = map[k];
    }
    haft_map_statistics s;
    if (status == HAFT_OK && first) {
        status = haft_map_get_statistics(&s, map[0], error);
        p->skewness = s.skewness;
        p->kurtosis = s.kurtosis;
    }
    HAFT_THEN(status, haft_psd_estimate(psd, n, view, p->wishes.window, error));
    if (status == HAFT_OK && p->wishes.tip_radius > 0) {
        status = haft_psd_table_cut(*psd, haft_psd_tip_limit(*psd, p->wishes.tip_radius), error);
    }
    for (size_t k = 0; k < n; k++) {
        haft_map_destroy(&map[k]);
    }
    return status;
}

static haft_status look_at_maps(init_plan *p, haft_error *error) {
    const init_words *w = p->words;
    haft_psd_table *psd = NULL, *other = NULL, *both = NULL;
    haft_status status = read_face(&psd, p, w->maps, w->map, true, error);
    if (status == HAFT_OK && w->opposite_maps > 0) {
        status = read_face(&other, p, w->opposite_maps, w->opposite_map, false, error);
        HAFT_THEN(status, haft_psd_combine(&both, psd, other, 0, error));
    }
    if (status == HAFT_OK) {
        const haft_psd_table *t = both != NULL ? both : psd;
        p->zeta_max = t->zeta[t->n - 1];
        p->rms = sqrt(haft_psd_table_get_moments(t).m0);
        p->correlation_length = haft_psd_table_get_correlation_length(t);
    }
    haft_psd_table_destroy(&psd);
    haft_psd_table_destroy(&other);
    haft_psd_table_destroy(&both);
    return status;
}

static haft_status look_at_surface(init_plan *p, haft_error *error) {
    if (p->roughness.rms > 0) {
        haft_psd psd;
        p->zeta_max = p->roughness.zeta_max;
        p->rms = p->roughness.rms;
        p->correlation_length = p->roughness.correlation_length;
        return haft_psd_from_roughness(&psd, &p->roughness, error);
    }
    return look_at_maps(p, error);
}

/* ---- grid and patches ---- */

static bool divides(double part, double whole) {
    double ratio = whole / part;
    return ratio >= 1 - DIVIDES && fabs(ratio - round(ratio)) <= DIVIDES * ratio;
}

/* Finds the patch length nearest to `wished` (as a ratio) that divides the beam and is a whole
 * number of lattice steps; 0 if none is near. */
static double find_patch(const init_plan *p, double lattice, double wished) {
    double steps = round(p->length / lattice), best = 0;
    for (double sites = SITES_LEAST; sites <= SITES_MOST && sites <= steps; sites++) {
        double patch = p->length / sites;
        bool nearer = best == 0 || fabs(log(patch / wished)) < fabs(log(best / wished));
        if (nearer && divides(lattice, patch) && patch >= PATCH_LATTICE_LEAST * lattice) {
            best = patch;
        }
    }
    return best > 0 && fabs(log(best / wished)) < log(8) ? best : 0;
}

/* Finds the coarsest step of a plain number, up to `most`, whose lattice divides the beam's width
 * and its patches. */
static bool fit_grid(init_plan *p, double most) {
    haft_psd psd = {.zeta_max = p->zeta_max};
    double wished = fmin(fmax(PATCH_STANDARD, 4 * p->correlation_length), p->length / 20);
    for (double step = inspect_grid_step(M_PI / most); step > most / 40;
         step = inspect_grid_step(M_PI / (step * 0.999))) {
        size_t ratio = haft_surface_lattice_ratio(&psd, step);
        double lattice = (double)ratio * step;
        double patch = ratio > 0 && divides(lattice, p->width) &&
                               p->width > PATCH_LATTICE_LEAST * lattice * (1 - DIVIDES)
                           ? find_patch(p, lattice, wished)
                           : 0;
        if (patch > 0) {
            p->grid_step = step;
            p->l_meso = patch;
            return true;
        }
    }
    return false;
}

static double points_of(const init_plan *p) {
    return p->l_meso / p->grid_step * (p->width / p->grid_step);
}

/* Chooses four grid points for each shortest wave, or two if four would make a patch too large. */
static haft_status choose_grid(init_plan *p, haft_error *error) {
    double coarse = M_PI / p->zeta_max;
    bool found = fit_grid(p, 0.5 * coarse);
    if (!found || points_of(p) > POINTS_A_PATCH) {
        found = fit_grid(p, coarse) || found;
    }
    if (!found) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "no grid carries waves down to %.4g um and divides a beam %.12g um long and %.12g um "
            "wide; give --beam sides that are multiples of 1 um and more than %.3g um wide, or a "
            "map of finer pixels",
            2 * coarse * 1e6, p->length * 1e6, p->width * 1e6, PATCH_LATTICE_LEAST * coarse * 1e6);
    }
    double many = POINTS_MOST / points_of(p);
    p->vectors = many < PATCHES_LEAST  ? PATCHES_LEAST
                 : many > PATCHES_MOST ? PATCHES_MOST
                                       : (size_t)many;
    return HAFT_OK;
}

/* ---- distances and load, by trial patches ---- */

/* Chooses the least tolerance at which the kernel of the surfaces is short enough to be used. */
static haft_status choose_tolerance(init_plan *p, const haft_case *c, haft_error *error) {
    static const double tolerances[] = {0, 1e-4, 1e-3, 1e-2};
    haft_case trial = *c;
    haft_status status = HAFT_OK;
    for (size_t k = 0; k < sizeof tolerances / sizeof *tolerances; k++) {
        haft_surface_plan *plan = NULL;
        trial.surface.kernel_tolerance =
            tolerances[k] > 0 ? tolerances[k] : c->surface.kernel_tolerance;
        status = haft_study_surface_plan(&plan, &trial, 1, error);
        haft_surface_plan_destroy(&plan);
        p->kernel_tolerance = tolerances[k];
        if (status != HAFT_ERROR_INPUT) {
            break;
        }
    }
    return status;
}

typedef struct reach {
    double pushed; /* least distance at which a curve still pushes twice as hard as it pulls [m];
                      -INFINITY if one never does */
    double ended;  /* greatest distance at which a curve still pulls or pushes [m] */
    double energy; /* mean energy of the pull [J/m^2] */
    bool open;     /* a curve has not vanished at its last distance */
} reach;

static void look_at_curve(reach *r, const haft_laws *laws, const double *force) {
    double pull = 0, energy = 0, step = laws->distance[1] - laws->distance[0];
    for (size_t i = 0; i < laws->n; i++) {
        pull = fmax(pull, -force[i]);
        energy += force[i] < 0 ? -force[i] * step : 0;
    }
    double scale = pull > 0 ? pull : fabs(force[0]);
    size_t last = laws->n - 1, first = 0;
    while (last > 0 && !(fabs(force[last]) > 1e-3 * scale)) {
        last--;
    }
    while (first + 1 < laws->n && force[first] > 2 * pull && force[first] > 0) {
        first++;
    }
    r->pushed = fmin(r->pushed, first > 0 ? laws->distance[first - 1] : -INFINITY);
    r->ended = fmax(r->ended, laws->distance[last]);
    r->energy += energy / (double)laws->m;
    r->open = r->open || last + 1 == laws->n;
}

/* Computes the curves of a few patches. */
static haft_status try_patches(reach *r, const init_plan *p, const haft_case *c, double from,
                               double to, haft_error *error) {
    haft_case trial = *c;
    haft_laws *laws = NULL;
    trial.surface.kernel_tolerance =
        p->kernel_tolerance > 0 ? p->kernel_tolerance : c->surface.kernel_tolerance;
    trial.law.sampler = HAFT_SAMPLER_PATCHES;
    trial.mesh.kind = HAFT_MESH_EXACT;
    trial.realizations = 1;
    trial.curves = HAFT_CURVES_ALL;
    trial.beam.length = TRIALS * c->mesh.l_meso;
    trial.mesh.active_from = 0;
    trial.contact.distance_from = from;
    trial.contact.distance_to = to;
    trial.contact.distance_step = (to - from) / TRIAL_DISTANCES;
    haft_status status = haft_study_build_laws(&laws, &trial, NULL, error);
    *r = (reach){.pushed = INFINITY};
    for (size_t k = 0; status == HAFT_OK && k < laws->m; k++) {
        look_at_curve(r, laws, haft_laws_curve(laws, k));
    }
    haft_laws_destroy(&laws);
    return status;
}

/* Margin at both ends of the distances, in rms. Few of the many patches of a case push or pull
 * farther than this beyond the extremes of the few trial patches. */
static const double ROOM = 1.5;

/* Finds distances that cover the curves: from where all patches push, if need be from where the
 * mean planes touch, to where all forces have vanished. */
static haft_status find_reach(reach *r, const init_plan *p, const haft_case *c, haft_error *error) {
    haft_contact_spec spec;
    haft_status status = haft_study_contact_spec(&spec, c, error);
    double from = p->rms, to = 8 * p->rms + spec.capillary_range + spec.vdw.range;
    for (int k = 0; k < 5 && status == HAFT_OK; k++) {
        status = try_patches(r, p, c, from, to, error);
        bool low = from > 0 && !(r->pushed - ROOM * p->rms > from);
        if (!low && !r->open) {
            break;
        }
        from = low ? 0 : from;
        to *= r->open ? 2 : 1;
    }
    return status;
}

/* Chooses plain numbers around the distances that the curves cover, with a margin for higher and
 * lower patches than these. */
static haft_status choose_distances(init_plan *p, const reach *r, haft_error *error) {
    static const double plain[] = {1, 2, 2.5, 5, 10};
    if (isinf(r->pushed)) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "surfaces of %.3g nm rms at %.4g %% humidity do not push as hard as they pull at any "
            "distance, down to where their mean planes touch, so no law holds them apart; give a "
            "rougher surface or less humidity",
            p->rms * 1e9, p->humidity * 100);
    }
    double low = fmax(0, r->pushed - ROOM * p->rms), high = r->ended + ROOM * p->rms + 0.5e-9;
    double wished = (high - low) / DISTANCES, power = pow(10, floor(log10(wished)));
    size_t k = 0;
    while (k < 4 && plain[k] * power < wished) {
        k++;
    }
    p->step = plain[k] * power;
    p->from = floor(low / p->step) * p->step;
    p->to = ceil(high / p->step) * p->step;
    if (p->to >= 0.9 * p->gap) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "the surfaces reach each other from %.4g nm on, the beam stands at "
                              "%.4g nm; give --gap=\"%.2g um\" at least",
                              p->to * 1e9, p->gap * 1e9, ceil(p->to * 2e7) * 0.1);
    }
    return HAFT_OK;
}

/* Chooses the load from the crack length that the adhesion can keep, for a clamped beam in an S
 * shape: gamma = 3/2 E t^3 h^2 / s^4. The beam is pressed down to a little more than half of that
 * length, but at most to three quarters of its own, so the crack at rest is the one that the beam
 * peels back to. */
static void choose_load(init_plan *p, const haft_case *c, double energy) {
    p->adhesion = energy;
    p->expected =
        pow(1.5 * c->beam.young_modulus * pow(p->thickness, 3) * p->gap * p->gap / energy, 0.25);
    double crack = fmin(0.55 * p->expected, 0.75 * p->length);
    crack = fmax(crack, 4 * p->l_meso);
    double unit = crack > 20e-6 ? 1e-6 : 0.1e-6;
    p->crack_length = ceil(crack / unit) * unit;
    p->position = ceil(0.4 * p->crack_length / unit) * unit;
}

haft_status init_choose(init_plan *p, haft_error *error) {
    haft_case *c = NULL;
    reach r = {0};
    haft_status status = look_at_surface(p, error);
    HAFT_THEN(status, choose_grid(p, error));
    if (status != HAFT_OK) {
        return status;
    }
    p->step = p->rms; /* placeholders until the curves are known */
    p->to = 30 * p->rms;
    p->crack_length = 0.75 * p->length;
    p->position = 0.3 * p->length;
    double gap = p->gap;
    p->gap = fmax(gap, 2 * p->to);
    status = init_try(&c, p, error);
    p->gap = gap;
    HAFT_THEN(status, choose_tolerance(p, c, error));
    HAFT_THEN(status, find_reach(&r, p, c, error));
    HAFT_THEN(status, choose_distances(p, &r, error));
    if (status == HAFT_OK) {
        choose_load(p, c, r.energy);
    }
    haft_case_destroy(&c);
    return status;
}
