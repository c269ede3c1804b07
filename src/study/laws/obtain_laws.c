/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Laws are built once: a file built from the same inputs is read, any other is built anew. */
#include "haft/study.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static void tell(const haft_progress *progress, const char *text) {
    if (progress != NULL && progress->note != NULL) {
        progress->note(progress->user, text);
    }
}

haft_status haft_study_laws_digest(char digest[HAFT_DIGEST_CAPACITY], const haft_case *c,
                                   const char *path, haft_error *error) {
    char found[HAFT_DIGEST_CAPACITY], origin[HAFT_DIGEST_CAPACITY];
    haft_status status = haft_laws_identify(digest, c, "", error);
    if (status == HAFT_OK && access(path, R_OK) == 0 &&
        haft_laws_peek(found, origin, path, NULL) == HAFT_OK && origin[0] != '\0') {
        char fitted[HAFT_DIGEST_CAPACITY];
        status = haft_laws_identify(fitted, c, origin, error);
        if (status == HAFT_OK && strcmp(fitted, found) == 0) {
            memcpy(digest, fitted, HAFT_DIGEST_CAPACITY);
        }
    }
    return status;
}

/* Reports patches that are left out of a model, because their laws are not in its results. */
static void tell_left_out(const haft_case *c, const haft_laws *laws,
                          const haft_progress *progress) {
    size_t count[HAFT_LAW_FAULTS];
    char text[200];
    haft_study_count_faults(laws, count);
    bool used = laws->chaos != NULL && !haft_study_draws_patches(c);
    if (used && count[HAFT_LAW_SOUND] < laws->m) {
        snprintf(
            text, sizeof text,
            "%zu of %zu patches have no Morse law and are left out of the model (haft-laws info "
            "says why): %zu with two wells, %zu below the bound of their energy",
            laws->m - count[HAFT_LAW_SOUND], laws->m, count[HAFT_LAW_TWO_WELLS],
            count[HAFT_LAW_BOUND]);
        tell(progress, text);
    }
}

static void tell_forces(const haft_case *c, const haft_progress *progress) {
    char text[120];
    if (c->contact.forces == HAFT_FORCES_AUTO) {
        snprintf(text, sizeof text, "forces chosen by the humidity, %g %%: %s",
                 100 * c->contact.capillary.humidity, haft_physics_name(haft_case_physics(c)));
        tell(progress, text);
    }
}

static haft_status build_model(haft_laws **out, const haft_case *c, const char *path,
                               const haft_progress *progress, haft_error *error) {
    HAFT_TRY(haft_study_build_laws(out, c, progress, error));
    tell_left_out(c, *out, progress);
    haft_status status = haft_laws_write(*out, c, path, error);
    if (status != HAFT_OK) {
        haft_laws_destroy(out);
    }
    return status;
}

haft_status haft_study_obtain_laws(haft_laws **out, char digest[HAFT_DIGEST_CAPACITY],
                                   const haft_case *c, const char *path,
                                   const haft_progress *progress, haft_error *error) {
    *out = NULL;
    bool there = access(path, F_OK) == 0, drawn = haft_sampler_is_stochastic(c->law.sampler);
    char found[HAFT_DIGEST_CAPACITY] = "";
    haft_status status = haft_study_laws_digest(digest, c, path, error);
    if (status == HAFT_OK && there) {
        status = haft_laws_read(out, found, path, error);
    }
    if (status != HAFT_OK) {
        return status;
    }
    tell_forces(c, progress);
    bool model = drawn && !haft_study_draws_patches(c);
    if (there && strcmp(found, digest) == 0 && (drawn || (*out)->chaos == NULL) &&
        (!model || (*out)->chaos != NULL)) {
        tell(progress, (*out)->origin[0] != '\0'
                           ? "the laws were fitted to a table of vectors: reading them"
                           : "the laws were built from the same inputs: reading them");
        tell_left_out(c, *out, progress);
        return HAFT_OK;
    }
    status = haft_laws_identify(digest, c, "", error);
    haft_laws_destroy(out);
    if (status != HAFT_OK) {
        return status;
    }
    tell(progress, there ? "the laws were built from other inputs: building them anew"
                         : "no laws yet: building them");
    return drawn ? build_model(out, c, path, progress, error) : HAFT_OK;
}

void haft_study_count_faults(const haft_laws *laws, size_t count[HAFT_LAW_FAULTS]) {
    memset(count, 0, HAFT_LAW_FAULTS * sizeof *count);
    for (size_t k = 0; k < laws->m; k++) {
        count[laws->fault[k]]++;
    }
}
