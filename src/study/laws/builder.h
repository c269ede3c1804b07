/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What builds laws from surfaces, and the scratch of one of its threads. Private to this room. */
#ifndef HAFT_STUDY_BUILDER_H
#define HAFT_STUDY_BUILDER_H

#include "haft/study.h"

/* Read only once made, shared by any number of threads. Blocks of surface are numbered from the
 * clamp, whichever of them are needed. */
typedef struct haft_builder {
    const haft_case *c;
    haft_contact_spec contact;
    haft_surface_plan *plan;
    haft_tiling *tiling;         /* windows of maps, instead of the plan; a block is a patch */
    haft_maugis_table *maugis;   /* NULL without van der Waals forces */
    size_t n;                    /* distances */
    size_t first_site, end_site; /* patches that get laws: of the beam, or of the model */
    size_t block_patches, first_block, end_block;
} haft_builder;

/* Not thread-safe (FFTW's planner).
 * @param surfaces NULL, or the builder whose surfaces this one's laws are read off too: then it has
 * none of its own */
haft_status haft_builder_create(haft_builder **out, const haft_case *c,
                                const haft_builder *surfaces, haft_error *error) HAFT_MUST_CHECK;
void haft_builder_destroy(haft_builder **builder);

/* Of n builders, the first with the surfaces of all. */
typedef struct haft_builder_hand haft_builder_hand;
haft_status haft_builder_hand_create(haft_builder_hand **out, const haft_builder *const *b,
                                     size_t n, haft_error *error) HAFT_MUST_CHECK;
void haft_builder_hand_destroy(haft_builder_hand **hand);

/* Empty laws of so many realizations, all curves kept. */
haft_status haft_builder_room(haft_laws **out, const haft_builder *b, size_t sets,
                              haft_error *error) HAFT_MUST_CHECK;

/* Laws of a block's patches by all the hand's builders, those of the first site as number `row` of
 * each one's laws. Thread-safe for distinct hands and blocks. */
haft_status haft_builder_block(const haft_builder *const *b, haft_builder_hand *w,
                               size_t realization, size_t block, haft_laws *const *laws, size_t row,
                               haft_error *error) HAFT_MUST_CHECK;

/* The laws of one realization, with such curves as the case keeps. Thread-safe for distinct hands.
 */
haft_status haft_builder_realize(haft_laws **out, const haft_builder *b, haft_builder_hand *w,
                                 size_t realization, haft_error *error) HAFT_MUST_CHECK;

#endif
