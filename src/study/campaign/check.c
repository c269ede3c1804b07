/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks of a case before a run: the first steps of a run, up to the law of the first site,
 * without a beam. They are the same functions, so the messages are the same. */
#include "study/laws/builder.h"

/* The patch whose curve a beam of the first realization takes first, if it takes curves at all. */
static bool first_patch(const haft_case *c, size_t *patch) {
    bool drawn = haft_sampler_is_stochastic(c->law.sampler);
    *patch = drawn ? haft_chaos_draw_patch(c->seed, 0, 0, c->law.chaos.vectors)
                   : haft_study_first_site(c);
    return !drawn || haft_study_draws_patches(c);
}

/* Makes the law of that patch as the run does. */
static haft_status check_law(haft_builder *b, size_t patch, haft_error *error) {
    const haft_builder *only = b;
    haft_builder_hand *hand = NULL;
    haft_laws *laws = NULL;
    bool drawn = haft_sampler_is_stochastic(b->c->law.sampler);
    b->first_site = patch;
    b->end_site = patch + 1;
    haft_status status = haft_builder_hand_create(&hand, &only, 1, error);
    HAFT_THEN(status, haft_builder_room(&laws, b, 1, error));
    HAFT_THEN(status,
              haft_builder_block(&only, hand, 0, patch / b->block_patches, &laws, 0, error));
    HAFT_THEN(status, haft_study_try_law(b->c, laws, drawn ? 0 : patch, error));
    haft_laws_destroy(&laws);
    haft_builder_hand_destroy(&hand);
    return status;
}

haft_status haft_study_check(const haft_case *c, bool laws, haft_error *error) {
    haft_builder *builder = NULL;
    haft_model *model = NULL;
    size_t patch = 0;
    haft_status status = haft_model_create_beam(&model, &c->beam, &c->mesh, error);
    haft_model_destroy(&model);
    if (status == HAFT_OK && laws) {
        status = haft_builder_create(&builder, c, NULL, error);
    }
    if (status == HAFT_OK && laws && first_patch(c, &patch)) {
        status = check_law(builder, patch, error);
    }
    haft_builder_destroy(&builder);
    return status;
}
