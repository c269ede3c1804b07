/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds the stochastic model of a case from its sound vectors. */
#include "stochastic.h"

/* N_g is known only after the principal components, and rising order needs it: so the model is
 * made twice. */
haft_status haft_stochastic_create(haft_chaos **out, size_t m, const haft_law_vector *vector,
                                   const haft_case *c, haft_error *error) {
    haft_chaos_spec spec = c->law.chaos.spec;
    spec.f_limit = haft_case_limit(c);
    haft_status status = haft_chaos_create(out, m, vector, &spec, error);
    if (status != HAFT_OK || c->law.chaos.component_order == HAFT_COMPONENTS_FALLING) {
        return status;
    }
    haft_chaos_parts parts;
    haft_chaos_get_parts(*out, &parts);
    spec.components = parts.components;
    for (size_t i = 0; i < HAFT_CHAOS_DIMENSION; i++) {
        spec.component_order[i] = i < spec.components ? spec.components - 1 - i : i;
    }
    haft_chaos_destroy(out);
    return haft_chaos_create(out, m, vector, &spec, error);
}

haft_status haft_study_build_chaos(haft_laws *laws, const haft_case *c, haft_error *error) {
    haft_law_vector *sound = haft_memory_alloc(laws->m, sizeof *sound, error);
    if (sound == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    size_t m = 0;
    for (size_t k = 0; k < laws->m; k++) {
        if (laws->fault[k] == HAFT_LAW_SOUND) {
            sound[m++] = laws->vector[k];
        }
    }
    haft_chaos_effort effort = {0};
    haft_status status = haft_stochastic_create(&laws->chaos, m, sound, c, error);
    HAFT_THEN(status, haft_chaos_measure(laws->chaos, &effort, &laws->errors, error));
    if (status == HAFT_ERROR_INPUT) {
        haft_error_prefix(error, "the stochastic model of %zu sound vectors of %zu: ", m, laws->m);
    }
    haft_memory_free(sound);
    return status;
}

haft_status haft_study_fit_laws(haft_laws **out, const haft_case *c, size_t m,
                                const haft_law_vector *vector, haft_error *error) {
    HAFT_TRY(haft_laws_create(out, m, 0, error));
    haft_laws *laws = *out;
    laws->sites = m;
    laws->f_limit = haft_case_limit(c);
    haft_digest_memory(vector, m * sizeof *vector, laws->origin);
    for (size_t k = 0; k < m; k++) {
        laws->vector[k] = vector[k];
        laws->fault[k] = haft_law_vector_fault(&vector[k], laws->f_limit);
    }
    haft_status status = haft_study_build_chaos(laws, c, error);
    if (status != HAFT_OK) {
        haft_laws_destroy(out);
    }
    return status;
}

haft_status haft_study_draw(const haft_laws *laws, const haft_case *c, size_t realization, size_t n,
                            haft_law_vector *vector, haft_error *error) {
    if (!haft_sampler_is_stochastic(c->law.sampler) || laws->chaos == NULL) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "laws are drawn only from a stochastic model; set law.sampler: gpce, "
                              "exact, kernel, bootstrap or mean");
    }
    haft_chaos_work *work = NULL;
    haft_chaos_sampler sampler = (haft_chaos_sampler)((int)c->law.sampler - (int)HAFT_SAMPLER_GPCE);
    haft_status status = HAFT_OK;
    if (sampler == HAFT_CHAOS_SAMPLER_EXACT) {
        status = haft_chaos_work_create(&work, laws->chaos, error);
    }
    HAFT_THEN(status, haft_chaos_sample(laws->chaos, work, sampler, c->seed, realization, 0, n,
                                        vector, error));
    haft_chaos_work_destroy(&work);
    return status;
}
