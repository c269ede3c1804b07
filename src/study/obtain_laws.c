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

static bool shapes_agree(const haft_laws *laws, const haft_case *c) {
    bool drawn = haft_sampler_is_stochastic(c->law.sampler);
    size_t sites = haft_study_sites(c);
    return drawn == (laws->chaos != NULL) &&
           (drawn || (laws->sites == sites && laws->m == sites * c->realizations));
}

haft_status haft_study_obtain_laws(haft_laws **out, char digest[HAFT_DIGEST_CAPACITY],
                                   const haft_case *c, const char *path,
                                   const haft_progress *progress, haft_error *error) {
    *out = NULL;
    haft_status status = haft_case_laws_digest(c, digest, error);
    if (status != HAFT_OK) {
        return status;
    }
    char found[HAFT_DIGEST_CAPACITY] = "";
    if (access(path, F_OK) != 0) {
        tell(progress, "no laws yet: building them");
    } else {
        status = haft_laws_read(out, found, path, error);
        if (status != HAFT_OK) {
            return status;
        }
        if (strcmp(found, digest) == 0 && shapes_agree(*out, c)) {
            tell(progress, "the laws were built from the same inputs: reading them");
            return HAFT_OK;
        }
        haft_laws_destroy(out);
        tell(progress, "the laws were built from other inputs: building them anew");
    }
    status = haft_study_build_laws(out, c, progress, error);
    if (status != HAFT_OK) {
        return status;
    }
    status = haft_laws_write(*out, c, path, error);
    if (status != HAFT_OK) {
        haft_laws_destroy(out);
    }
    return status;
}

void haft_study_count_faults(const haft_laws *laws, size_t count[HAFT_LAW_FAULTS]) {
    memset(count, 0, HAFT_LAW_FAULTS * sizeof *count);
    for (size_t k = 0; k < laws->m; k++) {
        count[laws->fault[k]]++;
    }
}
