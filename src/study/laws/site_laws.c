/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The laws of one beam: of its patches, Morse where it fits, the curve itself where it does not or
 * is asked for; or drawn from the model. */
#include "haft/study.h"

#include <float.h>
#include <math.h>

/* The law of site r from the curve of patch k, whose table is there for all beams or is the beam's
 * table number `slot`. */
static haft_status make_table(haft_site_laws *s, const haft_laws *laws, size_t r, size_t k,
                              size_t slot, haft_error *error) {
    const haft_law_table *made = laws->table != NULL ? laws->table[k] : NULL;
    made = made != NULL ? made : s->table[slot];
    if (made != NULL) {
        s->law[r] = haft_law_from_table(made);
        return HAFT_OK;
    }
    const double *curve = haft_laws_curve(laws, k);
    if (curve == NULL) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "the laws hold no curve of site %zu; set output.curves: all and build "
            "them again",
            r);
    }
    haft_status status =
        haft_law_table_create(&s->table[slot], laws->n, laws->distance, curve, error);
    if (status != HAFT_OK) {
        haft_error_prefix(error, "the curve of site %zu (%s): ", r,
                          haft_law_fault_name(laws->fault[k]));
        return status;
    }
    s->law[r] = haft_law_from_table(s->table[slot]);
    return HAFT_OK;
}

/* The law of site r from law k, whose fault is known: a Morse law where its vector has one, else a
 * table where the case allows it. */
static haft_status make_law(haft_site_laws *s, const haft_case *c, const haft_laws *laws, size_t r,
                            size_t k, size_t slot, haft_error *error) {
    haft_law_fault fault = laws->fault[k];
    if (fault == HAFT_LAW_SOUND && c->law.kind == HAFT_LAW_MORSE) {
        fault = haft_law_morse(&s->law[r], &laws->vector[k], laws->f_limit);
    }
    s->vector[r] = laws->vector[k];
    s->unfit += fault != HAFT_LAW_SOUND;
    if (fault == HAFT_LAW_SOUND && c->law.kind == HAFT_LAW_MORSE) {
        return HAFT_OK;
    }
    if (c->law.kind == HAFT_LAW_MORSE && c->law.unfit == HAFT_UNFIT_STOP) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "no Morse law fits the curve of site %zu (%s); set law.unfit: table "
                              "to use such curves themselves, or law.kind: table to use all",
                              r, haft_law_fault_name(fault));
    }
    return make_table(s, laws, r, k, slot, error);
}

/* The vectors of a realization from the model, and their Morse laws. */
static haft_status draw_laws(haft_site_laws *s, const haft_case *c, const haft_laws *laws,
                             size_t realization, haft_error *error) {
    haft_status status = haft_study_draw(laws, c, realization, s->sites, s->vector, error);
    for (size_t r = 0; r < s->sites && status == HAFT_OK; r++) {
        haft_law_fault fault = haft_law_morse(&s->law[r], &s->vector[r], laws->f_limit);
        if (fault != HAFT_LAW_SOUND) {
            status = haft_error_set(error, HAFT_ERROR_INPUT,
                                    "the vector drawn for site %zu has no Morse law (%s); set "
                                    "law.chaos.bounds: strict, which draws none such",
                                    r, haft_law_fault_name(fault));
        }
    }
    return status;
}

bool haft_study_draws_patches(const haft_case *c) {
    return c->law.sampler == HAFT_SAMPLER_BOOTSTRAP && c->law.kind == HAFT_LAW_TABLE;
}

/* The patches' own curves, drawn: of all of them, whether a Morse law would fit or not. */
static haft_status draw_patches(haft_site_laws *s, const haft_case *c, const haft_laws *laws,
                                size_t realization, haft_error *error) {
    haft_status status = HAFT_OK;
    for (size_t r = 0; r < s->sites && status == HAFT_OK; r++) {
        size_t k = haft_chaos_draw_patch(c->seed, realization, r, laws->m);
        status = make_law(s, c, laws, r, k, k, error);
    }
    return status;
}

/* Sites before the zone have no laws: the one in the zone that reaches farthest stands in for them,
 * to tell whether they stay out of reach. */
static void stand_in(haft_site_laws *s, size_t first) {
    size_t farthest = first;
    double reach = 0;
    for (size_t r = first; r < s->sites && first > 0; r++) {
        double own = haft_law_reach(&s->law[r], DBL_EPSILON);
        if (own > reach) {
            reach = own;
            farthest = r;
        }
    }
    for (size_t r = 0; r < first; r++) {
        s->law[r] = s->law[farthest];
        s->vector[r] = s->vector[farthest];
    }
}

static haft_status use_laws(haft_site_laws *s, const haft_case *c, const haft_laws *laws,
                            size_t realization, haft_error *error) {
    size_t first = haft_study_first_site(c);
    if (!haft_study_has_sites(c, laws, realization)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "there are no laws of realization %zu for all its sites; `haft-laws "
                              "build --force` builds all",
                              realization);
    }
    size_t from = realization * laws->sites;
    haft_status status = HAFT_OK;
    for (size_t r = first; r < s->sites && status == HAFT_OK; r++) {
        status = make_law(s, c, laws, r, from + r - laws->first_site, r, error);
    }
    if (status == HAFT_OK) {
        stand_in(s, first);
    }
    return status;
}

