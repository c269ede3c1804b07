/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Variants of a case for its error budget. Each is written and read back as a case of its own,
 * so that a senseless change is refused as it would be in case.yaml, and any variant can be run
 * again alone. All have the case's seed, so two variants draw the same random numbers for the
 * same purpose. Laws of the same inputs are built once. */
#include "budget.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- the changed case ---- */

/* A quarter more, in whole elements and patches. */
static double lengthened(const haft_case *c) {
    double unit = c->mesh.l_meso, element = c->mesh.element_length;
    if (c->mesh.kind == HAFT_MESH_UNIFORM) {
        double ratio = element / unit;
        bool nested = ratio > 0.5 && fabs(ratio - round(ratio)) < 1e-6 * ratio;
        unit = nested ? element : c->beam.length;
    }
    return c->beam.length + ceil(0.25 * c->beam.length / unit * (1 - 1e-9)) * unit;
}

static void change(haft_case *v, unsigned changes) {
    if (changes & HAFT_CHANGE_LENGTH) {
        v->beam.length = lengthened(v);
    }
    if (changes & HAFT_CHANGE_GRID) {
        v->surface.grid_step *= 0.5;
    }
    if (changes & HAFT_CHANGE_ASPERITIES) {
        v->contact.asperities = v->contact.asperities == HAFT_ASPERITY_ISLANDS
                                    ? HAFT_ASPERITY_SUMMITS
                                    : HAFT_ASPERITY_ISLANDS;
    }
    if (changes & HAFT_CHANGE_EXACT) {
        v->law.sampler = HAFT_SAMPLER_EXACT;
    }
    if (changes & HAFT_CHANGE_PATCHES) {
        v->law.sampler = HAFT_SAMPLER_PATCHES;
    }
    if (changes & HAFT_CHANGE_SEAMLESS) {
        v->law.sampler = HAFT_SAMPLER_EXPLICIT;
    }
    if (changes & HAFT_CHANGE_TABLE) {
        v->law.kind = HAFT_LAW_TABLE;
    }
    if (changes & HAFT_CHANGE_PATCH) {
        v->mesh.l_meso *= 0.5;
    }
    if (changes & HAFT_CHANGE_MESH) {
        v->mesh.kind = HAFT_MESH_EXACT;
    }
    if (changes & HAFT_CHANGE_STEPS) {
        v->path.gap_step *= 0.5;
        v->path.flow_step *= 0.5;
    }
}

static haft_status make_case(haft_changed *own, const haft_changed_set *set, haft_error *error) {
    char path[4096], name[16];
    haft_case v = *set->c;
    v.realizations = set->beams;
    v.stop.crack_length_mean = 0;
    memset(&v.evidence, 0, sizeof v.evidence);
    v.curves = HAFT_CURVES_ALL; /* some variants take them as tables */
    change(&v, own->changes);
    snprintf(name, sizeof name, "%03x.yaml", own->changes);
    HAFT_TRY(haft_path_join(path, sizeof path, set->directory, name, error));
    HAFT_TRY(haft_case_write(&v, path, error));
    return haft_case_read(&own->c, path, error);
}

/* ---- its beams ---- */

static haft_status obtain_laws(const haft_laws **laws, double *seconds, haft_changed_set *set,
                               const haft_case *c, haft_error *error) {
    char digest[HAFT_DIGEST_CAPACITY];
    size_t sites = haft_sampler_is_stochastic(c->law.sampler) ? 0 : haft_study_sites(c);
    haft_status status = haft_case_laws_digest(c, digest, error);
    for (size_t i = 0; i < set->laws_count && status == HAFT_OK; i++) {
        if (strcmp(set->built[i].digest, digest) == 0 && set->built[i].sites == sites) {
            *laws = set->built[i].laws;
            *seconds = set->built[i].seconds;
            return HAFT_OK;
        }
    }
    /* only its request to stop: the budget reports its own progress */
    haft_progress inner = {0};
    if (set->progress != NULL) {
        inner.stop = set->progress->stop;
        inner.user = set->progress->user;
    }
    haft_laws *built = NULL;
    double start = haft_clock_seconds();
    HAFT_THEN(status, haft_study_build_laws(&built, c, &inner, error));
    if (status == HAFT_OK) {
        size_t i = set->laws_count++;
        memcpy(set->built[i].digest, digest, sizeof digest);
        set->built[i].sites = sites;
        *laws = set->built[i].laws = built;
        *seconds = set->built[i].seconds = haft_clock_seconds() - start;
    }
    return status;
}

