/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One beam: its path and its summary. */
#include "haft/study.h"

#include <math.h>

haft_status haft_study_realize(haft_path **out, haft_summary *summary, const haft_case *c,
                               const haft_model *model, const haft_site_laws *laws,
                               bool keep_states, haft_error *error) {
    haft_path_options options = c->path;
    options.keep_states = keep_states;
    double start = haft_clock_seconds();
    HAFT_TRY(haft_solve_path(out, model, laws->law, &c->programme, &options, error));
    const haft_path *path = *out;
    haft_path_point end = {0}, turn = {0};
    if (path->points > 0) {
        end = path->point[path->points - 1];
        turn = path->point[path->turn];
    }
    bool solved = path->outcome == HAFT_OUTCOME_STUCK || path->outcome == HAFT_OUTCOME_FREE;
    bool stuck = path->outcome == HAFT_OUTCOME_STUCK;
    *summary = (haft_summary){
        .crack_length = solved ? end.crack_length : NAN,
        .loaded_crack_length = path->points > 0 ? turn.crack_length : NAN,
        .gamma = stuck ? haft_beam_effective_energy(&c->beam, end.crack_length) : 0,
        .work = end.work,
        .dissipated = end.dissipated,
        .internal_energy = solved ? end.internal_energy : NAN,
        .end_influence = path->end_influence,
        .ledger_error = path->ledger_error,
        .seconds = haft_clock_seconds() - start,
        .outcome = (int)path->outcome,
        .jumps = (int)path->jumps,
        .steps = (int)path->points,
        .unfit = (int)laws->unfit,
    };
    return HAFT_OK;
}