/* ---- which laws there are, and which are wanted ---- */

bool haft_study_has_sites(const haft_case *c, const haft_laws *laws, size_t realization) {
    return laws != NULL && laws->chaos == NULL && realization < laws->m / laws->sites &&
           laws->first_site <= haft_study_first_site(c) &&
           laws->first_site + laws->sites >= haft_study_sites(c);
}

/* Whether the solver takes the curve of a law with this fault. */
static bool takes_curve(const haft_case *c, haft_law_fault fault) {
    return c->law.kind == HAFT_LAW_TABLE || fault != HAFT_LAW_SOUND;
}

bool haft_study_has_laws(const haft_case *c, const haft_laws *laws, size_t realization) {
    if (!haft_study_has_sites(c, laws, realization)) {
        return false;
    }
    size_t from = realization * laws->sites - laws->first_site, end = haft_study_sites(c);
    for (size_t r = haft_study_first_site(c); r < end; r++) {
        if (takes_curve(c, laws->fault[from + r]) && haft_laws_curve(laws, from + r) == NULL) {
            return false;
        }
    }
    return true;
}

haft_status haft_study_take_laws(haft_laws **out, const haft_case *c, const haft_laws *laws,
                                 size_t set, size_t realization, haft_error *error) {
    bool stochastic = haft_sampler_is_stochastic(c->law.sampler);
    size_t first = stochastic ? 0 : haft_study_first_site(c) - laws->first_site;
    size_t count = stochastic ? laws->m : haft_study_sites(c) - haft_study_first_site(c);
    bool *keep = haft_memory_alloc(count, sizeof *keep, error);
    if (keep == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    bool all = c->curves == HAFT_CURVES_ALL || c->law.kind == HAFT_LAW_TABLE ||
               (!stochastic && haft_case_wants_evidence(c, realization));
    for (size_t i = 0; i < count; i++) {
        haft_law_fault fault = laws->fault[set * laws->sites + first + i];
        keep[i] = all || (!stochastic && takes_curve(c, fault));
    }
    haft_status status = haft_laws_select(out, laws, set * laws->sites + first, count, keep, error);
    haft_memory_free(keep);
    return status;
}

/* ---- the laws of a beam ---- */

static haft_status create(haft_site_laws **out, size_t sites, size_t tables, haft_error *error) {
    haft_site_laws *s = *out = haft_memory_alloc(1, sizeof *s, error);
    if (s == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    s->sites = sites;
    s->tables = tables;
    s->law = haft_memory_alloc(sites, sizeof *s->law, error);
    s->table = haft_memory_alloc(tables, sizeof *s->table, error);
    s->vector = haft_memory_alloc(sites, sizeof *s->vector, error);
    return s->law && s->table && s->vector ? HAFT_OK : HAFT_ERROR_MEMORY;
}

haft_status haft_study_site_laws(haft_site_laws **out, const haft_case *c, const haft_laws *laws,
                                 size_t realization, haft_error *error) {
    bool drawn = haft_sampler_is_stochastic(c->law.sampler), patches = haft_study_draws_patches(c);
    size_t sites = haft_study_sites(c);
    haft_status status = create(out, sites, drawn && patches ? laws->m : sites, error);
    if (status == HAFT_OK) {
        status = (!drawn    ? use_laws
                  : patches ? draw_patches
                            : draw_laws)(*out, c, laws, realization, error);
    }
    for (size_t r = 0; r < sites && status == HAFT_OK; r++) {
        (*out)->law[r].far = c->contact.far;
    }
    if (status != HAFT_OK) {
        haft_site_laws_destroy(out);
    }
    return status;
}

haft_status haft_study_try_law(const haft_case *c, const haft_laws *laws, size_t site,
                               haft_error *error) {
    haft_site_laws *s = NULL;
    haft_status status = create(&s, site + 1, 1, error);
    HAFT_THEN(status, make_law(s, c, laws, site, 0, 0, error));
    haft_site_laws_destroy(&s);
    return status;
}

void haft_site_laws_destroy(haft_site_laws **laws) {
    if (laws == NULL || *laws == NULL) {
        return;
    }
    haft_site_laws *s = *laws;
    for (size_t r = 0; s->table != NULL && r < s->tables; r++) {
        haft_law_table_destroy(&s->table[r]);
    }
    haft_memory_free(s->table);
    haft_memory_free(s->law);
    haft_memory_free(s->vector);
    haft_memory_free(s);
    *laws = NULL;
}

size_t haft_study_sites(const haft_case *c) {
    return (size_t)llround(c->beam.length / c->mesh.l_meso);
}

size_t haft_study_first_site(const haft_case *c) {
    return haft_sampler_is_stochastic(c->law.sampler) ? 0
                                                      : haft_mesh_inert_sites(&c->beam, &c->mesh);
}