static haft_status follow(haft_summary *beam, const haft_case *c, const haft_model *model,
                          const haft_laws *laws, size_t k, haft_error *error) {
    haft_site_laws *sites = NULL;
    haft_path *path = NULL;
    haft_status status = haft_study_site_laws(&sites, c, laws, k, error);
    HAFT_THEN(status, haft_study_realize(&path, beam, c, model, sites, false, error));
    haft_path_destroy(&path);
    haft_site_laws_destroy(&sites);
    return status;
}

/* Runs all beams in parallel. The failure of the first of them is reported. */
static haft_status follow_all(haft_changed *own, const haft_changed_set *set, const haft_laws *laws,
                              haft_error *error) {
    haft_model *model = NULL;
    const haft_progress *p = set->progress;
    haft_status result = haft_model_create_beam(&model, &own->c->beam, &own->c->mesh, error);
    long beams = (long)set->beams, failed = beams;
    if (result != HAFT_OK) {
        return result;
    }
#pragma omp parallel for schedule(dynamic)
    for (long k = 0; k < beams; k++) {
        haft_error mine = {0};
        bool halt = false;
#pragma omp critical
        halt = p != NULL && p->stop != NULL && p->stop(p->user);
        haft_status status =
            halt ? haft_error_set(&mine, HAFT_ERROR_INTERRUPTED,
                                  "stopped while the budget was being measured; nothing kept")
                 : follow(&own->beam[k], own->c, model, laws, (size_t)k, &mine);
#pragma omp critical
        if (status != HAFT_OK && k < failed) {
            failed = k;
            result = haft_error_set(error, status, "%s", mine.message);
        }
    }
    haft_model_destroy(&model);
    return result;
}

haft_status haft_changed_get(const haft_changed **out, haft_changed_set *set, unsigned changes,
                             haft_error *error) {
    for (size_t i = 0; i < set->count; i++) {
        if (set->changed[i].changes == changes) {
            *out = &set->changed[i];
            return HAFT_OK;
        }
    }
    if (set->count == HAFT_VARIANTS_KEPT) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT, "more than %d variants of a case",
                              HAFT_VARIANTS_KEPT);
    }
    const haft_laws *laws = NULL;
    haft_changed own = {.changes = changes,
                        .beam = haft_memory_alloc(set->beams, sizeof *own.beam, error)};
    double seconds = 0;
    haft_status status = own.beam == NULL ? HAFT_ERROR_MEMORY : make_case(&own, set, error);
    HAFT_THEN(status, obtain_laws(&laws, &seconds, set, own.c, error));
    double start = haft_clock_seconds();
    HAFT_THEN(status, follow_all(&own, set, laws, error));
    own.seconds = (seconds + haft_clock_seconds() - start) / (double)set->beams;
    if (status != HAFT_OK) {
        haft_memory_free(own.beam);
        haft_case_destroy(&own.c);
        return status;
    }
    set->changed[set->count] = own;
    *out = &set->changed[set->count++];
    return HAFT_OK;
}

void haft_changed_close(haft_changed_set *set) {
    for (size_t i = 0; i < set->count; i++) {
        haft_case_destroy(&set->changed[i].c);
        haft_memory_free(set->changed[i].beam);
    }
    for (size_t i = 0; i < set->laws_count; i++) {
        haft_laws_destroy(&set->built[i].laws);
    }
}
