/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The laws of one beam: of its patches, Morse where it fits, the curve itself where it does not or
 * is asked for; or drawn from the model. */
#include "haft/study.h"

#include <math.h>

static haft_status make_table(haft_site_laws *s, const haft_laws *laws, size_t r, size_t k,
                              haft_error *error) {
    haft_status status = haft_law_table_create(&s->table[r], laws->n, laws->distance,
                                               laws->force + k * laws->n, error);
    if (status != HAFT_OK) {
        haft_error_prefix(error, "the curve of site %zu (%s): ", r,
                          haft_law_fault_name(laws->fault[k]));
        return status;
    }
    s->law[r] = haft_law_from_table(s->table[r]);
    return HAFT_OK;
}

static haft_status make_law(haft_site_laws *s, const haft_case *c, const haft_laws *laws, size_t r,
                            size_t k, haft_error *error) {
    haft_law_fault fault = laws->fault[k];
    haft_law morse;
    if (fault == HAFT_LAW_SOUND) {
        fault = haft_law_morse(&morse, &laws->vector[k], laws->f_limit);
    }
    s->vector[r] = laws->vector[k];
    s->unfit += fault != HAFT_LAW_SOUND;
    if (c->law.kind == HAFT_LAW_TABLE) {
        return make_table(s, laws, r, k, error);
    }
    if (fault == HAFT_LAW_SOUND) {
        s->law[r] = morse;
        return HAFT_OK;
    }
    if (c->law.unfit == HAFT_UNFIT_STOP) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "no Morse law fits the curve of site %zu (%s); set law.unfit: table "
                              "to use such curves themselves, or law.kind: table to use all",
                              r, haft_law_fault_name(fault));
    }
    return make_table(s, laws, r, k, error);
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

static haft_status take_laws(haft_site_laws *s, const haft_case *c, const haft_laws *laws,
                             size_t realization, haft_error *error) {
    haft_status status = HAFT_OK;
    for (size_t r = 0; r < s->sites && status == HAFT_OK; r++) {
        status = make_law(s, c, laws, r, realization * laws->sites + r, error);
    }
    return status;
}

haft_status haft_study_site_laws(haft_site_laws **out, const haft_case *c, const haft_laws *laws,
                                 size_t realization, haft_error *error) {
    *out = NULL;
    haft_site_laws *s = haft_memory_alloc(1, sizeof *s, error);
    if (s == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    bool drawn = haft_sampler_is_stochastic(c->law.sampler);
    s->sites = drawn ? haft_study_sites(c) : laws->sites;
    s->law = haft_memory_alloc(s->sites, sizeof *s->law, error);
    s->table = haft_memory_alloc(s->sites, sizeof *s->table, error);
    s->vector = haft_memory_alloc(s->sites, sizeof *s->vector, error);
    haft_status status = s->law && s->table && s->vector ? HAFT_OK : HAFT_ERROR_MEMORY;
    if (status == HAFT_OK) {
        status = (drawn ? draw_laws : take_laws)(s, c, laws, realization, error);
    }
    if (status != HAFT_OK) {
        haft_site_laws_destroy(&s);
    }
    *out = s;
    return status;
}

void haft_site_laws_destroy(haft_site_laws **laws) {
    if (laws == NULL || *laws == NULL) {
        return;
    }
    haft_site_laws *s = *laws;
    for (size_t r = 0; s->table != NULL && r < s->sites; r++) {
        haft_law_table_destroy(&s->table[r]);
    }
    haft_memory_free(s->table);
    haft_memory_free(s->law);
    haft_memory_free(s->vector);
    haft_memory_free(s);
    *laws = NULL;
}
